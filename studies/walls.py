#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What a wall costs on a coarse grid: errors of staircases and of cut cells against the cells.

usage: walls.py draw | walls.py run CASE SCHEME CELLS ...

draw: docs/figures/walls.png from docs/data/walls.csv, which says where each figure comes from. run:
one of the cases below by a scheme of &coupling, with CELLS per diameter; prints rows of that table.
"""

from __future__ import annotations

import csv
import math
import subprocess
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from post.history import read_history

OUT = Path("out/walls")
TABLE = Path("docs/data/walls.csv")
DIAMETER = 0.02  # [m]
RHO, P = 1.225, 101325.0
C = math.sqrt(1.4 * P / RHO)  # speed of sound [m/s]
SHOCK = "density=3.266667, pressure=455962.5, velocity=425.3672, 0, 0"  # of Mach 2
STREAM = f"density={RHO}, pressure={P}, velocity={3 * C}, 0, 0"  # of Mach 3
HEAVY = 7800 * 1e3  # [kg/m3]: nothing moves it
DECK = """A body of 20 mm that is held in a shock or a stream.

&run t_end = {end}, dimension = {dimension}, symmetry = {planes} /
&air box = {box}, cells = {cells}, bc = {bc}
    reconstruction = 'muscl', flux = 'hllc', integrator = 'ssprk2', ramp_steps = 0 /
&gas id = 'wind', box = -9, {front}, -9, 9, -9, 9, {gas} /
&material id = 'm', model = 'linear_elastic', density = {heavy}
    youngs_modulus = 2e14, poisson_ratio = 0.3 /
&body id = 'ball', shape = 'sphere', centre = 0, 0, 0, radius = {radius}, spacing = {spacing}
    material = 'm', formulation = 'rigid' /
&output history_every = {every}, dump_every = 1 /
&coupling scheme = '{scheme}' /
"""
COLOURS = {"wall_flux": "tab:red", "cut_cells": "tab:blue"}
DECADES = ([0.01, 0.1, 1, 10, 100], ["0.01", "0.1", "1", "10", "100"])  # of the errors [%]
WHAT = "cells per diameter"
# title, what is along x, cases with what to call them (else by their quantities), error shown [%]
PANELS = [
    ("impulse of a Mach 2 shock on a sphere", WHAT, {"shocked sphere": ""}, (0.3, 400)),
    ("the same on a cylinder", WHAT, {"shocked cylinder": ""}, (0.3, 400)),
    (
        "drag at Mach 3",
        WHAT,
        {"drag of a sphere": "sphere", "drag of a cylinder": "cylinder"},
        (0.2, 200),
    ),
    (
        "pressure on an oblique, on a moving wall",
        "cells per length of the wedge, of the tube",
        {"wedge": "shock reflected at 60 degrees", "piston": "slow piston, to a tenth"},
        (0.002, 30),
    ),
    (
        "place of a cylinder lifted by a Mach 3 shock",
        "cells along the channel",
        {"lifted cylinder": ""},
        (0.1, 300),
    ),
]
# dimension; lengths before, behind and beside the middle, in diameters; front of the wind
SHAPES = {
    "shocked cylinder": (2, (1.5, 3.5, 3.0), -0.9),
    "drag of a cylinder": (2, (1.5, 2.0, 2.5), 9.0),
    "drag of a sphere": (3, (1.25, 1.75, 1.5), 9.0),
    "shocked sphere": (3, (3.0, 9.0, 3.9), -1.5),
}


def deck_of(case: str, scheme: str, cells: float) -> tuple[str, float]:
    """The deck, and when the shock meets the body."""
    dimension, sides, front = SHAPES[case]
    h = DIAMETER / cells
    n = [round((sides[0] + sides[1]) * cells)] + [round(sides[2] * cells)] * (dimension - 1)
    low = -sides[0] * DIAMETER
    box = [low, low + n[0] * h] + [x for m in n[1:] for x in (0, m * h)] + [0, 1] * (3 - dimension)
    # the wind begins on a face of the cells
    front = low + round((front * DIAMETER - low) / h) * h
    arrival = max(0.0, (-DIAMETER / 2 - front) / (2 * C))
    shocked = "shocked" in case
    end = arrival + 2.05e-4 if case == "shocked sphere" else arrival + 2.02 * DIAMETER / C
    if not shocked:
        end = 14 * DIAMETER / (3 * C)
    side = "wall" if case == "shocked cylinder" else "outflow"
    bc = ["outflow"] * 2 + ["symmetry", side] * (dimension - 1) + ["outflow"] * 2 * (3 - dimension)
    return DECK.format(
        end=end,
        dimension=dimension,
        planes="'y', 'z'" if dimension == 3 else "'y'",
        box=", ".join(f"{x:.9g}" for x in box),
        cells=", ".join(str(m) for m in (n + [1])[:3]),
        bc=", ".join(f"'{x}'" for x in bc),
        front=f"{front:.9g}" if shocked else 9,
        gas=SHOCK if shocked else STREAM,
        heavy=HEAVY,
        radius=DIAMETER / 2,
        spacing=min(h / 2, DIAMETER / 10),
        every=end / 500,
        scheme=scheme,
    ), arrival


def measure(case: str, scheme: str, cells: float) -> list[tuple[str, float]]:
    """Run a case: its quantities and what they are."""
    OUT.mkdir(parents=True, exist_ok=True)
    name = f"{case.replace(' ', '_')}_{scheme}_{cells:g}"
    text, arrival = deck_of(case, scheme, cells)
    (OUT / f"{name}.nml").write_text(text, encoding="utf-8")
    with (OUT / f"{name}.log").open("w", encoding="utf-8") as log:
        subprocess.run(
            ["bin/brisance", "run", OUT / f"{name}.nml", "--out", OUT / name, "--replace"],
            check=True,
            stdout=log,
            stderr=log,
        )
    table = read_history(OUT / name / "bodies.csv")
    # of the whole body, of which planes leave a half or a quarter
    push = 2 ** (SHAPES[case][0] - 1) * table["ball:mass"] * table["ball:velocity_x"]
    time = table.time - arrival
    if case == "shocked sphere":
        area = math.pi / 4 * DIAMETER**2
        return [
            (f"impulse at {t} us [Pa s]", float(np.interp(1e-6 * t, time, push)) / area)
            for t in (50, 100, 200)
        ]
    if case == "shocked cylinder":
        unit = DIAMETER / C
        return [
            (f"impulse at {t:g} D/c0", float(np.interp(t * unit, time, push)) * C / P / DIAMETER**2)
            for t in (0.5, 1, 2)
        ]
    late = int(np.searchsorted(time, 0.7 * time[-1]))
    force = (push[-1] - push[late]) / (time[-1] - time[late])
    area = DIAMETER if SHAPES[case][0] == 2 else math.pi / 4 * DIAMETER**2
    return [("drag coefficient", force / (0.5 * RHO * (3 * C) ** 2 * area))]


def run(case: str, scheme: str, *cells: str) -> None:
    """Print the rows of a case."""
    for n in cells:
        for quantity, value in measure(case, scheme, float(n)):
            print(f"{case},{quantity},{n},{scheme},{value:.5g},", flush=True)


def lines_of(rows: list[dict[str, str]], case: str) -> dict[tuple[str, str], tuple[list, list]]:
    """Cells and errors in % of a case, by quantity and scheme."""
    lines: dict[tuple[str, str], tuple[list, list]] = {}
    for row in rows:
        if row["case"] != case:
            continue
        value, reference = float(row["value"]), float(row["reference"])
        if abs(value - reference) > 0:  # else it is the reference
            x, y = lines.setdefault((row["quantity"], row["scheme"]), ([], []))
            x.append(float(row["cells"]))
            y.append(100 * abs(value / reference - 1))
    return lines


def panel(ax: plt.Axes, rows: list[dict[str, str]], cases: dict[str, str], along: str) -> None:
    """Errors of some cases against the cells: a mark for each quantity."""
    marks = iter("os^Dv")
    ticks: set[float] = set()
    for case, label in cases.items():
        used: dict[str, str] = {}
        for (quantity, scheme), (x, y) in lines_of(rows, case).items():
            mark = used.setdefault(quantity, used.get(quantity) or next(marks))
            ticks |= set(x)
            name = label or quantity.split(" [")[0]
            line = "--" if scheme == "wall_flux" else "-"
            ax.loglog(x, y, marker=mark, color=COLOURS[scheme], linestyle=line)
            if scheme == "cut_cells":
                name = label or quantity.split(" [")[0]
                ax.plot([], [], mark, color="0.4", label=name)
    ax.set_xticks(sorted(ticks), [f"{t:g}" for t in sorted(ticks)])
    ax.minorticks_off()
    ax.set_xlabel(along)
    ax.grid(visible=True, alpha=0.3)


def bars(ax: plt.Axes, rows: list[dict[str, str]]) -> None:
    """Sideways force of plates by their angles."""
    plates = [row for row in rows if row["case"] == "inclined plate"]
    angles = sorted({int(row["cells"]) for row in plates})
    for row in plates:
        x = angles.index(int(row["cells"])) + (-0.2 if row["scheme"] == "wall_flux" else 0.2)
        share = round(100 * float(row["value"]), 1) + 0.0
        ax.bar(x, share, 0.36, color=COLOURS[row["scheme"]])
        ax.text(x, max(0, share) + 0.15, f"{share:.1f}", ha="center", fontsize=8)
    ax.axhline(0, color="black", lw=0.8)
    ax.set_xticks(range(len(angles)), [str(x) for x in angles])
    ax.set(xlabel="angle of the plate [degrees]", ylabel="sideways over normal impulse [%]")
    ax.set_title("inclined plate under a Mach 2 shock", fontsize=11)


def draw() -> None:
    """All cases: dashed red the staircase, blue the cut cells, dotted a slope of first order."""
    with TABLE.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    fig, axes = plt.subplots(2, 3, figsize=(13, 8), constrained_layout=True)
    for ax, (title, along, cases, limits) in zip(axes.flat, PANELS, strict=False):
        panel(ax, rows, cases, along)
        low, high = ax.get_xlim()
        x = np.array([low, high])
        ax.plot(x, limits[1] * 0.6 * low / x, color="black", lw=0.8, ls=":")
        ax.set_xlim(low, high)
        ax.set_yticks(*DECADES)
        ax.set_ylim(*limits)
        ax.set_title(title, fontsize=11)
        ax.legend(frameon=False, fontsize=8, loc="lower left")
    bars(axes[1, 2], rows)
    for ax in axes[:, 0]:
        ax.set_ylabel("error [%]")
    keys = [
        plt.Line2D([], [], color=COLOURS["wall_flux"], ls="--", label="staircase"),
        plt.Line2D([], [], color=COLOURS["cut_cells"], label="cut cells"),
        plt.Line2D([], [], color="black", lw=0.8, ls=":", label="first order"),
    ]
    fig.legend(handles=keys, loc="outside upper center", ncols=3, frameon=False)
    fig.savefig("docs/figures/walls.png", dpi=110)
    plt.close(fig)


if __name__ == "__main__":
    if sys.argv[1:] == ["draw"]:
        draw()
    elif sys.argv[1:2] == ["run"] and len(sys.argv) > 4:
        run(*sys.argv[2:])
    else:
        sys.exit(__doc__)
