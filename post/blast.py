# SPDX-License-Identifier: MIT
"""Blast engineering: reference curves, and what is measured on a pressure history."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

DATA = Path(__file__).parent / "data"
TABLES = {"air": DATA / "kb_free_air.csv", "surface": DATA / "kb_surface.csv"}
LB = 0.45359237  # [kg]
FT_PER_CUBE_ROOT_LB = LB ** (1 / 3) / 0.3048  # of 1 m/kg^(1/3)
UNITS = {"air": FT_PER_CUBE_ROOT_LB, "surface": 1.0}  # of the distances of the tables
PSI = 6894.757293  # [Pa]
QUANTITIES = (
    "incident_overpressure",
    "reflected_overpressure",
    "arrival",
    "duration",
    "incident_impulse",
    "reflected_impulse",
)


@dataclass(frozen=True)
class FreeAirBlast:
    """TNT burst at sea level, a sphere in free air or a hemisphere on the ground, at one distance.

    Reflected values are those of a large rigid wall hit squarely. All in SI units.
    """

    scaled_distance: float  # [m/kg^(1/3)]
    incident_overpressure: float  # [Pa]
    reflected_overpressure: float  # [Pa]
    arrival: float  # after detonation [s]
    duration: float  # of the positive phase [s]
    incident_impulse: float  # [Pa s]
    reflected_impulse: float  # [Pa s]

    def on_surface(self, angle: float) -> tuple[float, float]:
        """Overpressure [Pa] and impulse [Pa s] on a surface, angle of incidence in [rad].

        By `oblique_shares`; no Mach stem.
        """
        reflected, incident = oblique_shares(math.cos(angle))
        return (
            reflected * self.reflected_overpressure + incident * self.incident_overpressure,
            reflected * self.reflected_impulse + incident * self.incident_impulse,
        )


def oblique_shares(cosine: float) -> tuple[float, float]:
    """Shares of the reflected and the incident wave in what a rigid surface feels.

    `cosine` c of the angle of incidence: p = p_r c^2 + p_i (1 + c - 2 c^2), and p_i alone where it
    looks away (c < 0). Never below p_i where p_r >= p_i, and p_i (1 + c) for sound (p_r = 2 p_i).
    Source: G. Randers-Pehrson, K. A. Bannister, ARL-TR-1310 (1997), whose printed share of the
    incident wave, 1 + c^2 - 2 c, has c and its square exchanged (docs/manual/blast.md).
    """
    c = max(cosine, 0.0)
    return c * c, 1 + c - 2 * c * c


@cache
def _branches(burst: str) -> dict[str, list[tuple[float, float, float, float, float, list[float]]]]:
    """Per quantity: (x_low, x_high, SI factor, shift, scale, coefficients), in rising order."""
    factor = {"psi": PSI, "ms/lb^(1/3)": 1e-3, "psi ms/lb^(1/3)": PSI * 1e-3,
              "kPa": 1e3, "ms/kg^(1/3)": 1e-3, "kPa ms/kg^(1/3)": 1.0}  # fmt: skip
    table: dict[str, list] = {name: [] for name in QUANTITIES}
    with TABLES[burst].open() as file:
        for row in csv.DictReader(line for line in file if not line.startswith("#")):
            coefficients = [float(row[f"c{k}"]) for k in range(12) if row.get(f"c{k}")]
            unit = factor[row["unit"]]
            if "lb^" in row["unit"]:
                unit /= LB ** (1 / 3)
            low, high, shift, scale = (float(row[k]) for k in ("x_low", "x_high", "shift", "scale"))
            table[row["quantity"]].append((low, high, unit, shift, scale, coefficients))
    return table


def free_air_range(burst: str = "air") -> tuple[float, float]:
    """Smallest and largest scaled distance of the curves [m/kg^(1/3)]."""
    branches = [b for rows in _branches(burst).values() for b in rows]
    low, high = min(b[0] for b in branches), max(b[1] for b in branches)
    low, high = 10**low / UNITS[burst], 10**high / UNITS[burst]
    return low, max(high, 40.0)  # the spheres end at 100 ft/lb^(1/3), commonly quoted as 40


def free_air(mass: float, distance: float) -> FreeAirBlast:
    """Kingery-Bulmash values for `mass` of TNT [kg] at `distance` from its centre [m].

    Raises ValueError where mass or distance is not positive and finite, or where the scaled
    distance is outside the range of the curves.
    """
    return _blast("air", mass, distance)


def surface(mass: float, distance: float) -> FreeAirBlast:
    """The same for a hemisphere of `mass` of TNT that lies on the ground."""
    return _blast("surface", mass, distance)


def _blast(burst: str, mass: float, distance: float) -> FreeAirBlast:
    for name, value in (("mass", mass), ("distance", distance)):
        if not (math.isfinite(value) and value > 0):
            raise ValueError(f"Kingery-Bulmash: the {name} must be positive, got {value}")
    z = distance / mass ** (1 / 3)
    low, high = free_air_range(burst)
    if not low <= z <= high:
        raise ValueError(
            f"Kingery-Bulmash: scaled distance {z:.4g} m/kg^(1/3) is outside "
            f"{low:.3g} .. {high:.3g} (mass {mass:g} kg at {distance:g} m)"
        )
    x = math.log10(z * UNITS[burst])
    values = {name: _evaluate(burst, name, x) for name in QUANTITIES}
    for name in ("arrival", "duration", "incident_impulse", "reflected_impulse"):
        values[name] *= mass ** (1 / 3)
    return FreeAirBlast(scaled_distance=z, **values)


def kinney_graham(mass: float, distance: float) -> tuple[float, float]:
    """Incident overpressure [Pa] and impulse [Pa s] by G. F. Kinney and K. J. Graham, Explosive
    Shocks in Air (1985): `mass` of TNT [kg] in free air at 101325 Pa and 288 K, `distance` [m].
    """
    z = distance / mass ** (1 / 3)
    peak = 808 * (1 + (z / 4.5) ** 2)
    peak /= math.sqrt((1 + (z / 0.048) ** 2) * (1 + (z / 0.32) ** 2) * (1 + (z / 1.35) ** 2))
    impulse = 0.067 * math.sqrt(1 + (z / 0.23) ** 4) / (z**2 * (1 + (z / 1.55) ** 3) ** (1 / 3))
    return 101325 * peak, 100 * impulse * mass ** (1 / 3)  # impulse: bar ms


def _evaluate(burst: str, name: str, x: float) -> float:
    """One curve at x = log10(scaled distance of its table); SI, per cube root of kg if scaled."""
    branches = _branches(burst)[name]
    _, _, unit, shift, scale, coefficients = next((b for b in branches if x <= b[1]), branches[-1])
    return unit * 10 ** np.polynomial.polynomial.polyval(shift + scale * x, coefficients)


@dataclass(frozen=True)
class Pulse:
    """What a blast wave did at a gauge. Not-a-number where a value does not exist.

    - overpressure: pressure less the ambient pressure.
    - arrival: the overpressure first passes 10 % of its peak and stays above for three samples
      (linear between samples). A shock smeared over cells has its middle half a rise time later.
    - peak: largest sample of the overpressure, no smoothing.
    - rise_time: from 10 % to 90 % of the peak.
    - duration: from arrival to the first return to ambient after the peak that is followed by
      suction (a loss of 0.5 % of the impulse) and not only by a dip of noise.
    - impulse: overpressure integrated over the positive phase; when the history ends inside that
      phase, up to its end: then a lower bound and `complete` is False.
    """

    reached: bool
    complete: bool
    ambient: float  # [Pa]
    arrival: float = math.nan  # [s]
    peak: float = math.nan  # [Pa]
    peak_time: float = math.nan  # [s]
    rise_time: float = math.nan  # [s]
    duration: float = math.nan  # [s]
    impulse: float = math.nan  # [Pa s]
    remark: str = ""


def measure_pulse(
    time: np.ndarray,
    pressure: np.ndarray,
    ambient: float | None = None,
    threshold: float | None = None,
) -> Pulse:
    """Measure the first blast wave in a pressure history; definitions in `Pulse`.

    `time` [s] rising, shape (n); `pressure` [Pa], shape (n). `ambient` [Pa]: default the first
    sample. A history whose overpressure stays below `threshold` [Pa] (default 0.5 % of ambient,
    at least 1 Pa) or within six times the scatter of its quiet start is 'not reached'.
    Raises ValueError for fewer than two samples, unequal shapes, falling times or NaN.
    """
    time, pressure = np.asarray(time, float), np.asarray(pressure, float)
    if time.ndim != 1 or time.shape != pressure.shape or time.size < 2:
        raise ValueError("a pressure history needs two or more times and as many pressures")
    if not (np.isfinite(time).all() and np.isfinite(pressure).all()):
        raise ValueError("the pressure history holds values that are not finite")
    if (np.diff(time) < 0).any():
        raise ValueError("the times of a pressure history must not fall")
    ambient = float(pressure[0]) if ambient is None else float(ambient)
    over = pressure - ambient
    if threshold is None:
        threshold = max(5e-3 * abs(ambient), 1.0)
    top = int(np.argmax(over))
    peak = float(over[top])
    if peak <= max(threshold, _noise(over)):
        return Pulse(reached=False, complete=False, ambient=ambient, remark="not reached")
    level = 0.1 * peak
    foot = _first_sustained(over, level, top)
    remark = ""
    if foot == 0:
        arrival, remark = math.nan, "the history starts inside the pulse"
    else:
        arrival = _cross(time, over, foot, level)
    end, complete = _end_of_phase(time, over, top)
    start = time[0] if foot == 0 else arrival
    if not complete:
        remark = (remark + "; " if remark else "") + "the history ends inside the positive phase"
    crest = foot + int(np.argmax(over[foot : top + 1] >= 0.9 * peak))
    late = _cross(time, over, crest, 0.9 * peak) if crest > 0 else math.nan
    return Pulse(
        reached=True,
        complete=complete,
        ambient=ambient,
        arrival=arrival,
        peak=peak,
        peak_time=float(time[top]),
        rise_time=late - arrival,
        duration=end - arrival if complete else math.nan,
        impulse=_integral(time, over, start, end),
        remark=remark,
    )


def _noise(over: np.ndarray) -> float:
    """Six times the scatter of the start: the quietest of the first tenths that have 20 samples."""
    n = over.size // 20
    return 6 * float(np.std(over[:n])) if n >= 20 else 0.0


def _first_sustained(over: np.ndarray, level: float, top: int) -> int:
    """First sample above `level` whose two followers are above too, or that leads to the peak."""
    above = over > level
    for i in np.flatnonzero(above[: top + 1]):
        if above[i : min(i + 3, top + 1)].all():
            return int(i)
    return top


def _cross(time: np.ndarray, value: np.ndarray, i: int, level: float) -> float:
    """Time at which the straight line from sample i-1 to sample i passes `level`."""
    rise = value[i] - value[i - 1]
    part = (level - value[i - 1]) / rise if rise != 0 else 1.0
    return float(time[i - 1] + min(max(part, 0.0), 1.0) * (time[i] - time[i - 1]))


def _end_of_phase(time: np.ndarray, over: np.ndarray, top: int) -> tuple[float, bool]:
    """End of the positive phase [s] and whether the history shows it."""
    down = np.flatnonzero((over[top + 1 :] <= 0) & (over[top:-1] > 0)) + top + 1
    if down.size == 0:
        return float(time[-1]), False
    steps = 0.5 * (over[1:] + over[:-1]) * np.diff(time)
    sums = np.concatenate([[0.0], np.cumsum(steps)])
    for i in down:
        loss = 5e-3 * sums[i]
        later = sums[i:] - sums[i]
        fallen = np.flatnonzero(later < -loss)
        regained = np.flatnonzero(later > loss)
        first_fall = fallen[0] if fallen.size else later.size
        first_gain = regained[0] if regained.size else later.size
        if first_fall < first_gain or (first_gain == later.size and over[-1] <= 0):
            return _cross(time, over, i, 0.0), True
    return float(time[-1]), False


def _integral(time: np.ndarray, over: np.ndarray, start: float, end: float) -> float:
    """Trapezoidal integral of a history between two times [Pa s]."""
    inside = (time > start) & (time < end)
    t = np.concatenate([[start], time[inside], [end]])
    p = np.interp(t, time, over)
    return float(np.sum(0.5 * (p[1:] + p[:-1]) * np.diff(t)))
