# SPDX-License-Identifier: MIT
"""Spall: the pull-back of a free face tells the tension at which the material gave way."""

from __future__ import annotations

import numpy as np

from studies.comparisons.case import Case, History, Measures, Quantity, Run
from studies.comparisons.reading import column

LENGTH, DENSITY, SPEED, PRESSURE, PULSE, STRENGTH, END = (
    0.04,
    8900.0,
    4000.0,
    1e9,
    4e-6,
    0.6e9,
    16e-6,
)
DECK = f"""A sharp triangular pulse in a slab that carries {STRENGTH / 1e9} GPa of tension, in 1-D.

&run t_end = {END}, dimension = 1 /
&material
    id = 'm', model = 'gruneisen', density = {DENSITY}, sound_speed = {SPEED}
    s1 = 0, gruneisen_gamma = 0, shear_modulus = 1e6, yield_stress = 1e5
    pressure_cutoff = -{STRENGTH:g}
/
&body id = 'slab', box = 0, {LENGTH}, 0, 1, 0, 1, spacing = {{spacing}}, material = 'm' /
&load body = 'slab', faces = 'x-', time = 0, {PULSE}, pressure = {PRESSURE:g}, 0 /
&gauge id = 'face', at = {LENGTH}, 0.5, 0.5, body = 'slab', quantity = 'velocity_x' /
&output history_every = 2e-8 /
"""


def line(history: History, start: float, end: float) -> tuple[float, float]:
    """Slope and height at 0 of the straight line through a stretch."""
    part = np.array([point for point in history if start <= point[0] <= end])
    slope, height = np.polyfit(part[:, 0], part[:, 1], 1)
    return float(slope), float(height)


def measures(history: History) -> Measures:
    """Told by two straight lines, before and after the signal of the spall (the front is smeared).

    Peak: the first line at the arrival of the front. Pull-back: how far it falls from there to
    where the second line meets it.
    """
    arrival, wait = LENGTH / SPEED, PULSE * STRENGTH / PRESSURE
    a, b = line(history, arrival + 0.3 * wait, arrival + 0.8 * wait)
    c, d = line(history, arrival + 1.3 * wait, arrival + 2 * wait)
    meeting = (d - b) / (a - c)
    return {"peak": a * arrival + b, "pullback": a * (arrival - meeting), "time": meeting}


def exact() -> History:
    """Acoustics: twice the particle velocity of the pulse until the signal of the spall."""
    arrival, impedance = LENGTH / SPEED, DENSITY * SPEED
    wait = PULSE * STRENGTH / PRESSURE
    low = 2 * (PRESSURE - STRENGTH) / impedance
    return [(0, 0), (arrival, 0), (arrival, 2 * PRESSURE / impedance), (arrival + wait, low)]


def _ours(n: int) -> Run:
    def write(folder):
        text = DECK.format(spacing=LENGTH / n)
        (folder / "deck.nml").write_text(text, encoding="utf-8")

    def read(folder):
        history = column(folder, "face")
        return measures(history), history

    return Run(f"Brisance, {n} particles", "brisance", f"{n} particles", write, read)


CASE = Case(
    name="spall",
    mark="W2",
    title="Spall behind a sharp pulse",
    setting="40 mm of an almost acoustic material (8900 kg/m3, 4 km/s), 1 GPa that falls to 0 in "
    "4 us, tension limited to "
    "0.6 GPa; free face.",
    reference="acoustics: peak 2 P/(rho c), pull-back 2 S/(rho c)",
    quantities=(
        Quantity("pullback", "pull-back", "m/s", 1, 4, 2 * STRENGTH / (DENSITY * SPEED), 0.1),
        Quantity("peak", "peak", "m/s", 1, 4, 2 * PRESSURE / (DENSITY * SPEED), 0.05),
        Quantity(
            "time",
            "signal of the spall at",
            "us",
            1e6,
            4,
            LENGTH / SPEED + PULSE * STRENGTH / PRESSURE,
            0.03,
        ),
    ),
    runs=(_ours(200), _ours(400), _ours(800)),
    axes=("time [us]", "velocity of the free face [m/s]"),
    scales=(1e6, 1),
    exact=exact,
    remarks={
        "Brisance, 800 particles": "first order: the pulse of tension is rounded off where it must "
        "reach the limit; CalculiX and OpenFOAM have no spall",
    },
)
