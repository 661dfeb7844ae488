# SPDX-License-Identifier: MIT
"""Pressure gauges: what they measured, beside what is known."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from post.blast import Pulse
from post.compare import Reference
from post.errors import PostError
from post.gauges import Expected, Gauge, expect, measure, pressure_gauges
from post.labels import note
from post.reader import Run
from post.reference_lines import draw_references
from post.style import BLUE, GREEN, GREY, ORANGE, RED, Picture, legend_above, new_figure, save
from post.units import scale_for, show, show_point

PER_PICTURE = 3  # gauges in one picture


def draw_gauges(run: Run, references: list[Reference], folder: Path) -> list[Picture]:
    """Pressure gauges with arrival, peak and impulse marked, beside Kingery-Bulmash."""
    gauges = pressure_gauges(run)
    pictures = []
    for start in range(0, len(gauges), PER_PICTURE):
        group = gauges[start : start + PER_PICTURE]
        figure, axes = new_figure(len(group), 3.1, squeeze=False)
        texts = [
            _draw_gauge(axis, run, gauge, references)
            for axis, gauge in zip(axes[:, 0], group, strict=True)
        ]
        name = "gauges.png" if start == 0 else f"gauges_{start // PER_PICTURE + 1}.png"
        names = ", ".join(gauge.id for gauge in group)
        title = f"Pressure at gauge{'s' if len(group) > 1 else ''} {names}"
        caption = (
            "Overpressure (blue) and its running integral, the impulse (green, right axis). "
            "Shaded: positive phase. Arrival: 10 % of the peak is passed. Kingery-Bulmash is "
            "drawn as a Friedlander pulse of its arrival, peak, duration and impulse. "
            + " ".join(texts)
        )
        pictures.append(Picture(save(figure, folder / name), title, caption))
    return pictures


def _draw_gauge(axis, run: Run, gauge: Gauge, references: list[Reference]) -> str:
    """One gauge; returns a sentence on it."""
    place = "" if gauge.at is None else f" at {show_point(gauge.at)}"
    axis.set_title(f"{gauge.id}{place}")
    try:
        pulse = measure(run, gauge)
    except PostError as error:
        axis.text(0.5, 0.5, str(error), ha="center", transform=axis.transAxes, color=RED)
        return f"{error}."
    time = run.gauges.time
    over = run.gauges[gauge.column] - (pulse.ambient if gauge.quantity == "pressure" else 0)
    expected = expect(run.deck, gauge)
    tf, tu = scale_for(time, "s")
    tops = [over, [expected.peak]] if expected else [over]
    pf, pu = scale_for(np.concatenate(tops), "Pa")
    axis.plot(time / tf, over / pf, color=BLUE, label="computed")
    if expected is not None:
        axis.plot(
            time / tf,
            ideal_wave(time, expected) / pf,
            color=ORANGE,
            ls="--",
            lw=1.3,
            label=f"Kingery-Bulmash, {expected.label}",
        )
        start = expected.blast.arrival / tf
        note(axis, show(expected.peak, "Pa"), (start, expected.peak / pf), color=ORANGE)
    low, high = axis.get_ylim()
    axis.set_ylim(low, 1.08 * high)
    if pulse.reached:
        _mark_pulse(axis, pulse, tf, pf)
        _draw_impulse(axis, time, over, pulse, (tf, tu))
        _shade(axis, time, over, pulse, (tf, pf))
    draw_references(axis, gauge, references, (tf, pf))
    axis.set_xlabel(f"time [{tu}]")
    axis.set_ylabel(f"overpressure [{pu}]")
    axis.set_xlim(time[0] / tf, time[-1] / tf)
    legend_above(axis)
    return _sentence(gauge, pulse, expected)


def _sentence(gauge: Gauge, pulse: Pulse, expected: Expected | None) -> str:
    if not pulse.reached:
        return f"{gauge.id} was not reached by the blast."
    text = f"{gauge.id}: front smeared over {show(pulse.rise_time, 's', 2)} (10 to 90 %)."
    if pulse.remark:
        text += f" At {gauge.id} {pulse.remark}."
    if expected is not None and not expected.reflected:
        text += (
            f" At {gauge.id} the reference is the incident wave alone, without later reflections."
        )
    return text


def ideal_wave(time: np.ndarray, expected: Expected) -> np.ndarray:
    """Friedlander pulse with the expected arrival, peak, duration and impulse [Pa], shape (n)."""
    blast = expected.blast
    ratio = expected.impulse / (expected.peak * blast.duration)
    low, high = 1e-3, 1e4
    for _ in range(100):  # the impulse falls with the decay
        b = math.sqrt(low * high)
        low, high = (b, high) if 1 / b - (1 - math.exp(-b)) / b**2 > ratio else (low, b)
    s = (time - blast.arrival) / blast.duration
    return np.where(s >= 0, expected.peak * (1 - s) * np.exp(-b * np.maximum(s, 0)), 0.0)


def _mark_pulse(axis, pulse: Pulse, tf: float, pf: float) -> None:
    """Arrival as a dotted line, the peak as a dot, both with their values."""
    if math.isfinite(pulse.arrival):
        name = "arrival, 10 % of the peak"
        axis.axvline(pulse.arrival / tf, color=GREY, lw=0.9, ls=":", label=name)
        text = f"arrival {show(pulse.arrival, 's')}"
        note(axis, text, (pulse.arrival / tf, 0.35 * pulse.peak / pf))
    axis.plot(pulse.peak_time / tf, pulse.peak / pf, "o", color=BLUE, ms=4.5)
    text = f"peak {show(pulse.peak, 'Pa')} at {show(pulse.peak_time, 's')}"
    note(axis, text, (pulse.peak_time / tf, pulse.peak / pf), color=BLUE)


def _draw_impulse(axis, time, over, pulse: Pulse, scale: tuple) -> None:
    """The running integral from arrival on, on the right axis."""
    tf, _ = scale
    steps = np.concatenate([[0.0], np.cumsum(0.5 * (over[1:] + over[:-1]) * np.diff(time))])
    start = pulse.arrival if math.isfinite(pulse.arrival) else time[0]
    values = np.where(time >= start, steps - np.interp(start, time, steps), 0.0)
    factor, unit = scale_for(values, "Pa s")
    right = axis.twinx()
    right.grid(False)
    right.plot(time / tf, values / factor, color=GREEN, lw=1.2)
    right.set_ylabel(f"impulse [{unit}]", color=GREEN)
    right.tick_params(axis="y", colors=GREEN)
    right.spines["right"].set_visible(True)
    right.spines["right"].set_color(GREEN)
    low, high = axis.get_ylim()
    top = max(float(values.max()) / factor, 1e-30) * 1.15
    right.set_ylim(top * low / high, top)
    axis.set_ylim(low, high)
    sign = "" if pulse.complete else "≥ "
    end = pulse.arrival + pulse.duration if pulse.complete else time[-1]
    text = f"impulse {sign}{show(pulse.impulse, 'Pa s')}"
    note(right, text, (end / tf, pulse.impulse / factor), color=GREEN)
    right.plot(end / tf, pulse.impulse / factor, "o", color=GREEN, ms=4)


def _shade(axis, time, over, pulse: Pulse, scale: tuple) -> None:
    tf, pf = scale
    start = pulse.arrival if math.isfinite(pulse.arrival) else time[0]
    end = start + pulse.duration if math.isfinite(pulse.duration) else time[-1]
    phase = (time >= start) & (time <= end)
    axis.fill_between(time / tf, over / pf, 0, where=phase, color=BLUE, alpha=0.12, lw=0)
