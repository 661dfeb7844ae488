# SPDX-License-Identifier: MIT
"""Limits by few runs: where a response meets a target, by a secant; where an event sets in, by
halving a bracket of which both ends were run.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

MOVE = 1.5  # factor by which an end of a bracket is moved
MOST = 14  # runs for one limit
SLOPES = 0.3, 5.0  # of ln response over ln unknown, magnitude: what a secant may have
FIRST = 1.1  # slope that is assumed at first: deflections go about so with pressure


@dataclass
class Found:
    """A limit and the runs that it took, in the order in which they were asked for."""

    value: float  # not a number where it was not found
    low: float  # the bracket: the last two unknowns between which the target lies
    high: float
    runs: list[tuple[float, float]] = field(default_factory=list)  # unknown, response
    message: str = ""


def meet(
    response: Callable[[float], float],
    target: float,
    guess: float,
    tolerance: float = 0.01,
    rising: bool = True,
) -> Found:
    """The unknown at which a positive response is the target, to a share of the target.

    A secant in the logarithms of both, its slope held within `SLOPES`, inside the bracket once
    there is one; where it would leave it, half of the bracket. `rising`: whether the response
    grows with the unknown. Not found where a response is no positive number, or after `MOST` runs.
    """
    sign = 1.0 if rising else -1.0
    found, known = Found(math.nan, math.nan, math.nan), []
    x = math.log(guess)
    for _ in range(MOST):
        y = response(math.exp(x))
        found.runs.append((math.exp(x), y))
        if not (math.isfinite(y) and y > 0):
            found.message = f"no response at {math.exp(x):.6g}"
            return found
        known.append((x, math.log(y / target)))
        low = [p for p in known if sign * p[1] < 0]
        high = [p for p in known if sign * p[1] >= 0]
        found.low = math.exp(max(low)[0]) if low else math.nan
        found.high = math.exp(min(high)[0]) if high else math.nan
        best, miss = min(known, key=lambda p: abs(p[1]))
        slope = _slope(known, sign)
        narrow = low and high and min(high)[0] - max(low)[0] <= 0.1 * tolerance
        if abs(miss) <= tolerance or narrow:
            found.value = math.exp(best - miss / slope)
            return found
        x = best - miss / slope
        if low and high:
            a, b = max(low)[0], min(high)[0]
            edge = 0.02 * (b - a)
            x = x if a + edge < x < b - edge else 0.5 * (a + b)
    found.message = f"not met within {MOST} runs"
    return found


def _slope(known: list, sign: float) -> float:
    """Of ln response over ln unknown near the target."""
    near = sorted(known, key=lambda p: abs(p[1]))[:2]
    if len(near) < 2 or near[0][0] == near[1][0]:
        return sign * FIRST
    slope = sign * (near[1][1] - near[0][1]) / (near[1][0] - near[0][0])
    return sign * min(max(slope, SLOPES[0]), SLOPES[1])


def bracket(
    event: Callable[[float], bool | None],
    low: float,
    high: float,
    tolerance: float = 0.02,
    rising: bool = True,
) -> Found:
    """The unknown at which an event sets in (goes away, where not `rising`) as the unknown grows.

    Both ends are run, and moved by factors of `MOVE` until it happens at one of them alone; then
    the bracket is halved in logarithms until its ends are within a share `tolerance`. An answer
    None is neither yes nor no: the search ends there and says so.
    """
    found = Found(math.nan, low, high)

    def beyond(x: float) -> bool:
        """Whether x lies beyond the limit. LookupError where the answer is neither."""
        yes = event(x)
        found.runs.append((x, math.nan if yes is None else float(yes)))
        if yes is None:
            raise LookupError(f"neither yes nor no at {x:.6g}: the run failed or was too short")
        if len(found.runs) > 2 * MOST:
            raise LookupError(f"not found within {2 * MOST} runs, the last at {x:.6g}")
        return yes == rising

    try:
        if beyond(low):
            high, low = low, low / MOVE
            while beyond(low):
                high, low = low, low / MOVE
        else:
            while not beyond(high):
                low, high = high, high * MOVE
        while high / low > 1 + tolerance:
            middle = math.sqrt(low * high)
            low, high = (low, middle) if beyond(middle) else (middle, high)
        found.value = math.sqrt(low * high)
    except LookupError as error:
        found.message = str(error)
    found.low, found.high = low, high
    return found


def guess_between(at: float, known: list[tuple[float, float]], generic: float) -> float:
    """A first guess at one place from limits at others, straight lines in logarithms.

    `known` are pairs (place, limit) in any order; outside of them the nearest slope goes on.
    """
    if not known:
        return generic
    rows = np.log(sorted(known))
    if len(rows) == 1:
        return float(math.exp(rows[0, 1]))
    x = math.log(at)
    k = int(np.clip(np.searchsorted(rows[:, 0], x), 1, len(rows) - 1))
    (x0, y0), (x1, y1) = rows[k - 1], rows[k]
    return float(math.exp(y0 + (y1 - y0) * (x - x0) / (x1 - x0)))


def waves(count: int) -> list[list[int]]:
    """Order in which limits along a curve are searched: ends, middle, then the gaps at once.

    So guesses come from the same neighbours whatever goes on side by side.
    """
    first = sorted({0, count - 1})
    second = sorted({(count - 1) // 2} - set(first))
    third = [k for k in range(count) if k not in first and k not in second]
    return [wave for wave in (first, second, third) if wave]


@dataclass(frozen=True)
class Hyperbola:
    """(P/p0 - 1)(I/i0 - 1) = c through points of a P-I diagram."""

    p0: float  # [Pa], quasi-static asymptote
    i0: float  # [Pa s], impulsive asymptote
    c: float
    rms: float  # of the factor by which loads must be scaled to lie on it

    def pressure(self, impulse) -> np.ndarray:
        """Pressures on the curve [Pa] for impulses above i0 [Pa s], any shape."""
        return self.p0 * (1 + self.c / (np.asarray(impulse, float) / self.i0 - 1))


def fit_hyperbola(pressure, impulse) -> Hyperbola:
    """Hyperbola through limits (n) by least squares of the factor along rays from the origin: in
    the pressures alone the upright branch would decide everything. ValueError below three points.
    """
    from scipy.optimize import least_squares  # noqa: PLC0415 (slow to load)

    p, i = np.asarray(pressure, float), np.asarray(impulse, float)
    if len(p) < 3 or len(p) != len(i):
        raise ValueError("a hyperbola needs three points or more")

    def miss(q):
        """Logarithm of the factor that brings each point to the curve."""
        p0, i0, c = np.exp(q)
        a, b = p / p0, i / i0
        return -np.log((a + b + np.sqrt((a - b) ** 2 + 4 * a * b * c)) / (2 * a * b))

    starts = [
        (math.log(p.min() * a), math.log(i.min() * 0.98), math.log(c))
        for a in (0.8, 0.9, 0.97)
        for c in (0.05, 0.2, 0.6)
    ]
    best = min((least_squares(miss, s, x_scale=0.1) for s in starts), key=lambda t: t.cost)
    p0, i0, c = np.exp(best.x)
    return Hyperbola(float(p0), float(i0), float(c), float(np.sqrt(np.mean(miss(best.x) ** 2))))
