# SPDX-License-Identifier: MIT
"""Gauges of a run: what the deck says of them, what they measured, what theory expects."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from post.blast import FreeAirBlast, Pulse, free_air, measure_pulse, surface
from post.deck import Deck, as_list
from post.errors import PostError
from post.reader import Run

PRESSURES = ("pressure", "overpressure")
NEAR = 2.0  # a gauge this many cells from a surface measures what arrives on the surface


@dataclass(frozen=True)
class Gauge:
    """One gauge: a column of gauges.csv and its place."""

    id: str
    column: str
    quantity: str
    unit: str
    at: np.ndarray | None  # (3) [m]; None if the deck does not know the gauge
    body: str = ""


@dataclass(frozen=True)
class Expected:
    """Kingery-Bulmash values for a gauge; overpressure and impulse as the gauge sees them."""

    blast: FreeAirBlast
    distance: float  # [m]
    mass: float  # [kg]
    reflected: bool
    angle: float  # of incidence on the surface [rad]; 0 if not reflected
    peak: float  # [Pa]
    impulse: float  # [Pa s]
    shape: str = "sphere"  # of the charge; the curves are those of a sphere of the same mass

    @property
    def label(self) -> str:
        """'reflected' or 'incident', with the angle where the blast does not arrive squarely, and
        a word where the charge is no sphere.
        """
        degrees = math.degrees(self.angle)
        text = "incident"
        if self.reflected:
            text = "reflected" if degrees < 1 else f"reflected at {degrees:.0f} deg"
        if self.shape == "hemisphere":
            return f"{text}, surface burst"
        return text if self.shape == "sphere" else f"{text}, sphere of equal mass"


def list_gauges(run: Run) -> list[Gauge]:
    """Gauges that have a column in gauges.csv, in the order of the file."""
    history = run.history("gauges")
    if history is None:
        return []
    known = {str(group.get("id")): group for group in run.deck.groups("gauge")}
    found = []
    for column in history.names[1:]:
        name, _, quantity = column.partition(":")
        group = known.get(name, {})
        at = np.array((as_list(group.get("at")) + [0.0] * 3)[:3], float) if group else None
        unit, body = history.unit(column), str(group.get("body") or "")
        quantity = quantity.split("[")[0] or str(group.get("quantity", name))
        found.append(Gauge(name, column, quantity, unit, at, body))
    return found


def pressure_gauges(run: Run) -> list[Gauge]:
    """Gauges of the pressure of the air."""
    return [g for g in list_gauges(run) if g.quantity in PRESSURES]


def measure(run: Run, gauge: Gauge) -> Pulse:
    """The blast wave at a pressure gauge. PostError if the history cannot be measured."""
    if gauge.quantity not in PRESSURES:
        raise PostError(f"gauge {gauge.id}: measures {gauge.quantity}, not a pressure")
    history = run.gauges
    ambient, threshold = run.deck.ambient, 5e-3 * run.deck.ambient
    values = history[gauge.column]
    if gauge.quantity == "overpressure":
        values = values + ambient
    try:
        return measure_pulse(history.time, values, ambient, threshold)
    except ValueError as error:
        raise PostError(f"gauge {gauge.id}: {error}") from error


def expect(deck: Deck, gauge: Gauge) -> Expected | None:
    """Kingery-Bulmash values for a pressure gauge.

    None where they do not apply: not exactly one charge of TNT at sea level, a gauge behind a
    body, a scaled distance outside the curves. A charge that is no sphere gets the values of a
    sphere of the same mass about the same centre, and the label says so. A gauge within two cells
    of the face of a box-shaped body or of a wall that looks at the charge gets the reflected
    values of that face. A charge on the ground (burst='surface', or its centre on the floor of a
    blast in the plane through its axis) gets the curves of a hemisphere of the mass that is there.
    """
    charge = _only_charge(deck)
    if charge is None or gauge.at is None or gauge.quantity not in PRESSURES:
        return None
    mass, centre, shape, on_ground = charge
    place, angle = gauge.at, 0.0
    face = _surface_near(deck, gauge.at, centre)
    if face is not None:
        place, angle = face
    elif any(_between(body.low, body.high, centre, gauge.at) for body in deck.bodies()):
        return None
    distance = float(np.linalg.norm(place - centre))
    try:
        blast = (surface if on_ground else free_air)(mass, distance)
    except ValueError:
        return None
    peak, impulse = blast.incident_overpressure, blast.incident_impulse
    if face is not None:
        peak, impulse = blast.on_surface(angle)
    hemisphere = on_ground and shape == "sphere"
    shape = "hemisphere" if hemisphere else shape
    return Expected(blast, distance, mass, face is not None, angle, peak, impulse, shape)


def _only_charge(deck: Deck) -> tuple[float, np.ndarray, str, bool] | None:
    """Mass [kg] that is there, centre [m] and shape of a charge to which the curves apply, and
    whether it lies on the ground.
    """
    charges = deck.groups("charge")
    if len(charges) != 1:
        return None
    charge = charges[0]
    centre = np.array((as_list(charge.get("at")) + [0.0] * 3)[:3], float)
    on_planes = all(abs(c) < 1e-9 for c, cut in zip(centre, deck.mirrors, strict=True) if cut)
    three = int(deck.get("run", "dimension", 3)) == 3
    sea_level = abs(deck.ambient / 101325.0 - 1) < 0.05
    if not (on_planes and three and sea_level) or charge.get("explosive", "tnt") != "tnt":
        return None
    mass = float(charge.get("mass") or math.nan)
    on_ground = charge.get("burst", "air") == "surface"
    if deck.get("air", "geometry") == "axial" and not on_ground:  # with its mirror image
        floor, axis = deck.get("air", "floor"), "xyz".index(str(charge.get("axis", "z")))
        on_ground = floor is not None and float(floor) == centre[axis]
        mass /= 2 if on_ground else 1
    return mass, centre, str(charge.get("shape", "sphere")), on_ground


def _surface_near(deck: Deck, at: np.ndarray, centre: np.ndarray):
    """Point on the nearest surface that looks at the charge, and the angle of incidence [rad]."""
    cell = deck.cell
    if cell is None:
        return None
    found = None
    for axis, side, level, low, high in _faces(deck):
        gap = side * (at[axis] - level)
        others = [d for d in range(3) if d != axis]
        inside = all(low[d] - 1e-9 <= at[d] <= high[d] + 1e-9 for d in others)
        looks = side * (centre[axis] - level) > 0
        if looks and inside and -1e-9 <= gap <= NEAR * cell[axis] and (not found or gap < found[0]):
            place = at.copy()
            place[axis] = level
            ray = centre - place
            angle = math.acos(min(side * ray[axis] / float(np.linalg.norm(ray)), 1.0))
            found = (gap, place, angle)
    return found and found[1:]


def _faces(deck: Deck):
    """Faces that reflect: (axis, outward side, level, low, high) of boxes and outer walls."""
    for body in deck.bodies():
        if body.shape == "box":
            for axis in range(3):
                yield axis, -1, body.low[axis], body.low, body.high
                yield axis, 1, body.high[axis], body.low, body.high
    box = np.array(as_list(deck.get("air", "box")), float)
    kinds = as_list(deck.get("air", "bc"))
    if box.size == 6 and kinds:
        kinds = kinds if len(kinds) == 6 else [kinds[0]] * 6
        low, high = box[0::2], box[1::2]
        for axis in range(3):
            if kinds[2 * axis] == "wall" and not deck.mirrors[axis]:
                yield axis, 1, low[axis], low, high
            if kinds[2 * axis + 1] == "wall":
                yield axis, -1, high[axis], low, high


def _between(low: np.ndarray, high: np.ndarray, a: np.ndarray, b: np.ndarray) -> bool:
    """Whether the straight line from a to b meets a box."""
    step = np.where(b == a, 1e-30, b - a)
    t0, t1 = (low - a) / step, (high - a) / step
    enter, leave = np.minimum(t0, t1).max(), np.maximum(t0, t1).min()
    return bool(max(enter, 0.0) < min(leave, 1.0))
