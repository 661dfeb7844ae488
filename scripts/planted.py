#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Plant faults in a copy of the sources, and see whether the tests notice them.

usage: planted.py [TEXT...]

For every fault of tests/planted.toml that has a TEXT in what it is, its file or its tests: the
file is changed in a copy of what git tracks, build/planted, and the tests that must see it run
there. Before, they run without the fault. Tests that hang on a fault see it. Ends with 1 where a
fault is not seen, where tests fail without it, or where what is to be changed does not stand in the
file once. Everything is built with QUICK=1. The tests are those of `make test`: a fault that slow
ones alone see has `slow`, the reason.
"""

import os
import shlex
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


def link_quick():
    """Tests of Python find the program and the emulated driver under their usual names."""
    for name, made in (
        ("bin/brisance", "brisance-quick"),
        ("build/cpu", "cpu-quick"),
        ("build/gpu/emulator", "emulator-quick"),
    ):
        if not (COPY / name).is_symlink():
            (COPY / name).parent.mkdir(parents=True, exist_ok=True)
            (COPY / name).symlink_to(made)


def commands_for(target, arguments, slow):
    """What builds and runs tests."""
    make = ["make", "-j2", "QUICK=1", *([] if slow else ["TIER=quick"])]
    if target != "python":
        return [[*make, target, f"ARGS={arguments}"]]
    label = [] if slow else ["-m", "not slow"]
    report = ["--junitxml=build/log/python.xml"]
    pytest = [".venv/bin/python", "-m", "pytest", *label, *report, *shlex.split(arguments)]
    return [[*make, "all", "emulator"], pytest]


def results(target, arguments, slow=False):
    """How many tests run and how many fail, 1 if they hang; 0 where they cannot be built or run."""
    report = COPY / "build" / "log" / f"{target}.xml"
    report.parent.mkdir(parents=True, exist_ok=True)
    report.unlink(missing_ok=True)
    with (COPY / "planted.log").open("w", encoding="utf-8") as log:
        for command in commands_for(target, arguments, slow):
            run = subprocess.Popen(command, cwd=COPY, stdout=log, stderr=subprocess.STDOUT,
                                   start_new_session=True)  # fmt: skip
            try:
                if run.wait(PATIENCE) and command[0] == "make" and target == "python":
                    return 0, 0
            except subprocess.TimeoutExpired:
                os.killpg(run.pid, signal.SIGKILL)
                run.wait()
                return 1, 1
    try:
        passed, failed, _ = count_xml(report)
    except (OSError, ParseError):
        return 0, 0
    return passed + failed, failed


def plant(fault):
    """What becomes of a fault, and whether that is as it must be."""
    path = COPY / fault["file"]
    good = path.read_text(encoding="utf-8")
    if good.count(fault["old"]) != 1:
        return "what is to be changed does not stand there once", False
    path.write_text(good.replace(fault["old"], fault["new"]), encoding="utf-8")
    number, failed = results(*fault["test"], slow="slow" in fault)
    path.write_text(good, encoding="utf-8")
    if not number:
        return f"is not built, or its tests do not run: {COPY}/planted.log", False
    return (f"seen, tests that fail: {failed}" if failed else "NOT SEEN"), failed > 0


def as_it_is(test, slow):
    """Whether tests run and pass without a fault."""
    number, failed = results(*test, slow=slow)
    verdict = f"{number} tests, {failed} fail" if number else "NONE IN make test, or not built"
    print(f"{'as it is: ' + ' '.join(test):70} {verdict}", flush=True)
    return number > 0 and failed == 0


def main():
    texts = sys.argv[1:] or [""]
    faults = tomllib.loads((HOME / "tests/planted.toml").read_text(encoding="utf-8"))["fault"]
    about = [" ".join([fault["what"], fault["file"], *fault["test"]]) for fault in faults]
    faults = [f for f, words in zip(faults, about, strict=True) if any(t in words for t in texts)]
    copy_sources()
    link_quick()
    fine = bool(faults)
    for test, slow in dict.fromkeys((tuple(fault["test"]), "slow" in fault) for fault in faults):
        fine = as_it_is(test, slow) and fine
    for fault in faults:
        verdict, good = plant(fault)
        print(f"{fault['what']:70} {verdict}", flush=True)
        fine = fine and good
    sys.exit(not fine)


if __name__ == "__main__":
    main()
