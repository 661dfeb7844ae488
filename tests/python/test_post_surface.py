# SPDX-License-Identifier: MIT
"""The skin of bodies of particles."""

import sys
from pathlib import Path

import numpy as np
import pytest

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parents[1]), str(HERE)]

from post.surface import skin_of  # noqa: E402


def block(n):
    axes = [(np.arange(k) + 0.5) * 0.1 for k in n]
    return np.stack([a.ravel() for a in np.meshgrid(*axes, indexing="ij")], 1)


def area(skin):
    a, b = (skin.corners[:, i + 2] - skin.corners[:, i] for i in (0, 1))
    return 0.5 * np.linalg.norm(np.cross(a, b), axis=1).sum()


def test_skin_of_a_block_is_its_surface():
    x = block((4, 3, 2))
    skin = skin_of(x, np.zeros_like(x), 0.1)
    assert len(skin.corners) == 2 * (12 + 8 + 6)
    assert area(skin) == pytest.approx(0.52)
    np.testing.assert_allclose(skin.corners.max((0, 1)), [0.4, 0.3, 0.2], atol=1e-12)
    half = skin_of(x, np.zeros_like(x), 0.1, mirrors=(True, False, False))
    assert area(half) == pytest.approx(0.52 - 0.06)  # open at x = 0


def test_skin_follows_a_linear_motion_exactly():
    x = block((4, 3, 2))
    f = np.array([[1.2, 0.1, 0.0], [0.0, 0.9, 0.2], [0.1, 0.0, 1.1]])
    rest = skin_of(x, np.zeros_like(x), 0.1)
    bent = skin_of(x @ f.T, x @ f.T - x, 0.1)
    np.testing.assert_allclose(bent.corners, rest.corners @ f.T, atol=1e-12)
    twice = skin_of(x @ f.T, x @ f.T - x, 0.1, magnification=2.0)
    np.testing.assert_allclose(twice.corners, rest.corners @ (2 * f - np.eye(3)).T, atol=1e-12)


def test_skin_opens_at_a_crack():
    x = block((4, 1, 1))
    move = np.where(x[:, :1] > 0.2, [[0.3, 0, 0]], [[0.0, 0, 0]])
    assert area(skin_of(x + move, move, 0.1)) == pytest.approx(4 * 0.04 + 4 * 0.01)


def test_particles_off_a_lattice_have_no_skin():
    x = np.random.default_rng(1).uniform(size=(200, 3))
    assert skin_of(x, np.zeros_like(x), 0.1) is None
