# SPDX-License-Identifier: MIT
"""Error bars of a scene by coarser partners: `python -m post certify DECK`."""

from __future__ import annotations

import csv
import json
import math
import sys
from dataclasses import dataclass, field, replace
from pathlib import Path

from post.convergence import ZERO, Interval, interval
from post.deck import Deck
from post.ensemble import Scatter, member_sets, scatter_of
from post.errors import NUMERICAL, USAGE, PostError
from post.partners import BUDGET, Plan, by_spacing, make_plan
from post.reader import Run
from post.results import results
from post.runner import (
    STOPPED,
    Job,
    Outcome,
    Program,
    Runner,
    Slot,
    Store,
    find_program,
    meaning_of,
)
from post.study import Pool, stopped_by_signals

HEADLINES = ("displacement", "impulse", "residual_velocity")  # results that come first
BY_MODEL = ("failed", "tensile", "crushed", "loose", "hole", "crater", "spall", "cracks", "debris")
ENDS = (" end", " permanent_set")  # values that are compared with the peak before them


@dataclass
class Options:
    """What the command line asks for."""

    out: Path | None = None
    sets: tuple[str, ...] = ()
    budget: float = BUDGET
    finer: bool = False
    hold: tuple[str, ...] = ()
    wanted: tuple[str, ...] = ()
    jobs: int = 1
    backend: str = "cpu"
    fine: Path | None = None
    want: float = math.nan  # relative error that is wanted
    check: bool = False
    program: str | None = None
    ensemble: int = 0  # members with each of two spacings
    levels: int = 3  # spacings, the finest included


@dataclass(frozen=True)
class Certified:
    """One result with its interval."""

    name: str
    unit: str
    values: tuple[float, ...]  # finest first
    scale: float  # natural scale
    interval: Interval


@dataclass
class Certificate:
    """All that is known of a scene and its partners."""

    deck: Path
    job: str
    program: str
    plan: Plan
    outcomes: list[Outcome]  # of the levels, finest first
    widths: list[float]  # spacing over the user's
    rows: list[Certified] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    histories: list[Path] = field(default_factory=list)  # folders of results, finest first
    wanted: tuple[str, ...] = ()
    want: float = math.nan
    scatter: dict[str, Scatter] = field(default_factory=dict)
    most: int = 3  # levels of an interval

    @property
    def headline(self) -> Certified | None:
        """The worst promised result of those that were asked for, else of the kinds that come
        first, else of the gauges, of the energies, of all.
        """
        asked = [row for row in self.rows if row.name in self.wanted]
        first = [row for row in self.rows if any(word in row.name for word in HEADLINES)
                 and row.name.endswith((" peak", "impulse", "velocity"))]  # fmt: skip
        gauges = [row for row in self.rows if ":" in row.name]
        energies = [row for row in self.rows if row.name.startswith("energy solid")]
        for some in (asked, first, gauges, energies, self.rows):
            good = [row for row in some if row.interval.promised and row.scale > 0]
            if good:
                return max(good, key=lambda row: row.interval.half / row.scale)
        return None


def certify(path: str | Path, options: Options) -> int:
    """Run what is missing, judge it, write page and tables; the exit code.

    0: all that was asked for is promised; 1: something of `--results` is not; 2: there is no
    partner, or the deck is refused; 3: a partner has failed; 75: stopped, goes on by the same
    command.
    """
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise PostError(f"{path}: cannot be read: {error.strerror}", USAGE) from error
    out = options.out or (options.fine / "certify" if options.fine else None)
    out = out or Path("out") / "certify" / path.stem
    return certify_job(path, Job(text, path.resolve().parent, options.sets), out, options)[0]


def certify_job(
    path: Path, job: Job, out: Path, options: Options
) -> tuple[int, Certificate | None]:
    """The exit code of `certify`, and the certificate where there is one."""
    program = Program(find_program(options.program))
    store = Store(out, program)
    check = store.check(job)
    if check.code:
        raise PostError(f"{path}: is refused: {check.message}", USAGE)
    deck = Deck(check.echo, str(path))
    plan = make_plan(deck, options.budget, options.hold, options.finer, options.levels)
    _say(path, plan)
    if plan.refusal:
        raise PostError(f"{path}: {plan.refusal}", USAGE)
    jobs = [replace(job, sets=(*job.sets, *level.sets)) for level in plan.levels]
    _refuse_what_is_refused(store, plan, jobs)
    if options.check:
        return 0, None
    fine = _given(options.fine, check.echo) if options.fine else None
    runner = Runner(store)
    slot = Slot() if options.backend != "gpu" else Slot(1, 0)
    pool = Pool(runner, [slot] * max(options.jobs, 1))
    with stopped_by_signals(runner, math.inf):
        made = _run(pool, jobs, fine)
        members = _run_ensemble(pool, jobs, options) if options.ensemble else []
    if any(one.state == "stopped" for row in (made, *members) for one in row):
        print("stopped; the same command goes on", file=sys.stderr)
        return STOPPED, None
    reckoned = math.isnan(made[0].seconds)
    if reckoned:
        made[0].seconds = made[1].seconds * plan.cost(plan.levels[0]) / plan.cost(plan.levels[1])
    certificate = judge(path, deck, (plan, made), options)
    if reckoned:
        certificate.notes.append("the seconds of your run are reckoned from those of the partner")
    certificate.program = program.stamp
    places = [store.place(one.key) / "out" for one in made]
    if options.fine:
        places[0] = options.fine
    if options.ensemble:
        _add_ensemble(certificate, *members)
    good = [k for k, one in enumerate(made) if one.done]
    certificate.histories = [places[k] for k in good]
    return _write(certificate, out, options), certificate


def _write(certificate: Certificate, out: Path, options: Options) -> int:
    """Tables and page; the exit code."""
    from post.certify_page import make_certificate_page  # noqa: PLC0415 (draws: slow to load)

    write_tables(certificate, out)
    page, text = make_certificate_page(certificate, out)
    print(text)
    print(f"certificate: {page}")
    if any(not one.done for one in certificate.outcomes):
        return NUMERICAL
    asked = [row for row in certificate.rows if row.name in options.wanted]
    return int(any(not row.interval.promised for row in asked))


def _say(path: Path, plan: Plan) -> None:
    """What will be run."""
    if plan.scarce is not None and plan.levels:
        names = ", ".join(k.name for k in plan.knobs)
        rows = " > ".join("/".join(map(str, level.numbers)) for level in plan.levels)
        print(f"certify {path.stem}: {plan.dimension}-D, {plan.scarce.name} decides")
        print(f"  {names}: {rows}; extra cost about {100 * plan.extra:.0f} %")
    for note in plan.notes:
        print(f"note: {note}", file=sys.stderr)


def _refuse_what_is_refused(store: Store, plan: Plan, jobs: list[Job]) -> None:
    for level, job in zip(plan.levels, jobs, strict=True):
        check = store.check(job)
        if check.code:
            name = "/".join(map(str, level.numbers))
            text = f"the partner {name} is refused: {check.message}"
            if "radius" in check.message and "charge" in check.message:
                text += " (start='1d' of the charge has no such limit)"
            raise PostError(text, USAGE)


def _given(folder: Path, echo: str) -> Outcome:
    """The run that is there, if it is one of this deck."""
    run = Run(folder)
    if meaning_of(run.deck.text) != meaning_of(echo):
        raise PostError(f"{folder}: is a run of another deck than this one", USAGE)
    found = Outcome("fine", "done", known=True)
    for one in results(run):
        found.values[one.name], found.units[one.name] = float(one.value), one.unit
    found.seconds = math.nan  # a run does not keep what it has cost
    return found


def _run(pool: Pool, jobs: list[Job], fine: Outcome | None) -> list[Outcome]:
    """Outcomes of all levels, the coarsest first run, finest first told."""
    waiting = [None if fine and k == 0 else pool.submit(job, float(k))
               for k, job in reversed(list(enumerate(jobs)))]  # fmt: skip
    found = []
    for future in waiting:
        one = fine if future is None else future.result()
        state = "known" if one.known else f"{one.seconds:.2f} core-s"
        print(f"  {one.key}: {one.state}, {state}", file=sys.stderr)
        found.append(one)
    return found[::-1]


def _run_ensemble(pool: Pool, jobs: list[Job], options: Options) -> list[list[Outcome]]:
    """Members with a jitter at the finest spacing and at the next."""
    seeds = range(1, options.ensemble + 1)
    waiting = [[pool.submit(replace(job, sets=(*job.sets, *member_sets(seed))))
                for seed in seeds] for job in jobs[:2]]  # fmt: skip
    return [[future.result() for future in row] for row in waiting]


def _add_ensemble(found: Certificate, fine: list[Outcome], middle: list[Outcome]) -> None:
    """Scatter of what is not promised and of what was asked for."""
    ratio = found.widths[1] / found.widths[0]
    bad = sum(not one.done for one in (*fine, *middle))
    if bad:
        found.notes.append(
            f"{bad} of {len(fine) + len(middle)} members of the ensemble have failed"
        )
    for row in found.rows:
        if row.interval.promised and row.name not in found.wanted:
            continue
        values = [[one.values.get(row.name, math.nan) for one in some] for some in (fine, middle)]
        try:
            found.scatter[row.name] = scatter_of(*values, ratio)
        except ValueError:
            continue  # not in enough members


def judge(path: Path, deck: Deck, made: tuple, options: Options) -> Certificate:
    """Intervals of all results of the levels that have any. PostError below two levels."""
    plan, outcomes = made
    widths = [level.width for level in plan.levels]
    found = Certificate(path, path.stem, "", plan, outcomes, widths, wanted=options.wanted)
    found.want, found.most = options.want, options.levels
    for level, one in zip(plan.levels, outcomes, strict=True):
        if not one.done:
            name = "/".join(map(str, level.numbers))
            found.notes.append(f"the level {name} has no results: {one.message}")
    good = [k for k, one in enumerate(outcomes) if one.done]
    if len(good) < 2:
        raise PostError("; ".join(found.notes), NUMERICAL)
    fine = outcomes[good[0]]
    h = [widths[k] for k in good][: options.levels]
    broken = by_spacing(deck)
    found.notes += [f"'{body}' breaks by its spacing: {why}; what is broken of it is by its model "
                    "not to be had by finer particles" for body, why in broken.items()]  # fmt: skip
    for name, value in fine.values.items():
        values = [outcomes[k].values.get(name, math.nan) for k in good][: options.levels]
        scale = natural_scale(fine, name)
        if not all(map(math.isfinite, values)) or scale <= 0:
            continue
        if max(map(abs, values)) < ZERO * scale:
            one = Interval(value, 0.0, value, math.nan, "nothing", False)
        else:
            one = interval(h, values, scale)
        if _by_model(name, broken):
            one = Interval(one.value, one.half, one.best, one.order, "by its model not", False)
        found.rows.append(Certified(name, fine.units[name], tuple(values), scale, one))
    _check_wanted(found, options.wanted)
    return found


def _check_wanted(found: Certificate, wanted: tuple[str, ...]) -> None:
    known = [row.name for row in found.rows]
    for name in wanted:
        if name not in known:
            text = f"--results: there is no result '{name}'; this deck gives {', '.join(known)}"
            raise PostError(text, USAGE)


def _by_model(name: str, broken: dict[str, str]) -> bool:
    """Whether a result is what a material does by its spacing."""
    if name.startswith("energy damage"):
        return bool(broken)
    owner, _, what = name.partition(" ")
    return owner in broken and (what.startswith(BY_MODEL) or what == "damage_mean")


def natural_scale(outcome: Outcome, name: str) -> float:
    """What an error of a result is compared with: energies and impulses with the largest of the
    run, speeds of bodies with the largest, a value at the end with its peak, else itself.
    """
    unit, values = outcome.units[name], outcome.values
    if unit in ("J", "N s") or (unit == "m/s" and ":" not in name):
        gauge = ":" in name
        alike = [abs(v) for other, v in values.items() if math.isfinite(v)
                 and outcome.units[other] == unit and (":" in other) == gauge]  # fmt: skip
        return max(alike, default=0.0)
    for end in ENDS:
        if name.endswith(end):
            peak = values.get(name.removesuffix(end) + " peak", 0.0)
            return max(abs(values[name]), abs(peak))
    return abs(values[name])


def write_tables(found: Certificate, out: Path) -> None:
    """`certify.csv` and `certify.json`."""
    levels = range(len(found.rows[0].values) if found.rows else 0)
    heads = ["result", "unit", *(f"f{k + 1}" for k in levels), "low", "high", "best", "order"]
    with (out / "certify.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow([*heads, "verdict", "promised"])
        for row in found.rows:
            one = row.interval
            cells = [row.name, row.unit, *row.values, one.low, one.high, one.best, one.order]
            writer.writerow([*cells, one.verdict, "yes" if one.promised else "no"])
    told = {
        "deck": str(found.deck),
        "program": found.program,
        "levels": [
            {"numbers": dict(zip([k.name for k in found.plan.knobs], level.numbers, strict=True)),
             "sets": list(level.sets), "width": level.width, "key": one.key, "state": one.state,
             "seconds": _number(one.seconds)}
            for level, one in zip(found.plan.levels, found.outcomes, strict=True)
        ],
        "notes": found.plan.notes + found.notes,
        "results": {
            row.name: {"value": row.interval.value, "half": row.interval.half, "unit": row.unit,
                       "best": row.interval.best, "verdict": row.interval.verdict,
                       "promised": row.interval.promised}
            for row in found.rows
        },
        "ensemble": {name: one.__dict__ for name, one in found.scatter.items()},
    }  # fmt: skip
    (out / "certify.json").write_text(json.dumps(told, indent=1), encoding="utf-8")


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None
