# SPDX-License-Identifier: MIT
"""A skin for particles on a lattice: the faces that have no neighbour, bent with the body.

Every particle stands for a small box of its body. Faces between particles that still hold together
are left out, so an intact body gets a closed smooth skin, a crack shows two faces, and a particle
that flew off stays a small box. Positions of corners are the mean of what the particles around the
corner make of it, each with its own deformation gradient.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

TORN = 1.5, 0.3  # neighbours further apart or closer than this many spacings do not hold together
APART = 1.6  # spacings between layers that are no neighbours, such as those of bars
# corners of a face as signs along the two other axes, in an order that goes round it
RING = ((-1, -1), (1, -1), (1, 1), (-1, 1))


@dataclass(frozen=True)
class Skin:
    """Quadrilaterals: corners (m, 4, 3) [m], and the particle (m) that each belongs to."""

    corners: np.ndarray
    particle: np.ndarray


@dataclass(frozen=True)
class Lattice:
    """Places of the unloaded particles of a body, and who stands where."""

    grid: np.ndarray  # [nx + 2, ny + 2, nz + 2] number of the particle, or -1; an empty rim
    place: np.ndarray  # (n, 3) place in the grid
    step: np.ndarray  # (3) [m]
    low: np.ndarray  # (3) coordinate of the first layer [m]


def skin_of(
    points: np.ndarray,
    displacement: np.ndarray,
    spacing: float | np.ndarray,
    mirrors: tuple[bool, bool, bool] = (False, False, False),
    magnification: float = 1.0,
) -> Skin | None:
    """Skin of one body, displacements magnified.

    `points`, `displacement` (n, 3) [m]; `spacing` of the particles [m], one or along each axis (3);
    planes of symmetry through the origin are left open. None if the unloaded particles do not lie
    on a lattice.
    """
    if len(points) == 0:
        return None
    rest = points - displacement
    lattice = find_lattice(rest, spacing)
    if lattice is None:
        return None
    edges, held = edges_of(points, lattice)
    if magnification != 1.0:
        points = rest + magnification * displacement
        edges, _ = edges_of(points, lattice, held)
    ends = [cut and on_plane(lattice, d) for d, cut in enumerate(mirrors)]
    corners, owner = [], []
    for axis in range(3):
        for side in (-1, 1):
            bare = ~held[axis][(side + 1) // 2]
            if ends[axis] and side < 0:
                bare = bare & (lattice.place[:, axis] > 1)
            rows = np.flatnonzero(bare)
            corners.append(_face_corners(points, edges, lattice, rows, (axis, side)))
            owner.append(rows)
    return _close(Skin(np.concatenate(corners), np.concatenate(owner)), lattice, ends)


def find_lattice(rest: np.ndarray, spacing: float | np.ndarray) -> Lattice | None:
    """Lattice of the unloaded particles `rest` (n, 3) [m]; None if two of them share a place.

    `spacing` [m]: one, or along each axis (3). Parts of a body that stand apart, such as bars, have
    empty places between them.
    """
    sides = np.broadcast_to(spacing, 3)
    low, step = np.empty(3), np.empty(3)
    place = np.empty(rest.shape, int)
    for d in range(3):
        starts = _levels(rest[:, d], sides[d])
        gaps = np.diff(starts)
        beside = gaps < APART * sides[d]
        low[d], step[d] = starts[0], _layer_step(starts, sides[d])
        jumps = np.maximum(np.rint(gaps / step[d]).astype(int), np.where(beside, 1, 2))
        number = 1 + np.concatenate([[0], np.cumsum(jumps)])
        place[:, d] = number[np.searchsorted(starts, rest[:, d], side="right") - 1]
    shape = place.max(axis=0) + 2
    if np.prod(shape.astype(float)) > max(50 * len(rest), 1e6):
        return None
    grid = np.full(shape, -1)
    grid[tuple(place.T)] = np.arange(len(rest))
    if np.count_nonzero(grid >= 0) < len(rest):
        return None
    return Lattice(grid, place, step, low)


def on_plane(lattice: Lattice, axis: int) -> bool:
    """Whether the first layer along an axis lies beside the plane through the origin."""
    return bool(abs(lattice.low[axis] - lattice.step[axis] / 2) < 0.25 * lattice.step[axis])


def _levels(places: np.ndarray, spacing: float) -> np.ndarray:
    """First coordinate of each layer of particles along an axis."""
    places = np.sort(places)
    return places[np.concatenate([[True], np.diff(places) > 0.4 * spacing])]


def _layer_step(starts: np.ndarray, spacing: float) -> float:
    """Distance of neighbouring layers along an axis [m]: the spacing where there are none."""
    gaps = np.diff(starts)
    gaps = gaps[gaps < APART * spacing]
    return float(np.median(gaps)) if len(gaps) else spacing


def neighbour(lattice: Lattice, axis: int, side: int) -> np.ndarray:
    """Neighbour of each particle in a direction, -1 where there is none."""
    place = lattice.place.copy()
    place[:, axis] += side
    return lattice.grid[tuple(place.T)]


def edges_of(points: np.ndarray, lattice: Lattice, held: list | None = None):
    """Edges of the box of each particle, and which of its six neighbours hold on to it.

    Returns edges (n, 3 axes, 3) [m] and held[axis][0 low, 1 high] (n).
    """
    found = [] if held is None else held
    edges = np.zeros((len(points), 3, 3))
    for axis in range(3):
        total, count = np.zeros((len(points), 3)), np.zeros(len(points))
        pair = []
        for number, side in enumerate((-1, 1)):
            other = neighbour(lattice, axis, side)
            step = side * (points[other] - points)
            if held is None:
                length = np.linalg.norm(step, axis=1) / lattice.step[axis]
                keeps = (other >= 0) & (length < TORN[0]) & (length > TORN[1])
                pair.append(keeps)
            else:
                keeps = held[axis][number]
            total += np.where(keeps[:, None], step, 0)
            count += keeps
        edges[:, axis, axis] = lattice.step[axis]
        some = count > 0
        edges[some, axis] = total[some] / count[some, None]
        if held is None:
            found.append(pair)
    return edges, found


def _face_corners(points, edges, lattice: Lattice, rows: np.ndarray, face: tuple) -> np.ndarray:
    """Corners (rows, 4, 3) of one face of the boxes of some particles."""
    axis, side = face
    others = [d for d in range(3) if d != axis]
    corners = np.empty((len(rows), 4, 3))
    for c, signs in enumerate(RING):
        sign = np.zeros(3, int)
        sign[axis], sign[others[0]], sign[others[1]] = side, *signs
        corners[:, c] = _corner(points, edges, lattice, rows, sign)
    return corners


def _corner(points, edges, lattice: Lattice, rows: np.ndarray, sign: np.ndarray) -> np.ndarray:
    """One corner (rows, 3): the mean over the particles around it that agree on where it is."""
    own = points[rows] + 0.5 * np.einsum("a,nad->nd", sign, edges[rows])
    total, count = own.copy(), np.ones(len(rows))
    reach = 0.6 * lattice.step.max()
    for number in range(1, 8):
        shift = np.array([number & 1, number >> 1 & 1, number >> 2 & 1]) * sign
        other = lattice.grid[tuple((lattice.place[rows] + shift).T)]
        seen_from_other = np.where(shift != 0, -sign, sign)
        guess = points[other] + 0.5 * np.einsum("a,nad->nd", seen_from_other, edges[other])
        agrees = (other >= 0) & (np.linalg.norm(guess - own, axis=1) < reach)
        total += np.where(agrees[:, None], guess, 0)
        count += agrees
    return total / count[:, None]


def _close(skin: Skin, lattice: Lattice, ends: list) -> Skin:
    """Put corners that belong to a plane of symmetry exactly on it, so that images meet."""
    for d in range(3):
        if ends[d]:
            values = skin.corners[..., d]
            values[np.abs(values) < 0.25 * lattice.step[d]] = 0.0
    return skin
