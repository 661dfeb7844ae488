# SPDX-License-Identifier: MIT
"""Figures that a test has measured, for the tables of the manual; see tests/verify/notes.f90."""

import os
from pathlib import Path


def note(key, value):
    if path := os.environ.get("BRZ_NOTES"):
        with Path(path).open("a", encoding="utf-8") as file:
            file.write(f"{key},{value:.16e}\n")
