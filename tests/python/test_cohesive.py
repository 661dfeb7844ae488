# SPDX-License-Identifier: MIT
"""Cohesive interfaces through whole runs: cantilevers that split, restarts, what is refused."""

import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest
from notes import note
from test_gpu import run as on_gpu
from test_gpu import stamp

BRISANCE = Path(__file__).parents[2] / "bin" / "brisance"

YOUNG, POISSON, GI, HIGH, START = 60e9, 0.3, 500.0, 0.006, 0.025
BEAM = """\
&run t_end={end}, dimension=2 /
&material id='m', model='linear_elastic', density=1600, youngs_modulus=60e9, poisson_ratio=0.3 /
&body id='low', box=0,0.07, -0.006,0, 0,1, spacing={dx}, material='m',
  fix_box=0,{dx}, -0.0042,-0.0033, 0,1,
  motion_time=0,{ramp},{end}, motion_velocity=0,0,0, 0,-{v},0, 0,-{v},0 /
&body id='high', box=0,0.07, 0,0.006, 0,1, spacing={dx}, material='m',
  fix_box=0,{dx}, 0.0018,0.0027, 0,1,
  motion_time=0,{ramp},{end}, motion_velocity=0,0,0, 0,{v},0, 0,{v},0 /
&interaction bodies='low','high', law='cohesive', tensile_strength=60e6, shear_strength=60e6,
  gi=500, gii=1000, open_box=0,0.02575,-1,1,0,1 /
&output history_every={every}, dump_every=1 /
"""

# two rigid blocks, the upper one lifted by 60 um: 20 mm of glue with 30 J/m2
PEEL = """\
&run t_end=2.2e-3, dimension=2 /
&material id='m', model='linear_elastic', density=1000, youngs_modulus=1e9, poisson_ratio=0.3 /
&body id='a', box=0,0.02, 0,0.01, 0,1, spacing=0.001, material='m', fix='y-' /
&body id='b', box=0,0.02, 0.01,0.02, 0,1, spacing=0.001, material='m', formulation='rigid',
  motion_time=0,1, motion_velocity=0,0.05,0, 0,0.05,0 /
&interaction bodies='a','b', law='cohesive', tensile_strength=1e6, shear_strength=2e6,
  gi=30, gii=60 /
&output history_every=2e-5, dump_every=1, checkpoint_every=3e-4 /
"""


def run(folder, deck, *args, code=0):
    (folder / "glue.nml").write_text(deck)
    done = subprocess.run(
        [BRISANCE, "run", "glue.nml", *args], cwd=folder, capture_output=True, text=True
    )
    assert done.returncode == code, done.stdout + done.stderr
    return done


def table(folder, name, out="out/glue"):
    return np.genfromtxt(
        folder / out / f"{name}.csv", delimiter=",", names=True, deletechars="", replace_space=" "
    )


@pytest.mark.long("the beam opens slowly")
def test_double_cantilever_beam(tmp_path):
    """Load of a crack of 30 mm by corrected beam theory (5 %); work = held + spent."""
    end, v = 1e-3, 0.42
    run(tmp_path, BEAM.format(end=end, ramp=end / 5, v=v, dx=0.0015, every=end / 400))
    energy = table(tmp_path, "energy")
    work, spent = energy["drive_work[J]"], energy["bond_heat[J]"]
    crack = START - 0.00075 + spent / GI  # from the load on
    load = np.gradient(work, energy["time[s]"]) / 2 / v
    shear = YOUNG / (2 * (1 + POISSON))
    gamma = 1.18 * YOUNG / shear
    chi = np.sqrt(YOUNG / (11 * shear) * (3 - 2 * (gamma / (1 + gamma)) ** 2))
    modulus = YOUNG / (1 - POISSON**2)
    exact = np.sqrt(GI * modulus * HIGH**3 / 12) / (crack + chi * HIGH)
    near = (crack > 0.028) & (crack < 0.032)
    assert np.count_nonzero(near) > 20
    ratio = float(np.mean(load[near] / exact[near]))
    note("cantilever_glued", ratio)
    assert ratio == pytest.approx(1, abs=0.05)
    assert abs(energy["error[-]"][-1]) < 1e-4
    broken = table(tmp_path, "bodies")["low+high:broken[m2]"][-1]
    assert spent[-1] == pytest.approx(GI * broken, rel=0.35)  # the zone besides
    assert spent[-1] > GI * broken


SLIDE = """\
&run t_end=1.3e-3, dimension=2 /
&material id='m', model='linear_elastic', density=1600, youngs_modulus=60e9, poisson_ratio=0.3 /
&body id='low', box=0,0.0645, -0.006,0, 0,1, spacing=0.0015, material='m', fix='x+' /
&body id='high', box=0,0.0645, 0,0.006, 0,1, spacing=0.0015, material='m', fix='x+' /
&body id='pin', box=0,0.003, 0.006,0.009, 0,1, spacing=0.0015, material='m', formulation='rigid',
  motion_time=0,5e-4,2e-3, motion_velocity=0,0,0, 0,-1,0, 0,-1,0 /
&interaction bodies='low','high', law='cohesive', tensile_strength=60e6, shear_strength=60e6,
  gi=500, gii=1000, open_box=0,0.04075,-1,1,0,1 /
&output history_every=5e-6, dump_every=1 /
"""


@pytest.mark.slow
def test_end_loaded_split_beam(tmp_path):
    """A clamped beam with a crack along its middle, pressed at its free end: half of an end-notched
    flexure. G_II = 9 P^2 (a + 0.42 chi h)^2/(4 E b^2 h^3), 5 %; the arms slide on each other.
    """
    run(tmp_path, SLIDE)
    energy = table(tmp_path, "energy")
    spent = energy["bond_heat[J]"]
    crack = 0.04 - 0.0015 + spent / 1000  # from the pin on
    load = np.gradient(energy["drive_work[J]"], energy["time[s]"])
    modulus = YOUNG / (1 - POISSON**2)
    exact = np.sqrt(1000 * 4 * modulus * HIGH**3 / 9) / (crack + 0.42 * 0.663 * HIGH)
    grows = (crack > 0.0415) & (crack < 0.0485)
    assert np.count_nonzero(grows) > 10
    ratio = float(np.mean(load[grows] / exact[grows]))
    note("split_beam_glued", ratio)
    assert ratio == pytest.approx(1, abs=0.05)
    assert abs(energy["error[-]"][-1]) < 5e-3
    assert energy["contact[J]"][-1] > 0


# both arms pulled up by rigid pins under ears of theirs, the far end held; 1.0 and 0.25 of a speed
MIXED = """\
&run t_end={end}, dimension=2 /
&material id='m', model='linear_elastic', density=1600, youngs_modulus=60e9, poisson_ratio=0.3 /
&body id='low', box=0,0.075, -0.006,0, 0,1, spacing=0.0015, material='m' /
&body id='high', box=0,0.075, 0,0.006, 0,1, spacing=0.0015, material='m' /
&body id='wall', box=0.075,0.0795, -0.006,0.006, 0,1, spacing=0.0015, material='m', fix='x+',
  fix_width=1 /
&body id='ear', box=-0.006,0, 0.003,0.006, 0,1, spacing=0.0015, material='m' /
&body id='foot', box=-0.006,0, -0.006,-0.003, 0,1, spacing=0.0015, material='m' /
&body id='pin', shape='cylinder', axis='z', centre=-0.003,0.0015,0.5, radius=0.0015, length=1,
  spacing=0.00075, material='m', formulation='rigid',
  motion_time=0,4e-4,{fast},{slow},{end}, motion_velocity=0,0,0, 0,1,0, 0,1,0, 0,{v},0, 0,{v},0 /
&body id='prop', shape='cylinder', axis='z', centre=-0.003,-0.0075,0.5, radius=0.0015, length=1,
  spacing=0.00075, material='m', formulation='rigid', motion_time=0,4e-4,{fast},{slow},{end},
  motion_velocity=0,0,0, 0,0.25,0, 0,0.25,0, 0,{w},0, 0,{w},0 /
&interaction law='none' /
&interaction bodies='low','high', law='cohesive', tensile_strength=60e6, shear_strength=60e6,
  gi=500, gii=1000, open_box=0,0.0462,-1,1,0,1 /
&interaction bodies='low','wall', law='bonded' /
&interaction bodies='high','wall', law='bonded' /
&interaction bodies='high','ear', law='bonded' /
&interaction bodies='low','foot', law='bonded' /
&interaction bodies='ear','pin', law='contact' /
&interaction bodies='foot','prop', law='contact' /
&output history_every=1e-5, dump_every=1 /
"""


def arm_loads(folder):
    """Loads of both pins, from their work and from the momentum of all that they pull; time."""
    energy, bodies = table(folder, "energy"), table(folder, "bodies")
    time = energy["time[s]"]
    parts = ("low", "high", "ear", "foot", "wall")
    momentum = sum(bodies[f"{p}:mass[kg]"] * bodies[f"{p}:velocity_y[m/s]"] for p in parts)
    both = np.gradient(momentum + bodies["wall:reaction_y[N s]"], time)
    high, low = (np.gradient(bodies[f"{p}:y[m]"], time) for p in ("pin", "prop"))
    second = (np.gradient(energy["drive_work[J]"], time) - high * both) / (low - high - 1e-9)
    return both - second, second, energy


@pytest.mark.slow
def test_mixed_mode_bending(tmp_path):
    """Half of the energy by opening, half by shear: G = 12 P_I^2 (a + chi h)^2/(E' b^2 h^3) and
    G_II = 9 P_II^2 (a + 0.42 chi h)^2/(4 E' b^2 h^3), with P_I half of the difference of the loads
    of both arms and P_II their sum, over the energy of Benzeggagh and Kenane at B = G_II/G, 5 %.
    """
    v, slow = 0.24, 1.75e-3
    end = slow + 1.25e-3
    run(tmp_path, MIXED.format(end=end, fast=slow - 4e-4, slow=slow, v=v, w=v / 4))
    first, second, energy = arm_loads(tmp_path)
    opening, shear = (first - second) / 2, first + second
    modulus = YOUNG / (1 - POISSON**2)
    crack = np.full(opening.size, 0.0495)
    mode, over = np.zeros((2, opening.size))
    for k in range(1, opening.size):  # from the pins on; what is spent tells how far it is
        g1 = 12 * opening[k] ** 2 * (crack[k - 1] + 0.663 * HIGH) ** 2 / (modulus * HIGH**3)
        g2 = 9 / 4 * shear[k] ** 2 * (crack[k - 1] + 0.42 * 0.663 * HIGH) ** 2
        g2 /= modulus * HIGH**3
        mode[k] = g2 / (g1 + g2)
        law = 500 + 500 * mode[k] ** 2
        over[k] = (g1 + g2) / law
        spent = energy["bond_heat[J]"]
        crack[k] = crack[k - 1] + max(spent[k] - spent[k - 1], 0) / law
    near = (crack > 0.051) & (crack < 0.057)
    assert np.count_nonzero(near) > 50
    note("mixed_mode_glued", float(over[near].mean()))
    note("mixed_mode_share", float(mode[near].mean()))
    assert over[near].mean() == pytest.approx(1, abs=0.05)
    assert mode[near].mean() == pytest.approx(0.5, abs=0.1)
    assert abs(energy["error[-]"][-1]) < 1e-4


def test_what_a_run_shows(tmp_path):
    """A lifted block: all breaks, 0.6 J are spent, a restart continues bit for bit."""
    done = run(tmp_path, PEEL, "--check")
    assert "a+b: 20 points" in done.stdout and "time step up to" in done.stdout
    done = run(tmp_path, PEEL)
    assert "2.000E-02 of 2.000E-02 m2 broken" in done.stdout
    assert "E-01 J spent (cracks, and what pressure held there)" in done.stdout
    energy = table(tmp_path, "energy")
    assert energy["bond_heat[J]"][-1] == pytest.approx(0.6, rel=5e-3)  # a little shear
    assert energy["bond[J]"][-1] == 0
    assert energy["bond[J]"].max() > 0.05
    assert abs(energy["error[-]"][-1]) < 1e-3
    assert np.isfinite(energy["total[J]"]).all()
    bodies = table(tmp_path, "bodies")
    assert bodies["a+b:broken[m2]"][-1] == pytest.approx(0.02)
    dumps = sorted((tmp_path / "out/glue").glob("solid_*.vtkhdf"))
    with h5py.File(dumps[-1]) as file:
        damage = file["VTKHDF/PointData/bond_damage"][:]
        assert np.count_nonzero(damage == 1) == 40
        assert np.count_nonzero(damage) == 40
        area = file["VTKHDF/FieldData/interface_area"][:]
        assert area.sum() == pytest.approx(0.02)
        assert file["VTKHDF/FieldData/interface_at"].shape == (20, 3)
    first = {p.name: p.read_bytes() for p in (tmp_path / "out/glue").glob("*.csv")}
    run(tmp_path, PEEL, "--replace", "--set", "run.max_steps=4000")
    assert 0 < table(tmp_path, "energy")["bond_heat[J]"][-1] < 0.6
    run(tmp_path, PEEL, "--restart", "latest")
    for name, text in first.items():
        assert (tmp_path / "out/glue" / name).read_bytes() == text


def test_what_is_glued_stays_until_it_is_loose(tmp_path):
    """A block flies out of the region with one that is glued to it: both stay; unglued it goes."""
    deck = """\
&run t_end=2e-3, dimension=2 /
&solid region=-1,0.03, -1,1, -1,1, leave='remove' /
&material id='m', model='linear_elastic', density=1000, youngs_modulus=1e8, poisson_ratio=0.3 /
&body id='a', box=0,0.005, 0,0.01, 0,1, spacing=0.001, material='m', velocity=20,0,0 /
&body id='b', box=0.005,0.01, 0,0.01, 0,1, spacing=0.001, material='m', velocity=20,0,0 /
&interaction bodies='a','b', law='{law}' {keys} /
"""
    keys = ", tensile_strength=1e7, shear_strength=1e7, gi=1e3, gii=1e3"
    run(tmp_path, deck.format(law="cohesive", keys=keys), "--backend", "cpu")
    glued = table(tmp_path, "energy")
    assert abs(glued["error[-]"][-1]) < 1e-3
    assert 0 < glued["removed[kg]"][-1] < glued["outside[kg]"][-1]
    run(tmp_path, deck.format(law="contact", keys=""), "--replace", "--backend", "cpu")
    free = table(tmp_path, "energy")
    assert free["removed[kg]"][-1] > glued["removed[kg]"][-1]


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (("gi=30, ", ""), "law='cohesive' needs the key 'gi'"),
        (("law='cohesive'", "law='contact'"), "has no place with law='contact'"),
        (("0.01,0.02, 0,1", "0.015,0.025, 0,1"), "have no faces that meet"),
        (("gi=30", "gi=30, interface_stiffness=1e9"), "take interface_stiffness of at least"),
        (("gi=30", "gi=30, open_box=0,1,0,1,0,1,0"), "open_box takes six numbers"),
    ],
)
def test_refused(tmp_path, change, told):
    done = run(tmp_path, PEEL.replace(*change), "--check", code=2)
    assert told in done.stderr and "glue.nml:" in done.stderr


def test_a_coarse_zone_is_told(tmp_path):
    done = run(tmp_path, PEEL.replace("gi=30", "gi=1"), "--check")
    assert "the cohesive zone between 'a' and 'b' is 1" in done.stderr


GPU = """\
&run t_end=2.2e-5, symmetry='y' /
&material id='m', model='linear_elastic', density=7800, youngs_modulus=200e9, poisson_ratio=0.3 /
&body id='a', box=0,0.006, 0,0.003, 0,0.004, spacing=0.001, material='m' /
&body id='b', box=0,0.006, 0,0.003, 0.004,0.007, spacing=0.001, material='m', spin=0,3e4,0 /
&interaction bodies='a','b', law='cohesive', tensile_strength=3e8, shear_strength=4e8,
  gi=2e4, gii=3e4, friction=0.2 /
&output history_every=5e-7, dump_every=1.1e-5, checkpoint_every=2e-6 /
"""


def numbers(folder, out):
    return {
        name: np.genfromtxt(folder / out / f"{name}.csv", delimiter=",", skip_header=1)
        for name in ("energy", "bodies")
    }


def same(first, second):
    for name, a in first.items():
        scale = np.abs(a).max(axis=0)
        assert np.all(np.abs(a - second[name]) <= 1e-8 * scale + 1e-9), name


def on_both(folder, deck):
    """Numbers of a deck that breaks glue, on the CPU and on the emulated GPU: they are the same."""
    (folder / "g.nml").write_text(deck)
    (folder / "good.ptx").write_text(f"// {stamp()}\n", encoding="utf-8")
    for backend in ("cpu", "gpu"):
        done = on_gpu(folder, "g.nml", "--backend", backend, "--out", backend)
        assert done.returncode == 0, done.stderr
        assert ("the bodies run on Emulated" in done.stderr) == (backend == "gpu")
        assert "m2 broken" in done.stdout
    cpu, gpu = numbers(folder, "cpu"), numbers(folder, "gpu")
    same(cpu, gpu)
    return cpu, gpu


def test_interfaces_on_the_gpu(tmp_path):
    """What breaks there is what breaks on the CPU; checkpoints go to and fro; the same bits."""
    cpu, gpu = on_both(tmp_path, GPU)
    energy = table(tmp_path, "energy", "gpu")
    bodies = table(tmp_path, "bodies", "gpu")
    broken = bodies["a+b:broken[m2]"][-1] / 1.8e-5
    assert 0.1 < broken < 0.9, broken
    assert energy["bond_heat[J]"][-1] > 0.1
    assert energy["bond_heat[J]"][-1] == bodies["a+b:bond_heat[J]"][-1]
    with (
        h5py.File(tmp_path / "cpu/solid_00002.vtkhdf") as a,
        h5py.File(tmp_path / "gpu/solid_00002.vtkhdf") as b,
    ):
        for name in (
            "PointData/bond_damage",
            "FieldData/interface_damage",
            "FieldData/interface_at",
        ):
            x, y = a[f"VTKHDF/{name}"][:], b[f"VTKHDF/{name}"][:]
            assert np.abs(x - y).max() <= 1e-6 * np.abs(x).max()
    steps = ("--set", "run.max_steps=60"), ("--set", "run.max_steps=150"), ()
    for k, backend in enumerate(("cpu", "gpu", "cpu")):
        restart = () if k == 0 else ("--restart", "latest")
        done = on_gpu(tmp_path, "g.nml", "--backend", backend, *steps[k], "--out", "p", *restart)
        assert done.returncode == 0, done.stderr
    same(cpu, numbers(tmp_path, "p"))
    for k in range(2):
        restart = () if k == 0 else ("--restart", "latest")
        more = steps[0] if k == 0 else ()
        done = on_gpu(tmp_path, "g.nml", "--backend", "gpu", *more, "--out", "q", *restart)
        assert done.returncode == 0, done.stderr
    interface = numbers(tmp_path, "q")["bodies"][:, -3:]
    assert (interface == gpu["bodies"][:, -3:]).all()


def test_glued_bodies_at_rest_have_no_energy_error(tmp_path):
    """The glue opens by rounding alone."""
    deck = PEEL.replace("0,0.05,0, 0,0.05,0", "0,0,0, 0,0,0").replace("t_end=2.2e-3", "t_end=1e-4")
    run(
        tmp_path,
        deck.replace(
            "formulation='rigid',\n  motion_time=0,1, motion_velocity=0,0,0, 0,0,0", "fix='y+'"
        ),
    )
    energy = table(tmp_path, "energy")
    assert not energy["error[-]"].any() and energy["bond_heat[J]"][-1] == 0
