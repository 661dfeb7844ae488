# SPDX-License-Identifier: MIT
"""Pressures on faces of bodies, in scenes without air: histories and blasts by Kingery-Bulmash."""

import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from notes import note

HOME = Path(__file__).parents[2]
sys.path.insert(0, str(HOME))

from post.blast import free_air, measure_pulse, surface  # noqa: E402

BRISANCE = HOME / "bin" / "brisance"
STEEL = """\
&material id='s', model='linear_elastic', density=7800, youngs_modulus=200e9, poisson_ratio=0.3 /
"""


def run(folder, deck, *options):
    """Rows of bodies.csv and energy.csv, by column; what was printed."""
    (folder / "load.nml").write_text(deck)
    done = subprocess.run([BRISANCE, "run", "load.nml", "--replace", *options], cwd=folder,
                          capture_output=True, text=True)  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    out = folder / "out" / "load"
    tables = {}
    for name in ("bodies", "energy", "gauges"):
        path = out / f"{name}.csv"
        if not path.exists():
            continue
        with path.open() as file:
            names = [column.strip() for column in file.readline().split(",")]
            rows = np.loadtxt(file, delimiter=",", ndmin=2)
        tables[name] = dict(zip(names, rows.T, strict=True))
    return tables


def momentum(tables, body="b"):
    """Of a body at the end [N s]."""
    b = tables["bodies"]
    mass = b[f"{body}:mass[kg]"][-1]
    return np.array([mass * b[f"{body}:velocity_{a}[m/s]"][-1] for a in "xyz"])


BLOCK = (
    STEEL
    + """\
&body id='b', box=0,0.01, 0,0.006, 0,0.004, spacing={dx}, material='s', formulation='{form}' /
&output history_every=1e-6, dump_every=1 /
"""
)


# A triangle of 100 MPa and 20 us on a face pushes with its impulse times the area of the face.
@pytest.mark.parametrize(("dimension", "symmetry", "form"), [
    (1, "", "auto"), (2, "", "auto"), (3, "", "auto"), (3, "symmetry='y','z'", "auto"),
    (3, "", "corrected_hourglass"), (3, "", "total_lagrangian"), (3, "", "rigid"),
])  # fmt: skip
def test_impulse_of_a_history(tmp_path, dimension, symmetry, form):
    deck = f"&run t_end=2e-5, dimension={dimension} {symmetry} /\n" + BLOCK.format(
        dx=1e-3, form=form
    )
    deck += "&load body='b', faces='x-', time=0,1e-5,2e-5, pressure=0,1e8,0 /\n"
    tables = run(tmp_path, deck)
    area = {1: 1.0, 2: 0.006, 3: 0.006 * 0.004}[dimension]
    wanted = 1e8 * 1e-5 * area
    got = momentum(tables)
    # the area of a face that deforms grows a little under the pulse
    even = dimension == 1 or form == "rigid"
    assert got[0] == pytest.approx(wanted, rel=1e-6 if even else 3e-4)
    assert symmetry or abs(got[1:]).max() < 1e-9 * wanted
    assert abs(tables["energy"]["error[-]"][-1]) < 1e-4
    work = tables["energy"]["load_work[J]"][-1]
    assert work >= 0.99 * got[0] ** 2 / 2 / tables["bodies"]["b:mass[kg]"][-1]


def test_pressure_on_all_faces_of_what_turns_is_balanced(tmp_path):
    """It follows the faces: the net force stays zero and the body is squeezed evenly."""
    deck = "&run t_end=5e-5 /\n" + BLOCK.format(dx=1e-3, form="bending")
    deck = deck.replace("material='s'", "material='s', spin=0,0,2e4, alpha=0")
    deck += "&load body='b', faces='x-','x+','y-','y+','z-','z+', pressure=1e7 /\n"
    tables = run(tmp_path, deck)
    scale = 1e7 * 0.006 * 0.004 * 5e-5  # impulse on one face
    note("load_turning", abs(momentum(tables)).max() / scale)
    assert abs(momentum(tables)).max() < 2e-3 * scale
    assert abs(tables["energy"]["error[-]"]).max() < 1e-3


CENTRES = (-7.5e-3, -2.5e-3, 2.5e-3, 7.5e-3)  # of the particles of a side [m]


@pytest.mark.parametrize(("burst", "curves"), [("air", free_air), ("surface", surface)])
def test_blast_is_that_of_kingery_bulmash(tmp_path, burst, curves):
    """A small rigid plate that looks at the charge, one at 60 degrees, and one that looks away."""
    mass, far = 2.0, 1.5
    blast = curves(mass, far)
    end = 1.05 * (blast.arrival + blast.duration)
    head = f"&run t_end={end} /\n" + STEEL.replace("7800", "1e6")  # it hardly turns
    plate = """\
&body id='b', box=-0.01,0.01, -0.01,0.01, 0,0.01, spacing=5e-3, material='s', formulation='rigid' /
&output history_every={every}, dump_every=1 /
&load body='b', faces='{face}', mass={mass}, at={at}, burst='{burst}' /
"""
    place = np.array([(x, y, 0.0) for x in CENTRES for y in CENTRES])
    for angle, face in ((0, "z-"), (60, "z-"), (180, "z+")):
        turn = math.radians(angle if face == "z-" else 0)
        level = 2.5e-3 if face == "z-" else 7.5e-3  # of the layer that is loaded
        at = np.array([far * math.sin(turn), 0.0, level - far * math.cos(turn)])
        where = ",".join(map(str, at))
        deck = head + plate.format(every=end / 100, face=face, mass=mass, at=where, burst=burst)
        tables = run(tmp_path, deck)
        got = -momentum(tables)[2] if face == "z+" else momentum(tables)[2]
        wanted = 0.0  # by the curves, particle by particle
        for way in place + [0, 0, level] - at:
            r = np.linalg.norm(way)
            here = curves(mass, r)  # the incident wave passes over what looks away
            wanted += here.incident_impulse if face == "z+" else (
                here.on_surface(math.acos(way[2] / r))[1])  # fmt: skip
        wanted *= 0.005**2
        note(f"load_blast_{angle}" if burst == "air" else f"load_ground_{angle}", got / wanted)
        assert got == pytest.approx(wanted, rel=1e-6)


HEIGHT = 1.5  # of 1 kg of TNT over a rigid floor [m]
OVER_A_FLOOR = (
    f"&run t_end=13e-3 /\n&air geometry='axial', floor=0 /\n"
    f"&charge id='tnt', mass=1, eos='jwl', at=0,0,{HEIGHT}, plane_cells=80 /\n"
    "&output history_every=0 /\n"
)


def test_oblique_reflection_from_a_floor(tmp_path):
    """The impulse that the curves give a surface, beside that of air in the plane through the axis
    on a rigid floor: within 12 % at 45, 60 and 70 degrees, and both above the incident one."""
    angles = (45, 60, 70)
    deck = OVER_A_FLOOR
    for angle in angles:
        at = HEIGHT * math.tan(math.radians(angle))
        deck += f"&gauge id='{angle}', at={at},0,0, quantity='overpressure' /\n"
    gauges = run(tmp_path, deck)["gauges"]
    time = gauges["time[s]"]
    for angle in angles:
        pulse = measure_pulse(time, gauges[f"{angle}:overpressure[Pa]"], ambient=0.0)
        assert pulse.complete
        turn = math.radians(angle)
        blast = free_air(1.0, HEIGHT / math.cos(turn))
        _, impulse = blast.on_surface(turn)
        note(f"load_oblique_{angle}", impulse / pulse.impulse)
        assert impulse == pytest.approx(pulse.impulse, rel=0.12)
        assert min(impulse, pulse.impulse) > blast.incident_impulse


@pytest.mark.parametrize("form", ["auto", "total_lagrangian", "rigid"])
def test_a_body_falls_freely(tmp_path, form):
    """Constant acceleration: velocity a t, no stress, and the work of the load is the energy."""
    end = 2e-5
    deck = f"&run t_end={end} /\n" + BLOCK.format(dx=1e-3, form=form)
    tables = run(tmp_path, deck + "&load body='b', acceleration=0,1e3,-9.81e5 /\n")
    mass = tables["bodies"]["b:mass[kg]"][-1]
    assert momentum(tables) == pytest.approx(mass * end * np.array([0, 1e3, -9.81e5]), rel=1e-9)
    work = tables["energy"]["load_work[J]"][-1]
    assert work == pytest.approx(momentum(tables) @ momentum(tables) / 2 / mass, rel=1e-9)
    assert abs(tables["energy"]["solid_internal[J]"][-1]) < 1e-9 * work


def test_a_driven_body_is_loaded(tmp_path):
    """A body that moves evenly: what drives it does the work that the load takes out of it."""
    end, pull, speed = 2e-5, -1e4, 10.0
    deck = f"&run t_end={end} /\n" + BLOCK.format(dx=1e-3, form="auto").replace(
        "form", f"velocity=0,0,{speed}, fix='x-', motion_time=0, motion_velocity=0,0,{speed}, form"
    )
    tables = run(tmp_path, deck + f"&load body='b', acceleration=0,0,{pull} /\n")
    mass = tables["bodies"]["b:mass[kg]"][-1]
    energy = {name.split("[")[0]: column[-1] for name, column in tables["energy"].items()}
    # of all particles, those that are held among them, which have the mean velocity of the body
    # to 4 %: the others are 0.2 m/s slower in the mean of the run
    assert energy["load_work"] == pytest.approx(mass * pull * speed * end, rel=0.04)
    note("load_driven", energy["error"])
    assert abs(energy["error"]) < 1e-8


@pytest.mark.parametrize(("symmetry", "form"), [("", "auto"), ("symmetry='y','z'", "auto"),
                                                 ("", "rigid")])  # fmt: skip
def test_impulse_of_a_force(tmp_path, symmetry, form):
    """A triangle of 1 kN and 20 us on all that is modelled of a body."""
    deck = f"&run t_end=2e-5, {symmetry} /\n" + BLOCK.format(dx=1e-3, form=form)
    deck += "&load body='b', force=1e3,0,0, time=0,1e-5,2e-5, scale=0,1,0 /\n"
    got = momentum(run(tmp_path, deck))
    assert got[0] == pytest.approx(1e3 * 1e-5, rel=1e-9)
    assert abs(got[1:]).max() < 1e-12


def test_a_column_hangs_from_its_top(tmp_path):
    """Uniaxial strain, gravity from the start: the tip swings between 0 and a L^2/c^2 with a period
    of 4 L/c; the first swing in parabolas (d'Alembert)."""
    long, pull, spacing = 0.1, 1e5, 1e-3
    # a column of three particles is held; it acts at the first of them (docs/theory/plates.md)
    deck = f"""\
&run t_end=7e-5, dimension=1 /
{STEEL}
&body id='b', box=0,{long + 2.5 * spacing}, 0,1, 0,1, spacing={spacing}, material='s', fix='x+'
    alpha=0.1 /
&load body='b', acceleration={-pull},0,0 /
&gauge id='tip', at=0,0,0, body='b', quantity='displacement_x' /
&output history_every=2e-7, dump_every=1 /
"""
    tables = run(tmp_path, deck)
    t, u = (list(tables["gauges"].values())[k] for k in (0, 1))
    speed = math.sqrt(200e9 * 0.7 / (1.3 * 0.4) / 7800)
    arrive = long / speed  # of the wave from the held end
    exact = np.where(t < arrive, t**2 / 2, t**2 / 2 - (t - arrive) ** 2)
    exact = np.where(t < 3 * arrive, exact, np.nan) * -pull
    top = pull * arrive**2
    error = np.nanmax(abs(u - exact)) / top
    note("load_hanging", -u.min() / top)
    note("load_hanging_time", t[np.argmin(u)] / (2 * arrive))
    assert -u.min() == pytest.approx(top, rel=0.01)
    assert t[np.argmin(u)] == pytest.approx(2 * arrive, rel=0.02)
    assert error < 0.02


def clamped_beam(elements=200):
    """First frequencies and shapes of the strip below, by Timoshenko elements: (omega, w(t))."""
    young, ratio, density, high, length = 200e9 / (1 - 0.09), 0.3, 7800.0, 0.01, 0.2
    shear, size = 200e9 / 2 / (1 + ratio), length / elements
    n = 2 * elements + 2
    stiff, mass = np.zeros((n, n)), np.zeros(n)
    slope = np.array([-1 / size, -0.5, 1 / size, -0.5])
    turn = np.array([0, -1 / size, 0, 1 / size])
    element = size * (5 / 6 * shear * high * np.outer(slope, slope)
                      + young * high**3 / 12 * np.outer(turn, turn))  # fmt: skip
    for k in range(elements):
        at = slice(2 * k, 2 * k + 4)
        stiff[at, at] += element
        mass[at] += density * size / 2 * np.array([high, high**3 / 12] * 2)
    free = slice(2, -2)
    root = np.sqrt(mass[free])
    squares, modes = np.linalg.eigh(stiff[free, free] / np.outer(root, root))
    force = np.zeros(n)
    force[0::2] = size
    part = modes.T @ (force[free] / root)
    middle = modes[elements - 2] / root[elements - 2]
    return np.sqrt(squares), part * middle


def test_clamped_strip_under_a_triangular_pulse(tmp_path):
    """Deflection of an elastic strip in plane strain against the sum over the modes of a beam."""
    peak, long = 1e6, 2e-4
    # three columns are held; the clamp acts at the first of them (docs/theory/plates.md)
    deck = f"""\
&run t_end=6e-4, dimension=2, symmetry='x' /
{STEEL}
&body id='b', box=0,{0.1 + 2.5 * 2e-3}, 0,0.01, 0,1, spacing=2e-3, material='s', fix='x+' /
&load body='b', faces='y-', time=0,{long}, pressure={peak},0 /
&gauge id='mid', at=0,0.005,0, body='b', quantity='displacement_y' /
&output history_every=2e-6, dump_every=1 /
"""
    tables = run(tmp_path, deck)
    t, w = (list(tables["gauges"].values())[k] for k in (0, 1))
    omega, part = clamped_beam()
    exact = np.zeros_like(t)
    for o, a in zip(omega[:60], part[:60], strict=True):
        # response to p0 (1 - t/T) until T, by superposition of ramps
        def ramp(s, o=o):
            s = np.maximum(s, 0)
            return (s - np.sin(o * s) / o) / o**2

        step = (1 - np.cos(o * t)) / o**2
        exact += a * peak * (step - ramp(t) / long + ramp(t - long) / long)
    error = abs(w.max() / exact.max() - 1)
    note("load_strip",
         w.max() / exact.max())  # fmt: skip
    late = t[np.argmax(w)] / t[np.argmax(exact)]
    note("load_strip_time", late)
    assert error < 0.01
    assert late == pytest.approx(1, abs=0.01)


def test_a_table_is_the_history_that_it_has(tmp_path):
    """Times and pressures, or factors of a force, in a file are those in the deck, to the bit."""
    (tmp_path / "p.csv").write_text("time [s], note, Pressure[Pa]\n0,1,0\n1e-5,1,1e8\n\n2e-5,2,0\n")
    (tmp_path / "f.csv").write_text("scale,time\n0,0\n1,1e-5\n0,2e-5\n")
    head = "&run t_end=2e-5 /\n" + BLOCK.format(dx=2e-3, form="auto")
    pairs = (
        ("faces='x-', table='p.csv'", "faces='x-', time=0,1e-5,2e-5, pressure=0,1e8,0"),
        ("force=1,2,3, table='f.csv'", "force=1,2,3, time=0,1e-5,2e-5, scale=0,1,0"),
    )
    for pair in pairs:
        a, b = (momentum(run(tmp_path, f"{head}&load body='b', {keys} /\n")) for keys in pair)
        assert (a == b).all() and abs(a).max() > 0


def test_restart_is_the_same_run(tmp_path):
    deck = "&run t_end=2e-5 /\n" + BLOCK.format(dx=1e-3, form="auto")
    deck += "&load body='b', faces='x-','z+', time=0,1e-5,2e-5, pressure=0,1e8,0 /\n"
    whole = run(tmp_path, deck)
    (tmp_path / "load.nml").write_text(deck)
    common = {"cwd": tmp_path, "capture_output": True, "text": True}
    done = subprocess.run([BRISANCE, "run", "load.nml", "--replace", "--set", "run.max_steps=20"],
                          **common)  # fmt: skip
    assert done.returncode == 0, done.stderr
    done = subprocess.run([BRISANCE, "run", "load.nml", "--restart", "latest"], **common)
    assert done.returncode == 0, done.stderr
    text = (tmp_path / "out" / "load" / "energy.csv").read_text().splitlines()
    last = dict(zip((c.strip() for c in text[0].split(",")), text[-1].split(","), strict=True))
    assert float(last["solid_kinetic[J]"]) == whole["energy"]["solid_kinetic[J]"][-1]


BAD = {
    "body='c', faces='z-', pressure=1": "there is no &body with id='c'",
    "body='b', faces='z-'": "give one of them",
    "body='b', faces='z-', pressure=1, mass=1, at=0,0,0": "give one of them",
    "body='b', faces='z-', mass=1": "add at = x, y, z",
    "body='b', faces='z-', pressure=1,2": "2 values of pressure for 0 times",
    "body='b', pressure=1": "a pressure needs faces",
    "body='b', faces='z-', force=1,0,0": "take them out",
    "body='b', force=1,0,0, acceleration=1,0,0": "give one of them",
    "body='b', force=1,0,0, scale=1,2": "2 values of scale for 0 times",
    "body='b', faces='z-', pressure=1, scale=1": "scale belongs to an acceleration or a force",
    "body='b', force=1,0,0, at=0,0,0": "at belongs to a charge",
    "body='b', faces='z-', pressure=1,2, time=1,1": "the times must grow",
    "body='b', faces='z-', pressure=1, time=1": "take time out",
    "body='b', faces='z-', mass=1, at=0,0,-50": "leave the range of the Kingery-Bulmash curves",
    "body='b', faces='z-', mass=1, at=0,0,-1, time=1": "time belongs to a history",
    "body='b', faces='z-', pressure=1, detonation_time=1": "belongs to a charge",
    "body='b', faces='z-', table='none.csv'": "none.csv",
    "body='b', faces='z-', pressure=1, patch='none.stl'": "there is no file 'none.stl'",
    "body='b', faces='z-', table='bad.nml'": "must name the columns time and pressure",
    "body='b', faces='z-', table='bad.nml', pressure=1": "take time, pressure, scale and mass out",
    "body='b', faces='z-', pressure=1, burst='surface'": "burst belongs to a charge",
    "body='b', faces='z-', mass=1, at=0,0,-0.065, burst='surface'": "leave the range of the King",
}


@pytest.mark.parametrize("line", BAD)
def test_bad_loads(tmp_path, line):
    deck = "&run t_end=1e-6 /\n" + BLOCK.format(dx=1e-3, form="auto") + f"&load {line} /\n"
    (tmp_path / "bad.nml").write_text(deck)
    done = subprocess.run([BRISANCE, "run", "bad.nml"], cwd=tmp_path, capture_output=True,
                          text=True)  # fmt: skip
    assert done.returncode == 2
    assert "bad.nml:5: &load" in done.stderr and BAD[line] in done.stderr


def test_a_push_stays_in_what_is_modelled(tmp_path):
    for run_keys, push in (("symmetry='x'", "1,0,0"), ("dimension=2", "0,0,1")):
        deck = f"&run t_end=1e-6, {run_keys} /\n" + BLOCK.format(dx=1e-3, form="auto")
        (tmp_path / "bad.nml").write_text(deck + f"&load body='b', force={push} /\n")
        done = subprocess.run([BRISANCE, "run", "bad.nml"], cwd=tmp_path, capture_output=True,
                              text=True)  # fmt: skip
        assert done.returncode == 2 and "make that component 0" in done.stderr


@pytest.mark.parametrize("group", ["load", "motion"])
def test_a_load_or_a_motion_wants_no_air(group, tmp_path):
    deck = "&run t_end=1e-6 /\n&air box=-1,1,-1,1,-1,1, cells=4,4,4 /\n"
    deck += BLOCK.format(dx=1e-3, form="auto")
    deck += {
        "load": "&load id='k', body='b', faces='z-', pressure=1e5 /\n",
        "motion": "&motion id='k', body='b', box=-1,1,-1,1,-1,1, velocity=1,0,0 /\n",
    }[group]
    (tmp_path / "bad.nml").write_text(deck)
    done = subprocess.run([BRISANCE, "run", "bad.nml"], cwd=tmp_path, capture_output=True,
                          text=True)  # fmt: skip
    assert done.returncode == 2
    assert f": &{group} id='k': is for scenes without air" in done.stderr
    assert done.stderr.count(f"&{group} id='k'") == 1  # it is named once
