#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Run the scenes of Chen et al.: every case of inputs/paper/campaign.toml at one size.

usage: paper.py SIZE [CASE...] [--backend cpu|gpu|auto] [--out FOLDER] [--brisance FILE] [--list]
                [--gpus N] [--share N]
       paper.py questions [QUESTION...]: the runs of inputs/paper/questions.toml, coarse;
       paper.py questions-fine [QUESTION...]: the same for a GPU

Results go to out/paper/SIZE/CASE, what a run prints to out/paper/SIZE/CASE.log. A case that has
results goes on from its last checkpoint, one that is done is passed over: so a campaign that was
stopped is continued by the same command. Ctrl-C and TERM leave a checkpoint. The exit code is that
of the first case that failed, 75 where it was stopped.

Each GPU of the machine (`--gpus`: so many of them) takes one case after the other, the longest
first; with `--share 2` each runs two at a time. With `--backend cpu` no GPU is asked for. Cores
are shared out among the runs that go on at once.
"""

import argparse
import dataclasses
import os
import shlex
import signal
import subprocess
import sys
import threading
import time
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from post.processes import Processes  # noqa: E402
from post.runner import STOPPED  # noqa: E402

INPUTS = ROOT / "inputs" / "paper"
SIZES = ("full", "quarter", "coarse", "tiny")
QUESTIONS = {"questions": "coarse", "questions-fine": "fine"}


@dataclasses.dataclass(frozen=True)
class Case:
    """One scene at one size: its name, section of the paper, deck and overrides."""

    name: str
    section: str
    deck: Path
    sets: tuple[str, ...]
    seconds: float = 60  # that it takes, about: of one H100 at the paper's resolution

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
        deck = INPUTS / case["deck"]
        chosen.append(Case(name, case["section"], deck, sets, case.get("seconds", 60)))
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


class Campaign:
    """Cases that wait, run and are done, on several GPUs at once."""

    def __init__(self, chosen, args, folder, places):
        self.args, self.folder, self.places = args, folder, places
        self.number = len(chosen)
        first = (lambda case: -case.seconds) if len(places) > 1 else (lambda case: 0)
        self.waiting = sorted(chosen, key=first)
        self.processes, self.code, self.stopped = Processes(), 0, False
        self.done, self.start = 0, time.monotonic()
        self.work = [sum(case.seconds for case in chosen), 0.0]  # all, done
        self.lock = threading.Lock()

    def run(self):
        """All cases; the exit code of the first that failed."""
        before = {one: signal.signal(one, self.stop) for one in (signal.SIGTERM, signal.SIGINT)}
        queues = [threading.Thread(target=self.serve, args=(place,)) for place in self.places]
        for queue in queues:
            queue.start()
        for queue in queues:
            while queue.is_alive():  # signals are heard between two waits
                queue.join(0.2)
        for number, handler in before.items():
            signal.signal(number, handler)
        return self.code

    def stop(self, number, frame):
        """Begin nothing more, and let each run that goes on write its checkpoint."""
        self.stopped = True
        self.processes.stop()

    def serve(self, place):
        """One case after the other in one place: the numbers of its GPUs, or None."""
        while True:
            with self.lock:
                if self.stopped or not self.waiting:
                    return
                case = self.waiting.pop(0)
            start = time.monotonic()
            code = self.run_case(case, place)
            with self.lock:
                self.tell(case, code, time.monotonic() - start, place)
                self.code = self.code or code
                self.stopped = self.stopped or code == STOPPED

    def run_case(self, case, place):
        """Run a case from its start or its last checkpoint; its exit code."""
        out = self.folder / case.name
        together, backend = self.args.processes > 1, self.args.backend
        command = [str(self.args.brisance), "run", *case.arguments(), "--out", str(out)]
        if together:
            command = ["mpirun", "-n", str(self.args.processes), "--bind-to", "none", *command]
            backend = backend or ("gpu" if gpus() else None)  # several take it only when told
        if backend:
            command += ["--backend", backend]
        if any(out.glob("chk_*.h5")):
            command += ["--restart", "latest"]
        elif out.exists():
            command += ["--replace"]
        surroundings = dict(os.environ)
        shares = len(self.places) * self.args.processes
        if shares > 1:
            cores = max(1, len(os.sched_getaffinity(0)) // shares)
            surroundings.setdefault("OMP_NUM_THREADS", str(cores))
        if place is not None:
            surroundings["CUDA_VISIBLE_DEVICES"] = place
        with (self.folder / f"{case.name}.log").open("a", encoding="utf-8") as log:
            print(f"$ {shlex.join(command)}", file=log, flush=True)
            return self.processes.run(command, log, environment=surroundings)[0]

    def tell(self, case, code, seconds, place):
        """A line when a case has ended, with how long the others will take."""
        self.done += 1
        self.work[1] += case.seconds
        total = time.monotonic() - self.start
        left = total * (self.work[0] / self.work[1] - 1)
        verdict = "done" if code == 0 else "stopped" if code == STOPPED else f"exit code {code}"
        print(
            f"[{self.done}/{self.number}] {case.name:14} {case.section:26} {verdict:12} "
            f"{seconds:8.1f} s{'' if place is None else f' on GPU {place}'}, "
            f"{total:8.1f} s in all, about {left:.0f} s to go",
            flush=True,
        )
        if code not in (0, STOPPED):
            print(last_lines(self.folder / f"{case.name}.log", 5), flush=True)


def gpus():
    """The GPUs of this machine, as CUDA_VISIBLE_DEVICES names them; none without a driver."""
    if "CUDA_VISIBLE_DEVICES" in os.environ:
        return [one for one in os.environ["CUDA_VISIBLE_DEVICES"].split(",") if one]
    try:
        asked = ["nvidia-smi", "--query-gpu=index", "--format=csv,noheader"]
        return subprocess.run(asked, capture_output=True, text=True, check=True).stdout.split()
    except (OSError, subprocess.CalledProcessError):
        return []


def places_of(args):
    """Where runs go on at once: GPUs for each, one for a process, or one place without a choice.

    Raises ValueError where there are fewer GPUs than asked for.
    """
    if args.backend == "cpu":
        return [None] * args.share
    found = gpus()[: args.gpus]
    if len(found) < (args.gpus or 0):
        raise ValueError(f"there are {len(found)} GPUs, not {args.gpus}")
    n = args.processes
    if 0 < len(found) < n:
        raise ValueError(f"there are {len(found)} GPUs for {n} processes")
    groups = [",".join(found[i : i + n]) for i in range(0, len(found) - n + 1, n)]
    return (groups if len(found) > 1 else [None]) * args.share


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
    parser.add_argument("--gpus", type=int, help="how many of the GPUs; default: all")
    parser.add_argument(
        "--processes", type=int, default=1, help="of a run, by mpirun, each on a GPU; default: 1"
    )
    parser.add_argument("--share", type=int, default=1, help="runs at once on each; default: 1")
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
    try:
        campaign = Campaign(chosen, args, folder, places_of(args))
    except ValueError as problem:
        parser.error(str(problem))
    return campaign.run()


if __name__ == "__main__":
    sys.exit(main())
