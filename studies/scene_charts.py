#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Record and draw scenes of Chen et al. on CFRP, inputs/paper/hvi.nml and inputs/paper/plate.nml.

usage: scene_charts.py record OUTDIR...        append impacts to docs/data/hvi_*.csv
       scene_charts.py blast NAME=OUTDIR...    append blasts to docs/data/cfrp_blast.csv
       scene_charts.py draw                    docs/figures/hvi_cfrp.png, cfrp_blast.png from these

Impact: kinetic energy over time, where the energy went, the hole. Blast: load on the plate and
motion of its middle. Beside what Chen et al. give.
"""

import csv
import sys
from collections import defaultdict
from pathlib import Path

import numpy as np

HOME = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(HOME))

ENERGIES = HOME / "docs/data/hvi_energy.csv"
HOLES = HOME / "docs/data/hvi_holes.csv"
PICTURE = HOME / "docs/figures/hvi_cfrp.png"
BLASTS = HOME / "docs/data/cfrp_blast.csv"
BLAST_PICTURE = HOME / "docs/figures/cfrp_blast.png"
SHARES = ("viscous", "contact_heat", "hourglass_heat", "plastic", "damage")
PAPER = {"kinetic": 10.0, "hole": 6.20, "experiment": 5.98}
TIMES = np.concatenate([np.arange(0, 1.2e-6, 1e-7), np.geomspace(1.2e-6, 25e-6, 20)])


def record(folders):
    """Append the histories (some 30 rows a run) and the final hole of each run."""
    from post.perforation import load_plate, measure_perforation  # noqa: PLC0415
    from post.reader import Run  # noqa: PLC0415

    for folder in folders:
        run = Run(folder)
        spacing = 1e3 * float(run.deck.groups("body")[0]["spacing"])
        energy, bodies = run.energy, run.bodies
        rows = []
        for k in np.unique(np.searchsorted(energy.time, TIMES * (1 - 1e-9))):
            if k < len(energy):
                row = [spacing, f"{1e6 * energy.time[k]:.3f}", f"{energy['solid_kinetic'][k]:.4f}"]
                row += [f"{bodies[name + ':kinetic'][k]:.4f}" for name in ("ball", "plate")]
                row += [f"{energy[name][k]:.4f}" for name in SHARES]
                rows.append([*row, f"{energy['error'][k]:.2e}"])
        heads = ["spacing[mm]", "time[us]", "kinetic[J]", "ball[J]", "plate[J]"]
        heads += [f"{name}[J]" for name in SHARES] + ["error[-]"]
        append(ENERGIES, heads, rows)
        found = measure_perforation(load_plate(run, run.frames[-1], "plate"))
        widest = found.widest
        holes = [widest.through, widest.layers[-1], widest.layers[0]]
        values = [f"{1e3 * o.diameter:.3f}" for h in holes for o in (h.seen, h.pushed)]
        heads = ["spacing[mm]", "time[us]", "through[mm]", "through_pushed[mm]"]
        heads += ["front[mm]", "front_pushed[mm]", "back[mm]", "back_pushed[mm]"]
        append(HOLES, heads, [[spacing, f"{1e6 * found.plate.time:.3f}", *values]])


def record_blasts(names):
    """Append load and motion of the middle of the plate, 120 rows a run."""
    from post.reader import Run  # noqa: PLC0415

    for name, folder in (text.split("=", 1) for text in names):
        gauges = Run(folder).gauges
        over = gauges["A:pressure"] - gauges["A:pressure"][0]
        steps = 0.5 * (over[1:] + over[:-1]) * np.diff(gauges.time)
        impulse = np.concatenate([[0.0], np.cumsum(steps)])
        wanted = np.linspace(0.14e-3, gauges.time[-1], 120)
        rows = []
        for k in np.unique(np.minimum(np.searchsorted(gauges.time, wanted), len(over) - 1)):
            values = over[k], impulse[k], gauges["mid:displacement_z"][k]
            values = [*values, gauges["mid_v:velocity_z"][k]]
            rows.append([name, f"{1e3 * gauges.time[k]:.5f}", *(f"{v:.5g}" for v in values)])
        heads = ["case", "time[ms]", "overpressure[Pa]", "impulse[Pa s]"]
        append(BLASTS, [*heads, "displacement[m]", "velocity[m/s]"], rows)


def append(path, heads, rows):
    """Add rows to a table; begin it if there is none."""
    fresh = not path.is_file()
    with path.open("a", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerows([heads, *rows] if fresh else rows)


def read(path):
    """Rows of a table by spacing, coarse to fine; each a dictionary of numbers."""
    found = defaultdict(list)
    with path.open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            found[float(row["spacing[mm]"])].append({k: float(v) for k, v in row.items()})
    return dict(sorted(found.items(), reverse=True))


def draw():
    """Kinetic energy over time; shares of the heat, and the hole, over the spacing."""
    from post.style import BLUE, CYCLE, GREEN, GREY, ORANGE, RED, plt, save  # noqa: PLC0415

    energies, holes = read(ENERGIES), read(HOLES)
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(11, 3.6))
    for colour, (spacing, rows) in zip(CYCLE, energies.items(), strict=False):
        time = [row["time[us]"] for row in rows]
        left.plot(time, [row["kinetic[J]"] for row in rows], color=colour, label=f"{spacing:g} mm")
    left.axhline(PAPER["kinetic"], color=GREY, ls="--", lw=1, label="paper, at its end")
    left.set(xlabel="time [µs]", ylabel="kinetic energy [J]", xscale="symlog", xlim=(0, 25))
    left.set_ylim(0, 62)
    left.set_xticks([0, 1, 2, 5, 10, 25], labels=["0", "1", "2", "5", "10", "25"])
    left.set_title("Kinetic energy")
    left.legend()
    spacings = list(energies)
    for name, colour, label in (
        ("kinetic[J]", BLUE, "kinetic"),
        ("viscous[J]", RED, "viscous heat"),
        ("contact_heat[J]", ORANGE, "heat of the contact"),
        ("damage[J]", GREEN, "damage"),
    ):
        values = [rows[-1][name] for rows in energies.values()]
        middle.plot(spacings, values, "o-", ms=4, color=colour, label=label)
    middle.set(
        xlabel="spacing [mm]", ylabel="energy at the end [J]", ylim=(0, None), xlim=(0, None)
    )
    middle.set_title("Where the 60 J are")
    middle.legend()
    for name, line, label in (
        ("", "o-", "loose parts away"),
        ("_pushed", "s-", "broken fibres away"),
    ):
        values = [rows[-1][f"through{name}[mm]"] for rows in holes.values()]
        right.plot(list(holes), values, line, ms=4, color=RED if name else BLUE, label=label)
    right.axhline(PAPER["hole"], color=GREY, ls="--", lw=1, label="paper, computed")
    right.axhline(PAPER["experiment"], color="black", ls=":", lw=1.2, label="experiment")
    right.set(xlabel="spacing [mm]", ylabel="hole [mm]", ylim=(0, 8), xlim=(0, None))
    right.set_title("Hole through the plate")
    right.legend(loc="lower left")
    print(save(figure, PICTURE))


def draw_blasts():
    """Load on the plate, and displacement and velocity of its middle, over time."""
    from post.style import CYCLE, plt, save  # noqa: PLC0415

    cases = defaultdict(list)
    with BLASTS.open(encoding="utf-8") as file:
        for row in csv.reader(file):
            if row[0] != "case":
                cases[row[0]].append([float(value) for value in row[1:]])
    figure, panels = plt.subplots(1, 4, figsize=(13, 3.6))
    titles = "overpressure at the middle [MPa]", "impulse there [Pa s]"
    titles = (*titles, "displacement of the middle [mm]", "its velocity [m/s]")
    paper = {0: [(0.12, 6.2)], 2: [(0.42, 10.2)], 3: [(0.25, 45.0)]}
    for k, (panel, title, factor) in enumerate(
        zip(panels, titles, (1e-6, 1.0, -1e3, -1.0), strict=True)
    ):
        for colour, (name, rows) in zip(CYCLE, cases.items(), strict=False):
            values = np.array(rows)
            panel.plot(values[:, 0], factor * values[:, k + 1], color=colour, label=name, lw=1.3)
        for time, value in paper.get(k, []):
            panel.plot(time, value, "k*", ms=9, label="Chen et al., largest", ls="none")
        panel.set(xlabel="time [ms]", title=title)
    panels[2].legend(fontsize=7.5)
    print(save(figure, BLAST_PICTURE))


if __name__ == "__main__":
    if sys.argv[1:2] == ["record"] and len(sys.argv) > 2:
        record(sys.argv[2:])
    elif sys.argv[1:2] == ["blast"] and len(sys.argv) > 2:
        record_blasts(sys.argv[2:])
    elif sys.argv[1:] == ["draw"]:
        draw()
        if BLASTS.is_file():
            draw_blasts()
    else:
        sys.exit(__doc__)
