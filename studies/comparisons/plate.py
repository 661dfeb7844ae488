# SPDX-License-Identifier: MIT
"""Clamped plates of Brisance: their deck, and what is measured on the motion of a middle."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from studies.comparisons.case import History, Measures, Run
from studies.comparisons.reading import column


@dataclass(frozen=True)
class Shape:
    """A plate and its particles."""

    half: float  # of the free span [m]
    thickness: float  # [m]
    layers: int  # particles through it
    wide: float = 0  # about so many times as wide as high, 0: cubes
    reach: float = 0  # widths of a particle by which the clamp acts behind the first held column


DECK = """{title}

A quarter of a clamped plate of {span:g} x {span:g} mm, {thick:g} mm thick, in {layers} layers,
written by studies/comparisons/plate.py. The clamp acts {clamp} of the three columns that are held.

&run t_end = {t_end}, symmetry = 'x', 'y' /
{material}
&body
    id = 'plate', box = {low}, {high}, {low}, {high}, {bottom}, 0
    spacing = {spacing}, material = 'm', fix = 'sides'{more}{aspect}
/
{load}
&gauge id = 'mid', at = 0, 0, {middle}, body = 'plate', quantity = 'displacement_z' /
&output history_every = {every} /
"""


def write(folder: Path, title: str, shape: Shape, **scene: str | float) -> None:
    """Write deck.nml of a plate.

    Of the scene: material and load (groups of the deck), t_end [s], and `more` keys of the body.
    """
    half, thickness, layers = shape.half, shape.thickness, shape.layers
    t_end, more = scene["t_end"], scene.get("more", "")
    _, spacing, outer = lattice(shape)
    across = thickness / layers if shape.wide else spacing
    aspect = f"{spacing / across:.7g}"
    text = DECK.format(
        title=title,
        span=2e3 * half,
        thick=1e3 * thickness,
        layers=layers,
        t_end=t_end,
        material=scene["material"],
        low=f"{-outer:.7g}",
        high=f"{outer:.7g}",
        bottom=-thickness,
        spacing=f"{across:.7g}",
        more=more and f"\n    {more}",
        aspect=f"\n    aspect = {aspect}, {aspect}, 1" if shape.wide else "",
        clamp=f"{shape.reach} widths behind the first" if shape.reach else "at the first",
        load=scene["load"],
        middle=-thickness / 2,
        every=t_end / 600,
    )
    (folder / "deck.nml").write_text(text, encoding="utf-8")


def lattice(shape: Shape) -> tuple[int, float, float]:
    """Columns of the quarter, their spacing, half the width of the box with its clamp [m].

    Three columns are held; the clamp acts at the centres of the first, or `reach` widths behind
    (docs/theory/plates.md).
    """
    aimed = (shape.wide or 1) * shape.thickness / shape.layers
    columns = shape.half / aimed + 2.5 - shape.reach
    columns = round(columns) if shape.wide else math.ceil(columns)
    spacing = shape.half / (columns - 2.5 + shape.reach)
    return columns, spacing, columns * spacing


def size(shape: Shape) -> str:
    return f"{lattice(shape)[0] ** 2 * shape.layers:,} particles"


def deflection(folder: Path) -> History:
    """Of the middle, away from the load, in m."""
    return [(t, -z) for t, z in column(folder, "mid")]


def peak(history: History) -> tuple[float, float]:
    """Time and value of the first maximum that no later value tops within a tenth of the run.

    The top is that of the parabola through the highest point and its neighbours.
    """
    window = (history[-1][0] - history[0][0]) / 10
    best = 0
    for k, (t, w) in enumerate(history):
        if w > history[best][1]:
            best = k
        elif t - history[best][0] > window and history[best][1] > 0.2 * max(v for _, v in history):
            break
    if best in (0, len(history) - 1):
        return history[best]
    (t0, w0), (t1, w1), (t2, w2) = history[best - 1 : best + 2]
    left, right = (w1 - w0) / (t1 - t0), (w2 - w1) / (t2 - t1)
    bend = (right - left) / (t2 - t0)
    time = (t0 + t1) / 2 - left / (2 * bend)
    return time, w1 - bend * (time - t1) ** 2 if bend else w1


def back(history: History, after: float) -> float | None:
    """When the middle first passes zero after a time [s]."""
    for (t0, w0), (t1, w1) in pairwise(history):
        if t0 > after and w0 > 0 >= w1:
            return t0 + (t1 - t0) * w0 / (w0 - w1)
    return None


def mean(history: History, start: float, end: float) -> float:
    """Mean over a stretch of time."""
    total = time = 0.0
    for (t0, w0), (t1, w1) in pairwise(history):
        a, b = max(t0, start), min(t1, end)
        if b > a:
            total += (b - a) * (w0 + w1) / 2
            time += b - a
    return total / time


def measures(history: History, *, residual: tuple[float, float] | None = None,
             swing: bool = False) -> Measures:  # fmt: skip
    """Peak, its time, and the first return (`swing`) or what stays between two times."""
    time, height = peak(history)
    found = {"peak": height, "peak_time": time}
    if swing and (when := back(history, time)):
        found["back"] = when
    if residual:
        found["stays"] = mean(history, *residual)
    return found


def run(title: str, shape: Shape, measure: Callable[[History], Measures] = measures,
        **scene: str | float) -> Run:  # fmt: skip
    """A run of Brisance: the deck of `write`, and the measures of its middle."""

    def inputs(folder: Path) -> None:
        write(folder, title, shape, **scene)

    def results(folder: Path) -> tuple[Measures, History]:
        history = deflection(folder)
        return measure(history), history

    kind = "wide layers" if shape.wide else "layers"
    return Run(f"Brisance, {shape.layers} {kind}", "brisance", size(shape), inputs, results)
