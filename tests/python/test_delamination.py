# SPDX-License-Identifier: MIT
"""Laminates that may delaminate: one body of the deck, laid as sublaminates of its plies."""

import h5py
import numpy as np
import pytest
from notes import note
from test_cohesive import on_both, run, table
from tiers import slow

# half of a clamped strip of plies, thrown
THICK, GAUGES = 0.0005, 12
STRIP = """\
&run t_end={end}, dimension=2, symmetry='x' /
&material id='m', preset='cfrp_ud', gdl=500 /
&body id='plate', box=0,{side}, 0,{high}, 0,1, spacing=0.0005, material='m', plies='{plies}',
  ply_axis='y', fix='x+', velocity=0,0.01,0 {delamination} /
&output history_every={every} /
"""


def swing(folder, plies, size, end, delamination):
    """When a strip is first back, by its deflection weighted with about its first mode [s].

    size: the free half of it, and with what is held [m]
    """
    half, side = size
    high = THICK * len(plies.split("/"))
    deck = STRIP.format(
        side=side, plies=plies, high=high, end=end, every=end / 200, delamination=delamination
    )
    for k in range(GAUGES):
        deck += f"&gauge id='g{k}', body='plate', quantity='displacement_y', "
        deck += f"at={(k + 0.5) * half / GAUGES},{high / 2 + 1e-6},0 /\n"
    run(folder, deck, "--replace")
    data = np.genfromtxt(folder / "out/glue/gauges.csv", delimiter=",", skip_header=1)
    shape = np.cos(np.pi / 2 * (np.arange(GAUGES) + 0.5) / GAUGES) ** 2
    move = data[:, 1:] @ shape
    top = int(np.argmax(move))
    after = top + int(np.argmax(move[top:] < 0))
    assert after > top
    share = move[after - 1] / (move[after - 1] - move[after])
    return data[after - 1, 0] + share * (data[after, 0] - data[after - 1, 0])


# omega a^2/h sqrt(rho/E1) of clamped strips by elasticity in plane strain, of so many columns of
# particles in half of the side: studies/plate_reference.py SIDE, where fibres at 0 lie along
ELASTIC = {
    "90/0/0/90": (20.5, 3.5497),
    "0/90/90/0": (20.5, 2.2615),
    "0/90/90/0/0/90/90/0": (40.5, 2.9110),
}


@pytest.mark.parametrize("plies", ELASTIC)
def test_a_short_strip_swings_by_elasticity(tmp_path, plies):
    """Stiff or soft plies outside: shear decides, and most of it is between plies of one angle.

    The clamp is where it acts: the first held particle lies on the edge of the strip.
    """
    columns, exact = ELASTIC[plies]
    high = THICK * len(plies.split("/"))
    side = 2 * columns * THICK
    period = 2 * np.pi / exact * side**2 / high * np.sqrt(1550 / 150e9)
    size = side / 2, (columns + 2.5) * THICK
    back = swing(tmp_path, plies, size, 0.62 * period, ", delamination='cohesive'")
    note("short_strip_" + plies.replace("/", ""), 100 * (2 * back / period - 1))
    assert 2 * back == pytest.approx(period, rel=0.02)


@pytest.mark.slow
def test_a_clamped_strip_swings_as_without_interfaces(tmp_path):
    """Four plies of one layer each, side 30 thicknesses: the same period within 2 %."""
    half = 60 * THICK
    plain, glued = (
        swing(tmp_path, "90/0/0/90", (half, half + 3 * THICK), 2e-4, more)
        for more in ("", ", delamination='cohesive'")
    )
    note("strip_of_plies", 100 * (glued / plain - 1))
    assert glued == pytest.approx(plain, rel=0.02)
    energy = table(tmp_path, "energy")
    assert abs(energy["error[-]"][-1]) < 1e-3
    assert energy["bond_heat[J]"][-1] == 0 < energy["bond[J]"].max()


# plies that are drawn apart by a rigid plate; they hold on to a wall below
PEEL = """\
&run t_end=4e-5, dimension=2 /
&material id='m', preset='cfrp_ud', gdl=500, zt=60e6 /
&body id='plate', box=0,0.01, 0,0.002, 0,1, spacing=0.0005, material='m', plies='0/90/90/0',
  ply_axis='y', fix_box=-1,1, -1,0.0005, -1,1, delamination='cohesive', {keys} /
&body id='tool', box=0,0.01, 0.002,0.004, 0,1, spacing=0.0005, material='m',
  formulation='rigid', motion_time=0,1, motion_velocity=0,1,0, 0,1,0 /
&interaction bodies='tool','plate', law='contact' /
&interaction bodies='tool','plate.{top}', law='cohesive', tensile_strength=1e9, shear_strength=1e9,
  gi=1e6, gii=1e6 /
&gauge id='g', body='plate', at=0.005,0.0019,0, quantity='velocity_y' /
&output history_every=1e-6, dump_every=4e-5, checkpoint_every=1e-5 /
"""


def test_plies_come_apart_where_they_may(tmp_path):
    """Pulled apart, one interface breaks and takes gdl times its area; the rest stays whole."""
    deck = PEEL.format(keys="interfaces='angles'", top=3)
    done = run(tmp_path, deck, "--check")
    for word in ("plate.1+plate.2: 20 points", "plate.2+plate.3: 20 points", "plate.3+tool"):
        assert word in done.stdout
    run(tmp_path, deck)
    bodies = table(tmp_path, "bodies")
    broken = [bodies[f"{pair}:broken[m2]"][-1] for pair in ("plate.1+plate.2", "plate.2+plate.3")]
    heat = [bodies[f"{pair}:bond_heat[J]"][-1] for pair in ("plate.1+plate.2", "plate.2+plate.3")]
    assert sum(broken) == pytest.approx(0.01)
    assert max(heat) == pytest.approx(500 * 0.01, rel=0.01)
    assert min(heat) < 0.2 * max(heat)
    assert abs(table(tmp_path, "energy")["error[-]"][-1]) < 5e-3
    echo = (tmp_path / "out/glue/glue.echo.nml").read_text()
    assert "id = 'plate.3'" in echo and "bodies = 'plate.*', 'plate.*'" in echo
    (tmp_path / "again").mkdir()
    run(tmp_path / "again", echo, "--check")
    first = {p.name: p.read_bytes() for p in (tmp_path / "out/glue").glob("*.csv")}
    run(tmp_path, deck, "--replace", "--set", "run.max_steps=1500")
    run(tmp_path, deck, "--restart", "latest")
    for name, text in first.items():
        assert (tmp_path / "out/glue" / name).read_bytes() == text


def test_numbers_of_the_deck_come_first(tmp_path):
    """An interaction of the laminate with itself, and one of two of its parts."""
    deck = PEEL.format(keys="interfaces=1,3", top=3) + (
        "&interaction bodies='plate.1','plate.2', law='cohesive', gii=900, open_box=0,0.002,-1,1,"
        "-1,1 /\n"
    )
    run(tmp_path, deck, "--set", "run.max_steps=1")
    echo = (tmp_path / "out/glue/glue.echo.nml").read_text().split("&")
    rules = [group for group in echo if group.startswith("interaction")]
    assert "'plate.*', 'plate.*'" in rules[2] and "gii = 500.0" in rules[2]
    assert "'plate.1', 'plate.2'" in rules[3] and "gii = 900.0" in rules[3]
    assert "gi = 500.0" in rules[3] and "shear_strength = 1.12e8" in rules[3]
    assert not any(" zt = " in group for group in echo if "id = 'm.plies'" in group)
    assert any(" zt = " in group for group in echo if "id = 'm'" in group)
    deck = PEEL.format(keys="", top=4) + (
        "&interaction bodies='plate','plate', law='cohesive', gi=100, friction=0.3 /\n"
    )
    run(tmp_path, deck, "--replace", "--set", "run.max_steps=1")
    echo = (tmp_path / "out/glue/glue.echo.nml").read_text().split("&")
    rules = [group for group in echo if group.startswith("interaction")]
    assert len(rules) == 3 and "gi = 100.0" in rules[2] and "gii = 500.0" in rules[2]


STRUCK = """\
&run t_end=1e-5 /
&material id='m', preset='cfrp_ud', gdl=500 /
&material id='s', preset='steel_4340' /
&body id='plate', box=0,0.008, 0,0.008, 0,0.002, spacing=0.0005, material='m', plies='0/90/90/0',
  fix='sides', fix_layers=1, delamination='cohesive' /
&body id='ball', shape='sphere', centre=0.004,0.004,-0.0016, radius=0.0015, spacing=0.0005,
  material='s', velocity=0,0,120 /
&interaction law='contact' /
&interaction bodies='plate','plate', law='cohesive', gii=1000 /
&output history_every=2e-7, dump_every=1 /
"""


@pytest.mark.parametrize("speed", [slow(120), slow(500), slow(1000), 2000])
def test_plies_that_are_struck(tmp_path, speed):
    """What an interface releases where plies are pressed together meets by contact without an
    energy of its own: with one, a ball of 120 m/s on four plies doubled the energy. Layers that
    crumple keep their faces free of stress wherever their fibres point, and points that are broken
    press on in any place: the ball of 500 m/s ended the run before, that of 2000 m/s made 6 % of
    its energy.
    """
    ball = ("--set", f"body(ball).velocity=0,0,{speed}")
    run(tmp_path, STRUCK, "--backend", "cpu", *ball)
    energy = table(tmp_path, "energy")
    error = float(np.abs(energy["error[-]"]).max())
    note(f"struck_plies_{speed}", error)
    assert energy["bond_heat[J]"][-1] > 0.05
    assert energy["contact[J]"].max() > 0.02
    assert error < 2e-3


def test_plies_that_let_go_under_a_block(tmp_path):
    """What lets go while it touches a third body keeps the energy of that contact, whose springs
    are others, and what lies within half a spacing then takes its energy from the heat of the bond:
    a rigid block of 1.9 km/s on two plies made 1.4 % of its energy.
    """
    deck = """\
&run t_end=3e-6 /
&material id='p', preset='hjc_40_scaled' /
&material id='t', preset='cfrp_ud', gdl=500 /
&body id='plate', box=0,0.02, 0,0.02, 0,0.002, spacing=0.001, material='t', plies='0/90',
  delamination='cohesive' /
&body id='block', box=0.007,0.013, 0.007,0.013, 0.003,0.012, spacing=0.000666667, material='p',
  velocity=0,0,-1872.6, formulation='rigid' /
&interaction law='contact' /
&interaction bodies='plate','plate', law='cohesive', gii=1000 /
&output history_every=1e-7, dump_every=1 /
"""
    run(tmp_path, deck, "--backend", "cpu")
    energy = table(tmp_path, "energy")
    error = float(np.abs(energy["error[-]"]).max())
    note("block_on_plies", error)
    assert energy["bond_heat[J]"][-1] > 40
    assert error < 3e-3


@pytest.mark.parametrize("form", ["bending", "corrected_hourglass"])
def test_bonds_that_break_under_pressure(tmp_path, form):
    """The same of bonds: blocks that meet at 60 m/s and slide, until their bond breaks."""
    body = f"spacing=1e-3, material='m', formulation='{form}'"
    deck = f"""\
&run t_end=1e-5, dimension=2 /
&material id='m', model='linear_elastic', density=1000, youngs_modulus=5e9, poisson_ratio=0.3 /
&body id='low', box=0,0.012, 0,0.006, 0,1, {body}, velocity=30,30,0 /
&body id='high', box=0,0.012, 0.006,0.012, 0,1, {body}, velocity=-30,-30,0 /
&interaction bodies='low','high', law='bonded', tensile_strength=3e7, shear_strength=4e7 /
&output history_every=2e-7, dump_every=1 /
"""
    run(tmp_path, deck, "--backend", "cpu")
    energy = table(tmp_path, "energy")
    error = float(np.abs(energy["error[-]"]).max())
    note(f"breaking_bond_{form}", error)
    assert energy["contact[J]"].max() > 4
    assert error < 1.2e-2


GPU = """\
&run t_end=2.5e-6, symmetry='x' /
&material id='m', preset='cfrp_ud', gdl=100, zt=30e6, s13=50e6, s23=50e6 /
&body id='plate', box=0,0.004, 0,0.004, 0,0.002, spacing=0.0005, material='m',
  plies='0/90/45/0', delamination='cohesive', fix='y-' /
&body id='ball', shape='sphere', centre=0,0.002,0.00355, radius=0.0015, spacing=0.0005,
  material='m', formulation='bending', velocity=0,0,-120 /
&output history_every=2.5e-7, dump_every=2.5e-6, checkpoint_every=1e-6 /
"""


def test_plies_on_the_gpu(tmp_path):
    """Single layers that bend, delaminate and are hit: as on the CPU."""
    on_both(tmp_path, GPU)
    energy = table(tmp_path, "energy", "gpu")
    assert energy["bond_heat[J]"][-1] > 1e-4
    assert abs(energy["error[-]"][-1]) < 5e-3
    with (
        h5py.File(tmp_path / "cpu/solid_00001.vtkhdf") as a,
        h5py.File(tmp_path / "gpu/solid_00001.vtkhdf") as b,
    ):
        x, y = (f["VTKHDF/PointData/bond_damage"][:] for f in (a, b))
        assert np.abs(x - y).max() <= 1e-6


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (("gdl=500, ", ""), "knows nothing of gi gii: give zt, s13 or s23, gdl"),
        (("plies='0/90/90/0'", "plies='0'"), "at least two plies"),
        (("'angles'", "4"), "interfaces: '4' is not 'all', 'angles' or a number from 1"),
        (("0/90/90/0", "0/0/0/0"), "all plies have the same angle"),
        (("ply_axis='y'", "ply_axis='z'"), "change ply_axis"),
        (("fix_box", "fix='y-', fix_box"), "only edges of the plies"),
        (("spacing=0.0005, material='m', plies", "spacing=0.001, material='m', plies"),
         "larger than the thinnest sublaminate"),
        (("id='tool'", "id='plate.2'"), "has the id of another body"),
        (("delamination='cohesive', ", ""), "interfaces needs delamination='cohesive'"),
        (("delamination='cohesive'", "delamination='cohesive', formulation='rigid'"),
         "has no place with formulation"),
    ],
)  # fmt: skip
def test_refused(tmp_path, change, told):
    deck = PEEL.format(keys="interfaces='angles'", top=3)
    assert change[0] in deck
    done = run(tmp_path, deck.replace(*change), "--check", code=2)
    assert told in done.stderr and "glue.nml:" in done.stderr
    assert "does not meet itself" not in done.stderr
