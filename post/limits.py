# SPDX-License-Identifier: MIT
"""Limits by few runs: where a response meets a target, by a secant; where an event sets in, by
halving a bracket of which both ends were run.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator
from dataclasses import dataclass, field

import numpy as np

MOVE = 1.5  # factor by which an end of a bracket is moved
MOST = 14  # times that a search asks
NEAR = 0.3  # of the step of a secant: how far points beside its end lie from it
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


# Searches are generators: each yields the unknowns that it asks for at once and is sent the answers
# in the same order, so that several go on side by side (`together`), one by one or in packs.
Search = Generator[list[float], list, Found]


def together(searches: dict[int, Search], ask: Callable[[list[tuple[int, float]]], list]) -> dict:
    """What searches find, by their numbers; all go on in step.

    `ask` answers pairs (number of a search, unknown) in their order: those that all searches want
    to know at the same time.
    """
    found: dict[int, Found] = {}
    wanted = {k: next(one) for k, one in searches.items()}
    while wanted:
        answers = iter(ask([(k, x) for k, points in wanted.items() for x in points]))
        for k, points in list(wanted.items()):
            try:
                wanted[k] = searches[k].send([next(answers) for _ in points])
            except StopIteration as end:
                found[k] = end.value
                del wanted[k]
    return found


def _alone(search: Search, response: Callable) -> Found:
    """What one search finds by a function of the unknown."""
    return together({0: search}, lambda pairs: [response(x) for _, x in pairs])[0]


def meet(response: Callable[[float], float], *options, **named) -> Found:
    """The unknown at which a positive response is the target; arguments as of `meeting`."""
    return _alone(meeting(*options, **named), response)


def meeting(
    target: float,
    guess: float,
    tolerance: float = 0.01,
    rising: bool = True,
    at_once: int = 0,
) -> Search:
    """Search for the unknown at which a positive response is the target, to a share of the target.

    A secant in the logarithms of both, its slope held within `SLOPES`, inside the bracket once
    there is one; where it would leave it, half of the bracket. With `at_once` points at a time the
    others lie to both sides of it, as far as it may be off. `rising`: whether the response grows
    with the unknown. Not found where a response is no positive number (all of those at once are
    none), or after `MOST` times.
    """
    sign = 1.0 if rising else -1.0
    found, known = Found(math.nan, math.nan, math.nan), []
    x, reach, inside = math.log(guess), math.log(MOVE), (-math.inf, math.inf)
    for _ in range(MOST):
        points = _fan(x, reach, inside, max(at_once, 1))
        responses = yield [math.exp(p) for p in points]
        found.runs += [(math.exp(p), y) for p, y in zip(points, responses, strict=True)]
        good = [(p, math.log(y / target)) for p, y in zip(points, responses, strict=True)
                if math.isfinite(y) and y > 0]  # fmt: skip
        if not good:
            found.message = f"no response at {math.exp(x):.6g}"
            return found
        known += good
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
        x, reach = best - miss / slope, NEAR * abs(miss / slope)
        if low and high:
            a, b = max(low)[0], min(high)[0]
            edge = 0.02 * (b - a)
            inside = a + edge, b - edge
            x = x if a + edge < x < b - edge else 0.5 * (a + b)
    found.message = f"not met within {len(found.runs)} runs"
    return found


def _fan(x: float, reach: float, inside: tuple[float, float], count: int) -> list[float]:
    """A place and others beside it, to both sides in turn and `reach` at the farthest; those that
    would lie on the ends of `inside` or beyond are left out.
    """
    sides = count // 2
    steps = [way * reach * k / sides for k in range(1, sides + 1) for way in (-1, 1)]
    return [x, *(x + s for s in steps[: count - 1] if inside[0] < x + s < inside[1])]


def _slope(known: list, sign: float) -> float:
    """Of ln response over ln unknown near the target."""
    near = sorted(known, key=lambda p: abs(p[1]))[:2]
    if len(near) < 2 or near[0][0] == near[1][0]:
        return sign * FIRST
    slope = sign * (near[1][1] - near[0][1]) / (near[1][0] - near[0][0])
    return sign * min(max(slope, SLOPES[0]), SLOPES[1])


def bracket(event: Callable[[float], bool | None], *options, **named) -> Found:
    """The unknown at which an event sets in; arguments as of `bracketing`."""
    return _alone(bracketing(*options, **named), event)


def bracketing(
    low: float,
    high: float,
    tolerance: float = 0.02,
    rising: bool = True,
    at_once: int = 0,
) -> Search:
    """Search for the unknown at which an event sets in (goes away, where not `rising`) as it grows.

    Both ends are run, and moved by factors of `MOVE` until it happens at one of them alone; then
    the bracket is halved in logarithms until its ends are within a share `tolerance`. With
    `at_once` points at a time both ends and so many between them are the first, and so many split
    a bracket after that. An answer None is neither yes nor no: the search ends there and says so,
    unless a yes and a no that lie nearer to the limit are known.
    """
    found = Found(math.nan, low, high)
    known: list[tuple[float, bool | None]] = []
    many = max(at_once, 1)
    points = np.geomspace(low, high, at_once + 2).tolist() if at_once else [low]
    while True:
        answers = yield points
        known += [(x, yes if yes is None else yes == rising)
                  for x, yes in zip(points, answers, strict=True)]  # fmt: skip
        found.runs += [(x, math.nan if yes is None else float(yes))
                       for x, yes in zip(points, answers, strict=True)]  # fmt: skip
        over = min((x for x, beyond in known if beyond), default=math.inf)
        under = max((x for x, beyond in known if beyond is False and x < over), default=0.0)
        if unclear := [x for x, beyond in known if beyond is None and under < x < over]:
            text = f"neither yes nor no at {unclear[0]:.6g}"
            found.message = f"{text}: the run failed or was too short"
            return found
        if not under:
            points = [over / MOVE**k for k in range(1, many + 1)]
        elif math.isinf(over):
            points = [high] if under < high else [under * MOVE**k for k in range(1, many + 1)]
        else:
            needed = math.ceil(math.log(over / under) / math.log1p(tolerance))
            pieces = min(many + 1, max(needed, 2))
            points = np.geomspace(under, over, pieces + 1)[1:-1].tolist()
        found.low, found.high = under or points[-1], over if math.isfinite(over) else points[-1]
        if under and over / under <= 1 + tolerance:
            found.value = math.sqrt(under * over)
            return found
        if len(found.runs) > 2 * MOST * many:
            last = found.runs[-1][0]
            found.message = f"not found within {2 * MOST * many} runs, the last at {last:.6g}"
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


def waves(count: int, packed: bool = False) -> list[list[int]]:
    """Order in which limits along a curve are searched: ends, middle, then the gaps at once.

    So guesses come from the same neighbours whatever goes on side by side. `packed`: the middle
    with the ends, as few and full runs are wanted then.
    """
    first = sorted({0, count - 1})
    second = sorted({(count - 1) // 2} - set(first))
    third = [k for k in range(count) if k not in first and k not in second]
    order = [first + second, third] if packed else [first, second, third]
    return [wave for wave in order if wave]


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
