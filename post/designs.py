# SPDX-License-Identifier: MIT
"""Points of a study: values, ranges and distributions of its parameters, put together."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field

import numpy as np

Value = float | str
DESIGNS = ("grid", "list", "lhs", "sobol", "one_at_a_time")
RANDOM = ("lhs", "sobol")
LAWS = {  # numbers of each distribution, in the words of the study file
    "uniform": "low, high",
    "loguniform": "low, high",
    "normal": "mean, standard deviation",
    "lognormal": "median, coefficient of variation",
    "triangular": "low, most likely, high",
    "weibull": "scale, shape",
}


@dataclass(frozen=True)
class Parameter:
    """One parameter: a list of values, or a distribution; numbers in SI units."""

    name: str
    unit: str = "-"  # SI
    factor: float = 1.0  # SI units in one unit of the file
    values: tuple[Value, ...] = ()
    law: str = ""  # of `LAWS`, or ''
    numbers: tuple[float, ...] = ()  # of the law
    sets: tuple[tuple[str, str], ...] = ()  # key of the deck, formula of its value
    line: int = 0

    @property
    def middle(self) -> Value:
        """The median of a distribution, or the middle one of the values."""
        if self.law:
            return float(self.quantile(np.array(0.5)))
        return self.values[len(self.values) // 2]

    def quantile(self, share: np.ndarray) -> np.ndarray:
        """Value below which a share of the distribution lies, any shape."""
        from scipy import stats  # noqa: PLC0415 (slow to load)

        a, b, *rest = self.numbers
        if self.law == "uniform":
            return a + (b - a) * share
        if self.law == "loguniform":
            return a * (b / a) ** share
        if self.law == "normal":
            return a + b * stats.norm.ppf(share)
        if self.law == "lognormal":
            return a * np.exp(math.sqrt(math.log1p(b * b)) * stats.norm.ppf(share))
        if self.law == "triangular":
            return stats.triang.ppf(share, (b - a) / (rest[0] - a), a, rest[0] - a)
        return a * (-np.log1p(-share)) ** (1 / b)  # weibull


@dataclass(frozen=True)
class Design:
    """How the points of a study are chosen."""

    kind: str  # of `DESIGNS`
    runs: int = 0
    seed: int = 1
    notes: list[str] = field(default_factory=list)


def points_of(parameters: list[Parameter], design: Design) -> list[dict[str, Value]]:
    """The points of a design, each a value for every parameter."""
    names = [one.name for one in parameters]
    if design.kind == "grid":
        return [dict(zip(names, row, strict=True))
                for row in itertools.product(*(one.values for one in parameters))]  # fmt: skip
    if design.kind == "list":
        longest = max(len(one.values) for one in parameters)
        rows = [one.values * (longest if len(one.values) == 1 else 1) for one in parameters]
        return [dict(zip(names, row, strict=True)) for row in zip(*rows, strict=True)]
    if design.kind == "one_at_a_time":
        middle = {one.name: one.middle for one in parameters}
        rows = [middle]
        for one in parameters:
            rows += [middle | {one.name: v} for v in one.values if v != middle[one.name]]
        return rows
    return _random_points(parameters, design)


def _random_points(parameters: list[Parameter], design: Design) -> list[dict[str, Value]]:
    from scipy.stats import qmc  # noqa: PLC0415 (slow to load)

    maker = qmc.Sobol if design.kind == "sobol" else qmc.LatinHypercube
    shares = maker(len(parameters), rng=design.seed).random(design.runs)
    shares = np.clip(shares, 1e-9, 1 - 1e-9)
    found: list[dict[str, Value]] = [{} for _ in range(design.runs)]
    for column, one in zip(shares.T, parameters, strict=True):
        if one.law:
            values = one.quantile(column).tolist()
        else:  # a choice between the values
            place = np.minimum((column * len(one.values)).astype(int), len(one.values) - 1)
            values = [one.values[k] for k in place]
        for row, value in zip(found, values, strict=True):
            row[one.name] = value
    return found
