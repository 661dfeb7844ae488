# SPDX-License-Identifier: MIT
"""Histories of a run of Brisance in its folder (out/deck)."""

from __future__ import annotations

import csv
from itertools import pairwise
from pathlib import Path

from studies.comparisons.case import History


def column(folder: Path, gauge: str, table: str = "gauges.csv") -> History:
    """(time, value) of the column whose name begins with a text."""
    with (folder / "out" / "deck" / table).open(encoding="utf-8") as file:
        rows = csv.reader(file, skipinitialspace=True)
        names = [name.strip() for name in next(rows)]
        at = next((k for k, name in enumerate(names) if name.startswith(gauge)), None)
        if at is None:
            raise KeyError(f"{folder}: no column {gauge} in {table}: {', '.join(names)}")
        return [(float(row[0]), float(row[at])) for row in rows if row]


def impulses(history: History) -> History:
    """(time, integral over time until then), by trapezoids: of a pressure [Pa s]."""
    total, found = 0.0, []
    for (a, p), (b, q) in pairwise(history):
        total += (b - a) * (p + q) / 2
        found.append((b, total))
    return found


def impulse(history: History, end: float) -> float:
    """The integral over time until `end`, by trapezoids: of a pressure [Pa s]."""
    return next((v for t, v in reversed(impulses(history)) if t <= end * (1 + 1e-9)), 0.0)
