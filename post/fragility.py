# SPDX-License-Identifier: MIT
"""Fragility: the chance that a limit is passed, over an intensity; lognormal curves."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

STARTS = (-3.0, -2.0, -1.0)  # logarithms of beta from which the likelihood is climbed


@dataclass(frozen=True)
class Curve:
    """P = Phi(ln(intensity/theta)/beta)."""

    theta: float  # the median intensity, in its unit
    beta: float  # scatter of its logarithm; not a number where it cannot be had
    low: float = math.nan  # 90 % limits of theta
    high: float = math.nan
    message: str = ""

    def chance(self, intensity) -> np.ndarray:
        """Chance that the limit is passed, any shape."""
        from scipy.stats import norm  # noqa: PLC0415 (slow to load)

        return norm.cdf(np.log(np.asarray(intensity, float) / self.theta) / self.beta)


def by_likelihood(intensity, passed) -> Curve:
    """Most likely curve of yes and no, shapes (n), and limits of theta by the profile.

    Where the largest no lies below the smallest yes there is no beta: then theta is the middle of
    the gap and the message says so (J. W. Baker, Earthquake Spectra 31 (2015) 579).
    """
    from scipy import optimize, stats  # noqa: PLC0415 (slow to load)

    x, yes = np.log(np.asarray(intensity, float)), np.asarray(passed, bool)
    if yes.all() or not yes.any():
        word = "all" if yes.all() else "none"
        return Curve(math.nan, math.nan, message=f"{word} of {len(x)} runs pass the limit")
    below, above = x[~yes].max(), x[yes].min()
    if below < above:
        theta = math.exp(0.5 * (below + above))
        text = f"no overlap of yes and no between {math.exp(below):.4g} and {math.exp(above):.4g}"
        return Curve(theta, math.nan, math.exp(below), math.exp(above), f"{text}: no beta")

    def unlikely(at: float, beta: float) -> float:
        z = (x - at) / math.exp(beta)
        return -float(np.where(yes, stats.norm.logcdf(z), stats.norm.logsf(z)).sum())

    tries = [
        optimize.minimize(lambda q: unlikely(*q), [np.median(x), s], method="Nelder-Mead")
        for s in STARTS
    ]
    best = min(tries, key=lambda t: t.fun)
    grid = best.x[0] + np.linspace(-0.5, 0.5, 401)
    profile = [
        optimize.minimize_scalar(
            lambda b, g=g: unlikely(g, b), bounds=(-6, 1), method="bounded"
        ).fun
        for g in grid
    ]
    inside = grid[np.array(profile) - best.fun < 0.5 * stats.chi2.ppf(0.9, 1)]
    ends = np.exp([inside.min(), inside.max()])
    return Curve(math.exp(best.x[0]), math.exp(best.x[1]), float(ends[0]), float(ends[1]))


def by_line(intensity, response, target: float) -> Curve:
    """A straight line of ln response over ln intensity, shapes (n): beta is its scatter over its
    slope. Sixteen runs are enough for it.
    """
    x, y = np.log(np.asarray(intensity, float)), np.log(np.asarray(response, float))
    slope, level = np.polyfit(x, y, 1)
    scatter = float(np.std(y - slope * x - level, ddof=2))
    return Curve(math.exp((math.log(target) - level) / slope), scatter / abs(slope))


def by_share(grid, share) -> Curve:
    """Theta and beta of a computed curve: its middle, and half of the way from 16 to 84 %."""
    x = np.log(np.asarray(grid, float))
    at = [float(np.interp(level, share, x)) for level in (0.5, 0.1587, 0.8413)]
    return Curve(math.exp(at[0]), 0.5 * (at[2] - at[1]))
