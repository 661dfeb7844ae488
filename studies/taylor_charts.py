#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draw the Taylor bar of copper: convergence of the particles, and surfaces beside the experiment.

usage: taylor_charts.py SHAPES.csv PROFILES.csv EXPERIMENT.csv PICTURE.png
"""

import csv
import sys
from collections import defaultdict
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

QUANTITIES = {"L/L0": 0.638, "D/D0": 1.78, "W/D0": 1.326}  # and the experiment


def rows(path):
    """The rows of a table, without its remarks."""
    lines = Path(path).read_text(encoding="utf-8").splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def main(shapes, profiles, experiment, picture):
    """Three panels against 1/resolution, and one of surfaces."""
    found = defaultdict(list)
    for row in rows(shapes):
        if row["bar"].startswith("copper"):
            found[row["method"]].append(row)
    fig, axes = plt.subplots(1, 4, figsize=(15, 4.6), constrained_layout=True)
    for ax, (quantity, measured) in zip(axes, QUANTITIES.items(), strict=False):
        for method, points in found.items():
            x = [1 / int(p["per radius"]) for p in points]
            style = "k-o" if method == "elements" else "-s"
            if "Armstrong" in method:
                style = "k*"
            ax.plot(x, [float(p[quantity]) for p in points], style, ms=5, label=method)
        ax.axhline(measured, color="0.5", ls=":", label="experiment")
        ax.set_xlim(0, 0.18)
        ax.set_xlabel("1/(particles or elements per radius)")
        ax.set_title(quantity)
        ax.grid(visible=True, alpha=0.25)
    surfaces = defaultdict(list)
    for row in rows(profiles):
        surfaces[row["method"]].append((float(row["radius mm"]), float(row["height mm"])))
    for method, points in surfaces.items():
        r, z = zip(*points, strict=True)
        axes[3].plot(r, z, label=method)
    measured = [
        (float(p["radius_mm"]), float(p["height_above_anvil_mm"])) for p in rows(experiment)
    ]
    r, z = zip(*[p for p in measured if p[0] > 0], strict=True)
    axes[3].plot(r, z, "k.", ms=6, label="experiment")
    axes[3].set(xlabel="radius [mm]", ylabel="height [mm]", title="surface at rest", xlim=(3, 8))
    axes[3].legend(fontsize=6)
    handles, labels = axes[0].get_legend_handles_labels()
    fig.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False, fontsize=7)
    fig.savefig(picture, dpi=110)


if __name__ == "__main__":
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    main(*sys.argv[1:])
