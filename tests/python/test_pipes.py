# SPDX-License-Identifier: MIT
"""Pipes on layered lattices: loads, bonds, contact, air, restarts, processes, the GPU; hollow
spheres."""

import subprocess

import numpy as np
import pytest
from notes import note
from test_gpu import EMULATOR, follows_the_cpu
from test_loads import BRISANCE, run
from test_ranks import equal_bodies, in_two, needs_mpirun, start
from test_run import history
from tiers import slow

METAL = """\
&material id='m', model='bilinear_j2', density=7800, youngs_modulus=200e9, poisson_ratio=0.3,
    yield_stress=350e6, tangent_modulus=1e9 /
"""
LAYERED = "shape='cylinder', lattice='layered', spacing=1e-3, material='m', centre=0,0,0,"
# Two pipes, one bonded around the other, burst from within, under a blast from outside; a block is
# thrown at them.
PIPES = f"""\
&run title='pipes', t_end=6e-6, symmetry='z' /
{METAL}
&body id='in', {LAYERED} radius=0.008, inner_radius=0.005, length=0.012 /
&body id='out', {LAYERED} radius=0.011, inner_radius=0.008, length=0.012 /
&body id='block', box=0.0113,0.0153, -0.003,0.003, 0,0.006, spacing=1e-3, material='m',
    velocity=-80,0,0 /
&interaction law='contact' /
&interaction bodies='in','out', law='bonded' /
&load body='in', faces='inside', time=0,4e-6,8e-6, pressure=3e8,3e8,0 /
&load body='out', faces='outside', mass=1e-3, at=-0.05,0,0, detonation_time=-1e-5 /
&gauge id='x', body='out', at=-0.011,0,0, quantity='displacement_x' /
&gauge id='y', body='in', at=0,0.005,0, quantity='displacement_y' /
&output history_every=0, checkpoint_every=2e-6, dump_every=4e-6 /
"""


@pytest.fixture(name="alone", scope="module")
def _alone(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pipes")
    (folder / "deck.nml").write_text(PIPES)
    done = start(0, "run", "deck.nml", "--out", "out", cwd=folder)
    assert done.returncode == 0, done.stderr
    values = history(folder / "out/gauges.csv")
    assert all(np.abs(values[name]).max() > 0 for name in values.dtype.names)
    error = np.abs(history(folder / "out/energy.csv")["error[-]"]).max()
    note("pipes_energy", error)
    assert error < 5e-3
    return folder / "out"


@pytest.mark.long("runs on several processes")
@needs_mpirun
def test_pipes_on_several_processes(alone, tmp_path):
    """The bytes of one run on one process."""
    (tmp_path / "deck.nml").write_text(PIPES)
    done = start(3, "run", "deck.nml", "--out", "out", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    equal_bodies(alone, tmp_path / "out")


@pytest.mark.long("runs on several processes")
@needs_mpirun
@pytest.mark.parametrize(("n", "m"), [(0, 0), slow(2, 4)])
def test_pipes_go_on_after_a_restart(n, m, alone, tmp_path):
    (tmp_path / "deck.nml").write_text(PIPES)
    in_two(n, m, 30, tmp_path)
    equal_bodies(alone, tmp_path / "out")


@pytest.mark.skipif(not EMULATOR.exists(), reason="make emulator builds it")
def test_pipes_on_the_gpu(alone, tmp_path):
    (tmp_path / "deck.nml").write_text(PIPES)
    follows_the_cpu(alone, tmp_path)


def test_a_pipe_in_a_blast(tmp_path):
    """It runs to its end, pushed along, and its energy closes."""
    deck = """\
&run t_end=6e-4, symmetry='z' /
{metal}
&air box=0,0.5, -0.15,0.15, 0,0.1, cells=40,24,8, density=1.2, pressure=1e5 /
&inflow face='x-', time=2e-5,4e-5,3e-4, overpressure=8e5,6e5,0 /
&body id='b', shape='cylinder', lattice='layered', axis='z', centre=0.2,0,0, radius=0.06,
    inner_radius=0.036, length=0.16, spacing=8e-3, material='m' /
&output history_every=1e-5, dump_every=1 /
"""
    (tmp_path / "deck.nml").write_text(deck.format(metal=METAL))
    done = start(0, "run", "deck.nml", "--out", "out", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    bodies = history(tmp_path / "out" / "bodies.csv")
    assert bodies["b:velocity_x[m/s]"][-1] > 0
    energy = history(tmp_path / "out" / "energy.csv")
    assert np.abs(energy["error[-]"]).max() < 5e-3


BAD = {
    "radius=0.008, lattice='layered'": "with an inner_radius",
    "radius=0.008, inner_radius=0.006, lattice='layered'": "less than three layers",
    "radius=0.008, inner_radius=0.0005, lattice='layered'": "at most the inner_radius",
    "radius=0.008, inner_radius=0.005, lattice='layered', formulation='bending'": "tensile_control",
    "radius=0.008, inner_radius=0.005, lattice='layered', plate_axis='x'": "radial normals",
    "radius=0.008, inner_radius=0.005, lattice='layered', variable_h=T": "leave variable_h out",
    "radius=0.008, inner_radius=0.005, lattice='layered', centre=0.003,0,0": "through the axis",
    "radius=0.008, inner_radius=0.005, lattice='layered' /\n&load body='b', faces='x+', pressure=1":
        "inside and outside of its wall",
    "radius=0.008, inner_radius=0.005 /\n&load body='b', faces='inside', pressure=1":
        "are faces of a body with lattice='layered'",
    "radius=0.008, inner_radius=0.005, lattice='layered' /\n"
    "&load body='b', faces='inside', mass=1, at=0,0,0": "compute the air",
}  # fmt: skip


@pytest.mark.parametrize("keys", BAD)
def test_what_no_layers_fill_is_refused(keys, tmp_path):
    centre = "" if "centre" in keys else "centre=0,0,0, "
    (tmp_path / "bad.nml").write_text(
        f"&run t_end=1e-6, symmetry='x' /\n{METAL}&body id='b', shape='cylinder', {centre}"
        f"length=0.01, spacing=1e-3, material='m', {keys} /\n"
    )
    done = subprocess.run([BRISANCE, "run", "bad.nml"], cwd=tmp_path, capture_output=True,
                          text=True)  # fmt: skip
    assert done.returncode == 2 and BAD[keys] in done.stderr, done.stderr
    assert "bad.nml:" in done.stderr


def test_check_names_the_wall(tmp_path):
    (tmp_path / "deck.nml").write_text(PIPES)
    done = start(0, "run", "deck.nml", "--check", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "a wall round z" in done.stdout
    assert "a bar along" not in done.stdout


HOLLOW = """\
&run t_end=7e-5, symmetry='x','y','z' /
&material id='s', model='linear_elastic', density=7800, youngs_modulus=200e9, poisson_ratio=0.3 /
&body id='b', shape='sphere', centre=0,0,0, radius=0.02, inner_radius=0.015, spacing=1.25e-3,
    material='s' /
&load body='b', faces='x+','y+','z+', time=0,4e-5,1, pressure=0,1e7,1e7 /
&gauge id='out', body='b', at=0.02,0,0, quantity='displacement_x' /
&gauge id='in', body='b', at=0.015,0,0, quantity='displacement_x' /
&output history_every=1e-6 /
"""


def test_a_hollow_sphere_under_pressure(tmp_path):
    """Its mass is exact; its surfaces go in as Lame says, four layers in the wall."""
    inner, outer = 0.015, 0.02
    tables = run(tmp_path, HOLLOW)
    assert tables["bodies"]["b:mass[kg]"][0] == pytest.approx(
        7800 * np.pi / 6 * (outer**3 - inner**3), rel=1e-12
    )
    gauges = {name.split(":")[0]: values for name, values in tables["gauges"].items()}
    late = gauges["time[s]"] > 4.6e-5  # the wall breathes about its place
    for name, r in (("out", outer), ("in", inner)):
        lame = -1e7 * outer**3 / (outer**3 - inner**3) * (0.4 * r + 1.3 * inner**3 / (2 * r**2))
        ratio = gauges[name][late].mean() / (lame / 200e9)
        note(f"hollow_sphere_{name}", ratio)
        assert ratio == pytest.approx(1, abs=0.04)


def test_a_sphere_as_hollow_as_it_is_wide_is_refused(tmp_path):
    (tmp_path / "bad.nml").write_text(HOLLOW.replace("inner_radius=0.015", "inner_radius=0.02"))
    done = subprocess.run([BRISANCE, "run", "bad.nml"], cwd=tmp_path, capture_output=True,
                          text=True)  # fmt: skip
    assert done.returncode == 2 and "bad.nml:3:" in done.stderr, done.stderr
    assert "leaves nothing of the radius" in done.stderr
