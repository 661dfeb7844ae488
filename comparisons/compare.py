# SPDX-License-Identifier: MIT
"""Run what this machine has, lay it beside what was recorded, draw and print."""

from __future__ import annotations

import argparse
import datetime
import shutil
import sys
from pathlib import Path

from comparisons import figures, tables
from comparisons.case import CASES, Case, Run, load_cases
from comparisons.programs import HOME, PROGRAMS, RunError, machine, timed
from comparisons.records import (
    Record,
    read_histories,
    read_records,
    replace,
    write_histories,
    write_records,
)

OUT = HOME / "out" / "compare"
DRIFT = 0.01  # a rerun that is farther from its record is pointed out


def options(arguments: list[str] | None = None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="make compare ARGS=...", description="Brisance beside other codes."
    )
    parser.add_argument("cases", nargs="*", metavar="CASE", help=f"of {', '.join(CASES)}")
    parser.add_argument("--record", action="store_true", help="keep what was run as the record")
    parser.add_argument("--draw", action="store_true", help="run nothing")
    parser.add_argument("--only", metavar="TEXT", help="only runs whose name holds a text")
    parser.add_argument("--slow", action="store_true", help="runs of over three minutes too")
    parser.add_argument("--turns", type=int, default=1, help="runs of each code, in turns (1)")
    parser.add_argument("--write", action="store_true", help="tables into docs/comparison.md")
    chosen = parser.parse_args(arguments)
    for name in chosen.cases:
        if name not in CASES:
            parser.error(f"there is no case {name}; cases: {', '.join(CASES)}")
    return chosen


def wanted(case: Case, chosen: argparse.Namespace) -> tuple[list[Run], list[str]]:
    """Runs of a case that can be made here, and why the others are skipped."""
    runs, skipped = [], []
    for run in case.runs:
        program = PROGRAMS[run.program]
        if chosen.only and chosen.only not in run.name:
            continue
        if program.find() is None:
            skipped.append(f"{program.title} is not installed ({program.package})")
        elif run.slow and not (chosen.slow or chosen.only):
            skipped.append(f"{run.name} takes over three minutes (--slow)")
        else:
            runs.append(run)
    return runs, list(dict.fromkeys(skipped))


def execute(case: Case, run: Run) -> tuple[Record, list]:
    """One run in a fresh folder: its record and history."""
    program = PROGRAMS[run.program]
    folder = OUT / case.name / run.name.replace(" ", "_").replace(",", "").replace("/", "_")
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    run.write(folder)
    seconds = timed(program, folder)
    measures, history = run.read(folder)
    command = f"make compare ARGS='{case.name} --only \"{run.name}\"'"
    version = program.version(program.find())
    today = datetime.date.today().isoformat()
    record = Record(
        run.name, "rerun", version, today, machine(), run.size, seconds, command, measures
    )
    return record, history


def run_case(case: Case, chosen: argparse.Namespace) -> bool:
    """Rerun a case, codes in turns; True if all went well."""
    runs, skipped = wanted(case, chosen)
    for line in skipped:
        print(f"{case.name}: skipped: {line}")
    records, histories = read_records(case), read_histories(case)
    found: dict[str, Record] = {}
    good = True
    for _ in range(chosen.turns):
        for run in runs:
            try:
                record, histories[run.name] = execute(case, run)
            except RunError as error:
                print(f"{case.name}: {error}", file=sys.stderr)
                good = False
                continue
            before = found.get(run.name)
            if before and before.core_s < record.core_s:
                record.core_s = before.core_s
            found[run.name] = record
            print(f"{case.name}: {tables.one_line(case, record)}", flush=True)
    for record in found.values():
        old = next((r for r in records if r.code == record.code), None)
        new_miss = judge(case, old, record)
        good = good and (chosen.record or not new_miss)
        if chosen.record:
            records = replace(records, record)
    if chosen.record and found:
        write_records(case, records)
        write_histories(case, histories)
    return good


def judge(case: Case, old: Record | None, record: Record) -> bool:
    """Print how a run differs from its record and its reference; True for a miss that is new."""
    for text in tables.drift(case, old, record, DRIFT):
        print(f"{case.name}: {record.code}: {text}")
    before = [line.split(":")[0] for line in tables.missed(case, old)] if old else []
    missed = tables.missed(case, record)
    for text in missed:
        known = text.split(":")[0] in before
        print(f"{case.name}: {record.code}: {text}{' (as recorded)' if known else ''}")
    return any(text.split(":")[0] not in before for text in missed)


def main(arguments: list[str] | None = None) -> int:
    chosen = options(arguments)
    good = True
    cases = load_cases(chosen.cases)
    for case in cases:
        if not chosen.draw:
            good = run_case(case, chosen) and good
        print(f"\n{tables.markdown(case)}\n", flush=True)
        figures.draw(case, HOME / "docs" / "figures" / f"comparison_{case.name}.png")
    figures.overview(load_cases(), HOME / "docs" / "figures" / "comparison.png")
    if chosen.write:
        tables.write_page(Path(HOME / "docs" / "comparison.md"), load_cases())
    return 0 if good else 1
