# SPDX-License-Identifier: MIT
"""What `--check` says: warnings of decks that run but may not mean what they say, sizes, steps."""

import os
import re
import subprocess
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
    "one_particle_across_a_bar": (
        "&run t_end=1e-4 /\n"
        + STEEL
        + "&body id='b', shape='bars', axis='x', box=0,0.1,0,0.01,0,0.01, diameter=0.01, "
        "spacing=0.009, material='s' /\n",
        "case.nml:3: &body id='b': warning: one particle across a bar",
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


def test_boxes_of_gas_on_faces_of_cells_are_sound(tmp_path):
    """A box that ends on faces or outside, and a gauge on the surface of a body."""
    text = AIR + "&gas id='a', box=-1,9,-1,0.4,0.18,0.2, density=2, pressure=2e5 /\n"
    code, out, err = check(tmp_path, text + STEEL + PLATE + "&gauge id='g', at=0.14,0.2,0.2 /\n")
    assert code == 0
    assert "verdict      the deck is sound" in out, out + err
