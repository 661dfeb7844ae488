#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Pictures of the recorded studies of the air: error against seconds, and where schemes fail.

usage: air_charts.py accuracy|stability table.csv picture.png
"""

from __future__ import annotations

import csv
import sys
from collections import defaultdict
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

PROBLEMS = ("sod", "entropy wave", "vortex", "sedov", "free-air blast")
COLOURS = {"first_order": "0.6", "muscl": "tab:blue", "weno3": "tab:orange", "weno5z": "tab:green"}
SEEN = {"survived": "#d9ead3", "fell back": "#fff2cc", "failed": "#f4b6b0"}


def rows(path: str) -> list[dict[str, str]]:
    """The rows of a table."""
    with Path(path).open() as file:
        return list(csv.DictReader(file))


def accuracy(table: str, picture: str) -> None:
    """One panel per problem, one line per scheme, one mark per resolution."""
    lines: dict[tuple[str, str], list[tuple[float, float, int]]] = defaultdict(list)
    for row in rows(table):
        if float(row["error"]) >= 0:
            point = float(row["seconds"]), float(row["error"]), int(row["cells"])
            lines[row["problem"], row["scheme"]].append(point)
    fig, axes = plt.subplots(2, 3, figsize=(13, 8), constrained_layout=True)
    for ax, problem in zip(axes.flat, PROBLEMS, strict=False):
        for (name, scheme), points in lines.items():
            if name != problem:
                continue
            seconds, errors, _ = zip(*points, strict=True)
            reconstruction, flux = scheme.rsplit("-", 1)
            label = f"{reconstruction.replace('_', ' ')}, {flux.upper()}"
            dash, mark = ("-", "o") if flux == "hllc" else ("--", "s")
            ax.loglog(
                seconds, errors, dash, marker=mark, ms=4, color=COLOURS[reconstruction], label=label
            )
        cells = sorted({p[2] for key, value in lines.items() if key[0] == problem for p in value})
        ax.set_title(f"{problem}: {', '.join(map(str, cells))} cells along a side", fontsize=10)
        ax.set_xlabel("seconds of one core")
        ax.set_ylabel("mean error")
        ax.grid(visible=True, which="both", alpha=0.25)
    handles, labels = axes.flat[0].get_legend_handles_labels()
    axes.flat[5].axis("off")
    axes.flat[5].legend(handles, labels, loc="center", frameon=False)
    axes.flat[5].set_title("lower left is better", fontsize=10)
    fig.savefig(picture, dpi=110)


def stability(table: str, picture: str) -> None:
    """One panel per scheme and choice of fallback: Courant number against pressure ratio."""
    found = rows(table)
    schemes = list(dict.fromkeys(row["scheme"] for row in found))
    fig, axes = plt.subplots(2, len(schemes), figsize=(15, 5), constrained_layout=True)
    for column, scheme in enumerate(schemes):
        for line, fallback in enumerate(("with", "without")):
            panel(
                axes[line, column],
                [
                    row
                    for row in found
                    if row["scheme"] == scheme and row["fallback"].strip() == fallback
                ],
            )
            if line == 0:
                axes[line, column].set_title(scheme.replace("_", " "), fontsize=9)
            if column == 0:
                axes[line, column].set_ylabel(f"Courant number\n{fallback} fallback", fontsize=9)
            if line == 1:
                axes[line, column].set_xlabel("pressure ratio 10^", fontsize=9)
    patches = [plt.Rectangle((0, 0), 1, 1, color=colour) for colour in SEEN.values()]
    fig.legend(patches, SEEN, loc="outside lower center", ncols=3, frameon=False)
    fig.savefig(picture, dpi=110)


def panel(ax: plt.Axes, found: list[dict[str, str]]) -> None:
    """What was seen, as coloured fields with the number of faces that fell back."""
    numbers = sorted({float(row["cfl"]) for row in found})
    ratios = sorted({float(row["pressure ratio"]) for row in found})
    for row in found:
        x, y = ratios.index(float(row["pressure ratio"])), numbers.index(float(row["cfl"]))
        ax.add_patch(plt.Rectangle((x, y), 1, 1, fc=SEEN[row["seen"].strip()], ec="white"))
        if row["seen"].strip() == "fell back":
            ax.text(x + 0.5, y + 0.5, row["fallback faces"], ha="center", va="center", fontsize=6)
    ax.set_xlim(0, len(ratios))
    ax.set_ylim(0, len(numbers))
    ax.set_xticks([i + 0.5 for i in range(len(ratios))], [f"{r:.0e}"[-1] for r in ratios])
    ax.set_yticks([i + 0.5 for i in range(len(numbers))], [f"{c:g}" for c in numbers])


if __name__ == "__main__":
    if len(sys.argv) != 4 or sys.argv[1] not in ("accuracy", "stability"):
        sys.exit(__doc__)
    {"accuracy": accuracy, "stability": stability}[sys.argv[1]](*sys.argv[2:])
