#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Run the parts of the test suite, one make target each; print the slowest tests, then the sum.

usage: run_tests.py [--quick] PART[+PART...]...

Parts joined by + run in two lanes: the first in one, the others one after another beside it.
--quick leaves out the tests that are labelled slow in their own file (TIER=quick for make), and
fails where another one computes for more than LIMIT core-seconds and does not say why in its file:
`!@long: reason` under the `subroutine` of a .pf file, `@pytest.mark.long("reason")` in Python. Such
a test is measured twice more alone, as processes that wait for each other compute, too, and as
neighbours on the same machine slow it down: the least of the three counts.

A part that leaves build/log/PART.xml (JUnit) is counted test by test; any other part counts as
one test. A part that ends badly without a failed test in its XML counts as one failure more. A
line 'skipped: why' of a part without XML makes it a skipped test. Each part says its seconds by the
clock and those of all cores. The ten slowest tests of all XML are listed with their core-seconds
(where they are not told, with those of the clock); the last line is the sum.
"""

import os
import re
import subprocess
import sys
import time
import xml.etree.ElementTree as xml
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

LOG = Path("build/log")
TAIL = 60
SLOWEST = 10
LIMIT = 10  # core-seconds of a test that does not say why
AGAIN = 2  # times that a test beyond it is measured once more


def count_xml(path):
    """Numbers of passed, failed and skipped tests in a JUnit file."""
    cases = list(xml.parse(path).iter("testcase"))
    bad = sum(c.find("failure") is not None or c.find("error") is not None for c in cases)
    skipped = sum(c.find("skipped") is not None for c in cases)
    return len(cases) - bad - skipped, bad, skipped


def run_make(part, quick, log, *more):
    """Exit code and core-seconds of one target."""
    command = [os.environ.get("MAKE", "make"), "--no-print-directory", part, *more]
    command.insert(1, f"-j{len(os.sched_getaffinity(0))}")
    if quick:
        command.append("TIER=quick")
    with log.open("w", encoding="utf-8") as out:
        run = subprocess.Popen(command, stdout=out, stderr=subprocess.STDOUT)
        _, status, usage = os.wait4(run.pid, 0)
        run.returncode = os.waitstatus_to_exitcode(status)
    return run.returncode, usage.ru_utime + usage.ru_stime


def run_part(part, quick):
    """Run one target; (passed, failed, skipped, core-seconds)."""
    report, log = LOG / f"{part}.xml", LOG / f"{part}.log"
    report.unlink(missing_ok=True)
    start = time.monotonic()
    code, core = run_make(part, quick, log)
    text = log.read_text(encoding="utf-8", errors="replace")
    try:
        passed, failed, skipped = count_xml(report)
    except (OSError, xml.ParseError):
        skipped = int(code == 0 and "skipped: " in text)
        passed, failed = int(code == 0 and not skipped), 0
    if code and not failed:
        failed = 1
    line = f"{part:<12} {passed:5} passed, {failed} failed, {skipped} skipped"
    lines = [f"{line} {time.monotonic() - start:8.1f} s {core:8.1f} core-s"]
    if failed:
        lines += ["", *text.splitlines()[-TAIL:], f"(all of it: {log})", ""]
    else:
        lines += [line for line in text.splitlines() if "skipped: " in line]
    print("\n".join(lines), flush=True)
    return passed, failed, skipped, core


def run_group(group, quick):
    """Counts of the parts of a group: the first in one lane, the others in another."""
    first, *others = group.split("+")
    with ThreadPoolExecutor(2) as lanes:
        main_lane = lanes.submit(run_part, first, quick)
        beside = lanes.submit(lambda: [run_part(part, quick) for part in others])
        return [main_lane.result(), *beside.result()]


def properties(case):
    """What a test case says of itself: its attributes, and the properties that pytest writes."""
    more = {found.get("name"): found.get("value") for found in case.iter("property")}
    return dict(case.items()) | more


def timed_tests(parts):
    """The tests of the JUnit files of parts, the slowest first: (seconds, part, properties)."""
    rows = []
    for part in parts:
        try:
            cases = [properties(case) for case in xml.parse(LOG / f"{part}.xml").iter("testcase")]
        except (OSError, xml.ParseError):
            continue
        rows += [(seconds_of(c), part, c) for c in cases]
    return sorted((row for row in rows if row[0] > 0), key=lambda row: row[0], reverse=True)


def reason(case):
    """Why a test may take long, as its file says; nothing where it does not."""
    if case.get("long"):
        return case["long"]
    suite = case.get("classname", "").removesuffix("_suite")
    name = re.escape(case.get("name", "").partition("[")[0])
    found = None
    for path in Path("tests").glob(f"*/{suite}.pf"):
        body = rf"^ *subroutine {name}\b(?:(?!^ *end subroutine).)*?^ *!@long: (\S[^\n]*)"
        found = found or re.search(body, path.read_text(encoding="utf-8"), re.S | re.M)
    return found[1] if found else ""


def seconds_of(case):
    """Core-seconds of a test, where they are not told its seconds by the clock."""
    return float(case.get("core", case.get("time", 0)))


def seconds_alone(part, case):
    """Core-seconds of one test that runs again, without any other."""
    name, report = case.get("name", ""), LOG / f"{part}.xml"
    file = f"{case.get('classname', '').replace('.', '/')}.py"
    whole = report.read_bytes()
    chosen = f"'{file}::{name}'" if Path(file).is_file() else f"-f {name.partition('[')[0]}"
    run_make(part, True, LOG / f"{part}-alone.log", f"ARGS={chosen}")
    cases = [properties(found) for found in xml.parse(report).iter("testcase")]
    report.write_bytes(whole)
    same = [c for c in cases if all(c.get(key) == case.get(key) for key in ("classname", "name"))]
    return seconds_of(same[0] if same else case)


def too_long(rows):
    """Lines on tests that take longer than they may."""
    for found, part, case in rows:
        if found <= LIMIT or reason(case):
            continue
        seconds = found
        for _ in range(AGAIN):
            seconds = min(seconds, seconds_alone(part, case)) if seconds > LIMIT else seconds
        if seconds > LIMIT:
            what = f"{part} {case.get('classname')} {case.get('name')}"
            yield f"{what}: {seconds:.1f} core-seconds, more than {LIMIT} and no reason in its file"


def main():
    LOG.mkdir(parents=True, exist_ok=True)
    for name in ("MAKEFLAGS", "MFLAGS", "MAKELEVEL"):
        os.environ.pop(name, None)
    groups = [word for word in sys.argv[1:] if word != "--quick"]
    quick, start = "--quick" in sys.argv, time.monotonic()
    counts = [count for group in groups for count in run_group(group, quick)]
    passed, failed, skipped, core = (sum(column) for column in zip(*counts, strict=True))
    rows = timed_tests(part for group in groups for part in group.split("+"))
    if rows:
        print("\nslowest tests, core-seconds:")
    for seconds, part, case in rows[:SLOWEST]:
        print(f"{seconds:8.1f} s  {part:<12} {case.get('classname')}  {case.get('name')}")
    faults = list(too_long(rows)) if quick else []
    print("\n".join(["", *faults]))
    print(f"{time.monotonic() - start:.0f} s, {core:.0f} core-seconds")
    failed += len(faults)
    print(f"{passed} passed, {failed} failed" + (f", {skipped} skipped" if skipped else ""))
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
