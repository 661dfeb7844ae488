# SPDX-License-Identifier: MIT
"""What was recorded: comparisons/CASE/results.csv, a row a run, and histories.csv."""

from __future__ import annotations

import csv
from dataclasses import dataclass, field
from itertools import pairwise

from studies.comparisons.case import Case, History, Measures

KEYS = ("code", "kind", "version", "date", "machine", "size", "core_s", "command")
KINDS = ("rerun", "recorded", "published", "exact", "experiment")
MOST = 200  # points of a history


@dataclass
class Record:
    """A run, ours or of others. kind: rerun (this machine can), recorded (no package of that code),
    published, exact, experiment."""

    code: str
    kind: str
    version: str = ""
    date: str = ""
    machine: str = ""
    size: str = ""
    core_s: float | None = None  # user time
    command: str = ""  # or source
    measures: Measures = field(default_factory=dict)


def read_records(case: Case) -> list[Record]:
    """Rows of results.csv; ValueError with file and line where one is no row of that case."""
    path = case.folder / "results.csv"
    if not path.is_file():
        return []
    known = [q.key for q in case.quantities]
    found = []
    with path.open(encoding="utf-8") as file:
        rows = csv.DictReader(file)
        if tuple(rows.fieldnames or ()) != (*KEYS, *known):
            raise ValueError(f"{path}:1: the columns must be {', '.join((*KEYS, *known))}")
        for row in rows:
            if row["kind"] not in KINDS:
                raise ValueError(f"{path}:{rows.line_num}: kind must be one of {', '.join(KINDS)}")
            measures = {key: float(row[key]) for key in known if row[key]}
            words = {key: row[key] for key in KEYS if key != "core_s"}
            seconds = float(row["core_s"]) if row["core_s"] else None
            found.append(Record(**words, core_s=seconds, measures=measures))
    return found


def write_records(case: Case, records: list[Record]) -> None:
    known = [q.key for q in case.quantities]
    case.folder.mkdir(exist_ok=True)
    with (case.folder / "results.csv").open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow((*KEYS, *known))
        for r in records:
            seconds = "" if r.core_s is None else f"{r.core_s:.4g}"
            words = (r.code, r.kind, r.version, r.date, r.machine, r.size, seconds, r.command)
            values = [f"{r.measures[k]:.6g}" if k in r.measures else "" for k in known]
            table.writerow((*words, *values))


def read_histories(case: Case) -> dict[str, History]:
    """Curves by name of their run, in the order of the file."""
    path = case.folder / "histories.csv"
    found: dict[str, History] = {}
    if path.is_file():
        with path.open(encoding="utf-8") as file:
            for row in csv.DictReader(line for line in file if not line.startswith("#")):
                found.setdefault(row["code"], []).append(
                    (float(row["time_s"]), float(row["value"]))
                )
    return found


def write_histories(case: Case, histories: dict[str, History]) -> None:
    with (case.folder / "histories.csv").open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(("code", "time_s", "value"))
        for code, points in histories.items():
            for time, value in thinned(points):
                table.writerow((code, f"{time:.6g}", f"{value:.6g}"))


def thinned(points: History) -> History:
    """At most MOST points, of every stretch the one farthest from the line through its ends."""
    if len(points) <= MOST:
        return points
    kept, n = [points[0]], len(points) - 2
    edges = [1 + n * k // (MOST - 2) for k in range(MOST - 1)]
    for a, b in pairwise(edges):
        stretch = points[a:b]
        (t0, v0), (t1, v1) = points[a - 1], points[b]
        slope = (v1 - v0) / (t1 - t0) if t1 > t0 else 0.0
        line = [abs(v - v0 - slope * (t - t0)) for t, v in stretch]
        kept.append(stretch[line.index(max(line))])
    return [*kept, points[-1]]


def replace(records: list[Record], new: Record) -> list[Record]:
    """The records with one in the place of that of the same code, or at the end."""
    if not any(r.code == new.code for r in records):
        return [*records, new]
    return [new if r.code == new.code else r for r in records]
