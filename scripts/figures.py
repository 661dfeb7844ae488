#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Compare the figures in the tables of the manual with those that the tests have measured.

usage: figures.py NOTES.csv... [--write] [--some] [PAGE...]

NOTES has lines `key,value`, the last one counts.

A cell names the keys of its figures, in their order, in a comment that begins with `=`:

    | Sod tube, L1 of density | 9.2e-3, 4.7e-3 | 9.07e-3, 4.54e-3 <!-- = sod_1 sod_2 --> |

A key may be `-` (a number that is no figure), max(PATTERN) or min(PATTERN), the largest or least
size of those that match, and KEY~0.02 gives a tolerance. A figure is right if it is the measured
value rounded to the digits shown; one below 1e-11, which is rounding, if the measured one is not
ten times as large. In a table with a column `measured` every row with a figure there names its
keys, or the file of docs/data that it comes from. Every key that a test notes stands in a table.
--some: where slow tests were left out, figures that were not measured are passed over, and so are
extremes. --write puts the measured figures in place.
"""

import fnmatch
import re
import sys
from pathlib import Path

COMMENT = re.compile(r"<!-- = (.*?) -->")
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w])")
EXTREME = re.compile(r"(max|min)\((.*)\)")
PAGES = ["docs/evidence/verification.md"]
ROUNDING = 1e-11


def read_notes(paths):
    notes = {}
    for path in paths:
        if not path.exists():
            sys.exit(f"{path} is missing: run `make verify python`")
        for line in path.read_text(encoding="utf-8").splitlines():
            key, _, value = line.rpartition(",")
            notes[key] = float(value)
    return notes


def value_of(key, notes, used):
    """The measured value that a key stands for, None without one."""
    if found := EXTREME.fullmatch(key):
        names = fnmatch.filter(notes, found[2])
        used.update(names)
        chosen = {"max": max, "min": min}[found[1]]
        return chosen((abs(notes[name]) for name in names), default=None)
    used.add(key)
    return notes.get(key)


def unit_of(text):
    """One in the last digit that a number shows."""
    mantissa, _, power = text.partition("e")
    return 10.0 ** (int(power or 0) - len(mantissa.partition(".")[2]))


def agrees(text, value, tolerance):
    shown = float(text)
    if tolerance is not None:
        return abs(value - shown) <= tolerance
    if shown == 0 and "." not in text:
        return abs(value) <= ROUNDING
    if abs(shown) < ROUNDING:
        return abs(value) <= 10 * abs(shown)
    return abs(value - shown) <= 0.55 * unit_of(text)


def as_shown(text, value):
    """The value with as many digits as the text has."""
    mantissa, _, power = text.partition("e")
    digits = len(mantissa.partition(".")[2])
    if power:
        new = re.sub(r"e([-+])0*(?=\d)", r"e\1", f"{value:.{digits}e}").replace("e+", "e")
    else:
        new = f"{value:.{digits}f}"
    return "+" + new if text.startswith("+") and value >= 0 else new


class Page:
    """One page of the manual, looked through line by line."""

    def __init__(self, path, notes, used, some):
        self.some = some
        self.path, self.notes, self.used = path, notes, used
        self.lines = path.read_text(encoding="utf-8").splitlines()
        self.faults, self.compared, self.column = [], 0, None

    def check(self):
        for number, line in enumerate(self.lines, 1):
            if not line.startswith("|"):
                self.column = None
                continue
            cells = line.split("|")
            if self.column is None:
                names = [cell.strip() for cell in cells]
                self.column = names.index("measured") if "measured" in names else 0
            for place, cell in enumerate(cells):
                if COMMENT.search(cell):
                    cells[place] = self.cell(cell, number)
                elif place == self.column != 0 and self.needs_key(cell, line):
                    self.fault(number, f"no key for the figures '{cell.strip()}'")
            self.lines[number - 1] = "|".join(cells)

    def fault(self, number, text):
        self.faults.append(f"{self.path}:{number}: {text}")

    @staticmethod
    def needs_key(cell, line):
        return NUMBER.search(cell) is not None and "docs/data/" not in line

    def cell(self, cell, number):
        """The cell with the measured figures; faults are added where it shows others."""
        comment = COMMENT.search(cell)
        keys = comment[1].split()
        text = cell[: comment.start()]
        figures = list(NUMBER.finditer(text))
        if len(figures) != len(keys):
            self.fault(number, f"{len(figures)} figures and {len(keys)} keys in '{cell.strip()}'")
            return cell
        for figure, key in reversed(list(zip(figures, keys, strict=True))):
            if key == "-":
                continue
            name, _, tolerance = key.partition("~")
            value = value_of(name, self.notes, self.used)
            if self.some and (value is None or EXTREME.fullmatch(name)):
                continue
            if value is None:
                self.fault(number, f"{name} was not measured: run `make verify python`")
                continue
            self.compared += 1
            if agrees(figure[0], value, float(tolerance) if tolerance else None):
                continue
            new = as_shown(figure[0], value)
            self.fault(number, f"{name} is {figure[0]} in the table, measured {value:.6g}: {new}")
            text = text[: figure.start()] + new + text[figure.end() :]
        return text + cell[comment.start() :]


def main():
    paths = [Path(word) for word in sys.argv[1:] if not word.startswith("--")]
    files = [path for path in paths if path.suffix == ".csv"]
    if not files:
        sys.exit(__doc__)
    notes, used = read_notes(files), set()
    chosen = [path for path in paths if path not in files] or [Path(name) for name in PAGES]
    pages = [Page(path, notes, used, "--some" in sys.argv) for path in chosen]
    for page in pages:
        page.check()
        if "--write" in sys.argv:
            page.path.write_text("\n".join(page.lines) + "\n", encoding="utf-8")
    faults = [fault for page in pages for fault in page.faults]
    where = ", ".join(map(str, files))
    faults += [f"{where}: {key} stands in no table" for key in notes if key not in used]
    if faults and "--write" in sys.argv:
        print("\n".join(faults))
        return
    if faults:
        sys.exit("\n".join(faults))
    print(f"{sum(page.compared for page in pages)} figures in tables are those of the tests")


if __name__ == "__main__":
    main()
