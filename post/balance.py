# SPDX-License-Identifier: MIT
"""Tables of what balances and what was spent: energies, impulses and masses, modelled and whole."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from post.reader import History, Run
from post.tables import Row, Table
from post.units import show

# what the numbers cost, over the energy that was put into the bodies: columns, name
NUMERICAL = (
    (("viscous",), "artificial viscosity of the bodies"),
    (("hourglass", "hourglass_heat"), "hourglass energy and heat"),
    (("artificial",), "artificial stress"),
    (("contact", "contact_heat"), "contact: springs and heat"),
)
# columns of energy.csv that are shown as totals, name; sums over several columns
TOTALS = (
    (("solid_kinetic",), "kinetic energy of the bodies"),
    (("solid_internal",), "internal energy of the bodies"),
    (("load_work",), "work of the {load} on the bodies"),
    (("drive_work",), "work of prescribed motion"),
    (("plastic",), "spent in plastic work"),
    (("damage",), "spent in damage"),
    (("friction",), "spent in friction"),
    (("bond_heat",), "spent in cohesive interfaces"),
    *NUMERICAL,
    (("impulse_x",), "impulse of the air on the bodies, x"),
    (("impulse_y",), "impulse of the air on the bodies, y"),
    (("impulse_z",), "impulse of the air on the bodies, z"),
)
EXTENSIVE = {"kg", "J", "N s"}  # units of what a part has less of than the whole


def has_air(run: Run) -> bool:
    """Whether the scene has air."""
    return bool(run.deck.groups("air"))


def _load(run: Run) -> str:
    """What loads the bodies."""
    return "air" if has_air(run) else "loads"


def column(history: History, name: str) -> np.ndarray | None:
    """A column of energy.csv in J by name, also where the name needs its unit; None if absent."""
    for label in (name, f"{name}[J]"):
        if label in history:
            return history[label]
    return None


def total_of(history: History, names: tuple[str, ...]) -> np.ndarray | None:
    """Sum of those of some columns that exist; None if there is none."""
    found = [values for name in names if (values := column(history, name)) is not None]
    return np.sum(found, axis=0) if found else None


def largest(values: np.ndarray) -> int:
    """Place of the largest magnitude among the values that are finite."""
    return int(np.argmax(np.where(np.isfinite(values), np.abs(values), -1.0)))


def whole_factor(run: Run, name: str, unit: str) -> float:
    """By what a column of the modelled part is multiplied to be that of the whole scene.

    What is normal to a plane of symmetry cancels between the images.
    """
    if unit not in EXTENSIVE:
        return 1.0
    if unit == "N s" and any(
        cut and name.endswith(f"_{axis}") for axis, cut in zip("xyz", run.deck.mirrors, strict=True)
    ):
        return 0.0
    return float(run.deck.images)


def energy_put_in(history: History) -> float:
    """Energy that the bodies were given [J]: at the start, by the air and by prescribed motion."""
    start = column(history, "solid_kinetic")
    given = 0.0 if start is None else float(start[0])
    for name in ("load_work", "drive_work"):
        values = column(history, name)
        if values is not None:
            given += float(np.nanmax(np.maximum(np.where(np.isfinite(values), values, 0.0), 0.0)))
    return given


@dataclass(frozen=True)
class Share:
    """A numerical part of the energy over what was put into the bodies."""

    name: str
    largest: float
    end: float


def numerical_shares(history: History) -> list[Share]:
    """What viscosity, hourglass forces, artificial stress and contact took or hold."""
    given = energy_put_in(history)
    shares = []
    for names, label in NUMERICAL:
        values = total_of(history, names)
        if values is not None and given > 0 and np.any(values != 0):
            part = values / given
            shares.append(Share(label, float(abs(part[largest(part)])), float(part[-1])))
    return shares


def balance_table(run: Run) -> Table:
    """What is not accounted for in energy, mass and momentum, and what the numbers cost."""
    history = run.history("energy")
    if history is None or not len(history):
        return Table("Balance", (), [])
    rows = [("energy, what is not accounted for, relative", *_worst(history, "error", "ratio"))]
    if has_air(run):
        rows += [
            (
                "mass of the air, what is not accounted for, relative",
                *_worst(history, "mass_error"),
            ),
            ("momentum, air and what it gave, relative", *_worst(history, "momentum_error")),
        ]
    rows = [row for row in rows if row[1] != "–"]
    rows += _coupling(history) if has_air(run) else []
    rows += [
        (f"{share.name}, of the energy put in", _percent(share.largest), _percent(share.end))
        for share in numerical_shares(history)
    ]
    if has_air(run) and column(history, "air_internal") is not None:
        counts = [f"{history[name][-1]:.0f}" for name in history.find(r".*fallback.*")]
        rows.append(("faces that fell back to first order", "", *(counts or ["not recorded"])[:1]))
    note = (
        f"Energy put into the bodies: {_both(run, energy_put_in(history), 'J')}: kinetic energy at "
        f"the start, work of the {_load(run)} and of prescribed motion."
    )
    return Table("Balance", ("quantity", "largest", "at the end"), rows, note)


def _percent(share: float) -> str:
    return f"{100 * share:.2g} %"


def _both(run: Run, value: float, unit: str) -> str:
    """A value, and that of the whole scene where only a part is modelled."""
    text = show(value, unit)
    return f"{text} ({show(run.deck.images * value, unit)} whole)" if run.deck.images > 1 else text


def _worst(history: History, *names: str) -> tuple[str, str]:
    """Largest magnitude and last value of the first of some columns that exists."""
    for name in names:
        if name in history:
            values = history[name] - (1 if name == "ratio" else 0)
            return f"{abs(values[largest(values)]):.1e}", f"{values[-1]:+.1e}"
    return "–", "–"


def _coupling(history: History) -> Iterable[Row]:
    """Work that is lost between air and bodies, over the work of the air."""
    work, lost = column(history, "load_work"), column(history, "coupling")
    given = 0.0 if work is None else float(abs(work[largest(work)]))
    if lost is not None and given > 0:
        part = lost / given
        label = "work lost between air and bodies, of the work of the air"
        yield label, _percent(abs(part[largest(part)])), _percent(part[-1])


def totals_table(run: Run) -> Table:
    """Energies and impulses of the bodies, of what is modelled and of the whole scene."""
    history = run.history("energy")
    if history is None or not len(history):
        return Table("Energies and impulses", (), [])
    rows, images = [], run.deck.images
    for names, label in TOTALS:
        values = total_of(history, names)
        if values is None or not np.any(values != 0):
            continue
        unit = "N s" if names[0].startswith("impulse") else "J"
        top, factor = largest(values), whole_factor(run, names[0], unit)
        when = show(history.time[top], "s")
        row = [label.format(load=_load(run)), show(values[top], unit), when, show(values[-1], unit)]
        if images > 1:
            row += [show(factor * values[top], unit), show(factor * values[-1], unit)]
        rows.append(tuple(row))
    heads = ["what", "largest", "at", "at the end"]
    heads += ["whole: largest", "whole: at the end"] if images > 1 else []
    note = "The largest magnitude."
    if images > 1:
        note += (
            f" 1/{images} of the scene is modelled, and that is what the files hold; whole: with "
            "the mirror images, between which impulses normal to a plane of symmetry cancel."
        )
    return Table("Energies and impulses", tuple(heads), rows, note)


def body_table(run: Run) -> Table:
    """State of each body at the end."""
    history = run.history("bodies")
    if history is None or not len(history):
        return Table("Bodies", (), [])
    wanted = {
        "mass": "mass",
        "velocity_x": "velocity x",
        "velocity_y": "velocity y",
        "velocity_z": "velocity z",
        "kinetic": "kinetic energy",
        "internal": "internal energy",
        "damage_mean": "mean damage",
        "load_work": f"work of the {_load(run)}",
    }
    there = [n for n in wanted if any(f"{b}:{n}" in history for b in history.owners())]
    rows = []
    for body in history.owners():
        cells = []
        for name in there:
            label = f"{body}:{name}"
            cells.append(_cell(run, history, label) if label in history else "–")
        rows.append((body, *cells))
    note = f"At t = {show(history.time[-1], 's')}."
    if run.deck.images > 1:
        note += (
            f" Of what is modelled, 1/{run.deck.images} of the scene; in brackets of the whole: "
            "the body with its mirror images."
        )
    return Table("Bodies at the end", ("body", *(wanted[n] for n in there)), rows, note)


def _cell(run: Run, history: History, label: str) -> str:
    """Last value of a column, and that of the whole in brackets where it differs."""
    value, unit = history[label][-1], history.unit(label)
    factor = whole_factor(run, label, unit)
    return show(value, unit) + (f" ({show(factor * value, unit)})" if factor != 1 else "")
