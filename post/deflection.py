# SPDX-License-Identifier: MIT
"""How far a plate was pushed out of its plane: largest, at the end, and what will remain."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from post.deck import AXES
from post.errors import PostError
from post.gauges import Gauge, list_gauges
from post.perforation import load_plate
from post.reader import Run
from post.tables import Table
from post.units import show

SWING = 0.05  # of the largest displacement: smaller turns are no swing


@dataclass(frozen=True)
class Deflection:
    """One history of a displacement [m, s]."""

    peak: float  # with its sign
    peak_time: float
    end: float
    residual: float  # not a number before the body has swung back and forth
    growing: bool  # the largest value is the last one


def measure_deflection(time: np.ndarray, move: np.ndarray) -> Deflection:
    """Measure a history, shapes (n). ValueError if it is empty or not finite.

    The residual is the middle of the last two turning points after the peak, as the plate swings
    about the shape that it will keep; a history that ends before two is not measured.
    """
    if not len(move) or len(time) != len(move) or not np.isfinite(move).all():
        raise ValueError("a history of displacements must have finite values")
    top = int(np.argmax(np.abs(move)))
    turns = _turning_points(move[top:], SWING * abs(float(move[top])))
    residual = 0.5 * (turns[-1] + turns[-2]) if len(turns) > 1 else math.nan
    growing = top == len(move) - 1 and len(move) > 1
    return Deflection(float(move[top]), float(time[top]), float(move[-1]), residual, growing)


def _turning_points(values: np.ndarray, least: float) -> list[float]:
    """Values at which a history turns by more than `least`, after its first value."""
    turns, low, high, way = [], values[0], values[0], 0
    for value in values[1:]:
        low, high = min(low, value), max(high, value)
        if way >= 0 and high - value > least:  # fell from the last high
            turns += [float(high)] if way else []
            way, low = -1, value
        elif way <= 0 and value - low > least:
            turns += [float(low)] if way else []
            way, high = 1, value
    return turns


def displacement_table(run: Run) -> Table:
    """Gauges of displacement, then the middle and the farthest point of each plate by its dumps."""
    rows, gauges = [], [g for g in list_gauges(run) if g.quantity.startswith("displacement")]
    for gauge in gauges:
        history = run.gauges
        rows.append(_row(f"{gauge.id} ({gauge.quantity[-1]})", history.time, history[gauge.column]))
    for body in run.deck.bodies():
        if body.shape == "box":
            rows += _rows_of_plate(run, body, gauges)
    heads = ("what", "largest", "at", "at the end", "residual")
    note = (
        "Residual: middle of the last two turning points, a dash where the body has not swung back "
        "and forth. Middle and farthest particle of a body: at the times of the dumps alone, so "
        "they may have gone farther; those that came loose by the end are left out, and a middle "
        "that has a gauge."
    )
    return Table("Displacements", heads, [row for row in rows if row], note)


def _row(name: str, time: np.ndarray, move: np.ndarray) -> tuple[str, ...] | None:
    try:
        found = measure_deflection(time, move)
    except ValueError:
        return None
    late = " (still growing)" if found.growing else ""
    times = show(found.peak_time, "s") + late
    return (name, show(found.peak, "m"), times, show(found.end, "m"), show(found.residual, "m"))


def _rows_of_plate(run: Run, body, gauges: list[Gauge]) -> list:
    """Middle and farthest particle of a body along its normal, over the dumps."""
    frames = [frame for frame in run.frames if frame.solid_path]
    try:
        plate = load_plate(run, frames[-1], body.id)
    except (PostError, IndexError):
        return []
    centre = (body.low + body.high) / 2
    centre[list(run.deck.mirrors)] = 0.0
    rest = plate.points - plate.field["displacement"]
    nearest = int(np.argmin(((rest - centre) ** 2).sum(axis=1)))
    middle, farthest = [], []
    for frame in frames:
        field = frame.solid("displacement", "body").field
        away = field["displacement"][field["body"] == body.number, plate.normal]
        middle.append(away[nearest] if plate.stays[nearest] else math.nan)
        kept = away[plate.stays]
        farthest.append(kept[np.argmax(np.abs(kept))])
    time = np.array([frame.time for frame in frames])
    rows = [_row(f"{body.id}, farthest", time, np.array(farthest))]
    if not any(_measures(gauge, body, plate.normal, rest[nearest]) for gauge in gauges):
        rows.insert(0, _row(f"{body.id}, middle", time, np.array(middle)))
    return rows


def _measures(gauge: Gauge, body, normal: int, place: np.ndarray) -> bool:
    """Whether a gauge records the motion of a place (3) [m] of a plate along its normal: it does so
    to half of the thickness across, and to a particle along the plate.
    """
    if gauge.body != body.id or gauge.at is None or gauge.quantity[-1] != AXES[normal]:
        return False
    away = np.abs(gauge.at - place)
    away[normal] = max(away[normal] - (body.high[normal] - body.low[normal]) / 2, 0.0)
    return bool((away <= body.step).all())
