# SPDX-License-Identifier: MIT
"""Curves of tests and hand calculation to lay beside results, each with source and range.

Kingery-Bulmash in air and on the ground: `blast.free_air`, `blast.surface`, tables
`data/kb_free_air.csv` and `data/kb_surface.csv`, which the loads of the program agree with
(tests/python/test_loads.py). Constants of the others: `data/reference_curves.toml`.
"""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

DATA = Path(__file__).parent / "data" / "reference_curves.toml"


@cache
def constants(name: str) -> dict:
    """Constants, source and range of one curve; KeyError for an unknown one."""
    with DATA.open("rb") as file:
        return tomllib.load(file)[name]


@dataclass(frozen=True)
class PlateDeflection:
    """Nurick and Martin's line for one plate."""

    phi: float  # dimensionless impulse
    deflection: float  # [m], permanent
    scatter: float  # [m], most tests lie within
    in_range: bool  # of the tests behind the line


@dataclass(frozen=True)
class ClampedPlate:
    """A plate held all round: a rectangle by its `sides` (2) [m], or a disc by its `radius` [m]."""

    thickness: float  # [m]
    density: float  # [kg/m3]
    yield_stress: float  # static [Pa]
    sides: tuple[float, float] | None = None
    radius: float | None = None


def nurick_martin(impulse: float, plate: ClampedPlate) -> PlateDeflection:
    """Permanent deflection of a clamped plate under an impulse [N s] spread over all of it.

    ValueError where it has neither sides nor radius or a number is not positive.
    """
    size = plate.sides or (plate.radius or 0.0,)
    values = [impulse, plate.thickness, plate.density, plate.yield_stress, *size]
    if not all(math.isfinite(v) and v > 0 for v in values):
        raise ValueError("Nurick-Martin: all numbers must be positive, with sides or a radius")
    table = constants("nurick_martin")
    strength = plate.thickness**2 * math.sqrt(plate.density * plate.yield_stress)
    if plate.sides is not None:
        phi, line = impulse / (2 * math.sqrt(size[0] * size[1]) * strength), table["square"]
    else:
        phi, line = impulse / (math.pi * size[0] * strength), table["circle"]
    ratio = line["slope"] * phi + line["offset"]
    low, high = table["deflection_over_thickness"]
    scatter = table["scatter"] * plate.thickness
    return PlateDeflection(phi, ratio * plate.thickness, scatter, low <= ratio <= high)


def recht_ipson(velocity, limit: float, mass: float, plug: float = 0.0) -> np.ndarray:
    """Residual velocity [m/s] of a projectile of `mass` [kg] that pushes out a `plug` [kg].

    `velocity` [m/s] of any shape; `limit` [m/s] the ballistic limit. 0 below the limit.
    """
    share = mass / (mass + plug)
    return lambert_jonas(velocity, limit, share, constants("recht_ipson")["exponent"])


def lambert_jonas(velocity, limit: float, a: float, p: float) -> np.ndarray:
    """v_r = a (v^p - limit^p)^(1/p) [m/s], 0 below the limit; `velocity` [m/s] of any shape."""
    v = np.maximum(np.asarray(velocity, float) / limit, 1.0)
    return a * limit * (v**p - 1) ** (1 / p)


GRAIN, INCH, FOOT = 6.479891e-5, 0.0254, 0.3048  # [kg], [m], [m]


def thor(velocity, mass: float, area: float, thickness: float, angle: float = 0.0) -> np.ndarray:
    """Residual velocity [m/s] of a compact steel fragment behind a plate of mild steel, by THOR.

    `velocity` [m/s] of any shape; `mass` [kg] and mean presented `area` [m2] of the fragment,
    `thickness` [m], `angle` [rad] from the normal. 0 where it does not pass. ValueError for numbers
    that are not positive, or an angle of a right angle and more.
    """
    v = np.asarray(velocity, float)
    lost = _thor_factor(mass, area, thickness, angle) * (v / FOOT) ** _thor_power() * FOOT
    return np.maximum(v - lost, 0.0)


def thor_limit(mass: float, area: float, thickness: float, angle: float = 0.0) -> float:
    """Velocity [m/s] at which `thor` leaves nothing; arguments and errors are the same."""
    return _thor_factor(mass, area, thickness, angle) ** (1 / (1 - _thor_power())) * FOOT


def _thor_power() -> float:
    return constants("thor_mild_steel")["velocity"]


def _thor_factor(mass: float, area: float, thickness: float, angle: float) -> float:
    """What the velocity, to its power, is multiplied by, in ft/s, grains and inches."""
    if min(mass, area, thickness) <= 0 or not 0 <= angle < math.pi / 2:
        raise ValueError("THOR: mass, area and thickness must be positive, the angle below 90 deg")
    c = constants("thor_mild_steel")
    volume = thickness / INCH * area / INCH**2
    return (10 ** c["log"] * volume ** c["volume"] * (mass / GRAIN) ** c["mass"]
            / math.cos(angle) ** c["secant"])  # fmt: skip


@dataclass(frozen=True)
class LimitFit:
    """Lambert-Jonas through shots."""

    a: float
    p: float
    limit: float  # [m/s]
    rms: float  # of the residual velocities [m/s]


def fit_limit(velocity, residual, stopped=(), parameters: int = 3, a: float = 1.0) -> LimitFit:
    """Lambert-Jonas through shots that went through, all (n) [m/s]; `stopped` bound it from below.

    `parameters`: 1 the limit alone (with `a` and p = 2), 2 with a, 3 with p too. A distance to the
    curve is measured across it, as it is vertical at the limit. ValueError with fewer shots than
    parameters.
    """
    from scipy.optimize import least_squares  # noqa: PLC0415 (slow to load)

    v, r, below = (np.asarray(x, float) for x in (velocity, residual, stopped))
    if len(v) < parameters or len(v) != len(r):
        raise ValueError(f"a fit of {parameters} parameters needs as many shots that went through")

    def unpack(x):
        return x[0], (x[1] if parameters > 1 else a), (x[2] if parameters > 2 else 2.0)

    def distance(x):
        limit, one, p = unpack(x)
        up = lambert_jonas(v, limit, one, p) - r
        along = ((r / one) ** p + limit**p) ** (1 / p) - v
        near = np.sign(up) * np.abs(up * along) / np.sqrt(up**2 + along**2 + 1e-12)
        return np.concatenate([near, np.maximum(below - limit, 0)])

    top = float(v.min())
    low, high = [0.2 * top, 0.3, 1.2], [1.05 * top, 1.001, 4.0]
    tries = [
        least_squares(distance, [start, 0.9, 2.2][:parameters],
                      bounds=(low[:parameters], high[:parameters]))
        for start in np.linspace(0.7, 0.999, 7) * top
    ]  # fmt: skip
    limit, one, p = unpack(min(tries, key=lambda t: t.cost).x)
    rms = float(np.sqrt(np.mean((lambert_jonas(v, limit, one, p) - r) ** 2)))
    return LimitFit(float(one), float(p), float(limit), rms)
