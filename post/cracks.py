# SPDX-License-Identifier: MIT
"""Cracks on a face, counted by a stated rule."""

from __future__ import annotations

import numpy as np

from post.face import FaceMap

LIMIT = 0.5  # damage from which a place is cracked
WHOLE = 0.95  # share of a face from which it is damaged as a whole: there are no cracks to count


def damaged_share(one: FaceMap, limit: float = LIMIT) -> float:
    """Share of a face on which the damage exceeds `limit`, from 0 to 1."""
    known = one.values[np.isfinite(one.values)]
    return float((known > limit).mean()) if known.size else 0.0


def crossings(one: FaceMap, radius: float, centre=(0.0, 0.0), limit: float = LIMIT) -> int:
    """How many cracks a circle on a face crosses.

    The circle [m] is followed in steps of half a cell; a crack is an arc on which the damage
    exceeds `limit`. Arcs that are less than a cell and a half apart count as one. 0 for a circle
    that leaves the face.
    """
    number = max(int(np.ceil(4 * np.pi * radius / float(one.step.min()))), 8)
    angle = 2 * np.pi * np.arange(number) / number
    places = np.asarray(centre) + radius * np.column_stack([np.cos(angle), np.sin(angle)])
    cell = np.floor((places - one.low) / one.step).astype(int)
    if (cell < 0).any() or (cell >= one.values.shape).any():
        return 0
    cracked = np.nan_to_num(one.values[tuple(cell.T)]) > limit
    for gap in (1, 2, 3):  # samples without damage between two with
        near = [np.roll(cracked, -k) for k in range(1, gap + 1)]
        cracked = cracked | (_any_before(cracked, gap) & np.any(near, axis=0))
    return int(np.count_nonzero(cracked & ~np.roll(cracked, 1)))


def _any_before(cracked: np.ndarray, gap: int) -> np.ndarray:
    return np.any([np.roll(cracked, k) for k in range(1, gap + 1)], axis=0)


def radial_cracks(one: FaceMap, radii, centre=(0.0, 0.0), limit: float = LIMIT) -> np.ndarray:
    """Cracks that cross circles of several radii [m] on a face, shape (n)."""
    return np.array([crossings(one, float(radius), centre, limit) for radius in radii])


def rings_of(one: FaceMap, count: int = 9) -> np.ndarray:
    """Radii [m] of circles about the middle of the coordinates, from 30 to 80 % of the way to the
    nearest edge of a face.
    """
    high = one.low + one.step * one.values.shape
    reach = float(min(np.abs(one.low).min(), np.abs(high).min()))
    return np.linspace(0.3, 0.8, count) * reach


def crossings_along(one: FaceMap, angle: float, reach: tuple[float, float], limit=LIMIT) -> int:
    """How many cracks a ray from the origin of a face crosses, between two radii [m].

    The ray at `angle` [rad] is followed in steps of half a cell; the rule is that of `crossings`.
    """
    step = 0.5 * float(one.step.min())
    radius = np.arange(reach[0], reach[1], step)
    places = radius[:, None] * np.array([np.cos(angle), np.sin(angle)])
    cell = np.floor((places - one.low) / one.step).astype(int)
    inside = ((cell >= 0) & (cell < one.values.shape)).all(axis=1)
    cracked = np.nan_to_num(one.values[tuple(cell[inside].T)]) > limit
    edges = np.flatnonzero(np.diff(np.concatenate([[0], cracked.astype(int), [0]])))
    begins, ends = edges[0::2], edges[1::2]
    return int(len(begins) - np.count_nonzero(begins[1:] - ends[:-1] <= 3))


def circumferential_cracks(one: FaceMap, rays: int = 72, limit: float = LIMIT) -> np.ndarray:
    """Cracks that rays from the origin cross, from 10 to 95 % of the way to the nearest edge.

    Shape (rays). A ring that goes all round is crossed by every ray; a radial crack lies along
    few of them: so the median tells the number of rings.
    """
    reach = float(rings_of(one)[0]) / 0.3
    angles = 2 * np.pi * (np.arange(rays) + 0.5) / rays
    return np.array([crossings_along(one, a, (0.1 * reach, 0.95 * reach), limit) for a in angles])
