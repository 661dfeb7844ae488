# SPDX-License-Identifier: MIT
"""What is measured of the scenes of the paper, and what speaks for or against each figure."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path

import numpy as np

from post.balance import column, largest, numerical_shares
from post.cracks import radial_cracks, rings_of
from post.energies import energy_of
from post.errors import PostError
from post.face import face_map
from post.gauges import expect, measure, pressure_gauges
from post.paper_hand import areal_mass, hand_text
from post.perforation import load_plate, measure_perforation
from post.reader import Run
from post.units import base_of, factor_of, show

TABLE = Path(__file__).parent / "data" / "paper.csv"
LATE = 1.2e-3  # [s] when the paper reads the slabs
HIT = 0.95  # of its largest speed: a fragment that is slower has hit something
EARLY = 3e-4  # [s] until then the plate of 3.1.2 has its first maximum of velocity


@dataclass(frozen=True)
class Printed:
    """One number of the paper, in SI units."""

    section: str
    where: str
    case: str
    measure: str
    value: float
    unit: str
    what: str


def printed_numbers() -> list[Printed]:
    """All rows of data/paper.csv."""
    with TABLE.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    return [
        Printed(**row | {"value": float(row["value"]) * factor_of(row["unit"]),
                         "unit": base_of(row["unit"])})
        for row in rows
    ]  # fmt: skip


def value_of(run: Run, name: str) -> float:
    """A measured number in SI units; not a number where the run has no such value."""
    try:
        return float(MEASURES[name](run))
    except (PostError, ValueError, IndexError):
        return math.nan


def _gauge(run: Run, column_name: str) -> np.ndarray:
    return np.abs(run.gauges[column_name])


def _pulse(run: Run):
    return measure(run, next(g for g in pressure_gauges(run) if g.id == "A"))


def _kinetic(run: Run) -> np.ndarray:
    return run.deck.images * column(run.energy, "solid_kinetic")


def _at(time: np.ndarray, values: np.ndarray, when: float) -> float:
    """A history at a time, or not a number where it ends before."""
    return float(np.interp(when, time, values)) if time[-1] > 0.999 * when else math.nan


def _early(run: Run, until: float = EARLY) -> np.ndarray:
    """Velocity of the middle: of the plate until its first maximum, of the slabs all of it."""
    values = _gauge(run, "mid_v:velocity_z")
    return values[run.gauges.time <= until] if run.job == "plate" else values


def _residual_pressure(run: Run) -> float:
    return run.gauges["A:pressure"][-1] - run.deck.ambient


@cache
def hole_of(folder: Path):
    """The holes of the plate of a run at its end (kept, as it takes a while)."""
    run = Run(folder)
    return measure_perforation(load_plate(run, _last(run)))


def _last(run: Run):
    return [frame for frame in run.frames if frame.solid_path][-1]


def _end(run: Run, kind: str) -> float:
    return float(getattr(energy_of(run, ["plate"]), kind)[-1])


def _radial_cracks(run: Run) -> float:
    face = face_map(run, _last(run), "concrete", "z+")
    return float(np.median(radial_cracks(face, rings_of(face))))


def impact(run: Run, gauge: str = "f0_v") -> tuple[float, float]:
    """Time [s] at which a fragment has lost 5 % of its speed, and its largest speed until then.

    The time is not a number for a fragment that hits nothing.
    """
    speed = _gauge(run, f"{gauge}:velocity_z")
    top = np.maximum.accumulate(speed)
    slower = np.flatnonzero((speed < HIT * top) & (top > 1.0))
    end = int(slower[0]) if len(slower) else len(speed) - 1
    return (float(run.gauges.time[end]) if len(slower) else math.nan), float(top[end])


MEASURES: dict[str, Callable[[Run], float]] = {
    "kinetic_start": lambda run: _kinetic(run)[0],
    "kinetic_end": lambda run: _kinetic(run)[-1],
    "kinetic_peak": lambda run: _kinetic(run).max(),
    "kinetic_late": lambda run: _at(run.energy.time, _kinetic(run), LATE),
    "plate_kinetic_end": lambda run: _end(run, "kinetic"),
    "plate_internal_end": lambda run: _end(run, "internal"),
    "plate_total_end": lambda run: _end(run, "total"),
    "hole": lambda run: hole_of(run.folder).widest.through.seen.diameter,
    "arrival": lambda run: _pulse(run).arrival,
    "peak": lambda run: _pulse(run).peak,
    "residual_pressure": _residual_pressure,
    "velocity_peak": lambda run: _early(run).max(),
    "velocity_peak_time": lambda run: run.gauges.time[np.argmax(_early(run))],
    "displacement_peak": lambda run: _gauge(run, "mid:displacement_z").max(),
    "displacement_peak_time": lambda run: run.gauges.time[
        np.argmax(_gauge(run, "mid:displacement_z"))
    ],
    "displacement_late": lambda run: _at(run.gauges.time, run.gauges["mid:displacement_z"], LATE),
    "radial_cracks": _radial_cracks,
    "launch_speed": lambda run: impact(run)[1],
    "impact_time": lambda run: impact(run)[0],
    "exit_speed": lambda run: _gauge(run, "f0_v:velocity_z")[-1] if _through(run) else math.nan,
}


def _through(run: Run) -> bool:
    """Whether the middle fragment is behind the slab at the end, or at least stays in motion."""
    return math.isfinite(impact(run)[0])


# --- what speaks for or against -------------------------------------------------------------------


def resolution(run: Run) -> tuple[str, str]:
    """'6 mm (concrete), 4 mm (steel)' of the particles, and '12 mm' of the cells."""
    spacings: dict[str, list[str]] = {}
    for body in run.deck.bodies():
        spacings.setdefault(f"{1e3 * body.spacing:.3g} mm", []).append(body.material)
    texts = [
        f"{size} ({', '.join(dict.fromkeys(names))})" if len(spacings) > 1 else size
        for size, names in spacings.items()
    ]
    cell = run.deck.cell
    return ", ".join(texts), "–" if cell is None else f"{1e3 * cell[2]:.3g} mm"


def load_text(run: Run) -> str:
    """The load at gauge A beside Kingery-Bulmash; empty where there is none."""
    gauge = next((g for g in pressure_gauges(run) if g.id == "A"), None)
    expected = expect(run.deck, gauge) if gauge is not None else None
    if expected is None:
        return ""
    pulse = measure(run, gauge)
    if not pulse.reached:
        return "the blast has not arrived"
    arrival = pulse.arrival / expected.blast.arrival
    impulse = f"{'' if pulse.complete else 'at least '}{pulse.impulse / expected.impulse:.2f}"
    return (
        f"beside Kingery-Bulmash ({show(expected.blast.arrival, 's')}, "
        f"{show(expected.peak, 'Pa')}, {show(expected.impulse, 'Pa s')}, {expected.label}) "
        f"arrival is {arrival:.2f}, peak {pulse.peak / expected.peak:.2f}, impulse {impulse}"
    )


def cost_text(run: Run) -> str:
    """What the numbers cost, and the error of the energy."""
    shares = [
        f"{share.name.split(' of ')[0].split(' energy')[0].split(':')[0]} "
        f"{100 * share.largest:.2g} %"
        for share in numerical_shares(run.energy)
        if share.largest > 2e-3
    ]
    text = (
        f"of the energy put in: {', '.join(shares)}" if shares else "numerical losses below 0.2 %"
    )
    if "error" in run.energy:
        error = run.energy["error"]
        text += f"; not accounted for {abs(error[largest(error)]):.0e}"
    return text


def layers_text(run: Run) -> str:
    """Layers of particles through each plate, and cells to the charge."""
    parts = []
    for body in run.deck.bodies():
        if body.shape == "box":
            thick = float(min(body.high - body.low))
            number = max(round(thick / body.spacing), 1)
            parts.append(f"{number} layer{'s' if number > 1 else ''} through {body.id}")
    cell, charge = run.deck.cell, run.deck.groups("charge")
    if cell is not None and charge:
        parts.append(f"{abs(charge[0]['at'][2]) / cell[2]:.0f} cells to the charge")
    return ", ".join(parts)


def impulse_text(run: Run) -> str:
    """Velocity that the impulse at A gives a free plate of all layers in the middle."""
    gauge = next((g for g in pressure_gauges(run) if g.id == "A"), None)
    mass = areal_mass(run.deck)
    if gauge is None or not mass or not measure(run, gauge).reached:
        return ""
    speed = measure(run, gauge).impulse / mass
    return f"a free plate under the impulse at A moves at {speed:.3g} m/s"


def impulse_total_text(run: Run) -> str:
    """Largest impulse of the air on the whole along z."""
    name = "impulse_z[N s]" if "impulse_z[N s]" in run.energy else "impulse_z"
    if name not in run.energy:
        return ""
    return f"here {show(run.deck.images * np.abs(run.energy[name]).max(), 'N s')} at most"


KINDS = {
    "arrival": (load_text,),
    "peak": (load_text, layers_text),
    "residual_pressure": (load_text,),
    "hole": (layers_text, cost_text),
    "radial_cracks": (layers_text, load_text),
    "displacement_late": (load_text, impulse_text),
    "displacement_peak": (load_text, layers_text),
    "velocity_peak": (impulse_text, load_text),
    "launch_speed": (),
    "impact_time": (load_text,),
    "kinetic_peak": (impulse_total_text, cost_text),
}


def why(run: Run, one: Printed) -> str:
    """What speaks for or against a figure: a calculation by hand, and what the run itself tells."""
    parts = []
    hand = partial(hand_text, name=one.measure, printed=one.value)
    for part in (hand, *KINDS.get(one.measure, (cost_text,))):
        try:
            parts.append(part(run))
        except (PostError, ValueError):
            continue
    return "; ".join(text for text in parts if text)


def wall_clock(run: Run) -> str:
    """What the run took, from its log beside the folder; a dash without one."""
    log = run.folder.with_name(run.folder.name + ".log")
    if not log.is_file():
        return "–"
    found = re.findall(r"wall clock +([\d.]+) s", log.read_text(errors="replace"))
    return show(sum(map(float, found)), "s") if found else "–"
