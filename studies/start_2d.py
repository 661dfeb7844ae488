#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A cylinder of TNT before a slab, by every way to start it: run, record, draw.

usage: start_2d.py [name of a run ...]   (all)

The charge of the slabs of Chen et al. (0.2 kg, as long as wide, 0.4 m before a plate) and a held
slab of half the width, a quarter of the scene; beside it the plane of the axis alone, over a floor
in the place of the slab. Rows of docs/data/start_2d.csv of other runs stay; `draw` needs all.
"""

from __future__ import annotations

import csv
import resource
import subprocess
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from post.blast import measure_pulse
from post.history import read_history

TABLE = Path("docs/data/start_2d.csv")
PICTURE = Path("docs/figures/start_2d.png")
FOLDER = Path("out/start_2d")
KEYS = ("run", "cells_mm", "arrival", "peak", "impulse", "peak_edge", "impulse_edge", "seconds")
CYLINDER = "shape = 'cylinder', aspect = 1"
SPHERE = "shape = 'sphere'"
AT_ONCE = "eos = 'ideal'"
ALONG_RADIUS = "eos = 'jwl', start = '1d'"
IN_PLANE = "eos = 'jwl', start = '2d'"
RUNS = {  # shape, start, cells of the air [mm]; of the plane: cells to its edge
    "3d_6": (CYLINDER, AT_ONCE, 6),
    "1d_12": (SPHERE, ALONG_RADIUS, 12),
    "2d_12": (CYLINDER, IN_PLANE, 12),
    "2d_6": (CYLINDER, IN_PLANE, 6),
    "alone_160": (CYLINDER, None, 160),
    "alone_320": (CYLINDER, None, 320),
}
LABELS = {
    "3d_6": "burnt at once in space, 6 mm",
    "1d_12": "sphere along its radius, 12 mm",
    "2d_12": "in the plane, then 12 mm",
    "2d_6": "in the plane, then 6 mm",
    "alone_320": "in the plane alone, floor",
}
HEAD = """&run title = 'Cylinder before a slab', t_end = 4e-4, symmetry = 'x', 'y' /
&air box = 0, 0.3, 0, 0.3, -0.912, 0.096, cells = {across}, {across}, {up} /
&material id = 'slab', preset = 'cfrp_woven' /
&body id = 'slab', shape = 'box', box = -0.25, 0.25, -0.25, 0.25, 0, 0.044, spacing = {spacing},
      material = 'slab', fix = 'all' /
&charge id = 'tnt', mass = 0.2, {shape}, {start}, at = 0, 0, -0.4 /
"""
PLANE = """&run title = 'Cylinder over a floor', t_end = 4e-4 /
&air geometry = 'axial', floor = 0 /
&charge id = 'tnt', mass = 0.2, {shape}, eos = 'jwl', plane_cells = {cells}, at = 0, 0, 0.4 /
"""
GAUGES = """&gauge id = 'A', at = 0, 0, {z}, quantity = 'overpressure' /
&gauge id = 'edge', at = 0.2, 0, {z}, quantity = 'overpressure' /
&output history_every = 1e-6 /
"""


def deck(name: str) -> str:
    """The deck of a run."""
    shape, start, cells = RUNS[name]
    if start is None:
        return PLANE.format(shape=shape, cells=cells) + GAUGES.format(z=0.003)
    across = 300 // cells
    spacing = {6: 5.5e-3, 12: 1e-2}[cells]
    text = HEAD.format(across=across, up=1008 // cells, spacing=spacing, shape=shape, start=start)
    return text + GAUGES.format(z=-0.003)


def run(name: str) -> dict[str, str]:
    """Run one deck on one core; a row of the table."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    path = FOLDER / f"{name}.nml"
    path.write_text("A cylinder before a slab.\n" + deck(name))
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    command = ["bin/brisance", "run", path, "--backend", "cpu", "--out", FOLDER / name, "--replace"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    history = read_history(FOLDER / name / "gauges.csv")
    row = [name, f"{RUNS[name][2]}" if RUNS[name][1] else ""]
    for gauge in ("A", "edge"):
        pulse = measure_pulse(
            history.time, history[f"{gauge}:overpressure"], ambient=0.0, threshold=1e5
        )
        row += [f"{pulse.arrival:.4e}"] if gauge == "A" else []
        row += [f"{pulse.peak:.4e}", f"{pulse.impulse:.4e}"]
    return dict(zip(KEYS, [*row, f"{seconds:.1f}"], strict=True))


def record(rows: list[dict[str, str]]) -> None:
    """Put rows into the table, in the place of old ones."""
    table = {}
    if TABLE.exists():
        with TABLE.open() as file:
            table = {row["run"]: row for row in csv.DictReader(file)}
    table.update({row["run"]: row for row in rows})
    with TABLE.open("w", newline="") as file:
        writer = csv.DictWriter(file, KEYS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(table[name] for name in RUNS if name in table)


def draw() -> None:
    """Overpressure and impulse before the middle of the slab."""
    fig, axes = plt.subplots(1, 2, figsize=(10, 4), constrained_layout=True)
    for name, label in LABELS.items():
        if not (FOLDER / name / "gauges.csv").exists():
            continue
        history = read_history(FOLDER / name / "gauges.csv")
        time, pressure = 1e3 * history.time, history["A:overpressure"]
        steps = (time[1:] - time[:-1]) * (pressure[1:] + pressure[:-1]) / 2e3
        axes[0].semilogy(time, pressure.clip(1e4) / 1e6, label=label)
        axes[1].plot(time[1:], steps.cumsum(), label=label)
    axes[0].set(ylabel="overpressure [MPa]", xlabel="time [ms]", xlim=(0.08, 0.4), ylim=(0.1, 100))
    axes[1].set(ylabel="impulse [Pa s]", xlabel="time [ms]", xlim=(0.08, 0.4))
    axes[0].axvline(0.110, color="black", lw=0.8, ls=":")
    axes[0].text(0.111, 0.13, "paper", fontsize=8)
    axes[0].legend(fontsize=8)
    fig.savefig(PICTURE, dpi=110)


if __name__ == "__main__":
    for wanted in sys.argv[1:] or RUNS:
        record([run(wanted)])
    draw()
