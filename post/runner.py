# SPDX-License-Identifier: MIT
"""Runs of the program for studies and certificates: each one once for ever, several at a time.

A run is known by what it means: the complete deck as the program tells it (`--check --echo`), the
stamp of the program and the bytes of the files that the deck names. Output settings, title and
backend are no part of it. `Store.folder/runs/<key>/result.json` is written last and by renaming: a
run is complete or not there, whatever ends the study.
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import math
import os
import re
import shutil
import signal
import subprocess
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

from post.errors import USAGE, PostError
from post.packing import NotPackable, Pack, pack, share_out
from post.processes import TOO_LONG, Processes
from post.reader import Run
from post.results import results

MEASURED = 2  # version of what is measured: a change measures nothing anew, it runs anew
STOPPED = 75  # exit code of a run that was stopped with a checkpoint
UNHEARD = 128 + signal.SIGUSR2  # of one that was asked to stop before it could hear it
NOT_MEANING = ("&output",)  # groups that do not change what a run computes
NOT_KEYS = ("title", "backend")  # keys that do not
FILES = re.compile(r"=\s*['\"]([^'\"\n]+\.(?:stl|csv|h5|vtkhdf|txt))['\"]", re.IGNORECASE)
SECONDS = re.compile(r"^time +about ([\d.]+) (ms|s|min|h) of one core", re.MULTILINE)
PARTICLES = re.compile(r"^solids +(\d+) particles", re.MULTILINE)
FACTOR = {"ms": 1e-3, "s": 1.0, "min": 60.0, "h": 3600.0}
SMALL = 10.0  # core-seconds: a shorter run is for a core, not for a GPU


def find_program(given: str | Path | None = None) -> Path:
    """The program: what is named, $BRISANCE, bin/brisance of this tree, or that on the path."""
    home = Path(__file__).resolve().parents[1]
    names = [given, os.environ.get("BRISANCE"), home / "bin" / "brisance", shutil.which("brisance")]
    for name in names:
        if name and Path(name).is_file():
            return Path(name).resolve()
        if name and name == given:
            break
    raise PostError(
        f"{given or 'brisance'}: there is no such program; build it (make), or name it by "
        "--brisance FILE or the variable BRISANCE",
        USAGE,
    )


@dataclass(frozen=True)
class Program:
    """The program that computes, and who it is."""

    path: Path

    @cached_property
    def stamp(self) -> str:
        """Version, commit, compiler and precision; of an uncommitted build its bytes as well."""
        done = subprocess.run([self.path, "--version"], capture_output=True, text=True, check=False)
        text = done.stdout.strip()
        if done.returncode or not text:
            raise PostError(f"{self.path}: does not tell its version", USAGE)
        if "dirty" in text or "(none" in text:
            text += "\n" + hashlib.sha256(self.path.read_bytes()).hexdigest()
        return text

    @property
    def name(self) -> str:
        """First line of the stamp: 'Brisance 0.1.0 (edda9c12f8eb)'."""
        return self.stamp.splitlines()[0]


@dataclass(frozen=True)
class Job:
    """One run that is wanted: a deck as text, where its files lie, and `--set` overrides."""

    text: str
    home: Path  # folder of the deck
    sets: tuple[str, ...] = ()
    begin: Job | None = None  # a run that ends with a checkpoint off which this one branches

    def options(self) -> list[str]:
        """The overrides as arguments."""
        return [part for one in self.sets for part in ("--set", one)]


@dataclass
class Outcome:
    """What a run has given; rows of a table are made of it."""

    key: str
    state: str  # 'done', 'refused', 'failed', 'stopped'
    code: int = 0
    seconds: float = 0.0  # of one core
    device: str = "cpu"
    message: str = ""
    values: dict[str, float] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)
    remarks: dict[str, str] = field(default_factory=dict)
    known: bool = False  # it was in the store

    @property
    def done(self) -> bool:
        """Whether there are results."""
        return self.state == "done"


@dataclass(frozen=True)
class Check:
    """What `--check` says of a job."""

    key: str
    echo: str
    seconds: float  # of one core, as the program guesses
    code: int
    message: str
    particles: int = 0  # of the bodies; 0 where it is not told


def key_of(echo: str, stamp: str, files: list[Path]) -> str:
    """Sixteen letters that stand for what a run computes and by what."""
    digest = hashlib.sha256(f"{MEASURED}\n{stamp}\n{meaning_of(echo)}".encode())
    for path in files:
        digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()[:16]


def meaning_of(echo: str) -> str:
    """A complete deck without what does not change the results: output, title, backend, marks."""
    kept, group = [], ""
    for line in echo.splitlines():
        text = line.split(" ! ")[0].strip()
        if text.startswith("&"):
            group = text.lower().split()[0]
        key = text.split("=")[0].strip().lower()
        if group and group not in NOT_MEANING and not (group == "&run" and key in NOT_KEYS):
            kept.append(text)
        if text == "/":
            group = ""
    return "\n".join(kept)


class Store:
    """Runs in a folder, each known by its key; several studies may share it."""

    def __init__(self, folder: Path, program: Program, keep: bool = False):
        self.folder, self.program, self.keep = folder, program, keep
        (folder / "runs").mkdir(parents=True, exist_ok=True)
        self.index = folder / "index.json"  # text of a job: its check, so that it is asked once
        self._lock = threading.Lock()
        self._checks: dict[str, dict] = {}
        if self.index.is_file():
            try:
                self._checks = json.loads(self.index.read_text())
            except ValueError:
                self._checks = {}  # cut off by a full disk: asked again

    def check(self, job: Job) -> Check:
        """Ask the program what a job means and costs; from the index where it was asked before."""
        if job.begin is not None:
            own, first = self.check(replace(job, begin=None)), self.check(job.begin)
            name = hashlib.sha256(f"{own.key} off {first.key}".encode()).hexdigest()[:16]
            return replace(own, key=name)
        files = _files_of(job)
        told = [self.program.stamp, job.text, *job.sets]
        told += [hashlib.sha256(path.read_bytes()).hexdigest() for path in files]
        name = hashlib.sha256("\0".join(told).encode()).hexdigest()[:24]
        if name in self._checks:
            return Check(**self._checks[name])
        with tempfile.TemporaryDirectory(dir=self.folder, prefix="check_") as place:
            deck = _write_deck(Path(place), job, files)
            echo = Path(place) / "complete.nml"
            command = [self.program.path, "run", deck.name, "--check", "--echo", echo.name]
            done = subprocess.run(
                [*command, *job.options()],
                cwd=place,
                env=os.environ | {"OMP_NUM_THREADS": "1"},
                capture_output=True,
                text=True,
                check=False,
            )
            text = echo.read_text() if echo.is_file() else ""
        if not text and "unknown option '--echo'" in done.stderr:
            raise PostError(f"{self.program.path}: is too old: it has no --check --echo", USAGE)
        found = SECONDS.search(done.stdout)
        cost = float(found[1]) * FACTOR[found[2]] if found else math.nan
        message = done.stderr.strip() if done.returncode else ""
        key = key_of(text, self.program.stamp, files) if text else name[:16]
        solids = PARTICLES.search(done.stdout)
        count = int(solids[1]) if solids else 0
        one = Check(key, text, cost, done.returncode, message, count)
        with self._lock:
            self._checks[name] = one.__dict__
            _write(self.index, json.dumps(self._checks))
        return one

    def place(self, key: str) -> Path:
        """Folder of a run."""
        return self.folder / "runs" / key

    def checkpoint(self, key: str) -> Path | None:
        """The last checkpoint in the folder of a run."""
        found = sorted((self.place(key) / "out").glob("chk_*[0-9].h5"))
        found = [path for path in found if ".part" not in path.name]
        return found[-1].resolve() if found else None

    def known(self, key: str) -> Outcome | None:
        """The outcome of a run that is complete, or None."""
        path = self.place(key) / "result.json"
        try:
            found = json.loads(path.read_text())
        except (OSError, ValueError):
            return None
        found["values"] = {k: math.nan if v is None else v for k, v in found["values"].items()}
        return Outcome(**found | {"known": True})

    def forget(self, key: str) -> None:
        """Let a run that failed be run again."""
        (self.place(key) / "result.json").unlink(missing_ok=True)

    @contextmanager
    def claim(self, key: str) -> Iterator[int]:
        """Hold the lock of a run; it lives on in the program that is started under it."""
        self.place(key).mkdir(parents=True, exist_ok=True)
        with (self.place(key) / ".study.lock").open("w") as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            os.set_inheritable(file.fileno(), True)
            yield file.fileno()

    def save(self, outcome: Outcome) -> None:
        """Write the outcome of a run: complete or not there."""
        found = outcome.__dict__ | {"known": False}
        found["values"] = {k: v if math.isfinite(v) else None for k, v in outcome.values.items()}
        _write(self.place(outcome.key) / "result.json", json.dumps(found, indent=1))


def _write(path: Path, text: str) -> None:
    """Write a file under another name first; OSError is left to the caller."""
    draft = path.with_name(f".{path.name}.{os.getpid()}.{threading.get_ident()}")
    draft.write_text(text)
    draft.replace(path)


def _files_of(job: Job) -> list[Path]:
    """Files that a deck and its overrides name and that lie beside it or at full paths."""
    names = FILES.findall("\n".join([job.text, *job.sets]))
    found = [job.home / name for name in dict.fromkeys(names)]
    return [path for path in found if path.is_file()]


def _write_deck(place: Path, job: Job, files: list[Path]) -> Path:
    """The deck in a folder, with links to the files that it names beside it."""
    place.mkdir(parents=True, exist_ok=True)
    for path in files:
        if path.is_relative_to(job.home):
            link = place / path.relative_to(job.home)
            link.parent.mkdir(parents=True, exist_ok=True)
            with suppress(FileExistsError):  # another run may have made it meanwhile
                link.symlink_to(path.resolve())
    deck = place / "deck.nml"
    deck.write_text(job.text)
    return deck


@dataclass(frozen=True)
class Slot:
    """Room for one run at a time: some threads of the CPU, or a share of one GPU."""

    threads: int = 1
    gpu: int | None = None


class Runner:
    """Runs jobs in slots. `stop()` ends those that go on, each with a checkpoint."""

    def __init__(self, store: Store, time_limit: float = math.inf, retry_failed: bool = False):
        self.store, self.retry_failed = store, retry_failed
        self.processes = Processes(time_limit)
        self.stopping = self.processes.stopping
        self.shared: dict[str, Outcome] = {}  # beginnings off which runs have branched
        self._tried: set[str] = set()

    def stop(self) -> None:
        """Ask all runs to write a checkpoint and end, and start no more."""
        self.processes.stop()

    def run(self, job: Job, slot: Slot) -> Outcome:
        """The outcome of a job, from the store where it is known."""
        check = self.store.check(job)
        if check.code:
            return Outcome(check.key, "refused", check.code, message=check.message)
        known = self._known(check.key)
        if known is not None:
            return known
        if self.stopping.is_set():
            return Outcome(check.key, "stopped", STOPPED)
        if job.begin is not None:
            first = self._begin(job.begin, slot)
            if not first.done:
                return replace(first, key=check.key, known=False)
        with self.store.claim(check.key) as lock:
            known = self._known(check.key)  # another study may have had it meanwhile
            return known or self._compute(job, check, slot, lock)

    def run_all(self, jobs: list[Job], slot: Slot) -> list[Outcome]:
        """Outcomes of jobs: several that nobody knows go in one run where they can."""
        checks = [self.store.check(job) for job in jobs]
        fresh = {c.key: (job, c) for job, c in zip(jobs, checks, strict=True)
                 if not c.code and job.begin is None and self._known(c.key) is None}  # fmt: skip
        found: dict[str, Outcome] = {}
        if len(fresh) > 1 and not self.stopping.is_set():
            with suppress(NotPackable):  # they run one by one
                packed = pack([check.echo for _, check in fresh.values()])
                found = self._compute_pack(packed, list(fresh.values()), slot)
        return [found.pop(check.key, None) or self.run(job, slot)
                for job, check in zip(jobs, checks, strict=True)]  # fmt: skip

    def _compute_pack(
        self, packed: Pack, members: list[tuple[Job, Check]], slot: Slot
    ) -> dict[str, Outcome]:
        """Outcomes of members by their keys; none where the run fails: one of them may be why."""
        keys = "".join(check.key for _, check in members)
        key = "pack_" + hashlib.sha256(keys.encode()).hexdigest()[:16]
        files = [path for job, _ in members for path in _files_of(job)]
        with self.store.claim(key) as lock:
            place = self.store.place(key)
            _write_deck(place, Job(packed.text, members[0][0].home), files)
            command = [str(self.store.program.path), "run", "deck.nml", "--out", "out", "--replace"]
            start = time.monotonic()
            code, spent = self._start(command, place, slot, lock)
            seconds = spent if slot.gpu is None else time.monotonic() - start
            if code == STOPPED or (self.stopping.is_set() and code == UNHEARD):
                return {c.key: Outcome(c.key, "stopped", STOPPED) for _, c in members}
            if code:
                return {}
            folders = [self.store.place(check.key) / "out" for _, check in members]
            share_out(place / "out", packed, folders)
            shutil.rmtree(place, ignore_errors=True)
        device = f"{_name(slot)}, {packed.members} at once"
        found = {}
        for (_, check), folder in zip(members, folders, strict=True):
            (folder / "deck.echo.nml").write_text(check.echo)
            outcome = Outcome(check.key, "done", 0, seconds / packed.members, device)
            self._measure(folder, outcome)
            self.store.save(outcome)
            found[check.key] = outcome
        return found

    def _begin(self, job: Job, slot: Slot) -> Outcome:
        """The beginning that runs share; it keeps its checkpoint."""
        key = self.store.check(job).key
        with self.store.claim(key) as lock:
            found = self._known(key)
            if found is None or (found.done and not self.store.checkpoint(key)):
                check = self.store.check(job)
                if check.code:
                    return Outcome(key, "refused", check.code, message=check.message)
                found = self._compute(job, check, slot, lock, keep=("chk_*.h5",))
        self.shared[key] = found
        return found

    def _known(self, key: str) -> Outcome | None:
        found = self.store.known(key)
        if found is not None and not found.done and self.retry_failed and key not in self._tried:
            self.store.forget(key)
            self._tried.add(key)
            return None
        return found

    def _compute(
        self, job: Job, check: Check, slot: Slot, lock: int, keep: tuple[str, ...] = ()
    ) -> Outcome:
        place = self.store.place(check.key)
        deck = _write_deck(place, job, _files_of(job))
        (place / "complete.nml").write_text(check.echo)
        out = place / "out"
        going_on = any(out.glob("chk_*.h5"))
        command = [str(self.store.program.path), "run", deck.name, "--out", "out", *job.options()]
        if going_on:
            command += ["--restart", "latest"]
        elif job.begin is None:
            command += ["--replace"]
        else:
            shutil.rmtree(out, ignore_errors=True)
            first = self.store.checkpoint(self.store.check(job.begin).key)
            command += ["--branch", str(first)]
        start = time.monotonic()
        code, spent = self._start(command, place, slot, lock)
        seconds = spent if slot.gpu is None else time.monotonic() - start
        outcome = Outcome(check.key, "done", code, seconds, _name(slot))
        if code == STOPPED or (self.stopping.is_set() and code == UNHEARD):
            outcome.state, outcome.code = "stopped", STOPPED
            return outcome  # no result: the same command goes on
        if code:
            outcome.state, outcome.message = "failed", _last_words(place / "log.txt", code)
        else:
            self._measure(out, outcome)
        self.store.save(outcome)
        self._clear(out, keep)
        return outcome

    def _start(self, command: list[str], place: Path, slot: Slot, lock: int) -> tuple[int, float]:
        """Run a command of the program in a slot: exit code and core-seconds."""
        command = [*command, "--backend", "cpu" if slot.gpu is None else "gpu"]
        environment = os.environ | {"OMP_NUM_THREADS": str(slot.threads)}
        if slot.gpu is not None:
            environment["CUDA_VISIBLE_DEVICES"] = str(slot.gpu)
        with (place / "log.txt").open("a") as log:
            return self.processes.run(command, log, place, environment, (lock,))

    def _measure(self, out: Path, outcome: Outcome) -> None:
        """Results of a run that has ended well."""
        try:
            run = Run(out)
            for one in results(run):
                outcome.values[one.name] = float(one.value)
                outcome.units[one.name] = one.unit
                outcome.remarks[one.name] = one.remark
        except PostError as error:
            outcome.state, outcome.message = "failed", str(error)

    def _clear(self, out: Path, keep: tuple[str, ...]) -> None:
        """Keep histories and the echo alone and what is named, unless all is to be kept."""
        for path in [] if self.store.keep else sorted(out.glob("*")):
            named = any(path.match(pattern) for pattern in keep)
            if path.suffix in (".vtkhdf", ".h5", ".series") and not named:
                path.unlink()


def _name(slot: Slot) -> str:
    """'cpu' or 'gpu 0'."""
    return "cpu" if slot.gpu is None else f"gpu {slot.gpu}"


def _last_words(log: Path, code: int) -> str:
    """What a run that failed has said last."""
    if code == TOO_LONG:
        return "took longer than the time limit"
    lines = [line for line in log.read_text(errors="replace").splitlines() if line.strip()]
    return lines[-1].strip() if lines else f"ended with code {code}"
