# SPDX-License-Identifier: MIT
"""One look for all pictures: colours, fonts, colour maps, sizes."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, LogNorm, Normalize
from matplotlib.ticker import LogLocator

from post.labels import settle
from post.units import scale_for

WIDTH = 7.5  # of a picture [inch]; a page shows it 900 pixels wide
DPI = 200
LETTERS, FULL = 105, 0.775  # letters of a legend beside each other in a panel of this width
BLUE, RED, GREEN, ORANGE, PURPLE, GREY = (
    "#1f5a93",
    "#b3312c",
    "#3a7d44",
    "#c97b1a",
    "#6b4c9a",
    "#6f7780",
)
INK = "#20242a"
CYCLE = (BLUE, RED, GREEN, ORANGE, PURPLE, "#2a8c98", "#8c564b", GREY)
STYLE = {
    "font.size": 9.5,
    "axes.titlesize": 10,
    "axes.titlelocation": "left",
    "axes.titleweight": "bold",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": "#40464d",
    "axes.linewidth": 0.8,
    "axes.grid": True,
    "axes.prop_cycle": mpl.cycler(color=CYCLE),
    "grid.color": "#dfe3e7",
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.5,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "figure.constrained_layout.use": True,
    "axes.titlepad": 6,
    "savefig.dpi": DPI,
}

mpl.rcParams.update(STYLE)

# Damage, 0..1: undamaged is a quiet grey, lightness falls evenly to dark violet.
DAMAGE = LinearSegmentedColormap.from_list(
    "damage", ["#d5dbe1", "#9fc3c4", "#4f9bab", "#2f6397", "#3d2a72", "#1c0a36"]
)
DAMAGE_COLOURS = ScalarMappable(Normalize(0, 1), DAMAGE)  # always this range
# Pressure: undisturbed air is nearly white, lightness falls evenly to dark red and black above it
# and to blue below.
BLAST = ("#fdfcf6", "#fae0a2", "#f5b254", "#e5762f", "#bb3a35", "#75193f", "#26082c")
SUCTION = ("#6d9cc7", "#b3cfe5", "#fdfcf6")


@dataclass(frozen=True)
class Picture:
    """A PNG file and what an engineer sees in it."""

    path: Path
    title: str
    caption: str


def highest(values: np.ndarray) -> float:
    """Largest finite value; 0 if there is none."""
    finite = values[np.isfinite(values)]
    return float(finite.max(initial=0.0))


def pressure_colours(ambient: float, top: float) -> ScalarMappable:
    """Logarithmic colours from a tenth of the ambient pressure to the largest shown [Pa]."""
    norm = LogNorm(0.1 * ambient, max(top, 1.5 * ambient))
    rest = float(norm(ambient))
    stops = list(zip(np.linspace(0, rest, len(SUCTION)), SUCTION, strict=True))
    stops += list(zip(np.linspace(rest, 1, len(BLAST)), BLAST, strict=True))[1:]
    return ScalarMappable(norm, LinearSegmentedColormap.from_list("pressure", stops, N=512))


def pressure_bar(figure, colours: ScalarMappable, axes, **options):
    """A colour bar of the pressure, marked at 1, 2 and 5; in kPa below 1 MPa."""
    bar = figure.colorbar(colours, ax=axes, **options)
    factor, unit = scale_for([colours.norm.vmax], "Pa")
    bar.set_label(f"pressure [{unit}]", fontsize=8.5)
    few = colours.norm.vmax < 300 * colours.norm.vmin
    bar.long_axis.set_major_locator(LogLocator(subs=(1, 2, 5) if few else (1,)))
    bar.long_axis.set_major_formatter(lambda value, _: f"{value / factor:g}")
    bar.long_axis.set_minor_formatter(lambda value, _: "")
    bar.ax.tick_params(labelsize=8)
    return bar


def linear_bar(figure, colours: ScalarMappable, axes, label: str, **options):
    """A colour bar with a linear scale."""
    bar = figure.colorbar(colours, ax=axes, **options)
    bar.set_label(label, fontsize=8.5)
    bar.ax.tick_params(labelsize=8)
    return bar


def new_figure(rows: int = 1, height: float = 3.0, **options):
    """Figure and axes in the common style, `rows` panels of `height` [inch] above each other."""
    return plt.subplots(rows, 1, figsize=(WIDTH, height * rows + 0.3), **options)


def legend_above(axis) -> None:
    """A legend between title and axes, where it hides no curve; as many columns as have room."""
    handles, labels = axis.get_legend_handles_labels()
    if not handles:
        return
    longest = max(len(label) for label in labels) + 7
    room = LETTERS * axis.get_position().width / FULL
    columns = max(1, min(len(labels), int(room // longest)))
    place = {"loc": "lower left", "bbox_to_anchor": (-0.01, 0.985), "borderaxespad": 0.2}
    axis.legend(handles, labels, ncols=columns, columnspacing=1.2, handlelength=1.8, **place)
    rows = -(-len(labels) // columns)
    axis.figure.set_figheight(axis.figure.get_figheight() + 0.18 * (rows - 1))
    axis.set_title(axis.get_title(loc="left"), loc="left", pad=6 + 14 * rows)


def save(figure, path: Path) -> Path:
    """Write a figure as PNG and close it; its labels are put where there is room."""
    settle(figure)
    figure.savefig(path)
    plt.close(figure)
    return path
