#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Several processes: how fast they are, and whether they have the results of one.

usage: bench_ranks.py PROGRAM [N...] [--backend gpu] [--cells N] [--steps N] [--same]

N are numbers of processes; 1 2 if none are named. Each run is a burst in a box of 96^3 cells
(weak: two thirds of that in each direction for each process), 12 steps after a start, with one
thread for each process; on GPUs 256^3 cells and 60 steps, and as many processes as GPUs. The speed
is that of the steps of the air alone, as the run prints it. Efficiency: of strong scaling the speed
over n times that of one process; of weak scaling the same with the larger box. With threads of one
process for comparison, on the CPU.

--same compares instead: histories of 40 gauges and of all totals, at each of the steps, must be the
same text on any number of processes, and numbers are written so that no bit is lost.

Needs Python alone: PROGRAM, PROGRAM.ptx and this file can be carried to a machine without
compilers. There mpirun is what the variable MPIRUN says (default: that of the PATH, with options as
below); an Open MPI that was carried along wants OPAL_PREFIX and BRISANCE_MPI (its libmpi.so.40).
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

DECK = """\
&run title = 'burst', t_end = 1, max_steps = {steps} /
&air box = 0, 1, 0, 1, 0, {depth}, cells = {n}, {n}, {m}, reconstruction = 'muscl', flux = 'hllc',
     integrator = 'ssprk2', activity = {activity} /
&gas id = 'hot', box = 0.25, 0.75, 0.25, 0.75, 0.25, 0.75, pressure = 1e6, density = 1.2 /
&output history_every = {often} /
"""
MPIRUN = "mpirun -q --oversubscribe --mca mpi_yield_when_idle 1"
AS_ROOT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


def run(options, folder, deck, processes, threads=1):
    """What a run of a deck prints; its results lie in FOLDER/out."""
    (Path(folder) / "deck.nml").write_text(deck, encoding="utf-8")
    command = [str(options.program.resolve()), "run", "deck.nml", "--out", "out"]
    command += ["--backend", options.backend]
    if processes > 1:
        command = [*os.environ.get("MPIRUN", MPIRUN).split(), "-n", str(processes), *command]
    env = {**os.environ, **AS_ROOT, "OMP_NUM_THREADS": str(threads)}
    done = subprocess.run(command, cwd=folder, env=env, capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"{' '.join(command)}: {done.stderr or done.stdout}")
    return done.stdout


def speed(options, processes, threads, cells, layers):
    """Million cell-steps per second."""
    with tempfile.TemporaryDirectory() as folder:
        deck = DECK.format(n=cells, m=layers, depth=layers / cells, steps=options.steps,
                           activity=".false.", often=1)  # fmt: skip
        said = run(options, folder, deck, processes, threads)
        return float(re.search(r"^air +([\d.]+) Mcell-steps/s", said, re.M)[1])


def measure(options):
    """Print strong and weak scaling."""
    cells, small = options.cells, options.cells * 2 // 3
    one = speed(options, 1, 1, cells, cells)
    small_one = speed(options, 1, 1, small, small)
    on_cpu = options.backend == "cpu"
    threads = "   threads of one process" if on_cpu else ""
    print(f"processes   strong Mcell-steps/s  efficiency{threads}   ", end="")
    print("weak Mcell-steps/s  efficiency")
    for n in options.counts:
        strong = speed(options, n, 1, cells, cells)
        print(f"{n:9} {strong:22.2f} {strong / (n * one):11.2f} ", end="")
        if on_cpu:
            print(f"{speed(options, 1, n, cells, cells):24.2f} ", end="")
        weak = speed(options, n, 1, small, small * n)
        print(f"{weak:20.2f} {weak / (n * small_one):11.2f}", flush=True)


def burst(options):
    """A burst that leaves the box, with gauges everywhere."""
    gauges = "".join(
        f"&gauge id = 'g{g}', at = {g * 0.618034 % 1:.6f}, {g * 0.754878 % 1:.6f}, "
        f"{g * 0.569840 % 1:.6f}, quantity = 'pressure' /\n"
        for g in range(1, 41)
    )
    return gauges + DECK.format(n=options.cells, m=options.cells, depth=1, steps=options.steps,
                                activity=".true.", often=0)  # fmt: skip


def compare(options):
    """Are the histories of scenes the same on any number of processes?"""
    bad = 0
    for name, scene in (("air", burst),):
        texts = {}
        for n in options.counts:
            with tempfile.TemporaryDirectory() as folder:
                run(options, folder, scene(options), n)
                found = sorted((Path(folder) / "out").glob("*.csv"))
                texts[n] = [file.read_text(encoding="utf-8") for file in found]
            first = texts[options.counts[0]]
            same = texts[n] == first
            bad += not same
            rows = sum(text.count("\n") for text in first)
            print(f"{name} on {n}: {rows} rows, ", end="")
            print("the same" if same else f"not those of {options.counts[0]}", flush=True)
    sys.exit(bad > 0)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("counts", type=int, nargs="*", default=[1, 2])
    parser.add_argument("--backend", choices=("cpu", "gpu"), default="cpu")
    parser.add_argument("--cells", type=int)
    parser.add_argument("--steps", type=int)
    parser.add_argument("--same", action="store_true")
    options = parser.parse_args()
    on_gpu = options.backend == "gpu"
    options.cells = options.cells or (256 if on_gpu else 96)
    options.steps = options.steps or (60 if on_gpu else 12)
    if options.same:
        compare(options)
    else:
        measure(options)


if __name__ == "__main__":
    main()
