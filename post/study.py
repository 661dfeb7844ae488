# SPDX-License-Identifier: MIT
"""Studies: a scene run many times, and what comes of it. `python -m post study STUDY.toml`."""

from __future__ import annotations

import math
import os
import queue
import signal
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from post.errors import USAGE, PostError
from post.limits import Found, Search, bracketing, guess_between, meeting, together, waves
from post.runner import SMALL, STOPPED, Job, Outcome, Program, Runner, Slot, Store, find_program
from post.study_file import Limit, Study, read_study
from post.study_histories import write_histories
from post.study_table import columns_of, write_csv, write_manifest, write_parquet

if TYPE_CHECKING:
    from post.study_certificate import Centre

TOO_MANY = 0.2  # share of failures from which a study ends
LEAST_FAILED = 5  # but not before so many have failed
# particles of a run on a GPU up to which more of them should cost next to nothing: four slabs of
# 10,900, as 64 of them go four times as fast as one alone (docs/evidence/performance.md)
FULL = 40_000
MOST_AT_ONCE = 7  # points that split a bracket
BESIDE = 3  # points of a secant: its end, and one to each side


@dataclass
class Options:
    """What the command line adds to a study file."""

    out: Path | None = None
    jobs: int | None = None
    gpus: str = ""  # 'all', '0,1' or ''
    check: bool = False
    list_only: bool = False
    stop_after: float = math.inf  # [s]
    retry_failed: bool = False
    keep: bool = False
    program: str | None = None


@dataclass
class Results:
    """What a study has found."""

    points: list[dict] = field(default_factory=list)
    outcomes: list[Outcome] = field(default_factory=list)
    limits: list[tuple[dict, Found]] = field(default_factory=list)  # point, limit there
    stopped: bool = False
    given_up: bool = False  # too many runs have failed
    centre: Centre | None = None  # its certificate


class Pool:
    """Workers, one a slot, that take jobs; the longest first, short ones never on a GPU."""

    def __init__(self, runner: Runner, slots: list[Slot]):
        self.runner = runner
        self._short: queue.PriorityQueue = queue.PriorityQueue()
        gpus = [slot for slot in slots if slot.gpu is not None]
        self.gpus, self.cores = len(gpus), len(slots) - len(gpus)
        cores = [slot for slot in slots if slot.gpu is None]
        self._long = queue.PriorityQueue() if gpus and cores else self._short
        self._count = 0
        self._lock = threading.Lock()
        for slot in slots:
            line = self._short if slot.gpu is None else self._long
            threading.Thread(target=self._work, args=(slot, line), daemon=True).start()

    def submit(self, job: Job, cost: float = 0.0) -> Future:
        """An outcome to come; `cost` in core-seconds."""
        return self._put(lambda slot: self.runner.run(job, slot), cost)

    def submit_all(self, jobs: list[Job], pack: int = 1) -> list[Future]:
        """Lists of outcomes to come that hold those of all jobs in their order: of one run each
        where up to `pack` jobs go together on a GPU, spread over all GPUs. What is short goes to
        cores, each job alone.
        """
        costs = [self.runner.store.check(job).seconds for job in jobs]
        short = self.cores and not sum(costs) > SMALL
        size = 1 if short or not self.gpus else min(pack, -(-len(jobs) // self.gpus))
        return [self._put(partial(self.runner.run_all, jobs[k : k + size]),
                          sum(costs[k : k + size]))
                for k in range(0, len(jobs), size)]  # fmt: skip

    def _put(self, work: Callable[[Slot], object], cost: float) -> Future:
        future: Future = Future()
        line = self._long if cost > SMALL else self._short
        with self._lock:
            self._count += 1
            line.put((-cost if math.isfinite(cost) else 0.0, self._count, work, future))
        return future

    def _work(self, slot: Slot, line: queue.PriorityQueue) -> None:
        while True:
            _, _, work, future = line.get()
            try:
                future.set_result(work(slot))
            except BaseException as error:  # goes to who waits for it
                future.set_exception(error)


class Progress:
    """Lines that say how far a study is: one that is written over on a terminal."""

    def __init__(self, title: str, stream: TextIO | None = None):
        self.title, self.begun = title, time.monotonic()
        self.stream = stream or sys.stderr
        self.total = self.done = self.known = 0
        self.failed: Counter[str] = Counter()
        self._told = 0.0
        self._lock = threading.Lock()

    def add(self, *outcomes: Outcome) -> None:
        """Count runs that have ended."""
        with self._lock:
            self.done += len(outcomes)
            self.known += sum(one.known for one in outcomes)
            for one in outcomes:
                if one.state in ("failed", "refused"):
                    self.failed[one.message.splitlines()[0] if one.message else "?"] += 1
            now = time.monotonic()
            if self.stream.isatty():
                print(f"\r{self.line()}\x1b[K", end="", file=self.stream, flush=True)
            elif now - self._told > 5 or self.done == self.total:
                print(self.line(), file=self.stream, flush=True)
                self._told = now

    def line(self) -> str:
        """'study pi: 37 of 64 done, 11 known, 2 failed; 380 s of about 660 s'."""
        spent = time.monotonic() - self.begun
        of = f" of {self.total}" if self.total else ""
        text = f"study {self.title}: {self.done}{of} done, {self.known} known"
        if self.failed:
            text += f", {sum(self.failed.values())} failed"
        fresh = self.done - self.known
        left = (self.total - self.done) * spent / fresh if fresh and self.total else 0.0
        return text + (f"; {spent:.0f} s of about {spent + left:.0f} s" if left else "")

    def end(self) -> None:
        """Leave the line that is written over."""
        if self.stream.isatty() and self.done:
            print(file=self.stream)


def make_study(path: str | Path, options: Options) -> tuple[Results, int]:
    """Run a study and write its table, pictures and page; the exit code.

    0: all is there; 2: a point is refused by the program; 3: runs have failed; 75: stopped, goes on
    by the same command. PostError for a study file that is wrong.
    """
    study = read_study(path)
    program = Program(find_program(options.program))
    out = options.out or Path("out") / "study" / study.path.stem
    store = Store(out, program, options.keep)
    limit_s = float(study.slots.get("time_limit", math.inf))
    runner = Runner(store, limit_s, options.retry_failed)
    slots = slots_of(study, options)
    for note in study.design.notes:
        print(f"note: {note}", file=sys.stderr)
    code = _look_ahead(study, store, len(slots), options)
    if options.check or options.list_only or code:
        return Results(), code
    progress = Progress(study.title)
    with stopped_by_signals(runner, options.stop_after):
        found = _run(study, runner, slots, progress)
    progress.end()
    if study.certify and not found.stopped and not found.given_up:
        jobs = sum(slot.gpu is None for slot in slots)
        middle = _middle(study, found)
        found.centre = _certify_centre(study, middle, out, max(jobs, 1), program.path)
        found.stopped = found.centre.stopped
    return _write(study, out, runner, found)


def _middle(study: Study, found: Results) -> dict:
    """The point of the certificate: the middle of the ranges, with the limit found there."""
    middle = study.centre
    near = [(point, one.value) for point, one in found.limits if math.isfinite(one.value)]
    if study.limit is not None and near:
        point, value = near[len(near) // 2]
        middle = middle | point | {study.limit.unknown.name: value}
    return middle


def _certify_centre(*args) -> Centre:
    from post.study_certificate import certify_centre  # noqa: PLC0415 (certify uses this module)

    return certify_centre(*args)


def _write(study: Study, out: Path, runner: Runner, found: Results) -> tuple[Results, int]:
    """Tables, page, and the exit code."""
    from post.study_page import make_study_page  # noqa: PLC0415 (draws: slow to load)

    columns = columns_of(study, found.points, found.outcomes)
    if found.centre is not None:
        columns += found.centre.columns(study, found.outcomes)
    about = {
        "program": runner.store.program.stamp,
        "study_file": study.path.read_text(encoding="utf-8"),
    }
    write_csv(out / "study.csv", columns)
    write_parquet(out / "study.parquet", columns, about)
    write_histories(out / "histories.h5", runner.store, found.outcomes)
    page, text = make_study_page(study, out, found)
    write_manifest(out, study, columns, about)
    print(text)
    spent = sum(one.seconds for one in found.outcomes if not one.known)
    known = sum(one.known for one in found.outcomes)
    print(f"{len(found.outcomes)} runs, {known} known before, {spent:.1f} core-s; {page}")
    if runner.shared:
        begun = sum(one.seconds for one in runner.shared.values())
        print(f"beginnings that runs share: {len(runner.shared)}, {begun:.1f} core-s")
    if found.stopped:
        print("stopped; the same command goes on", file=sys.stderr)
        return found, STOPPED
    bad = [one for one in found.outcomes if one.state in ("failed", "refused")]
    if found.given_up:
        print("given up: more than a fifth of the runs have failed", file=sys.stderr)
    for one, count in Counter(o.message for o in bad).most_common(3):
        print(f"{count} x {one}", file=sys.stderr)
    return found, 3 if bad else 0


def slots_of(study: Study, options: Options) -> list[Slot]:
    """Room for runs: cores of this machine, and GPUs where they are asked for."""
    threads = int(study.slots.get("threads", 1))
    cores = len(os.sched_getaffinity(0))
    given = options.jobs if options.jobs is not None else study.slots.get("jobs")
    jobs = max(cores // threads, 1) if given is None else int(given)
    named = options.gpus or study.slots.get("gpus", "")
    gpus = _gpus(named) if named else []
    share = int(study.slots.get("share", 1))
    slots = [Slot(threads)] * jobs + [Slot(threads, gpu) for gpu in gpus for _ in range(share)]
    if not slots:
        raise PostError("study: --jobs 0 without --gpus leaves nothing to run on", USAGE)
    return slots


def _gpus(named: str | list | int) -> list[int]:
    """Numbers of the GPUs that are meant by 'all', '0,1' or a list."""
    if isinstance(named, str) and named == "all":
        found = sorted(Path("/dev").glob("nvidia[0-9]*"))
        return [int(path.name.removeprefix("nvidia")) for path in found]
    try:
        parts = named.split(",") if isinstance(named, str) else named
        return [int(part) for part in (parts if isinstance(parts, list) else [parts])]
    except ValueError as error:
        raise PostError(f"--gpus {named}: must be all, or numbers such as 0,1", USAGE) from error


def _look_ahead(study: Study, store: Store, workers: int, options: Options) -> int:
    """Check all points that are known beforehand: how many, their cost; 2 where one is refused."""
    points = study.points()
    limit = study.limit
    if limit is not None and limit.kind != "fragility":
        points = [p | {limit.unknown.name: x} for p in points for x in (limit.low, limit.high)]
    jobs = [study.job(point) for point in points]
    with ThreadPoolExecutor(workers) as pool:
        checks = list(pool.map(store.check, jobs))
    refused = [(k, c) for k, c in enumerate(checks, 1) if c.code]
    for number, check in refused[:3]:
        print(f"{study.path}: point {number} is refused: {check.message}", file=sys.stderr)
    if options.list_only:
        for job, check in zip(jobs, checks, strict=True):
            print(f"{store.program.path} run {study.deck} {' '.join(job.options())} # {check.key}")
        return USAGE if refused else 0
    known = sum(store.known(check.key) is not None for check in checks)
    different = len({check.key for check in checks})
    costs = [check.seconds for check in checks if math.isfinite(check.seconds)]
    cost = f", {min(costs):.3g} to {max(costs):.3g} core-s each" if costs else ""
    kind = "points" if limit is None or limit.kind == "fragility" else "ends of brackets"
    print(f"study {study.title}: {len(points)} {kind}, {different} different runs, "
          f"{known} known{cost}; {workers} at a time")  # fmt: skip
    return USAGE if refused else 0


class stopped_by_signals:  # noqa: N801 (used like a function)
    """INT and TERM, and the end of `--stop-after`, stop a study with checkpoints."""

    def __init__(self, runner: Runner, seconds: float):
        self.runner = runner
        self.timer = threading.Timer(seconds, runner.stop) if math.isfinite(seconds) else None
        self.main = threading.current_thread() is threading.main_thread()

    def __enter__(self):
        if self.timer:
            self.timer.daemon = True
            self.timer.start()
        if self.main:
            self.before = {s: signal.signal(s, self._stop) for s in (signal.SIGINT, signal.SIGTERM)}

    def _stop(self, number, frame) -> None:
        if self.runner.stopping.is_set():
            raise KeyboardInterrupt
        self.runner.stop()

    def __exit__(self, *_):
        if self.timer:
            self.timer.cancel()
        if self.main:
            for number, handler in self.before.items():
                signal.signal(number, handler)


def _run(study: Study, runner: Runner, slots: list[Slot], progress: Progress) -> Results:
    pool = Pool(runner, slots)
    limit = study.limit
    if limit is None or limit.kind == "fragility":
        return _run_design(study, runner, pool, progress)
    return _run_limits(study, limit, (runner, pool), progress)


def _run_design(study: Study, runner: Runner, pool: Pool, progress: Progress) -> Results:
    """All points of a design; ends early where too many fail."""
    points = study.points()
    progress.total = len(points)
    waiting = pool.submit_all([study.job(point) for point in points], study.pack)
    for future in waiting:
        future.add_done_callback(lambda f: f.exception() or progress.add(*f.result()))
    outcomes, given_up = [], False
    for future in waiting:
        outcomes += future.result()
        bad = sum(one.state == "failed" for one in outcomes)
        if bad >= LEAST_FAILED and bad > TOO_MANY * len(points):
            given_up = True
            runner.stop()
    stopped = runner.stopping.is_set() and not given_up
    return Results(points, outcomes, stopped=stopped, given_up=given_up)


def _run_limits(study: Study, limit: Limit, rooms: tuple, progress: Progress) -> Results:
    """One limit at each point of the design, side by side where guesses allow it: each by itself,
    or all in step, what they ask for at the same time being packed.
    """
    runner, pool = rooms
    points, found = study.points(), Results()
    limits: dict[int, Found] = {}
    asked: dict[int, list[tuple[dict, Outcome]]] = {k: [] for k in range(len(points))}
    packed = study.pack > 1 and pool.gpus > 0
    measure = event_of if limit.event else response_of

    def answers(pairs: list[tuple[int, float]]) -> list:
        """What points say, given as (number of a limit, unknown)."""
        wanted = [points[k] | {limit.unknown.name: x} for k, x in pairs]
        jobs = [study.job(point) for point in wanted]
        futures = pool.submit_all(jobs, study.pack if packed else 1)
        outcomes = [one for future in futures for one in future.result()]
        progress.add(*outcomes)
        for (k, _), point, one in zip(pairs, wanted, outcomes, strict=True):
            asked[k].append((point, one))
        return [measure(limit, one) for one in outcomes]

    along = "" if limit.event else _along(study)  # an event needs no guess
    middle = math.sqrt(limit.low * limit.high)
    order = waves(len(points), packed) if along else [list(range(len(points)))]
    with ThreadPoolExecutor(max(len(points), 1)) as threads:
        for wave in order:
            known = [(float(points[k][along]), one.value) for k, one in limits.items()
                     if along and math.isfinite(one.value)]  # fmt: skip
            at_once = _at_once(study, runner.store, [points[k] for k in wave]) if packed else 0
            searches = {k: _search(limit, guess_between(float(points[k][along]), known, middle)
                                   if along else middle, at_once) for k in wave}  # fmt: skip
            if packed:
                limits |= together(searches, answers)
            else:
                alone = [{k: search} for k, search in searches.items()]
                for one in threads.map(lambda search: together(search, answers), alone):
                    limits |= one
    for k in range(len(points)):
        found.limits.append((points[k], limits[k]))
        found.points += [point for point, _ in asked[k]]
        found.outcomes += [one for _, one in asked[k]]
    found.stopped = runner.stopping.is_set()
    return found


def _search(limit: Limit, guess: float, at_once: int) -> Search:
    """The search for one limit, by so many points at a time; 0: one after the other."""
    if limit.event:
        return bracketing(limit.low, limit.high, limit.tolerance, limit.rising, at_once)
    some = min(at_once, BESIDE)
    return meeting(abs(limit.target), guess, limit.tolerance, limit.rising, some)


def _at_once(study: Study, store: Store, points: list[dict]) -> int:
    """How many points of each of some limits are asked for at once: as many as a GPU takes beside
    each other for next to nothing, at least one.
    """
    limit = study.limit
    jobs = [study.job(point | {limit.unknown.name: limit.low}) for point in points]
    particles = sum(store.check(job).particles for job in jobs)
    room = FULL // particles if particles else 1
    return min(max(room, 1), MOST_AT_ONCE, max(study.pack // len(points), 1))


def _along(study: Study) -> str:
    """The parameter along which limits make a curve: the only one with several values."""
    several = [one.name for one in study.parameters if len(one.values) > 1]
    several = [study.limit.along] if study.limit.along else several
    one = next((p for p in study.parameters if several == [p.name]), None)
    positive = one is not None and all(isinstance(v, float) and v > 0 for v in one.values)
    return several[0] if positive else ""


def response_of(limit: Limit, outcome: Outcome) -> float:
    """Size of the result of a limit; not a number where the run has none."""
    if outcome.done and limit.result not in outcome.values:
        known = ", ".join(outcome.values) or "none"
        raise PostError(f"there is no result '{limit.result}'; this deck gives {known}", USAGE)
    return abs(outcome.values.get(limit.result, math.nan))


def event_of(limit: Limit, outcome: Outcome) -> bool | None:
    """Whether the event of a limit has happened; None where the run has failed, or where a shot
    has ended before the projectile was through or had stopped.
    """
    sign = ">" if ">" in limit.event else "<"
    name, number = (part.strip() for part in limit.event.split(sign))
    now = f"{name.split(' ', 1)[0]} velocity_now"
    open_ = name.endswith("residual_velocity") and outcome.remarks.get(now) == "not finished"
    if not outcome.done or open_:
        return None
    value = outcome.values.get(name, math.nan)
    return value > float(number) if sign == ">" else value < float(number)
