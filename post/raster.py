# SPDX-License-Identifier: MIT
"""The shadow of a plate on a grid of pixels, and the openings in it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from post.fragments import pieces

FINE = 4  # pixels along one spacing
MOST = 40  # openings that are looked at


@dataclass(frozen=True)
class Raster:
    """Pixels over the face of a plate; arrays are [pixels along the 1st axis, along the 2nd]."""

    low: np.ndarray  # (2) corner [m]
    pixel: float  # side [m]
    shape: tuple[int, int]

    def shadow(self, centre: np.ndarray, half: np.ndarray) -> np.ndarray:
        """Pixels whose centre lies in one of the rectangles centre +- half, both (n, 2) [m]."""
        ends = []
        for d in range(2):
            first = np.ceil((centre[:, d] - half[:, d] - self.low[d]) / self.pixel - 0.5)
            last = np.floor((centre[:, d] + half[:, d] - self.low[d]) / self.pixel - 0.5) + 1
            ends.append([np.clip(e, 0, self.shape[d]).astype(int) for e in (first, last)])
        size = self.shape[0] + 1, self.shape[1] + 1
        count = np.zeros(size[0] * size[1])
        for a, b, sign in ((0, 0, 1), (0, 1, -1), (1, 0, -1), (1, 1, 1)):
            index = ends[0][a] * size[1] + ends[1][b]
            count += sign * np.bincount(index, minlength=count.size)
        return count.reshape(size).cumsum(0).cumsum(1)[:-1, :-1] > 0.5


@dataclass(frozen=True)
class Opening:
    """A region of pixels."""

    area: float  # [m2]
    middle: np.ndarray  # (2) its centre of area [m]
    pixels: np.ndarray  # as the raster

    @property
    def diameter(self) -> float:
        """Of the circle with the same area [m]."""
        return math.sqrt(4 * self.area / math.pi)


def openings(raster: Raster, dark: np.ndarray) -> list[Opening]:
    """Regions without shadow that do not reach the rim of the raster, the largest first.

    Gaps narrower than three pixels are not opened, regions smaller than a particle left out, and
    at most `MOST` are given.
    """
    light = opened(~dark)
    name = regions(light)
    rim = np.concatenate([name[0], name[-1], name[:, 0], name[:, -1]])
    size = np.bincount(name[light], minlength=1)
    size[np.unique(rim[rim >= 0])] = 0
    found = np.flatnonzero(size >= FINE**2)
    order = found[np.argsort(-size[found], kind="stable")][:MOST]
    return [region_of(raster, name == number) for number in order]


def region_of(raster: Raster, pixels: np.ndarray) -> Opening:
    """Area and middle of some pixels."""
    places = np.argwhere(pixels)
    middle = (
        raster.low + (places.mean(0) + 0.5) * raster.pixel if len(places) else np.full(2, np.nan)
    )
    return Opening(len(places) * raster.pixel**2, middle, pixels)


def regions(light: np.ndarray) -> np.ndarray:
    """Name of the region of each pixel, those that share a side being joined; -1 in the dark."""
    number = np.cumsum(light.ravel()).reshape(light.shape) - 1
    pairs = [
        (number[:-1][light[:-1] & light[1:]], number[1:][light[:-1] & light[1:]]),
        (number[:, :-1][light[:, :-1] & light[:, 1:]], number[:, 1:][light[:, :-1] & light[:, 1:]]),
    ]
    one, other = (np.concatenate([pair[i] for pair in pairs]) for i in range(2))
    found = np.full(light.shape, -1)
    found[light] = pieces(int(light.sum()), one, other)
    return found


def mirrored(raster: Raster, values: np.ndarray, mirrors: tuple[bool, bool]):
    """The whole raster and its picture, from the part beside the planes of symmetry.

    A row whose middle lies on a plane is its own image.
    """
    low = raster.low.copy()
    for d, cut in enumerate(mirrors):
        if cut:
            image = np.flip(values, d)
            if abs(raster.low[d] + 0.5 * raster.pixel) < 0.25 * raster.pixel:
                image = image.take(range(image.shape[d] - 1), d)
            low[d] = (0.5 * (values.shape[d] - image.shape[d]) - values.shape[d]) * raster.pixel
            values = np.concatenate([image, values], d)
    return Raster(low, raster.pixel, values.shape), values


def opened(light: np.ndarray) -> np.ndarray:
    """Light without what is narrower than three pixels: shrunk by one pixel and grown again."""
    return _grown(~_grown(~light))


def _grown(mask: np.ndarray) -> np.ndarray:
    """A mask and all pixels beside it, corners included."""
    for axis in range(2):
        wide = mask.copy()
        near, far = [slice(None)] * 2, [slice(None)] * 2
        near[axis], far[axis] = slice(1, None), slice(None, -1)
        wide[tuple(near)] |= mask[tuple(far)]
        wide[tuple(far)] |= mask[tuple(near)]
        mask = wide
    return mask
