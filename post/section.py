# SPDX-License-Identifier: MIT
"""Contact sheet: a vertical cut through blast and bodies at a few times, side by side."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize

from post.errors import PostError
from post.figures import Picture
from post.reader import AirGrid, Frame, Run
from post.space import Cut, air_in, choose_cut, particles_in, pick_frames, whole_air
from post.style import (
    DAMAGE,
    DAMAGE_COLOURS,
    DPI,
    GREY,
    WIDTH,
    linear_bar,
    pressure_bar,
    pressure_colours,
    save,
)

AXES = "xyz"
DARK = "#2b3138"  # of bodies over the air


def draw_sheet(run: Run, folder: Path, frame: Frame | None = None, count: int = 5) -> Picture:
    """Pressure in a vertical plane with the bodies on it; below, the bodies alone, stretched.

    `count` times that tell the story of the run, or the one of `frame`.
    """
    if not run.frames:
        raise PostError("there are no dumps, so nothing can be drawn")
    frames = pick_frames(run, count) if frame is None else [frame]
    airs = [_cut_air(run, one) for one in frames]
    if all(air is not None and min(sorted(air.cells)[1:]) == 1 for air in airs):
        raise PostError("a scene of one dimension has no cut")
    cut = choose_cut(run.deck, airs[0].cells if airs[0] else None)
    bodies = [_cut_bodies(run, one, cut) for one in frames]
    view = _view(run, airs[0], bodies, cut)
    top = max((float(a.field["pressure"].max()) for a in airs if a), default=0.0)
    colours = pressure_colours(run.deck.ambient, top)
    strips = any(len(quads) for quads, _ in bodies)
    figure, axes = _layout(len(frames), view, strips)
    for column, shown in enumerate(frames):
        axis = axes[0, column]
        if airs[column]:
            _draw_air(axis, airs[column], cut, colours)
        _draw_bodies(axis, bodies[column][0])
        _dress(axis, view, cut, column)
        axis.set_title(f"{1e3 * shown.time:.3f} ms", loc="center", fontweight="normal")
        if strips:
            axis.set_xlabel("")
            axis.set_xticklabels([])
            _draw_strip(axes[1, column], bodies, column, view, cut)
    _colour_bars(figure, axes, colours if airs[0] else None, strips)
    return Picture(
        save(figure, folder / "sheet.png"),
        "Blast and bodies in a vertical cut",
        _caption(run, cut, strips),
    )


def _caption(run: Run, cut: Cut, strips: bool) -> str:
    plane = f"{AXES[cut.normal]} = {1e3 * cut.level:g} mm"
    text = f"Pressure of the air in the plane {plane}, on one logarithmic scale (blue: suction)"
    if any(run.deck.mirrors):
        text += ", mirrored over the planes of symmetry"
    text += ". The bodies are drawn at true scale."
    if strips:
        text += (
            " Below: the same section of the bodies alone, coloured by damage, with the vertical "
            "axis stretched."
        )
    return text


def _cut_air(run: Run, frame: Frame) -> AirGrid | None:
    if frame.air_path is None:
        return None
    return whole_air(frame.air("pressure", "solid"), run.deck.mirrors)


def _cut_bodies(run: Run, frame: Frame, cut: Cut) -> tuple[np.ndarray, np.ndarray]:
    """Boxes (m, 4, 2) [m] of the particles in the cut, and their damage (m)."""
    if frame.solid_path is None:
        return np.zeros((0, 4, 2)), np.zeros(0)
    solid = frame.solid("displacement", "body", "damage")
    rows = particles_in(cut, run, solid)
    size = {body.number: body.spacing for body in run.deck.bodies()}
    half = np.array([size.get(b, 0.0) for b in solid.field["body"][rows]]) * 0.56
    centre = solid.points[rows][:, [cut.across, cut.up]]
    ring = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    quads = centre[:, None, :] + half[:, None, None] * ring
    damage = solid.field["damage"][rows]
    for place, axis in enumerate((cut.across, cut.up)):
        if run.deck.mirrors[axis]:
            image = quads.copy()
            image[..., place] *= -1
            quads, damage = np.concatenate([quads, image]), np.concatenate([damage, damage])
    return quads, damage


def _view(run: Run, air: AirGrid | None, bodies: list, cut: Cut) -> np.ndarray:
    """Limits [[across low, high], [up low, high]] [m] of the panels."""
    if air is not None:
        low, high = air.low, air.low + air.cells * air.spacing
        return np.array([[low[d], high[d]] for d in (cut.across, cut.up)])
    points = np.concatenate([quads.reshape(-1, 2) for quads, _ in bodies])
    if not len(points):
        raise PostError("there is neither air nor a body in the cut")
    low, high = points.min(0), points.max(0)
    margin = 0.05 * (high - low).max()
    return np.stack([low - margin, high + margin], 1)


def _layout(count: int, view: np.ndarray, strips: bool):
    """Figure with a row of true-scale panels, and a row of strips below."""
    width = (WIDTH - 1.2) / count
    height = min(width * np.ptp(view[1]) / np.ptp(view[0]), 6.0)
    ratios = [height, 0.9] if strips else [height]
    figure, axes = plt.subplots(
        len(ratios),
        count,
        figsize=(WIDTH, sum(ratios) + 0.9),
        gridspec_kw={"height_ratios": ratios},
        squeeze=False,
        dpi=DPI,
    )
    return figure, axes


def _draw_air(axis, air: AirGrid, cut: Cut, colours) -> None:
    pressure = air_in(cut, air, "pressure")
    solid = air_in(cut, air, "solid") > 0
    low, high = air.low, air.low + air.cells * air.spacing
    axis.imshow(
        np.ma.array(pressure, mask=solid),
        origin="lower",
        extent=[low[cut.across], high[cut.across], low[cut.up], high[cut.up]],
        cmap=colours.cmap,
        norm=colours.norm,
        interpolation="nearest",
    )


def _draw_bodies(axis, quads: np.ndarray, damage: np.ndarray | None = None) -> None:
    """Boxes of the particles in the colour of their damage, or dark."""
    if not len(quads):
        return
    if damage is None:
        boxes = PolyCollection(quads, facecolor=DARK, edgecolor=DARK, lw=0.4)
    else:
        boxes = PolyCollection(
            quads, array=damage, cmap=DAMAGE, norm=Normalize(0, 1), edgecolor="face", lw=0
        )
    axis.add_collection(boxes)


def _dress(axis, view: np.ndarray, cut: Cut, column: int) -> None:
    """Limits, ticks in mm, labels on the left panel alone."""
    axis.set_aspect("equal")
    axis.set_xlim(view[0])
    axis.set_ylim(view[1])
    axis.grid(False)
    axis.xaxis.set_major_locator(plt.MaxNLocator(3))
    for one in (axis.xaxis, axis.yaxis):
        one.set_major_formatter(lambda value, _: f"{1e3 * value:g}")
    axis.tick_params(labelsize=8)
    axis.set_xlabel(f"{AXES[cut.across]} [mm]", fontsize=8.5)
    if column == 0:
        axis.set_ylabel(f"{AXES[cut.up]} [mm]", fontsize=8.5)
    else:
        axis.set_yticklabels([])


def _draw_strip(axis, bodies: list, column: int, view: np.ndarray, cut: Cut) -> None:
    """The bodies alone; the vertical range is that of all times."""
    points = np.concatenate([quads.reshape(-1, 2) for quads, _ in bodies])
    low, high = points.min(0), points.max(0)
    margin = 0.08 * (high[1] - low[1])
    _draw_bodies(axis, *bodies[column])
    _dress(axis, np.array([view[0], [low[1] - margin, high[1] + margin]]), cut, column)
    axis.set_aspect("auto")
    axis.axhline(0, color=GREY, lw=0.4, zorder=0)


def _colour_bars(figure, axes, colours, strips: bool) -> None:
    place = {"fraction": 0.03, "pad": 0.01}
    if colours is not None:
        pressure_bar(figure, colours, axes[0].tolist(), **place)
    if strips:
        linear_bar(figure, DAMAGE_COLOURS, axes[-1].tolist(), "damage [-]", **place)
