# SPDX-License-Identifier: MIT
"""Mistakes of a first deck that `--check` tells: other units, late times, what never acts."""

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BRISANCE = Path(os.environ.get("BRISANCE", ROOT / "bin" / "brisance"))

STEEL = (
    "&material id='s', model='linear_elastic', density=7850, youngs_modulus=200e9, "
    "poisson_ratio=0.3 /\n"
)
PLY = "&material id='c', preset='cfrp_ud' /\n"
CUBE = "box=0,0.01, 0,0.01, 0,0.01, spacing=1e-3, material='s'"
LOWER = "box=0,0.01, 0,0.01, -0.01,0, spacing=1e-3, material='s'"
BLOCK = f"&body id='a', {CUBE}, fix='z-' /\n&load body='a', faces='z+', pressure=1e6 /\n"
AIR = "&air box=0,2, 0,2, 0,2, cells=20,20,20 /\n"
TNT = "&charge id='c', mass=4000, at=1,1,1 /\n"
BALL = (
    "&body id='ball', shape='sphere', centre={}, radius=5e-3, spacing=1e-3, material='s', {} /\n"
    "&body id='plate', box=-0.01,0.01, -0.01,0.01, 0,0.004, spacing=1e-3, material='s' /\n"
)


def blast(faces, at):
    """A plate under a charge by its curves."""
    return (
        "&body id='a', box=0,0.1, 0,0.1, 0,0.01, spacing=2.5e-3, material='s', fix='sides' /\n"
        f"&load body='a', faces={faces}, mass=1, at={at} /\n"
    )


def check(folder, deck, head="&run t_end=1e-3 /\n"):
    """Exit code and messages of `--check`."""
    (folder / "a.nml").write_text(head + deck)
    command = [BRISANCE, "run", "a.nml", "--check"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=60)
    assert ("the deck is sound" in done.stdout) == (done.returncode == 0 and not done.stderr)
    return done.returncode, done.stderr


UNITS = {
    "spacing_in_mm": (
        STEEL + "&body id='a', box=0,40, 0,40, 0,12, spacing=4, material='s', velocity=0,0,1 /\n",
        "spacing = 4.0 [m] is not plausible",
    ),
    "velocity_in_mm": (STEEL + f"&body id='a', {CUBE}, velocity=0,0,-3e5 /\n", "300000.0 [m/s]"),
    "spin": (STEEL + f"&body id='a', {CUBE}, spin=0,0,1e6 /\n", "1e6 [rad/s]"),
    "energy_of_charge": (AIR + TNT.replace("mass", "energy=4.6, mass"), "4.6 [J/kg]"),
    "density_of_charge": (AIR + TNT.replace("mass=4000", "mass=4, density=1.63"), "1.63 [kg/m3]"),
    "pressure_of_air": (AIR.replace("box", "pressure=101.325, box") + TNT, "101.325 [Pa]"),
    "pressure_in_mpa": (STEEL + BLOCK.replace("1e6", "0.3"), "pressure = 0.3 [Pa]"),
    "strength_of_glue": (
        STEEL
        + f"&body id='a', {CUBE}, velocity=0,0,10 /\n&body id='b', {LOWER} /\n"
        + "&interaction law='bonded', tensile_strength=60 /\n",
        "tensile_strength = 60.0 [Pa]",
    ),
}

IDLE = {
    "rest": (STEEL + f"&body id='a', {CUBE} /\n", "a.nml:1: warning: &run: nothing happens"),
    "still_air": (AIR, "nothing happens"),
    "control_whole": (
        STEEL + f"&body id='a', {CUBE}, formulation='rigid', fix='all', velocity=0,0,9 /\n",
        "velocity and spin have no effect: fix='all' holds all of it",
    ),
    "in_a_fix_box": (
        STEEL + f"&body id='a', {CUBE}, fix_box=-1,1,-1,1,-1,1, velocity=0,0,9 /\n",
        "velocity and spin have no effect: a fix_box holds all of it",
    ),
    "late_motion": (
        STEEL
        + f"&body id='a', {CUBE} /\n"
        + "&motion id='m', body='a', box=0,1, 0,1, 0,2e-3, time=1,2, velocity=0,0,0,0,0,1 /\n",
        "a.nml:4: warning: &motion id='m': it begins at 1.0 s, after the end of the run",
    ),
    "late_wave": (
        AIR + "&inflow face='x-', time=5,20, overpressure=1e5,0 /\n",
        "it begins at 5.0 s, after the end of the run",
    ),
    "outwards": (AIR + "&inflow face='x-', mach=-2 /\n", "nothing comes in"),
    "late_outputs": (STEEL + BLOCK + "&output history_every=1 /\n", "no row of the histories"),
    "no_region": (STEEL + BLOCK + "&solid leave='remove' /\n", "leave has no effect"),
    "beside_the_region": (
        STEEL + BLOCK + "&solid region=1,2, 1,2, 1,2, leave='remove' /\n",
        "'a' lies outside of the region",
    ),
    "covered": (
        STEEL
        + f"&body id='a', {CUBE}, velocity=0,0,10 /\n&body id='b', {LOWER} /\n"
        + "&interaction law='bonded', bodies='a','b' /\n&interaction law='contact' /\n",
        "a.nml:5: warning: &interaction: has no effect: a later &interaction covers it",
    ),
    "too_slow": (STEEL + BALL.format("0,0,0.012", "velocity=0,0,-0.8"), "no two bodies meet"),
    "beside": (STEEL + BALL.format("0.03,0,0.012", "velocity=500,0,-100"), "no two bodies meet"),
    "cuts_nothing": (
        STEEL
        + BLOCK
        + "&body id='bars', shape='bars', axis='x', box=0,0.01, 0,0.01, -0.05,-0.048, bars=2,1,\n"
        + "  diameter=2e-3, spacing=1e-3, material='s', cuts='a' /\n",
        "it cuts nothing",
    ),
    "blast_from_behind": (STEEL + blast("'z+'", "0.05,0.05,-1"), "none of these faces sees"),
}


@pytest.mark.parametrize("case", UNITS)
def test_other_units_are_asked_about(case, tmp_path):
    """Numbers a thousand times or more off any use."""
    deck, words = UNITS[case]
    code, said = check(tmp_path, deck)
    assert code == 0 or case == "density_of_charge", said
    assert words in said and "is it in SI units?" in said


@pytest.mark.parametrize("case", IDLE)
def test_what_never_acts_is_told(case, tmp_path):
    """What the deck asks for and the run would leave out in silence."""
    deck, words = IDLE[case]
    code, said = check(tmp_path, deck)
    assert code == 0, said
    assert words in said


@pytest.mark.parametrize(
    "deck",
    [
        STEEL + BLOCK + "&output dump_every=1e-4, history_every=1e-5 /\n",
        STEEL + BALL.format("0,0,0.012", "velocity=0,0,-80"),
        STEEL + BALL.format("0.03,0,0.012", "velocity=-500,0,-100"),
        STEEL + blast("'z+'", "0.05,0.05,1"),
        STEEL + blast("'z-','z+'", "0.05,0.05,-1"),
        AIR + "&inflow face='x+', velocity=-700,0,0 /\n",
        "&air box=0,1, 0,1, 0,1, cells=9,9,9, pressure=1, density=1 /\n"
        "&gas id='g', box=0,1, 0,1, 0,0.3333333333, pressure=9, density=1 /\n",
    ],
)
def test_what_acts_is_sound(deck, tmp_path):
    """The same with things where they act."""
    assert check(tmp_path, deck) == (0, "")


def test_charges_that_overlap_are_refused(tmp_path):
    """Of two charges of 500 kg, 20 mm apart, 89 % of one was lost."""
    two = AIR + "&charge id='c', mass=500, at=1,1,0.5 /\n&charge id='d', mass=500, at=1,1,{} /\n"
    code, said = check(tmp_path, two.format(0.52))
    assert code == 2
    assert "a.nml:4: &charge id='d': it overlaps the charge 'c'" in said
    code, said = check(tmp_path, two.format(1.4))
    assert code == 0, said


@pytest.mark.parametrize(("dimension", "words"), [(1, "a slab"), (2, "a round bar")])
def test_a_sphere_needs_three_dimensions(dimension, words, tmp_path):
    """In fewer it is something else, of another mass."""
    deck = STEEL + "&body id='a', shape='sphere', centre=3*0, radius=0.01, spacing=1e-3,\n"
    deck += "  material='s', velocity=9,0,0 /\n"
    _, said = check(tmp_path, deck, f"&run t_end=1e-5, dimension={dimension} /\n")
    assert f"with dimension={dimension} a sphere is {words}" in said


def test_a_charge_lies_in_the_plane_of_the_scene(tmp_path):
    """Its third coordinate was left out in silence."""
    deck = STEEL + "&body id='a', box=0,0.1, 0,0.01, 0,1, spacing=2.5e-3, material='s' /\n"
    deck += "&load body='a', faces='y+', mass=1, at=0.05,1,{} /\n"
    head = "&run t_end=1e-3, dimension=2 /\n"
    _, said = check(tmp_path, deck.format(7), head)
    assert "the scene has no direction z" in said
    assert check(tmp_path, deck.format(0.5), head) == (0, "")


@pytest.mark.parametrize(("axis", "words"), [("z", "ply_axis='x'"), ("x", "")])
def test_plies_lie_across_the_thickness(axis, words, tmp_path):
    """A plate normal to x, with the plies along its side."""
    deck = PLY + "&body id='a', box=0,0.004, 0,0.04, 0,0.04, spacing=1e-3, material='c',\n"
    deck += f"  plies='0/90/90/0', ply_axis='{axis}', velocity=9,0,0 /\n"
    _, said = check(tmp_path, deck)
    assert words in said if words else said == ""


def test_a_blast_that_is_mapped_at_once_is_not_sound(tmp_path):
    """In milliseconds for seconds: the warning of the start counts in the verdict."""
    deck = AIR + "&charge id='c', mass=1, at=1,1,1, start='1d', eos='jwl' /\n"
    _, said = check(tmp_path, deck, "&run t_end=1e-5 /\n")
    assert "warning: the blast is mapped so early" in said
