# SPDX-License-Identifier: MIT
"""Bodies in air on the GPU, here the emulated one."""

import h5py
import pytest
from test_gpu import follows_the_cpu, run, same, stamp
from test_run import history


@pytest.fixture(name="deck")
def _deck(tmp_path):
    (tmp_path / "good.ptx").write_text(f"// {stamp()}\n", encoding="utf-8")
    return tmp_path


COUPLED = """&run title='t', t_end=1.2e-4 /
&air box=0,1, 0,0.4, 0,0.3, cells=40,8,6, bc='outflow' /
&gas id='hot', box=0,0.3, 0,0.4, 0,0.3, density=3, pressure=2e6 /
&material id='m', model='linear_elastic', density=2000, youngs_modulus=1e6, poisson_ratio=0.3 /
&body id='b', shape='box', box=0.3,0.4, 0.12,0.28, 0.1,0.2, spacing=0.025, material='m',
      velocity=1500,200,0 /
&gauge id='g', at=0.61,0.23,0.17, quantity='overpressure' /
&output dump_every=1e-4, checkpoint_every=2e-5, history_every=5e-6 /
"""


def agree(deck, name):
    """A scene of air and bodies is the same on the GPU, where all of it runs, and on the CPU."""
    for backend in ("gpu", "cpu"):
        done = run(deck, name, "--backend", backend, "--out", backend)
        assert done.returncode == 0, done.stderr
        assert ("air and bodies run on Emulated" in done.stderr) == (backend == "gpu")
    same("gpu", "cpu", deck)


def cells(path):
    """Numbers of the cut cells of a checkpoint."""
    with h5py.File(path) as file:
        return file["coupling/cell"][:].tolist()


def test_bodies_in_air_move_as_on_the_cpu(deck):
    (deck / "f.nml").write_text(COUPLED, encoding="utf-8")
    agree(deck, "f.nml")
    listed = [set(cells(path)) for path in sorted((deck / "gpu").glob("chk_*.h5"))]
    # they follow the body
    assert len(listed[-1] - listed[0]) > 20 and len(listed[0] - listed[-1]) > 20
    first = ("--set", "run.max_steps=9", "--out", "parts")
    assert run(deck, "f.nml", "--backend", "gpu", *first).returncode == 0
    second = ("--restart", "latest", "--out", "parts")
    assert run(deck, "f.nml", "--backend", "gpu", *second).returncode == 0
    same("parts", "gpu", deck)


WOKEN = """&run title='t', t_end=5e-5 /
&air box=0,0.2, 0,0.05, 0,0.05, cells=40,10,10, bc='wall' /
&gas id='hot', box=0,0.06, 0,0.05, 0,0.05, density=60, pressure=4e7 /
&material id='cu', preset='ofhc_copper' /
&material id='ply', preset='cfrp_woven' /
&body id='plate', shape='box', box=0.075,0.08, 0,0.05, 0.01,0.04, spacing=0.0025, material='ply',
      plies='2*(0/90)', fix='y-', formulation='bending' /
&body id='block', shape='box', box=0.085,0.095, 0.015,0.035, 0.015,0.035, spacing=0.0025,
      material='cu' /
&body id='ball', shape='sphere', centre=0.1055,0.025,0.025, radius=0.005, spacing=0.0025,
      material='cu', formulation='rigid' /
&interaction law='contact', friction=0.2 /
&gauge id='g', body='block', at=0.09,0.025,0.025, quantity='velocity_x' /
&gauge id='inside', at=0.09,0.025,0.025, quantity='pressure' /
&output dump_every=3e-5, checkpoint_every=1e-5, history_every=2e-6 /
"""


@pytest.mark.slow
def test_bodies_wake_in_air_as_on_the_cpu(deck):
    (deck / "w.nml").write_text(WOKEN, encoding="utf-8")
    for backend in ("gpu", "cpu"):
        done = run(deck, "w.nml", "--backend", backend, "--out", backend)
        assert done.returncode == 0, done.stderr
    same("gpu", "cpu", deck)


@pytest.mark.long("the GPU is emulated")
def test_bodies_that_wake_go_on_on_either(deck):
    (deck / "w.nml").write_text(WOKEN, encoding="utf-8")
    done = run(deck, "w.nml", "--backend", "cpu", "--out", "cpu")
    assert done.returncode == 0, done.stderr
    steps = 0
    for backend in ("cpu", "gpu", "cpu", "gpu"):
        steps += 10
        restart = ("--restart", "latest") if steps > 10 else ()
        more = ("--set", f"run.max_steps={steps}") if steps < 40 else ()
        done = run(deck, "w.nml", "--backend", backend, "--out", "parts", *more, *restart)
        assert done.returncode == 0, done.stderr
    same("parts", "cpu", deck)


# blocks that lie on each other, bonded or not, sleep until the wave comes; lists are built before,
# for a block that turns beside them (at this rate once, a few steps before they wake)
PILE = """&run title='t', t_end=1, max_steps=60, dimension=2 /
&air box=0,0.2, 0,0.1, 0,1, cells=40,20,1, bc='wall', ramp_steps=0 /
&gas id='hot', box=0,0.02, 0,0.1, 0,1, density=60, pressure=4e7 /
&material id='m', model='linear_elastic', density=1500, youngs_modulus=3e8, poisson_ratio=0.3 /
&body id='a', box=0.06,0.08, 0.02,0.05, 0,1, spacing=0.0025, material='m' /
&body id='b', box=0.08,0.1, 0.02,0.05, 0,1, spacing=0.0025, material='m' /
&body id='c', box=0.06,0.1, 0.05,0.06, 0,1, spacing=0.0025, material='m' /
&body id='d', box=0.185,0.195, 0.02,0.03, 0,1, spacing=0.0025, material='m', spin=0,0,8e3 /
&interaction law='contact', friction=0.2 /
&interaction bodies='a','b', law='bonded' /
&gauge id='c', body='c', quantity='contact_y' /
&output history_every=0 /
"""


def test_what_lies_on_what_sleeps_presses_once_it_wakes(deck):
    (deck / "deck.nml").write_text(PILE, encoding="utf-8")
    done = run(deck, "deck.nml", "--backend", "cpu", "--out", "cpu")
    assert done.returncode == 0, done.stderr
    follows_the_cpu(deck / "cpu", deck)
    bodies, gauges = (history(deck / "cpu" / f"{name}.csv") for name in ("bodies", "gauges"))
    energy = bodies["b:kinetic[J]"]
    assert energy[5] < 1e-20 and energy[-1] > 0.1  # it sleeps, and is pushed
    assert abs(gauges["c:contact_y[N]"]).max() > 1e3


CUT = """&run title='t', t_end=1.2e-4, dimension=2 /
&air box=0,0.16, 0,0.08, 0,1, cells=64,32,1,
     bc='outflow','outflow','wall','wall','outflow','outflow' /
&gas id='shock', box=0,0.03, 0,0.08, 0,1, density=3.266667, pressure=455962.5,
     velocity=425.3672,0,0 /
&material id='m', model='linear_elastic', density=20, youngs_modulus=1e9, poisson_ratio=0.3 /
&body id='disc', shape='sphere', centre=0.051,0.043,0, radius=0.011, spacing=1.25e-3, material='m',
      formulation='rigid' /
&body id='held', shape='box', box=0.085,0.0875, 0.01,0.07, 0,1, spacing=1.25e-3, material='m',
      fix='all' /
&body id='driven', shape='box', box=0.12,0.13, 0.03,0.05, 0,1, spacing=1.25e-3, material='m',
      formulation='rigid', motion_time=0,1, motion_velocity=-150,40,0, -150,40,0 /
&gauge id='g', at=0.066,0.043,0.5, quantity='overpressure' /
&output dump_every=6e-5, checkpoint_every=2e-5, history_every=5e-6 /
"""


def test_walls_run_through_cells_as_on_the_cpu(deck):
    (deck / "c.nml").write_text(CUT, encoding="utf-8")
    agree(deck, "c.nml")
    steps = 0
    for backend in ("gpu", "gpu", "cpu", "gpu"):
        steps += 15
        restart = ("--restart", "latest") if steps > 15 else ()
        more = ("--set", f"run.max_steps={steps}") if steps < 60 else ()
        done = run(deck, "c.nml", "--backend", backend, "--out", "parts", *more, *restart)
        assert done.returncode == 0, done.stderr
    same("parts", "gpu", deck)
