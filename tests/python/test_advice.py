# SPDX-License-Identifier: MIT
"""What `--check` advises: what is so, for decks of inputs/ and for a scene changed in one thing."""

import os
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from notes import note
from tiers import slow

ROOT = Path(__file__).parents[2]
BRISANCE = Path(os.environ.get("BRISANCE", ROOT / "bin" / "brisance"))
START, MIRROR, LOAD, RIGID, NEAR, FAR, STILL, ONE = (
    "cells in its radius",
    "mirror image",
    "Kingery and",
    "fixed everywhere",
    "send back",
    "not reach",
    "gives way by",
    "one gas in place of two",
)
CRACKS, LATE = "cost the same up to", "and the run ends at"

EVEN = """
&run t_end = 2e-5 /
&air box = -0.06, 0.06, -0.06, 0.06, -0.04, 0.08, cells = 30, 30, 30 /
&charge id = 'tnt', mass = 1.5e-3, start = '1d', at = 0, 0, 0.05 /
&material id = 'ply', model = 'orthotropic_ply', density = 1600, e1 = 140e9, e2 = 10e9, e3 = 10e9
  nu12 = 0.3, nu13 = 0.3, nu23 = 0.4, g12 = 5e9, g13 = 5e9, g23 = 3.5e9 /
&material id = 'steel', model = 'linear_elastic', density = 7800, youngs_modulus = 2e11
  poisson_ratio = 0.3 /
&body id = 'plate', box = -0.02, 0.02, -0.02, 0.02, -0.008, 0, spacing = 2e-3, material = 'ply'
  plies = '0/90/90/0', fix = 'x-', 'x+' /
&body id = 'left', shape = 'sphere', centre = -0.012, 0, -0.02, radius = 4e-3, spacing = 2e-3
  material = 'steel' /
&body id = 'right', shape = 'sphere', centre = 0.012, 0, -0.02, radius = 4e-3, spacing = 2e-3
  material = 'steel' /
"""


def advice(deck, *sets):
    command = [BRISANCE, "run", deck, "--check", *(part for one in sets for part in ("--set", one))]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stdout + done.stderr
    head, _, _ = done.stdout.partition("verdict")
    return head.split("advice       ")[1:]


def kinds(texts):
    every = (START, MIRROR, LOAD, RIGID, NEAR, FAR, STILL, ONE, CRACKS)
    return {kind for kind in every if any(kind in t for t in texts)}


PROJECT = {  # what is advised for each deck; of slabs and fragments the charge is a cylinder
    "beam": set(),
    "cylinder_floor": set(),
    "demo": {LOAD, NEAR},
    "free_air": set(),
    "reflection": set(),
    "shock_tube": set(),
    "jobs/beam": set(),
    "jobs/blast_fragments": set(),
    "jobs/fragment_plate": set(),
    "jobs/hypervelocity": set(),
    "jobs/laminate": set(),
    "jobs/plate_air": {LOAD, NEAR},
    "jobs/plate_impulse": set(),
    "jobs/plate_load": set(),
    "jobs/rc_slab": set(),
    "jobs/rod_concrete": set(),
    "jobs/spall": {CRACKS},
    "jobs/surface_burst": set(),
    "jobs/wall": set(),
    "paper/fragments": {START, MIRROR},
    "paper/fragments_460": {START, MIRROR},
    "paper/hvi": set(),  # plies of 45 degrees
    "paper/plate": {MIRROR, LOAD, NEAR},
    "paper/slab_1": {START, MIRROR},
    "paper/slab_2": {START, MIRROR},
    "paper/slab_3": {START, MIRROR},
    "paper/slab_4": {START, MIRROR},
    "paper/sphere": {MIRROR},
}


def test_no_deck_is_left_out():
    folder = ROOT / "inputs"
    decks = [*folder.glob("*.nml"), *folder.glob("jobs/*.nml"), *folder.glob("paper/*.nml")]
    assert {str(deck.relative_to(folder))[:-4] for deck in decks} == set(PROJECT)


# (the sphere of the paper is the scene of the most particles: its neighbours are sorted for 3 s)
@pytest.mark.parametrize("deck", [slow(d) if d == "paper/sphere" else d for d in PROJECT])
def test_decks_of_the_project(deck):
    texts = advice(ROOT / "inputs" / f"{deck}.nml")
    assert kinds(texts) == PROJECT[deck] and len(texts) == len(PROJECT[deck])


def test_a_blast_that_arrives_after_the_end_is_told():
    """The building of a job at the end of the run, and before the front is there."""
    deck = ROOT / "inputs/jobs/wall.nml"
    late = [text for text in advice(deck, "run.t_end=4e-3") if LATE in text]
    assert len(late) == 1
    assert re.search(r"the nearest body 5000 mm away after 4\.\d+ ms", late[0])
    assert not any(LATE in text for text in advice(deck, "run.t_end=6e-3"))


@pytest.mark.parametrize(
    ("change", "planes"),
    [
        ("run.t_end=2e-5", "x = 0, y = 0"),
        ("charge(tnt).at=1e-3,0,0.05", "y = 0"),
        ("body(plate).plies=45/90/90/45", None),
        ("body(plate).plies=0/90/0/90", "x = 0, y = 0"),
        ("body(plate).fix=x-", "y = 0"),
        ("body(left).velocity=10,0,0", "y = 0"),
        ("body(left).velocity=0,10,0", None),
        ("body(left).spin=0,0,5", None),
        ("body(plate).spin=0,5,0", "y = 0"),
        ("body(right).radius=5e-3", "y = 0"),
        ("body(right).centre=0.012,1e-3,-0.02", None),
        ("body(left).material=ply", "y = 0"),
        ("air.bc=outflow,wall,outflow,outflow,outflow,outflow", "y = 0"),
        ("air.box=-0.06,0.061,-0.06,0.06,-0.04,0.08", "y = 0"),
        ("run.symmetry=y", None),
        ("body(plate).fix_box=-0.03,-0.018,-0.03,0.03,-1,1", "y = 0"),
        ("body(plate).fix_box=-0.03,-0.018,-0.03,0.03,-1,1,0.018,0.03,-0.03,0.03,-1,1",
         "x = 0, y = 0"),
    ],
)  # fmt: skip
def test_planes_of_symmetry(tmp_path, change, planes):
    deck = tmp_path / "even.nml"
    deck.write_text(EVEN, encoding="utf-8")
    sets = [change]
    if change == "run.symmetry=y":  # the rest of y: the box of the air begins at the plane
        sets += ["air.box=-0.06,0.06,0,0.06,-0.04,0.08", "air.cells=30,15,30"]
        planes = "x = 0"
    told = [text for text in advice(deck, *sets) if MIRROR in text]
    if planes is None:
        assert told == []
    else:
        assert len(told) == 1
        assert f"mirror image in {planes}:" in told[0]


BLOCK = """
&run t_end = 2e-5 /
&material id = 's', model = 'linear_elastic', density = 7800, youngs_modulus = 2e11
  poisson_ratio = 0.3 /
&body id = 'b', box = -0.02, 0.02, -0.02, 0.02, -0.02, 0.02, spacing = 5e-3, material = 's' /
"""
ENDS = """
&motion id = 'low', body = 'b', box = -1, -0.015, -1, 1, -1, 1, velocity = -1, 0, {low} /
&motion id = 'high', body = 'b', box = 0.015, 1, -1, 1, -1, 1, velocity = 1, 0, 0 /
"""


@pytest.mark.parametrize(
    ("more", "planes"),
    [
        ("", "x = 0, y = 0, z = 0"),
        ("&load body = 'b', acceleration = 0, 0, -9.81 /", "x = 0, y = 0"),
        ("&load body = 'b', force = 5, 0, 0 /", "y = 0, z = 0"),
        (ENDS.format(low=0), "x = 0, y = 0, z = 0"),
        (ENDS.format(low=2), "y = 0"),
        (ENDS.format(low=0).replace("0.015, 1,", "0.01, 1,"), "y = 0, z = 0"),
    ],
)
def test_planes_of_symmetry_of_loads_and_motions(tmp_path, more, planes):
    deck = tmp_path / "block.nml"
    deck.write_text(BLOCK + more + "\n", encoding="utf-8")
    told = [text for text in advice(deck) if MIRROR in text]
    assert len(told) == 1
    assert f"mirror image in {planes}:" in told[0]


def test_the_part_moves_as_the_whole(tmp_path):
    """What the advice promises: the quarter has the energies of the whole, divided by four."""
    deck = tmp_path / "even.nml"
    gas = (
        "&gas id = 'hot', box = -0.06, 0.06, -0.06, 0.06, 0.01, 0.08, density = 8, pressure = 1e7 /"
    )
    charge = next(line for line in EVEN.splitlines() if line.startswith("&charge"))
    deck.write_text(EVEN.replace(charge, gas), encoding="utf-8")
    assert kinds(advice(deck)) == {MIRROR}
    last = []
    for name, sets in (
        ("whole", []),
        ("part", ["run.symmetry=x,y", "air.box=0,0.06,0,0.06,-0.04,0.08", "air.cells=15,15,30"]),
    ):
        command = [BRISANCE, "run", deck, "--out", tmp_path / name, "--backend", "cpu"]
        command += [part for one in sets for part in ("--set", one)]
        done = subprocess.run(command, capture_output=True, text=True, timeout=300)
        assert done.returncode == 0, done.stdout + done.stderr
        with (tmp_path / name / "energy.csv").open(encoding="utf-8") as file:
            names = file.readline().strip().split(",")
            row = np.loadtxt(file.readlines()[-1:], delimiter=",")
        last.append([row[names.index(f"solid_{kind}[J]")] for kind in ("kinetic", "internal")])
    assert last[0][0] > 0
    np.testing.assert_allclose(4 * np.array(last[1]), last[0], rtol=1e-6)


BALL = """
&run t_end = 4e-4, symmetry = 'x', 'y', 'z' /
&air box = 0, 0.4, 0, 0.4, 0, 0.4, cells = 40, 40, 40 /
&gas id = 'ends_the_start', box = 0.13, 0.15, 0.13, 0.15, 0.13, 0.15
  density = 1.225, pressure = 101325 /
&charge id = 'tnt', mass = 0.5, start = '3d', at = 0, 0, 0 /
&gauge id = 'a', at = 0.25, 0, 0, quantity = 'overpressure' /
&output history_every = 1e-6 /
"""


def test_a_charge_of_few_cells_is_told_of_a_start_along_its_radius(tmp_path):
    """What that brings: test_advice_taken.py."""
    deck = tmp_path / "ball.nml"
    deck.write_text(BALL, encoding="utf-8")
    told = [text for text in advice(deck) if START in text]
    assert len(told) == 1 and "start='1d'" in told[0] and " s of one core" in told[0]
    for better in ("charge(tnt).start=1d", "air.cells=80,80,80"):
        assert START not in kinds(advice(deck, better))


DRUM = """
&run t_end = 1e-4, symmetry = 'x', 'y' /
&air box = 0, 0.2, 0, 0.2, -0.2, 0.2, cells = 20, 20, 40 /
&charge id = 'tnt', mass = 0.5, shape = 'cylinder', at = 0, 0, -0.08, plane_cells = 40 /
&material id = 's', model = 'linear_elastic', density = 7800, youngs_modulus = 2e11
  poisson_ratio = 0.3 /
&body id = 'b', box = -0.1, 0.1, -0.1, 0.1, 0.15, 0.17, spacing = 5e-3, material = 's' /
"""


def test_a_cylinder_of_few_cells_is_better_started_in_its_plane(tmp_path):
    """Where there is room, as the program then takes it; by how much: docs/manual/blast.md."""
    deck = tmp_path / "drum.nml"
    deck.write_text(DRUM, encoding="utf-8")
    told = [text for text in advice(deck) if START in text]
    assert len(told) == 1 and "start='2d'" in told[0]
    for sets in ("charge(tnt).start=2d", "charge(tnt).at=0,0,0", "charge(tnt).shape=box"):
        assert START not in kinds(advice(deck, sets)), sets


def test_a_body_that_is_held_everywhere(tmp_path):
    deck = tmp_path / "even.nml"
    deck.write_text(EVEN, encoding="utf-8")
    told = [t for t in advice(deck, "body(plate).fix_box=-1,1,-1,1,-1,1") if RIGID in t]
    assert len(told) == 1 and "of one core (1600 particles)" in told[0]
    assert RIGID not in kinds(advice(deck, "body(plate).fix_box=-1,1,-1,1,-0.004,1"))


def test_sides_that_the_blast_does_not_reach(tmp_path):
    deck = tmp_path / "even.nml"
    deck.write_text(EVEN, encoding="utf-8")
    wide = ["air.box=-0.3,0.3,-0.06,0.06,-0.04,0.08", "air.cells=150,30,30"]
    assert FAR in kinds(advice(deck, "run.t_end=2e-5", *wide))
    assert FAR not in kinds(advice(deck, "run.t_end=2e-3", *wide))


def test_a_load_by_curves_needs_a_face_with_nothing_before_it(tmp_path):
    deck = tmp_path / "even.nml"
    deck.write_text(EVEN, encoding="utf-8")
    assert LOAD in kinds(advice(deck))
    before = [f"body({name}).centre={x},0,0.02" for name, x in (("left", -0.03), ("right", 0.03))]
    assert LOAD not in kinds(advice(deck, *before))
    assert LOAD not in kinds(advice(deck, "body(left).velocity=0,0,10"))


WALL = """
&run t_end = 8e-4, symmetry = 'x', 'y' /
&air box = 0, 0.24, 0, 0.24, -0.08, 0.64, cells = 12, 12, 36 /
&charge id = 'tnt', mass = 0.02, start = '1d', at = 0, 0, 0.4, radial_cells = 60 /
&material id = 's', model = 'bilinear_j2', density = 7850, youngs_modulus = 2e11
  poisson_ratio = 0.3, yield_stress = 4e8, tangent_modulus = 1e9 /
&material id = 'light', model = 'linear_elastic', density = 500, youngs_modulus = 1e9
  poisson_ratio = 0.3 /
&body id = 'wall', box = -0.12, 0.12, -0.12, 0.12, -0.03, 0, spacing = 0.01, material = 's' /
&gauge id = 'air', at = 0, 0, 0.03, quantity = 'overpressure' /
&gauge id = 'push', body = 'wall', quantity = 'impulse_z' /
&output history_every = 2e-6 /
"""


def histories(folder, deck, name, *sets):
    """Columns of the gauges of a run: time first."""
    command = [BRISANCE, "run", deck, "--out", folder / name, "--backend", "cpu"]
    command += [part for one in sets for part in ("--set", one)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return np.genfromtxt(folder / name / "gauges.csv", delimiter=",", skip_header=1).T


def farthest_apart(one, other):
    """Of each gauge, over the largest number of the first."""
    return [
        np.abs(np.interp(one[0], other[0], b) - a).max() / np.abs(a).max()
        for a, b in zip(one[1:], other[1:], strict=True)
    ]


def test_a_wall_that_the_air_may_take_for_rigid(tmp_path):
    deck = tmp_path / "wall.nml"
    deck.write_text(WALL, encoding="utf-8")
    told = [text for text in advice(deck) if STILL in text]
    assert len(told) == 1 and "of one core\n" in told[0] and "432 particles in" in told[0]
    assert STILL not in kinds(advice(deck, "body(wall).material=light"))


@pytest.mark.slow
def test_a_rigid_wall_has_the_air_of_a_heavy_one(tmp_path):
    """Who follows the advice has the same air and the same push within the per cent that it
    promises; a light plate, for which nothing is said, has not."""
    deck = tmp_path / "wall.nml"
    deck.write_text(WALL, encoding="utf-8")
    rigid = ["body(wall).formulation=rigid", "body(wall).fix=all"]
    wall = histories(tmp_path, deck, "wall")
    apart = farthest_apart(wall, histories(tmp_path, deck, "rigid", *rigid))
    note("advice_still", max(apart))
    assert max(apart) < 0.01
    light = ["body(wall).material=light"]
    wall = histories(tmp_path, deck, "light", *light)
    apart = farthest_apart(wall, histories(tmp_path, deck, "light_rigid", *light, *rigid))
    note("advice_moves", max(apart))
    assert max(apart) > 0.01


@pytest.mark.parametrize(
    "change",
    [
        ["charge(tnt).mass=0.4"],  # it yields under the pulse
        ["run.t_end=1e-2"],
        ["material(s).failure_strain=0.1"],
        ["body(wall).velocity=0,0,-1"],
        ["body(wall).formulation=rigid"],
        ["charge(tnt).explosive=c4"],
        ["air.bc=symmetry,outflow,symmetry,outflow,wall,outflow"],
    ],
)  # fmt: skip
def test_a_wall_that_may_be_seen_to_move(tmp_path, change):
    deck = tmp_path / "wall.nml"
    deck.write_text(WALL, encoding="utf-8")
    assert STILL not in kinds(advice(deck, *change))


FAR_OFF = """
&run t_end = 8e-4, symmetry = 'x', 'y', 'z' /
&air box = 0, 0.9, 0, 0.6, 0, 0.6, cells = 45, 30, 30 /
&gas id = 'ends_the_start', box = 0.6, 0.62, 0, 0.02, 0, 0.02, density = 1.225
  pressure = 101325 /
&charge id = 'tnt', mass = 0.01, start = '1d', eos = 'jwl', at = 0, 0, 0, radial_cells = 60 /
&gauge id = 'a', at = 0.4, 0.1, 0.1, quantity = 'overpressure' /
&output history_every = 2e-6 /
"""


def test_products_from_which_nothing_arrives(tmp_path):
    """Where sound from the products may arrive nothing is said."""
    deck = tmp_path / "far.nml"
    deck.write_text(FAR_OFF, encoding="utf-8")
    told = [text for text in advice(deck) if ONE in text]
    assert len(told) == 1 and "gamma = 1.4 in &charge" in told[0] and "of 40500 cells" in told[0]
    for sets in ("gauge(a).at=0.2,0.1,0.1", "run.t_end=1.6e-3", "charge(tnt).eos=ideal",
                 "charge(tnt).gamma=1.4"):  # fmt: skip
        assert ONE not in kinds(advice(deck, sets)), sets


@pytest.mark.slow
def test_one_gas_gives_the_gauge_what_two_do(tmp_path):
    deck = tmp_path / "far.nml"
    deck.write_text(FAR_OFF, encoding="utf-8")
    apart = farthest_apart(*(histories(tmp_path, deck, name, *sets) for name, sets in (
        ("two", []), ("one", ["charge(tnt).gamma=1.4"]))))  # fmt: skip
    note("advice_one_gas", apart[0])
    assert apart[0] < 1e-3


STRIP = """\
&run t_end=1e-6, dimension=2 /
&material id='m', preset='concrete_48' /
&body id='strip', box=0,0.016, 0,0.02, 0,1, spacing=0.001, material='m' /
"""


def test_a_body_finer_than_its_cracks_need(tmp_path):
    """The strip of test_cracks.py spends the same energy at 1, 2 and 4 mm; at 2 mm it has 8 rows
    left, at 4 mm too few for a word."""
    deck = tmp_path / "strip.nml"
    deck.write_text(STRIP)
    texts = advice(deck)
    assert any("the cracks of 'strip' cost the same" in t and "2.0 mm would do:" in t
               and "of one core less" in t and "1/8 of the work" in t
               for t in texts)  # fmt: skip
    for sets in ("body.spacing=0.002", "material.gf=1", "body.formulation=rigid"):
        assert not any("the cracks of" in t for t in advice(deck, sets)), sets


def test_a_thin_round_wall_of_metal_is_told(tmp_path):
    deck = tmp_path / "pipe.nml"
    deck.write_text(
        "&run t_end=1e-5 /\n&material id='m', preset='steel_4340' /\n"
        "&body id='pipe', shape='cylinder', axis='z', centre=0,0,0.05, radius=0.053, "
        "inner_radius=0.047, length=0.1, spacing=2e-3, material='m' /\n",
        encoding="utf-8",
    )
    wall = "the wall of 'pipe' has 3 layers"
    assert any(wall in text for text in advice(deck))
    assert not any(wall in text for text in advice(deck, "body(pipe).formulation=bending"))
    assert not any("the wall" in text for text in advice(deck, "body(pipe).inner_radius=0.02"))
