# SPDX-License-Identifier: MIT
"""Charges where they cannot be what the deck says: in bodies, on floors, in closed rooms."""

import math
import os
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest

from post.blast import surface
from post.deck import Deck
from post.gauges import Gauge, expect

ROOT = Path(__file__).resolve().parents[2]
BINARY = Path(os.environ.get("BRISANCE", ROOT / "bin" / "brisance"))


def brisance(folder, deck, *args):
    """Exit code and all that was printed."""
    (folder / "case.nml").write_text(deck, encoding="utf-8")
    done = subprocess.run(
        [BINARY, "run", "case.nml", *args],
        cwd=folder,
        capture_output=True,
        timeout=60,
        check=False,
        text=True,
        env={**os.environ, "OMP_NUM_THREADS": "1"},
    )
    return done.returncode, done.stdout + done.stderr


# The radius of the charge is 36.7 mm, four cells and a half.
SCENE = """&run t_end=1e-6 /
&air box=-0.1,0.1,-0.1,0.1,-0.1,0.1, cells=24,24,24 /
&material id='s', model='linear_elastic', density=7850, youngs_modulus=200e9, poisson_ratio=0.3 /
"""
HALF = """&run t_end=1e-6, symmetry='z' /
&air box=-0.1,0.1,-0.1,0.1,0,0.1, cells=24,24,12,
     bc='outflow','outflow','outflow','outflow','symmetry','outflow' /
&material id='s', model='linear_elastic', density=7850, youngs_modulus=200e9, poisson_ratio=0.3 /
"""
BALL = "&charge id='c', mass=0.3375, at=0,0,0 /\n"
TETRAHEDRON = ((0.09, 0.09, 0.09), (0.09, -0.09, -0.09), (-0.09, 0.09, -0.09), (-0.09, -0.09, 0.09))


def stl(path):
    """A tetrahedron as an STL file of text."""
    faces = ((0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2))
    rows = ["solid t"]
    for face in faces:
        rows += ["facet normal 0 0 0", "outer loop"]
        rows += ["vertex {} {} {}".format(*TETRAHEDRON[k]) for k in face]
        rows += ["endloop", "endfacet"]
    path.write_text("\n".join([*rows, "endsolid t"]) + "\n", encoding="utf-8")


def particles(path):
    """A block of 83 x 83 x 45 mm in a table of particles."""
    rows = [
        f"{0.0075 * i},{0.0075 * j},{0.0075 * k},4.22e-7"
        for i in range(-5, 6)
        for j in range(-5, 6)
        for k in range(-5, 1)
    ]
    path.write_text("\n".join(["x,y,z,volume", *rows]) + "\n", encoding="utf-8")


IN_BODIES = {  # of the charge in per cent, at least and at most, and the body
    "box": (SCENE + BALL + "&body id='b', box=-.08,.08,-.08,.08,-.06,0,", 40, 50),
    "sphere": (SCENE + BALL + "&body id='b', shape='sphere', centre=0,0,0, radius=0.06,", 99, 100),
    "cylinder": (
        SCENE + BALL + "&body id='b', shape='cylinder', axis='x', length=0.16, centre=0,0,0, "
        "radius=0.02,",
        25,
        55,
    ),
    "pipe": (
        SCENE + BALL + "&body id='b', shape='cylinder', axis='z', length=0.16, centre=0,0,0, "
        "radius=0.05, inner_radius=0.02,",
        35,
        65,
    ),
    "stl": (SCENE + BALL + "&body id='b', shape='stl', file='b.stl',", 80, 100),
    "particles": (SCENE + BALL + "&body id='b', shape='particles', file='b.csv',", 40, 70),
    "half": (
        HALF + BALL + "&body id='b', box=-.08,.08,-.08,.08,-.02,.02,",
        65,
        85,
    ),
    "cylinder_of_explosive": (
        SCENE + "&charge id='c', shape='cylinder', mass=0.3375, at=0,0,0.02 /\n"
        "&body id='b', box=-.08,.08,-.08,.08,-.06,0,",
        10,
        25,
    ),
    "second": (
        SCENE
        + "&charge id='a', mass=0.1, at=0.05,0,0.05, density=800 /\n"
        + BALL
        + "&body id='b', box=-.08,.08,-.08,.08,-.06,0,",
        40,
        50,
    ),
}


@pytest.mark.parametrize("name", IN_BODIES)
def test_a_charge_in_a_body_is_refused(tmp_path, name):
    """With file, line, the body and the part, when checked and when run."""
    head, least, most = IN_BODIES[name]
    stl(tmp_path / "b.stl")
    particles(tmp_path / "b.csv")
    deck = head + " spacing=0.0075, material='s' /\n"
    line = 1 + deck[: deck.index("&charge id='c'")].count("\n")
    for args in (["--check"], ["--replace"]) if name == "box" else (["--check"],):
        code, text = brisance(tmp_path, deck, *args)
        found = re.search(
            rf"case\.nml:{line}: &charge id='c': (\d+) % of it .* lies in body 'b'.*move it", text
        )
        assert code == 2 and found, text
        assert least <= int(found[1]) <= most, text


@pytest.mark.parametrize("depth", [0.0, 0.005])
def test_what_a_body_takes_of_a_charge_is_told(tmp_path, depth):
    """A charge that touches a plate is whole; of one a little way in the kilograms are told.

    Particles half a cell apart: their wall is a plane where they end."""
    radius = (3 * 0.3375 / 1630 / (4 * math.pi)) ** (1 / 3)
    deck = SCENE + BALL.replace("0,0,0 /", f"0,0,{radius - depth} /")
    deck += f"&body id='b', box=-.08,.08,-.08,.08,-.06,0, spacing={0.1 / 24}, material='s' /\n"
    cap = math.pi * depth**2 / 3 * (3 * radius - depth) * 1630
    for args in (["--check"], ["--replace"]):
        code, text = brisance(tmp_path, deck, *args)
        assert code == 0, text
        told = re.search(
            r"c: *(\S+) kg of *(\S+) lie in cells that bodies fill, and are lost", text
        )
        lost = float(told[1]) if told else 0.0
        assert lost == pytest.approx(cap, rel=0.02, abs=1e-12)
        if args == ["--check"]:
            kept = re.search(r"c: *(\S+) kg in the model", text)
            assert float(kept[1]) == pytest.approx(0.3375 - lost, rel=1e-3)


# --- on a floor, and near it -------------------------------------------------------------------

PLANE = """&run t_end=4e-3 /
&air geometry='axial', floor=0 /
&charge id='c', mass=5, at=0,0,{height}, plane_cells=40{more} /
&gauge id='g', at=2,0,0, quantity='overpressure' /
"""
IN_A_BOX = """&run t_end=1, symmetry='x','y' /
&air box=0,2.4,0,2.4,0,2.4, cells=12,12,12,
     bc='symmetry','outflow','symmetry','outflow','wall','outflow' /
&charge id='c', mass=5, start='2d', at=0,0,{height}, plane_cells=40{more} /
"""


@pytest.mark.parametrize("deck", [PLANE, IN_A_BOX], ids=["plane", "box"])
@pytest.mark.parametrize("more", [", eos='jwl'", ""])
@pytest.mark.parametrize("height", [0.0902, 0.1, 0.15])
def test_a_charge_near_a_floor_runs_and_is_warned_of(tmp_path, deck, more, height):
    """At any height: it ended with code 3 where an odd number of rows lay below."""
    args = ["--replace"] if deck == PLANE else ["--check"]
    code, text = brisance(tmp_path, deck.format(height=height, more=more), *args)
    assert code == 0, text
    assert "case.nml:" in text and "half sides over the floor" in text and "burst='surface'" in text


def test_a_charge_well_over_a_floor_is_not_warned_of(tmp_path):
    code, text = brisance(tmp_path, PLANE.format(height=0.3, more=""), "--check")
    assert code == 0 and "warning" not in text
    assert re.search(r"accuracy .* 49 % low", text)


def peak(text):
    """Largest value of the gauge in the summary."""
    return float(re.search(r"^g +overpressure +(\S+) Pa", text, re.MULTILINE)[1])


def test_the_mass_on_the_ground_is_what_is_there(tmp_path):
    """`burst` has one meaning in &charge and &load; without it a floor through the centre asks."""
    code, text = brisance(tmp_path, PLANE.format(height=0, more=""), "--check")
    assert code == 2 and "burst='surface'" in text and "(2.5 kg for" in text
    deck = PLANE.replace("mass=5", "mass=10").format(height=0, more=", burst='air'")
    code, whole = brisance(tmp_path, deck, "--replace")
    assert code == 0
    code, half = brisance(tmp_path, PLANE.format(height=0, more=", burst='surface'"), "--replace")
    assert code == 0 and peak(half) == peak(whole)
    assert "5.0 kg, hemispherical surface burst on the floor z = 0.0, the same as 10.0 kg" in half
    code, text = brisance(tmp_path, PLANE.format(height=0.3, more=", burst='surface'"), "--check")
    assert code == 2 and "needs the ground to lie on" in text


@pytest.mark.parametrize("sign", ["surface", "floor"])
def test_the_report_compares_a_surface_burst_with_one(sign):
    """5 kg at 8 m: 48.6 kPa of the hemisphere's curves, not those of a sphere of 10 kg."""
    more, mass = (", burst='surface'", 5) if sign == "surface" else (", burst='air'", 10)
    text = PLANE.format(height=0, more=more).replace("mass=5", f"mass={mass}")
    gauge = Gauge("g", "g:overpressure", "overpressure", "Pa", np.array([8.0, 0, 0]))
    expected = expect(Deck(text), gauge)
    assert expected.mass == 5 and expected.label == "incident, surface burst"
    assert expected.peak == surface(5, 8).incident_overpressure
    assert expected.peak == pytest.approx(48.6e3, rel=0.002)


# --- closed rooms, walls beside a start along the radius -----------------------------------------

ROOM = """&run t_end=1e-6 /
&air box=0,1,0,1,0,1, cells=50,50,50, bc=6*'wall' /
&charge id='c', mass=0.1, start='1d', eos='jwl', at=0.5,0.5,{height} /
"""


def test_products_do_not_burn_in_a_closed_room(tmp_path):
    """0.1 kg in 1 m3 leave 172 kPa, 580 at most if burnt; a vent takes the warning away."""
    code, text = brisance(tmp_path, ROOM.format(height=0.5), "--check")
    assert code == 0 and re.search(r"case.nml:3: warning: .*closed on all sides", text)
    assert "comes out as 172 kPa; burnt, it may be 580 kPa at most" in text
    vented = ROOM.replace("6*'wall'", "5*'wall','outflow'").format(height=0.5)
    assert "closed" not in brisance(tmp_path, vented, "--check")[1]


@pytest.mark.parametrize("height", [0.0, 0.05])
def test_a_wall_beside_a_start_along_the_radius_names_what_helps(tmp_path, height):
    code, text = brisance(tmp_path, ROOM.format(height=height), "--check")
    assert code == 2 and "the wall 'z-' stops it" in text and "start='2d'" in text
    assert ("bc='symmetry'" in text) == (height == 0) and "smaller cells" not in text
