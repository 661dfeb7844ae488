# SPDX-License-Identifier: MIT
"""Figures that a test has measured, for the tables of the manual; see tests/verify/notes.f90."""

import os
import re
from pathlib import Path


def note(key, value):
    """Note a number under a key of letters, digits, points, signs and `_` (scripts/figures.py)."""
    assert re.fullmatch(r"[\w.+-]+", key), f"'{key}' cannot be named in a table"
    line = f"{key},{value:.16e}\n"
    if path := os.environ.get("BRZ_NOTES"):
        with Path(path).open("a", encoding="utf-8") as file:
            file.write(line)
