# SPDX-License-Identifier: MIT
"""Which particles of a body still hold together, and into how many pieces it broke."""

from __future__ import annotations

import numpy as np

from post.surface import Lattice, neighbour


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


def largest_piece(lattice: Lattice, held: list, sound: np.ndarray) -> np.ndarray:
    """Whether each particle belongs to the largest piece of a body, shape (n).

    `held` as of `surface.edges_of`; particles that are not `sound` (n) hold nothing.
    """
    ones, others = [], []
    for axis in range(3):
        other = neighbour(lattice, axis, 1)
        rows = np.flatnonzero(held[axis][1] & sound)
        rows = rows[sound[other[rows]]]
        ones.append(rows)
        others.append(other[rows])
    name = pieces(len(sound), np.concatenate(ones), np.concatenate(others))
    size = np.bincount(name[sound], minlength=len(sound))
    return sound & (name == np.argmax(size))
