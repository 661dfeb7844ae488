# SPDX-License-Identifier: MIT
"""Units for reading and showing: values are SI inside, prefixes are for people only."""

from __future__ import annotations

import math

import numpy as np

PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"))
PREFIXED = {"Pa", "s", "m", "J", "W", "N", "N s", "Pa s"}  # m/s and kg stay as they are
NOTHING = 1e-12  # in SI units, whatever they are: what is shown below it is rounding
KNOWN = {"Pa", "s", "m", "g", "J", "N", "m/s", "N s", "kg", "Hz", "m/s2", "kg/m3", "J/kg"}


def factor_of(unit: str) -> float:
    """How many SI units a unit with a prefix is; ValueError for an unknown unit.

    Products such as 'kPa ms' are allowed: every part may carry a prefix.
    """
    unit = unit.strip()
    if unit in ("", "-"):
        return 1.0
    if unit == "%":
        return 0.01
    if unit in KNOWN:
        return 1e-3 if unit == "g" else 1.0
    parts = unit.split()
    if len(parts) > 1:
        return math.prod(factor_of(part) for part in parts)
    for size, prefix in (*PREFIXES, (1e-6, "u")):
        if prefix and unit.startswith(prefix) and unit[len(prefix) :] in KNOWN - {"kg", "kg/m3"}:
            return size * factor_of(unit[len(prefix) :])
    raise ValueError(f"unknown unit '{unit}'")


def base_of(unit: str) -> str:
    """The SI unit behind a unit with prefixes; ValueError for an unknown unit."""
    factor_of(unit)
    parts = []
    for part in unit.split():
        bare = part if part in KNOWN else part[1:] or part
        parts.append({"g": "kg", "%": "-"}.get(bare, bare))
    return " ".join(parts) or "-"


def scale_for(values, unit: str) -> tuple[float, str]:
    """Factor and name of the unit in which values are best shown: between 1 and 1000 at most.

    Values divided by the factor are in the named unit. Lengths stay in mm below a metre, times
    in ms down to 0.02 ms: the units in which blast and plates are thought of.
    """
    finite = np.abs(np.asarray(values, float))
    finite = finite[np.isfinite(finite)]
    top = float(finite.max()) if finite.size else 0.0
    if unit not in PREFIXED or top == 0.0:
        return 1.0, unit
    if (unit == "m" and 1e-5 <= top < 1.0) or (unit == "s" and 2e-5 <= top < 1.0):
        return 1e-3, "m" + unit
    for size, prefix in PREFIXES:
        if top >= size * (1 - 1e-9):
            return size, prefix + unit
    return PREFIXES[-1][0], PREFIXES[-1][1] + unit


def show_point(point) -> str:
    """A place with the unit in which its largest coordinate is best read: '(0, 12.5) mm'."""
    factor, name = scale_for(point, "m")
    return f"({', '.join(f'{x / factor:.6g}' for x in point)}) {name}"


def show(value: float, unit: str, digits: int = 3) -> str:
    """A value with its unit for people, e.g. '12.2 MPa'; a dash where there is none, 0 where there
    is rounding alone.
    """
    if value is None or not math.isfinite(value):
        return "–"
    value = 0.0 if abs(value) < NOTHING else value
    factor, name = scale_for([value], unit)
    return f"{_plain(value / factor, digits)} {name}".removesuffix(" -")


def _plain(value: float, digits: int) -> str:
    """Significant digits without an exponent where that reads well."""
    if value == 0:
        return "0"
    if 1e-3 <= abs(value) < 1e5:
        places = max(digits - 1 - math.floor(math.log10(abs(value))), 0)
        return f"{value:.{places}f}"
    return f"{value:.{digits - 1}e}"
