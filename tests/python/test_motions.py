# SPDX-License-Identifier: MIT
"""Several motions of one body: &motion on regions of it."""

import subprocess

import numpy as np
import pytest
from notes import note
from test_gpu import EMULATOR, follows_the_cpu
from test_loads import BRISANCE, run
from test_ranks import equal_bodies, in_two, needs_mpirun, start
from test_run import history
from tiers import slow

STEEL = """\
&material id='s', model='linear_elastic', density=7800, youngs_modulus=200e9, poisson_ratio=0.3 /
"""
BAR = (
    "&run t_end=2e-4 /\n"
    + STEEL
    + """\
&body id='bar', box=0,0.04, 0,0.004, 0,0.004, spacing=1e-3, material='s' /
&motion id='low', body='bar', box=0,0.001, 0,0.004, 0,0.004, axes='x', time=0,1e-4,2e-4,
    velocity=0,0,0, -0.1,0,0, 0,0,0 /
&motion id='high', body='bar', box=0.039,0.04, 0,0.004, 0,0.004, axes='x', time=0,1e-4,2e-4,
    velocity=0,0,0, 0.3,0,0, 0,0,0 /
&gauge id='low', body='bar', motion='low', quantity='reaction_x' /
&gauge id='high', body='bar', motion='high', quantity='reaction_x' /
&gauge id='both', body='bar', quantity='reaction_x' /
&gauge id='u_low', body='bar', at=0,0,0, quantity='displacement_x' /
&gauge id='u_high', body='bar', at=0.04,0,0, quantity='displacement_x' /
&output history_every=0 /
"""
)


def gauges(tables):
    return {name.split(":")[0]: column for name, column in tables["gauges"].items()}


def lost(energy):
    """What the energy of a run misses at most, over the largest that it has had."""
    total = energy["total[J]"]
    return np.abs(total - total[0]).max() / energy["energy_scale[J]"].max()


def test_a_bar_is_pulled_at_both_ends(tmp_path):
    """Each end goes as it is told; in the end the bar pulls with E A times its strain."""
    tables = run(tmp_path, BAR)
    g = gauges(tables)
    assert g["u_low"][-1] == pytest.approx(-1e-5, rel=1e-9)
    assert g["u_high"][-1] == pytest.approx(3e-5, rel=1e-9)
    # the body pulls the high end down; waves that still run make up some of it
    exact = 200e9 * 16e-6 * 4e-5 / 0.039
    late = g["high"].size * 9 // 10
    force = [-g["high"][late:].mean() / exact, g["low"][late:].mean() / exact]
    note("motion_force_low", force[1])
    note("motion_force_high", force[0])
    assert force == pytest.approx([1, 1], rel=0.03)
    assert g["low"] + g["high"] == pytest.approx(g["both"], abs=1e-9 * exact)
    error = lost(tables["energy"])
    note("motion_energy", error)
    assert error < 1e-3


BEND = (
    "&run t_end=1.5e-3, dimension=2 /\n"
    + STEEL
    + """\
&body id='beam', box=-0.05,0.05, -0.005,0.005, 0,1, spacing=2e-3, material='s' /
&motion id='left', body='beam', box=-0.0401,-0.038, -1,1, -1,2, axes='y', velocity=0,0,0 /
&motion id='right', body='beam', box=0.038,0.0401, -1,1, -1,2, axes='y', velocity=0,0,0 /
&motion id='ram', body='beam', box=-0.0021,0.0021, -1,1, -1,2, axes='y', time=0,6e-4,1.2e-3,
    velocity=0,0,0, 0,-0.2,0, 0,0,0 /
&gauge id='ram', body='beam', motion='ram', quantity='reaction_y' /
&gauge id='left', body='beam', motion='left', quantity='reaction_y' /
&gauge id='right', body='beam', motion='right', quantity='reaction_y' /
&gauge id='mid', body='beam', at=0,0,0, quantity='displacement_y' /
&gauge id='end', body='beam', at=-0.039,-0.005,0, quantity='displacement_x' /
&output history_every=1e-6 /
"""
)


def test_three_point_bending(tmp_path):
    """Two rollers of the beam and a ram, all motions of it, against Timoshenko's beam: the ram
    holds two columns of particles, so that each arm is shorter by half a spacing."""
    g = gauges(run(tmp_path, BEND))
    modulus, shear, height = 200e9 / (1 - 0.3**2), 200e9 / 2.6, 0.01
    arm = 0.039 - 0.001
    # half of the beam is a cantilever that is clamped where the ram is
    give = 4 * arm**3 / (modulus * height**3) + 1.2 * arm / (shear * height)
    assert g["mid"][-1] == pytest.approx(-1.2e-4, rel=1e-6)
    exact = 2 * 1.2e-4 / give
    late = g["ram"].size * 4 // 5  # one period, 0.3 ms, after the ram has stopped
    ratio = g["ram"][late:].mean() / exact
    note("motion_bending", ratio)
    assert ratio == pytest.approx(1, abs=0.05)
    for side in ("left", "right"):
        assert g[side][late:].mean() == pytest.approx(-g["ram"][late:].mean() / 2, rel=1e-2)
    assert g["end"][-1] == pytest.approx(-1.5 * 1.2e-4 / arm * 4e-3, rel=0.1)  # free along the beam


BAD = {
    "id='m', body='c', box=0,1,0,1,0,1, velocity=1,0,0": "there is no &body with id='c'",
    "id='m', body='b', box=0,0.001,0,1,0,1, velocity=1,0": "expects 3 to 192 numbers",
    "id='m', body='b', box=0,0.001,0,1,0,1, time=0,1, velocity=1,0,0": "3 numbers for 2 times",
    "id='m', body='b', box=0,0.001,0,1,0,1, time=1,0, velocity=1,0,0,2,0,0": "must grow",
    "id='m', body='b', box=0,0.001,0,1,0,1, axes='y', velocity=1,0,0": "are free along 'x'",
    "id='m', body='b', box=5,6,0,1,0,1, velocity=1,0,0": "no particle of the body",
    "id='m', body='b', box=0.003,0.01,0,1,0,1, velocity=1,0,0": "a support (fix, fix_box, roller",
    "id='m', body='b', box=0,0.002,0,1,0,1, velocity=1,0,0 /\n"
    "&motion id='n', body='b', box=0.001,0.002,0,1,0,1, velocity=1,0,0": "to &motion id='m', too",
    "id='m', body='r', box=0,1,0,1,0,1, velocity=1,0,0": "regions of a rigid body",
    "id='m', body='d', box=0.01,0.012,0,1,0,1, velocity=1,0,0": "make that a &motion, too",
}


@pytest.mark.parametrize("keys", BAD)
def test_bad_motions(tmp_path, keys):
    deck = (
        "&run t_end=1e-6 /\n"
        + STEEL
        + """\
&body id='b', box=0,0.004, 0,0.002, 0,0.002, spacing=1e-3, material='s',
    fix_box=0.003,1,-1,1,-1,1 /
&body id='r', box=0.006,0.008, 0,0.002, 0,0.002, spacing=1e-3, material='s',
    formulation='rigid' /
&body id='d', box=0.01,0.014, 0,0.002, 0,0.002, spacing=1e-3, material='s', fix='x+',
    motion_time=0,1, motion_velocity=1,0,0,1,0,0 /
"""
        + f"&motion {keys} /\n"
    )
    (tmp_path / "bad.nml").write_text(deck)
    done = subprocess.run([BRISANCE, "run", "bad.nml"], cwd=tmp_path, capture_output=True,
                          text=True)  # fmt: skip
    assert done.returncode == 2 and BAD[keys] in done.stderr, done.stderr
    assert "bad.nml:" in done.stderr


@pytest.mark.parametrize(("axis", "told"), [("x", True), ("y", False)])
def test_a_motion_across_a_plane_of_symmetry_is_told(tmp_path, axis, told):
    """What lies at the plane and leaves it tears the body from its mirror image."""
    (tmp_path / "case.nml").write_text(
        f"&run t_end=1e-6, symmetry='{axis}' /\n"
        + STEEL
        + "&body id='b', box=0,0.004, 0,0.002, 0,0.002, spacing=5e-4, material='s' /\n"
        "&motion id='m', body='b', box=0,0.001,0,1,0,1, axes='x', velocity=1,0,0 /\n"
        "&motion id='n', body='b', box=0.003,0.004,0,1,0,1, axes='x', velocity=1,0,0 /\n"
    )
    done = subprocess.run([BRISANCE, "run", "case.nml", "--check"], cwd=tmp_path,
                          capture_output=True, text=True)  # fmt: skip
    text = "case.nml:4: warning: &motion id='m': the plane of symmetry x=0 cuts a region "
    assert done.returncode == 0 and (text in done.stderr) == told, done.stderr
    assert "'n'" not in done.stderr


# Held, on a roller, bent and twisted by two motions, pressed on one of them, met by a block that a
# motion draws
MOVED = (
    "&run title='moved', t_end=1.4e-5, energy_band=0.5 /\n"
    + STEEL
    + """\
&body id='b', box=0,0.02, 0,0.006, 0,0.006, spacing=1e-3, material='s',
    fix_box=0,0.002,-1,1,-1,1, roller_box=0.008,0.009,-1,0.001,-1,1, roller_axis='y' /
&body id='c', box=0.012,0.018, 0.00605,0.01005, 0,0.006, spacing=1e-3, material='s' /
&motion id='turn', body='b', box=0.018,0.021,0.004,1,-1,1, time=0,1e-5, velocity=0,0,0, 3,-9,12 /
&motion id='bend', body='b', box=0.018,0.021,-1,0.002,-1,1, axes='z', time=0,2e-5,
    velocity=0,0,2, 0,0,-14 /
&motion id='draw', body='c', box=0,1,0.009,1,-1,1, axes='y', velocity=0,-12,0 /
&load body='b', faces='x+', pressure=2e8 /
&gauge id='turn', body='b', motion='turn', quantity='reaction_y' /
&gauge id='bend', body='b', motion='bend', quantity='reaction_z' /
&gauge id='draw', body='c', motion='draw', quantity='reaction_y' /
&gauge id='all', body='b', quantity='reaction_z' /
&gauge id='x', body='b', at=0.02,0,0, quantity='displacement_x' /
&output history_every=0, checkpoint_every=2.5e-6, dump_every=5e-6 /
"""
)


@pytest.fixture(name="alone", scope="module")
def _alone(tmp_path_factory):
    folder = tmp_path_factory.mktemp("moved")
    (folder / "deck.nml").write_text(MOVED)
    done = start(0, "run", "deck.nml", "--out", "out", cwd=folder)
    assert done.returncode == 0, done.stderr
    values = history(folder / "out/gauges.csv")
    assert all(np.abs(values[name]).max() > 0 for name in values.dtype.names)
    error = lost(history(folder / "out/energy.csv"))
    note("motions_energy", error)
    assert error < 1e-3
    return folder / "out"


@needs_mpirun
@pytest.mark.parametrize("n", [3, slow(2), slow(4)])
def test_motions_do_not_depend_on_processes(n, alone, tmp_path):
    (tmp_path / "deck.nml").write_text(MOVED)
    done = start(n, "run", "deck.nml", "--out", "out", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    equal_bodies(alone, tmp_path / "out")
    assert (tmp_path / "out/gauges.csv").read_text() == (alone / "gauges.csv").read_text()


@needs_mpirun
@pytest.mark.parametrize(("n", "m"), [(2, 0), slow(0, 0), slow(0, 4)])
def test_motions_go_on_after_a_restart(n, m, alone, tmp_path):
    (tmp_path / "deck.nml").write_text(MOVED)
    in_two(n, m, 60, tmp_path)
    equal_bodies(alone, tmp_path / "out")
    assert (tmp_path / "out/gauges.csv").read_text() == (alone / "gauges.csv").read_text()


@pytest.mark.skipif(not EMULATOR.exists(), reason="make emulator builds it")
def test_motions_on_the_gpu(alone, tmp_path):
    (tmp_path / "deck.nml").write_text(MOVED)
    follows_the_cpu(alone, tmp_path)
