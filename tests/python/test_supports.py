# SPDX-License-Identifier: MIT
"""Rollers and starts against exact results: beams and plates that are simply supported, blocks
that slide, bodies that turn about a point."""

import math
import subprocess

import h5py
import numpy as np
import pytest
from notes import note
from test_gauges import gauges, whole
from test_loads import BRISANCE, STEEL, run
from tiers import slow

YOUNG, NU, RHO = 200e9, 0.3, 7800.0
SHEAR = YOUNG / 2 / (1 + NU)


def timoshenko(n, long, high, stiff):
    """Frequency of mode n of a simply supported beam of unit width, with shear and turn."""
    k = n * math.pi / long
    bend, area, turn = stiff * high**3 / 12, RHO * high, RHO * high**3 / 12
    shear = 5 / 6 * SHEAR * high
    # area turn w^4 - (area bend k2 + turn shear k2 + area shear) w^2 + bend shear k^4 = 0
    b = area * bend * k**2 + turn * shear * k**2 + area * shear
    root = math.sqrt(b * b - 4 * area * turn * bend * shear * k**4)
    return math.sqrt((b - root) / 2 / area / turn)


def test_beam_on_rollers_under_its_weight(tmp_path):
    """Plane strain, gravity from the start: deflection of the middle against the sum over modes."""
    half, high, spacing, pull = 0.05, 0.005, 1e-3, 1e4
    at = half - spacing / 2  # of the particles that are fixed, a line in the middle layer
    deck = f"""\
&run t_end=1.0e-3, dimension=2, symmetry='x' /
{STEEL}
&body id='b', box=0,{half}, {-high / 2},{high / 2}, 0,1, spacing={spacing}, material='s',
    roller_box={at - 1e-4},{half}, -1e-4,1e-4, 0,1, roller_axis='y' /
&load body='b', acceleration=0,{-pull},0 /
&gauge id='mid', body='b', at=0,0,0, quantity='displacement_y' /
&gauge id='end', body='b', at={half},0,0, quantity='displacement_y' /
&gauge id='f', body='b', quantity='reaction_y' /
&output history_every=2e-6, dump_every=1 /
"""
    tables = run(tmp_path, deck)
    g, t = gauges(tables), tables["gauges"]["time[s]"]
    long = 2 * at
    exact = np.zeros_like(t)
    for n in range(1, 30, 2):
        omega = timoshenko(n, long, high, YOUNG / (1 - NU**2))
        part = 4 * pull / (n * math.pi) * math.sin(n * math.pi / 2)
        exact -= part * (1 - np.cos(omega * t)) / omega**2
    first = t < 0.75e-3
    k, m = np.argmin(g["mid"][first]), np.argmin(exact[first])
    note("roller_beam", g["mid"][k] / exact[m])
    note("roller_beam_time", t[k] / t[m])
    assert g["mid"][k] == pytest.approx(exact[m], rel=0.03)
    assert t[k] == pytest.approx(t[m], rel=0.02)
    assert abs(g["end"]).max() == 0
    weight = tables["bodies"]["b:mass[kg]"][0] * pull
    period = t <= 2 * t[k]
    note("roller_weight", -g["f"][period].mean() / weight)
    assert -g["f"][period].mean() == pytest.approx(weight, rel=0.02)


@pytest.mark.long("a plate through its first period")
@pytest.mark.parametrize(("layers", "bound"), [slow(3, 0.08), slow(5, 0.02)])
def test_first_period_of_a_plate_on_rollers(tmp_path, layers, bound):
    """A square plate, simply supported on lines in its middle layer: time to its largest deflection
    after a push against half the first period of a thick plate (Mindlin). What rollers hold is a
    spacing wide, so that three layers are too stiff; five are not."""
    half, high = 0.05, 0.005
    spacing = high / layers
    at = half - spacing / 2
    line = f"{at - 1e-4},{half}, 0,{half}, -1e-4,1e-4, 0,{half}, {at - 1e-4},{half}, -1e-4,1e-4"
    deck = f"""\
&run t_end=2.9e-4, symmetry='x','y' /
{STEEL}
&body id='b', box=0,{half}, 0,{half}, {-high / 2},{high / 2}, spacing={spacing}, material='s',
    roller_box={line}, roller_axis='z','z' /
&load body='b', acceleration=0,0,-1e5, time=0,4.2e-4, scale=1,1 /
&gauge id='mid', body='b', at=0,0,0, quantity='displacement_z' /
&output history_every=1e-6, dump_every=1 /
"""
    tables = run(tmp_path, deck)
    t, w = tables["gauges"]["time[s]"], gauges(tables)["mid"]
    # Mindlin: the modes of a simply supported plate are those of a beam with k^2 = kx^2 + ky^2
    exact = np.zeros_like(t)
    for m in range(1, 16, 2):
        for n in range(1, 16, 2):
            long = 2 * at / math.hypot(m, n)
            omega = timoshenko(1, long, high, YOUNG / (1 - NU**2))
            part = 16e5 / (m * n * math.pi**2) * math.sin(m * math.pi / 2) * math.sin(
                n * math.pi / 2)  # fmt: skip
            exact -= part * (1 - np.cos(omega * t)) / omega**2
    k, m = np.argmin(w), np.argmin(exact)
    note(f"roller_plate_{layers}", w[k] / exact[m])
    note(f"roller_plate_time_{layers}", t[k] / t[m])
    assert w[k] == pytest.approx(exact[m], rel=bound)
    assert t[k] == pytest.approx(t[m], rel=bound / 3)


@pytest.mark.parametrize("form", ["auto", "corrected_hourglass", "total_lagrangian"])
def test_a_block_on_rollers_slides(tmp_path, form):
    """Held along z at its foot, pushed along x: its momentum along x is that of a free body, what
    it is pushed down goes into the rollers."""
    deck = (
        f"&run t_end=4e-6, dt_max=2e-8 /\n{STEEL}"
        + f"""\
&body id='b', box=0,0.006, 0,0.006, 0,0.004, spacing=1e-3, material='s', formulation='{form}',
    velocity=5,0,7, roller_box=-1,1, -1,1, 0,0.001, roller_axis='z' /
&load body='b', force=1e4,2e3,-3e4 /
{whole("b", "reaction", "impulse")}
&gauge id='foot', body='b', at=0.003,0.003,0, quantity='displacement_z' /
&output history_every=1e-12, dump_every=1 /
"""
    )
    tables = run(tmp_path, deck)
    g, b = gauges(tables), tables["bodies"]
    mass, t = b["b:mass[kg]"][0], b["time[s]"]
    dt = np.diff(t)[:-2]
    for a, start, push in (("x", 5, 1e4), ("y", 0, 2e3)):
        assert mass * b[f"b:velocity_{a}[m/s]"] == pytest.approx(mass * start + push * t, rel=1e-10)
        assert abs(b[f"b:reaction_{a}[N s]"]).max() == 0
    # at the start the particles on rollers do not have the velocity of the others
    share = 3 / 4
    left = mass * b["b:velocity_z[m/s]"] + b["b:reaction_z[N s]"] - mass * share * 7
    held = 3e4 / 4  # part of the force that acts on the particles on the rollers
    left[1:-2] -= dt / 2 * (g["b_reaction_z"][1:-2] + held)
    assert left[:-2] == pytest.approx(g["b_impulse_z"][:-2], abs=1e-10 * 3e4 * t[-1])
    assert abs(g["foot"]).max() == 0 and g["b_reaction_z"].min() < -1e4
    assert abs(tables["energy"]["error[-]"]).max() < 1e-3


@pytest.mark.parametrize("form", ["bending", "rigid"])
def test_a_body_turns_about_a_point(tmp_path, form):
    """Velocity of the centre, energy of rotation about the point, and both stay."""
    deck = (
        f"&run t_end=2e-5 /\n{STEEL}"
        + f"""\
&body id='b', box=0.02,0.03, 0,0.006, 0,0.004, spacing=1e-3, material='s', formulation='{form}',
    velocity=0,0,4, spin=0,0,1e3, spin_centre=0,0.003,0.002, alpha=0 /
&output history_every=1e-6, dump_every=1 /
"""
    )
    b = run(tmp_path, deck)["bodies"]
    mass = b["b:mass[kg]"][0]
    assert b["b:velocity_y[m/s]"] == pytest.approx(25.0, rel=1e-12)
    assert b["b:velocity_z[m/s]"] == pytest.approx(4.0, rel=1e-12)
    assert abs(b["b:velocity_x[m/s]"]).max() < 1e-10
    # of points on a lattice: a^2 - dx^2 in place of a^2
    inertia = mass * ((0.01**2 + 0.006**2 - 2e-6) / 12 + 0.025**2)
    exact = (inertia * 1e6 + mass * 16) / 2
    assert b["b:kinetic[J]"][0] == pytest.approx(exact, rel=2e-3 if form == "rigid" else 1e-12)
    assert b["b:kinetic[J]"] == pytest.approx(b["b:kinetic[J]"][0], rel=1e-4)


BAD = {
    "roller_box=0,1,0,1,0,1": "give one for each",
    "roller_axis='x'": "give one for each",
    "roller_box=0,1,0,1,0,1, roller_axis='x', formulation='rigid'": "rollers are for bodies that",
    "fix='x-', motion_time=0, motion_velocity=0,0,0, roller_box=0,1,0,1,0,1, roller_axis='x'":
        "a body with a prescribed motion has no rollers",
    "roller_box=2,3,0,1,0,1, roller_axis='x'": "holds no particle",
    "variable_h=.true., h_range=1.2,0.7": "the lower bound comes first",
}  # fmt: skip


@pytest.mark.parametrize("line", BAD)
def test_bad_supports(tmp_path, line):
    deck = f"&run t_end=1e-6 /\n{STEEL}&body id='b', box=0,0.01, 0,0.006, 0,0.004, "
    (tmp_path / "bad.nml").write_text(deck + f"spacing=1e-3, material='s', {line} /\n")
    done = subprocess.run([BRISANCE, "run", "bad.nml"], cwd=tmp_path, capture_output=True,
                          text=True)  # fmt: skip
    assert done.returncode == 2, done.stdout
    assert "bad.nml:3: &body" in done.stderr and BAD[line] in done.stderr


PARTS = """\
&run t_end=1e-6 /
&material id='p', preset='cfrp_ud' /
&body id='l', box=0,0.012, 0,0.008, 0,0.006, spacing=1e-3, material='p', plies='0/90/0',
    delamination='cohesive', {} /
&interaction bodies='l','l', law='cohesive', tensile_strength=3e7, shear_strength=3e7, gi=100,
    gii=300 /
"""


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ("fix_box=0,0.001,0,1,0,0.001, roller_box=0.011,1,0,1,0,0.001, roller_axis='z'", ""),
        ("fix_box=0,0.001,0,1,0,0.001, 1,2,0,1,0,1", "warning: fix_box 2 holds no particle"),
        ("roller_box=1,2,0,1,0,1, roller_axis='z'", "roller_box 1 holds no particle"),
    ],
)
def test_boxes_hold_particles_of_any_ply(tmp_path, keys, words):
    """Lines below the lowest ply of three that are laid as bodies of their own."""
    (tmp_path / "deck.nml").write_text(PARTS.format(keys))
    done = subprocess.run([BRISANCE, "run", "deck.nml"], cwd=tmp_path, capture_output=True,
                          text=True)  # fmt: skip
    assert done.returncode == (2 if "roller_box 1" in words else 0), done.stderr
    assert (words in done.stderr) if words else "holds no" not in done.stderr
    assert done.stderr.count("holds no") == (words != "")


def lattice(box, spacing):
    """Places of the particles of a box."""
    axes = [np.arange(low + spacing / 2, high, spacing) for low, high in box]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def test_velocities_of_a_file_are_those_of_a_spin(tmp_path):
    box = [(0, 0.01), (0, 0.006), (0, 0.004)]
    x = lattice(box, 1e-3)
    v = np.cross([1e3, 2e3, 3e3], x - [0.005, 0.003, 0.002]) + [1, 2, 3]
    order = np.random.default_rng(3).permutation(len(x))
    table = np.hstack([x, v])[order]
    head = "x[m],y[m],z[m],velocity_x[m/s],velocity_y,velocity_z"
    np.savetxt(tmp_path / "v.csv", table, fmt="%.17g", delimiter=",", header=head, comments="")
    body = "&body id='b', box=0,0.01, 0,0.006, 0,0.004, spacing=1e-3, material='s', {} /\n"
    tail = "&output history_every=1e-7, dump_every=1 /\n"
    wanted, got = (
        run(tmp_path, f"&run t_end=1e-6 /\n{STEEL}{body.format(keys)}{tail}")["bodies"]
        for keys in ("velocity=1,2,3, spin=1e3,2e3,3e3", "start_file='v.csv'")
    )
    for name, column in wanted.items():
        scale = abs(column).max() + 1e-30
        assert (
            abs(got[name] - column).max() < 1e-6 * scale or "internal" in name or "velocity" in name
        )
    assert got["b:kinetic[J]"] == pytest.approx(wanted["b:kinetic[J]"], rel=1e-9)
    dump = next((tmp_path / "out" / "load").glob("solid_00000.vtkhdf")).rename(
        tmp_path / "s.vtkhdf"
    )
    again = run(tmp_path, f"&run t_end=1e-6 /\n{STEEL}"
                + body.format(f"start_file='{dump.name}'") + tail)["bodies"]  # fmt: skip
    assert again["b:kinetic[J]"] == pytest.approx(wanted["b:kinetic[J]"], rel=1e-5)


def test_a_bar_that_starts_with_half_of_it_pressed(tmp_path):
    """d'Alembert: waves of half the stress run both ways from the middle, the material between
    them moves with p/(2 rho c); the energy of the start is in the diagnostics."""
    p, spacing = 1e6, 5e-4
    ratio = NU / (1 - NU)
    x = (np.arange(200) + 0.5) * spacing
    low = -p * (x < 0.05)
    rows = np.stack([x, 0 * x, 0 * x, low, ratio * low, ratio * low], axis=1)
    head = "x,y,z,stress_xx,stress_yy,stress_zz"
    np.savetxt(tmp_path / "s.csv", rows, fmt="%.17g", delimiter=",", header=head, comments="")
    deck = f"""\
&run t_end=6e-6, dimension=1 /
{STEEL}
&body id='b', box=0,0.1, 0,1, 0,1, spacing={spacing}, material='s', start_file='s.csv' /
&gauge id='v', body='b', at=0.05,0,0, quantity='velocity_x' /
&gauge id='s', body='b', at=0.04,0,0, quantity='stress_xx' /
&gauge id='t', body='b', at=0.06,0,0, quantity='stress_yy' /
&output history_every=1e-6, dump_every=1 /
"""
    tables = run(tmp_path, deck)
    g = gauges(tables)
    modulus = YOUNG * (1 - NU) / (1 + NU) / (1 - 2 * NU)
    speed = p / 2 / math.sqrt(RHO * modulus)
    for name, exact in (("v", speed), ("s", -p / 2), ("t", -ratio * p / 2)):
        note(f"start_{name}", g[name][-1] / exact)
        assert g[name][-1] == pytest.approx(exact, rel=0.01)
    energy = tables["energy"]
    assert abs(energy["error[-]"]).max() < 2e-3  # of the jump, in the first steps
    assert energy["solid_internal[J]"][0] == pytest.approx(0.05 * p**2 / 2 / modulus, rel=1e-4)


def test_strains_of_a_table_are_its_stresses_and_a_dump_has_them(tmp_path):
    """Hooke's law at the start; a bar that starts from the dump of another has its stress."""
    box = [(0, 0.004), (0, 0.003), (0, 0.003)]
    x = lattice(box, 1e-3)
    rng = np.random.default_rng(5)
    e = 1e-5 * rng.standard_normal((len(x), 6))
    lame, shear = YOUNG * NU / (1 + NU) / (1 - 2 * NU), YOUNG / 2 / (1 + NU)
    s = 2 * shear * e
    s[:, :3] += lame * e[:, :3].sum(1, keepdims=True)
    parts = ("xx", "yy", "zz", "xy", "yz", "xz")
    for name, values in (("strain", e), ("stress", s)):
        head = "x,y,z," + ",".join(f"{name}_{part}" for part in parts)
        np.savetxt(tmp_path / f"{name}.csv", np.hstack([x, values]), fmt="%.17g", delimiter=",",
                   header=head, comments="")  # fmt: skip
    body = "&body id='b', box=0,0.004, 0,0.003, 0,0.003, spacing=1e-3, material='s', {} /\n"
    where = ["start_file='strain.csv'", "start_file='stress.csv'",
             "start_file='s.vtkhdf', start_stress=.true."]  # fmt: skip
    found = []
    for keys in where:
        run(tmp_path, f"&run t_end=1e-6, max_steps=0 /\n{STEEL}" + body.format(keys))
        dump = next((tmp_path / "out" / "load").glob("solid_00000.vtkhdf"))
        with h5py.File(dump) as f:
            order = np.argsort(np.asarray(f["VTKHDF/PointData/id"]))
            found.append(np.asarray(f["VTKHDF/PointData/stress"])[order])
        (tmp_path / "s.vtkhdf").write_bytes(dump.read_bytes())
    largest = abs(found[1]).max()
    assert largest > 1e5
    assert max(abs(other - found[1]).max() for other in (found[0], found[2])) < 1e-6 * largest


def test_one_end_held_the_other_driven(tmp_path):
    """Two bonded bodies with motions of their own: a wave of rho c v passes the bond, doubles at
    the end that is held, and comes back to the driven end."""
    deck = f"""\
&run t_end=1.6e-5, dimension=1 /
{STEEL}
&body id='a', box=0,0.02, 0,1, 0,1, spacing=1e-4, material='s', fix='x-' /
&body id='b', box=0.02,0.04, 0,1, 0,1, spacing=1e-4, material='s', fix='x+',
    motion_time=0,1e-6, motion_velocity=0,0,0, 5,0,0 /
&interaction law='bonded' /
&gauge id='s', body='a', at=0.005,0,0, quantity='stress_xx' /
&gauge id='t', body='b', at=0.035,0,0, quantity='stress_xx' /
&gauge id='h', body='a', quantity='reaction_x' /
&output history_every=1e-7, dump_every=1 /
"""
    tables = run(tmp_path, deck)
    g, time = gauges(tables), tables["gauges"]["time[s]"]
    modulus = YOUNG * (1 - NU) / (1 + NU) / (1 - 2 * NU)
    wave = 5 * math.sqrt(RHO * modulus)
    for name, first, last, exact in (("t", 3e-6, 1.1e-5, 1), ("s", 9.6e-6, 1.6e-5, 2),
                                     ("h", 9e-6, 1.5e-5, 2)):  # fmt: skip
        late = g[name][(time > first) & (time < last)] / wave
        error = abs(late / exact - 1).max()
        note(f"two_motions_{name}", error)
        assert error < 2e-3
    assert abs(g["s"][time < 4e-6]).max() < 1e-6 * wave  # nothing before it arrives


@pytest.mark.parametrize(("keys", "why"), [
    ("start_file='none.csv'", "bad.nml:3: &body id='b': there is no file 'none.csv'"),
    ("start_file='bad.nml'", "bad.nml"),
    ("start_file='x.csv'", "must have the columns"),
    ("start_file='v.csv', formulation='rigid'", "give a rigid one velocity and spin"),
    ("start_file='e.csv'", "has stresses and strains"),
    ("start_file='s.csv'", "only a body of model='linear_elastic'"),
])  # fmt: skip
def test_bad_start_files(tmp_path, keys, why):
    (tmp_path / "x.csv").write_text("x,y,z\n0,0,0\n")
    (tmp_path / "v.csv").write_text("x,y,z,velocity_x\n0,0,0,1\n")
    (tmp_path / "s.csv").write_text("x,y,z,stress_xx\n0,0,0,1\n")
    (tmp_path / "e.csv").write_text("x,y,z,stress_xx,strain_xx\n0,0,0,1,1\n")
    material = STEEL if "s.csv" not in keys else "&material id='s', preset='ofhc_copper' /\n"
    deck = f"&run t_end=1e-6 /\n{material}&body id='b', box=0,0.01, 0,0.006, 0,0.004, "
    (tmp_path / "bad.nml").write_text(deck + f"spacing=1e-3, material='s', {keys} /\n")
    done = subprocess.run([BRISANCE, "run", "bad.nml"], cwd=tmp_path, capture_output=True,
                          text=True)  # fmt: skip
    assert done.returncode in (2, 4) and why in done.stderr
