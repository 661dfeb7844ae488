# SPDX-License-Identifier: MIT
"""Curves over time: energy, gauges, motion. Each function writes one PNG and returns a caption."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from post.blast import Pulse
from post.compare import Reference
from post.errors import PostError
from post.gauges import Expected, Gauge, expect, list_gauges, measure, pressure_gauges
from post.reader import History, Run
from post.style import BLUE, CYCLE, GREEN, GREY, ORANGE, RED, legend_above, new_figure, save
from post.units import scale_for, show

PER_PICTURE = 3  # gauges in one picture
PARTS = {1: "the whole scene", 2: "the half that is modelled", 4: "the quarter that is modelled"}


@dataclass(frozen=True)
class Picture:
    """A PNG file and what an engineer sees in it."""

    path: Path
    title: str
    caption: str


# columns of energy.csv: name, label, line style
AIR = (
    ("air_internal", "air, internal", "-"),
    ("air_kinetic", "air, kinetic", "-"),
    ("air_outflow", "left through the outer faces", "-"),
    ("air_ledger", "kept for solid cells", "--"),
)
SOLID = (
    ("air_work", "given by the air", "-"),
    ("solid_kinetic", "kinetic", "-"),
    ("solid_internal", "internal (elastic and spent)", "-"),
    ("hourglass", "hourglass", "-"),
    ("viscous", "spent in artificial viscosity", "--"),
    ("plastic", "spent in plastic work", "--"),
    ("damage", "spent in damage", "--"),
)


def energy_column(history: History, name: str) -> np.ndarray | None:
    """A column of energy.csv by name, also where the name needs its unit; None if absent."""
    for label in (name, f"{name}[J]"):
        if label in history:
            return history[label]
    return None


def energy_residual(history: History) -> np.ndarray | None:
    """Relative error of the total energy, from the column `error` or `ratio`, or the total."""
    if "error" in history:
        return history["error"]
    if "ratio" in history:
        return history["ratio"] - 1
    total = energy_column(history, "total")
    if total is None or not len(total) or total[0] == 0:
        return None
    return total / total[0] - 1


def draw_energy(run: Run, folder: Path) -> Picture:
    """Where the energy is, what the solids did with theirs, and what is unaccounted for."""
    history = run.energy
    if not len(history):
        raise PostError(f"{history.path}: has no rows yet")
    panels = [(group, title) for group, title in ((AIR, "Air and total"), (SOLID, "Solids"))]
    panels = [(group, title) for group, title in panels if _worth_drawing(history, group)]
    figure, axes = new_figure(
        len(panels) + 1,
        2.5,
        sharex=True,
        gridspec_kw={"height_ratios": [3] * len(panels) + [1.6]},
        squeeze=False,
    )
    axes = axes[:, 0]
    factor, unit = scale_for(history.time, "s")
    time = history.time / factor
    for axis, (group, title) in zip(axes, panels, strict=False):
        _draw_energies(axis, history, time, group, title)
    _draw_residual(axes[-1], history, time)
    axes[-1].set_xlabel(f"time [{unit}]")
    part = PARTS.get(run.deck.images, "the part that is modelled")
    axes[0].set_title(f"{axes[0].get_title(loc='left')}: energies of {part}")
    caption = (
        f"Energies of {part}. Solid lines are stores and flows, dashed lines are parts of the "
        "internal energy that were spent for good. The lowest panel is the total energy over its "
        f"initial value less one: largest {_largest(energy_residual(history))}."
    )
    return Picture(save(figure, folder / "energy.png"), "Energy history", caption)


def _largest(residual: np.ndarray | None) -> str:
    return "unknown" if residual is None else f"{np.nanmax(np.abs(residual)):.1e}"


def _worth_drawing(history: History, group: tuple) -> list:
    """Members of a group whose column exists and is not zero throughout."""
    found = []
    for name, label, line in group:
        values = energy_column(history, name)
        if values is not None and np.nanmax(np.abs(values)) > 0:
            found.append((values, label, line))
    return found


def _draw_energies(axis, history: History, time: np.ndarray, group: tuple, title: str) -> None:
    curves = _worth_drawing(history, group)
    if group is AIR and (total := energy_column(history, "total")) is not None:
        curves.append((total, "total of everything", "-"))
    factor, unit = scale_for(np.concatenate([values for values, _, _ in curves]), "J")
    for i, (values, label, line) in enumerate(curves):
        whole = label.startswith("total")
        color = "#20242a" if whole else CYCLE[i % len(CYCLE)]
        axis.plot(time, values / factor, line, color=color, label=label, lw=2.2 if whole else 1.5)
    axis.set_title(title)
    axis.set_ylabel(f"energy [{unit}]")
    axis.margins(x=0)
    axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), handlelength=1.6)


def _draw_residual(axis, history: History, time: np.ndarray) -> None:
    residual = energy_residual(history)
    if residual is None:
        axis.text(0.5, 0.5, "no total energy in energy.csv", ha="center", transform=axis.transAxes)
        return
    top = float(np.nanmax(np.abs(residual)))
    power = math.floor(math.log10(top)) if top > 0 else 0
    axis.axhline(0, color=GREY, lw=0.8)
    axis.plot(time, residual / 10.0**power, color=RED, lw=1.2)
    name = "1" if power == 0 else rf"$10^{{{power}}}$"
    axis.set_ylabel(f"error [{name}]")
    axis.set_title("Unaccounted energy over initial energy")


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
    place = (
        ""
        if gauge.at is None
        else " at ({}) mm".format(", ".join(f"{1e3 * x:g}" for x in gauge.at))
    )
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
        late = expected.blast.arrival > 0.25 * time[-1]
        _note(axis, show(expected.peak, "Pa"), (start, expected.peak / pf), late, color=ORANGE)
    low, high = axis.get_ylim()
    axis.set_ylim(low, 1.08 * high)
    if pulse.reached:
        _mark_pulse(axis, pulse, time[-1], tf, pf)
        _draw_impulse(axis, time, over, pulse, (tf, tu))
        _shade(axis, time, over, pulse, (tf, pf))
    _draw_references(axis, gauge, references, (tf, pf))
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


def _mark_pulse(axis, pulse: Pulse, end: float, tf: float, pf: float) -> None:
    """Arrival as a dotted line, the peak as a dot, both with their values."""
    if math.isfinite(pulse.arrival):
        axis.axvline(pulse.arrival / tf, color=GREY, lw=0.9, ls=":")
        late = pulse.arrival > 0.25 * end
        text = f"arrival {show(pulse.arrival, 's')}"
        _note(axis, text, (pulse.arrival / tf, 0.35 * pulse.peak / pf), left=late)
    axis.plot(pulse.peak_time / tf, pulse.peak / pf, "o", color=BLUE, ms=4.5)
    text = f"peak {show(pulse.peak, 'Pa')} at {show(pulse.peak_time, 's')}"
    _note(axis, text, (pulse.peak_time / tf, pulse.peak / pf))


def _note(axis, text: str, at: tuple, left: bool = False, rise: float = 0, **text_options):
    """A short text beside a point, on a white ground so that curves do not cross it."""
    axis.annotate(
        text,
        at,
        xytext=(-7 if left else 7, rise),
        textcoords="offset points",
        ha="right" if left else "left",
        va="center",
        fontsize=8.5,
        zorder=5,
        bbox={"boxstyle": "round,pad=0.15", "fc": "white", "ec": "none", "alpha": 0.85},
        **text_options,
    )


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
    right.annotate(
        f"impulse {sign}{show(pulse.impulse, 'Pa s')}",
        (end / tf, pulse.impulse / factor),
        xytext=(-4, -16),
        textcoords="offset points",
        ha="right",
        va="top",
        color=GREEN,
        fontsize=8.5,
        bbox={"boxstyle": "round,pad=0.15", "fc": "white", "ec": "none", "alpha": 0.85},
    )
    right.plot(end / tf, pulse.impulse / factor, "o", color=GREEN, ms=4)


def _shade(axis, time, over, pulse: Pulse, scale: tuple) -> None:
    tf, pf = scale
    start = pulse.arrival if math.isfinite(pulse.arrival) else time[0]
    end = start + pulse.duration if math.isfinite(pulse.duration) else time[-1]
    phase = (time >= start) & (time <= end)
    axis.fill_between(time / tf, over / pf, 0, where=phase, color=BLUE, alpha=0.12, lw=0)


def _draw_references(axis, gauge: Gauge, references: list[Reference], scale: tuple) -> None:
    """Values of the reference file: a line for a peak, a tick for a time."""
    tf, vf = scale
    own = {r.quantity: r for r in references if r.gauge in (gauge.id, gauge.column)}
    if "peak" in own:
        value = math.copysign(own["peak"].value, _sign_of(axis)) / vf
        label = own["peak"].source
        axis.axhline(value, color=RED, lw=1.0, ls="-.", label=label)
    for name in ("arrival", "peak_time"):
        if name in own:
            axis.axvline(own[name].value / tf, color=RED, lw=1.0, ls="-.")


def _sign_of(axis) -> float:
    """Sign of the largest magnitude that is drawn."""
    values = np.concatenate([line.get_ydata() for line in axis.lines[:1]])
    return float(values[np.argmax(np.abs(values))]) or 1.0


def draw_motion(run: Run, references: list[Reference], folder: Path) -> Picture | None:
    """Displacement and velocity gauges of the bodies; None if there is nothing to draw."""
    gauges = [g for g in list_gauges(run) if g.quantity.startswith(("displacement", "velocity"))]
    gauges = [g for g in gauges if g.body]
    groups = [
        [g for g in gauges if g.quantity.startswith(kind)] for kind in ("displacement", "velocity")
    ]
    if not groups[0] and any(frame.solid_path for frame in run.frames):
        return _draw_dumped_motion(run, folder)
    groups = [group for group in groups if group]
    if not groups or not len(run.gauges):
        return None
    figure, axes = new_figure(len(groups), 2.7, sharex=True, squeeze=False)
    texts = []
    for axis, group in zip(axes[:, 0], groups, strict=True):
        texts += _draw_motions(axis, run, group, references)
    unit = scale_for(run.gauges.time, "s")[1]
    axes[-1, 0].set_xlabel(f"time [{unit}]")
    return Picture(save(figure, folder / "motion.png"), "Motion of the bodies", " ".join(texts))


def _draw_motions(axis, run: Run, group: list[Gauge], references: list[Reference]) -> list[str]:
    """Gauges of one kind in one panel; returns a sentence for each."""
    time, texts = run.gauges.time, []
    tf, _ = scale_for(time, "s")
    vf, vu = scale_for(np.concatenate([run.gauges[g.column] for g in group]), group[0].unit)
    kind = group[0].quantity.split("_")[0]
    for i, gauge in enumerate(group):
        values, color = run.gauges[gauge.column], CYCLE[i % len(CYCLE)]
        direction = gauge.quantity.split("_")[-1]
        axis.plot(
            time / tf, values / vf, color=color, label=f"{gauge.id}: {kind} along {direction}"
        )
        _draw_references(axis, gauge, references, (tf, vf))
        if not np.isfinite(values).all():
            texts.append(f"{gauge.id} holds values that are not finite.")
            continue
        top = int(np.argmax(np.abs(values)))
        text = f"{show(values[top], gauge.unit)} at {show(time[top], 's')}"
        axis.plot(time[top] / tf, values[top] / vf, "o", color=color, ms=4.5)
        rise = 12 if values[top] > 0 else -12
        at, left = (time[top] / tf, values[top] / vf), time[top] > 0.6 * time[-1]
        _note(axis, text, at, left=left, rise=rise)
        texts.append(f"Largest {kind} of {gauge.id}: {text}.")
    axis.set_ylabel(f"{kind} [{vu}]")
    axis.set_title(kind.capitalize())
    axis.set_xlim(time[0] / tf, time[-1] / tf)
    axis.margins(y=0.12)
    legend_above(axis)
    return texts


def _draw_dumped_motion(run: Run, folder: Path) -> Picture:
    """Without a displacement gauge: the particle that moved farthest, from the dumps."""
    frames = [frame for frame in run.frames if frame.solid_path]
    last = frames[-1].solid("displacement", "id").field
    row = int(np.argmax(np.linalg.norm(last["displacement"], axis=1)))
    number = last["id"][row]
    time = np.array([frame.time for frame in frames])
    move = np.array([frame.solid("displacement").field["displacement"][row] for frame in frames])
    figure, axis = new_figure(1, 3.0)
    tf, tu = scale_for(time, "s")
    vf, vu = scale_for(move, "m")
    for d, name in enumerate("xyz"):
        axis.plot(time / tf, move[:, d] / vf, "o-", ms=3.5, label=f"along {name}")
    axis.set_xlabel(f"time [{tu}]")
    axis.set_ylabel(f"displacement [{vu}]")
    axis.set_title(f"Displacement of particle {number}")
    axis.legend()
    caption = f"Particle {number}, which is displaced farthest at the end; one mark per dump."
    return Picture(save(figure, folder / "motion.png"), "Motion of the bodies", caption)
