# SPDX-License-Identifier: MIT
"""A shot at a target as a firing range measures it: residual velocity, plug, debris, what is left.

Everything is told of pieces: particles that hang together on the lattice of their unloaded body
(`fragments.find_fragments`), those with a damage of `FAILED` and more left out. Pieces of fewer
than `DUST` particles and failed particles are dust: their mass counts, they are no plug.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from post.deck import Body, Deck, as_list
from post.errors import PostError
from post.fragments import Fragment, find_fragments
from post.reader import Frame, Run

FAILED = 0.99  # damage from which a particle holds nothing
DUST = 8  # particles: a smaller piece is dust
STILL = 0.02  # of the striking velocity: a slower projectile has stopped
STEADY = 0.005  # of the striking velocity: how far the velocity may still change
LATE = 0.9  # the last tenth of the time is averaged


@dataclass(frozen=True)
class Shot:
    """A body that moves at the start, and a box at rest on its way."""

    projectile: Body
    target: Body
    speed: float  # [m/s]
    direction: np.ndarray  # (3) unit vector

    @property
    def normal(self) -> int:
        """Axis across the target: its shortest side."""
        return int(np.argmin(self.target.high - self.target.low))

    @property
    def side(self) -> int:
        """-1 where the face at the low end of the normal is struck, 1 where the high one is."""
        return -1 if self.direction[self.normal] > 0 else 1

    @property
    def rear(self) -> float:
        """Coordinate of the unloaded rear face along the normal [m]."""
        ends = self.target.low, self.target.high
        return float((ends[1] if self.side < 0 else ends[0])[self.normal])

    @property
    def front(self) -> float:
        """Coordinate of the unloaded front face along the normal [m]."""
        ends = self.target.low, self.target.high
        return float((ends[0] if self.side < 0 else ends[1])[self.normal])

    @property
    def diameter(self) -> float:
        """Of the projectile: the second of its sides [m]."""
        return float(np.sort(self.projectile.high - self.projectile.low)[1])


@dataclass(frozen=True)
class Cloud:
    """What flies away from one side of a target, plug left out, of the whole scene."""

    mass: float  # [kg], dust included
    dust: float  # share of the mass that is dust
    pieces: int  # that are no dust
    velocity: float  # along the shot: momentum over mass [m/s]
    fastest: float  # largest speed of a piece that is no dust [m/s]
    half_angle: float  # of the cone about the shot that holds half of the mass [rad]


@dataclass(frozen=True)
class Outcome:
    """How a shot ended."""

    verdict: str  # 'perforated', 'stopped', 'rebounded' or 'not finished'
    velocity: float  # of the main piece along the shot [m/s]; residual velocity if perforated
    settled: bool  # the velocity has stopped changing
    mass: float  # of the main piece [kg]
    angle: float  # of the main piece to the shot [rad]
    plug: Fragment | None
    behind: Cloud
    before: Cloud


def shots_of(run: Run) -> list[Shot]:
    """The shots of a run; where a body comes from a file, its box is that of its particles."""
    return find_shots(run.deck, _boxes_of_files(run))


def _boxes_of_files(run: Run) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Corners of the unloaded bodies that come from files, mirror images included."""
    unknown = [b for b in run.deck.bodies() if not (b.high > b.low).any()]
    frame = next((f for f in run.frames if f.solid_path), None)
    if not unknown or frame is None:
        return {}
    solid, found = frame.solid("displacement", "body"), {}
    mirrors = np.array(run.deck.mirrors, bool)
    for body in unknown:
        own = (solid.field["body"] == body.number) & solid.known
        if own.any():
            rest = solid.points[own] - solid.field["displacement"][own]
            low, high = rest.min(axis=0) - body.spacing / 2, rest.max(axis=0) + body.spacing / 2
            found[body.id] = np.where(mirrors, -high, low), high
    return found


def find_shots(deck: Deck, boxes: dict | None = None) -> list[Shot]:
    """Each moving body with the box at rest that its straight way meets first; `boxes`: low and
    high corners of bodies of which the deck tells none.
    """
    bodies, moves = deck.bodies(), {}
    boxes_of = boxes or {}
    bodies = [replace(b, low=boxes_of[b.id][0], high=boxes_of[b.id][1]) if b.id in boxes_of else b
              for b in bodies]  # fmt: skip
    for body, group in zip(bodies, deck.groups("body"), strict=True):
        moves[body.id] = np.array((as_list(group.get("velocity")) + [0.0] * 3)[:3], float)
    found = []
    for body in bodies:
        speed = float(np.linalg.norm(moves[body.id]))
        if speed == 0:
            continue
        way = moves[body.id] / speed
        boxes = [b for b in bodies if b.shape == "box" and not moves[b.id].any()]
        met = [(gap, k) for k, b in enumerate(boxes) if (gap := _gap(body, b, way)) is not None]
        if met:
            found.append(Shot(body, boxes[min(met)[1]], speed, way))
    return found


def _gap(body: Body, target: Body, way: np.ndarray) -> float | None:
    """How far a body flies until its middle meets the box [m]; None where it passes by."""
    start = (body.low + body.high) / 2
    step = np.where(way == 0, 1e-30, way)
    near, far = (target.low - start) / step, (target.high - start) / step
    enter, leave = np.minimum(near, far).max(), np.maximum(near, far).min()
    return float(enter) if 0 <= enter <= leave else None


def measure_shot(run: Run, shot: Shot) -> Outcome:
    """How a shot ended, from the last dump and the histories. PostError without dumps."""
    frame = next((f for f in reversed(run.frames) if f.solid_path), None)
    if frame is None:
        raise PostError(f"{run.folder}: there are no dumps of the solid")
    pieces = find_fragments(run, frame, shot.projectile.id, FAILED)
    main = pieces[0]
    time, velocity = _velocity(run, shot, main, sum(p.mass * p.copies for p in pieces))
    late = time >= LATE * time[-1]
    v = float(velocity[late].mean())
    settled = float(np.ptp(velocity[late])) < STEADY * shot.speed
    plug, behind, before = _thrown(run, frame, shot)
    speed = float(np.linalg.norm(main.velocity))
    angle = math.acos(np.clip(main.velocity @ shot.direction / speed, -1, 1)) if speed else 0.0
    verdict = _verdict(shot, main, v, settled)
    return Outcome(verdict, v, settled, main.mass, angle, plug, behind, before)


def _velocity(run: Run, shot: Shot, main: Fragment, whole: float):
    """Times [s] and velocity along the shot of the main piece [m/s], from the histories where it
    is nearly all of the projectile, else from the dumps.
    """
    history, name = run.history("bodies"), shot.projectile.id
    if main.mass * main.copies > 0.99 * whole and history is not None and len(history):
        columns = [f"{name}:velocity_{axis}" for axis in "xyz"]
        parts = [history[c] * d for c, d in zip(columns, shot.direction, strict=True)
                 if c in history]  # fmt: skip
        if parts:
            return history.time, np.sum(parts, axis=0)
    frames = [f for f in run.frames if f.solid_path and f.time >= LATE * run.frames[-1].time]
    speeds = [find_fragments(run, f, name, FAILED)[0].velocity @ shot.direction for f in frames]
    return np.array([f.time for f in frames]), np.array(speeds)


def _verdict(shot: Shot, main: Fragment, v: float, settled: bool) -> str:
    """What has become of the projectile."""
    n, way = shot.normal, -shot.side
    tail = (main.low if way > 0 else main.high)[n]  # the end that leaves last
    head = (main.high if way > 0 else main.low)[n]
    if v < -STILL * shot.speed:
        return "rebounded" if settled or way * (head - shot.front) < 0 else "not finished"
    if abs(v) <= STILL * shot.speed:
        return "stopped"
    free = way * (tail - shot.rear) > 0.5 * shot.diameter
    return "perforated" if free and settled else "not finished"


def _thrown(run: Run, frame: Frame, shot: Shot) -> tuple[Fragment | None, Cloud, Cloud]:
    """The plug, and what flies behind and before the target."""
    n, way = shot.normal, -shot.side
    pieces = [p for p in find_fragments(run, frame, shot.target.id, FAILED) if not p.main]
    leaves = [way * p.velocity[n] for p in pieces]
    behind = [p for p, v in zip(pieces, leaves, strict=True)
              if way * (p.middle[n] - shot.rear) > 0 and v > 0]  # fmt: skip
    before = [p for p, v in zip(pieces, leaves, strict=True)
              if way * (p.middle[n] - shot.front) < 0 and v < 0]  # fmt: skip
    across = [d for d in range(int(run.deck.get("run", "dimension", 3))) if d != n]
    start = (shot.projectile.low + shot.projectile.high) / 2

    def is_plug(p: Fragment) -> bool:
        """Wide enough, and near the line of the shot: not a part of the plate that broke off."""
        away = p.middle - start
        aside = np.linalg.norm((away - (away @ shot.direction) * shot.direction)[across])
        wide = (p.high - p.low)[across].min() >= 0.5 * shot.diameter
        return bool(p.particles >= DUST and wide and aside <= shot.diameter)

    wide = [p for p in behind if is_plug(p)]
    plug = max(wide, key=lambda p: p.mass, default=None)
    rest = [p for p in behind if p is not plug]
    return plug, _cloud(rest, shot.direction), _cloud(before, -shot.direction)


def _cloud(pieces: list[Fragment], way: np.ndarray) -> Cloud:
    """Sums over pieces; velocities along `way`."""
    if not pieces:
        return Cloud(0.0, 0.0, 0, math.nan, math.nan, math.nan)
    mass = np.array([p.mass * p.copies for p in pieces])
    dust = np.array([p.particles < DUST for p in pieces])
    speed = np.array([p.speed for p in pieces])
    along = np.array([p.velocity @ way for p in pieces])
    angle = np.arccos(np.clip(along / np.maximum(speed, 1e-300), -1, 1))
    order = np.argsort(angle)
    half = angle[order][np.searchsorted(np.cumsum(mass[order]), 0.5 * mass.sum())]
    fastest = float(speed[~dust].max()) if (~dust).any() else math.nan
    count = int(sum(p.copies for p, small in zip(pieces, dust, strict=True) if not small))
    whole = float(mass.sum())
    share = float(mass[dust].sum()) / whole
    return Cloud(whole, share, count, float(mass @ along) / whole, fastest, float(half))
