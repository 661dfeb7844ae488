# SPDX-License-Identifier: MIT
"""The whole scene from the part that is modelled: mirror images, cuts, and the choice of frames."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from post.deck import Deck, as_list
from post.errors import PostError
from post.gauges import measure, pressure_gauges
from post.reader import AirGrid, Frame, Particles, Run
from post.surface import Lattice, edges_of, find_lattice, on_plane

CRUSHED, BLOWN = 0.4, 2.5  # times the volume of the particle: else its neighbours have flowed
LONGER = 2  # times what it was: the most that an edge that nothing spans is stretched
NICE = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)


def whole_air(grid: AirGrid, mirrors: tuple[bool, bool, bool]) -> AirGrid:
    """The air with its mirror images: vectors change the sign of the normal component."""
    low, cells, field = grid.low.copy(), grid.cells.copy(), dict(grid.field)
    for axis, cut in enumerate(mirrors):
        if not cut or abs(low[axis]) > 0.5 * grid.spacing[axis] or grid.cells[axis] < 2:
            continue
        for name, values in field.items():
            image = np.flip(values, 2 - axis).copy()
            if values.ndim == 4:
                image[..., axis] *= -1
            field[name] = np.concatenate([image, values], 2 - axis)
        low[axis] -= cells[axis] * grid.spacing[axis]
        cells[axis] *= 2
    return AirGrid(grid.time, low, grid.spacing, cells, field)


def mirrored(corners: np.ndarray, mirrors: tuple[bool, bool, bool]) -> np.ndarray:
    """Points (..., 3) and their mirror images, joined along the first axis; fields repeat."""
    for axis, cut in enumerate(mirrors):
        if cut:
            image = corners.copy()
            image[..., axis] *= -1
            corners = np.concatenate([corners, image])
    return corners


@dataclass(frozen=True)
class Cut:
    """A plane through the scene: its normal, the axes across and up, and where it lies."""

    normal: int
    across: int
    up: int
    level: float  # [m]
    whole: bool = False  # a plane scene: everything lies in it


def choose_cut(deck: Deck, cells: np.ndarray | None = None) -> Cut:
    """The plane y = const through the charge, or else a body; in 2-D the plane of the scene."""
    flat = [d for d in range(3) if cells is not None and cells[d] == 1]
    normal = flat[-1] if flat else 1
    dimension = int(deck.get("run", "dimension", 3))
    if dimension < 3:
        return Cut(2, 0, 1, 0.0, whole=True)
    across, up = (d for d in range(3) if d != normal)
    for group in deck.groups("charge"):
        return Cut(normal, across, up, float((as_list(group.get("at")) + [0.0] * 3)[normal]))
    if deck.mirrors[normal]:
        return Cut(normal, across, up, 0.0)
    for body in deck.bodies():
        return Cut(normal, across, up, float(body.low[normal] + body.high[normal]) / 2)
    box = as_list(deck.get("air", "box")) + [0.0] * 6
    return Cut(normal, across, up, (box[2 * normal] + box[2 * normal + 1]) / 2)


def air_in(cut: Cut, grid: AirGrid, name: str) -> np.ndarray:
    """A scalar field in the cells at a cut, [up, across]; between two layers their mean."""
    values = np.moveaxis(grid.field[name], 2 - cut.normal, 0)  # [normal, up, across]
    place = (cut.level - grid.low[cut.normal]) / grid.spacing[cut.normal] - 0.5
    last = grid.cells[cut.normal] - 1
    first = int(np.clip(np.floor(place + 1e-6), 0, last))
    if abs(place - first - 0.5) < 0.01 and first < last:
        return 0.5 * (values[first] + values[first + 1])
    return values[int(np.clip(np.rint(place), 0, last))]


def boxes_of(run: Run, solid: Particles) -> np.ndarray:
    """Edges of the box that each particle stands for, [particle, edge, component] [m].

    Neighbours on the lattice of the unloaded body that still hold together span it, so it is
    stretched and turned with the body. Edges along which nothing holds are as long as the volume of
    the particle asks for. Where neighbours have flowed past each other the box is that of the
    unloaded body, grown or shrunk. `solid` holds displacement, body and, if it is known, volume.
    """
    edges = np.zeros((len(solid.points), 3, 3))
    volume = solid.field.get("volume")
    if int(run.deck.get("run", "dimension", 3)) < 3:
        volume = None  # that of a slice of 1 m
    for body in run.deck.bodies():
        own = np.flatnonzero((solid.field["body"] == body.number) & solid.known)
        if not len(own):
            continue
        points = solid.points[own]
        lattice = find_lattice(points - solid.field["displacement"][own], body.step)
        step = body.step if lattice is None else lattice.step
        wanted = np.full(len(own), step.prod()) if volume is None else volume[own].astype(float)
        wanted[~((wanted > 0) & np.isfinite(wanted))] = step.prod()
        edges[own] = np.cbrt(wanted / step.prod())[:, None, None] * np.diag(step)
        if lattice is not None:
            spanned = _spanned(points, lattice, wanted, run.deck.mirrors)
            ratio = np.abs(np.linalg.det(spanned)) / wanted
            fair = (ratio > CRUSHED) & (ratio < BLOWN)
            edges[own[fair]] = spanned[fair]
    return edges


def _spanned(points: np.ndarray, lattice: Lattice, volume: np.ndarray, mirrors) -> np.ndarray:
    """Edges (n, 3, 3) [m] of boxes between neighbours; those that nothing spans are scaled so that
    the box has its `volume` (n) [m3]. Beside a plane of symmetry the image is a neighbour.
    """
    edges, held = edges_of(points, lattice)
    for d, cut in enumerate(mirrors):
        if cut and on_plane(lattice, d):
            first = (lattice.place[:, d] == 1) & held[d][1]
            edges[first, d] *= 0.5
            edges[first, d, d] += np.minimum(points[first, d], lattice.step[d])
    loose = ~np.array([low | high for low, high in held]).T
    have = np.maximum(np.abs(np.linalg.det(edges)), 1e-6 * volume)
    factor = (volume / have) ** (1 / np.maximum(loose.sum(axis=1), 1))
    factor = np.clip(factor, 1 / LONGER, LONGER)
    return np.where(loose[:, :, None], factor[:, None, None] * edges, edges)


def particles_in(cut: Cut, solid: Particles, edges: np.ndarray) -> np.ndarray:
    """Rows of the particles that the plane of a cut goes through, the nearest last.

    `edges` as of `boxes_of`. The plane meets the ellipsoid around the box of the particle; for a
    cube, the sphere through its corners. So where particles have moved off the plane, the next ones
    on either side are drawn, and what lies nearer is drawn over them.
    """
    rows = np.flatnonzero(solid.known)
    if cut.whole:
        return rows
    away = np.abs(solid.points[rows, cut.normal] - cut.level)
    reach = 0.5 * np.sqrt(3) * np.linalg.norm(edges[rows, :, cut.normal], axis=1)
    met = away <= reach
    rows, far = rows[met], away[met] / np.maximum(reach[met], 1e-300)
    return rows[np.argsort(-far, kind="stable")]


def outlines_in(cut: Cut, points: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """What a cut shows of boxes: parallelograms [box, corner, across or up] [m].

    `points` (n, 3) and `edges` (n, 3, 3) [m]: the two edges that lie most in the plane span it.
    """
    length = np.maximum(np.linalg.norm(edges, axis=2), 1e-300)
    drop = np.argmax(np.abs(edges[..., cut.normal]) / length, axis=1)
    if cut.whole:
        drop = np.full(len(points), cut.normal)
    every = np.arange(len(points))
    plane = [cut.across, cut.up]
    one, other = (edges[every, (drop + k) % 3][:, plane] for k in (1, 2))
    signs = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) / 2
    corners = signs[:, :1] * one[:, None] + signs[:, 1:] * other[:, None]
    return points[:, None, plane] + corners


def first_arrival(run: Run) -> float | None:
    """Earliest arrival at a gauge within two cells of a body [s]; None if there is none."""
    times = []
    cell = run.deck.cell
    for gauge in pressure_gauges(run):
        if gauge.at is None or cell is None:
            continue
        near = 2 * cell.max()
        for body in run.deck.bodies():
            inside = (gauge.at > body.low - near) & (gauge.at < body.high + near)
            if inside.all():
                pulse = _try_measure(run, gauge)
                times += [pulse.arrival] if pulse and np.isfinite(pulse.arrival) else []
    return min(times) if times else None


def _try_measure(run: Run, gauge):
    try:
        return measure(run, gauge)
    except PostError:
        return None


def pick_frames(run: Run, count: int) -> list[Frame]:
    """Frames that tell the story: equal parts of what happens lie between them.

    With a blast that arrives at a body, the first is before and the second just after the
    arrival. The last frame is always shown, one at the start is left out.
    """
    frames = [frame for frame in run.frames if frame.time > 0] or run.frames
    if len(frames) <= count:
        return frames
    end, arrival = frames[-1].time, first_arrival(run)
    time, share = happenings(run)
    if arrival is None or not 0.05 * end < arrival < 0.9 * end or count < 4:
        early, levels = [], np.arange(1, count + 1) / count
    else:
        early = [0.6 * arrival, 1.08 * arrival]
        levels = np.linspace(np.interp(early[1], time, share), 1, count - 1)[1:]
    chosen = [frames[-1]]
    for wanted in [*early, *np.interp(levels[:-1], share, time)]:
        left = [frame for frame in frames if frame not in chosen]
        chosen.append(min(left, key=lambda frame: abs(frame.time - wanted)))
    return sorted(chosen, key=lambda frame: frame.time)


def happenings(run: Run) -> tuple[np.ndarray, np.ndarray]:
    """Times [s], and the share of what happens in the run until then, from 0 to 1, both (n).

    What happens: how far the energies of the bodies and the impulse on them have gone up and down
    (those of the air in a run without bodies), and time itself, each as a part of its total.
    """
    history = run.history("energy")
    time, parts = np.array([0.0, run.end]), []
    if history is not None and len(history) > 1 and run.end > 0:
        time = history.time
        names = history.find("(solid_(kinetic|internal)|impulse_[xyz])") or []
        ways = [_way(history[name]) for name in names]
        if not any(way is not None for way in ways):
            ways = [_way(history[name]) for name in history.find("air_(kinetic|internal)")]
        parts = [way for way in ways if way is not None]
    clock = (time - time[0]) / max(time[-1] - time[0], 1e-300)
    return time, np.mean([clock, *parts], axis=0)


def _way(values: np.ndarray) -> np.ndarray | None:
    """How far a history has gone up and down, over its whole way; None if it stays put."""
    way = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(np.nan_to_num(values))))])
    return way / way[-1] if np.isfinite(way[-1]) and way[-1] > 0 else None


def magnification_for(size: float, displacement: float) -> float:
    """Round factor that shows the largest displacement as about 10 % of the size of the scene."""
    if displacement <= 0 or size <= 0:
        return 1.0
    wanted = 0.1 * size / displacement
    return float(max((n for n in NICE if n <= wanted * 1.2), default=1))
