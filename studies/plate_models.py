#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Error against seconds for the plate under blast of the paper, by how much is modelled.

usage: plate_models.py [draw]

168 g of TNT at 0.4 m from a clamped plate of CFRP: a load by Kingery-Bulmash without air; air with
a charge that is burnt at once, or started along its radius or in a plane; the load that such air
has on a rigid plate, put onto the plate alone (its seconds are those of both runs); a quarter or
the whole plate; coarse to fine. Each run has one core, two run at a time. The error is that of the
displacement of two points after 0.3 ms, before damage decides, against the scene at the resolution
of the paper (REFERENCE). Records docs/data/plate_models.csv and draws
docs/figures/plate_models.png; `draw` only draws.
"""

from __future__ import annotations

import csv
import re
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from model_charts import TILES, compute, read, readable, sizes, tiles, wall_loads

TABLE = Path("docs/data/plate_models.csv")
PICTURE = Path("docs/figures/plate_models.png")
FOLDER = Path("out/plate_models")
KEYS = ("run", "model", "cells_mm", "spacing_mm", "middle_mm", "quarter_mm", "error", "seconds")
# [mm] middle and quarter point: inputs/paper/plate.nml, 0.3 mm, cells of 1.2 mm, H200, 054bcf3
REFERENCE = (5.981, 5.998)
END = 3e-4
PLATE = """&run title = 'Plate under blast', t_end = {end}{symmetry} /
&material id = 'cfrp', preset = 'cfrp_woven' /
&body
    id = 'plate', shape = 'box', box = -0.125, 0.125,  -0.125, 0.125,  -0.0042, 0
    spacing = {spacing}e-3, material = 'cfrp', formulation = 'bending'
    fix_box = -0.126, -0.1208,  -0.126, 0.126,  -0.005, 0.001
               0.1208, 0.126,   -0.126, 0.126,  -0.005, 0.001
              -0.126, 0.126,  -0.126, -0.1208,  -0.005, 0.001
              -0.126, 0.126,   0.1208, 0.126,   -0.005, 0.001
/
&gauge id = 'mid', at = 0, 0, -0.0021, quantity = 'displacement_z', body = 'plate' /
&gauge id = 'quarter', at = 0.0625, 0, -0.0021, quantity = 'displacement_z', body = 'plate' /
&output history_every = 1e-6 /
"""
LOAD = "&load id = 'tnt', body = 'plate', faces = 'z+', mass = 0.168, at = 0, 0, 0.4 /\n"
AIR = """&air
    box = {low}, 0.1368, {low}, 0.1368, -0.0288, 0.5328, cells = {across}, {across}, {up}
/
&charge id = 'tnt', mass = 0.168, explosive = 'tnt', {start}, at = 0, 0, 0.4 /
"""
AT_ONCE = "eos = 'ideal'"
ALONG_RADIUS = "eos = 'jwl', start = '1d'"
IN_PLANE = "eos = 'jwl', start = '2d'"
# a rigid plate as tiles, and the loads that the air has on them
TILE = """&body
    id = '{name}', box = {x:.6g}, {x1:.6g}, {y:.6g}, {y1:.6g}, -0.0042, 0, spacing = {spacing}e-3
    material = 'cfrp', formulation = 'rigid', fix = 'all'
/
&gauge id = '{name}', body = '{name}', quantity = 'impulse_z' /
"""
WALL_LOAD = "&load body = 'plate', faces = 'z+', patch = '{name}.stl', table = '{name}.csv' /\n"
SIDE = 0.125 / TILES  # [m]
MODELS = {  # start of the charge, symmetry
    "load by Kingery-Bulmash": (None, True),
    "air, burnt at once": (AT_ONCE, True),
    "air, 1-D start": (ALONG_RADIUS, True),
    "air, 2-D start": (IN_PLANE, True),
    "rigid plate in air, its load on the plate": (ALONG_RADIUS, True),
    "air, 1-D start, whole plate": (ALONG_RADIUS, False),
}
ON_WALL = "rigid plate in air, its load on the plate"
RUNS = [  # model, cells of the air [mm], spacing [mm]
    ("load by Kingery-Bulmash", None, 2.1),
    ("load by Kingery-Bulmash", None, 1.4),
    ("air, burnt at once", 7.2, 2.1),
    ("air, burnt at once", 3.6, 1.4),
    ("air, 1-D start", 7.2, 2.1),
    ("air, 1-D start", 3.6, 2.1),
    ("air, 1-D start", 3.6, 1.4),
    (ON_WALL, 7.2, 2.1),
    (ON_WALL, 3.6, 1.4),
    ("air, 2-D start", 7.2, 2.1),
    ("air, 2-D start", 3.6, 1.4),
    ("air, 1-D start, whole plate", 7.2, 2.1),
]


def deck(model: str, cells: float | None, spacing: float) -> str:
    """The deck of a run."""
    start, mirrored = MODELS[model]
    symmetry = ", symmetry = 'x', 'y'" if mirrored else ""
    text = PLATE.format(end=END, symmetry=symmetry, spacing=spacing)
    if start is None:
        return text + LOAD
    across = round(136.8 / cells) * (1 if mirrored else 2)
    low = "0" if mirrored else "-0.1368"
    return text + AIR.format(low=low, across=across, up=round(561.6 / cells), start=start)


def wall_deck(cells: float, spacing: float) -> str:
    """The plate as rigid tiles in air."""
    text = re.sub(r"&body.*?\n/\n|&gauge.*?/\n", "", deck(ON_WALL, cells, spacing), flags=re.S)
    for name, x, y in tiles(SIDE):
        text += TILE.format(name=name, x=x, x1=x + SIDE, y=y, y1=y + SIDE, spacing=spacing)
    return text + "&interaction law = 'none' /\n"


def loaded_deck(number: int, spacing: float) -> str:
    """The plate alone under the mean pressures that the air had on the tiles."""
    text = PLATE.format(end=END, symmetry=", symmetry = 'x', 'y'", spacing=spacing)
    return text + wall_loads(FOLDER, number, SIDE, WALL_LOAD, -1.0)


def run(number: int) -> list[str]:
    """Run one model on one core; a row of the table."""
    model, cells, spacing = RUNS[number]
    seconds = 0.0
    if model == ON_WALL:
        seconds = compute(FOLDER, f"run_{number}_wall", f"{model}.\n{wall_deck(cells, spacing)}")
        text = loaded_deck(number, spacing)
    else:
        text = deck(model, cells, spacing)
    seconds += compute(FOLDER, f"run_{number}", f"{model}.\n{text}")
    history = read(FOLDER / f"run_{number}")
    moved = [-1e3 * float(history[f"{name}:displacement_z"][-1]) for name in ("mid", "quarter")]
    error = sum(abs(a / b - 1) for a, b in zip(moved, REFERENCE, strict=True)) / len(moved)
    numbers = [f"{moved[0]:.3f}", f"{moved[1]:.3f}", f"{error:.4f}", f"{seconds:.1f}"]
    print(model, cells, spacing, *numbers, flush=True)
    return [f"run_{number}", model, "" if cells is None else f"{cells:g}", f"{spacing:g}", *numbers]


def record() -> None:
    """Run all and write the table."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    with ThreadPoolExecutor(2) as pool:
        rows = list(pool.map(run, range(len(RUNS))))
    with TABLE.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerows([KEYS, *rows])


def draw() -> None:
    """Error against seconds of one core, a curve for each model."""
    with TABLE.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    figure, axis = plt.subplots(figsize=(7.5, 4.6), constrained_layout=True)
    for model in MODELS:
        own = [row for row in rows if row["model"] == model]
        seconds, errors = ([float(row[key]) for row in own] for key in ("seconds", "error"))
        axis.loglog(seconds, [100 * e for e in errors], "o-", ms=5, label=model)
        drop = -10 if "2-D" in model else 4  # beside the curve of the 1-D start
        for row, x, y in zip(own, seconds, errors, strict=True):
            axis.annotate(sizes(row), (x, 100 * y), xytext=(5, drop), fontsize=7,
                          textcoords="offset points")  # fmt: skip
    axis.set(xlabel="seconds of one core", ylabel="error of the displacement at 0.3 ms [%]")
    readable(axis.xaxis, axis.yaxis)
    axis.grid(alpha=0.3)
    axis.set_xlim(right=330)
    axis.legend(fontsize=8, loc="center left", bbox_to_anchor=(0.02, 0.72))
    figure.savefig(PICTURE, dpi=110)


if __name__ == "__main__":
    if sys.argv[1:] != ["draw"]:
        record()
    draw()
