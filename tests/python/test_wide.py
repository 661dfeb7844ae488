# SPDX-License-Identifier: MIT
"""Particles three times as wide as high: thin bodies bend by theory, conserve, restart, refuse."""

import math
import subprocess

import numpy as np
import pytest
from notes import note
from test_gpu import run as on_gpu
from test_gpu import same, stamp
from test_loads import BRISANCE
from test_ranks import needs_mpirun, start
from test_run import arrays
from tiers import slow

YOUNG, NU, RHO = 200e9, 0.3, 7800.0
HALF, HIGH = 0.1, 0.01  # [m]
REACH = 0.28  # of elastic clamps in two dimensions, 0.27 in three: docs/theory/plates.md
MATERIAL = f"""\
&material id='m', model='linear_elastic', density={RHO}, youngs_modulus={YOUNG},
    poisson_ratio={NU} /"""
PLY = """\
&material id='m', model='orthotropic_ply', density=1600, e1=140e9, e2=10e9, e3=10e9, nu12=0.3,
    nu13=0.3, nu23=0.4, g12=5e9, g13=5e9, g23=3.6e9 /"""
STEEL = """\
&material id='m', model='bilinear_j2', density=7800, youngs_modulus=200e9, poisson_ratio=0.3,
    yield_stress=350e6, tangent_modulus=1e9 /"""


def run(folder, deck, *more, name="w"):
    (folder / f"{name}.nml").write_text(deck)
    return subprocess.run([BRISANCE, "run", f"{name}.nml", "--replace", *more], cwd=folder,
                          capture_output=True, text=True)  # fmt: skip


def gauge(folder, name="w"):
    """Time and the first gauge."""
    table = np.genfromtxt(folder / "out" / name / "gauges.csv", delimiter=",", skip_header=1)
    return table[:, 0], table[:, 1]


def table(file):
    """Columns of a table by their names."""
    with file.open(encoding="utf-8") as lines:
        names = [name.strip() for name in lines.readline().split(",")]
    columns = np.genfromtxt(file, delimiter=",", skip_header=1).T
    return dict(zip(names, columns, strict=True))


def beam_period():
    """Lowest symmetric mode of a clamped Timoshenko beam in plane strain, shear factor 5/6."""
    stiff, shear = YOUNG / (1 - NU**2) * HIGH**3 / 12, 5 / 6 * YOUNG / 2 / (1 + NU) * HIGH

    def fault(omega):
        """w = C cosh(m x) + D cos(n x) and its turn at x = HALF: the determinant."""
        a, b = RHO * HIGH * omega**2 / shear, RHO * HIGH**3 / 12 * omega**2 / stiff
        root = math.sqrt(((a - b) / 2) ** 2 + RHO * HIGH * omega**2 / stiff)
        m, n = math.sqrt(root - (a + b) / 2), math.sqrt(root + (a + b) / 2)
        p, q = (m * m + a) / m * math.tanh(m * HALF), (a - n * n) / n
        return q * math.sin(n * HALF) - p * math.cos(n * HALF)

    high = 22.373 / (2 * HALF) ** 2 * math.sqrt(stiff / RHO / HIGH)
    low = 0.7 * high
    for _ in range(60):
        middle = (low + high) / 2
        if fault(low) * fault(middle) <= 0:
            high = middle
        else:
            low = middle
    return 2 * math.pi / low


def period_of(time, move, near):
    """The period by which a harmonic that may fade fits best, to 1e-5 of it."""
    best, step, number = near, 0.15 * near, 601
    while step > 1e-6 * near:
        periods = np.linspace(best - step, best + step, number)
        best = min(periods, key=lambda period: misfit(time, move, period))
        step, number = periods[1] - periods[0], 21
    return best


def misfit(time, move, period):
    turn = 2 * math.pi * time / period
    waves = np.stack([np.cos(turn), np.sin(turn), time * np.cos(turn), time * np.sin(turn)], 1)
    rest = move - waves @ np.linalg.lstsq(waves, move, rcond=None)[0]
    return float(rest @ rest)


STRIP = """\
&run t_end={end}, symmetry='x', dimension=2 /
{material}
&body id='b', box=0,{side}, {low},{high}, 0,1, spacing={dy}, aspect={aspect},1,1, material='m',
    fix='x+' /
&load body='b', faces='y+', time=0,{pulse}, pressure=1e4,1e4 /
&gauge id='mid', at=0,0,0, body='b', quantity='displacement_y' /
&output history_every={every} /
"""


@pytest.mark.parametrize("layers", [3, 4, slow(5)])
@pytest.mark.parametrize("wide", [2, slow(3), 4])
def test_a_clamped_strip_swings_as_a_beam(tmp_path, layers, wide):
    """For any width: particles that see w = x^2/2 as a strain across are 0.80 here."""
    exact = beam_period()
    height = HIGH / layers
    columns = round(HALF / (wide * height) + 2.5 - REACH)
    dx = HALF / (columns - 2.5 + REACH)
    deck = STRIP.format(end=2.5 * exact, material=MATERIAL, side=columns * dx, low=-HIGH / 2,
                        high=HIGH / 2, dy=height, aspect=dx / height, pulse=exact / 8,
                        every=exact / 100)  # fmt: skip
    done = run(tmp_path, deck)
    assert done.returncode == 0, done.stderr
    time, move = gauge(tmp_path)
    free = time > exact / 8
    found = period_of(time[free], move[free], exact) / exact
    note(f"wide_strip_{layers}_{wide}", found)
    assert found == pytest.approx(1, abs=0.025 if wide < 4 else 0.035)


PLATE = """\
&run t_end={end}, symmetry='x','y' /
{material}
&body id='plate', box=0,{side}, 0,{side}, -0.01,0, spacing={dz}, aspect={wide},{wide},1,
    material='m', fix='x+','y+' /
&load body='plate', faces='z+', time=0,50e-6, pressure={p},{p} /
&gauge id='mid', at=0,0,-0.005, body='plate', quantity='displacement_z' /
&output history_every=1e-6 /
"""


def plate(folder, layers, reach, scene):
    """Deflection of the middle of a clamped plate whose particles are about three wide."""
    material, pressure, end = scene
    dz = HIGH / layers
    columns = round(HALF / (3 * dz) + 2.5 - reach)
    dx = HALF / (columns - 2.5 + reach)
    done = run(folder, PLATE.format(end=end, material=material, side=columns * dx, dz=dz,
                                    wide=dx / dz, p=pressure))  # fmt: skip
    assert done.returncode == 0, done.stderr
    time, move = gauge(folder)
    return time, -move


@pytest.mark.parametrize("layers", [3, slow(4)])
def test_a_plate_swings_as_by_mindlin(tmp_path, layers):
    """P1 of studies/notes/comparison.md: 9.229 um by the modes of Mindlin's plate."""
    time, move = plate(tmp_path, layers, 0.27, (MATERIAL, 1e5, 1.6e-4))
    note(f"wide_plate_{layers}", move.max() / 9.229e-6)
    note(f"wide_plate_{layers}_time", time[move.argmax()] / 133.1e-6)
    assert move.max() == pytest.approx(9.229e-6, rel=0.03)
    assert time[move.argmax()] == pytest.approx(133.1e-6, rel=0.03)


@pytest.mark.parametrize("layers", [3])
def test_a_plate_that_yields(tmp_path, layers):
    """P3 of studies/notes/comparison.md, the first held layer on the edge: peak of the elements,
    18.7 mm, and what stays, 17.7 mm. What keeps layers straight holds no more than they yield
    to."""
    time, move = plate(tmp_path, layers, 0, (STEEL, 1e8, 6e-4))
    note(f"wide_steel_{layers}", move.max() / 18.7e-3)
    stays = np.interp(np.linspace(4e-4, 6e-4, 201), time, move).mean()
    note(f"wide_steel_stays_{layers}", stays / 17.7e-3)
    energy = table(tmp_path / "out" / "w" / "energy.csv")
    held = energy["hourglass[J]"][-1] / energy["solid_internal[J]"][-1]
    note(f"wide_steel_held_{layers}", held)
    assert move.max() == pytest.approx(18.7e-3, rel=0.03)
    assert stays == pytest.approx(17.7e-3, rel=0.03)
    assert held < 0.02


FREE = """\
&run t_end=4e-5{planes} /
{material}
&body id='b', box=0,0.012, 0,0.009, 0,0.0015, spacing=0.0005, aspect=3,3,1, material='m',
    spin={spin}, velocity={velocity} /
&output history_every=1e-6, dump_every=1, checkpoint_every=1 /
"""


def test_a_wide_plate_that_tumbles_conserves(tmp_path):
    """Momentum and angular momentum to rounding: the arms of both particles are the adjoint of
    their gradients, and the hourglass force turns with the body."""
    deck = FREE.format(planes="", material=MATERIAL, spin="2e4,1e4,3e4", velocity="10,20,30")
    done = run(tmp_path, deck)
    assert done.returncode == 0, done.stderr
    energy = table(tmp_path / "out" / "w" / "energy.csv")["total[J]"]
    body = table(tmp_path / "out" / "w" / "bodies.csv")
    note("wide_free_energy", np.ptp(energy) / energy[0])
    assert np.ptp(energy) < 1e-3 * energy[0]
    speed = np.array([body[f"b:velocity_{a}[m/s]"] for a in "xyz"]).T
    drift = np.abs(speed - speed[0]).max() / np.linalg.norm(speed[0])
    note("wide_free_momentum", drift)
    assert drift < 1e-12
    turns = []
    for file in sorted((tmp_path / "out" / "w").glob("solid_*.vtkhdf")):
        found = arrays(file)
        place, move = (np.float64(found[next(k for k in found if k.endswith(n))])
                       for n in ("VTKHDF/Points", "PointData/velocity"))  # fmt: skip
        turns.append(np.cross(place - place.mean(0), move).sum(0))
    drift = np.linalg.norm(turns[-1] - turns[0]) / np.linalg.norm(turns[0])
    note("wide_free_turn", drift)
    assert drift < 1e-6  # dumps are real32


def test_a_restart_leaves_the_same_bytes(tmp_path):
    deck = FREE.format(planes=", symmetry='x'", material=STEEL, spin="0,9e4,0", velocity="0,0,0")
    assert run(tmp_path, deck, "--out", "whole", "--set", "run.max_steps=40").returncode == 0
    assert run(tmp_path, deck, "--out", "parts", "--set", "run.max_steps=17").returncode == 0
    (tmp_path / "w.nml").write_text(deck)
    again = subprocess.run([BRISANCE, "run", "w.nml", "--out", "parts", "--restart", "latest",
                            "--set", "run.max_steps=40"], cwd=tmp_path, capture_output=True,
                           text=True)  # fmt: skip
    assert again.returncode == 0, again.stderr
    one, two = (sorted((tmp_path / f).glob("chk_*.h5"))[-1] for f in ("whole", "parts"))
    first, second = arrays(one), arrays(two)
    assert any(path.endswith("tilt") for path in first)
    for path, values in first.items():
        if values.dtype != object:
            assert values.tobytes() == second[path].tobytes(), path


@pytest.mark.parametrize(
    ("planes", "plies"), [("", ""), (", symmetry='x','z'", ""), (", symmetry='y'", "0/90/0")]
)
def test_wide_particles_on_the_gpu(tmp_path, planes, plies):
    deck = FREE.format(planes=planes, material=STEEL, spin="0,9e4,0", velocity="0,0,0")
    deck += "&gauge id='g', body='b', at=0.011,0.008,0.001, quantity='displacement_z' /"
    if plies:
        deck = deck.replace(STEEL, PLY).replace("material='m',", f"material='m', plies='{plies}',")
    (tmp_path / "g.nml").write_text(deck.replace("4e-5", "4e-6"))
    (tmp_path / "good.ptx").write_text(f"// {stamp()}\n", encoding="utf-8")
    for backend in ("cpu", "gpu"):
        done = on_gpu(tmp_path, "g.nml", "--backend", backend, "--out", backend)
        assert done.returncode == 0, done.stderr
        assert ("the bodies run on Emulated" in done.stderr) == (backend == "gpu")
    same("gpu", "cpu", tmp_path)


@needs_mpirun
def test_processes_leave_the_bytes_of_one(tmp_path):
    deck = PLATE.format(end=6e-6, material=STEEL, side=0.03, dz=0.00125, wide=3, p=1e8)
    (tmp_path / "w.nml").write_text(deck)
    tables = []
    for n in (0, 3):
        done = start(n, "run", "w.nml", "--out", f"out{n}", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        tables.append((tmp_path / f"out{n}" / "gauges.csv").read_bytes())
    assert tables[0] == tables[1]


SECOND = "&body id='c', box=0,0.012, 0,0.009, 0.01,0.0115, spacing=0.0005, material='m' /"
AIR = "&air box=0,0.02, 0,0.02, -0.01,0.01, cells=10,10,10 /"


@pytest.mark.parametrize(
    ("change", "more", "words"),
    [
        (("aspect=3,3,1", "aspect=3,3,1, formulation='bending'"), "", "'total_lagrangian'"),
        (("aspect=3,3,1", "aspect=3,3,2"), "", "must be 1"),
        (("aspect=3,3,1", "aspect=3,3,1"), SECOND, "law = 'none'"),
        (("aspect=3,3,1", "aspect=3,3,1"), AIR, "&load"),
        (("box=0,0.012, 0,0.009, 0,0.0015", "shape='sphere', centre=0,0,0, radius=0.01"), "",
         "boxes alone"),
        (("aspect=3,3,1", "aspect=3,3,1, plate_axis='q'"), "", "plate_axis"),
    ],
)  # fmt: skip
def test_what_does_not_go_with_wide_particles(tmp_path, change, more, words):
    deck = FREE.format(planes="", material=STEEL, spin="0,0,0", velocity="0,0,0")
    assert run(tmp_path, deck, "--check").returncode == 0
    done = run(tmp_path, deck.replace(*change) + more, "--check")
    assert done.returncode == 2
    assert words in done.stderr


def test_the_check_tells_widths(tmp_path):
    done = run(tmp_path, FREE.format(planes="", material=STEEL, spin="0,0,0", velocity="0,0,0"),
               "--check")  # fmt: skip
    assert "144 particles at 1.5 x 1.5 x 0.5 mm" in done.stdout
    assert "anisotropic spacing), a plate across z" in done.stdout
