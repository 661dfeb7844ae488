# SPDX-License-Identifier: MIT
"""Coarser partners of a deck: the same scene with fewer cells and particles, by `--set` alone."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from post.deck import Deck, as_list

BUDGET = 0.25  # extra cost of two partners over the run
NEAR = 0.1  # share by which a number may be moved so that faces fit cells
LOOSE = 0.1  # cells: a face that lies farther from a face of a cell is told
TNT = 1630.0  # density of a charge [kg/m3], to tell its radius
STARTS = {"axial": ("plane_cells", 160, 2)}  # key, default, dimensions of a blast on its own
LEAST_START = 40  # cells of such a blast; the program refuses less


@dataclass(frozen=True)
class Knob:
    """One number of a deck that refines it."""

    name: str  # 'air.cells', 'body(plate).spacing'
    owner: str  # 'air' or the id of a body
    n: int  # cells along the shortest side, layers through the thinnest
    least: int
    text: Callable[[int], str]  # what follows '--set name='

    def sets(self, n: int) -> str:
        """The override for another number."""
        return f"{self.name}={self.text(n)}"


@dataclass(frozen=True)
class Level:
    """One spacing: a number for each knob, and the overrides that make it."""

    numbers: tuple[int, ...]
    sets: tuple[str, ...]
    width: float  # spacing over that of the user's deck


@dataclass
class Plan:
    """What a certificate will run."""

    dimension: int
    knobs: list[Knob]
    levels: list[Level]  # finest first
    scarce: Knob | None  # the knob that decides on the ratios
    notes: list[str] = field(default_factory=list)
    refusal: str = ""  # why there is no partner, and what to do
    extra: float = 0.0  # cost of the partners over that of the user's run, about

    def cost(self, level: Level) -> float:
        """Of a level over the user's run."""
        return level.width ** -(self.dimension + 1)


def ratio_for(dimension: int, budget: float = BUDGET, partners: int = 2) -> float:
    """Ratio of spacings of which the partners cost a share `budget` of the run.

    Cost goes with h^-(d+1): x + x^2 = budget, x = r^-(d+1); with three partners x + x^2 + x^3.
    """
    x = math.sqrt(budget + 0.25) - 0.5
    for _ in range(20 if partners > 2 else 0):  # Newton, from above
        x -= (x + x**2 + x**3 - budget) / (1 + 2 * x + 3 * x**2)
    return x ** (-1 / (dimension + 1))


def make_plan(
    deck: Deck,
    budget: float = BUDGET,
    hold: tuple[str, ...] = (),
    finer: bool = False,
    most: int = 3,
) -> Plan:
    """Partners of a complete deck.

    `hold`: bodies that keep their spacing; `finer`: one level finer than the deck comes first;
    `most`: levels, 3 or 4.
    """
    dimension = int(deck.get("run", "dimension", 3))
    geometry = str(deck.get("air", "geometry", "cartesian"))
    if geometry != "cartesian":
        dimension = STARTS.get(geometry, ("", 0, 1))[2]
    elif not deck.groups("body"):
        dimension = max(sum(int(n) > 1 for n in as_list(deck.get("air", "cells"))), 1)
    notes: list[str] = []
    knobs = [*_air_knob(deck, notes), *_body_knobs(deck, notes)]
    held = [k for k in knobs if k.owner in hold]
    knobs = [k for k in knobs if k.owner not in hold]
    notes = [f"'{k.owner}' keeps its spacing: nothing is told of its share" for k in held] + notes
    if not knobs:
        return Plan(dimension, [], [], None, notes, "the deck has nothing that can be refined")
    scarce = min(knobs, key=lambda k: k.n / k.least)
    ratio = ratio_for(dimension, budget, most - 1)
    numbers = _numbers(scarce, ratio, finer, most)
    fixed = fixed_sets(deck)
    levels = []
    for m in numbers:
        row = [max(min(k.least, k.n), round(k.n * m / scarce.n)) for k in knobs]
        if m != scarce.n:
            row = [_aligned(deck, k, n) if k.name == "air.cells" else n
                   for k, n in zip(knobs, row, strict=True)]  # fmt: skip
        row = [m if k is scarce and k.name != "air.cells" else n
               for k, n in zip(knobs, row, strict=True)]  # fmt: skip
        own = m == scarce.n
        sets = () if own else tuple(k.sets(n) for k, n in zip(knobs, row, strict=True))
        real = scarce.n / row[knobs.index(scarce)]
        levels.append(Level(tuple(row), (*sets, *fixed), real))
    plan = Plan(dimension, knobs, levels, scarce, notes)
    _judge(deck, plan, ratio)
    return plan


def _numbers(scarce: Knob, ratio: float, finer: bool, most: int) -> list[int]:
    """Numbers of the knob that decides, finest first: `most` where there is room for them."""
    n, least = scarce.n, scarce.least
    numbers = [max(least, round(n / ratio ** (most - 1)))]
    for k in range(most - 2, 0, -1):
        numbers.append(max(round(n / ratio**k), numbers[-1] + 1))
    numbers = sorted({n, *(m for m in numbers if least <= m < n)}, reverse=True)
    return [_finer(n, ratio), *numbers][:most] if finer else numbers


def _finer(n: int, ratio: float) -> int:
    """The number of the level that `--finer` puts before that of the deck."""
    return max(n + 1, round(ratio * n))


def _judge(deck: Deck, plan: Plan, ratio: float) -> None:
    """Say what is missing, what it costs, and which faces do not fit the cells."""
    scarce, count = plan.scarce, len(plan.levels)
    user = next(level for level in plan.levels if level.width == 1.0)
    plan.extra = sum(plan.cost(level) for level in plan.levels if level is not user)
    what = "layers" if scarce.owner != "air" else "cells"
    if count == 1:
        finer = _finer(scarce.n, ratio)
        cost = (finer / scarce.n) ** (plan.dimension + 1)
        plan.refusal = (
            f"there is no coarser partner: {scarce.name} has {scarce.n} {what}, {scarce.least} are "
            f"the least. Use --finer (a partner of {finer} {what}, {cost:.1f} times the "
            f"cost), or --hold {scarce.owner} (its spacing stays, all else is certified)"
        )
        if scarce.owner not in ("air", ""):
            plan.refusal += "; total_lagrangian with aspect makes more layers cheap"
    elif count == 2:
        plan.notes.append("two levels only: intervals are wide, and none is promised")
    knob = next((k for k in plan.knobs if k.name == "air.cells"), None)
    if knob is not None:
        far, whose = misfit(deck, knob.n)
        if far > LOOSE:
            plan.notes.append(
                f"a face of {whose} lies {far:.2f} cells from a face of a cell: what arrives there "
                "jumps by as much from partner to partner"
            )


def _air_knob(deck: Deck, notes: list[str]) -> list[Knob]:
    if not deck.groups("air"):
        return []
    geometry = str(deck.get("air", "geometry", "cartesian"))
    if geometry != "cartesian":
        key, default, _ = STARTS.get(geometry, ("radial_cells", 240, 1))
        charge = deck.groups("charge")[0]
        n, name = int(charge.get(key) or default), str(charge.get("id"))
        return [Knob(f"charge({name}).{key}", "air", n, LEAST_START, str)]
    cells = [int(n) for n in as_list(deck.get("air", "cells"))]
    live = [d for d in range(3) if cells[d] > 1]
    if not live:
        return []
    n, least = min(cells[d] for d in live), 4
    for charge in deck.groups("charge"):
        if charge.get("start", "3d") != "3d":
            notes.append(
                f"charge '{charge.get('id')}' starts as start='{charge['start']}' in all partners: "
                "the error of that start is in no interval"
            )
            continue
        radius = (3 * float(charge.get("mass") or 0) / (4 * math.pi * TNT)) ** (1 / 3)
        least = max(least, math.ceil(3 * n * float(deck.cell[live].min()) / max(radius, 1e-9)))
        notes.append(
            f"charge '{charge.get('id')}' begins on the grid, and needs three cells in its radius "
            "in each partner: start='1d' does not"
        )

    def text(m: int) -> str:
        return ",".join(str(max(1, round(cells[d] * m / n)) if d in live else 1) for d in range(3))

    return [Knob("air.cells", "air", n, least, text)]


def _body_knobs(deck: Deck, notes: list[str]) -> list[Knob]:
    found = []
    dimension = int(deck.get("run", "dimension", 3))
    for body, group in zip(deck.bodies(), deck.groups("body"), strict=True):
        least = 1 if group.get("formulation") == "rigid" else 3
        aspect = np.array(body.aspect)
        if body.shape == "box":
            layers = ((body.high - body.low) / body.step)[:dimension]
            axis = int(np.argmin(layers))
            thin, width = float((body.high - body.low)[axis]), float(aspect[axis])
        elif body.shape == "bars":
            least, width = min(least, 2), 1.0
            thin = float(group.get("diameter") or 0.0)
        elif body.shape in ("sphere", "cylinder"):
            least, width = max(least, 4) if least > 1 else 1, 1.0
            thin = float(np.min((body.high - body.low)[:dimension]))
        else:
            thin, width = 12 * body.spacing, 1.0
            notes.append(f"body '{body.id}' from a file follows the others; it never decides")
        n = max(round(thin / body.spacing / width), 1)

        def text(m: int, thin=thin, width=width) -> str:
            return repr(thin / m / width)

        found.append(Knob(f"body({body.id}).spacing", body.id, n, min(least, n), text))
    return found


def fixed_sets(deck: Deck) -> tuple[str, ...]:
    """Overrides of what would change its meaning with the spacing: widths in place of layers, and
    histories at every step.
    """
    sets = ["output.history_every=0"]
    for body, group in zip(deck.bodies(), deck.groups("body"), strict=True):
        if group.get("fix") is not None and group.get("fix_width") is None:
            width = float(group.get("fix_layers") or 3) * body.spacing
            sets.append(f"body({body.id}).fix_width={width!r}")
    return tuple(sets)


def misfit(deck: Deck, n: int) -> tuple[float, str]:
    """Largest distance of a face of a box from a face of a cell, in cells, and whose it is.

    `n`: cells along the shortest modelled side. (0, '') without boxes in the air.
    """
    box = np.array(as_list(deck.get("air", "box")), float)
    cells = [int(k) for k in as_list(deck.get("air", "cells"))]
    live = [d for d in range(3) if cells[d] > 1]
    smallest = min(cells[d] for d in live)
    worst = (0.0, "")
    for body in deck.bodies():
        if body.shape != "box":
            continue
        for d in live:
            low, high = box[2 * d], box[2 * d + 1]
            for face in (body.low[d], body.high[d]):
                if low < face < high:
                    place = (face - low) / (high - low) * round(cells[d] * n / smallest)
                    worst = max(worst, (abs(place - round(place)), f"'{body.id}'"))
    return worst


def _aligned(deck: Deck, knob: Knob, n: int) -> int:
    """The number within 10 % of n with which faces of boxes fit the cells best."""
    near = range(max(knob.least, math.ceil((1 - NEAR) * n)), math.floor((1 + NEAR) * n) + 1)
    return min(near, key=lambda k: (round(misfit(deck, k)[0], 2), abs(k - n)), default=n)


def by_spacing(deck: Deck) -> dict[str, str]:
    """Bodies whose material breaks by its spacing and not by an energy, and why."""
    found = {}
    laws = {str(g.get("id")): g for g in deck.groups("material")}
    for body in deck.bodies():
        law = laws.get(body.material, {})
        if law.get("gf") is not None:
            continue
        strain = law.get("failure_strain") is not None or law.get("d1") is not None
        if strain and law.get("failure") != "none":
            found[body.id] = "its particles fail at a strain"
        elif str(law.get("model", "")).startswith("hjc"):
            found[body.id] = "its law has no fracture energy (gf)"
    return found
