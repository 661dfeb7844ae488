# SPDX-License-Identifier: MIT
"""An elastic wave in uniaxial strain: a pulse runs through a slab to its free face and back."""

from __future__ import annotations

import math

from studies.comparisons import bricks
from studies.comparisons.case import Case, History, Measures, Quantity, Run
from studies.comparisons.reading import column

LENGTH, DENSITY, YOUNG, POISSON = 0.1, 7800.0, 200e9, 0.3
PRESSURE, RISE, END = 100e6, 4e-6, 60e-6
SPEED = math.sqrt(YOUNG * (1 - POISSON) / ((1 + POISSON) * (1 - 2 * POISSON)) / DENSITY)
STEP = 1e-7  # of CalculiX
DECK = f"""A pressure pulse in a slab of steel, in 1-D, written by studies/comparisons/stress_wave.

&run t_end = {END}, dimension = 1 /
&material
    id = 'm', model = 'linear_elastic', density = {DENSITY}
    youngs_modulus = {YOUNG:g}, poisson_ratio = {POISSON}
/
&body id = 'slab', box = 0, {LENGTH}, 0, 1, 0, 1, spacing = {{spacing}}, material = 'm'{{more}} /
&load body = 'slab', faces = 'x-', time = 0, {RISE}, {2 * RISE}, pressure = 0, {PRESSURE:g}, 0 /
&gauge id = 'face', at = {LENGTH}, 0.5, 0.5, body = 'slab', quantity = 'velocity_x' /
&output history_every = 1e-7 /
"""


def push(t: float) -> float:
    """The pulse: a triangle [Pa]."""
    return PRESSURE * max(0.0, 1 - abs(t / RISE - 1))


def exact(t: float) -> float:
    """Velocity of the free face: twice that of each wave that arrives; d'Alembert."""
    travel = LENGTH / SPEED
    waves = sum(push(t - k * travel) for k in range(1, 2 + int(t / travel), 2))
    return 2 * waves / (DENSITY * SPEED)


def measures(history: History) -> Measures:
    """Peak of the first arrival, its time, and the rms error until the end over that peak."""
    first = [(t, v) for t, v in history if t < 1.5 * LENGTH / SPEED + 2 * RISE]
    time, peak = max(first, key=lambda point: point[1])
    square = sum((v - exact(t)) ** 2 for t, v in history) / len(history)
    top = 2 * PRESSURE / (DENSITY * SPEED)
    return {"peak": peak, "time": time, "rms": math.sqrt(square) / top}


def _ours(n: int, alpha: float | None = None) -> Run:
    def write(folder):
        text = DECK.format(spacing=LENGTH / n, more="" if alpha is None else f", alpha = {alpha}")
        (folder / "deck.nml").write_text(text, encoding="utf-8")

    def read(folder):
        history = column(folder, "face")
        return measures(history), history

    name = f"Brisance, {n} particles" + ("" if alpha is None else f", alpha {alpha}")
    return Run(name, "brisance", f"{n} particles", write, read)


def _row(n: int) -> str:
    """A row of linear bricks that cannot widen, implicit."""
    h, b = LENGTH / n, LENGTH / n
    lines = ["*NODE, NSET=ALL"]
    for k in range(n + 1):
        corners = ((0, 0), (b, 0), (b, b), (0, b))
        lines += [
            f"{4 * k + j + 1}, {y:.9g}, {z:.9g}, {k * h:.9g}" for j, (y, z) in enumerate(corners)
        ]
    lines.append("*ELEMENT, TYPE=C3D8, ELSET=ROW")
    lines += [f"{k + 1}, " + ", ".join(str(4 * k + j) for j in range(1, 9)) for k in range(n)]
    lines += ["*MATERIAL, NAME=M", f"*ELASTIC\n{YOUNG:g}, {POISSON}\n*DENSITY\n{DENSITY:g}"]
    lines += ["*SOLID SECTION, ELSET=ROW, MATERIAL=M", "*BOUNDARY\nALL, 1, 2, 0."]
    lines += [f"*NSET, NSET=FACE\n{4 * n + 1}", "*AMPLITUDE, NAME=A"]
    lines += [f"0., 0., {RISE}, {PRESSURE:g}", f"{2 * RISE}, 0., {END}, 0."]
    lines += ["*STEP, INC=100000", "*DYNAMIC, DIRECT, ALPHA=0.", f"{STEP}, {END}"]
    lines += ["*DLOAD, AMPLITUDE=A\n1, P1, 1.", "*NODE PRINT, NSET=FACE\nV", "*END STEP"]
    return "\n".join(lines) + "\n"


def _elements(n: int) -> Run:
    def write(folder):
        (folder / "model.inp").write_text(_row(n), encoding="utf-8")

    def read(folder):
        history = [(0.0, 0.0), *bricks.printed(folder)]
        return measures(history), history

    return Run(f"CalculiX, {n} elements", "calculix", f"{n} C3D8", write, read)


CASE = Case(
    name="stress_wave",
    mark="W1",
    title="Elastic wave in a slab",
    setting="100 mm of steel in uniaxial strain, a triangle of 100 MPa and 8 us on one face; "
    "velocity of the free face.",
    reference="d'Alembert",
    quantities=(
        Quantity("peak", "peak", "m/s", 1, 4, 2 * PRESSURE / (DENSITY * SPEED), 0.04),
        Quantity("time", "at", "us", 1e6, 4, LENGTH / SPEED + RISE, 0.01),
        Quantity("rms", "rms error", "%", 1e2, 2),
    ),
    runs=(_ours(100), _ours(200), _ours(400), _ours(200, 0.1), _elements(100), _elements(200)),
    axes=("time [us]", "velocity of the free face [m/s]"),
    scales=(1e6, 1),
    exact=lambda: [(k * END / 600, exact(k * END / 600)) for k in range(601)],
    remarks={
        "Brisance, 200 particles": "viscosity (alpha 1) flattens the tip three times as much as "
        "elements do",
        "Brisance, 200 particles, alpha 0.1": "for bodies that stay elastic: a twenty-fifth of the "
        "time of as many elements",
        "CalculiX, 100 elements": "better: nothing damps; it rings before and behind the pulse",
    },
)
