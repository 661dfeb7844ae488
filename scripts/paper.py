#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Run the scenes of Chen et al.: every case of inputs/paper/campaign.toml at one size.

usage: paper.py SIZE [CASE...] [--backend cpu|gpu|auto] [--out FOLDER] [--brisance FILE] [--list]
       paper.py questions [QUESTION...]: the runs of inputs/paper/questions.toml, coarse;
       paper.py questions-fine [QUESTION...]: the same for a GPU

Results go to out/paper/SIZE/CASE, what a run prints to out/paper/SIZE/CASE.log. A case that has
results goes on from its last checkpoint, one that is done is passed over: so a campaign that was
stopped is continued by the same command. Ctrl-C and TERM leave a checkpoint. The exit code is that
of the first case that failed, 75 where it was stopped.
"""

import argparse
import dataclasses
import shlex
import signal
import subprocess
import sys
import time
import tomllib
from pathlib import Path

INPUTS = Path(__file__).parents[1] / "inputs" / "paper"
SIZES = ("full", "quarter", "coarse", "tiny")
QUESTIONS = {"questions": "coarse", "questions-fine": "fine"}
STOPPED = 75


@dataclasses.dataclass(frozen=True)
class Case:
    """One scene at one size: its name, section of the paper, deck and overrides."""

    name: str
    section: str
    deck: Path
    sets: tuple[str, ...]

    def arguments(self):
        """What follows `brisance run`: the deck and a `--set` for each override."""
        return [str(self.deck), *(part for text in self.sets for part in ("--set", text))]


def read_table(name):
    """A table of inputs/paper."""
    return tomllib.loads((INPUTS / name).read_text(encoding="utf-8"))


def cases(size, names=()):
    """The cases that exist at a size, those of `names` where there are any.

    Raises KeyError for an unknown case, and ValueError for one that lacks the size.
    """
    if size in QUESTIONS:
        return question_cases(size, names)
    table = read_table("campaign.toml")
    chosen = []
    for name in names or table["case"]:
        case = table["case"][name]
        if size not in case:
            if names:
                raise ValueError(f"{name} has no size '{size}'")
            continue
        sets = tuple(text for key in case[size] for text in table["sets"][key])
        chosen.append(Case(name, case["section"], INPUTS / case["deck"], sets))
    return chosen


def question_cases(size, names=()):
    """The runs of all questions of questions.toml, or of some; a run that several share once.

    Raises KeyError for an unknown question.
    """
    campaign, table = read_table("campaign.toml"), read_table("questions.toml")
    sets = campaign["sets"] | table["sets"] | table[f"sets_{QUESTIONS[size]}"]
    runs = [run for name in names or table["question"] for run in table["question"][name]["runs"]]
    chosen = []
    for name in dict.fromkeys(runs):
        base, *changes = table["run"][name]
        case = campaign["case"].get(base, {"deck": f"{base}.nml", "section": "3.2.2"})
        texts = tuple(text for change in changes for text in sets[change])
        chosen.append(Case(name, case["section"], INPUTS / case["deck"], texts))
    return chosen


def run_case(case, args, folder):
    """Run a case from its start or its last checkpoint; its exit code and the wall time [s]."""
    out = folder / case.name
    command = [str(args.brisance), "run", *case.arguments(), "--out", str(out)]
    if args.backend:
        command += ["--backend", args.backend]
    if any(out.glob("chk_*.h5")):
        command += ["--restart", "latest"]
    elif out.exists():
        command += ["--replace"]
    start = time.monotonic()
    with (folder / f"{case.name}.log").open("a", encoding="utf-8") as log:
        print(f"$ {shlex.join(command)}", file=log, flush=True)
        process = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT)
        signal.signal(signal.SIGTERM, lambda *_: process.terminate())
        try:
            code = process.wait()
        except KeyboardInterrupt:  # the run has had it as well, and writes its checkpoint
            code = process.wait()
    return code, time.monotonic() - start


def last_lines(file, n):
    """The last n lines of a text file, indented."""
    lines = file.read_text(encoding="utf-8", errors="replace").splitlines()
    return "\n".join(f"    {line}" for line in lines[-n:])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("size", choices=(*SIZES, *QUESTIONS))
    parser.add_argument("case", nargs="*", help="default: all that have this size")
    parser.add_argument(
        "--backend", choices=("cpu", "gpu", "auto"), help="default: as the deck says"
    )
    parser.add_argument("--out", type=Path, default=Path("out/paper"), help="default: out/paper")
    parser.add_argument("--brisance", type=Path, default=Path("bin/brisance"), help="the program")
    parser.add_argument("--list", action="store_true", help="print the commands and run nothing")
    args = parser.parse_args()
    try:
        chosen = cases(args.size, args.case)
    except (KeyError, ValueError) as problem:
        parser.error(f"unknown case: {problem}")
    if args.list:
        for case in chosen:
            print(shlex.join([str(args.brisance), "run", *case.arguments()]))
        return 0
    folder = args.out / args.size
    folder.mkdir(parents=True, exist_ok=True)
    first, total = 0, 0.0
    for number, case in enumerate(chosen, 1):
        print(f"[{number}/{len(chosen)}] {case.name:14} {case.section:26}", end=" ", flush=True)
        code, seconds = run_case(case, args, folder)
        total += seconds
        verdict = "done" if code == 0 else "stopped" if code == STOPPED else f"exit code {code}"
        left = total / number * (len(chosen) - number)
        print(
            f"{verdict:12} {seconds:8.1f} s, {total:8.1f} s in all, about {left:.0f} s to go",
            flush=True,
        )
        first = first or code
        if code not in (0, STOPPED):
            print(last_lines(folder / f"{case.name}.log", 5), flush=True)
        if code == STOPPED:
            break
    return first


if __name__ == "__main__":
    sys.exit(main())
