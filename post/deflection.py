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

AT_REST = 0.01  # of the largest displacement: less of a range is no motion
SWING = 0.3  # of the range after the peak: smaller turns belong to quicker modes
MOST_PERIODS = 4  # over which the ringing is averaged, the last ones


@dataclass(frozen=True)
class Deflection:
    """One history of a displacement [m, s]."""

    peak: float  # with its sign
    peak_time: float
    end: float
    permanent: float  # the permanent set; not a number while it cannot be told
    spread: float  # half of the range of the ringing about it
    growing: bool  # the largest value is the last one


def measure_deflection(time: np.ndarray, move: np.ndarray) -> Deflection:
    """Measure a history, shapes (n). ValueError if it is empty or not finite."""
    if not len(move) or len(time) != len(move) or not np.isfinite(move).all():
        raise ValueError("a history of displacements must have finite values")
    top = int(np.argmax(np.abs(move)))
    permanent, spread = permanent_set(time, move)
    growing = top == len(move) - 1 and len(move) > 1
    end = float(move[-1])
    return Deflection(float(move[top]), float(time[top]), end, permanent, spread, growing)


def permanent_set(time: np.ndarray, move: np.ndarray) -> tuple[float, float]:
    """The displacement that stays when the elastic ringing has died away, and half of the range of
    that ringing; shapes (n), both not a number where the history does not tell.

    A history that swings after its peak: the mean over time of the last whole periods, at most
    `MOST_PERIODS`, from a turning point to one of the same kind; the mean of the last two turning
    points where there are two alone. Turns below `SWING` of the range in the second half after the
    peak do not count. One that has come to rest, within `AT_REST` of the peak for at least as long
    as it took to move there: the mean of that stretch.
    """
    size = np.abs(move)
    top = int(np.argmax(size))
    rest = _rest(time, move, AT_REST * size[top])
    if rest is not None:
        return rest
    late = move[top + (len(move) - top) // 2 :]
    turns = _turning_points(move[top:], max(SWING * np.ptp(late), AT_REST * size[top]))
    if len(turns) < 2:
        return math.nan, math.nan
    turns = top + np.array(turns)
    half = 0.5 * abs(float(move[turns[-1]] - move[turns[-2]]))
    if len(turns) == 2:
        return 0.5 * float(move[turns[0]] + move[turns[1]]), half
    count = min((len(turns) - 1) // 2, MOST_PERIODS)
    part = slice(turns[-1 - 2 * count], turns[-1] + 1)
    t, u = time[part], move[part]
    return float(np.trapezoid(u, t) / (t[-1] - t[0])), half


def _rest(time: np.ndarray, move: np.ndarray, least: float) -> tuple[float, float] | None:
    """Mean and half range of the stretch at the end in which nothing moves by more than `least`."""
    low = np.minimum.accumulate(move[::-1])[::-1]
    high = np.maximum.accumulate(move[::-1])[::-1]
    first = int(np.argmax(high - low <= least))
    way = np.flatnonzero(np.abs(move - move[0]) > 0.1 * np.abs(move - move[0]).max())
    if not len(way) or len(move) - first < 3:
        return (0.0, 0.0) if not np.any(move) else None
    rise = time[first] - time[max(int(way[0]) - 1, 0)]
    if time[-1] - time[first] < rise:
        return None
    return float(move[first:].mean()), 0.5 * float(high[first] - low[first])


def _turning_points(values: np.ndarray, least: float) -> list[int]:
    """Places at which a history turns by more than `least`, after its first value."""
    turns, low, high, way = [], 0, 0, 0
    for place, value in enumerate(values[1:], 1):
        low = place if value < values[low] else low
        high = place if value > values[high] else high
        if way >= 0 and values[high] - value > least:  # fell from the last high
            turns += [high] if way else []
            way, low = -1, place
        elif way <= 0 and value - values[low] > least:
            turns += [low] if way else []
            way, high = 1, place
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
    heads = ("what", "largest", "at", "at the end", "permanent set", "ringing")
    note = (
        "Permanent set: mean of the last whole swings, or of the rest that it came to, with half "
        "of the range of that ringing; a dash where the history ends before. Middle and farthest "
        "particle of a body: at the times of the dumps alone, so they may have gone farther; those "
        "that came loose by the end are left out, and a middle that has a gauge."
    )
    return Table("Displacements", heads, [row for row in rows if row], note)


def _row(name: str, time: np.ndarray, move: np.ndarray) -> tuple[str, ...] | None:
    try:
        found = measure_deflection(time, move)
    except ValueError:
        return None
    late = " (still growing)" if found.growing else ""
    times = show(found.peak_time, "s") + late
    ringing = "–" if math.isnan(found.spread) else f"± {show(found.spread, 'm')}"
    ends = show(found.end, "m"), show(found.permanent, "m"), ringing
    return (name, show(found.peak, "m"), times, *ends)


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
