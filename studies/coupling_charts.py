#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Studies of the coupling of air and bodies: run the decks, record what they give, draw it.

usage: coupling_charts.py [--keep] paper|steps|panel|plate ...

paper: the coupling as the paper prints it against cut cells; steps: steps of the solid
in one of the air; panel: a steel panel bent by a shock; plate: the demo at several resolutions.
--keep takes runs that lie in out/coupling. Writes docs/data/coupling_NAME.csv and
docs/figures/coupling_NAME.png. panel and plate take half an hour of a core each.
"""

from __future__ import annotations

import csv
import os
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

OUT = Path("out/coupling")
KEEP = "--keep" in sys.argv
SPEED = 9.265913 * (1.4 * 1e5 / 1.2) ** 0.5  # of a shock of pressure ratio 100 [m/s]
BARS = {"steel": (7800, 5000), "concrete": (2000, 3000), "foam": (50, 1500)}  # kg/m3, m/s
PANEL = {2: ("96,32,1", 2.5e-3), 3: ("144,48,1", 1.6666667e-3), 4: ("192,64,1", 1.25e-3)}
SCHEME = {
    "air.reconstruction": "muscl",
    "air.flux": "hllc",
    "air.integrator": "ssprk2",
    "output.dump_every": 1,
}
FLOOR = {
    "2": (0.1344, "16,16,55", 8.4e-3),
    "3": (0.1344, "24,24,83", 5.6e-3),
    "4": (0.1344, "32,32,111", 4.2e-3),
    "wide": (0.2688, "48,48,83", 5.6e-3),
}
TIMES = (0.2e-3, 0.3e-3, 0.36e-3, 0.45e-3)  # [s]
PLATE = {2: ("16,16,60", 8.4e-3), 3: ("24,24,90", 5.6e-3), 4: ("32,32,120", 4.2e-3)}


def run(deck: str, name: str, **settings: object) -> Path:
    """Run a deck with changed settings (dots for double underscores); where its results are."""
    out = OUT / name
    if KEEP and (out / "energy.csv").exists():
        return out
    changes = []
    for key, value in settings.items():
        changes += ["--set", f"{key.replace('__', '.')}={value}"]
    subprocess.run(
        ["bin/brisance", "run", deck, "--out", out, "--replace", *changes],
        check=True,
        stdout=subprocess.DEVNULL,
        env=os.environ | {"OMP_NUM_THREADS": "1"},
    )
    return out


def write(name: str, rows: list[dict[str, object]]) -> None:
    """Record a table."""
    with Path(f"docs/data/coupling_{name}.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        for row in rows:
            shown = {k: f"{v:.5g}" if isinstance(v, float) else v for k, v in row.items()}
            writer.writerow(shown)


def save(fig: plt.Figure, name: str) -> None:
    fig.savefig(f"docs/figures/coupling_{name}.png", dpi=110)
    plt.close(fig)


def paper() -> None:
    """Fixed wall at pressure ratio 100 and free plate at Mach 2: impulse and mass."""
    rows = []
    for problem, deck in (("fixed wall", "tube_wall"), ("free plate", "tube_plate")):
        for cells in (100, 200, 400, 800):
            for scheme in ("cut_cells", "paper"):
                out = run(
                    f"tests/scenes/{deck}.nml",
                    f"{deck}_{scheme}_{cells}",
                    coupling__scheme=scheme,
                    air__cells=f"{cells},1,1",
                    body__spacing=0.0006 if deck == "tube_plate" else 0.08 / 96,
                )
                energy = read_history(out / "energy.csv")
                given = energy["impulse_x"][-1]
                if problem == "fixed wall":
                    exact = 752.77358e5 * (energy.time[-1] - 1 / SPEED)
                else:
                    exact = 0.6 * 409.79138
                gas = energy["air_mass"]
                lost = energy["mass_error"][-1] * gas[0] / gas[-1]
                rows.append(
                    {
                        "problem": problem,
                        "scheme": scheme,
                        "cells": cells,
                        "impulse error": given / exact - 1,
                        "mass error": lost,
                    }
                )
    write("paper", rows)
    fig, axes = plt.subplots(1, 2, figsize=(11, 4.5), constrained_layout=True)
    for ax, column in zip(axes, ("impulse error", "mass error"), strict=True):
        for problem, mark in (("fixed wall", "o"), ("free plate", "s")):
            for scheme, colour in (("cut_cells", "tab:blue"), ("paper", "tab:red")):
                line = [r for r in rows if r["problem"] == problem and r["scheme"] == scheme]
                ax.loglog(
                    [r["cells"] for r in line],
                    [max(abs(r[column]), 1e-16) for r in line],
                    marker=mark,
                    color=colour,
                    label=f"{problem}, {scheme}",
                )
        ax.set_xlabel("cells along the tube")
        ax.set_xticks([100, 200, 400, 800], ["100", "200", "400", "800"])
        ax.minorticks_off()
        ax.grid(visible=True, alpha=0.3)
    axes[0].set_title("|impulse on the plate / exact - 1|")
    axes[1].set_title("|mass of the gas that is lost / mass of the gas|")
    axes[0].legend(frameon=False, fontsize=9)
    save(fig, "paper")


def steps() -> None:
    """K steps of an elastic bar in one of the air, against one in one."""
    rows = []
    for name, (density, speed) in BARS.items():
        reference = None
        for k in (1, 2, 4, 8):
            dt = 0.999 * 0.1 * 1.2 * 0.1 / 120 / speed
            out = run(
                "tests/scenes/bar.nml",
                f"bar_{name}_{k}",
                run__dt_max=k * dt,
                run__t_end=1e-4,
                air__ramp_steps=0,
                material__density=density,
                material__youngs_modulus=density * speed**2,
                output__history_every=16 * dt,
            )
            energy = read_history(out / "energy.csv")
            v = read_history(out / "bodies.csv")["bar:velocity_x"]
            force = np.diff(energy["impulse_x"])[:-1] / np.diff(energy.time)[:-1]
            if reference is None:
                reference = v, force
                continue
            n = min(len(force), len(reference[1]))
            off = force[:n] - reference[1][:n]
            rows.append(
                {
                    "bar": name,
                    "K": k,
                    "velocity": np.abs(v[:n] - reference[0][:n]).max() / np.abs(v).max(),
                    "force": float(np.sqrt(np.mean(off**2)) / 753.77e5),
                }
            )
    write("steps", rows)
    fig, axes = plt.subplots(1, 2, figsize=(11, 4.2), constrained_layout=True)
    titles = {
        "velocity": "largest difference of the velocity / velocity",
        "force": "rms difference of the force / reflected pressure",
    }
    for ax, (column, title) in zip(axes, titles.items(), strict=True):
        for (name, (density, speed)), mark in zip(BARS.items(), "os^", strict=True):
            line = [r for r in rows if r["bar"] == name]
            label = f"{name}, {density} kg/m3, {speed} m/s"
            ax.loglog([r["K"] for r in line], [r[column] for r in line], marker=mark, label=label)
        ax.set_xlabel("steps of the solid in one of the air")
        ax.set_xticks([2, 4, 8], ["2", "4", "8"])
        ax.minorticks_off()
        ax.set_title(title)
        ax.grid(visible=True, which="both", alpha=0.3)
    axes[0].legend(frameon=False, loc=(0.02, 0.55))
    save(fig, "steps")


def panel() -> None:
    """Tip of the steel panel at three resolutions."""
    rows = []
    fig, ax = plt.subplots(figsize=(8, 4.5), constrained_layout=True)
    for layers, (cells, dx) in PANEL.items():
        out = run(
            "tests/scenes/panel.nml",
            f"panel_{layers}",
            **{"body(panel).spacing": 1e-3 / layers, "body(step).spacing": dx},
            air__cells=cells,
            run__t_end=3.5e-3,
        )
        gauges = read_history(out / "gauges.csv")
        time, tip = gauges.time, gauges["tip:displacement_x"]
        first = int(tip.argmax())
        low = first + int(tip[first:].argmin())
        half = time[low] - time[first]
        rows.append(
            {
                "layers": layers,
                "air cell [mm]": 1e3 * dx,
                "peak [mm]": 1e3 * tip[first],
                "peak after [ms]": 1e3 * time[first] - 0.029,
                "half a period [ms]": 1e3 * half,
                "way back to [mm]": 1e3 * tip[low],
            }
        )
        ax.plot(1e3 * time, 1e3 * tip, label=f"{layers} layers, air {1e3 * dx:.3g} mm")
    write("panel", rows)
    ax.set_xlabel("time [ms]")
    ax.set_ylabel("deflection of the tip [mm]")
    ax.set_title("steel panel 50 x 1 mm, shock of Mach 1.21")
    ax.legend(frameon=False)
    ax.grid(visible=True, alpha=0.3)
    save(fig, "panel")


def seen(label: str, out: Path, dx: float) -> dict[str, object]:
    """What gauge A and the middle of the plate have seen, with what was run so far."""
    gauges = read_history(out / "gauges.csv")
    ambient = 101325.0
    over = gauges["A:pressure"] - ambient
    pulse = measure_pulse(gauges.time, gauges["A:pressure"], ambient=ambient)
    row: dict[str, object] = {"scene": label, "air cell [mm]": 1e3 * dx}
    row |= {"peak [MPa]": 1e-6 * pulse.peak, "arrival [ms]": 1e3 * pulse.arrival}
    sums = np.concatenate([[0], np.cumsum(np.diff(gauges.time) * (over[1:] + over[:-1]) / 2)])
    for t in TIMES:
        done = gauges.time[-1] > 0.999 * t
        row[f"impulse {1e3 * t:g} ms [Pa s]"] = (
            float(np.interp(t, gauges.time, sums)) if done else float("nan")
        )
    for t in TIMES:
        done = gauges.time[-1] > 0.999 * t and "mid:displacement_z" in gauges
        row[f"deflection {1e3 * t:g} ms [mm]"] = (
            -1e3 * float(np.interp(t, gauges.time, gauges["mid:displacement_z"]))
            if done
            else float("nan")
        )
    return row


def plate() -> None:
    """The demo at several resolutions; the same blast on a rigid floor, and along the radius."""
    rows, runs = [], []
    for layers, (cells, dx) in PLATE.items():
        out = run(
            "inputs/demo.nml",
            f"demo_{layers}",
            **{"body.spacing": 4.2e-3 / layers, "gauge(A).at": f"0,0,{dx / 2}"},
            air__cells=cells,
            **SCHEME,
        )
        runs.append((f"{layers} layers, air {1e3 * dx:.1f} mm", out))
        rows.append(seen(f"plate of {layers} layers", out, dx))
    for name, (side, cells, dx) in FLOOR.items():
        out = run(
            "tests/scenes/floor.nml",
            f"floor_{name}",
            air__box=f"0,{side},0,{side},0,0.4648",
            air__cells=cells,
            **{"gauge(A).at": f"0,0,{dx / 2}"},
        )
        rows.append(seen("rigid floor" + ", wide box" * (name == "wide"), out, dx))
    for eos in ("ideal", "jwl"):
        out = run("tests/scenes/radial.nml", f"radial_{eos}", charge__eos=f"'{eos}'")
        row = seen(f"along the radius, {eos}, reflected", out, 0.0)
        incident = 1e6 * row["peak [MPa]"]
        row["peak [MPa]"] = 1e-6 * reflected(incident)
        rows.append({k: float("nan") if "impulse" in k else v for k, v in row.items()})
    write("plate", rows)
    draw_plate(rows, runs)


def reflected(over: float, ambient: float = 101325.0) -> float:
    """Overpressure behind the normal reflection of a shock, gamma = 1.4 (Rankine, Hugoniot)."""
    return 2 * over * (7 * ambient + 4 * over) / (7 * ambient + over)


def draw_plate(rows: list[dict[str, object]], runs: list[tuple[str, Path]]) -> None:
    """Pressure and deflection in time; peak against resolution."""
    fig, axes = plt.subplots(1, 3, figsize=(14, 4.3), constrained_layout=True)
    for label, out in runs:
        gauges = read_history(out / "gauges.csv")
        time = 1e3 * gauges.time
        axes[0].plot(time, 1e-6 * (gauges["A:pressure"] - 101325), label=label)
        axes[1].plot(time, -1e3 * gauges["mid:displacement_z"], label=label)
    blast = free_air(0.168, 0.4)
    axes[0].set(xlim=(0.14, 0.24), xlabel="time [ms]", title="overpressure at the middle [MPa]")
    axes[1].set(xlim=(0.14, 0.45), xlabel="time [ms]", title="deflection of the middle [mm]")
    axes[1].legend(frameon=False)
    for start, mark in (("plate", "o"), ("rigid floor", "s")):
        line = [r for r in rows if r["scene"].startswith(start) and "wide" not in r["scene"]]
        line.sort(key=lambda r: r["air cell [mm]"])
        x = [r["air cell [mm]"] for r in line]
        axes[2].plot(x, [r["peak [MPa]"] for r in line], marker=mark, label=start)
    for r in rows[-2:]:
        axes[2].plot(0, r["peak [MPa]"], "*", ms=10, label=r["scene"])
    axes[2].axhline(1e-6 * blast.reflected_overpressure, color="black", lw=0.8)
    axes[2].text(8.4, 1e-6 * blast.reflected_overpressure + 0.1, "Kingery-Bulmash", ha="right")
    axes[2].set(xlim=(-0.3, 8.8), xlabel="air cell [mm]", title="peak overpressure [MPa]")
    axes[2].legend(frameon=False, fontsize=8, loc="lower left")
    for ax in axes:
        ax.grid(visible=True, alpha=0.3)
    save(fig, "plate")


if __name__ == "__main__":
    for study in sys.argv[1:]:
        if study != "--keep":
            {"paper": paper, "steps": steps, "panel": panel, "plate": plate}[study]()
