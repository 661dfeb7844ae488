# SPDX-License-Identifier: MIT
"""Contact sheet: a vertical cut through blast and bodies at a few times, side by side."""

from __future__ import annotations

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection

from post.errors import PostError
from post.reader import AirGrid, Frame, Run
from post.space import (
    Cut,
    air_in,
    boxes_of,
    choose_cut,
    outlines_in,
    particles_in,
    pick_frames,
    whole_air,
)
from post.style import (
    DAMAGE_COLOURS,
    DPI,
    GREY,
    WIDTH,
    Picture,
    highest,
    linear_bar,
    pressure_bar,
    pressure_colours,
    save,
)
from post.tints import Tints, tints_of
from post.units import scale_for, show

AXES = "xyz"
WIDE = 0.75  # height over width of a scene whose times stand below each other
FAR_ABOVE = 10  # times the pressure of the other times: shown in the darkest colour
OVERLAP = 1.12  # of the outlines of neighbours, so that no paper shines through between them
DARK = "#2b3138"  # of bodies over the air


def draw_sheet(run: Run, folder: Path, frame: Frame | None = None, count: int = 5) -> Picture:
    """Pressure in a vertical plane with the bodies on it; below, the bodies alone, stretched.

    `count` times that tell the story of the run, or the one of `frame`.
    """
    if not run.frames:
        raise PostError("there are no dumps, so nothing can be drawn")
    frames = pick_frames(run, count) if frame is None else [frame]
    airs = [cut_air(run, one) for one in frames]
    if all(air is not None and min(sorted(air.cells)[1:]) == 1 for air in airs):
        raise PostError("a scene of one dimension has no cut")
    cut = choose_cut(run.deck, airs[0].cells if airs[0] else None)
    tints = tints_of(run.deck)
    bodies = [cut_bodies(run, one, cut, tints) for one in frames]
    view = view_of(run, airs[0], bodies, cut)
    colours = pressure_colours(run.deck.ambient, _top_of_scale(airs))
    strips = any(len(quads) for quads, *_ in bodies)
    figure, axes = _layout(len(frames), view, tints if strips else None)
    for number, shown in enumerate(frames):
        axis = axes[0, number]
        if airs[number]:
            draw_air(axis, airs[number], cut, colours)
        draw_bodies(axis, bodies[number][0])
        dress(axis, view, cut)
        axis.set_title(f"{1e3 * shown.time:.3f} ms", loc="center", fontweight="normal")
        if strips:
            _draw_strip(axes[1, number], bodies, number, view, cut)
    _clear_inner_labels(axes)
    over = any(air and highest(air.field["pressure"]) > colours.norm.vmax for air in airs)
    _colour_bars(figure, axes, colours if airs[0] else None, over)
    stretch = None
    if strips:
        tints.legend(figure)
        stretch = _label_strips(figure, axes[1], cut)
    caption = _caption(run, cut, stretch)
    title = "Blast and bodies in a vertical cut"
    return Picture(save(figure, folder / "sheet.png"), title, caption)


def _top_of_scale(airs: list[AirGrid | None]) -> float:
    """Highest pressure of the scale [Pa]: that of all times, unless one of them is far above the
    others, as a charge that has just burnt is.
    """
    tops = [highest(air.field["pressure"]) for air in airs if air]
    return min(max(tops), FAR_ABOVE * float(np.median(tops))) if tops else 0.0


def _caption(run: Run, cut: Cut, stretch: float | None) -> str:
    plane = f"in the plane {AXES[cut.normal]} = {show(cut.level, 'm', 6)}"
    if cut.whole:
        plane = f"in the plane of {AXES[cut.across]} and {AXES[cut.up]}"
    text = f"Pressure of the air {plane}, on one logarithmic scale (blue: suction)"
    if not any(frame.air_path for frame in run.frames):
        text = f"Section {plane}"
    if any(run.deck.mirrors):
        text += ", mirrored over the planes of symmetry"
    text += ". The bodies are drawn at true scale."
    if stretch is not None:
        text += (
            " Beside or below: the same section of the bodies alone, coloured by damage, with the "
            f"vertical axis stretched {stretch:.2g} times, over the height of what is wide."
        )
    return text


def _label_strips(figure, axes, cut: Cut) -> float:
    """Write onto the strips how far they are stretched; the factor."""
    figure.draw_without_rendering()
    axis = axes[0]
    box, across, up = axis.get_window_extent(), np.ptp(axis.get_xlim()), np.ptp(axis.get_ylim())
    stretch = float(box.height / up / (box.width / across))
    for axis in axes:
        if axis.get_ylabel():
            axis.set_ylabel(f"{axis.get_ylabel()}, {stretch:.2g} : 1", fontsize=8.5)
    return stretch


def cut_air(run: Run, frame: Frame) -> AirGrid | None:
    if frame.air_path is None:
        return None
    return whole_air(frame.air("pressure", "solid"), run.deck.mirrors)


def cut_bodies(run: Run, frame: Frame, cut: Cut, tints: Tints) -> tuple[np.ndarray, ...]:
    """Outlines (m, 4, 2) [m] of the particles in the cut, their colours (m, 3) and bodies (m)."""
    if frame.solid_path is None:
        return np.zeros((0, 4, 2)), np.zeros((0, 3)), np.zeros(0, int)
    solid = frame.solid("displacement", "body", "damage", "volume", lacking=True)
    edges = boxes_of(run, solid)
    rows = particles_in(cut, solid, edges)
    body = solid.field["body"][rows]
    quads = outlines_in(cut, solid.points[rows], OVERLAP * edges[rows])
    paint = tints.paint(solid.field["damage"][rows], body)
    for place, axis in enumerate((cut.across, cut.up)):
        if run.deck.mirrors[axis]:
            image = quads.copy()
            image[..., place] *= -1
            quads, paint = np.concatenate([quads, image]), np.concatenate([paint, paint])
            body = np.concatenate([body, body])
    return quads, paint, body


def view_of(run: Run, air: AirGrid | None, bodies: list, cut: Cut) -> np.ndarray:
    """Limits [[across low, high], [up low, high]] [m] of the panels."""
    if air is not None:
        low, high = air.low, air.low + air.cells * air.spacing
        return np.array([[low[d], high[d]] for d in (cut.across, cut.up)])
    points = np.concatenate([quads.reshape(-1, 2) for quads, *_ in bodies])
    if not len(points):
        raise PostError("there is neither air nor a body in the cut")
    low, high = points.min(0), points.max(0)
    margin = 0.05 * (high - low).max()
    return np.stack([low - margin, high + margin], 1)


def _layout(count: int, view: np.ndarray, tints: Tints | None):
    """Figure and axes [true scale, strips][time]: one column for each time, or, where the scene is
    wide, one row with the strip on the right.
    """
    kinds = 1 if tints is None else 2
    legend = 0.0 if tints is None else tints.height
    slope = float(np.ptp(view[1]) / np.ptp(view[0]))
    if slope < WIDE and count > 1:
        height = max((WIDTH - 1.6) / kinds * slope, 0.6) + 0.35
        figure, axes = plt.subplots(
            count,
            kinds,
            figsize=(WIDTH, height * count + 1.2 + legend),
            squeeze=False,
            dpi=DPI,
        )
        return figure, axes.T
    height = min((WIDTH - 1.2) / count * slope, 6.0)
    ratios = [height, 0.9][:kinds]
    return plt.subplots(
        kinds,
        count,
        figsize=(WIDTH, sum(ratios) + 0.9 + legend),
        gridspec_kw={"height_ratios": ratios},
        squeeze=False,
        dpi=DPI,
    )


def draw_air(axis, air: AirGrid, cut: Cut, colours) -> None:
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


def draw_bodies(axis, quads: np.ndarray, paint: np.ndarray | None = None) -> None:
    """Boxes of the particles in their colours, or dark."""
    if not len(quads):
        return
    if paint is None:
        boxes = PolyCollection(quads, facecolor=DARK, edgecolor=DARK, lw=0.4)
    else:
        boxes = PolyCollection(quads, facecolor=paint, edgecolor="face", lw=0)
    axis.add_collection(boxes)


def dress(axis, view: np.ndarray, cut: Cut) -> None:
    """Limits, ticks and labels, in mm below a width of 1 m."""
    factor, unit = scale_for(view[0], "m")
    axis.set_aspect("equal")
    axis.set_xlim(view[0])
    axis.set_ylim(view[1])
    axis.grid(False)
    narrow = axis.get_subplotspec().get_gridspec().ncols > 2
    axis.xaxis.set_major_locator(plt.MaxNLocator(3 if narrow else 6))
    axis.yaxis.set_major_locator(plt.MaxNLocator(5))
    for one in (axis.xaxis, axis.yaxis):
        one.set_major_formatter(lambda value, _: f"{value / factor:g}")
    axis.tick_params(labelsize=8)
    axis.set_xlabel(f"{AXES[cut.across]} [{unit}]", fontsize=8.5)
    axis.set_ylabel(f"{AXES[cut.up]} [{unit}]", fontsize=8.5)


def _clear_inner_labels(axes) -> None:
    """Labels along x on the lowest panels alone, along y on the first of each row of a kind."""
    for axis in axes.ravel():
        place = axis.get_subplotspec()
        if not place.is_last_row():
            axis.set_xlabel("")
            axis.set_xticklabels([])
    for kind in axes:
        for axis in kind:
            if axis is not kind[0] and _row(axis) == _row(kind[0]):
                axis.set_ylabel("")
                axis.set_yticklabels([])


def _draw_strip(axis, bodies: list, number: int, view: np.ndarray, cut: Cut) -> None:
    """The bodies alone; the vertical range is that of what is wide, at all times."""
    low, high = range_of_strips(bodies)
    margin = 0.08 * (high - low)
    draw_bodies(axis, *bodies[number][:2])
    dress(axis, np.array([view[0], [low - margin, high + margin]]), cut)
    axis.set_aspect("auto")
    axis.axhline(0, color=GREY, lw=0.4, zorder=0)


def range_of_strips(bodies: list) -> tuple[float, float]:
    """Lowest and highest place [m] of the bodies that are at least half as wide as the widest."""
    first = next(cut for cut in bodies if len(cut[0]))
    number = np.unique(first[2])
    width = [np.ptp(first[0][first[2] == n][..., 0]) for n in number]
    wide = number[np.array(width) >= 0.5 * max(width)]
    places = np.concatenate([quads[np.isin(body, wide)][..., 1] for quads, _, body in bodies])
    return float(places.min()), float(places.max())


def _row(axis) -> int:
    """Row of a panel."""
    return axis.get_subplotspec().rowspan.start


def _colour_bars(figure, axes, colours, over: bool) -> None:
    """Bars on the right of the rows, or below the two columns of a wide scene; with an arrow where
    pressures lie `over` the scale.
    """
    place = {"fraction": 0.03, "pad": 0.01}
    if _row(axes[0, 0]) != _row(axes[0, -1]):
        place = {"location": "bottom", "fraction": 0.02, "pad": 0.01, "shrink": 0.8}
    if colours is not None:
        arrow = {"extend": "max"} if over else {}
        pressure_bar(figure, colours, axes[0].tolist(), **place, **arrow)
    if len(axes) > 1:
        linear_bar(figure, DAMAGE_COLOURS, axes[1].tolist(), "damage [-]", **place)
