#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Blasts of TNT in free air against the Kingery-Bulmash curves: run, measure, record, draw.

Writes docs/data/free_air_blast.csv and docs/figures/free_air_blast.png, and says what lies
outside the bounds; docs/validation.md has the reasons.
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

PLACES = (0.5, 0.725, 1.0, 2.0, 5.0)  # [m], of 1 kg: scaled distances
GASES = {"JWL": "eos='jwl'", "JWL, instant": "eos='jwl', burn='instant'", "ideal": "eos='ideal'"}
SHOWN = ("peak", "arrival", "duration", "impulse")
DECK = """1 kg of TNT in open air, along the radius.
&run title = 'TNT in free air', t_end = 17e-3 /
&air geometry = 'spherical' /
&charge id = 'tnt', mass = 1, explosive = 'tnt', at = 0, 0, 0, {gas} /
{gauges}
&output history_every = 0 /
"""


def run(name: str, gas: str) -> list[dict[str, float]]:
    """Run one deck; what each gauge has seen over the curve."""
    folder = Path("out/validate")
    folder.mkdir(parents=True, exist_ok=True)
    deck = folder / f"{name.replace(', ', '_').lower()}.nml"
    gauges = "\n".join(f"&gauge id = 'z{z}', at = {z}, 0, 0 /" for z in PLACES)
    deck.write_text(DECK.format(gas=gas, gauges=gauges))
    out = folder / deck.stem
    subprocess.run(
        ["bin/brisance", "run", deck, "--out", out, "--replace"],
        check=True,
        stdout=subprocess.DEVNULL,
    )
    history = read_history(out / "gauges.csv")
    found = []
    for z in PLACES:
        pulse = measure_pulse(history.time, history[f"z{z}:pressure"], ambient=101325.0)
        blast = free_air(1.0, z)
        found.append(
            {
                "Z": z,
                "peak": pulse.peak,
                "arrival": pulse.arrival,
                "duration": pulse.duration,
                "impulse": pulse.impulse,
                "peak KB": blast.incident_overpressure,
                "arrival KB": blast.arrival,
                "duration KB": blast.duration,
                "impulse KB": blast.incident_impulse,
            }
        )
    return found


def bound(quantity: str, z: float) -> float | None:
    """Largest accepted relative difference; none for durations, which are only told."""
    if quantity in ("peak", "arrival"):
        return 0.10 if z >= 1 else 0.20
    return 0.15 if quantity == "impulse" else None


def draw(table: dict[str, list[dict[str, float]]], picture: Path) -> None:
    """Ratio to the curve against scaled distance, one panel per quantity."""
    fig, axes = plt.subplots(1, 4, figsize=(14, 4), constrained_layout=True)
    for ax, quantity in zip(axes, SHOWN, strict=True):
        z = np.geomspace(0.45, 5.5, 200)
        limits = [bound(quantity, x) for x in z]
        if limits[0] is not None:
            low, high = [1 - b for b in limits], [1 + b for b in limits]
            ax.fill_between(z, low, high, color="0.9", label="bound")
        for (name, found), mark in zip(table.items(), "os^", strict=True):
            ratio = [row[quantity] / row[f"{quantity} KB"] for row in found]
            ax.semilogx([row["Z"] for row in found], ratio, marker=mark, label=name)
        ax.axhline(1, color="black", lw=0.8)
        ax.set_title(f"{quantity} over Kingery-Bulmash")
        ax.set_xlabel("Z [m/kg^(1/3)]")
        ax.set_xticks(PLACES, [f"{x:g}" for x in PLACES], minor=False)
        ax.minorticks_off()
        ax.grid(visible=True, alpha=0.3)
    axes[2].legend(loc="lower right", frameon=False)
    fig.savefig(picture, dpi=110)


def main() -> None:
    table = {name: run(name, gas) for name, gas in GASES.items()}
    with Path("docs/data/free_air_blast.csv").open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        keys = list(next(iter(table.values()))[0])
        writer.writerow(["products", *keys])
        for name, found in table.items():
            writer.writerows([name, *(f"{row[key]:.4e}" for key in keys)] for row in found)
    draw(table, Path("docs/figures/free_air_blast.png"))
    for name, found in table.items():
        for row in found:
            ratios = {q: row[q] / row[f"{q} KB"] for q in SHOWN}
            line = "  ".join(f"{q} {ratio:5.3f}" for q, ratio in ratios.items())
            wrong = [
                quantity
                for quantity, ratio in ratios.items()
                if (limit := bound(quantity, row["Z"])) and not abs(ratio - 1) <= limit
            ]
            remark = "  outside: " + ", ".join(wrong) if wrong else ""
            print(f"{name:14s} Z {row['Z']:5.3f}  {line}{remark}")


if __name__ == "__main__":
    main()
