# SPDX-License-Identifier: MIT
"""Histories of a run of Brisance in its folder (out/deck)."""

from __future__ import annotations

import csv
from pathlib import Path

from comparisons.case import History


def column(folder: Path, gauge: str, table: str = "gauges.csv") -> History:
    """(time, value) of the column whose name begins with a text."""
    with (folder / "out" / "deck" / table).open(encoding="utf-8") as file:
        rows = csv.reader(file, skipinitialspace=True)
        names = [name.strip() for name in next(rows)]
        at = next((k for k, name in enumerate(names) if name.startswith(gauge)), None)
        if at is None:
            raise KeyError(f"{folder}: no column {gauge} in {table}: {', '.join(names)}")
        return [(float(row[0]), float(row[at])) for row in rows if row]
