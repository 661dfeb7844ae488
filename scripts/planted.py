#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Plant faults in a copy of the sources, and see whether the tests notice them.

usage: planted.py [TEXT]

For every fault of tests/planted.toml that has TEXT in what it is: the file is changed in a copy of
what git tracks, build/planted, and the tests that must see it are run there. Before, they run
without the fault. Tests that hang on a fault see it. Ends with 1 where a fault is not seen, where
tests fail without it, or where what is to be changed does not stand in the file once. Tests of
Python take a native build, all others one with QUICK=1.
"""

import os
import signal
import subprocess
import sys
import tomllib
from pathlib import Path
from xml.etree.ElementTree import ParseError

from run_tests import count_xml

HOME = Path(__file__).resolve().parents[1]
COPY = HOME / "build" / "planted"
PATIENCE = 400  # [s] for a build and tests that hang on a fault, say as a process is waited for


def write_if_changed(path, content):
    """What stands there already keeps its time, so that make builds little."""
    if not (path.is_file() and path.read_bytes() == content):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)


def copy_sources():
    """The files that git tracks, as they are now, and the environment of Python."""
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=HOME, capture_output=True, check=True)
    for name in listed.stdout.decode().split("\0"):
        if (HOME / name).is_file():
            write_if_changed(COPY / name, (HOME / name).read_bytes())
            (COPY / name).chmod((HOME / name).stat().st_mode)
    if not (COPY / ".venv").exists():
        (COPY / ".venv").symlink_to(HOME / ".venv")


def failures(target, arguments):
    """How many tests fail, 1 if they hang; -1 where they cannot be built or run."""
    report = COPY / "build" / "log" / f"{target}.xml"
    report.unlink(missing_ok=True)
    command = ["make", "-j2", target, f"ARGS={arguments}"]
    if target != "python":
        command.insert(1, "QUICK=1")
    with (COPY / "planted.log").open("w", encoding="utf-8") as log:
        run = subprocess.Popen(command, cwd=COPY, stdout=log, stderr=subprocess.STDOUT,
                               start_new_session=True)  # fmt: skip
        try:
            run.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            os.killpg(run.pid, signal.SIGKILL)
            run.wait()
            return 1
    try:
        return count_xml(report)[1]
    except (OSError, ParseError):
        return -1


def plant(fault):
    """What becomes of a fault, and whether that is as it must be."""
    path = COPY / fault["file"]
    good = path.read_text(encoding="utf-8")
    if good.count(fault["old"]) != 1:
        return "what is to be changed does not stand there once", False
    path.write_text(good.replace(fault["old"], fault["new"]), encoding="utf-8")
    found = failures(*fault["test"])
    path.write_text(good, encoding="utf-8")
    if found < 0:
        return f"is not built, or its tests do not run: {COPY}/planted.log", False
    return (f"seen, tests that fail: {found}" if found else "NOT SEEN"), found > 0


def main():
    text = sys.argv[1] if len(sys.argv) > 1 else ""
    faults = tomllib.loads((HOME / "tests/planted.toml").read_text(encoding="utf-8"))["fault"]
    faults = [fault for fault in faults if text in fault["what"]]
    copy_sources()
    fine = bool(faults)
    for test in dict.fromkeys(tuple(fault["test"]) for fault in faults):
        found = failures(*test)
        print(f"{'as it is: ' + ' '.join(test):70} {found} tests fail", flush=True)
        fine = fine and found == 0
    for fault in faults:
        verdict, good = plant(fault)
        print(f"{fault['what']:70} {verdict}", flush=True)
        fine = fine and good
    sys.exit(not fine)


if __name__ == "__main__":
    main()
