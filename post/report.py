# SPDX-License-Identifier: MIT
"""The report of a run: pictures, tables, the deck, as one page that needs nothing else."""

from __future__ import annotations

import math
from collections.abc import Callable
from html import escape
from pathlib import Path

from post.balance import balance_table, body_table, totals_table
from post.certificate import certificate_table
from post.compare import Comparison, compare, find_references, read_references
from post.deflection import displacement_table
from post.energy_picture import draw_energy
from post.errors import PostError
from post.face import draw_damaged_faces
from post.fragment_reference import draw_fragments, fragment_rows
from post.gauge_picture import draw_gauges
from post.gauges import measure, pressure_gauges
from post.hole_picture import draw_perforation, hole_table
from post.interface import draw_interfaces, interface_table
from post.motion_picture import draw_motion
from post.page import PAGE, html_picture, html_problems, html_table
from post.perforation import LEAST, load_plate, measure_perforation
from post.plate_reference import plate_references
from post.reader import Frame, Run
from post.results import material_table, results_table
from post.style import Picture
from post.tables import Table, as_text
from post.units import show, show_point
from post.view import IN_REPORT, framed, make_view

MOST_BODIES = 12  # that are described one by one


def make_report(run: Run, given_references: str | Path | None = None) -> tuple[Path, str]:
    """Write `report/*.png` and `report.html` into the folder of a run.

    Returns the path of the page and the tables as text for the terminal. A picture that cannot be
    made is replaced by the reason; only an unreadable run or reference file is a PostError.
    """
    run.leave_out_damaged()
    path = find_references(run, given_references)
    references = read_references(path) if path else []
    references += plate_references(run)
    folder = run.folder / "report"
    folder.mkdir(exist_ok=True)
    pictures, failures = _draw_all(run, references, folder)
    holes, views = _holes(run, folder)
    pictures += views
    tables = [
        comparison_table(compare(run, references) + fragment_rows(run), path),
        balance_table(run),
        totals_table(run),
        results_table(run),
        certificate_table(run.folder),
        *holes,
        gauge_table(run),
        displacement_table(run),
        body_table(run),
        material_table(run),
        interface_table(run),
    ]
    tables = [table for table in tables if table.rows]
    problems = run.problems + failures
    view = _view(run, problems)
    page = run.folder / "report.html"
    page.write_text(_html(run, pictures, tables, problems, view), encoding="utf-8")
    return page, "\n".join([*map(as_text, tables), *(f"note: {text}" for text in problems)])


def _draw_all(run: Run, references: list, folder: Path) -> tuple[list[Picture], list[str]]:
    """All pictures, and a sentence for each that could not be made."""
    from post.scene import LITTLE_DAMAGE, draw_blast, draw_bodies  # noqa: PLC0415 (renders, slow to load)
    from post.section import draw_sheet  # noqa: PLC0415

    has_air = any(frame.air_path for frame in run.frames)
    has_solid = any(frame.solid_path for frame in run.frames)
    jobs: list[tuple[str, bool, Callable]] = [
        ("blast", has_air, lambda: draw_blast(run, folder)),
        ("cut", has_air or has_solid, lambda: draw_sheet(run, folder)),
        ("bodies", has_solid, lambda: draw_bodies(run, folder)),
        ("faces", has_solid, lambda: draw_damaged_faces(run, folder, LITTLE_DAMAGE)),
        ("interfaces", has_solid, lambda: draw_interfaces(run, folder)),
        ("gauges", run.history("gauges") is not None, lambda: draw_gauges(run, references, folder)),
        ("motion", has_solid, lambda: draw_motion(run, references, folder)),
        ("residual velocity", has_solid, lambda: draw_fragments(run, folder)),
        ("energy", run.history("energy") is not None, lambda: draw_energy(run, folder)),
    ]
    pictures, failures = [], []
    for name, wanted, draw in jobs:
        if not wanted:
            continue
        try:
            drawn = draw()
        except PostError as error:
            failures.append(f"no picture of the {name}: {error}")
            continue
        except (ArithmeticError, LookupError, ValueError) as error:
            failures.append(f"no picture of the {name}: {type(error).__name__}: {error}")
            continue
        if drawn is not None:
            pictures += drawn if isinstance(drawn, list) else [drawn]
    return pictures, failures


def _view(run: Run, problems: list[str]) -> str:
    """The scene to turn and play, or nothing where there are no bodies."""
    if not any(frame.solid_path for frame in run.frames):
        return ""
    try:
        return framed(make_view(run, IN_REPORT))
    except (PostError, LookupError, ValueError) as error:
        problems.append(f"no view: {error}")
        return ""


def _holes(run: Run, folder: Path) -> tuple[list[Table], list[Picture]]:
    """Table and picture of each plate in which there is a hole at the end."""
    frame = next((f for f in reversed(run.frames) if f.solid_path), None)
    tables, pictures = [], []
    for body in run.deck.bodies() if frame else []:
        try:
            plate = load_plate(run, frame, body.id)
        except PostError:
            continue  # no box, or not on a lattice
        if plate.stays.all():
            continue
        found = measure_perforation(plate)
        if found.widest.through.seen.diameter > LEAST * body.spacing:
            tables.append(hole_table(found))
            pictures += draw_perforation(found, folder)
    return tables, pictures


def comparison_table(rows: list[Comparison], path: Path | None) -> Table:
    """Measured beside reference."""
    found = []
    for row in rows:
        difference = row.difference
        text = f"{100 * difference:+.0f} %" if math.isfinite(difference) else "–"
        measured, reference = (show(v, row.unit) for v in (row.measured, row.reference))
        found.append((row.quantity, row.gauge, measured, reference, text, row.source))
    heads = ("quantity", "gauge", "measured", "reference", "difference", "source of the reference")
    note = "A dash: the run has no such value (not reached, or the history ends too early)."
    if path is not None:
        note += f" References beside Kingery-Bulmash and THOR: {path.name}."
    return Table("Comparison", heads, found, note)


def gauge_table(run: Run) -> Table:
    """What each pressure gauge saw."""
    rows = []
    for gauge in pressure_gauges(run):
        place = "–" if gauge.at is None else show_point(gauge.at)
        try:
            p = measure(run, gauge)
        except PostError as error:
            rows.append((gauge.id, place, *["–"] * 5, str(error)))
            continue
        impulse = ("" if p.complete or not p.reached else "≥ ") + show(p.impulse, "Pa s")
        times = (show(p.rise_time, "s", 2), show(p.duration, "s"))
        peak, arrival = show(p.peak, "Pa"), show(p.arrival, "s")
        rows.append((gauge.id, place, arrival, peak, *times, impulse, p.remark))
    heads = ("gauge", "at", "arrival", "peak overpressure", "rise", "duration", "impulse", "")
    note = (
        "Arrival: 10 % of the peak is passed. Rise: 10 to 90 %. Duration: until the overpressure "
        "turns to suction. Impulse: overpressure over that time."
    )
    return Table("Pressure gauges", heads, rows, note)


def _html(
    run: Run, pictures: list[Picture], tables: list[Table], problems: list[str], view: str
) -> str:
    title = run.deck.title or run.job
    body = [_facts(run)]
    body.insert(0, html_problems(problems))
    body += [html_table(table) for table in tables[:4]]
    body += [view, *(html_picture(picture) for picture in pictures)]
    body += [html_table(table) for table in tables[4:]]
    body.append(
        "<h2>Deck</h2><p>Complete, with all defaults; it runs as it stands.</p>"
        f"<pre>{escape(run.deck.text)}</pre>"
    )
    return PAGE.format(title=escape(title), body="\n".join(body))


def _facts(run: Run) -> str:
    """What was run, by what, and how much of it there is."""
    about, deck = run.about, run.deck
    facts = {
        "folder": str(run.folder),
        "program": f"Brisance {about.get('version', '?')}, commit {about.get('commit', '?')}, "
        f"{about.get('precision', 'unknown')} precision",
        "time": f"{show(run.end, 's')} of {show(float(deck.get('run', 't_end', math.nan)), 's')}",
        "dumps": str(len(run.frames)),
    }
    cells = deck.get("air", "cells")
    if cells is not None:
        sides = " x ".join(f"{1e3 * d:.3g}" for d in deck.cell) if deck.cell is not None else "?"
        facts["air"] = f"{math.prod(cells):,} cells of {sides} mm".replace(",", " ")
    frame = next((f for f in reversed(run.frames) if f.solid_path), None)
    if frame is not None:
        facts |= _facts_of_bodies(run, frame)
    for group in deck.groups("charge"):
        facts[f"charge {group.get('id', '')}"] = (
            f"{float(group['mass']):g} kg {group.get('explosive', 'tnt')}, {group.get('shape')}, "
            f"at ({', '.join(f'{x:g}' for x in group.get('at', []))}) m"
            + (" on the ground, which mirrors it" if group.get("burst") == "surface" else "")
        )
    if deck.images > 1:
        planes = ", ".join(a for a, cut in zip("xyz", deck.mirrors, strict=True) if cut)
        facts["symmetry"] = f"planes normal to {planes}: 1/{deck.images} of the scene is modelled"
    rows = "".join(f"<tr><th>{escape(k)}</th><td>{escape(v)}</td></tr>" for k, v in facts.items())
    return f'<table class="facts">{rows}</table>'


def _facts_of_bodies(run: Run, frame: Frame) -> dict[str, str]:
    """What the bodies are made of and how finely; particles of the modelled part."""
    number = frame.solid("body").field["body"]
    bodies = run.deck.bodies()
    facts = {"bodies": f"{len(number):,} particles in {len(bodies)}".replace(",", " ")}
    for body in bodies[:MOST_BODIES]:
        model = run.deck.model_of(body.material) or "unknown model"
        count = f"{int((number == body.number).sum()):,}".replace(",", " ")
        facts[f"body {body.id}"] = (
            f"{body.material} ({model}), {1e3 * body.spacing:.3g} mm between particles, {count} of "
            "them"
        )
    if len(bodies) > MOST_BODIES:
        facts["further bodies"] = ", ".join(body.id for body in bodies[MOST_BODIES:])
    return facts
