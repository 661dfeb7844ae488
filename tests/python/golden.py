# SPDX-License-Identifier: MIT
"""Golden curves: one small table per deck of inputs/material, kept in tests/golden.

usage: make golden               writes them anew; look at what changed before you commit it
       make golden CASE=name     writes that one

The curves are those of the native build in double precision: others differ by rounding in most.
"""

import subprocess
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[2]
BRISANCE = ROOT / "bin" / "brisance"
DECKS = ROOT / "inputs" / "material"
GOLDEN = ROOT / "tests" / "golden"
TOLERANCE = 1e-6  # of the largest number of a column


def names():
    return sorted(deck.stem for deck in DECKS.glob("*.nml"))


def drive(name, out, *args):
    """The table of a deck, as names of columns and rows of numbers."""
    command = [BRISANCE, "mat", DECKS / f"{name}.nml", "--out", out, "--replace", *args]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, f"{name}: {done.stderr}"
    return read(out)


def read(file):
    with Path(file).open() as lines:
        columns = lines.readline().strip().split(",")
        return columns, np.loadtxt(lines, delimiter=",", ndmin=2)


def differences(golden, found):
    """What differs, in words; nothing if the tables agree."""
    if golden[0] != found[0]:
        return ["the columns differ"]
    if golden[1].shape != found[1].shape:
        return [f"{len(found[1])} rows in place of {len(golden[1])}"]
    scale = np.abs(golden[1]).max(axis=0)
    error = np.abs(found[1] - golden[1]).max(axis=0)
    return [
        f"{name}: off by {e:.3g}, largest number {s:.3g}"
        for name, e, s in zip(golden[0], error, scale, strict=True)
        if not e <= TOLERANCE * max(s, scale_of(name))
    ]


def scale_of(name):
    """Numbers below this count as zero, times the tolerance: rounding of stresses that cancel."""
    return {"Pa": 1e7, "J/kg": 1.0}.get(name.partition("[")[2].rstrip("]"), 1e-6)


def is_native(version):
    """True if --version tells of the native build in double precision."""
    words = version.split()
    return "-O3" in words and "-march=native" in words and "working precision: double" in version


def write(name):
    """Write the curve of a deck anew."""
    file = GOLDEN / f"{name}.csv"
    columns, rows = drive(name, file)
    with file.open("w") as out:
        out.write(",".join(columns) + "\n")
        for row in rows:
            out.write(",".join(f"{x:.9g}" for x in row) + "\n")
    print(f"{file}: {len(rows)} rows, {file.stat().st_size} bytes", flush=True)


def main(chosen):
    """Write the curves of the decks in `chosen`, of all without any; returns what is wrong."""
    version = subprocess.run([BRISANCE, "--version"], capture_output=True, text=True, check=True)
    if not is_native(version.stdout):
        return f"make golden: {BRISANCE} is not the native build in double precision: run `make`"
    unknown = ", ".join(sorted(set(chosen) - set(names())))
    if unknown:
        return f"make golden: there is no {unknown}; CASE is one of {', '.join(names())}"
    GOLDEN.mkdir(exist_ok=True)
    for name in chosen or names():
        write(name)
    for old in set(GOLDEN.glob("*.csv")) - {GOLDEN / f"{name}.csv" for name in names()}:
        old.unlink()
    return None


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
