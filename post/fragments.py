# SPDX-License-Identifier: MIT
"""Which particles of a body still hold together, and into which pieces it broke."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from post.errors import USAGE, PostError
from post.reader import Frame, Run
from post.surface import Lattice, edges_of, find_lattice, neighbour
from post.tables import Table
from post.units import show


def pieces(count: int, one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Piece of each of `count` items that the pairs `one`-`other` (m) join; shape (count).

    A piece has the number of its lowest item. Every item takes the lowest name among those it is
    joined to, until none changes.
    """
    name = np.arange(count)
    while len(one):
        low = np.minimum(name[one], name[other])
        np.minimum.at(name, name[one], low)
        np.minimum.at(name, name[other], low)
        while True:
            above = name[name]
            if np.array_equal(above, name):
                break
            name = above
        open_ = name[one] != name[other]
        one, other = one[open_], other[open_]
    return name


def hanging_together(lattice: Lattice, held: list, sound: np.ndarray) -> np.ndarray:
    """Piece of each particle of a body, shape (n): the number of its lowest particle.

    `held` as of `surface.edges_of`; particles that are not `sound` (n) hold nothing.
    """
    ones, others = [], []
    for axis in range(3):
        other = neighbour(lattice, axis, 1)
        rows = np.flatnonzero(held[axis][1] & sound)
        rows = rows[sound[other[rows]]]
        ones.append(rows)
        others.append(other[rows])
    return pieces(len(sound), np.concatenate(ones), np.concatenate(others))


def largest_piece(lattice: Lattice, held: list, sound: np.ndarray) -> np.ndarray:
    """Whether each particle belongs to the largest piece of a body, shape (n); of a body that was
    several parts at the start, as the bars of a mesh, to the largest piece of its part.

    `held` as of `surface.edges_of`; particles that are not `sound` (n) hold nothing.
    """
    return _largest_of_parts(lattice, hanging_together(lattice, held, sound), sound)


def _largest_of_parts(lattice: Lattice, name: np.ndarray, sound: np.ndarray) -> np.ndarray:
    """Whether each particle belongs to the largest of the pieces `name` (n) of its part at the
    start: of what hangs together on the lattice of the unloaded body.
    """
    held = [[neighbour(lattice, axis, side) >= 0 for side in (-1, 1)] for axis in range(3)]
    part = hanging_together(lattice, held, np.ones(len(sound), bool))
    size = np.bincount(name[sound], minlength=len(sound))
    rows = np.flatnonzero(sound)
    rows = rows[np.lexsort((name[rows], -size[name[rows]], part[rows]))]
    parts, first = np.unique(part[rows], return_index=True)
    best = np.full(len(sound), -1)
    best[parts] = name[rows[first]]
    return sound & (name == best[part])


@dataclass(frozen=True)
class Fragment:
    """A piece of a body that hangs together, of the whole scene."""

    particles: int  # of the modelled part
    mass: float  # [kg], with what lies beyond planes of symmetry that it touches
    size: float  # [m] diameter of a sphere of its volume
    velocity: np.ndarray  # (3) of its mass centre [m/s], without parts that mirror images cancel
    middle: np.ndarray  # (3) its mass centre [m]
    low: np.ndarray  # (3) corner of the box around its particles [m], of the modelled part
    high: np.ndarray  # (3)
    copies: int  # how many of it there are in the whole scene
    main: bool = True  # the largest piece of the body, or of a part that stood apart at the start

    @property
    def speed(self) -> float:
        """Magnitude of the velocity [m/s]."""
        return float(np.linalg.norm(self.velocity))


def find_fragments(
    run: Run, frame: Frame, name: str, failed: float | None = None
) -> list[Fragment]:
    """The pieces into which a body has broken, the heaviest first.

    Two neighbours on the lattice of the unloaded body hang together while they are 0.3 to 1.5
    spacings apart (`surface.TORN`); particles with a damage of `failed` and more hold nothing, and
    each is a piece of its own. A piece that touches a plane of symmetry is one with its image.
    PostError for a body that is not there or on no lattice.
    """
    number = {body.id: body.number for body in run.deck.bodies()}.get(name)
    solid = frame.solid("displacement", "body", "mass", "density", "velocity", "damage")
    own = np.flatnonzero((solid.field["body"] == number) & solid.known)
    if number is None or not len(own):
        raise PostError(f"{run.job}: there is no body '{name}' in this dump", USAGE)
    step = next(body.step for body in run.deck.bodies() if body.id == name)
    points = solid.points[own]
    rest = points - solid.field["displacement"][own]
    lattice = find_lattice(rest, step)
    if lattice is None:
        raise PostError(f"body '{name}': its particles do not lie on a lattice")
    sound = np.ones(len(own), bool)
    if failed is not None:
        sound = solid.field["damage"][own] < failed
    names = hanging_together(lattice, edges_of(points, lattice)[1], sound)
    field = {key: solid.field[key][own].astype(float) for key in ("mass", "density", "velocity")}
    field["main"] = _largest_of_parts(lattice, names, sound)
    return _measure_pieces(names, points, rest, field, (run.deck.mirrors, step))


def _measure_pieces(names, points, rest, field: dict, scene: tuple) -> list[Fragment]:
    mirrors, step = scene
    kinds, piece = np.unique(names, return_inverse=True)
    count = np.bincount(piece)
    mass = np.bincount(piece, field["mass"])
    volume = np.bincount(piece, field["mass"] / field["density"])
    sums = [[np.bincount(piece, field["mass"] * v[:, d]) / mass for d in range(3)]
            for v in (points, field["velocity"])]  # fmt: skip
    middle, velocity = (np.transpose(rows) for rows in sums)
    low, high = np.full((len(kinds), 3), np.inf), np.full((len(kinds), 3), -np.inf)
    np.minimum.at(low, piece, points - np.asarray(step) / 2)
    np.maximum.at(high, piece, points + np.asarray(step) / 2)
    joined, copies = np.ones(len(kinds)), np.ones(len(kinds), int)
    for d, cut in enumerate(mirrors):
        if cut:
            nearest = np.full(len(kinds), np.inf)
            np.minimum.at(nearest, piece, np.abs(rest[:, d]))
            touches = nearest < 0.75 * step[d]
            joined[touches] *= 2
            copies[~touches] *= 2
            middle[touches, d] = velocity[touches, d] = 0.0
            low[touches, d] = -high[touches, d]
    main = np.bincount(piece, field["main"]) > 0
    found = [
        Fragment(
            int(n), float(m * j), float((6 * v * j / np.pi) ** (1 / 3)), u, x, a, b, int(c), bool(o)
        )
        for n, m, j, v, u, x, a, b, c, o in zip(
            count, mass, joined, volume, velocity, middle, low, high, copies, main, strict=True
        )
    ]
    return sorted(found, key=lambda one: -one.mass)


def fragment_table(found: list[Fragment], name: str, most: int = 8) -> Table:
    """The heaviest pieces one by one, the others together."""
    rows = []
    for place, one in enumerate(found[:most]):
        what = "largest piece" if place == 0 else f"piece {place + 1}"
        several = f", {one.copies} of it" if one.copies > 1 else ""
        mass, size = show(one.mass, "kg"), show(one.size, "m")
        rows.append((what + several, mass, size, show(one.speed, "m/s")))
    rest = found[most:]
    if rest:
        number, mass = sum(f.copies for f in rest), sum(f.copies * f.mass for f in rest)
        top = max(f.speed for f in rest)
        sizes = f"{show(min(f.size for f in rest), 'm')} to {show(max(f.size for f in rest), 'm')}"
        rows.append((f"{number} more", show(mass, "kg"), sizes, f"up to {show(top, 'm/s')}"))
    note = (
        "Neighbours on the lattice of the unloaded body hang together while they are 0.3 to 1.5 "
        "spacings apart. Size: diameter of a sphere of equal volume. Velocity of the mass centre."
    )
    return Table(f"Pieces of {name}", ("piece", "mass", "size", "velocity"), rows, note)
