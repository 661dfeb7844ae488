# SPDX-License-Identifier: MIT
"""Members of a study as one run: the bodies of many decks side by side, and nothing between them.

A run of ten thousand particles leaves most of a GPU idle; sixty-four of them in one run do not.
Members lie along an axis without a plane of symmetry, as far apart as the widest is long, its way
included, or further; they share the time step, the smallest of all, and go on to the latest end. A
member has its histories up to its own end. What is written for all bodies together, as energies and
dumps, is not that of a member: a study that asks for such results is not packed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from post.deck import AXES, Deck, as_list

# keys that say where something is: a point, or boxes x0, x1, y0, y1, z0, z1
POINTS = {"body": ("centre", "spin_centre"), "load": ("at",), "gauge": ("at", "to")}
BOXES = {
    "body": ("box", "fix_box", "roller_box"),
    "motion": ("box",),
    "interaction": ("open_box",),
}
# keys that name what has an id
NAMES = {
    "body": ("id", "material", "cuts"),
    "material": ("id",),
    "interaction": ("id", "bodies"),
    "load": ("id", "body"),
    "motion": ("id", "body"),
    "gauge": ("id", "body", "with", "motion"),
}
SHARED = ("run", "solid", "output")  # groups that are the same in all members
HELD_ALONE = {"run": ("title", "backend", "t_end")}  # keys of them that may differ
APART = 2.0  # pitch of the members over the length of the longest, with the way that it flies


class NotPackable(Exception):
    """Why members cannot go in one run."""


@dataclass(frozen=True)
class Pack:
    """One run for several members."""

    text: str  # its deck
    members: int
    axis: int  # along which they lie: 0, 1, 2
    pitch: float  # from one to the next [m]
    ends: tuple[float, ...]  # t_end of each member [s]

    def shift(self, k: int) -> float:
        """How far member k, from 0, lies from where its deck has it, along the axis [m]."""
        return (k - (self.members - 1) / 2) * self.pitch


def pack(decks: list[str]) -> Pack:
    """One deck for members given as complete decks (`--check --echo`), in their order.

    NotPackable, with the reason, where they share something that must differ.
    """
    members = [Deck(text) for text in decks]
    first = members[0]
    for deck in members:
        _refuse(deck, first)
    axis, pitch = _axis_of(members)
    ends = tuple(float(deck.get("run", "t_end", 0.0)) for deck in members)
    packed = Pack("", len(members), axis, pitch, ends)
    lines = [f"{len(members)} members of a study side by side along {AXES[axis]}."]
    whole = {"title": "members of a study", "t_end": max(ends)}
    lines += [_group("run", first.groups("run")[0] | whole)]
    for name in ("solid", "output"):
        lines += [_group(name, group) for group in first.groups(name)]
    if all(len(deck.groups("body")) == 1 for deck in members):
        lines.append(_group("interaction", {"law": "none"}))  # a member alone meets nothing
    for group in first.groups("interaction"):
        lines += [_group("interaction", group)] if _of_all(group) else []
    for k, deck in enumerate(members):
        for name in NAMES:
            for group in deck.groups(name):
                if name == "interaction" and _of_all(group):
                    continue
                moved = _moved(name, group, axis, packed.shift(k))
                lines.append(_group(name, _renamed(name, moved, f"m{k}_")))
    return replace(packed, text="\n".join(lines) + "\n")


def _refuse(deck: Deck, first: Deck) -> None:
    """NotPackable where a deck has what cannot lie beside others."""
    if odd := [name for name in deck.names if name not in (*NAMES, *SHARED)]:
        raise NotPackable(f"members have &{odd[0]}")
    for name in SHARED:
        for one, other in zip(deck.groups(name), first.groups(name), strict=False):
            left = HELD_ALONE.get(name, ())
            if {k: v for k, v in one.items() if k not in left} != {
                k: v for k, v in other.items() if k not in left
            }:
                raise NotPackable(f"members differ in &{name}")
    if deck.get("solid", "region") is not None:
        raise NotPackable("particles leave a region of &solid")
    if any(group.get("file") for group in deck.groups("body")):
        raise NotPackable("a body comes from a file")
    shared = [g for g in deck.groups("interaction") if _of_all(g)]
    if shared != [g for g in first.groups("interaction") if _of_all(g)]:
        raise NotPackable("members differ in an &interaction of all bodies")


def _of_all(interaction: dict) -> bool:
    """Whether an interaction is one of all bodies."""
    return any("*" in str(name) for name in as_list(interaction.get("bodies", "*")))


def _axis_of(members: list[Deck]) -> tuple[int, float]:
    """Axis without a plane of symmetry along which members are shortest, and their pitch [m]; as
    long as bodies are with the way that they fly at their first velocity.
    """
    dimension = int(members[0].get("run", "dimension", 3))
    mirrors = members[0].mirrors
    bodies = [body for deck in members for body in deck.bodies()]
    ways = [_way(deck, group) for deck in members for group in deck.groups("body")]
    low = np.min([b.low + np.minimum(w, 0) for b, w in zip(bodies, ways, strict=True)], axis=0)
    high = np.max([b.high + np.maximum(w, 0) for b, w in zip(bodies, ways, strict=True)], axis=0)
    lengths = {d: float(high[d] - low[d]) for d in range(dimension) if not mirrors[d]}
    if not lengths:
        raise NotPackable("there are planes of symmetry across all axes")
    axis = min(lengths, key=lengths.get)
    across = max(float(b.high[d] - b.low[d]) for b in bodies for d in range(dimension))
    return axis, APART * max(lengths[axis], 0.1 * across)


def _way(deck: Deck, body: dict) -> np.ndarray:
    """How far a body flies until the end at its first velocity, shape (3) [m]."""
    velocity = np.array((as_list(body.get("velocity")) + [0.0] * 3)[:3], float)
    return velocity * float(deck.get("run", "t_end", 0.0))


def _moved(name: str, group: dict, axis: int, by: float) -> dict:
    """A group with its places moved along an axis [m]."""
    moved = dict(group)
    for key in POINTS.get(name, ()):
        if (point := as_list(group.get(key))) and len(point) > axis:
            point[axis] += by
            moved[key] = point
    for key in BOXES.get(name, ()):
        if box := as_list(group.get(key)):
            for at in range(2 * axis, len(box), 6):
                box[at] += by
                box[at + 1] += by
            moved[key] = box
    return moved


def _renamed(name: str, group: dict, mark: str) -> dict:
    """A group whose names are those of a member."""
    renamed = dict(group)
    for key in NAMES[name]:
        if (value := group.get(key)) is not None:
            names = [mark + str(one) for one in as_list(value)]
            renamed[key] = names if isinstance(value, list) else names[0]
    return renamed


def _group(name: str, values: dict) -> str:
    """A namelist group as text."""
    keys = [f"  {key} = {_value(value)}" for key, value in values.items() if value is not None]
    return "\n".join([f"&{name}", *keys, "/", ""])


def _value(value: object) -> str:
    if isinstance(value, (list, tuple)):
        return ", ".join(_value(one) for one in value)
    if isinstance(value, bool):
        return ".true." if value else ".false."
    if isinstance(value, str):
        return "'" + value.replace("'", "''") + "'"
    return repr(value)


def share_out(out: Path, packed: Pack, folders: list[Path]) -> None:
    """Give each member its columns of the histories of the run in `out`, as if it had run alone.

    Writes gauges.csv and bodies.csv of each folder, up to the end of the member. OSError is left to
    the caller.
    """
    for name in ("gauges.csv", "bodies.csv"):
        if not (out / name).is_file():
            continue
        rows = [line.split(",") for line in (out / name).read_text(encoding="utf-8").splitlines()]
        rows = [row for row in rows if len(row) == len(rows[0])]  # the last may be cut off
        for k, folder in enumerate(folders):
            mark = f"m{k}_"
            kept = [0, *(c for c, head in enumerate(rows[0]) if head.startswith(mark))]
            lines = [",".join(rows[0][c].removeprefix(mark) for c in kept)]
            places = [i for i, c in enumerate(kept)
                      if rows[0][c].endswith(f":{AXES[packed.axis]}[m]")]  # fmt: skip
            for row in _until(packed.ends[k], [[row[c] for c in kept] for row in rows[1:]]):
                for i in places:
                    row[i] = repr(float(row[i]) - packed.shift(k))
                lines.append(",".join(row))
            folder.mkdir(parents=True, exist_ok=True)
            (folder / name).write_text("\n".join(lines) + "\n", encoding="utf-8")


def _until(end: float, rows: list[list[str]]) -> list[list[str]]:
    """Rows of a history up to a time [s]; where others follow, one on a straight line is the last,
    as a run has a row at its end.
    """
    late = next((i for i, row in enumerate(rows) if float(row[0]) > end * (1 + 1e-12)), len(rows))
    kept = rows[:late]
    if not 0 < late < len(rows) or float(rows[late - 1][0]) >= end * (1 - 1e-12):
        return kept
    one, other = (np.array(row, float) for row in rows[late - 1 : late + 1])
    last = one + (other - one) * (end - one[0]) / (other[0] - one[0])
    return [*kept, [repr(end), *(repr(float(v)) for v in last[1:])]]
