# SPDX-License-Identifier: MIT
"""The tables of the page of the paper: what was run, its numbers beside ours, what differs and why.

A campaign has its runs by case in `runs`, from coarse to fine, and lists those of cases by `every`.
"""

from __future__ import annotations

import csv
import math
from pathlib import Path

from post.deck import Deck
from post.paper_measures import (
    Printed,
    cost_text,
    layers_text,
    load_text,
    printed_numbers,
    resolution,
    value_of,
    wall_clock,
    why,
)
from post.paper_pictures import label_of
from post.reader import Run
from post.tables import Table
from post.units import show

CASES = {
    "hvi": "3.1.1",
    "plate": "3.1.2",
    "slab_1": "3.2.1",
    "slab_2": "3.2.1",
    "slab_3": "3.2.1",
    "slab_4": "3.2.1",
    "fragments": "3.2.2",
    "fragments_460": "3.2.2",
}
INPUTS = Path(__file__).resolve().parents[1] / "inputs" / "paper"
REASONS = Path(__file__).parent / "data" / "paper_reasons.csv"
DIFFERS = 0.15  # of the paper's number, at least: less is not asked for a reason


def runs_table(campaign) -> Table:
    """What was run, with what, and what it took."""
    rows = []
    for case, section in CASES.items():
        for run in campaign.runs.get(case, []):
            particles, cells = resolution(run)
            frame = next((f for f in reversed(run.frames) if f.solid_path), None)
            count = "–" if frame is None else f"{len(frame.solid('id').points):,}".replace(",", " ")
            part = f"1/{run.deck.images}" if run.deck.images > 1 else "whole"
            about = run.about
            made = f"{about.get('precision', '?')}, {about.get('commit', '?')}"
            until = "; ".join(text for text in (show(run.end, "s"), smaller(run)) if text)
            row = (case, section, particles, cells, count, part, until)
            rows.append((*row, wall_clock(run), made))
        if case not in campaign.runs:
            rows.append((case, section, "not run", *["–"] * 6))
    heads = ("case", "section", "particles", "air cells", "number", "modelled", "until",
             "wall clock", "made with")  # fmt: skip
    return Table("What was run", heads, rows)


def smaller(run: Run) -> str:
    """'0.5 m wide instead of 1 m' for a run that is not all of the deck; empty otherwise."""
    deck = Deck((INPUTS / f"{run.job}.nml").read_text(encoding="utf-8"), run.job)
    wide = {body.id: float(max(body.high - body.low)) for body in deck.bodies()}
    for body in run.deck.bodies():
        width = float(max(body.high - body.low))
        if wide.get(body.id) and abs(width / wide[body.id] - 1) > 1e-3:  # bars have no width here
            return f"{width:g} m wide instead of {wide[body.id]:g} m"
    end = float(deck.get("run", "t_end"))
    return "" if run.end > 0.99 * end else f"not the whole {show(end, 's')}"


def doubt_table(campaign) -> Table:
    """What speaks against each run, measured in it."""
    rows = [
        (label_of(run), load_text(run) or "–", layers_text(run), cost_text(run))
        for run in campaign.every(*CASES)
    ]
    note = (
        "Kingery-Bulmash is for a sphere; the charge of the slabs is a cylinder in full runs, "
        "which sends 30 % more impulse along its axis. Viscosity, hourglass forces and contact are "
        "what the numbers cost: above some 10 % a result is one of this resolution, not of the "
        "scene."
    )
    return Table("How far to trust each run", ("run", "load", "resolution", "cost"), rows, note)


def reasons() -> dict[tuple[str, str], str]:
    """Why we differ, as far as runs have told, by case and measure: data/paper_reasons.csv."""
    with REASONS.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    return {(row["case"], row["measure"]): row["because"] for row in rows}


def difference_table(campaign) -> Table:
    """Numbers of the finest runs that are not those of the paper, and why."""
    known, rows = reasons(), []
    for one in printed_numbers():
        runs = [run for run in campaign.runs.get(one.case, []) if not smaller(run)]
        value = value_of(runs[-1], one.measure) if runs else math.nan
        if not abs(value / one.value - 1) > DIFFERS:
            continue
        because = known.get((one.case, one.measure), "not known")
        made = ", cells ".join(text for text in resolution(runs[-1]) if text != "–")
        numbers = show(one.value, one.unit), show(value, one.unit)
        rows.append((f"{one.case}: {one.what}", *numbers, made, because))
    note = (
        f"Of the finest run of each case: what is more than {100 * DIFFERS:.0f} % from the paper. "
        "The reasons are those of runs that differ in one thing, of a calculation by hand, or of "
        "the balances below; where none is known, that is said."
    )
    heads = ("quantity", "paper", "here", "made with", "why")
    return Table("What differs from the paper, and why", heads, rows, note)


def numbers_table(campaign, printed: list[Printed]) -> Table:
    """Each number of the paper beside that of every run."""
    rows = []
    for one in printed:
        head = (one.where, f"{one.case}: {one.what}", show(one.value, one.unit))
        runs = campaign.runs.get(one.case, [])
        runs = [run for run in runs if not smaller(run)] or runs[-1:]
        if not runs:
            rows.append((*head, "not run", "–", "–", "–"))
        for run in runs:
            value = value_of(run, one.measure)
            difference, reason = "–", _missing(run)
            if math.isfinite(value) and smaller(run):
                reason = f"{smaller(run)}: not to be compared"
            elif math.isfinite(value):
                difference = f"{100 * (value / one.value - 1):+.0f} %"
                reason = why(run, one)
            made = ", cells ".join(text for text in resolution(run) if text != "–")
            rows.append((*head, show(value, one.unit), difference, made, reason))
    heads = ("paper", "quantity", "its value", "here", "difference", "made with",
             "measured beside it")  # fmt: skip
    return Table("Numbers", heads, rows, "A dash: the run has no such value.")


def _missing(run: Run) -> str:
    return f"the run ends at {show(run.end, 's')}" if run.frames else "there are no dumps"
