# SPDX-License-Identifier: MIT
"""The blast of `&load mass` for finite elements: Kingery-Bulmash, Friedlander, angles."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache

from post.blast import free_air, oblique_shares


@cache
def decay(peak: float, duration: float, impulse: float) -> float:
    """b of p (1 - t/T) exp(-b t/T) with an impulse; bisection."""
    wanted, low, high = impulse / (peak * duration), 1e-6, 1e6
    for _ in range(200):
        b = math.sqrt(low * high)
        if 1 / b - (1 - math.exp(-b)) / b**2 > wanted:
            low = b
        else:
            high = b
    return b


def until(peak: float, duration: float, b: float, t: float) -> float:
    """Impulse from the arrival until t after it."""
    s = min(max(t / duration, 0.0), 1.0)
    return (
        peak * duration * ((1 - s) * -math.exp(-b * s) / b + 1 / b - (1 - math.exp(-b * s)) / b**2)
    )


def load(
    mass: float, at: tuple[float, float, float], step: float
) -> Callable[[float, float, float], float]:
    """Mean pressure over `step` about a time on the plane z = 0 that looks up, by x, y, time."""

    @cache
    def place(x: float, y: float) -> tuple[float, tuple, tuple]:
        distance = math.dist((x, y, 0.0), at)
        wave = free_air(mass, distance)
        reflected, incident = oblique_shares(at[2] / distance)
        parts = (
            (reflected * wave.reflected_overpressure, wave.duration,
             decay(wave.reflected_overpressure, wave.duration, wave.reflected_impulse)),
            (incident * wave.incident_overpressure, wave.duration,
             decay(wave.incident_overpressure, wave.duration, wave.incident_impulse)),
        )  # fmt: skip
        return wave.arrival, *parts

    def mean(x: float, y: float, t: float) -> float:
        arrival, *parts = place(x, y)
        end, start = t + step / 2 - arrival, t - step / 2 - arrival
        return sum(until(*part, end) - until(*part, start) for part in parts) / step

    return mean
