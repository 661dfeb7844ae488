# SPDX-License-Identifier: MIT
"""Run what this machine has, lay it beside what was recorded, draw and print."""

from __future__ import annotations

import argparse
import datetime
import hashlib
import json
import shutil
import time
from pathlib import Path

from studies.comparisons import figures, tables
from studies.comparisons.case import CASES, Case, Run, load_cases
from studies.comparisons.programs import HOME, PROGRAMS, RunError, machine, timed
from studies.comparisons.progress import Progress
from studies.comparisons.records import (
    Record,
    read_histories,
    read_records,
    replace,
    write_histories,
    write_records,
)

OUT = HOME / "out" / "compare"
FAILURES = (RunError, OSError, ValueError, LookupError, StopIteration)
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
    parser.add_argument("--again", action="store_true", help="also what has been run before")
    parser.add_argument("--turns", type=int, default=1, help="runs of each code, in turns (1)")
    parser.add_argument(
        "--write", action="store_true", help="tables into studies/notes/comparison.md"
    )
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


def state(folder: Path, path: Path) -> str:
    """Digest of the inputs of a run and of the program that is to read them."""
    found = hashlib.sha256(path.read_bytes())
    for file in sorted(p for p in folder.rglob("*") if p.is_file()):
        found.update(str(file.relative_to(folder)).encode())
        found.update(file.read_bytes())
    return found.hexdigest()


def execute(case: Case, run: Run, *, again: bool) -> tuple[Record, list, bool]:
    """One run in a fresh folder, its record and history; or what the same run has left there."""
    program = PROGRAMS[run.program]
    path = program.find()
    folder = OUT / case.name / run.name.replace(" ", "_").replace(",", "").replace("/", "_")
    inputs, ended = folder.with_name(folder.name + ".new"), folder / "ended.json"
    shutil.rmtree(inputs, ignore_errors=True)
    inputs.mkdir(parents=True)
    run.write(inputs)
    mark = state(inputs, path)
    end = json.loads(ended.read_text(encoding="utf-8")) if ended.is_file() else {}
    kept = end.get("state") == mark and not again
    if not kept:
        shutil.rmtree(folder, ignore_errors=True)
        inputs.rename(folder)
        seconds = timed(program, folder)
        today = datetime.date.today().isoformat()
        end = {"state": mark, "core_s": seconds, "date": today, "machine": machine()}
        ended.write_text(json.dumps(end), encoding="utf-8")
    shutil.rmtree(inputs, ignore_errors=True)
    measures, history = run.read(folder)
    command = f"make compare ARGS='{case.name} --only \"{run.name}\"'"
    record = Record(run.name, "rerun", program.version(path), end["date"], end["machine"],
                    run.size, end["core_s"], command, measures)  # fmt: skip
    return record, history, kept


def run_case(case: Case, chosen: argparse.Namespace, progress: Progress | None = None) -> bool:
    """Rerun a case, codes in turns; True if all went well."""
    runs, skipped = wanted(case, chosen)
    progress = progress or Progress.of([(case, run) for run in runs], chosen.turns)
    for line in skipped:
        print(f"{case.name}: skipped: {line}")
    records, histories = read_records(case), read_histories(case)
    found: dict[str, Record] = {}
    good = True
    for turn in range(chosen.turns):
        for run in runs:
            progress.begin(case, run)
            start = time.monotonic()
            try:
                again = chosen.again or turn > 0
                record, histories[run.name], kept = execute(case, run, again=again)
            except FAILURES as error:
                progress.end(case, run, "failed")
                progress.remark(f"{case.name}: {run.name}: {error}")
                good = False
                continue
            progress.end(case, run, "kept" if kept else "run", time.monotonic() - start)
            before = found.get(run.name)
            if before and before.core_s < record.core_s:
                record.core_s = before.core_s
            found[run.name] = record
            print(f"{case.name}: {tables.one_line(case, record)}", flush=True)
    for record in found.values():
        old = next((r for r in records if r.code == record.code), None)
        new_miss = judge(case, old, record, progress)
        good = good and (chosen.record or not new_miss)
        if chosen.record:
            records = replace(records, record)
    if chosen.record and found:
        write_records(case, records)
        write_histories(case, histories)
    return good


def judge(case: Case, old: Record | None, record: Record, progress: Progress) -> bool:
    """Tell how a run differs from its record and its reference; True for a miss that is new."""
    for text in tables.drift(case, old, record, DRIFT):
        progress.remark(f"{case.name}: {record.code}: {text}")
    before = [line.split(":")[0] for line in tables.missed(case, old)] if old else []
    missed = tables.missed(case, record)
    for text in missed:
        known = " (as recorded)" if text.split(":")[0] in before else ""
        progress.remark(f"{case.name}: {record.code}: {text}{known}")
    return any(text.split(":")[0] not in before for text in missed)


def main(arguments: list[str] | None = None) -> int:
    chosen = options(arguments)
    good = True
    cases = load_cases(chosen.cases)
    plan = {case.name: wanted(case, chosen) for case in cases}
    progress = Progress.of([(c, run) for c in cases for run in plan[c.name][0]], chosen.turns)
    for case in cases:
        if not chosen.draw:
            good = run_case(case, chosen, progress) and good
        print(f"\n{tables.markdown(case)}\n", flush=True)
        figures.draw(case, HOME / "docs" / "figures" / f"comparison_{case.name}.png")
    figures.overview(load_cases(), HOME / "docs" / "figures" / "comparison.png")
    if chosen.write:
        tables.write_page(Path(HOME / "studies" / "notes" / "comparison.md"), load_cases())
    if not chosen.draw:
        print(progress.summary(sum(len(skipped) for _, skipped in plan.values())))
    return 0 if good else 1
