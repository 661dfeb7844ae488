# SPDX-License-Identifier: MIT
"""Several runs in one table: what moved, what was spent, what arrived, one column for each run."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from post.balance import energy_put_in, largest, numerical_shares, total_of, whole_factor
from post.certificate import interval_text, read_certificate
from post.deflection import measure_deflection
from post.errors import PostError
from post.gauges import list_gauges, measure, pressure_gauges
from post.reader import Run
from post.results import SCENE, results, text_of
from post.tables import Table
from post.units import show

Values = dict[str, str]


def name_runs(runs: list[Run]) -> list[str]:
    """A short name for each run: its folder, with those above where folders are alike."""
    paths = [run.folder.resolve().parts for run in runs]
    for depth in range(1, max(map(len, paths)) + 1):
        names = ["/".join(parts[-depth:]) for parts in paths]
        if len(set(names)) == len(names):
            return names
    return [f"{name} ({number})" for number, name in enumerate(names, 1)]


def summary(run: Run) -> Values:
    """What is compared of a run, as texts by name. Energies, masses and impulses of the whole."""
    found: Values = {}
    for part in (
        _size,
        _displacements,
        _energies,
        _numbers,
        _pressures,
        _fragments,
        _results,
        _certified,
    ):
        found |= part(run)
    return found


def summary_table(runs: list[Run], names: list[str] | None = None) -> Table:
    """One row for each quantity that some run has, one column for each run."""
    values = [summary(run) for run in runs]
    keys: list[str] = []
    for one in values:  # rows that only some runs have stay beside their neighbours
        place = 0
        for key in one:
            if key in keys:
                place = keys.index(key) + 1
            else:
                keys.insert(place, key)
                place += 1
    rows = [(key, *(one.get(key, "–") for one in values)) for key in keys]
    note = (
        "Energies, impulses and masses of the whole scene, mirror images included. Numerical "
        "shares: of the energy that was put into the bodies. A dash: a run has no such value."
    )
    return Table("Runs side by side", ("quantity", *(names or name_runs(runs))), rows, note)


def _size(run: Run) -> Values:
    about, deck = run.about, run.deck
    found = {"program": f"{about.get('version', '?')} {about.get('commit', '')}".strip()}
    if about.get("precision"):
        found["precision"] = str(about["precision"])
    cells = deck.get("air", "cells")
    if cells is not None and not run.radial:
        found["air cells"] = f"{math.prod(np.atleast_1d(cells)):,}".replace(",", " ")
    frame = next((f for f in reversed(run.frames) if f.solid_path), None)
    if frame is not None:
        found["particles"] = f"{len(frame.solid('id').points):,}".replace(",", " ")
    if deck.images > 1:
        found["modelled part"] = f"1/{deck.images}"
    return found | {"end of the run": show(run.end, "s")}


def _displacements(run: Run) -> Values:
    found = {}
    for gauge in list_gauges(run):
        values = run.gauges[gauge.column]
        kind, _, axis = gauge.quantity.partition("_")
        if not gauge.body or kind not in ("displacement", "velocity"):
            continue
        try:
            one = measure_deflection(run.gauges.time, values)
        except ValueError:
            continue
        late = ", still growing" if one.growing else ""
        name = f"{kind} {axis} of {gauge.id}"
        found[f"{name}, largest"] = f"{show(one.peak, gauge.unit)} at {show(one.peak_time, 's')}"
        found[f"{name}, largest"] += late
        found[f"{name}, at the end"] = show(one.end, gauge.unit)
        if kind == "displacement":
            found[f"{name}, permanent set"] = show(one.permanent, gauge.unit)
    return found


def _certified(run: Run) -> Values:
    """Intervals of the results of a run that has a certificate."""
    known = read_certificate(run.folder)
    return {f"{name}, certified": interval_text(one) for name, one in known.items()
            if one["promised"]}  # fmt: skip


def _results(run: Run) -> Values:
    """Residual velocity, plug, debris, holes, craters, damage, cracks."""
    found = {}
    for one in results(run, SCENE):
        told = one.name.endswith(("velocity", "velocity_now")) or not math.isfinite(one.value)
        remark = f" ({one.remark})" if told and one.remark else ""
        found[one.name.replace("_", " ")] = text_of(one) + remark
    return found


def _energies(run: Run) -> Values:
    history = run.history("energy")
    if history is None or not len(history):
        return {}
    found = {}
    for names, label, unit in (
        (("solid_kinetic",), "kinetic energy of the bodies", "J"),
        (("solid_internal",), "internal energy of the bodies", "J"),
        (("load_work",), "work of the air or the loads on the bodies", "J"),
        (("plastic",), "spent in plastic work", "J"),
        (("damage",), "spent in damage", "J"),
        *(((f"impulse_{axis}",), f"impulse of the air, {axis}", "N s") for axis in "xyz"),
    ):
        values = total_of(history, names)
        factor = whole_factor(run, names[0], unit)
        if values is None or not factor or not np.any(values != 0):
            continue
        top = largest(values)
        peak = f"{show(factor * values[top], unit)} at {show(history.time[top], 's')}"
        found[f"{label}, largest"] = peak
        found[f"{label}, at the end"] = show(factor * values[-1], unit)
    return found


def _numbers(run: Run) -> Values:
    """What the numbers cost."""
    history = run.history("energy")
    if history is None or not len(history):
        return {}
    given = run.deck.images * energy_put_in(history)
    found = {"energy put into the bodies": show(given, "J")} if given > 0 else {}
    for share in numerical_shares(history):
        found[f"{share.name}, share"] = f"{100 * share.largest:.2g} %"
    for name, label in (
        ("error", "energy not accounted for"),
        ("mass_error", "mass not accounted for"),
        ("momentum_error", "momentum not accounted for"),
    ):
        if name in history:
            found[label] = f"{abs(history[name][largest(history[name])]):.1e}"
    return found


def _pressures(run: Run) -> Values:
    found = {}
    for gauge in pressure_gauges(run):
        try:
            pulse = measure(run, gauge)
        except PostError:
            continue
        sign = "" if pulse.complete else "≥ "
        found[f"arrival at {gauge.id}"] = show(pulse.arrival, "s")
        found[f"peak overpressure at {gauge.id}"] = show(pulse.peak, "Pa")
        if pulse.reached:
            found[f"impulse at {gauge.id}"] = sign + show(pulse.impulse, "Pa s")
    return found


def _fragments(run: Run) -> Values:
    """Speeds of the bodies that fly: those that move at the start, and those that are no plates."""
    history = run.history("bodies")
    if history is None or not len(history):
        return {}
    shapes = {body.id: body.shape for body in run.deck.bodies()}
    found = {}
    for body in history.owners():
        speed = body_speed(run, body)
        if speed is None:
            continue
        if shapes.get(body) in ("sphere", "cylinder", "file") or speed[0] > 0:
            top = largest(speed)
            found[f"speed of {body}, largest"] = (
                f"{show(speed[top], 'm/s')} at {show(history.time[top], 's')}"
            )
            found[f"speed of {body}, at the end"] = show(speed[-1], "m/s")
    return found


def body_speed(run: Run, body: str) -> np.ndarray | None:
    """Speed of the mass centre of a body at the times of bodies.csv [m/s]; None if unknown."""
    history = run.bodies
    names = [f"{body}:velocity_{axis}" for axis in "xyz"]
    there = [history[name] for name in names if name in history]
    return np.linalg.norm(there, axis=0) if there else None


def common_gauges(runs: list[Run], wanted: Callable[[str], bool]) -> list[str]:
    """Columns of gauges.csv that at least two of the runs have, of the quantities wanted."""
    columns = [{g.column for g in list_gauges(run) if wanted(g.quantity)} for run in runs]
    every = dict.fromkeys(g.column for run in runs for g in list_gauges(run))
    least = min(2, len(runs))
    return [name for name in every if sum(name in have for have in columns) >= least]
