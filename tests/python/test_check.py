# SPDX-License-Identifier: MIT
"""What `--check` says: warnings of decks that run but may not mean what they say, sizes, steps."""

import math
import os
import re
import resource
import subprocess
import sys
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BINARY = Path(os.environ.get("BRISANCE", ROOT / "bin" / "brisance"))

AIR = "&run t_end=1e-4 /\n&air box=0,0.4,0,0.4,0,0.4, cells=20,20,20 /\n"
STEEL = "&material id='s', preset='steel_paper' /\n"
PLATE = "&body id='p', box=0.1,0.14,0.1,0.3,0.1,0.3, spacing=0.01, material='s' /\n"


def check(folder, text, limit=None, timeout=20):
    """Exit code, standard output and warnings of a deck that is checked."""
    (folder / "case.nml").write_text(text)
    done = subprocess.run(
        [BINARY, "run", "case.nml", "--check"],
        cwd=folder,
        capture_output=True,
        timeout=timeout,
        check=False,
        text=True,
        preexec_fn=limit,
    )
    return done.returncode, done.stdout, done.stderr


WARNINGS = {
    "gas_between_cells": (
        AIR + "&gas id='a', box=0,0.4,0,0.4,0.185,0.209, density=2, pressure=2e5 /\n",
        "case.nml:3: warning: &gas id='a': the box ends inside cells; in effect it is "
        "x 0.0..0.4, y 0.0..0.4, z 0.18..0.2 ",
    ),
    "gas_holds_no_cell": (
        AIR + "&gas id='a'\n box=0,0.4,0,0.4,0.191,0.199, density=2, pressure=2e5 /\n",
        "case.nml:4: warning: &gas id='a': the box changes nothing: it holds the middle of no cell "
        "along z, where they are 0.02 m long; make it larger or the cells smaller",
    ),
    "gauge_in_a_body": (
        AIR + STEEL + PLATE + "&gauge id='g', at=0.12,0.2,0.2 /\n",
        "case.nml:5: &gauge id='g': warning: it lies in the body 'p'",
    ),
    "particles_as_far_apart_as_cells": (
        AIR
        + STEEL
        + "&body id='p', box=0.1,0.14, 0.1,0.3, 0.1,0.3, spacing=0.02, material='s' /\n",
        "case.nml:4: warning: &body id='p': its particles, 0.02 m apart, leave gaps for cells of "
        "air of 0.02 m: gas appears inside it, and energy with it; use at most 0.9 of a cell",
    ),
    "a_body_that_is_smaller_than_a_cell": (
        AIR
        + STEEL
        + "&body id='p', box=0.1,0.115, 0.1,0.115, 0.1,0.3, spacing=0.005, material='s' /\n",
        "case.nml:4: warning: &body id='p': it is smaller than a cell of the air, 0.02 m: the gas "
        "sees and pushes whole cells",
    ),
    "a_single_row_of_particles": (
        "&run t_end=1e-4 /\n"
        + STEEL
        + "&body id='b', box=0,0.1,0,0.01,0,0.01, spacing=0.01, material='s' /\n",
        "case.nml:3: &body id='b': warning: a single row of particles does not see what it "
        "strains across",
    ),
    "keys_of_other_formulations": (
        "&run t_end=1e-4 /\n"
        + STEEL
        + "&body id='b', box=0,0.1,0,0.1,0,0.04, spacing=0.01, material='s',\n"
        "  formulation='bending', zeta_viscous=0.1 /\n",
        "case.nml:3: warning: &body id='b': zeta_viscous has no effect: it is of "
        "formulation='corrected_hourglass', and this is 'bending'",
    ),
    "bounds_of_a_fixed_smoothing_length": (
        "&run t_end=1e-4 /\n"
        + STEEL
        + "&body id='b', box=0,0.1,0,0.1,0,0.04, spacing=0.01, material='s', h_range=0.8,1.1 /\n",
        "case.nml:3: warning: &body id='b': h_range has no effect: it is of variable_h = .true.",
    ),
    "plies_of_a_metal": (
        "&run t_end=1e-4 /\n"
        + STEEL
        + "&body id='b', box=0,0.1,0,0.1,0,0.03, spacing=0.01, material='s', plies='0/90/0' /\n",
        "case.nml:3: &body id='b': warning: plies change nothing: its material 's' is the same",
    ),
    "a_single_layer_of_metal": (
        "&run t_end=1e-4 /\n"
        + STEEL
        + "&body id='b', box=0,0.1,0,0.1,0,0.01, spacing=0.01, material='s' /\n",
        "lay two or more, or take formulation='bending', a membrane then",
    ),
    "a_face_that_is_held_through_the_body": (
        "&run t_end=1e-4 /\n"
        + STEEL
        + "&body id='b', box=0,0.1,0,0.04,0,0.04, spacing=0.01, material='s', fix='y-','z+',\n"
        "  fix_layers=4 /\n",
        "case.nml:3: &body id='b': warning: fix holds every particle of it, as 4 layers reach "
        "through; take less, or fix='all' if it is to stand still",
    ),
    "a_depth_that_is_held_through_the_body": (
        "&run t_end=1e-4, symmetry='x' /\n"
        + STEEL
        + "&body id='b', shape='sphere', centre=0,0,0, radius=0.04, spacing=0.01, material='s',\n"
        "  fix='x+', fix_width=0.04 /\n",
        "fix holds every particle of it, as 0.04 m reach through",
    ),
}


@pytest.mark.parametrize("case", WARNINGS)
def test_traps_are_told(case, tmp_path):
    """A deck that runs but may not be meant: a warning with file, line and remedy."""
    text, words = WARNINGS[case]
    code, out, err = check(tmp_path, text)
    assert code == 0, err
    assert words in err
    assert re.search(r"^verdict +[1-9] warning", out, re.MULTILINE), out


WEIGHT = "&load body='b', acceleration=0,0,-9.81 /\n"


@pytest.mark.parametrize(
    "keys", ["fix='y-','z+', fix_layers=3", "fix='x-', fix_layers=9", "fix='all', fix_layers=9"]
)
def test_what_is_held_in_part_is_sound(keys, tmp_path):
    """A body that moves somewhere, or is said to stand still."""
    text = "&body id='b', box=0,0.1,0,0.04,0,0.04, spacing=0.01, material='s', "
    code, _, err = check(tmp_path, "&run t_end=1e-4 /\n" + STEEL + text + keys + " /\n" + WEIGHT)
    assert (code, err) == (0, "")


ROW = "&body id='b', box=0,0.1, 0,0.1, 0,0.01, spacing=0.01, material='{}', {} /\n"
BAR = (
    "&body id='b', shape='bars', axis='x', box=0,0.1,0,0.01,0,0.01, diameter=0.01, "
    "spacing=0.009, material='s'{} /\n"
)
ELASTIC = (
    "&material id='e', model='linear_elastic', density=1e3, youngs_modulus=1e9, "
    "poisson_ratio=0.3 /\n"
)
AROUND = "&body id='c', box=0,0.1, -0.027,0.036, -0.027,0.036, spacing=0.009, material='s' /\n"


@pytest.mark.parametrize(
    ("bodies", "words"),
    [
        (ROW.format("e", "formulation='bending'"), ""),
        (ROW.format("e", "formulation='rigid'"), ""),
        (ROW.format("e", "formulation='corrected', fix='all'"), ""),
        (ROW.format("e", "formulation='total_lagrangian'"), "'total_lagrangian' has no stress in"),
        (BAR.format(""), "one particle across a bar that no body is bonded to"),
        (BAR.format(", fix='all'"), ""),
        (AROUND + BAR.format(", cuts='c'"), ""),
    ],
)
def test_single_layers_and_rows(bodies, words, tmp_path):
    """What has stress is let pass without a word, what has none is refused."""
    material = STEEL if "'s'" in bodies else ELASTIC
    code, out, err = check(tmp_path, "&run t_end=1e-4 /\n" + material + bodies + WEIGHT)
    assert code == (2 if words else 0), err
    assert words in err
    if not words:
        assert err == "", err
        assert "the deck is sound" in out


def test_boxes_of_gas_on_faces_of_cells_are_sound(tmp_path):
    """A box that ends on faces or outside, and a gauge on the surface of a body."""
    text = AIR + "&gas id='a', box=-1,9,-1,0.4,0.18,0.2, density=2, pressure=2e5 /\n"
    code, out, err = check(tmp_path, text + STEEL + PLATE + "&gauge id='g', at=0.14,0.2,0.2 /\n")
    assert code == 0
    assert "verdict      the deck is sound" in out, out + err


def gigabytes(n):
    """For a process that may have so many GB of addresses."""
    return lambda: resource.setrlimit(resource.RLIMIT_AS, (int(n * 1e9), int(n * 1e9)))


HUGE = (
    "&run t_end=1, symmetry='x' /\n&air box=0,1,-1,1,-1,1, cells=1000,1000,1000 /\n"
    "&charge id='c', mass=1, at=0,0,0.5 /\n"
    + STEEL
    + "&body id='slab', box=0,0.5,-0.5,0.5,-0.25,0.25, spacing=0.5e-3, material='s' /\n"
    "&body id='ball', shape='sphere', centre=0,0,0.4, radius=0.05, spacing=0.5e-3, material='s' /\n"
    "&body id='bars', shape='bars', axis='y', box=-0.387,0.387,-0.5,0.5,0,0.006, diameter=0.006, "
    "bars=1,13, spacing=0.5e-3, material='s', cuts='slab' /\n"
)


def test_a_scene_of_two_thousand_million_particles_is_sized_in_a_second(tmp_path):
    """Cells, particles, memory and steps come from the deck alone."""
    begin = time.monotonic()
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    code, out, err = check(tmp_path, HUGE)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert code == 0, err
    assert after.ru_utime - before.ru_utime < 1, f"{time.monotonic() - begin} s"
    assert "1000000000 cells" in out
    count = dict(re.findall(r"^body +(\w+): about (\d+) particles", out, re.MULTILINE))
    bars = 6.5 * 12 * 12 * 2000  # half a bar on the plane and six more
    assert int(count["bars"]) == bars
    assert int(count["slab"]) == pytest.approx(1000 * 2000 * 1000 - bars, abs=1)
    assert int(count["ball"]) == pytest.approx(4 / 3 * math.pi * 100**3 / 2, rel=1e-6)
    assert re.search(r"^memory +about \d+\.\d GB are needed", out, re.MULTILINE), out
    assert re.search(r"^solid steps .* in each step of the air, about \d+", out, re.MULTILINE), out


def test_too_little_memory_is_told_before_anything_is_built(tmp_path):
    """Exit code 5, with what is needed and what is there; a check only tells."""
    deck = AIR.replace("20,20,20", "200,200,200") + STEEL + PLATE
    (tmp_path / "case.nml").write_text(deck)
    done = subprocess.run(
        [BINARY, "run", "case.nml", "--backend", "cpu"],
        cwd=tmp_path,
        capture_output=True,
        timeout=60,
        check=False,
        text=True,
        preexec_fn=gigabytes(0.9),
        env={**os.environ, "OMP_NUM_THREADS": "1"},
    )
    assert done.returncode == 5, done.stderr
    assert re.search(
        r"too little memory: about \d\.\d GB are needed at most, \d\.\d GB by 8000000 "
        r"cells, .* [MG]B are free here; use a machine with more",
        done.stderr,
    )
    assert not (tmp_path / "out").exists()
    code, out, _ = check(tmp_path, deck, gigabytes(0.9))
    assert code == 0
    assert "8000000 cells" in out


@pytest.mark.parametrize(
    "bodies", ["", PLATE, PLATE + PLATE.replace("'p'", "'q'").replace("0.1,0.14,", "0.15,0.19,")]
)
def test_what_is_estimated_is_what_is_built(bodies, tmp_path):
    """Estimates of memory are those of the arrays that are there."""
    deck = AIR.replace("20,20,20", "60,60,60") + STEEL + bodies.replace("0.01,", "0.005,")
    code, out, err = check(tmp_path, deck)
    assert code == 0, err
    told = re.search(r"^air .* mm, ([\d.]+) MB", out, re.MULTILINE)
    needed = re.search(
        r"needed at most, ([\d.]+) MB by \d+ cells(?:, ([\d.]+) MB by (\d+) p)?", out
    )
    assert float(needed[1]) == pytest.approx(float(told[1]), rel=0.02)
    if bodies:
        solid = re.search(r"^solids +(\d+) particles, ([\d.]+) MB", out, re.MULTILINE)
        assert needed[3] == solid[1]
        lists = (84 + 36) * 1e-6 * int(solid[1])  # and what the coupling keeps
        assert float(needed[2]) - lists == pytest.approx(float(solid[2]), rel=0.02)


# The process has the peak of its parent for its own: a small one starts it.
PEAK = """\
import resource, subprocess, sys
done = subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL)
print(1024 * resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
sys.exit(done.returncode)
"""


def test_a_run_needs_no_more_memory_than_is_told(tmp_path):
    """Most of it goes to the cells around a block, 34 of 40 along each axis: what is told is more
    than is used, by the room that lists have for more, and no more than half as much again."""
    deck = AIR.replace("20,20,20", "40,40,40").replace("1e-4", "1e-3, max_steps=2")
    deck += STEEL + (
        "&body id='p', box=0.06,0.34,0.06,0.34,0.06,0.34, spacing=0.007, material='s',\n"
        "      formulation='rigid' /\n"
    )
    code, out, err = check(tmp_path, deck)
    assert code == 0, err
    told = float(re.search(r"about ([\d.]+) MB are needed at most", out)[1])
    done = subprocess.run(
        [sys.executable, "-c", PEAK, BINARY, "run", "case.nml", "--backend", "cpu"],
        cwd=tmp_path,
        capture_output=True,
        timeout=60,
        check=False,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    used = 1e-6 * float(done.stdout)
    assert used < told < 1.5 * used


def test_steps_without_end_are_counted(tmp_path):
    """1e11 steps are more than an integer of 32 bits holds."""
    deck = AIR.replace("1e-4", "9.5e5")
    code, out, err = check(tmp_path, deck + "&output dump_every=1e-10 /\n")
    assert code == 0, err
    steps = int(re.search(r"about (\d+) steps", out)[1])
    assert 0.9e11 < steps < 1.1e11
    assert "9.5e15 dumps" in out


def test_steps_of_bodies_are_counted(tmp_path):
    """In air the bodies take sub-steps; alone their step is that of the scene."""
    code, out, _ = check(tmp_path, AIR + STEEL + PLATE)
    assert code == 0
    air = float(re.search(r"^time step +([\d.E+-]+) s", out, re.MULTILINE)[1])
    solid = re.search(
        r"^solid steps +([\d.E+-]+) s at first: (\d+) in .* about (\d+) ", out, re.MULTILINE
    )
    assert int(solid[2]) == math.ceil(air / float(solid[1]))
    assert int(solid[3]) == round(1e-4 / air) * int(solid[2])
    code, out, _ = check(tmp_path, "&run t_end=1e-4 /\n" + STEEL + PLATE)
    alone = float(re.search(r"^time step +([\d.E+-]+) s", out, re.MULTILINE)[1])
    assert alone == pytest.approx(float(solid[1]), rel=1e-3)
    assert "solid steps" not in out


MEETINGS = """\
&run t_end=1e-6 /
&material id='s', model='linear_elastic', density=7850, youngs_modulus=2e11, poisson_ratio=0.3 /
&body id='slab', box=0,0.06, 0,0.06, 0,0.02, spacing=0.002, material='s' /
&body id='bar', shape='bars', axis='x', bars=1,1, diameter=0.006, box=0,0.06, 0.02,0.04,
  0.006,0.014, spacing=0.002, material='s', cuts='slab' /
&body id='p1', box=0,0.01, 0,0.01, 0.03,0.04, spacing=0.002, material='s' /
&body id='p2', box=0.02,0.03, 0,0.01, 0.03,0.04, spacing=0.002, material='s' /
&body id='p3', box=0.04,0.05, 0,0.01, 0.03,0.04, spacing=0.002, material='s' /
&interaction bodies='p1','slab', law='contact', friction=0.3 /
&interaction bodies='p2','slab', law='none' /
"""


def test_how_bodies_meet_is_told(tmp_path):
    """Law, reason and pairs; of many pairs of a kind the first."""
    code, out, err = check(tmp_path, MEETINGS)
    assert code == 0, err
    told = [" ".join(line.split()) for line in out.splitlines() if line.startswith("interaction")]
    assert told == [
        "interaction bonded (default: one cuts the other): slab+bar",
        "interaction contact, friction 0.3 (case.nml:9): slab+p1",
        "interaction none (case.nml:10): slab+p2",
        "interaction contact (default): slab+p3, bar+p1, bar+p2, bar+p3 and 3 more pairs",
    ]


def test_echo_is_the_complete_deck(tmp_path):
    """The file is what a run leaves in its folder; decks that mean the same give the same bytes."""
    deck = "&run t_end=1e-6, dimension=1 /\n&air box=0,1,0,1,0,1, cells=20,1,1 /\n"
    same = "! another text\n&air cells=20,1,1,\n  box=0,1.0,0,1,0,1e0 /\n"
    same += "&run dimension=1, t_end=2e-6 /\n"

    def echo(name, text, *more):
        (tmp_path / "case.nml").write_text(text)
        command = [BINARY, "run", "case.nml", "--check", "--echo", name, *more]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=20)
        assert done.returncode == 0, done.stderr
        return (tmp_path / name).read_bytes()

    first = echo("one.nml", deck)
    assert first == echo("two.nml", same, "--set", "run.t_end=1e-6")
    assert b"gamma = 1.4 ! default" in first and first != echo("three.nml", same)
    (tmp_path / "case.nml").write_text(deck)
    subprocess.run([BINARY, "run", "case.nml"], cwd=tmp_path, capture_output=True, check=True)
    assert first == (tmp_path / "out" / "case" / "case.echo.nml").read_bytes()


@pytest.mark.parametrize(
    ("args", "code", "message"),
    [
        (["--echo", "a.nml"], 2, "--echo goes with --check"),
        (["--check", "--echo"], 2, "--echo needs a value"),
        (["--check", "--echo", "no/such/folder/a.nml"], 4, "no/such/folder/a.nml"),
    ],
)
def test_echo_that_cannot_be(tmp_path, args, code, message):
    (tmp_path / "case.nml").write_text(AIR)
    done = subprocess.run(
        [BINARY, "run", "case.nml", *args], cwd=tmp_path, capture_output=True, text=True, timeout=20
    )
    assert done.returncode == code and message in done.stderr
