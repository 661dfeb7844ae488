# SPDX-License-Identifier: MIT
"""Short texts beside points of curves, put where they cover nothing."""

from __future__ import annotations

import numpy as np
from matplotlib.text import Annotation
from matplotlib.transforms import Bbox

NOTE = "note"  # mark of the texts that `settle` may move
# places of a text about its point: offset in points, alignment across and up
PLACES = [
    (dx * far, dy * far, across, up)
    for far in (1, 2.4, 4, 6, 8)
    for dx, dy, across, up in (
        (7, 0, "left", "center"),
        (-7, 0, "right", "center"),
        (5, 8, "left", "bottom"),
        (-5, 8, "right", "bottom"),
        (5, -8, "left", "top"),
        (-5, -8, "right", "top"),
        (0, 9, "center", "bottom"),
        (0, -9, "center", "top"),
    )
]


def note(axis, text: str, at: tuple[float, float], **options) -> Annotation:
    """A text beside a point, on a pale ground; `settle` finds its place when all is drawn."""
    box = {"boxstyle": "round,pad=0.15", "fc": "white", "ec": "none", "alpha": 0.85}
    place = {"xytext": (7, 0), "textcoords": "offset points", "va": "center", "gid": NOTE}
    return axis.annotate(text, at, fontsize=8.5, zorder=5, bbox=box, **place, **options)


def settle(figure) -> None:
    """Move each note to the first place inside its panel that covers no other note, and there to
    the one that covers least of the curves.
    """
    notes = [(axis, text) for axis in figure.axes for text in axis.texts if text.get_gid() == NOTE]
    if not notes:
        return
    figure.draw_without_rendering()
    taken: list[tuple[object, Bbox]] = []
    for axis, text in notes:
        curves = [c for other in figure.axes if _same_panel(axis, other) for c in _curves(other)]
        best = None
        for order, place in enumerate(PLACES):
            _put(text, place)
            box = text.get_window_extent().padded(2)
            frame = axis.get_window_extent()
            outside = _outside(box, frame)
            covered = sum(box.overlaps(other) for panel, other in taken if _same_panel(axis, panel))
            hidden = sum(_inside(box, curve) for curve in curves)
            cost = (outside > 0, covered, hidden > 0, outside, min(hidden, 20), order)
            if best is None or cost < best[0]:
                best = (cost, place)
        _put(text, best[1])
        taken.append((axis, text.get_window_extent().padded(2)))


def _put(text: Annotation, place: tuple) -> None:
    dx, dy, across, up = place
    text.set_position((dx, dy))
    text.set_ha(across)
    text.set_va(up)


def _same_panel(one, other) -> bool:
    """Whether two axes lie on each other, as those with a second scale do."""
    return np.allclose(one.get_window_extent().extents, other.get_window_extent().extents)


def _curves(axis) -> list[np.ndarray]:
    """Points of the curves of an axis in pixels, close together."""
    found = []
    for line in axis.lines:
        points = line.get_transform().transform(np.column_stack(line.get_data(orig=False)))
        points = points[np.isfinite(points).all(axis=1)]
        if len(points) > 1:
            length = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
            at = np.linspace(0, length[-1], 600)
            points = np.column_stack([np.interp(at, length, points[:, d]) for d in range(2)])
        found.append(points)
    return found


def _inside(box: Bbox, points: np.ndarray) -> int:
    """How many points lie in a box."""
    x, y = points.T if len(points) else (np.zeros(0), np.zeros(0))
    return int(((x > box.x0) & (x < box.x1) & (y > box.y0) & (y < box.y1)).sum())


def _outside(box: Bbox, frame: Bbox) -> float:
    """By how many pixels a box reaches over a frame."""
    over = (frame.x0 - box.x0, box.x1 - frame.x1, frame.y0 - box.y0, box.y1 - frame.y1)
    return float(np.maximum(over, 0).sum())
