# SPDX-License-Identifier: MIT
"""The page of a study: one sentence, its pictures, tables, what failed, and the file itself."""

from __future__ import annotations

import csv
import json
import math
from collections import Counter
from html import escape
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from post.errors import PostError
from post.fragility import Curve, by_likelihood, by_line, by_share
from post.fragment_reference import LABEL, FragmentShot, fragment_shot_of
from post.limits import Found, fit_hyperbola
from post.page import PAGE, html_picture, html_problems, html_table
from post.reference_curves import fit_limit
from post.study_file import MEMBER, Study
from post.study_pictures import (
    draw_fragility,
    draw_limits,
    draw_pi,
    draw_responses,
    draw_search,
    draw_shares,
)
from post.study_table import result_names
from post.surrogate import WORST, Surrogate, fit_surrogate, predict, sensitivity
from post.tables import Table, as_text
from post.units import show

if TYPE_CHECKING:
    from post.runner import Outcome
    from post.study import Results

MOST_FORMULAS = 4  # results for which a surrogate is made
DRAWS = 2**13  # of the other parameters at each intensity of a fragility curve


class Page:
    """What goes on the page, in order."""

    def __init__(self, study: Study, folder: Path, found: Results):
        self.study, self.folder, self.found = study, folder, found
        self.sentence = ""
        self.pictures: list = []
        self.tables: list[Table] = []
        self.notes: list[str] = []
        self.surrogates: dict[str, Surrogate] = {}

    def results(self) -> dict[str, tuple[np.ndarray, str]]:
        """Values (n) and unit of each wanted result that is a number in several runs."""
        found, outcomes = {}, self.found.outcomes
        for name in result_names(self.study, outcomes):
            values = np.array([one.values.get(name, math.nan) for one in outcomes], float)
            unit = next((o.units[name] for o in outcomes if name in o.units), "-")
            if np.isfinite(values).sum() > 1:
                found[name] = values, unit
        return found


def make_study_page(study: Study, folder: Path, found: Results) -> tuple[Path, str]:
    """Write `study.html` and what belongs to it; the path, and its tables as text."""
    page = Page(study, folder, found)
    kind = study.limit.kind if study.limit is not None else "design"
    if found.outcomes:
        if kind in ("limit", "pi", "standoff_charge"):
            _add_limits(page)
        else:
            _add_design(page)
        if kind == "fragility":
            _add_fragility(page)
    known = {name for one in found.outcomes for name in one.values}
    for name in study.results:
        if known and name not in known:
            page.notes.append(f"no run has a result '{name}'; there are {', '.join(sorted(known))}")
    _add_failures(page)
    if study.repeat > 1:
        _add_scatter(page)
    if found.centre is not None:
        names = result_names(study, found.outcomes)[:MOST_FORMULAS]
        page.notes.append(found.centre.sentence(names))
    if not page.sentence:
        done = sum(one.done for one in found.outcomes)
        page.sentence = f"{done} of {len(found.outcomes)} runs have results."
    path = folder / "study.html"
    path.write_text(_html(page), encoding="utf-8")
    text = [page.sentence, "", *map(as_text, page.tables), *(f"note: {t}" for t in page.notes)]
    return path, "\n".join(text)


def _html(page: Page) -> str:
    study, outcomes = page.study, page.found.outcomes
    spent = sum(one.seconds for one in outcomes)
    cost = (
        f"{len(outcomes)} runs, {spent:.0f} core-s in all, "
        f"{sum(one.known for one in outcomes)} of them known before."
    )
    parts = [f"<p>{escape(page.sentence)}</p>", html_problems(page.notes)]
    parts += [html_picture(picture) for picture in page.pictures]
    parts += [html_table(table) for table in page.tables]
    parts.append(
        f"<h2>Cost</h2><p>{escape(cost)} The same command goes on, and runs nothing twice."
    )
    parts.append(f"</p><h2>Study</h2><pre>{escape(study.path.read_text(encoding='utf-8'))}</pre>")
    return PAGE.format(title=escape(study.title), body="\n".join(parts))


def _add_failures(page: Page) -> None:
    bad = Counter(o.message or o.state for o in page.found.outcomes if not o.done)
    rows = [(str(count), text) for text, count in bad.most_common(8)]
    if rows:
        page.tables.append(Table("Runs without results", ("runs", "why"), rows))


def _add_scatter(page: Page) -> None:
    """What chance does: standard deviation of the members of a point, all points together."""
    sets: dict[str, list[int]] = {}
    for k, point in enumerate(page.found.points):
        alike = json.dumps({n: repr(v) for n, v in point.items() if n != MEMBER})
        sets.setdefault(alike, []).append(k)
    rows = []
    for name, (values, unit) in page.results().items():
        some = [values[k][np.isfinite(values[k])] for k in sets.values()]
        some = [v for v in some if len(v) > 1]
        free = sum(len(v) - 1 for v in some)
        if free:
            deviation = math.sqrt(sum(float(np.var(v)) * len(v) for v in some) / free)
            mean = float(np.mean([abs(v.mean()) for v in some]))
            share = f"{100 * deviation / mean:.2g} %" if mean else ""
            rows.append((name, _text(deviation, unit), share, str(free)))
    if rows:
        heads = ("result", "standard deviation of a member", "of the mean", "degrees of freedom")
        note = "Members of a point differ by a jitter of a thousandth of a spacing."
        page.tables.append(Table("Scatter by chance", heads, rows, note))


def _add_design(page: Page) -> None:
    """Response curves, surrogates and what decides."""
    study, found = page.study, page.found
    results = page.results()
    random = study.design.kind in ("lhs", "sobol") and study.surrogate
    numbers = [p for p in study.parameters if p.law]
    if random and len(numbers) == len(study.parameters):
        for name, (values, _) in list(results.items())[:MOST_FORMULAS]:
            _add_surrogate(page, name, values)
    formulas = page.surrogates, _residuals_by_thor(page)
    picture = draw_responses(study.parameters, found.points, results, formulas, page.folder)
    page.pictures += [picture] if picture else []
    shares = {n: sensitivity(s, study.parameters) for n, s in page.surrogates.items()}
    picture = draw_shares(shares, page.folder)
    page.pictures += [picture] if picture else []
    rows = [
        (name, _text(np.nanmin(v), unit), _text(np.nanmedian(v), unit), _text(np.nanmax(v), unit))
        for name, (v, unit) in results.items()
    ]
    if rows:
        page.tables.append(Table("Results", ("result", "least", "median", "most"), rows))


def _shot_of(page: Page, outcome: Outcome) -> FragmentShot | None:
    """The shot of a run, where it is one within the range of THOR."""
    return fragment_shot_of(page.folder / "runs" / outcome.key / "out")


def _residuals_by_thor(page: Page) -> dict[str, np.ndarray]:
    """Residual velocity of each run by THOR (n) [m/s], by the name of the result; not a number
    where it does not apply.
    """
    found: dict[str, np.ndarray] = {}
    if not any(name.endswith(" residual_velocity") for name in page.results()):
        return found
    for k, outcome in enumerate(page.found.outcomes):
        if (one := _shot_of(page, outcome)) is not None:
            name = f"{one.shot.projectile.id} residual_velocity"
            rows = found.setdefault(name, np.full(len(page.found.outcomes), math.nan))
            rows[k] = float(one.residual(one.shot.speed))
    return found


def _shots_of_limits(page: Page) -> list[FragmentShot | None]:
    """The shot of each limit whose unknown is its speed, where it is one within the range of THOR;
    that of the last run of the search.
    """
    found, at = [], 0
    for _, one in page.found.limits:
        outcomes = page.found.outcomes[at : at + len(one.runs)]
        at += len(one.runs)
        shot = _shot_of(page, outcomes[-1]) if outcomes else None
        same = shot is not None and math.isclose(shot.shot.speed, one.runs[-1][0], rel_tol=1e-6)
        found.append(shot if same else None)
    return found


def _text(value: float, unit: str) -> str:
    return show(float(value), unit)


def _add_surrogate(page: Page, name: str, values: np.ndarray) -> None:
    """Fit one, tell both errors, write it where it is good enough."""
    good = np.isfinite(values)
    points = [[p[one.name] for one in page.study.parameters]
              for p, yes in zip(page.found.points, good, strict=True) if yes]  # fmt: skip
    sign = -1.0 if (values[good] < 0).all() else 1.0
    try:
        one = fit_surrogate([p.name for p in page.study.parameters], points, sign * values[good])
    except ValueError as error:
        page.notes.append(f"no surrogate of '{name}': {error}")
        return
    rows = [
        (kind.replace("_", " "), f"{100 * e.rms:.2g} %", f"{100 * e.largest:.2g} %", f"{e.q2:.5f}",
         "kept" if kind == one.kind and e.rms < WORST else "")
        for kind, e in one.errors.items()
    ]  # fmt: skip
    heads = ("formula", "rms error", "largest", "Q2", "")
    note = "Relative, of runs that the formula had not seen: eight parts, each left out once."
    page.tables.append(Table(f"Surrogate of {name}", heads, rows, note))
    if one.error.rms >= WORST:
        page.notes.append(
            f"no surrogate of '{name}': its error of {100 * one.error.rms:.0f} % is above 10 %"
        )
        return
    one.sign = sign
    page.surrogates[name] = one
    told = {"result": name, "sign": sign, "error_rms": one.error.rms, "formula": one.data}
    path = page.folder / "surrogate.json"
    every = json.loads(path.read_text()) if path.is_file() else {}
    path.write_text(json.dumps(every | {name: told}, indent=1))


def _add_limits(page: Page) -> None:
    """Table of the limits, and the picture that belongs to them."""
    study, limit = page.study, page.study.limit
    unknown, names = limit.unknown, [p.name for p in study.parameters]
    units = {p.name: p.unit for p in study.parameters}
    rows, lines = [], []
    shots = _shots_of_limits(page)
    for (point, one), shot in zip(page.found.limits, shots, strict=True):
        cells = [_point_text(point[n], units[n]) for n in names]
        ends = f"{show(one.low, unknown.unit, 4)} to {show(one.high, unknown.unit, 4)}"
        value = show(one.value, unknown.unit, 4)
        thor = [show(shot.limit, "m/s", 4) if shot else "–"] if any(shots) else []
        rows.append((*cells, value, ends, *thor, str(len(one.runs)), one.message))
        lines.append([point[n] for n in names] + [one.value, one.low, one.high, len(one.runs)])
    thor = [LABEL] if any(shots) else []
    heads = (*names, f"limit of {unknown.name}", "last runs on both sides", *thor, "runs", "")
    page.tables.append(Table("Limits", heads, rows))
    with (page.folder / "limits.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        unit = unknown.unit
        ends = [f"{unknown.name}[{unit}]", f"low[{unit}]", f"high[{unit}]", "runs"]
        writer.writerow([*(f"{n}[{units[n]}]" for n in names), *ends])
        writer.writerows(lines)
    page.notes += [one.message for _, one in page.found.limits if one.message]
    if limit.kind == "pi":
        _add_pi(page)
    elif len(page.found.limits) > 1:
        along = next((p for p in study.parameters if len(p.values) > 1), None)
        if along is not None and all(isinstance(v, float) for v in along.values):
            page.pictures.append(draw_limits(along, unknown, page.found.limits, shots, page.folder))
            page.sentence = f"Limits of {unknown.name} along {along.name}: {_what(study)}."
    elif page.found.limits:
        _add_search(page, page.found.limits[0][1], shots[0])


def _point_text(value, unit: str) -> str:
    return value if isinstance(value, str) else show(value, unit)


def _what(study: Study) -> str:
    """What the limit is one of: '35.0 mm of mid:displacement_y peak'."""
    limit = study.limit
    if limit.event:
        return limit.event
    unit = "m" if "displacement" in limit.result else ""
    size = show(limit.target, unit) if unit else f"{limit.target:g}"
    return f"{limit.result} of {size}"


def _add_search(page: Page, one: Found, shot: FragmentShot | None) -> None:
    """One limit alone: its runs, a fit where they are residual velocities, and THOR where the shot
    is one for it.
    """
    study, limit = page.study, page.study.limit
    result = limit.measured
    outcomes = page.found.outcomes
    unit = next((o.units[result] for o in outcomes if result in o.units), "-")
    fit = None
    if result.endswith("residual_velocity"):
        speeds = [(x, o.values.get(result, 0.0))
                  for (x, y), o in zip(one.runs, outcomes, strict=True)
                  if o.done and (result in o.values or math.isfinite(y))]  # fmt: skip
        through = [(x, v) for x, v in speeds if v > 0]
        stops = [x for x, v in speeds if not v > 0]
        if len(through) >= 3:
            fit = fit_limit(*zip(*through, strict=True), stops, 3 if len(through) > 3 else 2)
    asked = (result, abs(limit.target), unit, fit, shot)
    page.pictures.append(draw_search(limit.unknown, one, outcomes, asked, page.folder))
    ends = f"{show(one.low, limit.unknown.unit, 4)} to {show(one.high, limit.unknown.unit, 4)}"
    name = limit.unknown.name
    page.sentence = f"{_what(study)}: {name} {show(one.value, limit.unknown.unit, 4)} ({ends})."


def _add_pi(page: Page) -> None:
    """P-I diagram: pressure is the unknown, the duration the parameter, I = P d/2 of a triangle
    unless the study derives an impulse.
    """
    study, limit = page.study, page.study.limit
    rows = []
    for point, one in page.found.limits:
        names = point | {limit.unknown.name: one.value}
        rows.append((one.value, _impulse(study, names), one))
    good = [(p, i) for p, i, _ in rows if math.isfinite(p)]
    curve = fit_hyperbola(*zip(*good, strict=True)) if len(good) >= 3 else None
    page.sentence = f"P-I diagram of {_what(study)}"
    if curve is not None:
        page.sentence += (
            f": below {show(curve.p0, 'Pa')} and below {show(curve.i0, 'Pa s')} it is not passed; "
            f"hyperbola with c {curve.c:.3f}, {100 * curve.rms:.1f} % rms along rays"
        )
    page.sentence += "."
    if good:
        band = _pressure_band(page)
        page.pictures.append(draw_pi(rows, curve, (_what(study), band), page.folder))


def _pressure_band(page: Page) -> float:
    """Share by which pressures are open by the cells: that of the result over the slope of its
    logarithm between the runs next to the limits; 0 without a certificate.
    """
    centre, limit = page.found.centre, page.study.limit
    share = centre.share(limit.result) if centre is not None else math.nan
    if not math.isfinite(share):
        return 0.0
    slopes = []
    for _, one in page.found.limits:
        near = sorted((x, y) for x, y in one.runs if y > 0)
        slopes += [math.log(b[1] / a[1]) / math.log(b[0] / a[0]) for a, b in pairwise(near)
                   if b[0] > a[0] and b[1] != a[1]]  # fmt: skip
    return share / abs(float(np.median(slopes))) if slopes else share


def _impulse(study: Study, names: dict) -> float:
    from post.expressions import evaluate  # noqa: PLC0415

    if "impulse" in study.derived:
        return float(evaluate(study.derived["impulse"], names, study.where("derived", "impulse")))
    duration = next(float(names[p.name]) for p in study.parameters if p.unit == "s")
    return 0.5 * duration * float(names[study.limit.unknown.name])


def _add_fragility(page: Page) -> None:
    """The curve by the surrogate, by likelihood of yes and no, and by a straight line."""
    study, limit = page.study, page.study.limit
    name = limit.unknown.name
    values = np.array([o.values.get(limit.result, math.nan) for o in page.found.outcomes])
    good = np.isfinite(values)
    if not good.any():
        raise PostError(f"{study.path}: no run has a result '{limit.result}'")
    x = np.array([p[name] for p in page.found.points])[good]
    size = np.abs(values[good])
    passed = size > abs(limit.target)
    curves = {"yes and no": by_likelihood(x, passed)}
    if good.sum() > 3:
        curves["straight line"] = by_line(x, size, abs(limit.target))
    share = _share(page, name)
    if share is not None:
        curves = {"surrogate": by_share(*share)} | curves
    unit = next(p.unit for p in study.parameters if p.name == name)
    rows = [(k, show(c.theta, unit, 4), _beta(c), _ends(c, unit), c.message)
            for k, c in curves.items()]  # fmt: skip
    heads = ("by", "theta", "beta", "90 % limits of theta", "")
    page.tables.insert(0, Table("Fragility", heads, rows))
    best = next(iter(curves.values()))
    page.sentence = (
        f"{_what(study)} is passed in half of the cases from {name} {show(best.theta, unit, 4)}, "
        f"beta {_beta(best)}."
    )
    picture = draw_fragility((x, name, unit), passed.astype(float), curves, share, page.folder)
    page.pictures.insert(0, picture)


def _beta(curve: Curve) -> str:
    return f"{curve.beta:.3f}" if math.isfinite(curve.beta) else "–"


def _ends(curve: Curve, unit: str) -> str:
    if not math.isfinite(curve.low):
        return "–"
    return f"{show(curve.low, unit, 4)} to {show(curve.high, unit, 4)}"


def _share(page: Page, name: str) -> tuple[np.ndarray, np.ndarray] | None:
    """Intensities, and the share of the other parameters' scatter that passes the limit there."""
    from scipy.stats import qmc  # noqa: PLC0415 (slow to load)

    surrogate = page.surrogates.get(page.study.limit.result)
    if surrogate is None:
        return None
    parameters = page.study.parameters
    shares = np.clip(qmc.Sobol(len(parameters), rng=7).random(DRAWS), 1e-9, 1 - 1e-9)
    drawn = np.column_stack([p.quantile(s) for p, s in zip(parameters, shares.T, strict=True)])
    place = [p.name for p in parameters].index(name)
    grid = np.geomspace(*(float(parameters[place].quantile(np.array(q))) for q in (1e-9, 1.0)), 80)
    chance = []
    for value in grid:
        drawn[:, place] = value
        passed = predict(surrogate.data, drawn) > abs(page.study.limit.target)
        chance.append(float(passed.mean()))
    return grid, np.array(chance)
