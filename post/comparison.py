# SPDX-License-Identifier: MIT
"""The comparison of several runs as one page: `python -m post compare OUT1 OUT2 ...`."""

from __future__ import annotations

from html import escape
from pathlib import Path

import numpy as np

from post.cracks import LIMIT, circumferential_cracks, radial_cracks, rings_of
from post.deck_difference import deck_table
from post.errors import PostError
from post.face import FaceMap
from post.overlay import compare_faces, damaged_bodies, draw_face_comparison, draw_histories
from post.page import PAGE, html_picture, html_problems, html_table
from post.reader import Run
from post.side_by_side import name_runs, summary_table
from post.style import Picture
from post.tables import Table, as_text


def make_comparison(
    runs: list[Run], folder: Path, body: str | None = None, time: float | None = None
) -> tuple[Path, str]:
    """Write `compare.html` and its pictures into a folder.

    Damage maps are those of `body`, or of every damaged box, at `time` [s] or the end of the
    shortest run. Returns the path of the page and the tables as text for the terminal.
    """
    for run in runs:
        run.leave_out_damaged()
    names = name_runs(runs)
    folder.mkdir(parents=True, exist_ok=True)
    tables = [summary_table(runs, names), deck_table([run.deck for run in runs], names)]
    pictures = draw_histories(runs, names, folder)
    problems = [f"{name}: {text}" for name, run in zip(names, runs, strict=True)
                for text in run.problems]  # fmt: skip
    for one in [body] if body else damaged_bodies(runs, time):
        try:
            pictures.append(draw_face_comparison(runs, names, one, folder, time))
            tables.append(crack_table(runs, names, one, time))
        except PostError as error:
            if body:
                raise
            problems.append(f"no damage map of {one}: {error}")
    tables = [table for table in tables if table.rows]
    page = folder / "compare.html"
    page.write_text(_html(names, tables, pictures, problems), encoding="utf-8")
    return page, "\n".join([*map(as_text, tables), *(f"note: {text}" for text in problems)])


def crack_table(runs: list[Run], names: list[str], body: str, time: float | None = None) -> Table:
    """Cracks on both faces of a body, run by run: median and range, radial and around."""
    have = [any(one.id == body for one in run.deck.bodies()) for run in runs]
    there = iter(compare_faces(runs, body, time=time))
    rows: dict[str, list[str]] = {}
    for yes in have:
        for side in ("low", "high"):
            one = next(there) if yes else None
            for kind, count in (("radial", _radial), ("circumferential", circumferential_cracks)):
                text = "–" if one is None else range_text(count(one))
                rows.setdefault(f"{kind}, face at {side}", []).append(text)
    note = (
        f"Radial: arcs with a damage above {LIMIT:g} on nine circles about the origin, from 30 to "
        "80 % of the way to the nearest edge. Circumferential: such arcs on 72 rays from the "
        "origin, from 10 to 95 % of that way. Median, least and most."
    )
    cells = [(name, *texts) for name, texts in sorted(rows.items(), reverse=True)]
    return Table(f"Cracks of {body}", ("cracks", *names), cells, note)


def _radial(one: FaceMap) -> np.ndarray:
    return radial_cracks(one, rings_of(one))


def range_text(counts: np.ndarray) -> str:
    """'4 (2 to 6)': median, least and most."""
    return f"{np.median(counts):g} ({counts.min()} to {counts.max()})"


def _html(
    names: list[str], tables: list[Table], pictures: list[Picture], problems: list[str]
) -> str:
    title = "Comparison of " + ", ".join(names)
    parts = [html_problems(problems), *map(html_table, tables), *map(html_picture, pictures)]
    return PAGE.format(title=escape(title), body="\n".join(parts))
