# SPDX-License-Identifier: MIT
"""What a hand calculation with Kingery-Bulmash expects of the scenes of the paper."""

from __future__ import annotations

import math

import numpy as np

from post.blast import free_air
from post.deck import Deck, as_list
from post.errors import PostError
from post.gauges import expect, list_gauges
from post.reader import Run
from post.units import show

GRID = 41  # places along half a side of a slab at which the load is taken


def density_of(deck: Deck, material: str) -> float:
    """Density of a material of the deck [kg/m3]; 0 where it does not say."""
    groups = [g for g in deck.groups("material") if g.get("id") == material]
    return float(groups[0].get("density") or 0.0) if groups else 0.0


def areal_mass(deck: Deck) -> float:
    """Mass of all boxes on top of each other [kg/m2]; bars count as what they replace."""
    return sum(
        density_of(deck, body.material) * float(min(body.high - body.low))
        for body in deck.bodies()
        if body.shape == "box"
    )


def load_on_slab(deck: Deck) -> tuple[float, float]:
    """Impulse of Kingery-Bulmash on a whole square plate under its charge [N s], and the kinetic
    energy of its elements if each keeps the impulse that it gets [J].

    By the angle of incidence of each (`FreeAirBlast.on_surface`). PostError without charge or
    plate.
    """
    plates = [body for body in deck.bodies() if body.shape == "box"]
    charges, mass = deck.groups("charge"), areal_mass(deck)
    if len(charges) != 1 or not plates or not mass:
        raise PostError("there is no plate under a single charge")
    side = float(max(np.abs([plates[0].low[:2], plates[0].high[:2]]).ravel()))
    at = as_list(charges[0]["at"])
    low, high = (pick(b) for pick, b in ((min, [p.low[2] for p in plates]),
                                         (max, [p.high[2] for p in plates])))  # fmt: skip
    height = min(abs(at[2] - low), abs(at[2] - high))
    x = (np.arange(GRID) + 0.5) * side / GRID
    away = np.hypot(np.hypot(*np.meshgrid(x, x)), height).ravel()
    weight = float(charges[0]["mass"])
    impulse = np.array(
        [free_air(weight, float(r)).on_surface(math.acos(height / r))[1] for r in away]
    )
    area = 4 * (side / GRID) ** 2  # of a place and its images
    return float(impulse.sum() * area), float((impulse**2).sum() * area / (2 * mass))


def launch_speed(deck: Deck, body: str = "f0") -> float:
    """Speed of a sphere under the reflected impulse of Kingery-Bulmash at its middle [m/s]."""
    sphere = next((b for b in deck.bodies() if b.id == body), None)
    charges = deck.groups("charge")
    if sphere is None or len(charges) != 1:
        raise PostError(f"there is no body '{body}' and a single charge")
    radius = float(sphere.high[0] - sphere.low[0]) / 2
    middle = (sphere.low + sphere.high) / 2
    away = float(np.linalg.norm(middle - np.array(as_list(charges[0]["at"]))))
    impulse = free_air(float(charges[0]["mass"]), away).reflected_impulse
    return impulse / (4 / 3 * radius * density_of(deck, sphere.material))


def hand_text(run: Run, name: str, printed: float) -> str:
    """The hand calculation beside a measure, and what the paper's number is of it."""
    if name in ("arrival", "peak"):
        gauge = next((g for g in list_gauges(run) if g.id == "A"), None)
        found = expect(run.deck, gauge) if gauge else None
        if found is None:
            return ""
        value = found.blast.arrival if name == "arrival" else found.peak
        return f"the paper has {printed / value:.2f} of Kingery-Bulmash"
    if name == "kinetic_peak":
        impulse, energy = load_on_slab(run.deck)
        return (
            f"Kingery-Bulmash over the slab gives {show(impulse, 'N s')} and, where each element "
            f"keeps its impulse, {show(energy, 'J')}: the paper has {printed / energy:.2f} of it"
        )
    if name in ("launch_speed",) and run.job == "fragments":
        speed = launch_speed(run.deck)
        return (
            f"by hand: {show(speed, 'm/s')} from the reflected impulse of Kingery-Bulmash; the "
            f"paper has {printed / speed:.0f} times that, which no blast of this charge gives"
        )
    return ""
