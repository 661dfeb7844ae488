# SPDX-License-Identifier: MIT
"""The page of a certificate: intervals, error against seconds, histories with bands."""

from __future__ import annotations

import math
from html import escape
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from post.certify import Certificate, Certified
from post.convergence import Band, band_of
from post.errors import PostError
from post.history import read_history
from post.page import PAGE, html_picture, html_problems, html_table
from post.style import (
    BLUE,
    CYCLE,
    DPI,
    GREY,
    INK,
    RED,
    WIDTH,
    Picture,
    legend_above,
    new_figure,
    save,
)
from post.tables import Table, as_text
from post.units import scale_for, show

MOST_CURVES, MOST_PANELS, MOST_HISTORIES = 6, 12, 6
DOTS, NEXT = 3, 2  # levels of a band; finer levels that are drawn ahead
LEAST_ERROR = 1e-4  # of the scale: smaller distances are drawn there


def make_certificate_page(found: Certificate, out: Path) -> tuple[Path, str]:
    """Write `certify.html` and its pictures; the path, and table and sentences as text."""
    table = interval_table(found)
    first = sentence(found)
    advice = recommendation(found)
    pictures = [p for p in (_draw_cost(found, out), _draw_spacing(found, out),
                            _draw_histories(found, out)) if p]  # fmt: skip
    levels = level_table(found)
    parts = [f"<p>{escape(first)}</p>", f"<p>{escape(advice)}</p>" if advice else ""]
    parts += [html_problems(found.plan.notes + found.notes), html_table(table)]
    chance = scatter_table(found)
    parts += [html_table(chance)] if chance.rows else []
    parts += [*map(html_picture, pictures), html_table(levels)]
    page = out / "certify.html"
    title = f"Error bars of {found.job}"
    page.write_text(PAGE.format(title=escape(title), body="\n".join(parts)), encoding="utf-8")
    notes = [f"note: {text}" for text in found.notes]
    more = [as_text(chance)] if chance.rows else []
    return page, "\n".join([as_text(table), *more, *notes, first, advice])


def interval_table(found: Certificate) -> Table:
    """Every result with its interval and what is to be said of it."""
    rows = []
    for row in found.rows:
        one = row.interval
        if one.verdict == "nothing":
            rows.append((row.name, "0", "", "", "nothing beside the largest of its kind"))
            continue
        ends = f"{show(one.low, row.unit, 4)} to {show(one.high, row.unit, 4)}"
        if one.half > abs(one.value) and row.scale > 2 * abs(one.value):  # small beside its kind
            ends = f"below {show(max(abs(one.low), abs(one.high)), row.unit, 2)}"
        width = f"{100 * one.half / row.scale:.2g} %"
        grey = "" if one.promised else " (not promised)"
        rows.append((row.name, show(one.value, row.unit, 4), ends, width, one.verdict + grey))
    note = (
        "Half widths over the natural scale: of an energy the largest energy, of a value at the "
        "end its peak. Promised intervals hold the value for vanishing spacing in 9 of 10, by the "
        "runs of the manual, Certify. It is the number of cells and particles that this speaks of, "
        "not the model."
    )
    return Table("Intervals", ("result", "value", "interval", "+-", "verdict"), rows, note)


def scatter_table(found: Certificate) -> Table:
    """What chance does to results that are not promised, where an ensemble was asked for."""
    units = {row.name: row.unit for row in found.rows}
    rows = [
        (name, show(one.mean, units[name], 4), f"+- {show(one.mean_half, units[name], 2)}",
         f"+- {show(one.one_half, units[name], 2)}", str(one.members))
        for name, one in found.scatter.items()
    ]  # fmt: skip
    heads = ("result", "mean", "of the mean", "one test more", "members")
    note = (
        "Members differ by a jitter of a thousandth of a spacing. Of the mean: what spacing and "
        "number of members leave open; one test more: chance alone, 9 of 10. Both are needed: a "
        "jitter is not the error of the spacing."
    )
    return Table("Ensemble", heads, rows, note)


def level_table(found: Certificate) -> Table:
    """What was run: the numbers, what was set, and what it cost."""
    rows = []
    for level, one in zip(found.plan.levels, found.outcomes, strict=True):
        numbers = ", ".join(
            f"{k.name}: {n}" for k, n in zip(found.plan.knobs, level.numbers, strict=True)
        )
        cost = f"{one.seconds:.3g} s" if math.isfinite(one.seconds) else "–"
        rows.append((f"{level.width:.3g}", numbers, cost, one.state, " ".join(level.sets)))
    heads = ("spacing over yours", "cells and layers", "core-seconds", "", "--set")
    return Table("Levels", heads, rows)


def sentence(found: Certificate) -> str:
    """'mid:displacement_z peak 18.9 mm, 18.1 to 19.7 mm with 9 chances in 10 ...'."""
    row = found.headline
    if row is None:
        return "Nothing is promised: no result converges on these three spacings."
    one = row.interval
    return (
        f"{row.name} {show(one.value, row.unit)}, {show(one.low, row.unit)} to "
        f"{show(one.high, row.unit)} with 9 chances in 10 ({one.verdict}). It is the number of "
        "cells that this speaks of, not the model."
    )


def recommendation(found: Certificate) -> str:
    """What a coarser run would miss and save, and what half of the error would cost."""
    row, seconds = found.headline, [one.seconds for one in found.outcomes if one.done]
    if row is None or len(seconds) < 2 or not all(map(math.isfinite, seconds[:2])):
        return ""
    one, plan = row.interval, found.plan
    missed = abs(row.values[1] - one.best) / row.scale
    saved = 1 - seconds[1] / seconds[0]
    scarce = plan.knobs.index(plan.scarce)
    coarse = plan.levels[1].numbers[scarce]
    cost = seconds[0] * 2 ** (plan.dimension + 1)
    extra = sum(seconds[1:]) / seconds[0]
    text = (
        f"Extra cost {100 * extra:.0f} %. With {plan.scarce.name} at {coarse} (of "
        f"{plan.levels[0].numbers[scarce]}) {row.name} is {100 * missed:.2g} % off, and "
        f"{100 * saved:.0f} % of the time is saved. Half of the error: "
        f"{2 * plan.levels[0].numbers[scarce]}, about {show(cost, 's', 2)} of one core."
    )
    if math.isfinite(found.want):
        factor = max(one.half / row.scale / found.want, 1e-9)
        n = math.ceil(plan.levels[0].numbers[scarce] * max(factor, 0.0))
        time = seconds[0] * factor ** (plan.dimension + 1)
        text += f" For {100 * found.want:g} %: {n}, about {show(time, 's', 2)}."
    return text


def _shown(found: Certificate, most: int) -> list[Certified]:
    """The results that are drawn: those asked for, else the ones that come first."""
    asked = [row for row in found.rows if row.name in found.wanted]
    peaks = {row.name.removesuffix(" peak"): row.values for row in found.rows}
    rest = [
        row
        for row in found.rows
        if row.interval.verdict != "nothing"
        and row.values != (row.name.endswith(" end") and peaks.get(row.name.removesuffix(" end")))
    ]
    gauges = [row for row in rest if ":" in row.name]
    others = [row for row in rest if ":" not in row.name]
    return (asked or [*gauges, *others])[:most]


def _draw_cost(found: Certificate, out: Path) -> Picture | None:
    """Error against seconds of this scene."""
    seconds = [one.seconds for one in found.outcomes if one.done]
    if not all(map(math.isfinite, seconds)):
        return None
    figure, axis = new_figure(1, 4.0)
    power = found.plan.dimension + 1
    ratio = found.plan.levels[1].width / found.plan.levels[0].width
    for row, own in zip(_shown(found, MOST_CURVES), CYCLE, strict=False):
        one = row.interval
        color = own if one.promised else "#b9bfc6"
        half = 100 * one.half / row.scale
        miss = [100 * max(abs(v - one.best) / row.scale, LEAST_ERROR) for v in row.values]
        ordered = one.best != one.value
        shown = miss if ordered else miss[1:]
        places = seconds[: len(row.values)] if ordered else seconds[1 : len(row.values)]
        label = row.name if one.promised else f"{row.name}: {one.verdict}"
        axis.plot(places, shown, "o-", color=color, ms=4, lw=1.1, label=label)
        axis.plot([seconds[0]], [half], "_", color=color, ms=16, mew=2)
        if one.promised:
            ahead = [seconds[0] * ratio ** (power * k) for k in range(NEXT + 1)]
            axis.plot(ahead, [half / ratio**k for k in range(NEXT + 1)], "--", color=color, lw=1)
    if math.isfinite(found.want):
        axis.axhline(100 * found.want, color=INK, lw=1, ls=":", label="wanted")
    axis.axvline(seconds[0], color=GREY, lw=0.8)
    axis.annotate(" your run", (seconds[0], 0.99), xycoords=("data", "axes fraction"), va="top",
                  fontsize=8.5, color=GREY)  # fmt: skip
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xlabel("seconds of one core")
    axis.set_ylabel("error [% of the natural scale]")
    legend_above(axis)
    caption = (
        "Dots: distance from the best estimate; of your run only where an order was seen. Bars: "
        "half width of its interval; dashed: what the next two finer levels would have. Grey: not "
        "promised."
    )
    return Picture(save(figure, out / "error_seconds.png"), "Error against seconds", caption)


def _draw_spacing(found: Certificate, out: Path) -> Picture | None:
    """Each result over the spacing, with its interval at your spacing."""
    rows = _shown(found, MOST_PANELS)
    if not rows:
        return None
    columns = min(3, len(rows))
    lines = -(-len(rows) // columns)
    figure, axes = plt.subplots(
        lines, columns, figsize=(WIDTH, 2.0 * lines + 0.3), squeeze=False, dpi=DPI
    )
    h = [w for w, one in zip(found.widths, found.outcomes, strict=True) if one.done]
    for axis, row in zip(axes.ravel(), rows, strict=False):
        one = row.interval
        factor, unit = scale_for(row.values, row.unit)
        color = BLUE if one.promised else GREY
        axis.plot(h[: len(row.values)], np.array(row.values) / factor, "o-", color=color, ms=4)
        axis.errorbar([h[0]], [one.value / factor], yerr=[[one.half / factor]] * 2, color=RED,
                      capsize=4, lw=1.5)  # fmt: skip
        axis.plot([0], [one.best / factor], "x", color=RED, ms=5)
        axis.set_xlim(-0.08 * h[-1], 1.06 * h[-1])
        axis.set_title(f"{row.name}\n{one.verdict}", fontsize=7.5, fontweight="normal", color=color)
        axis.set_ylabel(f"[{unit}]", fontsize=8)
        axis.tick_params(labelsize=8)
    for spare in axes.ravel()[len(rows) :]:
        spare.set_visible(False)
    figure.supxlabel("spacing over that of your run", fontsize=9)
    caption = "Red: the interval at your spacing, and (cross, at 0) the best estimate."
    return Picture(save(figure, out / "spacing.png"), "Results over the spacing", caption)


def bands(found: Certificate) -> dict[str, tuple[Band, list, str]]:
    """Bands of the gauges that all three levels have: band, curves finest first, unit."""
    if len(found.histories) < DOTS:
        return {}
    try:
        rows = [read_history(folder / "gauges.csv") for folder in found.histories[:DOTS]]
    except PostError:
        return {}
    h = [w for w, one in zip(found.widths, found.outcomes, strict=True) if one.done][:DOTS]
    made = {}
    for name in rows[0].names[1:]:
        curves = [(r.time, r[name]) for r in rows if name in r]
        same = len(curves) == DOTS and all(len(t) > 3 and np.isfinite(v).all() for t, v in curves)
        if same and np.ptp(curves[0][1]) > 0:
            made[name] = band_of(h, curves), curves, rows[0].unit(name)
    return made


def _draw_histories(found: Certificate, out: Path) -> Picture | None:
    """Histories of the three levels, the band in the colour of the finest."""
    made = list(bands(found).items())[:MOST_HISTORIES]
    if not made:
        return None
    figure, axes = new_figure(len(made), 2.1, squeeze=False, sharex=True)
    for axis, (name, (band, curves, unit)) in zip(axes[:, 0], made, strict=True):
        (tf, tu), (vf, vu) = scale_for(band.time, "s"), scale_for(curves[0][1], unit)
        low, high = band.low / vf, band.high / vf
        axis.fill_between(band.time / tf, low, high, color=BLUE, alpha=0.22, lw=0)
        for k, (time, values) in enumerate(curves):
            width, color = 1.6 - 0.5 * k, (BLUE, "#5b8bb8", GREY)[k]
            level = found.plan.levels[k]
            label = f"spacing {level.width:.2f}"
            axis.plot(time / tf, values / vf, color=color, lw=width, label=label)
        at, late = band.arrival
        foot = axis.get_ylim()[0]
        axis.plot([(at - late) / tf, (at + late) / tf], [foot, foot], color=RED, lw=3,
                  solid_capstyle="butt")  # fmt: skip
        axis.set_ylabel(f"[{vu}]")
        axis.set_title(name)
        axis.set_xlabel(f"time [{tu}]")
    legend_above(axes[0, 0])
    caption = (
        "Band: one and a half times what is left of an error of first order, after the three were "
        "laid over each other by their arrivals; red at the foot: the interval of the arrival."
    )
    return Picture(save(figure, out / "histories.png"), "Histories with bands", caption)
