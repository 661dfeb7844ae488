#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Error against seconds for slab 2 of the paper, by how much is modelled.

usage: slab_models.py run [--brisance FILE] [--backend gpu|cpu] [--out FOLDER] [--seconds S]
       slab_models.py record [--out FOLDER]: docs/data/slab_models.csv from what was run
       slab_models.py draw: docs/figures/slab_models.png

0.2 kg of TNT 0.4 m below a slab of concrete on CFRP (inputs/paper/slab_2.nml): a load by
Kingery-Bulmash without air, the load that air has on a rigid slab, air with a sphere that is
started along its radius, and with the cylinder of the paper, started in the plane of its axis; a
quarter or the whole. One run after the other, the most telling first; one that has ended is not
made again, so a stopped study goes on. Without anything beside them, on one card, the seconds are
those of the command from start to end, on a CPU those of one core. Errors are those of the CFRP in
the middle at 1.2 ms and of the impulse, against the finest quarter with the same charge.
"""

from __future__ import annotations

import argparse
import csv
import re
import subprocess
import time
from pathlib import Path

from model_charts import TILES, Engine, compute, read, readable, sizes, tiles, wall_loads

HOME = Path(__file__).resolve().parent.parent
TABLE = HOME / "docs/data/slab_models.csv"
PICTURE = HOME / "docs/figures/slab_models.png"
DECK = HOME / "inputs/paper/slab_2.nml"
KEYS = ("run", "model", "cells_mm", "spacing_mm", "early_mm", "late_mm", "impulse_Ns", "error",
        "impulse_error", "seconds")  # fmt: skip
EARLY, LATE = 3e-4, 1.2e-3  # [s]
BY_CURVES = "load by Kingery-Bulmash"
ON_WALL = "rigid slab in air, its load on the slab"
SPHERE, CYLINDER = "air, sphere, 1-D start", "air, cylinder, 2-D start"
WHOLE = "air, sphere, 1-D start, the whole slab"
MODELS = {  # the charge, and what it is started with
    BY_CURVES: ("sphere", None),
    ON_WALL: ("sphere", "1d"),
    SPHERE: ("sphere", "1d"),
    WHOLE: ("sphere", "1d"),
    CYLINDER: ("cylinder", "2d"),
}
LAYERS = {  # size [mm]: layers of the CFRP (6 mm) and of the concrete (38 mm), particles in a bar
    6: (1, 7, 2),
    4: (2, 9, 2),
    3: (2, 12, 2),
    2: (3, 19, 3),
}
MATERIALS = ("cfrp", "concrete", "steel")
RUNS = [  # model, cells of the air [mm], size of the particles [mm]
    (SPHERE, 12, 6),
    (BY_CURVES, None, 6),
    (CYLINDER, 12, 6),
    (ON_WALL, 12, 6),
    (SPHERE, 6, 3),
    (BY_CURVES, None, 3),
    (CYLINDER, 6, 3),
    (SPHERE, 8, 4),
    (CYLINDER, 8, 4),
    (BY_CURVES, None, 4),
    (WHOLE, 12, 6),
    (SPHERE, 6, 6),
    (SPHERE, 12, 3),
    (SPHERE, 4, 2),
    (CYLINDER, 4, 3),
    (SPHERE, 4, 3),
    (ON_WALL, 6, 3),
    (CYLINDER, 12, 3),
    (WHOLE, 8, 4),
    (CYLINDER, 4, 2),
    (BY_CURVES, None, 2),
]
BOX, LOW, HIGH = 0.6, -0.624, 0.096  # of the air [m]: whole cells of every size, z = 0 on a face
SIDE = 0.5 / TILES  # [m]
TILE_SPACING = {12: 5e-3, 8: 4e-3, 6: 4e-3}  # of the rigid slab, by the cells
LOAD = "&load body = 'cfrp', faces = 'z-', mass = 0.2, at = 0, 0, -0.4 /\n"
WALL_LOAD = "&load body = 'cfrp', faces = 'z-', patch = '{name}.stl', table = '{name}.csv' /\n"
GAUGES = "".join(f"&gauge id = '{b}', body = '{b}', quantity = 'impulse_z' /\n"
                 for b in ("cfrp", "concrete"))  # fmt: skip
TILE = """&body
    id = '{name}', box = {x:.6g}, {x1:.6g}, {y:.6g}, {y1:.6g}, 0, 0.044, spacing = {spacing}
    material = 'concrete', formulation = 'rigid', fix = 'all'
/
&gauge id = '{name}', body = '{name}', quantity = 'impulse_z' /
"""


def without(text: str, *groups: str) -> str:
    """A deck without some kinds of groups."""
    return re.sub(rf"^&(?:{'|'.join(groups)})\b.*?/[ ]*$", "", text, flags=re.S | re.M)


def deck(model: str, cells: int | None, size: int) -> str:
    """The deck of a run."""
    text = DECK.read_text(encoding="utf-8")
    whole = model == WHOLE
    text = text.replace("t_end = 1.2e-3", f"t_end = {LATE}" + ("" if whole else
                        ", symmetry = 'x', 'y'"))  # fmt: skip
    for layers, height, material in zip(LAYERS[size], (6, 38, 6), MATERIALS, strict=True):
        text, found = re.subn(rf"spacing = 2e-3,(.* material = '{material}')",
                              rf"spacing = {1e-3 * height / layers:.10g},\1", text)  # fmt: skip
        if not found:
            raise ValueError(f"{DECK}: no body of '{material}' with spacing = 2e-3")
    text = re.sub(r"&output .*?/", "&output history_every = 1e-6 /", text) + GAUGES
    if cells is None:
        return re.sub(r"&gauge id = '(A|edge|free)'.*?/", "", without(text, "air", "charge"))
    across, up = round(1e3 * BOX / cells), round(1e3 * (HIGH - LOW) / cells)
    low, across = (-BOX, 2 * across) if whole else (0, across)
    text = re.sub(r"&air\n.*?\n/", f"&air box = {low}, {BOX}, {low}, {BOX}, {LOW}, {HIGH}, "
                  f"cells = {across}, {across}, {up} /", text, flags=re.S)  # fmt: skip
    shape, start = MODELS[model]
    return text.replace("shape = 'cylinder', axis", f"eos = 'jwl', start = '{start}', "
                        f"shape = '{shape}', axis")  # fmt: skip


def wall_deck(cells: int, size: int) -> str:
    """The slab as rigid tiles in air."""
    text = without(deck(ON_WALL, cells, size), "body", "gauge", "interaction")
    for name, x, y in tiles(SIDE):
        text += TILE.format(name=name, x=x, x1=x + SIDE, y=y, y1=y + SIDE,
                            spacing=TILE_SPACING[cells])  # fmt: skip
    return text + "&interaction law = 'none' /\n"


def run(number: int, chosen: argparse.Namespace, left: float | None) -> float:
    """Run one model; its seconds."""
    model, cells, size = RUNS[number]
    name, engine = f"run_{number}", Engine(chosen.brisance, chosen.backend, left)
    seconds = 0.0
    if model == ON_WALL:
        wall = f"{model}.\n{wall_deck(cells, size)}"
        seconds = compute(chosen.out, f"{name}_wall", wall, engine)
        text = deck(model, None, size) + wall_loads(chosen.out, number, SIDE, WALL_LOAD, 1.0)
    else:
        text = deck(model, cells, size) + (LOAD if model == BY_CURVES else "")
    return seconds + compute(chosen.out, name, text, engine)


def ended(folder: Path) -> dict[int, float]:
    """Seconds of the runs that a folder has, by their number."""
    path = folder / "seconds.csv"
    if not path.is_file():
        return {}
    rows = csv.reader(path.read_text(encoding="utf-8").splitlines())
    return {int(row[0]): float(row[1]) for row in rows}


def make(chosen: argparse.Namespace) -> None:
    """Make the runs that a folder lacks, until the time is over."""
    chosen.out.mkdir(parents=True, exist_ok=True)
    start = time.monotonic()
    for number in range(len(RUNS)):
        if number in ended(chosen.out):
            continue
        left = chosen.seconds - (time.monotonic() - start) if chosen.seconds else None
        if left is not None and left < 5:
            break
        try:
            seconds = run(number, chosen, left)
        except (subprocess.SubprocessError, OSError, KeyError) as error:
            print(number, *RUNS[number], "has failed:", error, flush=True)
            continue
        with (chosen.out / "seconds.csv").open("a", encoding="utf-8") as file:
            file.write(f"{number},{seconds:.2f}\n")
        print(number, *RUNS[number], f"{seconds:.1f} s", flush=True)


def at(folder: Path, name: str, when: float) -> float:
    """What a gauge has first at a time or after it."""
    history = read(folder)
    return next(float(value) for t, value in zip(history["time"], history[name], strict=True)
                if float(t) >= when * (1 - 1e-9))  # fmt: skip


def measured(number: int, out: Path) -> tuple[float, float, float]:
    """CFRP in the middle, early and late [mm], and the largest impulse on the whole slab [N s]."""
    folder = out / f"run_{number}"
    history = read(folder)
    pushes = (history[f"{body}:impulse_z"] for body in ("cfrp", "concrete"))
    parts = 1 if RUNS[number][0] == WHOLE else 4
    impulse = parts * max(float(a) + float(b) for a, b in zip(*pushes, strict=True))
    early, late = (1e3 * at(folder, "mid_cfrp:displacement_z", when) for when in (EARLY, LATE))
    return early, late, impulse


def finest(charge: str, done: dict[int, float]) -> int:
    """The run that the others with its charge are measured against."""
    model = SPHERE if charge == "sphere" else CYLINDER
    own = [k for k in done if RUNS[k][0] == model]
    return min(own, key=lambda k: (RUNS[k][2], RUNS[k][1]))


def record(chosen: argparse.Namespace) -> None:
    """Write the table, in the order of models and from coarse to fine."""
    done = ended(chosen.out)
    found = {k: measured(k, chosen.out) for k in done}
    models = list(MODELS)
    order = sorted(done, key=lambda k: (models.index(RUNS[k][0]), -RUNS[k][2], -(RUNS[k][1] or 0)))
    rows = [KEYS]
    for k in order:
        model, cells, size = RUNS[k]
        _, late, push = found[finest(MODELS[model][0], done)]
        early, own, impulse = found[k]
        rows.append((f"run_{k}", model, cells or "", size, f"{early:.3f}", f"{own:.3f}",
                     f"{impulse:.1f}", f"{abs(own / late - 1):.4f}",
                     f"{abs(impulse / push - 1):.4f}", f"{done[k]:.1f}"))  # fmt: skip
        print(*rows[-1])
    with TABLE.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows(rows)


def draw() -> None:
    """Error of displacement and of impulse against seconds, a colour for each model."""
    import matplotlib  # noqa: PLC0415 (runs are made where it may be missing)

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt  # noqa: PLC0415

    with TABLE.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    figure, axes = plt.subplots(1, 2, figsize=(11, 4.8), constrained_layout=True, sharex=True)
    for number, model in enumerate(MODELS):
        for axis, key in zip(axes, ("error", "impulse_error"), strict=True):
            own = [row for row in rows if row["model"] == model and float(row[key]) > 0]
            if not own:
                continue
            points = [(float(row["seconds"]), 100 * float(row[key])) for row in own]
            alike = [point for row, point in zip(own, points, strict=True)
                     if row["cells_mm"] in ("", str(2 * int(row["spacing_mm"])))]  # fmt: skip
            axis.loglog(*zip(*points, strict=True), "o", color=f"C{number}", ms=5)
            axis.loglog(*zip(*alike, strict=True), "o-", color=f"C{number}", ms=5, label=model)
            drop = -10 if model == ON_WALL else 4
            for row, point in zip(own, points, strict=True):
                axis.annotate(sizes(row), point, xytext=(5, drop), fontsize=7,
                              textcoords="offset points")  # fmt: skip
    axes[0].set(ylabel="error of the CFRP's displacement at 1.2 ms [%]")
    axes[1].set(ylabel="error of the impulse on the slab [%]")
    for axis in axes:
        axis.set(xlabel="seconds of one GPU")
        readable(axis.xaxis, axis.yaxis)
        axis.set_xlim(right=1.3 * max(float(r["seconds"]) for r in rows if float(r["error"]) > 0))
        axis.grid(alpha=0.3, which="both")
    axes[0].legend(fontsize=8)
    figure.savefig(PICTURE, dpi=110)


def main() -> None:
    parser = argparse.ArgumentParser(description="Error against seconds of slab 2 of the paper.")
    parser.add_argument("what", choices=("run", "record", "draw"))
    parser.add_argument("--brisance", default=str(HOME / "bin" / "brisance"))
    parser.add_argument("--backend", choices=("gpu", "cpu"), default="gpu")
    parser.add_argument("--out", type=Path, default=HOME / "out" / "slab_models")
    parser.add_argument("--seconds", type=float, help="begin nothing after so many, stop what runs")
    chosen = parser.parse_args()
    if chosen.what == "run":
        make(chosen)
    elif chosen.what == "record":
        record(chosen)
    else:
        draw()


if __name__ == "__main__":
    main()
