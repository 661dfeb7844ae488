#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draw the stability map of the solids.

usage: stability_map.py TABLE.csv PICTURE.png

A row of the table is one problem in one formulation: what was seen (stable, noisy, fractured,
clumped, failed) and the number of that problem.
"""

import csv
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot

COLOURS = {
    "stable": "#b7dfb9",
    "noisy": "#fbe7a1",
    "clumped": "#f6c28b",
    "fractured": "#ef9a94",
    "failed": "#c58fc9",
}


def short(number):
    """A number as it fits a cell."""
    size = abs(number)
    if size == 0:
        return "0"
    if size < 1e-3 or size >= 1e3:
        return f"{number:.0e}".replace("e-0", "e-").replace("e+0", "e")
    return f"{number:.3g}"


def main(table, picture):
    """One coloured cell for each pair of formulation and problem."""
    with Path(table).open(encoding="utf-8") as lines:
        rows = list(csv.DictReader(lines))
    tests = list(dict.fromkeys(row["test"] for row in rows))
    forms = list(dict.fromkeys(row["formulation"] for row in rows))
    quantity = {row["test"]: row["quantity"] for row in rows}
    figure, axes = pyplot.subplots(figsize=(1.15 * len(tests) + 2.0, 0.42 * len(forms) + 1.4))
    for row in rows:
        x, y = tests.index(row["test"]), forms.index(row["formulation"])
        axes.add_patch(pyplot.Rectangle((x, y), 1, 1, fc=COLOURS[row["seen"]], ec="white", lw=2))
        axes.text(x + 0.5, y + 0.38, row["seen"], ha="center", va="center", fontsize=8)
        axes.text(
            x + 0.5, y + 0.72, short(float(row["value"])), ha="center", va="center", fontsize=7
        )
    axes.set_xlim(0, len(tests))
    axes.set_ylim(len(forms), 0)
    axes.set_xticks([i + 0.5 for i in range(len(tests))])
    heads = [f"{test}\n{quantity[test]}".replace("angular momentum", "spin") for test in tests]
    axes.set_xticklabels(heads, fontsize=7)
    axes.set_yticks([i + 0.5 for i in range(len(forms))])
    axes.set_yticklabels(forms, fontsize=8)
    axes.tick_params(length=0)
    axes.xaxis.tick_top()
    for side in axes.spines.values():
        side.set_visible(False)
    figure.tight_layout()
    figure.savefig(picture, dpi=150)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2])
