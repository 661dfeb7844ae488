#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Error against seconds for slab 2 of the paper, by how much is modelled.

usage: slab_models.py [draw]

0.2 kg of TNT 0.4 m below a slab of concrete on CFRP (inputs/paper/slab_2.nml), coarse quarters of
it: a load by Kingery-Bulmash without air, the load that air has on a rigid slab, air with a sphere
that is started along its radius, and with the cylinder of the paper, started in the plane of its
axis. Each run has one core, one runs at a time. Errors are those of the CFRP in the middle at 1.2
ms and of the impulse, against the scene of that charge at the resolution of the paper (REFERENCE).
Records docs/data/slab_models.csv and draws docs/figures/slab_models.png; `draw` only draws.
"""

from __future__ import annotations

import csv
import re
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter
from plate_models import compute, load_table, square

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from post.history import History, read_history

TABLE = Path("docs/data/slab_models.csv")
PICTURE = Path("docs/figures/slab_models.png")
FOLDER = Path("out/slab_models")
DECK = Path("inputs/paper/slab_2.nml")
KEYS = ("run", "model", "cells_mm", "spacing_mm", "early_mm", "late_mm", "impulse_Ns", "error",
        "impulse_error", "seconds")  # fmt: skip
# CFRP in the middle at 1.2 ms [mm], largest impulse [N s]; quarters, 2 mm, cells of 4 mm, H200,
# docs/paper_questions.md
REFERENCE = {"sphere": (3.98, 237.0), "cylinder": (6.14, 228.0)}
EARLY = 3e-4  # [s]
MODELS = {  # the charge, and what it is started with
    "load by Kingery-Bulmash": ("sphere", None),
    "rigid slab in air, its load on the slab": ("sphere", "1d"),
    "air, sphere, 1-D start": ("sphere", "1d"),
    "air, cylinder, 2-D start": ("cylinder", "2d"),
}
ON_WALL = "rigid slab in air, its load on the slab"
RUNS = [  # model, cells of the air [mm], spacing [mm]
    ("air, sphere, 1-D start", 12, 6),
    ("load by Kingery-Bulmash", None, 6),
    ("air, cylinder, 2-D start", 12, 6),
    (ON_WALL, 12, 6),
    ("air, cylinder, 2-D start", 10, 5),
    ("air, sphere, 1-D start", 10, 5),
    ("load by Kingery-Bulmash", None, 5),
]
HEIGHT = {12: (-0.624, 0.096), 10: (-0.62, 0.1)}  # of the box of air [m], by its cells
TILES = 5  # across the quarter
SIDE = 0.5 / TILES  # [m]
LOAD = "&load body = 'cfrp', faces = 'z-', mass = 0.2, at = 0, 0, -0.4 /\n"
WALL_LOAD = "&load body = 'cfrp', faces = 'z-', patch = '{name}.stl', table = '{name}.csv' /\n"
GAUGES = "".join(f"&gauge id = '{b}', body = '{b}', quantity = 'impulse_z' /\n"
                 for b in ("cfrp", "concrete"))  # fmt: skip
TILE = """&body
    id = '{name}', box = {x:.6g}, {x1:.6g}, {y:.6g}, {y1:.6g}, 0, 0.044, spacing = {spacing}e-3
    material = 'concrete', formulation = 'rigid', fix = 'all'
/
&gauge id = '{name}', body = '{name}', quantity = 'impulse_z' /
"""


def without(text: str, *groups: str) -> str:
    """A deck without some kinds of groups."""
    return re.sub(rf"^&(?:{'|'.join(groups)})\b.*?/[ ]*$", "", text, flags=re.S | re.M)


def deck(model: str, cells: int | None, spacing: int) -> str:
    """The deck of a run: a quarter of the slab."""
    text = DECK.read_text(encoding="utf-8")
    text = text.replace("t_end = 1.2e-3", "t_end = 1.2e-3, symmetry = 'x', 'y'")
    text = re.sub(
        r"spacing = 2e-3, (material = '(cfrp|concrete)')", rf"spacing = {spacing}e-3, \1", text
    )
    text = text.replace("spacing = 2e-3", "spacing = 6e-3")  # of the bars
    text = re.sub(r"&output .*?/", "&output history_every = 1e-6 /", text) + GAUGES
    if cells is None:
        return re.sub(r"&gauge id = '(A|edge|free)'.*?/", "", without(text, "air", "charge"))
    low, high = HEIGHT[cells]
    counts = (round(600 / cells), round(600 / cells), round(1e3 * (high - low) / cells))
    text = re.sub(r"&air\n.*?\n/", f"&air box = 0, 0.6, 0, 0.6, {low}, {high}, "
                  f"cells = {counts[0]}, {counts[1]}, {counts[2]} /", text, flags=re.S)  # fmt: skip
    shape, start = MODELS[model]
    return text.replace("shape = 'cylinder', axis", f"eos = 'jwl', start = '{start}', "
                        f"shape = '{shape}', axis")  # fmt: skip


def tiles() -> list[tuple[str, float, float]]:
    """Name and low corner of each tile of the quarter."""
    return [(f"tile_{i}_{j}", i * SIDE, j * SIDE) for i in range(TILES) for j in range(TILES)]


def wall_deck(cells: int, spacing: int) -> str:
    """The slab as rigid tiles in air."""
    text = without(deck(ON_WALL, cells, spacing), "body", "gauge", "interaction")
    for name, x, y in tiles():
        text += TILE.format(name=name, x=x, x1=x + SIDE, y=y, y1=y + SIDE, spacing=spacing)
    return text + "&interaction law = 'none' /\n"


def loaded_deck(number: int, spacing: int) -> str:
    """The slab alone under the mean pressures that the air had on the tiles."""
    history = read_history(FOLDER / f"run_{number}_wall" / "gauges.csv")
    text = deck(ON_WALL, None, spacing)
    for tile, x, y in tiles():
        name = f"run_{number}_{tile}"
        pressed = [float(value) / SIDE**2 for value in history[f"{tile}:impulse_z"]]
        (FOLDER / f"{name}.csv").write_text(load_table(history, pressed), encoding="utf-8")
        (FOLDER / f"{name}.stl").write_text(square(x, y, SIDE), encoding="utf-8")
        text += WALL_LOAD.format(name=name)
    return text


def at(history: History, name: str, when: float) -> float:
    """What a gauge has first at a time or after it."""
    return next(float(value) for time, value in zip(history["time"], history[name], strict=True)
                if float(time) >= when * (1 - 1e-9))  # fmt: skip


def run(number: int) -> list[str]:
    """Run one model on one core; a row of the table."""
    model, cells, spacing = RUNS[number]
    seconds = 0.0
    if model == ON_WALL:
        seconds = compute(FOLDER, f"run_{number}_wall", f"{model}.\n{wall_deck(cells, spacing)}")
        text = loaded_deck(number, spacing)
    else:
        text = deck(model, cells, spacing)
        if cells is None:
            text += LOAD
    seconds += compute(FOLDER, f"run_{number}", text)
    history = read_history(FOLDER / f"run_{number}" / "gauges.csv")
    moved = [1e3 * at(history, "mid_cfrp:displacement_z", when) for when in (EARLY, 1.2e-3)]
    pushes = (history[f"{body}:impulse_z"] for body in ("cfrp", "concrete"))
    impulse = 4 * max(float(a) + float(b) for a, b in zip(*pushes, strict=True))
    late, given = REFERENCE[MODELS[model][0]]
    numbers = [f"{moved[0]:.3f}", f"{moved[1]:.3f}", f"{impulse:.1f}",
               f"{abs(moved[1] / late - 1):.4f}", f"{abs(impulse / given - 1):.4f}",
               f"{seconds:.1f}"]  # fmt: skip
    print(model, cells, spacing, *numbers, flush=True)
    return [f"run_{number}", model, "" if cells is None else f"{cells:g}", f"{spacing:g}", *numbers]


def record() -> None:
    """Run all, write the table after each."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    rows = [list(KEYS)]
    for number in range(len(RUNS)):
        rows.append(run(number))
        with TABLE.open("w", newline="", encoding="utf-8") as file:
            csv.writer(file, lineterminator="\n").writerows(rows)


def draw() -> None:
    """Error of displacement and of impulse against seconds of one core, a colour for each model."""
    with TABLE.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    figure, axes = plt.subplots(1, 2, figsize=(9.5, 4.2), constrained_layout=True, sharex=True)
    for model in MODELS:
        own = [row for row in rows if row["model"] == model]
        if not own:
            continue
        seconds = [float(row["seconds"]) for row in own]
        for axis, key in zip(axes, ("error", "impulse_error"), strict=True):
            errors = [100 * float(row[key]) for row in own]
            axis.semilogy(seconds, errors, "o-", ms=5, label=model)
            for row, x, y in zip(own, seconds, errors, strict=True):
                sizes = [row["cells_mm"]] if row["cells_mm"] else []
                axis.annotate(" / ".join([*sizes, row["spacing_mm"]]), (x, y), xytext=(5, 4),
                              fontsize=7, textcoords="offset points")  # fmt: skip
    axes[0].set(ylabel="error of the CFRP's displacement at 1.2 ms [%]")
    axes[1].set(ylabel="error of the impulse on the slab [%]")
    for axis in axes:
        axis.set(
            xlabel="seconds of one core",
            xlim=(0, 1.25 * max(float(row["seconds"]) for row in rows)),
        )
        axis.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
        axis.yaxis.set_minor_formatter(NullFormatter())
        axis.grid(alpha=0.3, which="both")
    axes[0].legend(fontsize=8, loc="center left")
    figure.savefig(PICTURE, dpi=110)


if __name__ == "__main__":
    if sys.argv[1:] != ["draw"]:
        record()
    draw()
