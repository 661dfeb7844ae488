#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Show that the pair loops of the solid are vector code: count the arithmetic in their loops.

usage: vectors.py OBJECT      (the optimised object of the library, build/cpu/brisance.o)

Disassembles each procedure whose name begins with `sum_` in the modules below, takes its loop over
the pairs (the loop with the most arithmetic) and counts operations on whole vectors and on single
numbers. A loop with fewer than 30 vector operations or with any on single numbers ends with code 1.
"""

import re
import subprocess
import sys

MODULES = ("brz_solid_gradient_sums", "brz_solid_pair_sums")
EXPECTED = 19
LEAST = 30
ARITHMETIC = re.compile(r"v?(?:fn?m(?:add|sub)\d*|mul|add|sub|div|sqrt|max|min)([ps])[sd]$")
WIDTH = {"x": 16, "y": 32, "z": 64}


def procedures(text):
    """(name, [(address, mnemonic, operands)]) of every pair loop in a disassembly."""
    for part in re.split(r"\n(?=[0-9a-f]+ <)", text):
        head = re.match(rf"[0-9a-f]+ <__({'|'.join(MODULES)})_MOD_(sum_\w+)>:", part)
        if head:
            rows = re.findall(r"^ *([0-9a-f]+):\s+(\S+) *(.*)$", part, re.M)
            yield f"{head[1]}: {head[2]}", [(int(a, 16), m, o) for a, m, o in rows]


def count(rows, first, last):
    """Vector operations, how many of them fused, single ones and bytes, from address to address."""
    vector = fused = single = width = 0
    for address, mnemonic, operands in rows:
        found = ARITHMETIC.match(mnemonic)
        if not (found and first <= address <= last):
            continue
        if found[1] == "s":
            single += 1
            continue
        vector += 1
        fused += "fm" in mnemonic or "fnm" in mnemonic
        width = max([width, *(WIDTH[r] for r in re.findall(r"%([xyz])mm", operands))])
    return vector, fused, single, width


def loops(rows):
    """Address of the first and the last instruction of every loop."""
    start = rows[0][0]
    for address, mnemonic, operands in rows:
        target = re.match(r"([0-9a-f]+) <", operands)
        if mnemonic.startswith("j") and target and start <= int(target[1], 16) < address:
            yield int(target[1], 16), address


def main(path):
    """Print a table; the exit code."""
    kind = subprocess.run(["objdump", "-f", path], capture_output=True, text=True, check=True)
    if "x86-64" not in kind.stdout:
        print("skipped: the counts are known for x86-64 only")
        return 0
    command = ["objdump", "-d", "--no-show-raw-insn", path]
    text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    bad = found = 0
    print("operations of one turn of the loop over pairs: on vectors (fused), on single numbers")
    for name, rows in procedures(text):
        found += 1
        best = max((count(rows, *span) for span in loops(rows)), default=(0, 0, 0, 0))
        vector, fused, single, width = best
        lost = vector < LEAST or single > 0
        bad += lost
        print(
            f"{name:<38} {vector:4} ({fused:3}) {single:4}   vectors of {width} B"
            f"{'   NOT VECTORISED' if lost else ''}"
        )
    if found < EXPECTED:
        print(f"only {found} of {EXPECTED} loops were found in {path}")
    return int(bad > 0 or found < EXPECTED)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
