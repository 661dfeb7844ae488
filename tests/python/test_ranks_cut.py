# SPDX-License-Identifier: MIT
"""Cut cells on several processes: the results and restarts of one, from outside."""

import functools

import numpy as np
import pytest
from test_ranks import go, needs_mpirun, start
from test_ranks_coupled import equal_runs, equal_states
from test_run import ROOT, arrays
from tiers import slow

# A sheet of one layer that is held and a rigid disc lie across borders of boxes, and a soft cube is
# torn to pieces where four of them meet. The hot gas wakes the fallback.
TORN = """\
&run title = 'torn', t_end = 1, max_steps = 70, energy_band = 10 /
&air box = 0, 0.4,  0, 0.4,  0, 0.08, cells = 40, 40, 8,
     bc = 'symmetry', 'outflow', 'wall', 'outflow', 'outflow', 'outflow',
     reconstruction = 'weno3', flux = 'hllc', integrator = 'ssprk2' /
&gas id = 'hot', box = 0.1, 0.2,  0.05, 0.35,  -1, 2, density = 8, pressure = 8e6,
     velocity = 1500, 0, 0 /
&material id = 's', model = 'linear_elastic', density = 200, youngs_modulus = 1e6,
     poisson_ratio = 0.3 /
&interaction law = 'none' /
&body id = 'sheet', shape = 'particles', file = 'sheet.csv', spacing = 6e-3, material = 's',
     fix = 'all' /
&body id = 'disc', shape = 'cylinder', centre = 0.29, 0.3, 0.04, radius = 0.025, length = 0.08,
     spacing = 6e-3, material = 's', formulation = 'rigid', velocity = -300, -80, 0,
     spin = 0, 0, 2000 /
&body id = 'torn', shape = 'particles', file = 'torn.csv', start_file = 'torn.csv',
     spacing = 6e-3, material = 's' /
&gauge id = 'a', at = 0.22, 0.2, 0.04, quantity = 'pressure' /
&output dump_every = 1e-4, history_every = 0 /
"""
CORNER = 0.24, 0.24, 0.04


# The same on the ends of a periodic direction, in which no process is cut: all lies higher by UP.
UP = np.array([0, 0.16, 0])
ROUND = (
    TORN.replace("'outflow', 'wall', 'outflow'", "'outflow', 'periodic', 'periodic'")
    .replace("0.05, 0.35,  -1, 2", "0.21, 0.39,  -1, 2")
    .replace("0.29, 0.3, 0.04", "0.29, 0.405, 0.04")
)


def write_bodies(folder, up=0 * UP):
    """The points of the sheet, and of the cube with their velocities."""
    way, height = np.meshgrid(np.arange(0, 0.1, 6e-3), np.arange(3e-3, 0.08, 6e-3))
    sheet = np.array([0.25 + 0.94 * way, 0.14 + 0.34 * way, height]).reshape(3, -1)
    side = (np.arange(6) - 2.5) * 6e-3
    cube = np.array(np.meshgrid(side, side, side)).reshape(3, -1)
    apart = 1e4 * cube + np.random.default_rng(1).uniform(-40, 40, cube.shape)
    named = {"sheet": sheet, "torn": np.vstack([cube + np.reshape(CORNER, (3, 1)), apart])}
    for name, rows in named.items():
        rows[:3] += up[:, None]
        head = "x,y,z,velocity_x,velocity_y,velocity_z"[: 5 if name == "sheet" else None]
        np.savetxt(folder / f"{name}.csv", rows.T, delimiter=",", header=head, comments="")


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """The folder of the run on one process."""

    @functools.cache
    def run_alone():
        folder = tmp_path_factory.mktemp("torn")
        write_bodies(folder)
        go(0, TORN, folder)
        return folder / "out"

    return run_alone


@needs_mpirun
@pytest.mark.parametrize("n", [4, slow(2), slow(3)])
def test_cut_cells_do_not_depend_on_processes(n, alone, tmp_path):
    write_bodies(tmp_path)
    go(n, TORN, tmp_path)
    equal_runs(alone(), tmp_path / "out")
    state = arrays(sorted((tmp_path / "out").glob("chk_??????.h5"))[-1])
    x = state["solid/x"][-216:]
    assert (np.abs(x - CORNER).max(axis=0) > 0.02).all()
    if n == 4:  # they meet where the cube is
        assert {tuple(box[3:5]) for box in state["air/boxes"].reshape(-1, 6)} >= {(24, 24)}


@needs_mpirun
@pytest.mark.parametrize(("n", "m"), [(2, 3), slow(0, 3), slow(4, 0)])
def test_cut_cells_go_on_on_other_processes(n, m, alone, tmp_path):
    write_bodies(tmp_path)
    (tmp_path / "deck.nml").write_text(TORN)
    for ranks, *more in ((n, "--set", "run.max_steps=35"), (m, "--restart", "latest")):
        done = start(ranks, "run", "deck.nml", "--out", "out", *more, cwd=tmp_path)
        assert done.returncode in (0, 3), done.stderr
    equal_states(alone(), tmp_path / "out")


@needs_mpirun
def test_cut_cells_round_the_ends_do_not_depend_on_processes(tmp_path):
    """On one, three, and two that hand over to three."""
    assert ROUND.count("periodic") == 2
    assert "0.21, 0.39" in ROUND and "0.405" in ROUND
    write_bodies(tmp_path, UP)
    for n in (0, 3):
        go(n, ROUND, tmp_path, out=str(n))
    equal_runs(tmp_path / "0", tmp_path / "3")
    state = arrays(sorted((tmp_path / "3").glob("chk_??????.h5"))[-1])
    x = state["solid/x"][-216:, 1]
    assert x.min() < 0.39 and x.max() > 0.41
    boxes = state["air/boxes"].reshape(-1, 6)
    assert (boxes[:, 1] == 1).all() and (boxes[:, 4] == 40).all()
    for n, *more in ((2, "--set", "run.max_steps=35"), (3, "--restart", "latest")):
        done = start(n, "run", "deck.nml", "--out", "2", *more, cwd=tmp_path)
        assert done.returncode in (0, 3), done.stderr
    equal_states(tmp_path / "0", tmp_path / "2")


# A disc that flies through the boxes of three; bodies that are bonded, and that sleep.
SHORT = {"disc": 400, "two_plates": 150, "struck_fragment": 60, "panel": 40}


@needs_mpirun
@pytest.mark.parametrize("name", ["disc", "two_plates", slow("struck_fragment"), slow("panel")])
def test_scenes_with_cut_cells_give_the_same(name, tmp_path):
    deck = (ROOT / f"tests/scenes/{name}.nml").read_text()
    for n in (0, 3):
        go(n, deck, tmp_path, "--set", f"run.max_steps={SHORT[name]}", "--set",
           "output.history_every=0", out=str(n))  # fmt: skip
    equal_states(tmp_path / "0", tmp_path / "3")
