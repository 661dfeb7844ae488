# SPDX-License-Identifier: MIT
"""Particles in a cut: no voids in bodies that are whole, whatever their motion, and their sizes."""

import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parents[1]), str(HERE)]

from test_post_pictures import area, grid  # noqa: E402

from post.deck import Deck  # noqa: E402
from post.reader import Particles  # noqa: E402
from post.space import Cut, boxes_of, outlines_in, particles_in  # noqa: E402
from post.surface import skin_of  # noqa: E402

BLOCK = """
&run t_end = 1e-3, symmetry = 'y' /
&material id = 's', model = 'bilinear_j2' /
&body id = 'block', box = -0.06, 0.06, -0.06, 0.06, 0, 0.06, spacing = {spacing}, material = 's'
  aspect = {aspect} /
"""


class Moved:
    """A block of particles of 10 x 10 x 10 mm, or three times as wide, of which the motion is given
    by a function of the unloaded places."""

    def __init__(self, move, aspect=(1, 1, 1)):
        sides = 0.12 / 36 * np.array(aspect) if max(aspect) > 1 else np.full(3, 0.01)
        axes = [
            np.arange(low + s / 2, 0.06, s) for low, s in zip((-0.06, 0, 0), sides, strict=True)
        ]
        rest = grid(*axes)
        moved = move(rest)
        field = {"displacement": moved - rest, "body": np.ones(len(rest), int)}
        self.solid = Particles(0.0, moved, field)
        text = BLOCK.format(spacing=sides.min(), aspect=", ".join(map(str, aspect)))
        self.run = SimpleNamespace(deck=Deck(text))

    def open_share(self, cut, inside):
        """Part of the pixels `inside` (n, 2) [m] of the cut that no outline covers."""
        edges = boxes_of(self.run, self.solid)
        rows = particles_in(cut, self.solid, edges)
        open_ = np.ones(len(inside), bool)
        for quad in outlines_in(cut, self.solid.points[rows], 1.0001 * edges[rows]):
            basis = np.array([quad[1] - quad[0], quad[3] - quad[0]]).T
            place = np.linalg.solve(basis, (inside - quad[0]).T)
            open_ &= ((place < 0) | (place > 1)).any(axis=0)
        return open_.mean()


def turned(axis, degrees):
    """Motion: rotation about an axis through the middle of the block."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    i, j = (d for d in range(3) if d != axis)
    turn = np.eye(3)
    turn[[i, i, j, j], [i, j, i, j]] = c, -s, s, c
    return lambda rest: (rest - [0, 0.03, 0.03]) @ turn.T + [0, 0.03, 0.03]


@pytest.mark.parametrize("shift", [0.0, 0.1, 0.3])
def test_section_on_a_plane_of_symmetry_has_no_void_where_particles_moved_off_it(shift):
    """Particles beside the plane move off it, each by up to `shift` of a spacing."""
    rng = np.random.default_rng(1)
    block = Moved(lambda rest: rest + 0.01 * shift * rng.uniform(0, 1, (len(rest), 1)) * [0, 1, 0])
    inside = grid(np.linspace(-0.059, 0.059, 60), np.linspace(0.001, 0.059, 30))
    assert block.open_share(Cut(1, 0, 2, 0.0), inside) == 0


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("level", [0.03, 0.0333])
def test_section_through_a_turned_block_has_no_void(axis, level):
    block = Moved(turned(axis, 37))
    inside = grid(np.linspace(-0.02, 0.02, 41), np.linspace(0.015, 0.045, 31))
    assert block.open_share(Cut(1, 0, 2, level), inside) == 0


def test_section_through_a_stretched_block_has_no_void_and_holds_one_layer():
    """A cut between two layers that are 1.4 spacings apart; one on a layer holds it alone."""
    block = Moved(lambda rest: rest * [1, 1.4, 1])
    inside = grid(np.linspace(-0.059, 0.059, 60), np.linspace(0.001, 0.059, 30))
    for level in (0.014, 0.021):
        assert block.open_share(Cut(1, 0, 2, level), inside) == 0
    rows = particles_in(Cut(1, 0, 2, 0.021), block.solid, boxes_of(block.run, block.solid))
    assert len(rows) == 12 * 6


def test_wide_particles_are_drawn_as_wide_as_they_are():
    """aspect = 3, 3, 1: they fill the section, and the skin is that of the block."""
    for move in (lambda rest: rest, turned(2, 20)):
        block = Moved(move, aspect=(3, 3, 1))
        inside = grid(np.linspace(-0.02, 0.02, 41), np.linspace(0.001, 0.059, 59))
        assert block.open_share(Cut(1, 0, 2, 0.03), inside) == 0
    body, rest = block.run.deck.bodies()[0], Moved(lambda rest: rest, aspect=(3, 3, 1)).solid
    skin = skin_of(rest.points, rest.field["displacement"], body.step)
    sides = 0.12, 0.06, 0.06
    assert area(skin) == pytest.approx(2 * sum(sides[d] * sides[d - 1] for d in range(3)))
