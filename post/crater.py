# SPDX-License-Identifier: MIT
"""What a face of a plate or slab has lost: the crater where it was struck, the spall behind.

A tester brushes loose matter off, lays a straight edge over the face and measures depth, diameter
and volume of what is missing. So a place has lost what no longer hangs together with the largest
piece of the body, counted from the unloaded face inwards until the first particle that stays.
Cracks narrower than three particles are no craters.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from post.perforation import Plate, openings_in
from post.raster import Raster, mirrored, opened, regions


@dataclass(frozen=True)
class FaceLoss:
    """The widest crater of one face, of the whole scene; zeros where nothing is missing."""

    side: int  # -1: the face at the low end of the normal, 1: at the high one
    area: float  # of the opening in the outermost layer, where the body is now [m2]
    depth: float  # from the unloaded face to the deepest place [m]
    volume: float  # [m3]
    through: bool  # it goes through the body: a hole

    @property
    def diameter(self) -> float:
        """Of the circle of the same area [m]."""
        return math.sqrt(4 * self.area / math.pi)


def face_loss(plate: Plate, side: int, brushed: bool = False) -> FaceLoss:
    """What the face at the low (-1) or the high (1) end of the normal has lost.

    `brushed`: particles that are broken (`perforation.BROKEN`) have been brushed away as well, and
    what then hangs on nothing.
    """
    keeps = plate.sound if brushed else plate.stays
    place = plate.lattice.place - 1
    i, j = plate.plane
    order = [i, j, plate.normal]
    shape = tuple(place[:, order].max(axis=0) + 1)
    filled, present = np.zeros(shape, bool), np.zeros(shape, bool)
    filled[tuple(place[:, order].T)] = True
    present[tuple(place[keeps][:, order].T)] = True
    lost = filled & ~present
    if side > 0:
        lost = lost[:, :, ::-1]
    layers = np.logical_and.accumulate(lost, axis=2).sum(axis=2)
    step = plate.lattice.step
    raster = Raster(plate.lattice.low[[i, j]] - step[[i, j]] / 2, float(step[i]), shape[:2])
    _, layers = mirrored(raster, layers, plate.mirrors)
    edge = np.pad(layers > 0, 1, mode="edge")  # what reaches the rim is as wide as it is
    open_ = opened(edge)[1:-1, 1:-1]
    name = regions(open_)
    if not open_.any():
        return FaceLoss(side, 0.0, 0.0, 0.0, False)
    widest = name == int(np.argmax(np.bincount(name[open_])))
    cell = float(step[i] * step[j])
    outer = place[:, plate.normal] == (shape[2] - 1 if side > 0 else 0)
    seen = openings_in(plate, keeps & outer)
    area = seen[0].area if seen else float(widest.sum()) * cell  # none: it reaches the rim
    depth = layers[widest] * float(step[plate.normal])
    through = bool((layers[widest] == shape[2]).any())
    return FaceLoss(side, area, float(depth.max()), float(depth.sum()) * cell, through)
