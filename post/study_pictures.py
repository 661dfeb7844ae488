# SPDX-License-Identifier: MIT
"""Pictures of studies: response curves, limits along a parameter, P-I diagrams, fragility."""

from __future__ import annotations

import math
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import LogFormatter

from post.blast import free_air
from post.designs import Parameter
from post.fragility import Curve
from post.fragment_reference import LABEL, FragmentShot, draw_thor
from post.limits import Found, Hyperbola
from post.reference_curves import LimitFit, lambert_jonas
from post.runner import Outcome
from post.style import (
    BLUE,
    DPI,
    GREEN,
    GREY,
    INK,
    ORANGE,
    RED,
    WIDTH,
    Picture,
    legend_above,
    new_figure,
    save,
)
from post.surrogate import Share, Surrogate, predict
from post.units import scale_for, show

MOST_ROWS, MOST_COLUMNS = 4, 4  # of response curves
CHARGES = (1, 10, 100, 1000, 10000)  # kg of TNT, lines in a P-I diagram
STANDOFFS = (1, 2, 5, 10, 20, 50)  # [m]


def axis_of(values, unit: str) -> tuple[float, str]:
    """Factor and unit in which numbers of a parameter or result are best read."""
    factor, name = scale_for(values, unit)
    return factor, f"[{name}]" if name not in ("", "-") else ""


def draw_responses(
    parameters: list[Parameter],
    points: list[dict],
    results: dict[str, tuple[np.ndarray, str]],
    formulas: tuple[dict[str, Surrogate], dict[str, np.ndarray]],
    folder: Path,
) -> Picture | None:
    """Each result over each parameter; the surrogate with its error at the middle of the others,
    and what THOR has for each run.

    `results` by name: values (n), not a number where a run has none, and the unit. `formulas`:
    surrogates, and values by THOR (n) in SI units, both by the name of the result.
    """
    surrogates, by_thor = formulas
    numbers = [one for one in parameters if all(isinstance(p[one.name], float) for p in points)]
    numbers = [p for p in numbers if len({point[p.name] for point in points}) > 1]
    numbers, names = numbers[:MOST_COLUMNS], list(results)[:MOST_ROWS]
    if not numbers or not names or not points:
        return None
    rows, columns = len(names), len(numbers)
    size = (WIDTH, 0.4 + (2.6 if columns < 3 else 2.0) * rows)
    figure, axes = plt.subplots(rows, columns, figsize=size, squeeze=False, dpi=DPI, sharey="row")
    for row, name in zip(axes, names, strict=True):
        values, unit = results[name]
        vf, vu = axis_of(values, unit)
        strongest, tint = _strongest(numbers, points, values)
        for axis, one in zip(row, numbers, strict=True):
            x = np.array([point[one.name] for point in points])
            xf, xu = axis_of(x, one.unit)
            shade = None if one is strongest else tint
            colours = {"color": BLUE} if shade is None else {"c": shade, "cmap": "viridis"}
            axis.scatter(x / xf, values / vf, 11, lw=0, **colours)
            if name in by_thor:
                axis.scatter(x / xf, by_thor[name] / vf, 22, marker="x", lw=1, **colours)
            if name in surrogates:
                _draw_surrogate(axis, surrogates[name], parameters, (one, xf, vf))
            if x.min() > 0 and x.max() > 10 * x.min():
                axis.set_xscale("log")
            axis.set_xlabel(f"{one.name} {xu}", fontsize=8.5)
        row[0].set_ylabel(f"{name}\n{vu}", fontsize=8.5)
        if name in by_thor:
            row[0].set_title(f"crosses: {LABEL}", loc="left", fontsize=9)
    caption = (
        "Every run is a point; in the panels of the others its colour is the parameter that the "
        "result follows most, from low (violet) to high (yellow)."
    )
    if surrogates:
        caption += (
            " Line: the surrogate with the other parameters at their medians; band: twice its "
            "cross-validated rms error."
        )
    return Picture(save(figure, folder / "responses.png"), "Response curves", caption)


def _strongest(numbers: list[Parameter], points: list[dict], values: np.ndarray) -> tuple:
    """The parameter whose order is most like that of a result, and its values by rank."""
    good = np.isfinite(values)
    ranks = {p.name: np.argsort(np.argsort([point[p.name] for point in points])) for p in numbers}
    order = np.argsort(np.argsort(values[good]))

    def alike(one: Parameter) -> float:
        own = ranks[one.name][good]
        return abs(float(np.corrcoef(own, order)[0, 1])) if np.ptp(own) and np.ptp(order) else 0.0

    best = max(numbers, key=alike)
    return best, ranks[best.name]


def _draw_surrogate(axis, surrogate: Surrogate, parameters: list[Parameter], which: tuple) -> None:
    one, xf, vf = which
    ends = [float(one.quantile(np.array(q))) for q in (0.005, 0.995)]
    x = np.linspace(*ends, 80)
    grid = np.array([[float(p.middle) for p in parameters]] * 80)
    grid[:, [p.name for p in parameters].index(one.name)] = x
    y = surrogate.sign * predict(surrogate.data, grid) / vf
    width = 2 * surrogate.error.rms
    axis.fill_between(x / xf, y * (1 - width), y * (1 + width), color=RED, alpha=0.18, lw=0)
    axis.plot(x / xf, y, color=RED, lw=1.3)


def draw_shares(shares: dict[str, list[Share]], folder: Path) -> Picture | None:
    """Bars of Sobol's indices: what each parameter alone and in all does to a result."""
    if not shares:
        return None
    names = list(shares)[:MOST_ROWS]
    figure, axes = new_figure(len(names), 0.5 + 0.28 * len(shares[names[0]]), squeeze=False)
    for axis, name in zip(axes[:, 0], names, strict=True):
        rows = shares[name]
        place = np.arange(len(rows))[::-1]
        total = [max(s.total, 0) for s in rows]
        ends = np.array([[max(t - s.low, 0), max(s.high - t, 0)]
                         for t, s in zip(total, rows, strict=True)]).T  # fmt: skip
        axis.barh(place, total, 0.62, color=BLUE, alpha=0.35, label="in all")
        axis.barh(place, [max(s.first, 0) for s in rows], 0.36, color=BLUE, label="alone")
        axis.errorbar(total, place, xerr=ends, fmt="none", ecolor=INK, lw=1, capsize=2.5)
        axis.set_yticks(place, [s.name for s in rows])
        axis.set_xlim(0, max(1.0, *(t for t in total)) * 1.02)
        axis.set_title(name)
        axis.grid(axis="y", visible=False)
    axes[0, 0].legend(loc="lower right")
    axes[-1, 0].set_xlabel("share of the variance")
    caption = (
        "Sobol's indices on the surrogate over the ranges and distributions of the study; lines: "
        "90 % by bootstrap. Alone and in all differ where parameters act together."
    )
    return Picture(save(figure, folder / "sensitivity.png"), "What decides", caption)


def draw_pi(
    limits: list[tuple[float, float, Found]],
    curve: Hyperbola | None,
    told: tuple[str, float],
    folder: Path,
) -> Picture:
    """P-I diagram: limits as (pressure [Pa], impulse [Pa s], search), hyperbola, charges.

    `told`: what the limit is, and the share by which cells leave the loads open.
    """
    what, band = told
    figure, axis = new_figure(1, 4.6)
    p, i = (np.array([row[k] for row in limits]) for k in (0, 1))
    good = np.isfinite(p) & np.isfinite(i)
    axis.loglog(i[good] / 1e3, p[good] / 1e3, "o", color=BLUE, ms=5, label=f"{what}, runs")
    if curve is not None:
        grid = curve.i0 * (1 + np.geomspace(1e-3, 50, 300))
        level = curve.pressure(grid)
        axis.plot(grid / 1e3, level / 1e3, color=BLUE, lw=1.5,
                  label=f"(P/P0 - 1)(I/I0 - 1) = {curve.c:.3g}")  # fmt: skip
        if band > 0:
            ends = [(grid * f / 1e3, level * f / 1e3) for f in (1 - band, 1 + band)]
            x, y = (np.concatenate([a, b[::-1]]) for a, b in zip(*ends, strict=True))
            label = f"cells: +-{100 * band:.2g} %"
            axis.fill(x, y, color=BLUE, alpha=0.18, lw=0, label=label)
        axis.axhline(curve.p0 / 1e3, color=GREY, lw=0.9, ls="--")
        axis.axvline(curve.i0 / 1e3, color=GREY, lw=0.9, ls="--")
        edge = i[good].max() / 1e3, p[good].max() / 1e3
        axis.annotate(f"P0 {show(curve.p0, 'Pa')}", (edge[0], curve.p0 / 1e3), ha="right",
                      va="top", fontsize=8.5, color=GREY)  # fmt: skip
        axis.annotate(f"I0 {show(curve.i0, 'Pa s')}", (curve.i0 / 1e3, edge[1]), rotation=90,
                      ha="right", va="top", fontsize=8.5, color=GREY)  # fmt: skip
    box = [i[good].min() / 2.5e3, i[good].max() / 4e2, p[good].min() / 2.5e3, p[good].max() / 5e2]
    _draw_charges(axis, box)
    axis.set_xlim(box[0], box[1])
    axis.set_ylim(box[2], box[3])
    axis.set_xlabel("impulse per area [kPa s]")
    axis.set_ylabel("peak pressure [kPa]")
    legend_above(axis)
    caption = (
        f"Above and right of the curve: {what} is passed. Thin lines: reflected pressure and "
        "impulse of Kingery and Bulmash, green for one charge, orange for one standoff."
    )
    return Picture(save(figure, folder / "pi.png"), "P-I diagram", caption)


def _draw_charges(axis, box: list[float]) -> None:
    """Lines of constant charge and standoff by Kingery-Bulmash inside a box [kPa s, kPa]."""

    def line(pairs, color, text):
        rows = np.array([_reflected(w, r) for w, r in pairs])
        rows = rows[np.isfinite(rows).all(axis=1)]
        inside = (rows[:, 0] > box[0]) & (rows[:, 0] < box[1])
        inside &= (rows[:, 1] > box[2]) & (rows[:, 1] < box[3])
        if inside.sum() < 3:
            return
        axis.plot(rows[:, 0], rows[:, 1], color=color, lw=0.8, alpha=0.8, zorder=1)
        at = rows[inside][len(rows[inside]) * 3 // 4]
        axis.annotate(text, at, fontsize=7.5, color=color, ha="center", zorder=1,
                      bbox={"fc": "white", "ec": "none", "pad": 0.6})  # fmt: skip

    for charge in CHARGES:
        distances = np.geomspace(0.1, 30, 80) * charge ** (1 / 3)
        line([(charge, r) for r in distances], GREEN, f"{charge:g} kg")
    for standoff in STANDOFFS:
        masses = (standoff / np.geomspace(30, 0.1, 80)) ** 3
        line([(w, standoff) for w in masses], ORANGE, f"{standoff:g} m")


def _reflected(charge: float, standoff: float) -> tuple[float, float]:
    """Impulse [kPa s] and pressure [kPa] on a wall that is hit squarely."""
    try:
        blast = free_air(charge, standoff)
    except ValueError:
        return math.nan, math.nan
    return blast.reflected_impulse / 1e3, blast.reflected_overpressure / 1e3


def draw_limits(
    along: Parameter,
    unknown: Parameter,
    limits: list[tuple[dict, Found]],
    shots: list[FragmentShot | None],
    folder: Path,
) -> Picture:
    """A limit along a parameter, with its bracket; of charge and standoff scaled distances, of
    `shots` (one a limit, None where it does not apply) the limits by THOR.
    """
    figure, axis = new_figure(1, 3.6)
    x = np.array([point[along.name] for point, _ in limits], float)
    y = np.array([one.value for _, one in limits])
    (xf, xu), (yf, yu) = axis_of(x, along.unit), axis_of(y, unknown.unit)
    low, high = (np.array([getattr(one, end) for _, one in limits]) for end in ("low", "high"))
    bars = np.nan_to_num(np.abs(np.array([y - low, high - y])) / yf)
    axis.errorbar(x / xf, y / yf, yerr=bars, fmt="o-", color=BLUE, capsize=3, ms=5, label="runs")
    if along.unit == "kg" and unknown.unit == "m":
        for z in (0.5, 1, 2, 5, 10, 20):
            line = z * x ** (1 / 3)
            if np.nanmin(y) / 2 < line.mean() < np.nanmax(y) * 2:
                axis.plot(x / xf, line / yf, color=GREEN, lw=0.8)
                axis.annotate(f"{z:g} m/kg^(1/3)", (x[-1] / xf, line[-1] / yf), fontsize=7.5,
                              color=GREEN, ha="right")  # fmt: skip
    if any(shots):
        by_thor = np.array([math.nan if one is None else one.limit for one in shots])
        axis.plot(x / xf, by_thor / yf, "x--", color=INK, lw=1, ms=5, label=LABEL)
        axis.legend(loc="best")
    axis.set_xscale("log")
    axis.set_yscale("log")
    for side in (axis.xaxis, axis.yaxis):
        side.set_major_formatter(lambda value, _: f"{value:g}")
        side.set_minor_formatter(LogFormatter())  # fewer of them the longer the axis
    axis.set_xlabel(f"{along.name} {xu}")
    axis.set_ylabel(f"{unknown.name} {yu}")
    caption = "Limits, each with the last runs on both sides of it."
    return Picture(save(figure, folder / "limits.png"), "Limits", caption)


def draw_search(
    unknown: Parameter, found: Found, outcomes: list[Outcome], asked: tuple, folder: Path
) -> Picture:
    """The runs of one limit: response over unknown, target and bracket; residual velocities with
    the fit of Lambert and Jonas. `asked`: result, its target, unit, a fit or None, and a shot for
    THOR or None.
    """
    result, target, unit, fit, shot = asked
    figure, axis = new_figure(1, 3.4)
    x = np.array([row[0] for row in found.runs])
    y = np.array([one.values.get(result, 0.0 if one.done and math.isfinite(row[1]) else math.nan)
                  for row, one in zip(found.runs, outcomes, strict=True)])  # fmt: skip
    (xf, xu), (yf, yu) = axis_of(x, unknown.unit), axis_of(y, unit)
    axis.plot(x / xf, np.abs(y) / yf, "o", color=BLUE, ms=5, label="runs")
    if math.isfinite(found.low) and math.isfinite(found.high):
        label = f"limit {found.low / xf:.4g} to {found.high / xf:.4g} {xu}"
        axis.axvspan(found.low / xf, found.high / xf, color=RED, alpha=0.2, lw=0, label=label)
    if isinstance(fit, LimitFit):
        grid = np.linspace(fit.limit, x.max(), 200)
        text = f"Lambert-Jonas: a {fit.a:.3g}, p {fit.p:.3g}, limit {fit.limit / xf:.4g} {xu}"
        curve = lambert_jonas(grid, fit.limit, fit.a, fit.p)
        axis.plot(grid / xf, curve / yf, color=GREEN, label=text)
        axis.plot(grid / xf, grid / yf, color=GREY, lw=0.9, ls=":", label="nothing lost")
    elif target:
        axis.axhline(target / yf, color=INK, lw=1, ls="--", label="target")
    if shot is not None and result.endswith("residual_velocity"):
        draw_thor(axis, shot, (min(shot.limit, x.min()), x.max()), (xf, yf), INK)
    elif shot is not None:
        text = f"{shot.label}: limit {show(shot.limit, 'm/s')}"
        axis.axvline(shot.limit / xf, color=INK, lw=1.2, ls="--", label=text)
    axis.set_xlabel(f"{unknown.name} {xu}")
    axis.set_ylabel(f"{result} {yu}")
    axis.legend(loc="upper left")
    caption = "The runs that the search took. The bracket is the answer, a fit is a picture of it."
    return Picture(save(figure, folder / "limit.png"), "The limit", caption)


def _told(label: str, curves: dict[str, Curve], factor: float, unit: str) -> str:
    """'surrogate: theta 1.618 kPa s, beta 0.041'."""
    one = curves[label]
    return f"{label}: theta {one.theta / factor:.4g} {unit.strip('[]')}, beta {one.beta:.3f}"


def draw_fragility(
    intensity: tuple[np.ndarray, str, str],
    passed: np.ndarray,
    curves: dict[str, Curve],
    share: tuple[np.ndarray, np.ndarray] | None,
    folder: Path,
) -> Picture:
    """Chance that a limit is passed: runs as marks at 0 and 1, and the curves. `intensity`: values
    (n), name, unit; `share`: the curve of the surrogate, intensities and chances.
    """
    x, name, unit = intensity
    figure, axis = new_figure(1, 3.6)
    xf, xu = axis_of(x, unit)
    axis.plot(x / xf, passed, "|", color=INK, ms=9, label="runs: passed 1, not 0")
    grid = np.geomspace(x.min(), x.max(), 400)
    if share is not None:
        axis.plot(
            share[0] / xf, share[1], color=RED, lw=2, label=_told("surrogate", curves, xf, xu)
        )
    rest = {label: curve for label, curve in curves.items() if label != "surrogate"}
    for (label, curve), color in zip(rest.items(), (BLUE, GREEN), strict=False):
        if math.isfinite(curve.beta) and curve.beta > 0:
            text = _told(label, curves, xf, xu)
            axis.plot(grid / xf, curve.chance(grid), color=color, lw=1.2, ls="--", label=text)
    axis.set_xlabel(f"{name} {xu}")
    axis.set_ylabel("chance that the limit is passed")
    axis.legend(loc="center left", fontsize=8)
    return Picture(
        save(figure, folder / "fragility.png"),
        "Fragility",
        "Theta: the intensity that passes the limit in half of the cases; beta: scatter of its "
        "logarithm.",
    )
