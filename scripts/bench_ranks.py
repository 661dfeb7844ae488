#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Speed of the air on several processes: strong and weak scaling, and threads for comparison.

usage: bench_ranks.py PROGRAM [N...]      (numbers of processes; 1 2 if none are named)

Each run is a burst in a box of 96^3 cells (weak: 64^3 for each process), 12 steps after a start,
with one thread for each process. The speed is that of the steps of the air alone, as the run
prints it. Efficiency: of strong scaling the speed over n times that of one process; of weak scaling
the same with the larger box.
"""

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

DECK = """\
&run title = 'burst', t_end = 1, max_steps = 12 /
&air box = 0, 1, 0, 1, 0, {depth}, cells = {n}, {n}, {m}, reconstruction = 'muscl', flux = 'hllc',
     integrator = 'ssprk2', activity = .false. /
&gas id = 'hot', box = 0.25, 0.75, 0.25, 0.75, 0.25, 0.75, pressure = 1e6, density = 1.2 /
&output history_every = 1 /
"""
MPIRUN = "mpirun -q --oversubscribe --mca mpi_yield_when_idle 1"
AS_ROOT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


def speed(program, processes, threads, cells, layers):
    """Million cell-steps per second."""
    with tempfile.TemporaryDirectory() as folder:
        deck = DECK.format(n=cells, m=layers, depth=layers / cells)
        (Path(folder) / "burst.nml").write_text(deck)
        command = [str(program), "run", "burst.nml"]
        if processes > 1:
            command = [*MPIRUN.split(), "-n", str(processes), *command]
        env = {**os.environ, **AS_ROOT, "OMP_NUM_THREADS": str(threads)}
        done = subprocess.run(command, cwd=folder, env=env, capture_output=True, text=True,
                              check=False)  # fmt: skip
        found = re.search(r"^air +([\d.]+) Mcell-steps/s", done.stdout, re.M)
        if done.returncode or not found:
            sys.exit(f"{' '.join(command)}: {done.stderr or done.stdout}")
        return float(found[1])


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    program = Path(sys.argv[1]).resolve()
    counts = [int(n) for n in sys.argv[2:]] or [1, 2]
    one = speed(program, 1, 1, 96, 96)
    small = speed(program, 1, 1, 64, 64)
    print("processes   strong Mcell-steps/s  efficiency   threads of one process   ", end="")
    print("weak Mcell-steps/s  efficiency")
    for n in counts:
        strong, threads = speed(program, n, 1, 96, 96), speed(program, 1, n, 96, 96)
        weak = speed(program, n, 1, 64, 64 * n)
        print(f"{n:9} {strong:22.2f} {strong / (n * one):11.2f} {threads:24.2f} ", end="")
        print(f"{weak:20.2f} {weak / (n * small):11.2f}", flush=True)


if __name__ == "__main__":
    main()
