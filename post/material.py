# SPDX-License-Identifier: MIT
"""Tables of `brisance mat`: the curves by which an engineer judges a material."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from post.errors import PostError
from post.history import History, read_history
from post.style import BLUE, CYCLE, ORANGE, RED, WIDTH, legend_above, save
from post.units import scale_for

AXES = ("xx", "yy", "zz", "yz", "xz", "xy")
NEEDED = ("rho", "e", "p", "q", *(f"s{a}" for a in AXES), *(f"eps_{a}" for a in AXES), "eps_p")
STYLES = ("-", "--", ":", "-.", (0, (1, 3)), (0, (5, 5)))
STILL = 1e-9  # a strain that counts as none
EQUAL = 1e-6  # part of the largest stress below which two are the same, or one is none


@dataclass(frozen=True)
class Curve:
    """One table and how its lines look."""

    table: History
    colour: str
    label: str


def draw_material(files: list[Path], picture: Path | None = None) -> Path:
    """One PNG with four panels of one table, or of several for comparison. Returns its path."""
    curves = [
        Curve(read_history(file), CYCLE[i % len(CYCLE)], file.stem) for i, file in enumerate(files)
    ]
    for curve in curves:
        check(curve.table)
    figure, panels = plt.subplots(2, 2, figsize=(WIDTH, 6.2))
    figure.suptitle(files[0].stem if len(files) == 1 else "Comparison", fontsize=10)
    draw_pressure(panels[0, 0], curves)
    if any(has_strength(curve.table) for curve in curves):
        draw_path(panels[0, 1], curves)
    else:
        draw_expansion(panels[0, 1], curves)
    if len(curves) == 1:
        draw_stresses(panels[1, 0], curves[0].table)
        draw_state(panels[1, 1], curves[0].table)
    else:
        draw_stress(panels[1, 0], curves)
        draw_one_state(panels[1, 1], curves)
    for panel in panels.flat:
        if panel.get_xscale() == "linear":
            panel.locator_params(axis="x", nbins=5)
        if len(files) == 1 or panel is panels[0, 0]:
            legend_above(panel)
    return save(figure, picture or files[0].with_suffix(".png"))


def check(table: History) -> None:
    """PostError if this is no table of `brisance mat`, or is not finite."""
    if missing := [name for name in NEEDED if name not in table]:
        raise PostError(f"{table.path}: no table of `brisance mat`: no column '{missing[0]}'")
    if len(table) < 2:
        raise PostError(f"{table.path}: fewer than two rows")
    for name in table.names:
        if not np.isfinite(table[name]).all():
            raise PostError(f"{table.path}: '{name}' is not finite")


def scale(curves: list[Curve], column: str, unit: str) -> tuple[float, str]:
    """One factor and unit for a column of all tables."""
    return scale_for(np.concatenate([curve.table[column] for curve in curves]), unit)


def plot(panel, curves: list[Curve], x, y) -> None:
    """A line for each table; x and y take a table."""
    for curve in curves:
        look = {"color": curve.colour}
        if len(curves) > 1:
            look["label"] = curve.label
        panel.plot(x(curve.table), y(curve.table), **look)


def has_strength(table: History) -> bool:
    return np.abs(table["q"]).max() > EQUAL * np.abs(table["p"]).max()


def compression(table: History) -> np.ndarray:
    return table["rho"] / table["rho"][0] - 1


def driven(table: History) -> str:
    """The component of strain that goes farthest: 'xx' .. 'xy'."""
    return max(AXES, key=lambda a: np.abs(table[f"eps_{a}"]).max() * (1 if a[0] == a[1] else 2))


def strain(table: History) -> np.ndarray:
    """The strain that goes farthest; the angle, where it is a shear."""
    a = driven(table)
    return table[f"eps_{a}"] * (1 if a[0] == a[1] else 2)


def draw_pressure(panel, curves: list[Curve]) -> None:
    """Pressure over compression; over time where the volume stays the same."""
    factor, unit = scale(curves, "p", "Pa")
    panel.set_ylabel(f"pressure [{unit}]")
    panel.set_title("Pressure")
    if any(np.ptp(compression(curve.table)) > STILL for curve in curves):
        plot(panel, curves, compression, lambda t: t["p"] / factor)
        panel.set_xlabel("compression µ = ρ/ρ₀ - 1 [-]")
    else:
        size, name = scale(curves, "time", "s")
        plot(panel, curves, lambda t: t.time / size, lambda t: t["p"] / factor)
        panel.set_xlabel(f"time [{name}], the volume is constant")


def draw_path(panel, curves: list[Curve]) -> None:
    """Equivalent stress over pressure, with a dot at the start."""
    along, name = scale(curves, "p", "Pa")
    factor, unit = scale(curves, "q", "Pa")
    plot(panel, curves, lambda t: t["p"] / along, lambda t: t["q"] / factor)
    for curve in curves:
        start = curve.table["p"][0] / along, curve.table["q"][0] / factor
        panel.plot(*start, "o", ms=4, color=curve.colour)
    panel.set_xlabel(f"pressure [{name}]")
    panel.set_ylabel(f"von Mises stress q [{unit}]")
    panel.set_title("Stress path")


def draw_expansion(panel, curves: list[Curve]) -> None:
    """Pressure over relative volume, both logarithmic: what a fluid is judged by."""
    factor, unit = scale(curves, "p", "Pa")
    plot(panel, curves, lambda t: t["rho"][0] / t["rho"], lambda t: t["p"] / factor)
    if all((curve.table["p"] > 0).any() for curve in curves):
        panel.set_xscale("log")
        panel.set_yscale("log")
        for axis in (panel.xaxis, panel.yaxis):
            axis.set_major_formatter("{x:g}")
        panel.xaxis.set_minor_formatter("{x:g}")
    panel.set_xlabel("volume ρ₀/ρ [-]")
    panel.set_ylabel(f"pressure [{unit}]")
    panel.set_title("Expansion")


def label_strain(panel, table: History) -> None:
    a = driven(table)
    panel.set_xlabel(f"{'logarithmic strain' if a[0] == a[1] else 'shear angle'} {a} [-]")
    panel.set_title("Stress and strain")


def draw_stress(panel, curves: list[Curve]) -> None:
    """Of each table the stress that belongs to the strain that goes farthest."""
    factor, unit = scale_for(np.concatenate([c.table["s" + driven(c.table)] for c in curves]), "Pa")
    plot(panel, curves, strain, lambda t: t["s" + driven(t)] / factor)
    label_strain(panel, curves[0].table)
    panel.set_ylabel(f"stress σ {driven(curves[0].table)} [{unit}]")


def draw_stresses(panel, table: History) -> None:
    """All stresses that matter over the strain that goes farthest; equal ones once."""
    top = max(np.abs(table[f"s{a}"]).max() for a in AXES)
    main = driven(table)
    groups: list[list[str]] = []
    for a in (main, *(a for a in AXES if a != main)):
        stress = table[f"s{a}"]
        if a != main and np.abs(stress).max() <= EQUAL * top:
            continue
        same = [g for g in groups if np.abs(stress - table[f"s{g[0]}"]).max() <= EQUAL * top]
        if same:
            same[0].append(a)
        else:
            groups.append([a])
    factor, unit = scale_for(np.array([top]), "Pa")
    for i, group in enumerate(groups):
        look = {"color": CYCLE[i], "linestyle": STYLES[i], "label": "σ " + " = ".join(group)}
        panel.plot(strain(table), table[f"s{group[0]}"] / factor, **look)
    panel.set_ylabel(f"stress [{unit}]")
    label_strain(panel, table)


def changing(table: History) -> list[str]:
    """Columns of damage and plastic strain that change."""
    columns = ("damage", *table.find("damage_.*"), "eps_p")
    return [c for c in columns if np.ptp(table[c]) > STILL]


def warms(table: History) -> bool:
    return "T" in table and np.ptp(table["T"]) > 1e-3


def in_words(column: str) -> str:
    words = {"eps_p": "plastic strain", "T": "temperature", "e": "energy"}
    return words.get(column, column.replace("_", " "))


def draw_state(panel, table: History) -> None:
    """Damage and plastic strain over time, temperature beside; the energy where none changes."""
    columns = changing(table)
    if not columns:
        draw_over_time(panel, [Curve(table, BLUE, "")], "T" if warms(table) else "e")
        return
    size, name = scale_for(table.time, "s")
    for i, column in enumerate(columns):
        colour = {"damage": RED, "eps_p": BLUE}.get(column, CYCLE[(i + 2) % len(CYCLE)])
        style = "-" if column in ("damage", "eps_p") else "--"
        panel.plot(table.time / size, table[column], style, color=colour, label=in_words(column))
    panel.set_xlabel(f"time [{name}]")
    shown = dict.fromkeys("damage" if "damage" in c else in_words(c) for c in columns)
    panel.set_ylabel(", ".join(shown) + " [-]")
    panel.set_title("State")
    if not warms(table):
        return
    beside = panel.twinx()
    beside.grid(False)
    beside.spines["right"].set_visible(True)
    beside.plot(table.time / size, table["T"], color=ORANGE)
    beside.set_ylabel("temperature [K]", color=ORANGE)
    beside.tick_params(axis="y", colors=ORANGE)
    panel.plot([], [], color=ORANGE, label="temperature")


def draw_one_state(panel, curves: list[Curve]) -> None:
    """The one quantity that tells most of several tables."""
    tables = [curve.table for curve in curves]
    for column in ("damage", "eps_p"):
        if all(column in changing(table) for table in tables):
            draw_over_time(panel, curves, column)
            return
    draw_over_time(panel, curves, "T" if all(map(warms, tables)) else "e")


def draw_over_time(panel, curves: list[Curve], column: str) -> None:
    size, name = scale(curves, "time", "s")
    factor, unit = scale(curves, column, "J" if column == "e" else "-")
    unit = {"e": f"{unit}/kg", "T": "K"}.get(column, "-")
    plot(panel, curves, lambda t: t.time / size, lambda t: t[column] / factor)
    panel.set_xlabel(f"time [{name}]")
    panel.set_ylabel(f"{in_words(column)} [{unit}]")
    panel.set_title(in_words(column).capitalize())
