#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Count the lines that tests have run, by folder and file, from what gcov wrote.

usage: coverage.py BUILD [FILE]      (BUILD: build/cpu-coverage)

Prints a line per folder of src (generated loops: build/made), the files with least, and the sum in
the last line. With FILE, the numbers of its lines that no test has run. Lines are those that hold
code, as gcov tells; one that ran in any of the objects counts as run.
"""

import json
import os
import subprocess
import sys
from collections import defaultdict
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

WORST = 12


def counts_of(data):
    """{source: {line: count}} of one file of counts."""
    command = ["gcov", "--json-format", "--stdout", str(data.resolve())]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    found = {}
    for text in done.stdout.splitlines():
        if not text.startswith("{"):
            continue
        for file in json.loads(text)["files"]:
            lines = found.setdefault(file["file"], defaultdict(int))
            for line in file["lines"]:
                lines[line["line_number"]] += line["count"]
    return found


def collect(build):
    """{source, from the root: {line: count}}, sources that no test has reached included."""
    files = sorted(build.glob("obj/**/*.gcno"))
    total = defaultdict(lambda: defaultdict(int))
    with ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        for found in pool.map(counts_of, files):
            for name, lines in found.items():
                path = os.path.relpath(name)
                if path.startswith(("src/", "build/made/")):
                    for line, count in lines.items():
                        total[path][line] += count
    return total


def share(files):
    """Lines that have run, lines, per cent."""
    lines = sum(len(counts) for counts in files)
    run = sum(count > 0 for counts in files for count in counts.values())
    return run, lines, 100 * run / max(lines, 1)


def ranges(numbers):
    """'3-5, 8' of 3, 4, 5, 8."""
    parts = []
    for number in sorted(numbers):
        if parts and parts[-1][1] == number - 1:
            parts[-1][1] = number
        else:
            parts.append([number, number])
    return ", ".join(f"{a}-{b}" if b > a else str(a) for a, b in parts)


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    total = collect(Path(sys.argv[1]))
    if not total:
        sys.exit(f"coverage: {sys.argv[1]} holds no counts: run make coverage")
    if len(sys.argv) == 3:
        counts = total.get(sys.argv[2])
        if counts is None:
            sys.exit(f"coverage: no counts of {sys.argv[2]}")
        print(f"{sys.argv[2]}: not run: {ranges(n for n, c in counts.items() if not c) or 'none'}")
        return
    folders = defaultdict(dict)
    for path, counts in total.items():
        folders[str(Path(path).parent)][path] = counts
    for folder in sorted(folders):
        run, lines, per_cent = share(folders[folder].values())
        print(f"{folder:<16} {run:6} of {lines:6} lines {per_cent:6.1f} %")
    print("\nleast:")
    worst = sorted(total, key=lambda path: share([total[path]])[2])[:WORST]
    for path in worst:
        print(f"{path:<40} {share([total[path]])[2]:6.1f} %")
    run, lines, per_cent = share(total.values())
    print(f"\n{run} of {lines} lines run: {per_cent:.1f} %")


if __name__ == "__main__":
    main()
