# SPDX-License-Identifier: MIT
"""Where a reference curve for plates applies to a run: Nurick-Martin beside its permanent set."""

from __future__ import annotations

import math

import numpy as np

from post.compare import Reference
from post.deck import AXES, Body, as_list
from post.gauges import list_gauges
from post.reader import Run
from post.reference_curves import ClampedPlate, PlateDeflection, nurick_martin

LAWS = ("bilinear_j2", "cowper_symonds")  # models whose static yield stress is one key


def plate_references(run: Run) -> list[Reference]:
    """Nurick and Martin's permanent deflection for each gauge in the middle of a clamped plate.

    A box held at its sides, of a law with one yield stress, under the impulse of the air or under
    `&load pressure` on a face; only within the range of the curve.
    """
    found = []
    for body in run.deck.bodies():
        expected = _expected(run, body)
        if expected is None or not expected.in_range:
            continue
        normal = int(np.argmin(body.high - body.low))
        middle = (body.low + body.high) / 2
        across = [d for d in range(3) if d != normal]
        for gauge in list_gauges(run):
            near = gauge.at is not None and np.all(
                np.abs(gauge.at - middle)[across] <= 1.01 * body.step[across]
            )
            if gauge.body == body.id and near and gauge.quantity == f"displacement_{AXES[normal]}":
                source = f"Nurick-Martin, phi {expected.phi:.3g}, tests within "
                source += f"{1e3 * expected.scatter:.2g} mm"
                found.append(
                    Reference("permanent_set", gauge.column, expected.deflection, "m", source)
                )
    return found


def _expected(run: Run, body: Body) -> PlateDeflection | None:
    """The line for one body; None where it is no clamped plate of a law with one yield stress."""
    group = next((g for g in run.deck.groups("body") if str(g.get("id")) == body.id), {})
    law = next((g for g in run.deck.groups("material") if g.get("id") == body.material), {})
    strength = law.get("yield_stress")
    held = "sides" in as_list(group.get("fix"))
    if body.shape != "box" or not held or strength is None or law.get("model") not in LAWS:
        return None
    normal = int(np.argmin(body.high - body.low))
    width = float(group.get("fix_width") or 0.0)
    width = width or float(group.get("fix_layers") or 3) * body.spacing
    across = [d for d in range(3) if d != normal]
    sides = [float(body.high[d] - body.low[d]) - 2 * width for d in across]
    if int(run.deck.get("run", "dimension", 3)) != 3 or min(sides) <= 0:
        return None
    impulse = abs(_impulse(run, body, normal, math.prod(sides)))
    thickness = float(body.high[normal] - body.low[normal])
    plate = ClampedPlate(thickness, float(law["density"]), float(strength), (sides[0], sides[1]))
    try:
        return nurick_martin(impulse, plate)
    except ValueError:
        return None


def _impulse(run: Run, body: Body, normal: int, area: float) -> float:
    """Of the loads of the deck on the free part of a plate, or of the air on it [N s]."""
    total = 0.0
    for load in run.deck.groups("load"):
        if str(load.get("body")) == body.id and load.get("pressure") is not None:
            time = np.array(as_list(load.get("time")), float)
            total += float(np.trapezoid(np.array(as_list(load.get("pressure")), float), time))
    if total:
        return total * area
    history, name = run.history("energy"), f"impulse_{AXES[normal]}"
    if history is None or name not in history or len(run.deck.bodies()) > 1:
        return 0.0
    whole = body.high - body.low
    face = math.prod(float(whole[d]) for d in range(3) if d != normal)
    return float(history[name][-1]) * run.deck.images * area / face
