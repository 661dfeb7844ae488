# SPDX-License-Identifier: MIT
"""Gauges of the air beside a body: what the body feels there."""

import numpy as np
import pytest
from notes import note
from test_gpu import EMULATOR, stamp
from test_gpu import run as on_gpu
from test_loads import run
from test_ranks import needs_mpirun, start
from tiers import slow

WAVES = {
    "shock": "time=0,1, overpressure=3e5,3e5",
    "blast": "time=0,2e-4, overpressure=2e6,0",
}
TUBE = """\
&run t_end=1.2e-3, dimension=1 /
&air box=0,1, 0,1, 0,1, cells={n},1,1 /
&inflow face='x-', {wave} /
&material id='m', model='linear_elastic', density=2000, youngs_modulus=1e9, poisson_ratio=0.3 /
&body id='b', box={x},{end}, 0,1, 0,1, spacing={dx}, material='m', formulation='rigid', fix='all' /
&gauge id='b', body='b', quantity='impulse_x' /
"""
SIDES = {"face": 0, "middle": 0.5, "inside": -0.4}  # cells before the body


@pytest.mark.parametrize("wave", WAVES)
@pytest.mark.parametrize("shift", [0, 0.3, 0.7])  # of the body against the cells, in cells
def test_impulse_beside_a_wall(tmp_path, wave, shift):
    """The overpressure up to half a cell before a body has the impulse that the body takes. What is
    left is the sum over steps, of either sign, and falls with them."""
    errors = []
    for n in (50, 200):
        x = 0.6 + shift / n
        deck = TUBE.format(n=n, wave=WAVES[wave], x=x, end=x + 0.1, dx=0.25 / n)
        for name, cells in SIDES.items():
            deck += f"&gauge id='{name}', at={x - cells / n},0.5,0.5, quantity='overpressure' /\n"
        table = run(tmp_path, deck, "--replace")["gauges"]
        time = table["time[s]"]
        taken = table["b:impulse_x[N s]"][-1]
        seen = [np.diff(time) @ (p[1:] + p[:-1]) / 2
                for p in (table[f"{name}:overpressure[Pa]"] for name in SIDES)]  # fmt: skip
        errors.append(max(abs(np.array(seen) / taken - 1)))
        note(f"wall_gauge_{wave}_{shift}_{n}", errors[-1])
    assert errors[1] < errors[0] < 2e-3


PLATE = """\
&run title='Burst beside a plate that gives way', t_end=1.5e-4 /
&air box=0,0.16, 0,0.16, -0.08,0.16, cells=16,16,24,
    bc='symmetry','outflow','symmetry','outflow','outflow','outflow' /
&gas id='hot', box=0,0.06, 0,0.06, 0.06,0.12, density=8, pressure=1e7 /
&material id='m', model='linear_elastic', density=300, youngs_modulus=1e8, poisson_ratio=0.3 /
&body id='plate', box=0,0.12, 0,0.12, -0.02,0, spacing=5e-3, material='m',
    velocity=0,0,-90 /
&gauge id='front', at=0.005,0.005,0.001, quantity='overpressure' /
&gauge id='edge', at=0.118,0.02,0.004, quantity='pressure' /
&gauge id='behind', at=0.031,0.022,-0.024, quantity='velocity_z' /
&gauge id='inside', at=0.031,0.052,-0.011, quantity='pressure' /
&gauge id='side', at=0.124,0.052,-0.011, quantity='density' /
&gauge id='far', at=0.08,0.02,0.08, quantity='pressure' /
&output history_every=0, checkpoint_every=6e-5 /
"""


CROSS = """\
&run title='A plate across the cuts between processes', t_end=8e-5 /
&air box=0,0.16, 0,0.16, -0.13,0.11, cells=16,16,24,
    bc='symmetry','outflow','symmetry','outflow','outflow','outflow' /
&gas id='hot', box=0,0.06, 0,0.06, 0.05,0.1, density=8, pressure=1e7 /
&material id='m', model='linear_elastic', density=300, youngs_modulus=1e8, poisson_ratio=0.3 /
&body id='plate', box=0.02,0.12, 0.01,0.13, -0.035,0.015, spacing=0.01, material='m',
    velocity=40,-20,-90, spin=0,0,300 /
&body id='post', box=0,0.01, 0,0.01, -0.05,0.03, spacing=0.01, material='m', velocity=0,0,-200 /
{gauges}&output history_every=0 /
"""


def gauges_across():
    """Gauges in and around the bodies: at random, in the middle of cells, and on the edge of the
    air, where two of eight cells count; some average over a box that bodies and processes share."""
    dice = np.random.default_rng(11)
    at = np.array([dice.uniform([0, 0, -0.05], [0.15, 0.15, 0.03]) for _ in range(60)])
    at[::3] = np.floor(at[::3] * 100) / 100 + 0.005
    at[1::3] = [[0, 0, z] for z in np.linspace(-0.075, -0.04, 20)]
    names = ("pressure", "density", "velocity_z")
    return "".join(
        f"&gauge id='g{k}', at={x:.4f},{y:.4f},{z:.4f}, quantity='{names[k % 3]}'"
        f"{', width=0.03' if k % 5 == 1 else ''} /\n"
        for k, (x, y, z) in enumerate(at)
    )


DECKS = {"gives way": PLATE, "across": CROSS.format(gauges=gauges_across())}


@pytest.fixture(name="alone", scope="module", params=[slow("gives way"), "across"])
def _alone(request, tmp_path_factory):
    """Gauges of a run on one process; the bodies move through more than a cell, 10 mm."""
    folder = tmp_path_factory.mktemp("alone")
    (folder / "deck.nml").write_text(DECKS[request.param])
    done = start(0, "run", "deck.nml", "--out", "out", cwd=folder)
    assert done.returncode == 0, done.stderr
    bodies = np.genfromtxt(folder / "out/bodies.csv", delimiter=",", names=True, deletechars="")
    ways = [bodies[name] for name in bodies.dtype.names if name.strip().endswith(":z[m]")]
    assert max(abs(z[-1] - z[0]) for z in ways) > 0.01
    return folder


def gauges(folder, out="out"):
    return (folder / out / "gauges.csv").read_text()


@pytest.mark.long("processes that wait for each other on two cores")
@needs_mpirun
@pytest.mark.parametrize("n", [slow(2), 3, slow(4)])
def test_wall_gauges_do_not_depend_on_processes(n, alone, tmp_path):
    """In solid a gauge has the nearest gas, which may be that of another process."""
    (tmp_path / "deck.nml").write_bytes((alone / "deck.nml").read_bytes())
    done = start(n, "run", "deck.nml", "--out", "out", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert gauges(tmp_path) == gauges(alone)


def test_wall_gauges_after_a_restart(alone, tmp_path):
    (tmp_path / "deck.nml").write_bytes((alone / "deck.nml").read_bytes())
    for args in (("--set", "run.max_steps=60"), ("--restart", "latest")):
        done = start(0, "run", "deck.nml", "--out", "out", *args, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
    assert gauges(tmp_path) == gauges(alone)


@pytest.mark.skipif(not EMULATOR.exists(), reason="make emulator builds it")
@pytest.mark.long("the emulated GPU, until the walls have moved through several cells")
def test_wall_gauges_on_the_gpu(alone, tmp_path):
    """The walls move, so that velocities of another row or another cell would be seen. All cells
    that gauges look at are fetched, also where one of eight counts and holds solid."""
    (tmp_path / "deck.nml").write_bytes((alone / "deck.nml").read_bytes())
    (tmp_path / "good.ptx").write_text(f"// {stamp()}\n")
    done = on_gpu(tmp_path, "deck.nml", "--out", "out", "--backend", "gpu")
    assert done.returncode == 0, done.stderr
    one, other = (np.loadtxt(f / "out/gauges.csv", delimiter=",", skiprows=1)
                  for f in (alone, tmp_path))  # fmt: skip
    assert one.shape == other.shape  # of those deep in a body all is zero
    assert (abs(one - other).max(axis=0) <= 1e-9 * abs(one).max(axis=0)).all()
