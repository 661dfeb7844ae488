#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""How often the intervals of `certify` hold the truth: ladders of small scenes.

usage: corpus.py [SCENE...] [--jobs N] [--judge] [--brisance FILE]

Runs the ladders of studies/corpus/corpus.toml (all, or those named), keeps them in out/corpus,
writes docs/data/certify_ladder.csv (every result of every level) and docs/data/certify.csv (share
held, widths), and prints the table of docs/manual/certify.md. `--judge` runs nothing. The finest
level is the truth; every triple below it that is 1.45 times coarser or more is judged. Every scene
has the same weight. Factors that hold 90 % are found from all scenes but one and judged on that.
"""

import argparse
import csv
import sys
import tomllib
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from post.certify import natural_scale  # noqa: E402
from post.convergence import FACTORS, FLOOR, ZERO, first_order_rest, interval, look_of  # noqa: E402
from post.expressions import evaluate  # noqa: E402
from post.runner import Job, Outcome, Program, Runner, Slot, Store, find_program  # noqa: E402
from post.study import Pool  # noqa: E402
from post.study_file import PLACE  # noqa: E402

CORPUS = ROOT / "studies" / "corpus"
LADDER = ROOT / "docs" / "data" / "certify_ladder.csv"
TABLE = ROOT / "docs" / "data" / "certify.csv"
HEADS = ("scene", "n", "result", "unit", "value", "core_seconds")
LEAST_TRUTH = 1.45  # ratio of the spacings of the user and of the truth
SHARE = 0.9  # of the promised results that shall hold the truth


@dataclass(frozen=True)
class Case:
    """One result of three levels, and what the finest level of the ladder has."""

    scene: str
    numbers: tuple[int, int, int]
    result: str
    values: tuple[float, float, float]
    truth: float
    scale: float

    @property
    def h(self):
        """Spacings, finest first."""
        return [1 / n for n in self.numbers]

    @property
    def look(self):
        """What the three look like."""
        return look_of(self.h, self.values, 2 * FLOOR * self.scale)

    def half(self, factors=FACTORS):
        """Half width with factors by look."""
        wide = factors[self.look] * first_order_rest(self.h, self.values)
        return max(wide, FLOOR * self.scale)

    @property
    def error(self):
        """Distance of the user's value from the truth."""
        return abs(self.values[0] - self.truth)


def job_of(scene, n):
    """One level of a ladder."""
    text = (CORPUS / f"{scene}.nml").read_text(encoding="utf-8")

    def fill(match):
        value = evaluate(match[1], {"n": float(n)}, scene)
        return repr(value) if value != int(value) else str(int(value))

    return Job(PLACE.sub(fill, text), CORPUS)


def run_ladders(names, options):
    """Run what is missing; rows of the ladder file, those of other scenes as they stand."""
    ladders = tomllib.loads((CORPUS / "corpus.toml").read_text(encoding="utf-8"))
    unknown = set(names) - set(ladders)
    if unknown:
        sys.exit(f"corpus.py: no scene {', '.join(unknown)}; there are {', '.join(ladders)}")
    program = Program(find_program(options.brisance))
    pool = Pool(Runner(Store(ROOT / "out" / "corpus", program)), [Slot()] * options.jobs)
    wanted = [(s, n) for s in (names or ladders) for n in ladders[s]]
    waiting = [(s, n, pool.submit(job_of(s, n), float(n))) for s, n in wanted]
    rows = [row for row in read_ladder() if row[0] not in {s for s, _ in wanted}]
    for scene, n, future in waiting:
        one = future.result()
        print(f"{scene} {n}: {one.state} {one.seconds:.2f} core-s {one.message}", flush=True)
        rows += [(scene, n, name, one.units[name], value, round(one.seconds, 3))
                 for name, value in one.values.items() if np.isfinite(value)]  # fmt: skip
    rows.sort(key=lambda row: (row[0], -int(row[1]), row[2]))
    with LADDER.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(HEADS)
        writer.writerows((*row[:4], f"{row[4]:.10g}", row[5]) for row in rows)


def read_ladder():
    """Rows of the ladder file, none where it is not there."""
    if not LADDER.is_file():
        return []
    with LADDER.open(encoding="utf-8") as file:
        return [(r["scene"], int(r["n"]), r["result"], r["unit"], float(r["value"]),
                 float(r["core_seconds"])) for r in csv.DictReader(file)]  # fmt: skip


def cases_of(rows):
    """Every result of every triple of neighbouring levels below the truth."""
    levels = defaultdict(dict)
    for scene, n, result, unit, value, seconds in rows:
        one = levels[scene].setdefault(n, Outcome("", "done", seconds=seconds))
        one.values[result], one.units[result] = value, unit
    found = []
    for scene, ladder in levels.items():
        numbers = sorted(ladder, reverse=True)
        users = [k for k in range(1, len(numbers) - 2) if numbers[0] / numbers[k] >= LEAST_TRUTH]
        for k in users:
            triple = tuple(numbers[k : k + 3])
            found += _cases(scene, triple, [ladder[n] for n in (numbers[0], *triple)])
    return found


def _cases(scene, numbers, outcomes):
    truth, user = outcomes[:2]
    for name in user.values:
        if not all(name in one.values for one in outcomes):
            continue
        values = tuple(one.values[name] for one in outcomes[1:])
        scale = natural_scale(user, name)
        if scale > 0 and max(map(abs, values)) >= ZERO * scale:
            yield Case(scene, numbers, name, values, truth.values[name], scale)


def held(cases, factors=FACTORS):
    """Share that hold the truth, of results and with every scene of the same weight; half widths
    over the natural scale.
    """
    by = defaultdict(list)
    for case in cases:
        by[case.scene].append(case.error <= case.half(factors))
    every = np.concatenate([np.array(v) for v in by.values()]) if by else np.zeros(0)
    scenes = float(np.mean([np.mean(v) for v in by.values()])) if by else np.nan
    return float(every.mean()), scenes, np.array([c.half(factors) / c.scale for c in cases])


def fit_factors(cases):
    """The smallest factor of each look that holds `SHARE`, every scene of the same weight."""
    found = dict(FACTORS)
    for look in FACTORS:
        some = [c for c in cases if c.look == look]
        if not some:
            continue
        count = defaultdict(int)
        for c in some:
            count[c.scene] += 1
        need = sorted(
            (0.0 if c.error <= FLOOR * c.scale
             else c.error / max(first_order_rest(c.h, c.values), 1e-300), 1 / count[c.scene])
            for c in some
        )  # fmt: skip
        weight = np.cumsum([w for _, w in need])
        found[look] = need[int(np.searchsorted(weight / weight[-1], SHARE - 1e-12))][0]
    return found


def one_left_out(cases):
    """Held with factors from the other scenes: of results, by scene, median half width."""
    right, widths = defaultdict(list), []
    for scene in sorted({c.scene for c in cases}):
        factors = fit_factors([c for c in cases if c.scene != scene])
        for c in cases:
            if c.scene == scene:
                right[scene].append(c.error <= c.half(factors))
                widths.append(c.half(factors) / c.scale)
    every = np.concatenate([np.array(v) for v in right.values()])
    by = float(np.mean([np.mean(v) for v in right.values()]))
    return float(every.mean()), by, float(np.median(widths))


def kind_of(result):
    """The kind of a result, for the table."""
    words = ("arrival", "peak_time", "impulse", "duration", "velocity", "displacement")
    words += ("volume", "mass", "angle", "depth", "energy", "kinetic", "internal")
    found = next((w for w in words if w in result), "other")
    same = {"peak_time": "arrival", "kinetic": "energy", "internal": "energy"}
    if "pressure peak" in result:
        return "peak"
    return same.get(found, found)


def judge(rows):
    """The table, as rows; printed as Markdown."""
    cases = cases_of(rows)
    good = [c for c in cases if interval(c.h, c.values, c.scale).promised]
    table = []
    groups = [("all that is promised", good), ("all", cases)]
    groups += [(f"promised, {k}", [c for c in good if kind_of(c.result) == k])
               for k in sorted({kind_of(c.result) for c in good})]  # fmt: skip
    groups += [(f"promised, {look}", [c for c in good if c.look == look]) for look in FACTORS]
    groups += [(f"promised, scene {s}", [c for c in good if c.scene == s])
               for s in sorted({c.scene for c in good})]  # fmt: skip
    for name, some in groups:
        if some:
            every, by, wide = held(some)
            table.append((name, len(some), 100 * every, 100 * by, 100 * float(np.median(wide)),
                          100 * float(np.quantile(wide, 0.8))))  # fmt: skip
    if len({c.scene for c in good}) > 2:
        every, by, wide = one_left_out(good)
        table.append(("promised, factors from the other scenes", len(good), 100 * every, 100 * by,
                      100 * wide, np.nan))  # fmt: skip
    with TABLE.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["group", "results", "held[%]", "held_by_scene[%]", "half_width_median[%]",
                         "half_width_80[%]"])  # fmt: skip
        writer.writerows((name, n, *(f"{v:.1f}" for v in more)) for name, n, *more in table)
    print("| group | results | held | by scene | half width, median | 80 % below |")
    print("|---|---|---|---|---|---|")
    for name, n, *more in table:
        cells = [f"{v:.0f} %" for v in more[:2]]
        cells += [f"{v:.1f} %" if np.isfinite(v) else "–" for v in more[2:]]
        print(f"| {name} | {n} | {' | '.join(cells)} |")
    factors = ", ".join(f"{k} {v:.2f}" for k, v in fit_factors(good).items())
    print(f"\nfactors that hold {100 * SHARE:.0f} %: {factors}; built in: {FACTORS}")


def main():
    """Run and judge."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--judge", action="store_true")
    parser.add_argument("--brisance")
    options = parser.parse_args()
    if not options.judge:
        run_ladders(options.scenes, options)
    judge(read_ladder())


if __name__ == "__main__":
    main()
