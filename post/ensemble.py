# SPDX-License-Identifier: MIT
"""What chance does to a scene that breaks: members that differ by a small jitter of the particles.

A jitter is not the error of the spacing: members are run with two spacings, and both count.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

JITTER = 1e-3  # spacings by which particles are off their places
SHARE = 0.9  # of the cases that an interval shall hold
APART = 3.0  # factor of what is left of an error of first order, as with two levels


@dataclass(frozen=True)
class Scatter:
    """A result of an ensemble, in its unit."""

    mean: float  # with the user's spacing
    deviation: float  # of one member
    mean_half: float  # half width of the interval of the mean: spacing and number of members
    one_half: float  # half width about the mean in which one test more would lie: chance alone
    members: int


def member_sets(seed: int) -> tuple[str, str]:
    """Overrides of one member."""
    return f"solid.jitter={JITTER:g}", f"solid.seed={seed}"


def scatter_of(fine, middle, ratio: float) -> Scatter:
    """Scatter of a result from members with the user's spacing (n) and with one `ratio` times as
    wide (m). Members that have no such result are left out; ValueError below two of each.
    """
    from scipy.stats import t as student  # noqa: PLC0415 (slow to load)

    one, two = (np.asarray(x, float) for x in (fine, middle))
    one, two = one[np.isfinite(one)], two[np.isfinite(two)]
    if min(len(one), len(two)) < 2:
        raise ValueError("an ensemble needs two members or more with each spacing")
    mean, deviation, count = float(one.mean()), float(one.std(ddof=1)), len(one)
    wide = float(student.ppf(0.5 + SHARE / 2, count - 1)) * deviation
    apart = APART * abs(float(two.mean()) - mean) / (ratio - 1)
    half = apart + wide / math.sqrt(count)
    return Scatter(mean, deviation, half, wide * math.sqrt(1 + 1 / count), count)
