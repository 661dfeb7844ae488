# SPDX-License-Identifier: MIT
"""Cohesive interfaces between bodies: how much of each is broken, and where."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgba

from post.deck import AXES
from post.reader import Frame, Run
from post.style import DAMAGE_COLOURS, RED, WIDTH, Picture, linear_bar, save
from post.tables import Table

FIELDS = tuple(f"interface{part}" for part in ("", "_names", "_at", "_damage", "_area"))
BROKEN = 1 - 1e-6  # damage of a point that carries nothing any more


@dataclass(frozen=True)
class Interface:
    """One interface at one time, mirror images included; places are those of the unloaded bodies.

    `points` (n, 3) [m], `damage` (n) from 0 to 1, `area` (n) of each point [m2] (in two dimensions
    of a depth of 1 m).
    """

    name: str  # such as 'low+high'
    time: float  # [s]
    points: np.ndarray
    damage: np.ndarray
    area: np.ndarray

    @property
    def broken(self) -> float:
        """Area that carries nothing any more [m2]."""
        return float(self.area[self.damage >= BROKEN].sum())

    @property
    def begun(self) -> float:
        """Area of points that are damaged and not broken [m2]."""
        return float(self.area[(self.damage > 0) & (self.damage < BROKEN)].sum())

    @property
    def normal(self) -> int:
        """Axis along which the points extend least."""
        return int(np.argmin(np.ptp(self.points, axis=0)))


def interfaces(run: Run, frame: Frame) -> list[Interface]:
    """The interfaces in a dump of the solid, in the order of the dump; none without any."""
    data = frame.field_data(*FIELDS)
    if data is None:
        return []
    found = []
    for k, name in enumerate(data["interface_names"]):
        own = data["interface"] == k + 1
        points, damage, area = (
            data[f"interface_{part}"][own].astype(float) for part in ("at", "damage", "area")
        )
        for axis in range(3):
            if run.deck.mirrors[axis] and len(points):
                image = points.copy()
                image[:, axis] *= -1
                points = np.concatenate([points, image])
                damage, area = np.tile(damage, 2), np.tile(area, 2)
        found.append(Interface(str(name).strip(), frame.time, points, damage, area))
    return found


def interface_table(run: Run) -> Table:
    """Areas of each interface at the end."""
    frame = next((f for f in reversed(run.frames) if f.solid_path), None)
    rows = []
    for one in interfaces(run, frame) if frame else []:
        total = float(one.area.sum())
        share = f"{100 * one.broken / total:.3g} %" if total else "–"
        areas = (f"{1e6 * v:.4g}" for v in (total, one.broken, one.begun))
        rows.append((one.name, *areas, share))
    heads = ("interface", "area [mm2]", "broken [mm2]", "damaged besides [mm2]", "broken share")
    note = "Of the whole scene, mirror images included; in two dimensions of a depth of 1 m."
    return Table("Cohesive interfaces", heads, rows, note)


def draw_interfaces(run: Run, folder: Path) -> Picture | None:
    """Damage of every interface that has some, at the end: maps, in two dimensions curves."""
    frame = next((f for f in reversed(run.frames) if f.solid_path), None)
    hurt = [one for one in interfaces(run, frame) if one.damage.any()] if frame else []
    if not hurt:
        return None
    flat = int(run.deck.get("run", "dimension", 3)) < 3
    columns = 1 if flat or len(hurt) == 1 else 2
    rows = -(-len(hurt) // columns)
    slope = 0.3 if flat else max(*(_slope(one) for one in hurt), 0.3)
    size = (WIDTH, rows * ((WIDTH - 1.4) / columns * slope + 0.7))
    figure, panels = plt.subplots(rows, columns, figsize=size, squeeze=False)
    for spare in panels.ravel()[len(hurt) :]:
        spare.set_visible(False)
    for axis, one in zip(panels.ravel(), hurt, strict=False):
        (_curve if flat else _map)(axis, one)
        axis.set_title(f"{one.name}, {1e3 * one.time:.3f} ms", fontsize=9)
    if not flat:
        linear_bar(figure, DAMAGE_COLOURS, list(panels.ravel()), "damage of the interface [-]",
                   fraction=0.04, pad=0.02)  # fmt: skip
    said = "; ".join(
        f"{one.name}: {1e6 * one.broken:.4g} of {1e6 * one.area.sum():.4g} mm2 broken"
        for one in hurt
    )
    caption = "Damage of the cohesive interfaces at the places of the unloaded bodies"
    caption += f"{'' if flat else '; red: broken'}. {said}."
    return Picture(save(figure, folder / "interfaces.png"), "Cohesive interfaces", caption)


def _slope(one: Interface) -> float:
    """Height over width of a map."""
    across, up = (np.ptp(one.points[:, d]) for d in range(3) if d != one.normal)
    return float(up / across) if across > 0 else 1.0


def _map(axis, one: Interface) -> None:
    """A square of its own area for each point, red if broken, seen along the normal."""
    i, j = (d for d in range(3) if d != one.normal)
    half = np.sqrt(one.area)[:, None, None] / 2
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    squares = 1e3 * (one.points[:, None, [i, j]] + half * corners)
    colours = DAMAGE_COLOURS.to_rgba(one.damage)
    colours[one.damage >= BROKEN] = to_rgba(RED)
    axis.add_collection(PolyCollection(squares, facecolors=colours, edgecolors=colours, lw=0.3))
    axis.set_aspect("equal")
    axis.margins(0)
    axis.autoscale_view()
    axis.grid(False)
    axis.set_xlabel(f"{AXES[i]} [mm]")
    axis.set_ylabel(f"{AXES[j]} [mm]")


def _curve(axis, one: Interface) -> None:
    """Damage along the interface."""
    along = int(np.argmax(np.ptp(one.points, axis=0)))
    order = np.argsort(one.points[:, along])
    axis.fill_between(1e3 * one.points[order, along], one.damage[order], step="mid", alpha=0.35)
    axis.step(1e3 * one.points[order, along], one.damage[order], where="mid")
    axis.set_ylim(0, 1.05)
    axis.set_xlabel(f"{AXES[along]} [mm]")
    axis.set_ylabel("damage [-]")
