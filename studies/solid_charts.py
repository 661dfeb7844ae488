#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draw the recorded study of the solids: error against seconds, a panel for each problem.

usage: solid_charts.py TABLE.csv PICTURE.png

Open marks are results that are no use as they stand (noisy, fractured, clumped); failed runs are
left out. Formulations are named up to their first comma.
"""

import csv
import sys
from collections import defaultdict
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

TITLES = {
    "cantilever": "cantilever: period\n{} particles across",
    "clamped plate": "clamped plate: period\n{} layers",
    "impact 2 km/s": "aluminium, 2 km/s: pressure\n{} particles along",
    "Taylor bar, length": "Taylor bar of copper: length\n{} per radius",
    "Taylor bar, foot": "Taylor bar of copper: foot\n{} per radius",
}
STYLES = {
    "paper": ("tab:gray", "v"),
    "corrected": ("tab:orange", "^"),
    "corrected_hourglass": ("tab:red", "o"),
    "bending": ("tab:blue", "s"),
    "total_lagrangian": ("tab:green", "P"),
    "finite elements": ("black", "x"),
}


def main(table, picture):
    """One line per formulation, one mark per resolution."""
    lines = defaultdict(list)
    numbers = defaultdict(set)
    with Path(table).open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if row["seen"] == "failed":
                continue
            error = 100 * abs(float(row["error"]))
            lines[row["test"], row["formulation"].partition(",")[0]].append(
                (float(row["seconds"]), error, row["seen"] == "stable")
            )
            numbers[row["test"]].add(int(row["resolution"]))
    fig, axes = plt.subplots(1, len(TITLES), figsize=(18, 4.6), constrained_layout=True)
    for ax, (test, title) in zip(axes, TITLES.items(), strict=True):
        for form, (colour, mark) in STYLES.items():
            points = lines[test, form]
            ax.loglog([p[0] for p in points], [p[1] for p in points], "-", color=colour, lw=1)
            for seconds, error, sound in points:
                fill = colour if sound else "white"
                ax.loglog(seconds, error, mark, color=colour, mfc=fill, ms=6)
        for axis in (ax.xaxis, ax.yaxis):
            axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
            axis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
            axis.set_minor_formatter(NullFormatter())
        ax.tick_params(labelsize=8)
        ax.set_title(title.format(", ".join(map(str, sorted(numbers[test])))), fontsize=9)
        ax.set_xlabel("seconds of one core")
        ax.grid(visible=True, which="both", alpha=0.25)
    axes[0].set_ylabel("error [%]")
    handles = [
        plt.Line2D([], [], color=colour, marker=mark, label=form)
        for form, (colour, mark) in STYLES.items()
    ]
    fig.legend(handles=handles, loc="outside lower center", ncols=6, frameon=False, fontsize=8)
    fig.savefig(picture, dpi=110)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
