# SPDX-License-Identifier: MIT
"""Where the energy is, over time, and what is not accounted for."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from post.balance import column, total_of
from post.errors import PostError
from post.reader import History, Run
from post.style import CYCLE, GREY, INK, RED, Picture, new_figure, save
from post.units import scale_for

PARTS = {1: "the whole scene", 2: "the half that is modelled", 4: "the quarter that is modelled"}
# columns of energy.csv: names that are added up, label, line style
AIR = (
    (("air_internal",), "air, internal", "-"),
    (("air_kinetic",), "air, kinetic", "-"),
    (("air_outflow",), "left through the outer faces", "-"),
)
SOLID = (
    (("air_work",), "given by the air", "-"),
    (("drive_work",), "given by prescribed motion", "-"),
    (("solid_kinetic",), "kinetic", "-"),
    (("solid_internal",), "internal (elastic and spent)", "-"),
    (("hourglass",), "hourglass", "-"),
    (("artificial",), "artificial stress", "-"),
    (("contact",), "springs of contact", "-"),
    (("contact_heat",), "heat of contact", "-"),
    (("viscous",), "spent in artificial viscosity", "--"),
    (("hourglass_heat",), "spent in hourglass forces", "--"),
    (("plastic",), "spent in plastic work", "--"),
    (("damage",), "spent in damage", "--"),
    (("friction",), "spent in friction", "--"),
    (("bond",), "stored in cohesive interfaces", "-"),
    (("bond_heat",), "spent in cohesive interfaces", "--"),
)
LEAST = 1e-3  # of the largest curve: what is smaller is told in the table alone


def energy_residual(history: History) -> np.ndarray | None:
    """Relative error of the total energy, from the column `error` or `ratio`, or the total."""
    if "error" in history:
        return history["error"]
    if "ratio" in history:
        return history["ratio"] - 1
    total = column(history, "total")
    if total is None or not len(total) or total[0] == 0:
        return None
    return total / total[0] - 1


def draw_energy(run: Run, folder: Path) -> Picture:
    """Where the energy is, what the solids did with theirs, and what is unaccounted for."""
    history = run.energy
    if not len(history):
        raise PostError(f"{history.path}: has no rows yet")
    panels = [(group, title) for group, title in ((AIR, "Air and total"), (SOLID, "Solids"))]
    panels = [(group, title) for group, title in panels if _worth_drawing(history, group)]
    figure, axes = new_figure(
        len(panels) + 1,
        2.5,
        sharex=True,
        gridspec_kw={"height_ratios": [3] * len(panels) + [1.6]},
        squeeze=False,
    )
    axes = axes[:, 0]
    factor, unit = scale_for(history.time, "s")
    time = history.time / factor
    for axis, (group, title) in zip(axes, panels, strict=False):
        _draw_energies(axis, history, time, (group, title), run.deck.images)
    _draw_residual(axes[-1], history, time)
    axes[-1].set_xlabel(f"time [{unit}]")
    part = PARTS.get(run.deck.images, "the part that is modelled")
    axes[0].set_title(f"{axes[0].get_title(loc='left')}: energies of {part}")
    several = "" if run.deck.images == 1 else "; on the right the scale of the whole scene"
    caption = (
        f"Energies of {part}{several}. Solid lines are stores and flows, dashed lines are parts of "
        "the internal energy that were spent for good. The lowest panel is the total energy over "
        f"its initial value less one: largest {_largest(energy_residual(history))}."
    )
    return Picture(save(figure, folder / "energy.png"), "Energy history", caption)


def _largest(residual: np.ndarray | None) -> str:
    return "unknown" if residual is None else f"{_top(residual):.1e}"


def _worth_drawing(history: History, group: tuple) -> list:
    """Members of a group whose columns exist and are no line along zero."""
    found = []
    for names, label, line in group:
        values = total_of(history, names)
        if values is not None:
            found.append((np.where(np.isfinite(values), values, np.nan), label, line))
    top = max((_top(values) for values, _, _ in found), default=0.0)
    return [one for one in found if _top(one[0]) > LEAST * top]


def _top(values: np.ndarray) -> float:
    """Largest magnitude of the finite values."""
    return float(np.max(np.abs(values[np.isfinite(values)]), initial=0.0))


def _draw_energies(axis, history: History, time: np.ndarray, panel: tuple, images: int) -> None:
    group, title = panel
    curves = _worth_drawing(history, group)
    if group is AIR and (total := column(history, "total")) is not None:
        curves.append((total, "total of everything", "-"))
    factor, unit = scale_for(np.concatenate([values for values, _, _ in curves]), "J")
    for i, (values, label, line) in enumerate(curves):
        whole = label.startswith("total")
        color = INK if whole else CYCLE[i % len(CYCLE)]
        axis.plot(time, values / factor, line, color=color, label=label, lw=2.2 if whole else 1.5)
    axis.set_title(title)
    axis.set_ylabel(f"energy [{unit}]")
    axis.margins(x=0)
    if images > 1:
        both = (lambda e: images * e, lambda e: e / images)
        whole = axis.secondary_yaxis("right", functions=both)
        whole.set_ylabel(f"of the whole [{unit}]")
    right = 1.16 if images > 1 else 1.0
    axis.legend(loc="center left", bbox_to_anchor=(right, 0.5), handlelength=1.6)


def _draw_residual(axis, history: History, time: np.ndarray) -> None:
    residual = energy_residual(history)
    if residual is None:
        axis.text(0.5, 0.5, "no total energy in energy.csv", ha="center", transform=axis.transAxes)
        return
    top = _top(residual)
    power = math.floor(math.log10(top)) if top > 0 else 0
    axis.axhline(0, color=GREY, lw=0.8)
    axis.plot(time, residual / 10.0**power, color=RED, lw=1.2)
    name = "1" if power == 0 else rf"$10^{{{power}}}$"
    axis.set_ylabel(f"error [{name}]")
    axis.set_title("Unaccounted energy over initial energy")
