# SPDX-License-Identifier: MIT
"""The decks of docs/jobs run in their coarse form, and give what a calculation by hand gives."""

import csv
import os
import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BRISANCE = Path(os.environ.get("BRISANCE", ROOT / "bin/brisance"))
PAGES = sorted((ROOT / "docs/jobs").glob("*.md"))
DECKS = sorted((ROOT / "inputs/jobs").glob("*.nml"))

# Of each deck: changes, a column of a table, and the bounds of its largest magnitude.
COARSE = {
    # Kingery-Bulmash, hemisphere, reflected: 648 Pa s, of which the front has brought two thirds
    "wall": (
        ["air.cells=20,10,12", "body.spacing=0.25", "run.t_end=7e-3"],
        ("energy", "impulse_x"), (1000, 2600),
    ),
    # Kingery-Bulmash: 199 kPa, 200 with the default 240 cells
    "surface_burst": (
        ["charge.radial_cells=80", "run.t_end=5e-3"], ("gauges", "4m"), (180e3, 210e3),
    ),
    # 2 kg at 0.8 m: the plate has the velocity of its impulse, 1.5 kPa s over 94 kg/m2, for 0.15 ms
    "plate_load": (
        ["body.spacing=6e-3", "run.t_end=4.5e-4"], ("gauges", "mid"), (0.8e-3, 3.5e-3),
    ),
    # the front arrives at 0.163 ms; 370 Pa s over 33 kg/m2 in 40 us
    "plate_air": (
        ["air.cells=17,17,56", "body.spacing=4.2e-3", "run.t_end=2.1e-4"],
        ("gauges", "mid"), (0.1e-3, 0.6e-3),
    ),
    # a free plate: 1 kPa s over 12.6 kg/m2, a pulse that falls to nothing in 20 us: 1.86 mm
    "plate_impulse": (
        ["body.aspect=4.551141,4.551141,1", "run.t_end=3e-5"],
        ("gauges", "mid"), (1.83e-3, 1.89e-3),
    ),
    # a free slab: 545 Pa s over 96 kg/m2 for some 20 us
    "rc_slab": (
        ["body(slab).spacing=10e-3", "body(bars_x).spacing=6e-3",
         "body(bars_y).spacing=6e-3", "run.t_end=1.9e-4"],
        ("gauges", "mid"), (0.02e-3, 0.25e-3),
    ),
    # a free plate: 475 Pa s over 6.3 kg/m2
    "laminate": (
        ["body.spacing=4.2e-3", "run.t_end=2.2e-4"], ("gauges", "mid"), (1e-3, 4e-3),
    ),
    "fragment_plate": (
        ["body(target).spacing=4e-3", "body(fragment).spacing=4e-3", "run.t_end=4e-5"],
        ("gauges", "back"), (100, 400),
    ),
    "rod_concrete": (
        ["body(slab).spacing=20e-3", "run.t_end=6e-5"], ("bodies", "rod:velocity_z"), (748, 750),
    ),
    # the pieces of both fly on with less than the projectile had
    "hypervelocity": (
        ["body(projectile).spacing=0.5e-3", "body(plate).spacing=0.5e-3"],
        ("bodies", "plate:velocity_x"), (100, 1500),
    ),
    # the products push the sphere by some metres per second, and nothing is hit yet
    "blast_fragments": (
        ["run.t_end=8e-5"], ("gauges", "speed"), (459, 470),
    ),
    # a beam by its modes: 2.559 mm
    "beam": (
        ["body.spacing=13.33333e-3", "body.box=-0.533333,0.533333,0,0.04,0,1",
         "run.t_end=2.5e-3"], ("gauges", "mid"), (2.45e-3, 2.66e-3),
    ),
    # acoustics: 6.72 m/s, less what viscosity takes
    "spall": (["body.spacing=8e-3", "run.t_end=1e-4"], ("gauges", "back"), (4.5, 6.8)),
}  # fmt: skip


def column(path, start):
    """All values of the column whose name begins so."""
    with path.open(encoding="utf-8") as file:
        rows = list(csv.reader(file))
    place = next(k for k, name in enumerate(rows[0]) if name.strip().startswith(start))
    return [float(row[place]) for row in rows[1:]]


@pytest.mark.long("a job to its result, as coarse as its page allows")
@pytest.mark.parametrize("deck", DECKS, ids=[deck.stem for deck in DECKS])
def test_a_coarse_job_gives_what_a_hand_calculation_does(tmp_path, deck):
    """It runs to its end in seconds, and its main quantity is between bounds by hand."""
    changes, (table, name), (low, high) = COARSE[deck.stem]
    words = [word for change in changes for word in ("--set", change)]
    command = [BRISANCE, "run", deck, "--out", tmp_path / "out", *words]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    largest = max(abs(value) for value in column(tmp_path / f"out/{table}.csv", name))
    assert low <= largest <= high, largest


@pytest.mark.parametrize("deck", DECKS, ids=[deck.stem for deck in DECKS])
def test_a_job_is_a_sound_deck_as_it_stands(tmp_path, deck):
    """`--check` of the deck that its page says to copy: no error."""
    command = [BRISANCE, "run", deck, "--check", "--out", tmp_path / "out"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    assert "verdict" in done.stdout or "charge" in done.stdout


def test_every_job_has_a_page_and_every_page_its_parts():
    """Each deck is named by a page; pages have deck, cost, error and limits."""
    texts = {page.name: page.read_text(encoding="utf-8") for page in PAGES}
    for deck in DECKS:
        named = [name for name, text in texts.items() if deck.name in text and name != "index.md"]
        assert named, deck.name
        assert deck.stem in COARSE
    for name, text in texts.items():
        if name in ("index.md", "gallery.md"):
            continue
        heads = re.findall(r"^## (.*)", text, re.MULTILINE)
        assert any(head.startswith("The deck") for head in heads), name
        assert {"Cost", "Error to expect", "In the report", "Limits"} <= set(heads), name
        assert f"({name})" in texts["index.md"], f"{name} is not in the list of jobs"


def test_every_page_says_first_for_whom_it_is():
    """After the heading, a sentence that begins with For."""
    for page in sorted((ROOT / "docs").rglob("*.md")):
        head, text = page.read_text(encoding="utf-8").split("\n\n")[:2]
        assert head.startswith("# "), page
        assert text.startswith("For who"), page
