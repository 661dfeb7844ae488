#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Several processes or GPUs: how fast they are, and whether they have the results of one.

usage: bench_ranks.py PROGRAM [N...] [--backend gpu] [--scenes S,...] [--size X] [--steps N]
                      [--calls] [--same]

N are numbers of processes; 1 2 if none are named. Scenes are

    air      a burst in a box of 256^3 cells
    weak     the same, two thirds as long in each direction for each process
    solid    a turning cube of steel of 100^3 particles
    plate    a quarter of the paper's plate (2.43 million particles, 6.1 million cells) in a burst
    debris   a ball of aluminium that goes through a plate of plies (2 million particles)

of `air,weak` (on GPUs all) the first steps, with one thread for each process (on GPUs eight for the
set-up). --size scales the numbers of cells and particles along each direction; on the CPU it is
0.375. The time of a step is that of air, bodies and coupling, as the run prints it; efficiency is
the time of one process over that of n, times n but for `weak`. Gauges (in the air all totals, too)
must be the same text on any number of processes; numbers are written so that no bit is lost. With
threads of one process for comparison, on the CPU.

--calls prints what every process asked of its GPU and of others. --same takes small scenes and ends
with 1 where texts differ.

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

AIR = """\
&run title = 'burst', t_end = 1, max_steps = {steps} /
&air box = 0, 1, 0, 1, 0, {depth}, cells = {n}, {n}, {m}, reconstruction = 'muscl', flux = 'hllc',
     integrator = 'ssprk2', activity = {activity} /
&gas id = 'hot', box = 0.25, 0.75, 0.25, 0.75, 0.25, 0.75, pressure = 1e6, density = 1.2 /
"""
SOLID = """\
&run title = 'cube', t_end = 1, max_steps = {steps}, energy_band = 1 /
&material id = 's', preset = 'rebar' /
&body id = 'cube', shape = 'box', box = 0, {side}, 0, {side}, 0, {side}, spacing = 1e-3,
     material = 's', velocity = 20, -30, 10, spin = {spin}, {spin}, 0 /
"""
PLATE = """\
&run title = 'plate', t_end = 1, max_steps = {steps}, symmetry = 'x', 'y', energy_band = 1 /
&air box = 0, 0.1368, 0, 0.1368, -0.0288, 0.5328, cells = {n}, {n}, {m} /
&gas id = 'hot', box = 0, 0.06, 0, 0.06, 0.006, 0.06, pressure = 1e7, density = 20 /
&material id = 'cfrp', preset = 'cfrp_woven' /
&body id = 'plate', shape = 'box', box = 0, 0.125, 0, 0.125, -0.0042, 0, spacing = {spacing},
     material = 'cfrp', formulation = 'bending', velocity = 0, 0, -1
     fix_box = 0.1208, 0.126, -1, 1, -1, 1,  -1, 1, 0.1208, 0.126, -1, 1 /
"""
DEBRIS = """\
&run title = 'debris', t_end = 1, max_steps = {steps}, energy_band = 1 /
&material id = 'aluminium', preset = 'al2024_paper' /
&material id = 'cfrp', preset = 'cfrp_ud', pressure = 'anderson' /
&body id = 'ball', shape = 'sphere', centre = 0, 0, {above}, radius = 0.75e-3, spacing = {spacing},
     material = 'aluminium', velocity = 0, 0, -4960 /
&body id = 'plate', shape = 'box', box = -0.015, 0.015, -0.015, 0.015, -0.0023, 0,
     spacing = {spacing}, material = 'cfrp', plies = '4*(45/0/-45/90)', fix = 'sides',
     formulation = 'corrected_hourglass' /
&interaction bodies = 'ball', 'plate', law = 'contact', shared_pressure = .true. /
"""
GAUGE = "&gauge id = 'g{g}', {body} at = {x:.7f}, {y:.7f}, {z:.7f}, quantity = '{what}' /\n"
MPIRUN = "mpirun -q --oversubscribe --bind-to none --mca mpi_yield_when_idle 1"
AS_ROOT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
PARTS = [("time step", "air"), ("bodies", "lists of bodies"), ("walls", "loads", "exchange"),
         ("set-up", "start"), ("output",)]  # fmt: skip


def gauges(corner, sides, whats, body=""):
    """40 gauges everywhere in a box."""
    body = f"body = '{body}'," if body else ""
    places = (
        [
            c + s * (g * f % 1)
            for c, s, f in zip(corner, sides, (0.618034, 0.754878, 0.569840), strict=True)
        ]
        for g in range(1, 41)
    )
    return "".join(
        GAUGE.format(g=f"{body[8:11]}{g}", body=body, x=x, y=y, z=z, what=whats[g % len(whats)])
        for g, (x, y, z) in enumerate(places, 1)
    )


def deck_of(scene, size, steps, processes):
    """The deck of a scene, and whether all its totals must have the same text."""
    if scene in ("air", "weak"):
        n = round(256 * size) if scene == "air" else round(171 * size)
        m = n if scene == "air" else n * processes
        text = AIR.format(n=n, m=m, depth=m / n, steps=steps, activity=".false.")
        text += gauges((0, 0, 0), (1, 1, m / n), ["pressure"])
    elif scene == "solid":
        side = round(100 * size) * 1e-3
        text = SOLID.format(side=side, steps=steps, spin=200 / side)  # faces part at 400 m/s
        text += gauges((0, 0, 0), 3 * [side], ["stress_xx", "speed"], "cube")
    elif scene == "plate":
        layers = max(round(14 * size), 2)
        text = PLATE.format(n=round(114 * size), m=round(468 * size), spacing=4.2e-3 / layers,
                            steps=steps)  # fmt: skip
        text += gauges((0, 0, 0.001), (0.13, 0.13, 0.06), ["pressure", "velocity_z"])
        text += gauges((0, 0, -0.004), (0.12, 0.12, 0.0039), ["stress_xx", "velocity_z"], "plate")
    else:
        spacing = min(1e-4 / size, 2.9e-4)
        text = DEBRIS.format(spacing=spacing, above=0.75e-3 + spacing, steps=steps)
        text += gauges(
            (-2e-3, -2e-3, -2.2e-3), (4e-3, 4e-3, 2.1e-3), ["stress_zz", "velocity_z"], "plate"
        )
    return text + "&output history_every = 0, report_every = 100 /\n"


def run(options, folder, deck, processes, threads):
    """What a run of a deck prints; its results lie in FOLDER/out."""
    (Path(folder) / "deck.nml").write_text(deck, encoding="utf-8")
    command = [str(options.program.resolve()), "run", "deck.nml", "--out", "out"]
    command += ["--backend", options.backend, "--calls"] + ["--profile"] * options.profile
    if processes > 1:
        command = [*os.environ.get("MPIRUN", MPIRUN).split(), "-n", str(processes), *command]
    env = {**os.environ, **AS_ROOT, "OMP_NUM_THREADS": str(threads)}
    done = subprocess.run(command, cwd=folder, env=env, capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"{' '.join(command)}: {done.stderr or done.stdout}")
    return done.stdout


def measure(options, scene, processes, threads=0):
    """Milliseconds of air, bodies and coupling a step, seconds of set-up and output, histories."""
    threads = threads or (8 if options.backend == "gpu" else 1)
    with tempfile.TemporaryDirectory() as folder:
        deck = deck_of(scene, options.size, options.steps, processes)
        said = run(options, folder, deck, processes, threads)
        kind = "*.csv" if scene == "air" else "gauges.csv"
        found = sorted((Path(folder) / "out").glob(kind))
        texts = [file.read_text(encoding="utf-8") for file in found]
    steps = int(re.search(r"after (\d+) steps", said)[1])
    table = said.split("host of process 1:")[1].split("host of process 2:")[0]
    rows = re.findall(r"^([a-z].{19}) +(\d+) +([\d.]+) ", table, re.M)
    parts = [
        sum(int(n) * float(ms) for name, n, ms in rows if name.startswith(names)) for names in PARTS
    ]
    if options.calls or options.profile:
        print(re.sub(r"\ngauge .*?\n\n", "\n", said, count=1, flags=re.S))
    return [part / steps for part in parts[:3]], [1e-3 * part for part in parts[3:]], texts


def show(options, scene):
    """Print the table of a scene; true if texts differ."""
    print(f"{scene:8}  processes  ms a step      air    solid  coupling  efficiency  set-up s  "
          f"output s  gauges")  # fmt: skip
    runs = [(n, 0) for n in options.counts]
    if options.backend == "cpu" and not options.same:
        runs += [(1, n) for n in options.counts if n > 1]
    one, first, bad = None, None, False
    for n, threads in runs:
        parts, (setup, rest), texts = measure(options, scene, n, threads)
        one, first = one or n * sum(parts), first or texts
        share = max(n if scene != "weak" else options.counts[0], threads)
        verdict = "the same" if texts == first else "NOT THE SAME"
        if scene == "weak":  # another box
            verdict = ""
        bad = bad or "NOT" in verdict
        print(f"{f'{threads} threads' if threads else n:>19} {sum(parts):10.3f} "
              f"{parts[0]:8.3f} {parts[1]:8.3f} {parts[2]:9.3f} {one / (share * sum(parts)):11.2f} "
              f"{setup:9.1f} {rest:9.1f}  {verdict}", flush=True)  # fmt: skip
    return bad


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("counts", type=int, nargs="*", default=[1, 2])
    parser.add_argument("--backend", choices=("cpu", "gpu"), default="cpu")
    parser.add_argument("--scenes")
    parser.add_argument("--size", type=float)
    parser.add_argument("--steps", type=int)
    parser.add_argument("--calls", action="store_true")
    parser.add_argument("--profile", action="store_true")
    parser.add_argument("--same", action="store_true")
    options = parser.parse_args()
    on_gpu = options.backend == "gpu"
    options.size = options.size or (0.22 if options.same else 1 if on_gpu else 0.375)
    options.steps = options.steps or (60 if on_gpu else 12)
    scenes = options.scenes or ("air,weak,solid,plate,debris" if on_gpu else "air,weak")
    bad = [show(options, scene) for scene in scenes.split(",")]
    sys.exit(options.same and any(bad))


if __name__ == "__main__":
    main()
