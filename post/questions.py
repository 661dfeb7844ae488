# SPDX-License-Identifier: MIT
"""What the paper leaves open, by runs that differ in one thing: `python -m post questions`.

The questions stand in inputs/paper/questions.toml, `studies/paper.py questions` runs them.
"""

from __future__ import annotations

import tomllib
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from post.comparison import crack_table
from post.document import Document, Heading
from post.errors import USAGE, PostError
from post.reader import Run
from post.side_by_side import summary_table
from post.style import Picture, new_figure, save
from post.tables import Table

QUESTIONS = Path(__file__).parents[1] / "inputs" / "paper" / "questions.toml"
CURVE = "mid:displacement_z"
DONE = 0.999  # of the time that a run should last
INTRODUCTION = (
    "The paper does not say how its slabs were held, reinforced and glued, nor how its charge was "
    "started. Each table is of runs that differ in that one thing: quarters of the scene; energies "
    "are of the whole. Answers are written by hand from the tables, all else by `python -m post "
    "questions`. The runs stand in inputs/paper/questions.toml: `studies/paper.py questions`, or "
    "`questions-fine` on a GPU."
)


def make_questions_page(folder: Path, markdown: Path) -> int:
    """Write the page of all questions of which `folder` holds runs; how many runs were used.

    `folder` holds a folder of each run, by its name in questions.toml. Pictures go into
    figures/NAME beside the page. PostError where there is no run at all.
    """
    table = tomllib.loads(QUESTIONS.read_text(encoding="utf-8"))
    runs = {}
    for name in table["run"]:
        if (folder / name / "energy.csv").is_file():
            run = Run(folder / name)
            run.leave_out_damaged()
            if run.end >= DONE * float(run.deck.get("run", "t_end")):
                runs[name] = run
    if not runs:
        raise PostError(f"{folder}: holds no run of {QUESTIONS.name} that is done", USAGE)
    missing = [name for name in table["run"] if name not in runs]
    pictures = folder / "pictures"
    pictures.mkdir(exist_ok=True)
    document = Document("What the paper leaves open", [INTRODUCTION])
    if missing:
        document.problems.append(f"not run: {', '.join(missing)}")
    for key, question in table["question"].items():
        names = [name for name in question["runs"] if name in runs]
        if len(names) < 2:
            document.problems.append(f"no answer yet: {question['text'].split('?')[0]}?")
        else:
            _answer(document, key, question, {name: runs[name] for name in names}, pictures)
    document.add(_made_with(runs))
    images = markdown.parent / "figures" / markdown.stem
    markdown.write_text(document.markdown(markdown, images), encoding="utf-8")
    return len(runs)


def _answer(document: Document, key: str, question: dict, runs: dict[str, Run], folder: Path):
    """The part of a question: text, answer, table, cracks, displacement of the middle."""
    document.add(Heading(question["text"].split("?")[0] + "?"))
    document.add(question["text"].split("?", 1)[1].strip(), question.get("answer", ""))
    names, ordered = list(runs), list(runs.values())
    every = summary_table(ordered, names)
    rows = [row for start in question["rows"] for row in every.rows if row[0].startswith(start)]
    document.add(Table("Runs side by side", every.heads, rows))
    body = question.get("cracks")
    there = {n: r for n, r in runs.items() if any(one.id == body for one in r.deck.bodies())}
    if there:
        try:
            document.add(crack_table(list(there.values()), list(there), body))
        except PostError as error:
            document.problems.append(f"cracks are not counted ({key}): {error}")
    document.add(_draw_middle(key, runs, folder))


def _draw_middle(key: str, runs: dict[str, Run], folder: Path) -> Picture | None:
    """Displacement of the middle against time, a curve for each run that has it."""
    runs = {name: run for name, run in runs.items() if run.history("gauges")}
    column = next((c for r in runs.values() for c in r.gauges.names if c == CURVE), None)
    if column is None:
        return None
    figure, axes = new_figure(1, 3.0, squeeze=False)
    axis = axes[0, 0]
    for number, (name, run) in enumerate(runs.items()):
        style = ("-", "--", "-.", ":")[number % 4]
        axis.plot(1e3 * run.gauges.time, 1e3 * np.asarray(run.gauges[column]), style, label=name)
    axis.set_xlabel("time [ms]")
    axis.set_ylabel("displacement of the middle [mm]")
    axis.legend()
    path = save(figure, folder / f"questions_{key}.png")
    plt.close(figure)
    return Picture(path, f"Displacement: {key}", "Middle of the slab, away from the charge.")


def _made_with(runs: dict[str, Run]) -> Table:
    """Program, precision and wall clock of each run."""
    rows = []
    for name, run in runs.items():
        about = run.about
        program = f"{about.get('version', '?')} {about.get('commit', '')}".strip()
        rows.append((name, program, str(about.get("precision", "–"))))
    return Table("Made with", ("run", "program", "precision"), rows)
