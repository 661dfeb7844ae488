#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Normal reflection of TNT blasts from a rigid floor against Kingery-Bulmash: run, record, draw.

usage: validate_reflection.py [--backend gpu] [cells per standoff distance ...]   (40)
       validate_reflection.py --record Z cells gauges.csv   (a run made elsewhere)

Rows of docs/data/reflected_blast.csv with other numbers of cells stay. Ends with an error where a
ratio leaves its band.
"""

from __future__ import annotations

import csv
import subprocess
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from post.blast import free_air, measure_pulse
from post.history import read_history

END = {0.725: 1.0e-3, 1.0: 1.6e-3, 2.0: 4.5e-3}  # of the run, by scaled distance [s]
TABLE = Path("docs/data/reflected_blast.csv")
FREE = Path("docs/data/free_air_blast.csv")
KEYS = ("Z", "cells", "peak", "arrival", "impulse")
BANDS = {  # ratios to Kingery-Bulmash by cells: lowest peak, lowest and highest impulse
    40: (0.57, 0.85, 1.15),
    80: (0.68, 0.85, 1.15),
    160: (0.74, 0.85, 1.15),
}
DECK = """1 kg of TNT {z} m above a rigid floor, a quarter of the scene.
&run title = 'Normal reflection', t_end = {end} /
&air box = 0, {side}, 0, {side}, 0, {height}, cells = {across}, {across}, {up},
     bc = 'symmetry', 'outflow', 'symmetry', 'outflow', 'wall', 'outflow' /
&charge id = 'tnt', mass = 1, eos = 'jwl', start = '1d', at = 0, 0, {z} /
&gauge id = 'floor', at = 0, 0, 0, quantity = 'overpressure' /
&output history_every = 0 /
"""


def run(z: float, cells: int, backend: list[str]) -> Path:
    """Run one deck; its histories."""
    folder = Path("out/validate")
    folder.mkdir(parents=True, exist_ok=True)
    deck = folder / f"floor_{z:g}_{cells}.nml"
    across, up = round(1.1 * cells), round(2.1 * cells)
    text = DECK.format(z=z, end=END[z], side=1.1 * z, height=2.1 * z, across=across, up=up)
    deck.write_text(text)
    out = folder / deck.stem
    command = ["bin/brisance", "run", deck, "--out", out, "--replace", *backend]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return out / "gauges.csv"


def measured(z: float, cells: int, histories: Path) -> dict[str, float]:
    """What the gauge on the floor has seen."""
    history = read_history(histories)
    pulse = measure_pulse(history.time, history["floor:overpressure"], ambient=0.0, threshold=1e3)
    impulse = pulse.impulse if pulse.complete else np.nan
    return dict(zip(KEYS, (z, cells, pulse.peak, pulse.arrival, impulse), strict=True))


def record(rows: list[dict[str, float]]) -> list[dict[str, float]]:
    """Put rows into the table, in the place of old ones."""
    table = {}
    if TABLE.exists():
        with TABLE.open() as file:
            for row in csv.DictReader(file):
                numbers = {key: float(row[key]) for key in KEYS}
                table[numbers["Z"], numbers["cells"]] = numbers
    table.update({(row["Z"], row["cells"]): row for row in rows})
    with TABLE.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(KEYS)
        for key in sorted(table):
            row = table[key]
            writer.writerow(
                [f"{row['Z']:g}", f"{row['cells']:g}", *(f"{row[k]:.4e}" for k in KEYS[2:])]
            )
    return [table[key] for key in sorted(table)]


def limit(z: float) -> float:
    """Overpressure that the incident peak of the run along the radius has when it comes back from
    a wall, by the jump conditions of gamma = 1.4 [Pa]."""
    with FREE.open() as file:
        rows = [row for row in csv.DictReader(file) if row["products"] == "JWL"]
    peak = next(float(row["peak"]) for row in rows if float(row["Z"]) == z)
    ratio = 1 + peak / 101325
    return (ratio * (3.2 * ratio - 0.4) / (0.4 * ratio + 2.4) - 1) * 101325


def draw(table: list[dict[str, float]], picture: Path) -> None:
    """Ratios to the curves against cells per standoff distance."""
    fig, axes = plt.subplots(1, 2, figsize=(10, 4.2), constrained_layout=True)
    for z, colour in zip(END, ("tab:blue", "tab:orange", "tab:green"), strict=True):
        rows = [row for row in table if row["Z"] == z]
        curve = free_air(1.0, z)
        cells = [row["cells"] for row in rows]
        peaks = [row["peak"] / curve.reflected_overpressure for row in rows]
        impulses = [row["impulse"] / curve.reflected_impulse for row in rows]
        axes[0].semilogx(cells, peaks, "o-", color=colour, label=f"Z = {z:g}")
        exact = limit(z) / curve.reflected_overpressure
        axes[0].axhline(exact, color=colour, ls="--", lw=1)
        axes[1].semilogx(cells, impulses, "o-", color=colour, label=f"Z = {z:g}")
    axes[0].set_title("peak (dashed: jump conditions)")
    axes[1].set_title("impulse")
    axes[1].fill_between([35, 180], 0.85, 1.15, color="0.9", label="goal")
    for ax in axes:
        ax.axhline(1, color="black", lw=0.8)
        ax.set_xlim(35, 180)
        ax.set_xticks([40, 80, 160], ["40", "80", "160"])
        ax.minorticks_off()
        ax.set_xlabel("cells per standoff distance")
        ax.set_ylabel("over Kingery-Bulmash")
        ax.grid(visible=True, alpha=0.3)
        ax.legend(frameon=False)
    fig.savefig(picture, dpi=110)


def judge(table: list[dict[str, float]]) -> int:
    """Print the ratios; how many left their band."""
    left = 0
    for row in table:
        curve = free_air(1.0, row["Z"])
        peak = row["peak"] / curve.reflected_overpressure
        impulse = row["impulse"] / curve.reflected_impulse
        least, low, high = BANDS[int(row["cells"])]
        wrong = [] if least <= peak <= 1.10 else ["peak"]
        wrong += [] if np.isnan(impulse) or low <= impulse <= high else ["impulse"]
        left += len(wrong)
        remark = "  LEFT ITS BAND: " + ", ".join(wrong) if wrong else ""
        print(
            f"floor, Z {row['Z']:5.3f}, {row['cells']:3.0f} cells  peak {peak:5.3f} "
            f"(limit {limit(row['Z']) / curve.reflected_overpressure:5.3f})  impulse {impulse:5.3f}"
            f"  arrival {row['arrival'] / curve.arrival:5.3f}{remark}"
        )
    return left


def main(words: list[str]) -> int:
    if words[:1] == ["--record"]:
        rows = [measured(float(words[1]), int(words[2]), Path(words[3]))]
    else:
        backend = words[:2] if words[:1] == ["--backend"] else []
        sizes = [int(word) for word in words[len(backend) :]] or [40]
        rows = [measured(z, n, run(z, n, backend)) for n in sizes for z in END]
    table = record(rows)
    draw(table, Path("docs/figures/reflected_blast.png"))
    return 1 if judge(table) else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
