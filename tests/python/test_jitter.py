# SPDX-License-Identifier: MIT
"""Particles a little off their places: how far, the same again, another set for another seed."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))
BINARY = Path(os.environ.get("BRISANCE", ROOT / "bin" / "brisance"))

from post.reader import Run  # noqa: E402

DECK = """
&run t_end=2e-6, dimension={d}, symmetry='x' /
&material id='s', model='linear_elastic', density=7850, youngs_modulus=2e11, poisson_ratio=0.3 /
&body id='block', box=0,0.02,0,0.02,0,{z}, spacing=1e-3, material='s', velocity=0,10,0 /
&body id='wall', box=0,0.02,0.0205,0.0235,0,{z}, spacing=1e-3, material='s', formulation='rigid',
      fix='all' /
&solid jitter={jitter}, seed={seed} /
"""


def places(folder, threads="1", **numbers):
    """Bodies and places of the particles at the start [mm], and the energy of the last row."""
    folder.mkdir()
    text = DECK.format(**({"d": 2, "z": 1, "jitter": 1e-3, "seed": 1} | numbers))
    (folder / "a.nml").write_text(text)
    subprocess.run(
        [BINARY, "run", "a.nml", "--backend", "cpu"],
        cwd=folder,
        env=os.environ | {"OMP_NUM_THREADS": threads},
        check=True,
        capture_output=True,
        timeout=100,
    )
    run = Run(folder / "out" / "a")
    solid = run.frames[0].solid("body", "displacement")
    rest = solid.points - solid.field["displacement"]
    return solid.field["body"], 1e3 * rest, run.energy.data[-1]


def test_shifts_are_as_long_as_asked_for(tmp_path):
    body, still, _ = places(tmp_path / "still", jitter=0)
    _, moved, _ = places(tmp_path / "moved")
    shift = (moved - still)[body == 1]
    assert np.abs(shift[:, :2]).max() == pytest.approx(1e-3, rel=0.02)
    assert np.all(shift[:, 2] == 0)  # not modelled
    assert shift[:, :2].std(axis=0) == pytest.approx(1e-3 / np.sqrt(3), rel=0.08)
    assert np.abs(shift[:, :2].mean(axis=0)).max() < 1e-4
    assert np.corrcoef(shift[:, 0], shift[:, 1])[0, 1] == pytest.approx(0, abs=0.15)
    assert np.all((moved - still)[body == 2] == 0)  # rigid bodies stay


def test_a_seed_is_a_set_of_shifts(tmp_path):
    """The same bits again and with two threads; another set for another seed."""
    _, one, end = places(tmp_path / "one")
    _, two, again = places(tmp_path / "two", threads="2")
    assert np.array_equal(one, two) and end == again
    _, other, _ = places(tmp_path / "other", seed=2)
    body, still, _ = places(tmp_path / "still", jitter=0)
    a, b = (x[body == 1, :2].ravel() - still[body == 1, :2].ravel() for x in (one, other))
    assert np.corrcoef(a, b)[0, 1] == pytest.approx(0, abs=0.12)
