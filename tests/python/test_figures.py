# SPDX-License-Identifier: MIT
"""The check of the figures in the manual's tables sees a figure that is not the measured one."""

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from notes import note

ROOT = Path(__file__).parents[2]
PAGE = """# A page

| test | bound | measured |
|---|---|---|
| tube | 2e-3 | 1.50e-3, 0.98 <!-- = error order --> |
| books | 1e-12 | 3e-14 <!-- = max(books_*) --> |
| speed, three runs | 1 % | +0.3 to 1.2 % <!-- = min(speed_?) max(speed_?) --> |
| a study (`docs/data/x.csv`) | none | 7.1 |
| plate, 2-D | holds | 2; 4.06 mm <!-- = - hole~0.1 --> |
"""
NOTES = """error,0.9
error,0.0014961
order,0.9764
books_a,1e-15
books_b,-2.9e-13
speed_1,0.345
speed_2,-1.23
hole,4.13
"""


def figures(folder, page=PAGE, notes=NOTES, *more):
    (folder / "page.md").write_text(page)
    (folder / "notes.csv").write_text(notes)
    script = ROOT / "scripts/figures.py"
    command = [sys.executable, str(script), "notes.csv", "page.md", *more]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


def test_rounded_figures_agree(tmp_path):
    assert figures(tmp_path) == (0, "6 figures in tables are those of the tests\n")


def test_what_slow_tests_measure_may_be_missing(tmp_path):
    """With --some alone; extremes are those of all tests."""
    few = "error,0.0014961\norder,0.9764\nspeed_1,0.2\n"
    told = "2 figures in tables are those of the tests\n"
    assert figures(tmp_path, PAGE, few, "--some") == (0, told)
    assert figures(tmp_path, PAGE, few)[0] == 1
    assert figures(tmp_path, PAGE.replace("0.98", "0.97"), few, "--some")[0] == 1
    assert "new stands in no table" in figures(tmp_path, PAGE, few + "new,1\n", "--some")[1]


WRONG = [
    (("1.50e-3", "1.51e-3"), 5, "error is 1.51e-3 in the table, measured 0.0014961: 1.50e-3"),
    (("0.98", "0.97"), 5, "order is 0.97"),
    (("3e-14", "2e-14"), 6, "measured 2.9e-13: 3e-13"),
    (("1.2 %", "1.3 %"), 7, "max(speed_?) is 1.3 in the table, measured 1.23: 1.2"),
    (("4.06", "4.31"), 9, "hole is 4.31"),
    (("error order", "error"), 5, "2 figures and 1 keys"),
    (("error order", "error rate"), 5, "rate was not measured"),
    ((" <!-- = error order -->", ""), 5, "no key for the figures '1.50e-3, 0.98'"),
    (("`docs/data/x.csv`", "of a study"), 8, "no key for the figures '7.1'"),
    ((" <!-- = - hole~0.1 -->", " (`docs/data/x.csv`)"), None, "hole stands in no table"),
]


@pytest.mark.parametrize(("change", "line", "words"), WRONG)
def test_what_does_not_agree_is_named(tmp_path, change, line, words):
    code, text = figures(tmp_path, PAGE.replace(*change, 1))
    assert code != 0
    assert words in text
    assert line is None or f"page.md:{line}: " in text


def test_measured_figures_are_put_in_place(tmp_path):
    page = PAGE.replace("1.50e-3", "9.99e-3").replace("4.06", "9.00").replace("+0.3", "+0.9")
    code, text = figures(tmp_path, page, NOTES, "--write")
    assert code == 0
    assert "error is 9.99e-3 in the table" in text
    written = (tmp_path / "page.md").read_text()
    assert "1.50e-3, 0.98 <!--" in written
    assert "2; 4.13 mm" in written
    assert "+0.3 to 1.2 %" in written
    assert figures(tmp_path, written)[0] == 0


# Every figure with a key in the manual, as its page shows it; one of them changed.
CELL = re.compile(r"\|([^|]*?)<!-- = (.*?) -->")
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w])")


@pytest.mark.parametrize("name", ["docs/evidence/verification.md"])
def test_one_false_figure_in_the_manual_is_found(tmp_path, name):
    page = (ROOT / name).read_text()
    shown = {}
    for cell, keys in CELL.findall(page):
        shown.update(zip(keys.split(), NUMBER.findall(cell), strict=True))
    plain = {key: number for key, number in shown.items() if "(" not in key and "~" not in key}
    assert len(plain) > 20
    notes = "".join(f"{key},{number}\n" for key, number in plain.items())
    assert " in the table, measured " not in figures(tmp_path, page, notes)[1]
    cell, keys = next(x for x in CELL.findall(page) if x[1].split()[0] in plain)
    number = NUMBER.search(cell)[0]
    false = re.sub(r"[1-9]", lambda digit: str((int(digit[0]) + 3) % 9 + 1), number, count=1)
    wrong = page.replace(cell + "<!--", cell.replace(number, false, 1) + "<!--", 1)
    key = keys.split()[0]
    code, text = figures(tmp_path, wrong, notes)
    assert code != 0
    assert f"{key} is {false} in the table" in text


def test_what_a_table_cannot_name_is_no_note(tmp_path, monkeypatch):
    """A key with a blank, several numbers under one key: with and without a file of notes."""
    with pytest.raises(AssertionError, match="'face 1' cannot be named in a table"):
        note("face 1", 1.0)
    monkeypatch.delenv("BRZ_NOTES", raising=False)
    with pytest.raises(TypeError):
        note("face_1", np.ones(3))
    monkeypatch.setenv("BRZ_NOTES", str(tmp_path / "notes.csv"))
    with pytest.raises(TypeError):
        note("face_1", np.ones(3))
    assert not (tmp_path / "notes.csv").exists()
    note("face_1", 0.5)
    assert (tmp_path / "notes.csv").read_text() == "face_1,5.0000000000000000e-01\n"
