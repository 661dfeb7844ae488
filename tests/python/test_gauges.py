# SPDX-License-Identifier: MIT
"""Gauges of bodies against exact answers: forces on what holds them, moments, impulses, stress."""

import subprocess

import numpy as np
import pytest
from notes import note
from test_loads import BLOCK, BRISANCE, STEEL, run

END = "&output history_every=1e-12, dump_every=1 /\n"


def gauges(tables):
    """Columns of gauges.csv by the name of the gauge."""
    return {name.split(":")[0]: column for name, column in tables["gauges"].items()}


def whole(body, *names):
    """Gauges of a whole body in all three directions."""
    return "".join(
        f"&gauge id='{body}_{name}_{a}', body='{body}', quantity='{name}_{a}' /\n"
        for name in names
        for a in "xyz"
    )


@pytest.mark.parametrize("form", ["auto", "corrected_hourglass", "total_lagrangian", "rigid"])
def test_momentum_balances(tmp_path, form):
    """Impulse of the load = change of momentum + impulse on what holds the body, at every step."""
    hold = "fix='all'" if form == "rigid" else "fix='x-'"
    deck = (
        f"&run t_end=4e-6, dt_max=2e-8 /\n{STEEL}"
        + f"""\
&body id='b', box=0,0.01, 0,0.006, 0,0.004, spacing=1e-3, material='s', formulation='{form}',
    {hold} /
&body id='f', box=0.02,0.03, 0,0.006, 0,0.004, spacing=1e-3, material='s', formulation='{form}' /
&load body='b', faces='x+', time=0,2e-6,4e-6, pressure=0,1e8,0 /
&load body='f', faces='x+','y-', time=0,2e-6,4e-6, pressure=0,1e8,0 /
&load body='f', acceleration=0,0,-1e6 /
{whole("b", "reaction", "load", "impulse")}{whole("f", "impulse")}{END}"""
    )
    tables = run(tmp_path, deck)
    g, b = gauges(tables), tables["bodies"]
    scale = 1e8 * 2e-6 * 0.006 * 0.004
    dt = np.diff(tables["gauges"]["time[s]"])
    worst = 0
    for a in "xyz":
        got = b["f:mass[kg]"] * b[f"f:velocity_{a}[m/s]"]
        worst = max(worst, abs(got - g[f"f_impulse_{a}"]).max())
        got = b["b:mass[kg]"] * b[f"b:velocity_{a}[m/s]"] + b[f"b:reaction_{a}[N s]"]
        if form != "rigid":  # the impulse on its support has that of the half step to come
            got[1:] -= dt / 2 * g[f"b_reaction_{a}"][1:]
        # the last two steps are shorter, and the force on a support is that of steps of one length
        worst = max(worst, abs(got - g[f"b_impulse_{a}"])[:-2].max())
        # the load of a step acts all through it
        assert np.cumsum(dt * g[f"b_load_{a}"][1:]) == pytest.approx(
            g[f"b_impulse_{a}"][1:], abs=1e-10 * scale)  # fmt: skip
        kick = np.diff(b[f"b:reaction_{a}[N s]"])
        assert dt * g[f"b_reaction_{a}"][1:] == pytest.approx(kick, abs=1e-10 * scale)
    note(f"gauge_balance_{form}", worst / scale)
    assert worst < 1e-10 * scale
    assert g["b_reaction_x"].min() < -1000


def stl(*quads):
    """Text of an STL file: two triangles for each quadrangle."""
    text = "solid patch\n"
    for a, b, c, d in quads:
        for corners in ((a, b, c), (a, c, d)):
            text += "facet normal 0 0 0\nouter loop\n"
            text += "".join(f"vertex {x} {y} {z}\n" for x, y, z in corners)
            text += "endloop\nendfacet\n"
    return text + "endsolid patch\n"


@pytest.mark.parametrize("shape", ["flat", "bent"])
def test_moment_of_a_pressure_on_a_patch(tmp_path, shape):
    """p on 3 mm x 2 mm of a face, off its middle: force p A, moment by the arm to the middle of the
    patch, also where the surface of the file lies beside the face."""
    low, high = (-5e-4, 8e-4) if shape == "bent" else (0, 0)
    quad = ((low, 0.002, 0.001), (high, 0.005, 0.001), (high, 0.005, 0.003), (low, 0.002, 0.003))
    (tmp_path / "p.stl").write_text(stl(quad))
    deck = (
        f"&run t_end=1e-6 /\n{STEEL}"
        + f"""\
&body id='b', box=0,0.01, 0,0.006, 0,0.004, spacing=1e-3, material='s', formulation='rigid',
    fix='all' /
&load body='b', faces='x-','x+', pressure=1e8, patch='p.stl' /
{whole("b", "reaction")}
&gauge id='my', body='b', quantity='moment_y', at=0.01,0.001,-0.002 /
&gauge id='mz', body='b', quantity='moment_z', at=0.01,0.001,-0.002 /
{END}"""
    )
    g = {name: column[-1] for name, column in gauges(run(tmp_path, deck)).items()}
    force = 1e8 * 6e-6
    assert g["b_reaction_x"] == pytest.approx(force, rel=1e-12)
    assert abs(g["b_reaction_y"]) + abs(g["b_reaction_z"]) < 1e-12 * force
    assert g["my"] == pytest.approx(force * (0.002 + 0.002), rel=1e-9)
    assert g["mz"] == pytest.approx(-force * (0.0035 - 0.001), rel=1e-9)


@pytest.mark.parametrize(("keys", "why"), [
    ("faces='x-', pressure=1, patch='none.stl'", "none.stl"),
    ("pressure=1, patch='p.stl'", "a patch lies on faces of the body"),
    ("faces='y+', pressure=1, patch='p.stl'", "on these faces under the patch"),
])  # fmt: skip
def test_bad_patches(tmp_path, keys, why):
    (tmp_path / "p.stl").write_text(
        stl(((0, 0, 0), (0, 0.006, 0), (0, 0.006, 0.004), (0, 0, 0.004)))
    )
    deck = (
        "&run t_end=1e-6 /\n" + BLOCK.format(dx=1e-3, form="auto") + f"&load body='b', {keys} /\n"
    )
    (tmp_path / "bad.nml").write_text(deck)
    done = subprocess.run([BRISANCE, "run", "bad.nml"], cwd=tmp_path, capture_output=True,
                          text=True)  # fmt: skip
    assert done.returncode in (2, 4) and why in done.stderr


def test_load_on_the_support_itself_is_recorded_once(tmp_path):
    """A body that is held everywhere takes up its weight, from the first step on."""
    deck = (
        f"&run t_end=1e-6 /\n{STEEL}"
        + f"""\
&body id='b', box=0,0.01, 0,0.006, 0,0.004, spacing=1e-3, material='s', fix='all' /
&load body='b', acceleration=0,0,-1e6 /
{whole("b", "impulse")}{END}"""
    )
    tables = run(tmp_path, deck)
    b = tables["bodies"]
    exact = -b["b:mass[kg]"][0] * 1e6 * b["time[s]"]
    assert b["b:reaction_z[N s]"] == pytest.approx(exact, rel=1e-12)
    assert gauges(tables)["b_impulse_z"] == pytest.approx(exact, rel=1e-12)


def test_weight_of_a_body_on_its_support(tmp_path):
    """A soft block that is held from below swings about its weight, in the mean over a period; a
    rigid one that may not fall rests on its support with all of it, and with its moment."""
    pull = 1e4
    for form in ("auto", "rigid"):
        hold = "fix='z-'" if form == "auto" else "fix='all'"
        deck = (
            f"&run t_end=4e-5 /\n{STEEL}"
            + f"""\
&body id='b', box=0,0.01, 0,0.006, 0,0.004, spacing=1e-3, material='s', {hold},
    formulation='{form}', alpha=1 /
&load body='b', acceleration=0,0,{-pull} /
{whole("b", "reaction")}
&gauge id='m', body='b', quantity='moment_y', at=0.002,0,0 /
&output history_every=1e-7, dump_every=1 /
"""
        )
        tables = run(tmp_path, deck)
        g = gauges(tables)
        weight = tables["bodies"]["b:mass[kg]"][0] * pull
        late = tables["gauges"]["time[s]"] > (2e-5 if form == "auto" else 1e-7)
        # alpha=1 has damped the wave, of period 4*3.5e-3/5860 = 2.4 us, by then
        tol = 5e-3 if form == "auto" else 1e-12
        assert -g["b_reaction_z"][late].mean() == pytest.approx(weight, rel=tol)
        assert g["m"][late].mean() == pytest.approx(weight * 0.003, rel=tol)
        note(f"gauge_weight_{form}", -g["b_reaction_z"][late].mean() / weight)


@pytest.mark.parametrize("form", ["auto", "corrected_hourglass"])
def test_contact_of_two_bodies_is_equal_and_opposite(tmp_path, form):
    """Two blocks meet: the force of each on the other, and its integral is the momentum that
    changes hands."""
    block = "box={0},{1}, 0,0.004, 0,0.004, spacing=1e-3, material='s'"
    deck = (
        f"&run t_end=8e-6, dt_max=2e-8 /\n{STEEL}"
        + f"""\
&body id='a', {block.format(0, 0.004)}, velocity=20,3,0, formulation='{form}' /
&body id='c', {block.format(0.00405, 0.00805)}, formulation='{form}' /
&interaction law='contact', friction=0.2 /
{whole("a", "contact")}{whole("c", "contact")}{END}"""
    )
    tables = run(tmp_path, deck)
    g, b = gauges(tables), tables["bodies"]
    dt = np.diff(tables["gauges"]["time[s]"])[:-2]
    scale = b["a:mass[kg]"][0] * 20
    for axis in "xyz":
        force = g[f"a_contact_{axis}"][1:-2]
        assert force == pytest.approx(-g[f"c_contact_{axis}"][1:-2], abs=1e-10 * scale / dt[0])
        got = b["a:mass[kg]"] * b[f"a:velocity_{axis}[m/s]"]
        # at a step the velocity has half of the kick that its force gives
        passed = np.cumsum(dt * force) - dt / 2 * force
        assert got[1:-2] - got[0] == pytest.approx(passed, abs=1e-10 * scale)
    assert g["a_contact_x"].min() < -1000 and abs(g["a_contact_y"]).max() > 10


def between(body, other):
    """Gauges of what another body does to a body."""
    return "".join(
        f"&gauge id='{body}{other}_{name}_{a}', body='{body}', with='{other}', "
        f"quantity='{name}_{a}' /\n"
        for name in ("contact", "impulse")
        for a in "xyz"
    )


@pytest.mark.parametrize("middle", ["auto", "corrected_hourglass", "rigid"])
def test_forces_between_three_bodies(tmp_path, middle):
    """A block is struck and strikes a third: the forces of each pair are equal and opposite and add
    up to what all others do, and impulses are the momentum that changes hands."""
    block = "box={0},{1}, 0,0.004, 0,0.004, spacing=1e-3, material='s'"
    deck = (
        f"&run t_end=8e-6, dt_max=2e-8 /\n{STEEL}"
        + f"""\
&body id='a', {block.format(0, 0.004)}, velocity=20,3,0 /
&body id='c', {block.format(0.00405, 0.00805)}, formulation='{middle}' /
&body id='d', {block.format(0.0081, 0.0121)}, velocity=-30,0,-2 /
&interaction law='contact', friction=0.2 /
{between("a", "c")}{between("c", "a")}{between("c", "d")}{between("d", "c")}{between("a", "d")}
{whole("c", "contact")}{END}"""
    )
    tables = run(tmp_path, deck)
    g, b = gauges(tables), tables["bodies"]
    dt = np.diff(tables["gauges"]["time[s]"])
    scale = b["a:mass[kg]"][0] * 20
    worst = 0
    for axis in "xyz":
        for one, two in ("ac", "cd"):
            for name, unit in (("contact", dt[0]), ("impulse", 1)):
                here, there = g[f"{one}{two}_{name}_{axis}"], g[f"{two}{one}_{name}_{axis}"]
                assert here == pytest.approx(-there, abs=1e-11 * scale / unit)
        both = g[f"ca_contact_{axis}"] + g[f"cd_contact_{axis}"]
        assert both[1:] == pytest.approx(g[f"c_contact_{axis}"][1:], abs=1e-9 * scale / dt[0])
        for body, given in (("a", g[f"ac_impulse_{axis}"]), ("d", g[f"dc_impulse_{axis}"]),
                            ("c", g[f"ca_impulse_{axis}"] + g[f"cd_impulse_{axis}"])):  # fmt: skip
            got = b[f"{body}:mass[kg]"] * b[f"{body}:velocity_{axis}[m/s]"]
            worst = max(worst, np.abs(got - got[0] - given).max() / scale)
        assert not g[f"ad_impulse_{axis}"].any()
    note("gauge_between", worst)
    assert worst < 1e-10
    assert g["ca_contact_x"].max() > 1000 and g["cd_contact_x"].min() < -1000
    assert g["ac_impulse_x"][-1] < -0.1 * scale and abs(g["ac_impulse_y"][-1]) > 1e-3 * scale


def test_a_block_bounces(tmp_path):
    """From an anvil, under gravity: impulse of the anvil = change of momentum + weight times time,
    and what the anvil is pressed with is what holds it."""
    deck = (
        f"&run t_end=2e-5, dt_max=2e-8 /\n{STEEL}"
        + f"""\
&body id='b', box=0,0.004, 0,0.003, 0,0.003, spacing=1e-3, material='s', velocity=0,0,-10 /
&body id='k', box=-0.001,0.005, -0.001,0.004, -0.00305,-0.00005, spacing=1e-3, material='s',
    formulation='rigid', fix='all' /
&load body='b', acceleration=0,0,-1e6 /
&interaction law='contact' /
{between("b", "k")}{between("k", "b")}{whole("k", "reaction")}{END}"""
    )
    tables = run(tmp_path, deck)
    g, b, time = gauges(tables), tables["bodies"], tables["gauges"]["time[s]"]
    mass = b["b:mass[kg]"][0]
    # a constant acceleration counts a step in full: at a step half of the next is missing
    momentum = mass * (b["b:velocity_z[m/s]"] + 10)
    given = g["bk_impulse_z"] - mass * 1e6 * time
    error = np.abs(momentum - given).max() / (mass * 10)
    note("gauge_bounce", error)
    assert error < 1e-10
    assert momentum[-1] > 1.5 * mass * 10 - mass * 1e6 * time[-1]
    assert g["kb_contact_z"][1:-2] == pytest.approx(g["k_reaction_z"][1:-2], abs=1e-6 * 1e3)


def test_stress_and_strain_behind_a_wave(tmp_path):
    """A bar in uniaxial strain is pressed at p: stress -p, strain -p/(lambda + 2 mu), pressure and
    equivalent stress by Hooke's law; a body that turns has no strain."""
    p, young, nu = 1e7, 200e9, 0.3
    modulus = young * (1 - nu) / (1 + nu) / (1 - 2 * nu)
    lateral = nu / (1 - nu)
    deck = (
        f"&run t_end=1.6e-5, dimension=1 /\n{STEEL}"
        + f"""\
&body id='b', box=0,0.1, 0,1, 0,1, spacing=1e-3, material='s' /
&load body='b', faces='x-', pressure={p} /
&gauge id='sx', body='b', at=0.03,0,0, quantity='stress_xx' /
&gauge id='sy', body='b', at=0.03,0,0, quantity='stress_yy' /
&gauge id='p', body='b', at=0.03,0,0, quantity='pressure' /
&gauge id='m', body='b', at=0.03,0,0, quantity='von_mises' /
&gauge id='d', body='b', at=0.03,0,0, quantity='density' /
&gauge id='e', body='b', at=0.025,0,0, to=0.035,0,0, quantity='strain' /
&output history_every=1e-6, dump_every=1 /
"""
    )
    g = {name: column[-1] for name, column in gauges(run(tmp_path, deck)).items()}
    exact = {"sx": -p, "sy": -p * lateral, "p": p * (1 + 2 * lateral) / 3, "m": p * (1 - lateral),
             "d": 7800 * (1 + p / modulus), "e": -p / modulus}  # fmt: skip
    for name, value in exact.items():
        note(f"gauge_{name}", g[name] / value)
        assert g[name] == pytest.approx(value, rel=5e-3), name
    turn = (
        f"&run t_end=1e-5 /\n{STEEL}"
        + """\
&body id='b', box=0,0.01, 0,0.006, 0,0.004, spacing=1e-3, material='s', formulation='rigid',
    spin=1e4,2e4,3e4 /
&gauge id='e', body='b', at=0,0,0, to=0.01,0.006,0.004, quantity='strain' /
&output history_every=1e-6, dump_every=1 /
"""
    )
    assert abs(gauges(run(tmp_path, turn))["e"]).max() < 1e-12


def test_a_drawn_bar_has_its_stress_as_principal_tension(tmp_path):
    """Drawn along its axis: that stress is the largest; the wave that comes back presses."""
    deck = f"""\
&run t_end=6e-5, dimension=1 /
{STEEL}&body id='b', box=0,0.1, 0,1, 0,1, spacing=1e-3, material='s', fix='x-',
    motion_time=0,1e-6,1.5e-5,1.6e-5, motion_velocity=0,0,0, -1,0,0, -1,0,0, 0,0,0 /
&gauge id='x', body='b', at=0.03,0,0, quantity='stress_xx' /
&gauge id='t', body='b', at=0.03,0,0, quantity='principal_tension' /
&output history_every=1e-6, dump_every=1 /
"""
    g = gauges(run(tmp_path, deck))
    assert g["x"].max() > 1e7
    assert g["x"].min() < -1e7
    np.testing.assert_allclose(g["t"], np.maximum(g["x"], 0), rtol=1e-6, atol=1e3)


def test_metal_that_yields_shows_plastic_strain_and_heat(tmp_path):
    """Compressed evenly in one dimension: equivalent strain 2/3 of the strain less the elastic one,
    heated by 0.9 of the plastic work."""
    deck = """\
&run t_end=2e-5, dimension=1 /
&material id='c', preset='ofhc_copper', d1=1e3 /
&body id='b', box=0,0.1, 0,1, 0,1, spacing=1e-3, material='c', fix='x-', motion_time=0,1e-6,
    motion_velocity=0,0,0, 100,0,0 /
&gauge id='e', body='b', at=0.02,0,0, quantity='plastic_strain' /
&gauge id='t', body='b', at=0.02,0,0, quantity='temperature' /
&gauge id='x', body='b', at=0.015,0,0, to=0.025,0,0, quantity='strain' /
&gauge id='m', body='b', at=0.02,0,0, quantity='von_mises' /
&output history_every=1e-8, dump_every=1 /
"""
    rows = gauges(run(tmp_path, deck))
    g = {name: column[-1] for name, column in rows.items()}
    exact = -2 / 3 * g["x"] - g["m"] / 3 / 46e9
    assert g["x"] < -0.015 and g["m"] > 9e7
    note("gauge_plastic", g["e"] / exact)
    assert g["e"] == pytest.approx(exact, rel=0.03)
    stress = (rows["m"][1:] + rows["m"][:-1]) / 2
    heat = 0.9 * np.sum(stress * np.diff(rows["e"])) / 8960 / 383
    assert g["t"] - 293 == pytest.approx(heat, rel=0.02)


BAD = {
    "quantity='stress_xx', at=0,0,0": "add body='...'",
    "quantity='overpressure', at=0,0,0, body='b'": "is that of the air: take body out",
    "quantity='strain', at=0,0,0, body='b'": "add to = x, y, z",
    "quantity='damage', at=0,0,0, to=0.01,0,0, body='b'": "to belongs to quantity='strain'",
    "quantity='strain', at=0,0,0, to=1e-5,0,0, body='b'": "both ends of the strain gauge are one",
    "quantity='strain', at=0,0,0, to=1,0,0, body='b'": "lies outside the body",
    "quantity='plastic_strain', at=0,0,0, body='b'": "keeps no plastic_strain",
    "quantity='reaction_x', body='b'": "nothing holds body b",
    "quantity='reaction_x', at=0,0,0, body='b'": "is that of the whole body; take at out",
    "quantity='moment_x', body='b'": "add at = x, y, z",
    "quantity='speed', body='b'": "add at = x, y, z",
    "quantity='impulse_x', body='b'": "is that of the air or of a &load",
    "quantity='contact_x'": "add body='...'",
    "quantity='contact_x', body='b', with='c'": "there is no &body with id='c'",
    "quantity='contact_x', body='b', with='b'": "a body does nothing to itself",
    "quantity='reaction_x', body='b', with='b'": "with belongs to quantity='contact_x'",
}


@pytest.mark.parametrize("line", BAD)
def test_bad_gauges(tmp_path, line):
    deck = "&run t_end=1e-6 /\n" + BLOCK.format(dx=1e-3, form="auto")
    (tmp_path / "bad.nml").write_text(deck + f"&gauge id='g', {line} /\n")
    done = subprocess.run([BRISANCE, "run", "bad.nml"], cwd=tmp_path, capture_output=True,
                          text=True)  # fmt: skip
    assert done.returncode == 2
    assert "bad.nml:5: &gauge" in done.stderr and BAD[line] in done.stderr


def test_forces_through_a_bond_are_refused(tmp_path):
    two = BLOCK.format(dx=1e-3, form="auto")
    two += "&body id='c', box=0.01,0.02,0,0.006,0,0.004, spacing=1e-3, material='s' /\n"
    two += "&interaction law='bonded' /\n&gauge id='g', body='b', with='c', quantity='contact_x' /"
    (tmp_path / "bad.nml").write_text("&run t_end=1e-6 /\n" + two)
    done = subprocess.run([BRISANCE, "run", "bad.nml"], cwd=tmp_path, capture_output=True,
                          text=True)  # fmt: skip
    assert done.returncode == 2 and "do not meet by law='contact'" in done.stderr


def test_contact_across_a_plane_of_symmetry_is_refused(tmp_path):
    deck = "&run t_end=1e-6, symmetry='x' /\n" + BLOCK.format(dx=1e-3, form="auto")
    (tmp_path / "bad.nml").write_text(deck + "&gauge id='g', body='b', quantity='contact_x' /\n")
    done = subprocess.run([BRISANCE, "run", "bad.nml"], cwd=tmp_path, capture_output=True,
                          text=True)  # fmt: skip
    assert done.returncode == 2 and "what the plane of symmetry takes up" in done.stderr
