# SPDX-License-Identifier: MIT
"""An interval for a result from runs with three or four spacings, and bands for histories.

Both differences count, each as what is left of an error of first order; a factor by what the three
look like. How often such intervals hold the truth is measured: docs/manual/certify.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

FLOOR = 0.005  # of the natural scale: nothing narrower is promised
COARSE = 0.5  # of the natural scale: a wider interval promises nothing
ZERO = 1e-3  # of the natural scale: a smaller result is none
FACTORS = {"settling": 1.0, "oscillating": 2.0, "monotone": 2.0, "not converging": 3.0}
TWO_LEVELS = 3.0  # factor where there are two spacings alone
WIDE = 1.5  # factor of the band of a history
ORDERS = -6.0, 12.0  # between which an order is sought


@dataclass(frozen=True)
class Interval:
    """What is known of one result; in its unit."""

    value: float  # with the finest spacing
    half: float  # half width of the interval about it
    best: float  # estimate for vanishing spacing
    order: float  # observed; not a number where there is none
    verdict: str
    promised: bool

    @property
    def low(self) -> float:
        """Lower end."""
        return self.value - self.half

    @property
    def high(self) -> float:
        """Upper end."""
        return self.value + self.half


def observed_order(h, f) -> float:
    """Order of convergence of three results `f`, finest first, with spacings `h`; not a number
    where they do not go one way. By bisection (P. J. Roache, J. Fluids Eng. 116 (1994) 405).
    """
    e21, e32 = f[1] - f[0], f[2] - f[1]
    if e21 == 0 or e32 == 0 or e21 * e32 < 0:
        return math.nan
    r21, r32, ratio = h[1] / h[0], h[2] / h[1], e32 / e21

    def miss(p: float) -> float:
        return r21**p * (r32**p - 1) / (r21**p - 1) - ratio

    low, high = ORDERS
    if miss(low) > 0:
        return low
    if miss(high) < 0:
        return high
    for _ in range(80):
        middle = 0.5 * (low + high)
        middle = 1e-9 if abs(middle) < 1e-9 else middle
        low, high = (low, middle) if miss(middle) > 0 else (middle, high)
    return 0.5 * (low + high)


def first_order_rest(h, f) -> float:
    """The larger of both differences, each as what is left of an error of first order."""
    e21, e32 = abs(f[1] - f[0]), abs(f[2] - f[1])
    r21, r32 = h[1] / h[0], h[2] / h[1]
    return max(e21 / (r21 - 1), e32 / (r32 - 1) / r21)


def fit_scatter(h, f) -> float:
    """Standard deviation of four levels or more about the best of the fits f0 + a h^p with p of 0.5
    to 2, f0 + a h, f0 + a h^2 and f0 + a h + b h^2, each with the weights 1/h (L. Eca, M. Hoekstra,
    J. Comput. Phys. 262 (2014) 104); 0 below four.
    """
    if len(h) < 4:
        return 0.0
    h, f = np.asarray(h, float), np.asarray(f, float)
    weight = np.sqrt(len(h) / h / np.sum(1 / h))

    def deviation(*powers: float, more: int = 0) -> float:
        columns = np.stack([np.ones_like(h), *(h**p for p in powers)], axis=1)
        best = np.linalg.lstsq(columns * weight[:, None], f * weight, rcond=None)[0]
        rest = weight * (columns @ best - f)
        return math.sqrt(float(rest @ rest) / (len(h) - columns.shape[1] - more))

    free = min(deviation(p, more=1) for p in np.linspace(0.5, 2.0, 61))
    return min(free, deviation(1.0), deviation(2.0), deviation(1.0, 2.0))


def look_of(h, f, little: float) -> str:
    """What three results look like, a name of `FACTORS`; differences to `little` do not count."""
    p, e21, e32 = observed_order(h, f), abs(f[1] - f[0]), abs(f[2] - f[1])
    if math.isnan(p):
        return "settling" if e21 <= e32 else "oscillating"
    if p >= 0.5 or max(e21, e32) <= little:
        return "monotone"
    return "not converging"


def interval(h, f, scale: float) -> Interval:
    """Interval of a result from two to four levels, finest first: the rule of the finest three, and
    with four the scatter about a fit through all besides.

    `h` spacings, `f` results, `scale` the natural scale of the result. ValueError for other numbers
    of levels or spacings that do not grow.
    """
    if len(h) != len(f) or len(h) not in (2, 3, 4) or any(b <= a for a, b in pairwise(h)):
        raise ValueError("an interval needs two to four levels, the finest first")
    scale = abs(scale)
    if len(h) == 4:
        one = interval(h[:3], f[:3], scale)
        half = one.half + fit_scatter(h, f)
        if half > COARSE * scale:
            return replace(one, half=half, verdict="too coarse", promised=False)
        return replace(one, half=half)
    if len(h) == 2:
        rest = abs(f[1] - f[0]) / (h[1] / h[0] - 1)
        half = max(TWO_LEVELS * rest, FLOOR * scale)
        return Interval(f[0], half, f[0], math.nan, "two levels only", False)
    p, look = observed_order(h, f), look_of(h, f, 2 * FLOOR * scale)
    half = max(FACTORS[look] * first_order_rest(h, f), FLOOR * scale)
    best = f[0]
    if look == "monotone" and not math.isnan(p):
        best -= 0.5 * (f[1] - f[0]) / ((h[1] / h[0]) ** min(max(p, 0.5), 1.0) - 1)
    if half > COARSE * scale:
        return Interval(f[0], half, best, p, "too coarse", False)
    return Interval(f[0], half, best, p, _words(f, scale, (look, p)), look != "not converging")


def _words(f, scale: float, seen: tuple[str, float]) -> str:
    look, p = seen
    if max(abs(f[1] - f[0]), abs(f[2] - f[1])) < FLOOR * scale:
        return "converged"
    if look == "monotone":
        return f"order {p:.1f}, taken as 1" if p > 1 else f"order {p:.1f}"
    return {"settling": "oscillates, settling", "oscillating": "oscillates"}.get(look, look)


@dataclass(frozen=True)
class Band:
    """A history with a band about it, shapes (n)."""

    time: np.ndarray  # [s]
    value: np.ndarray
    low: np.ndarray
    high: np.ndarray
    arrival: tuple[float, float]  # [s] and half of its interval


def arrival_of(time: np.ndarray, values: np.ndarray) -> float:
    """Time at which a history first has half of its largest change [s]."""
    change = np.abs(values - values[0])
    level = 0.5 * float(change.max())
    i = int(np.argmax(change >= level))
    if i == 0 or level == 0:
        return float(time[i])
    part = (level - change[i - 1]) / (change[i] - change[i - 1])
    return float(time[i - 1] + part * (time[i] - time[i - 1]))


def band_of(h, curves: list[tuple[np.ndarray, np.ndarray]], points: int = 400) -> Band:
    """Band about the finest of three histories (times, values), finest first.

    They are laid over each other by their arrivals; the band is `WIDE` times the rest of first
    order, the widest within 1 % of the length, and smeared by the interval of the arrival. Before
    the earliest arrival nothing is smeared, and no edge leaves the range that the three have.
    """
    end = min(float(t[-1]) for t, _ in curves)
    time = np.linspace(float(curves[0][0][0]), end, points)
    at = [arrival_of(t, v) for t, v in curves]
    late = max(FACTORS[look_of(h, at, 0.0)] * first_order_rest(h, at), 0.0)
    late = min(late, 0.25 * (time[-1] - time[0]))
    rows = [np.interp(time + (a - at[0]), t, v) for a, (t, v) in zip(at, curves, strict=True)]
    e21, e32 = np.abs(rows[1] - rows[0]), np.abs(rows[2] - rows[1])
    r21, r32 = h[1] / h[0], h[2] / h[1]
    width = WIDE * np.maximum(e21 / (r21 - 1), e32 / (r32 - 1) / r21)
    width = _widest(width, max(1, round(0.01 * points)))
    smear = int(np.ceil(late / (time[1] - time[0])))
    low, high = -_widest(width - rows[0], smear), _widest(rows[0] + width, smear)
    least = min(float(v.min()) for _, v in curves)
    most = max(float(v.max()) for _, v in curves)
    margin = float(width.max())
    bottom = least if least == curves[0][1][0] else least - margin  # it starts at its least: a rise
    top = most if most == curves[0][1][0] else most + margin
    low, high = np.clip(low, bottom, None), np.clip(high, None, top)
    early = time < at[0] - late
    low[early], high[early] = np.minimum(rows[0], low)[early], np.maximum(rows[0], high)[early]
    return Band(time, rows[0], low, high, (at[0], late))


def _widest(values: np.ndarray, reach: int) -> np.ndarray:
    """Largest value within `reach` samples on both sides."""
    padded = np.pad(values, reach, mode="edge")
    return np.lib.stride_tricks.sliding_window_view(padded, 2 * reach + 1).max(axis=1)
