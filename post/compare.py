# SPDX-License-Identifier: MIT
"""Measured values beside references: Kingery-Bulmash, and what the user gives in a file."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from post.balance import whole_factor
from post.blast import Pulse
from post.deflection import permanent_set
from post.errors import USAGE, PostError
from post.gauges import PRESSURES, Gauge, expect, list_gauges, measure, pressure_gauges
from post.reader import Run
from post.units import base_of, factor_of

COLUMNS = ("quantity", "gauge", "value", "unit", "source")
OF_PULSES = {"arrival": "s", "rise_time": "s", "duration": "s", "impulse": "Pa s"}
OF_ALL = {"peak": "", "peak_time": "s", "final": "", "permanent_set": "m"}


@dataclass(frozen=True)
class Reference:
    """One row of a reference file, in SI units."""

    quantity: str
    gauge: str  # id of a gauge, or a column of a history such as 'plate:damage_mean', or
    # 'whole:' and such a column: of the whole scene where a part is modelled
    value: float
    unit: str  # SI
    source: str


@dataclass(frozen=True)
class Comparison:
    """A measured value beside a reference, in SI units."""

    quantity: str
    gauge: str
    measured: float  # not a number where the run has no such value
    reference: float
    unit: str
    source: str

    @property
    def difference(self) -> float:
        """(measured - reference)/|reference|; not a number where that makes no sense."""
        if self.reference == 0:
            return math.nan
        return (self.measured - self.reference) / abs(self.reference)


def find_references(run: Run, given: str | Path | None = None) -> Path | None:
    """The reference file: the given one, or `<job>.reference.csv` in the folder or in inputs/."""
    if given is not None:
        if not Path(given).is_file():
            raise PostError(f"{given}: there is no such reference file", USAGE)
        return Path(given)
    name = f"{run.job}.reference.csv"
    home = Path(__file__).resolve().parents[1]
    inputs = [home / "inputs", home / "inputs" / "paper"]
    places = [run.folder, Path.cwd(), Path("inputs"), *inputs]
    return next((place / name for place in places if (place / name).is_file()), None)


def read_references(path: Path) -> list[Reference]:
    """Rows `quantity, gauge, value, unit, source`; `#` begins a comment line.

    Raises PostError with file and line for anything that cannot be understood.
    """
    found, header = [], None
    lines = path.read_text(encoding="utf-8").splitlines()
    for number, line in enumerate(lines, 1):
        if not line.strip() or line.startswith("#"):
            continue
        cells = [cell.strip() for cell in next(csv.reader([line], skipinitialspace=True))]
        if header is None:
            header = cells
            if tuple(header) != COLUMNS:
                raise PostError(f"{path}:{number}: the columns must be {', '.join(COLUMNS)}", USAGE)
        else:
            found.append(_reference(cells, f"{path}:{number}"))
    return found


def _reference(cells: list[str], where: str) -> Reference:
    if len(cells) != len(COLUMNS):
        raise PostError(f"{where}: has {len(cells)} values, not {len(COLUMNS)}", USAGE)
    quantity, gauge, value, unit, source = cells
    if quantity not in (OF_PULSES | OF_ALL):
        known = ", ".join(OF_PULSES | OF_ALL)
        raise PostError(f"{where}: unknown quantity '{quantity}'; known are {known}", USAGE)
    try:
        return Reference(quantity, gauge, float(value) * factor_of(unit), base_of(unit), source)
    except ValueError as error:
        raise PostError(f"{where}: {error}", USAGE) from error


def compare(run: Run, references: list[Reference]) -> list[Comparison]:
    """Kingery-Bulmash for each gauge to which it applies, then the given references."""
    rows = []
    for gauge in pressure_gauges(run):
        expected = expect(run.deck, gauge)
        if expected is None:
            continue
        pulse = _pulse(run, gauge)
        source = f"Kingery-Bulmash, {expected.label}, {expected.distance:g} m"
        whole = pulse.impulse if pulse.complete else math.nan
        rows += [
            Comparison("arrival", gauge.id, pulse.arrival, expected.blast.arrival, "s", source),
            Comparison("peak overpressure", gauge.id, pulse.peak, expected.peak, "Pa", source),
            Comparison("impulse", gauge.id, whole, expected.impulse, "Pa s", source),
        ]
    for reference in references:
        name, measured, unit = _measured(run, reference)
        rows.append(
            Comparison(name, reference.gauge, measured, reference.value, unit, reference.source)
        )
    return rows


def _pulse(run: Run, gauge: Gauge) -> Pulse:
    """The pulse of a gauge; 'not reached' where the history cannot be measured."""
    try:
        return measure(run, gauge)
    except PostError as error:
        return Pulse(reached=False, complete=False, ambient=run.deck.ambient, remark=str(error))


def _measured(run: Run, reference: Reference) -> tuple[str, float, str]:
    """Name, value and unit of what a reference speaks of; not a number if the run lacks it."""
    name = reference.quantity.replace("_", " ")
    for gauge in list_gauges(run):
        if reference.gauge not in (gauge.id, gauge.column):
            continue
        if reference.quantity == "permanent_set":
            moves = gauge.quantity.startswith("displacement")
            values = run.gauges[gauge.column] if moves else np.array([math.nan])
            if not np.isfinite(values).all():
                return name, math.nan, gauge.unit
            return name, abs(permanent_set(run.gauges.time, values)[0]), gauge.unit
        if gauge.quantity in PRESSURES and reference.quantity != "final":
            unit = OF_PULSES.get(reference.quantity) or OF_ALL[reference.quantity] or "Pa"
            name = "peak overpressure" if reference.quantity == "peak" else name
            return name, getattr(_pulse(run, gauge), reference.quantity), unit
        subject = gauge.quantity.split("_")[0]
        name = (
            f"{name} {subject}" if reference.quantity != "peak_time" else f"time of peak {subject}"
        )
        values = run.gauges[gauge.column]
        if reference.quantity != "final" and _still_growing(values):
            name += " (so far)"
        return name, *_extreme(reference.quantity, run.gauges.time, values, gauge.unit)
    label = reference.gauge.removeprefix("whole:")
    for history in (run.history("bodies"), run.history("energy")):
        if history is not None and label in history:
            values, unit = history[label], history.unit(label)
            factor = whole_factor(run, label, unit) if label != reference.gauge else 1.0
            return name, *_extreme(reference.quantity, history.time, factor * values, unit)
    return name, math.nan, reference.unit


def _still_growing(values: np.ndarray) -> bool:
    """Whether the largest magnitude is the last value: the peak may be still to come."""
    return len(values) > 1 and int(np.nanargmax(np.abs(values))) == len(values) - 1


def _extreme(quantity: str, time: np.ndarray, values: np.ndarray, unit: str) -> tuple[float, str]:
    """Largest magnitude, its time, or the last value of a history."""
    if quantity in OF_PULSES or not len(values) or not np.isfinite(values).all():
        return math.nan, OF_PULSES.get(quantity, unit)
    top = int(np.argmax(np.abs(values)))
    if quantity == "peak":
        return float(abs(values[top])), unit
    return (float(time[top]), "s") if quantity == "peak_time" else (float(values[-1]), unit)
