#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Run the parts of the test suite, one make target each; print the slowest tests, then the sum.

usage: run_tests.py PART[+PART...]...

Parts joined by + run in two lanes: the first in one, the others one after another beside it.

A part that leaves build/log/PART.xml (JUnit) is counted test by test; any other part counts as
one test. A part that ends badly without a failed test in its XML counts as one failure more. A
line 'skipped: why' of a part without XML makes it a skipped test. The ten slowest tests of all XML
are listed with their wall seconds; the last line is the sum.
"""

import os
import subprocess
import sys
import time
import xml.etree.ElementTree as xml
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

LOG = Path("build/log")
TAIL = 60
SLOWEST = 10


def count_xml(path):
    """Numbers of passed, failed and skipped tests in a JUnit file."""
    cases = list(xml.parse(path).iter("testcase"))
    bad = sum(c.find("failure") is not None or c.find("error") is not None for c in cases)
    skipped = sum(c.find("skipped") is not None for c in cases)
    return len(cases) - bad - skipped, bad, skipped


def run_part(part):
    """Run one target; (passed, failed, skipped)."""
    report, log = LOG / f"{part}.xml", LOG / f"{part}.log"
    report.unlink(missing_ok=True)
    command = [os.environ.get("MAKE", "make"), "--no-print-directory", part]
    command.insert(1, f"-j{len(os.sched_getaffinity(0))}")
    start = time.monotonic()
    with log.open("w", encoding="utf-8") as out:
        code = subprocess.run(command, stdout=out, stderr=subprocess.STDOUT, check=False).returncode
    text = log.read_text(encoding="utf-8", errors="replace")
    try:
        passed, failed, skipped = count_xml(report)
    except (OSError, xml.ParseError):
        skipped = int(code == 0 and "skipped: " in text)
        passed, failed = int(code == 0 and not skipped), 0
    if code and not failed:
        failed = 1
    seconds = time.monotonic() - start
    lines = [f"{part:<12} {passed:5} passed, {failed} failed, {skipped} skipped {seconds:8.1f} s"]
    if failed:
        lines += ["", *text.splitlines()[-TAIL:], f"(all of it: {log})", ""]
    else:
        lines += [line for line in text.splitlines() if "skipped: " in line]
    print("\n".join(lines), flush=True)
    return passed, failed, skipped


def run_group(group):
    """Counts of the parts of a group: the first in one lane, the others in another."""
    first, *others = group.split("+")
    with ThreadPoolExecutor(2) as lanes:
        main_lane = lanes.submit(run_part, first)
        beside = lanes.submit(lambda: [run_part(part) for part in others])
        return [main_lane.result(), *beside.result()]


def slowest(parts):
    """The slowest tests of the JUnit files of parts: rows (seconds, part, suite, name)."""
    rows = []
    for part in parts:
        try:
            cases = list(xml.parse(LOG / f"{part}.xml").iter("testcase"))
        except (OSError, xml.ParseError):
            continue
        rows += [
            (float(case.get("time")), part, case.get("classname", "-"), case.get("name", "-"))
            for case in cases
            if case.get("time")
        ]
    return sorted(rows, reverse=True)[:SLOWEST]


def main():
    LOG.mkdir(parents=True, exist_ok=True)
    for name in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL"):
        os.environ.pop(name, None)
    groups = sys.argv[1:]
    counts = [count for group in groups for count in run_group(group)]
    passed, failed, skipped = (sum(column) for column in zip(*counts, strict=True))
    if rows := slowest(part for group in groups for part in group.split("+")):
        print("\nslowest tests, wall seconds:")
    for seconds, part, suite, name in rows:
        print(f"{seconds:8.1f} s  {part:<12} {suite}  {name}")
    print(f"\n{passed} passed, {failed} failed" + (f", {skipped} skipped" if skipped else ""))
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
