# SPDX-License-Identifier: MIT
"""`--describe` shows what a first deck needs, and all keys where it is asked to."""

import os
import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BRISANCE = Path(os.environ.get("BRISANCE", ROOT / "bin/brisance"))
GROUPS = ["run", "air", "charge", "body", "interaction", "load", "motion", "gauge", "output"]


def describe(*words):
    done = subprocess.run(
        [BRISANCE, "--describe", *words], capture_output=True, text=True, check=True
    )
    return done.stdout


def keys_in(text):
    """Names of the keys that a description explains, in its order."""
    return re.findall(r"^  (?!and \d)(\w+) +(?:\d+ |real|text|integer|logical)", text, re.MULTILINE)


@pytest.mark.parametrize("group", GROUPS)
def test_a_group_shows_the_few_keys_that_a_first_deck_needs(group):
    """A dozen at most, all that are required, and how many more there are."""
    few, every = describe(group), describe(group, "--all")
    more = re.search(rf"^  and (\d+) more: brisance --describe {group} --all$", few, re.MULTILINE)
    left = int(more[1]) if more else 0
    assert set(keys_in(few)) <= set(keys_in(every))
    assert len(keys_in(few)) + left == len(keys_in(every)), (keys_in(few), keys_in(every))
    assert 3 <= len(keys_in(few)) <= 12
    assert few.count(", required\n") == every.count(", required, basic\n")
    assert " more: " not in every


def test_the_body_of_a_first_deck_fits_a_screen():
    """Shape, spacing, material, supports, velocity; no knob of the method."""
    few = describe("body")
    assert {"shape", "box", "spacing", "material", "fix", "velocity"} <= set(keys_in(few))
    assert not {"alpha", "zeta", "tensile_control"} & set(keys_in(few))
    assert len(few.splitlines()) <= 40
    assert re.search(r"^  alpha .*, expert$", describe("body", "--all"), re.MULTILINE)


def test_the_reference_marks_the_same_keys():
    """The level of each key stands in the page of the manual."""
    page = describe("--markdown")
    body = page[page.index("## &body") : page.index("## &interaction")]
    marked = re.findall(r"^\| `(\w+)` \| \*\*basic\*\* \|", body, re.MULTILINE)
    assert marked == keys_in(describe("body"))


def test_materials_show_what_they_cannot_do_without():
    """The required keys of every model, and how many more."""
    few = describe("material")
    assert "with model='linear_elastic'" in few
    assert "youngs_modulus" in few
    assert re.search(r"^  and \d+ more: brisance --describe material --all$", few, re.MULTILINE)
