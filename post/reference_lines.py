# SPDX-License-Identifier: MIT
"""Values of a reference file as lines in a picture, each with its name."""

from __future__ import annotations

import math

import numpy as np

from post.compare import Reference
from post.gauges import Gauge
from post.style import INK
from post.units import show

TIMES = {"arrival": ":", "peak_time": "--"}  # line styles
LEVELS = {"peak": "-.", "final": (0, (6, 2)), "permanent_set": (0, (3, 1))}


def draw_references(axis, gauge: Gauge, references: list[Reference], scale: tuple) -> None:
    """A line for each value of a reference file that belongs to a gauge, named in the legend.

    Levels for a peak and for the value at the end, upright lines for times. `scale` is that of
    the two axes.
    """
    tf, vf = scale
    for own in references:
        if own.gauge not in (gauge.id, gauge.column):
            continue
        name = f"{own.quantity.replace('_', ' ')} {show(own.value, own.unit)}: {own.source}"
        if own.quantity in LEVELS:
            value = own.value if own.quantity == "final" else math.copysign(own.value, _sign(axis))
            axis.axhline(value / vf, color=INK, lw=1.0, ls=LEVELS[own.quantity], label=name)
        elif own.quantity in TIMES:
            axis.axvline(own.value / tf, color=INK, lw=1.0, ls=TIMES[own.quantity], label=name)


def _sign(axis) -> float:
    """Sign of the largest magnitude that is drawn."""
    values = np.concatenate([line.get_ydata() for line in axis.lines[:1]])
    values = values[np.isfinite(values)]
    return float(values[np.argmax(np.abs(values))]) or 1.0 if len(values) else 1.0
