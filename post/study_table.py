# SPDX-License-Identifier: MIT
"""The table of a study: CSV, Parquet with units, and a manifest that says what everything is."""

from __future__ import annotations

import csv
import hashlib
import json
import math
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from post.runner import Outcome
from post.study_file import MEMBER, Study

FIXED = {
    "point": "number of the point, from 1",
    "key": "name of the run in runs/",
    "state": "done, failed, refused or stopped",
    "exit_code": "of the program",
    "seconds": "of one core, or of the clock on a GPU",
    "device": "where it ran",
    "split": "train, validation or test, by the point",
}


@dataclass(frozen=True)
class Column:
    """One column: its values, unit and what it is."""

    name: str
    unit: str
    about: str
    values: list[Any]

    @property
    def head(self) -> str:
        """Name and unit as histories have them: 'mass[kg]'."""
        return f"{self.name}[{self.unit}]" if self.unit else self.name


def columns_of(study: Study, points: list[dict], outcomes: list[Outcome]) -> list[Column]:
    """The columns of the table: what was asked, what came out; numbers in SI units."""
    rows = list(zip(points, outcomes, strict=True))
    found = [
        Column("point", "", FIXED["point"], list(range(1, len(rows) + 1))),
        Column("key", "", FIXED["key"], [one.key for one in outcomes]),
        Column("state", "", FIXED["state"], [one.state for one in outcomes]),
        Column("exit_code", "", FIXED["exit_code"], [one.code for one in outcomes]),
        Column("seconds", "s", FIXED["seconds"], [one.seconds for one in outcomes]),
        Column("device", "", FIXED["device"], [one.device for one in outcomes]),
        Column("split", "", FIXED["split"], [split_of(point) for point in points]),
    ]
    units = {one.name: one.unit for one in study.parameters}
    if study.limit is not None:
        units.setdefault(study.limit.unknown.name, study.limit.unknown.unit)
    for name, unit in units.items():
        values = [point.get(name, math.nan) for point in points]
        text = any(isinstance(v, str) for v in values)
        found.append(Column(name, "" if text else unit, "parameter", values))
    if study.repeat > 1:
        values = [point[MEMBER] for point in points]
        found.append(Column(MEMBER, "", "number of the member: &solid seed", values))
    for name in result_names(study, outcomes):
        unit = next((o.units[name] for o in outcomes if name in o.units), "-")
        values = [one.values.get(name, math.nan) for one in outcomes]
        found.append(Column(name, unit, "result", values))
    return found


def result_names(study: Study, outcomes: list[Outcome]) -> list[str]:
    """The results that the study wants, or all that some run has."""
    wanted = list(study.results)
    if study.limit is not None and study.limit.result:
        wanted.append(study.limit.result)
    if wanted:
        return list(dict.fromkeys(wanted))
    return list(dict.fromkeys(name for one in outcomes for name in one.values))


def split_of(point: dict) -> str:
    """Which part of a set for learning a point belongs to: by its values, never by its row; all
    members of a point to the same.
    """
    text = json.dumps({k: repr(v) for k, v in sorted(point.items()) if k != MEMBER})
    share = int(hashlib.sha256(text.encode()).hexdigest()[:8], 16) / 2**32
    return "train" if share < 0.7 else "validation" if share < 0.85 else "test"


def write_csv(path: Path, columns: list[Column]) -> None:
    """The table as text; the first row has names with units."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow([one.head for one in columns])
        for row in zip(*(one.values for one in columns), strict=True):
            writer.writerow([repr(v) if isinstance(v, float) else v for v in row])


def write_parquet(path: Path, columns: list[Column], about: dict[str, str]) -> None:
    """The same as Parquet; unit and description stand in the metadata of each field."""
    import pyarrow as pa  # noqa: PLC0415 (slow to load)
    import pyarrow.parquet as pq  # noqa: PLC0415

    arrays, fields = [], []
    for one in columns:
        text = any(isinstance(v, str) for v in one.values)
        whole = not text and all(isinstance(v, int) for v in one.values)
        kind = pa.string() if text else pa.int64() if whole else pa.float64()
        values = [str(v) for v in one.values] if text else one.values
        arrays.append(pa.array(values, kind))
        told = {"unit": one.unit or "-", "description": one.about}
        fields.append(pa.field(one.name, kind, metadata=told))
    table = pa.Table.from_arrays(arrays, schema=pa.schema(fields, metadata=about))
    draft = path.with_suffix(".part")
    pq.write_table(table, draft, compression="zstd")
    draft.replace(path)


def write_manifest(
    folder: Path, study: Study, columns: list[Column], about: dict[str, str]
) -> Path:
    """`manifest.json`: files with their sums, columns with units, design, program."""
    files = sorted(p for p in folder.glob("*") if p.suffix in (".csv", ".parquet", ".json", ".h5"))
    files = [p for p in files if p.name not in ("manifest.json", "index.json")]
    path = folder / "manifest.json"
    told = {
        "study": study.title,
        "file": study.path.name,
        "written": datetime.now(UTC).isoformat(timespec="seconds"),
        "files": {p.name: hashlib.sha256(p.read_bytes()).hexdigest() for p in files},
        "columns": [
            {"name": c.name, "unit": c.unit or "-", "description": c.about} for c in columns
        ],
        "parameters": [
            {"name": p.name, "unit": p.unit, "values": list(p.values), "law": p.law,
             "numbers": list(p.numbers)}
            for p in study.parameters
        ],
        "design": {"kind": study.design.kind, "runs": study.design.runs, "seed": study.design.seed},
        "split": "train 70, validation 15, test 15 %, by the values of the point",
    }  # fmt: skip
    path.write_text(json.dumps(told | about, indent=1), encoding="utf-8")
    return path
