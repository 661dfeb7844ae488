# SPDX-License-Identifier: MIT
"""A perforated plate: seen from both sides, cut through the hole, and its holes ply by ply."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from post.deck import AXES
from post.perforation import Hole, HoleAround, Perforation, Plate
from post.raster import Raster
from post.style import BLUE, DAMAGE, DAMAGE_COLOURS, RED, Picture, linear_bar, plt, save
from post.tables import Table
from post.units import show

REACH = 1.0  # half width of the window over the diameter of the largest hole
HOLE = "#ffffff"
MOST_PICTURES = 6  # of the holes of one body


def hole_table(found: Perforation) -> Table:
    """The holes and the damage around them, for the terminal and the report."""
    rows = []
    for number, hole in enumerate(found.holes, 1):
        rows += _rows_of_hole(found.plate, hole, number if len(found.holes) > 1 else 0)
    rows.append(("came loose", f"{100 * found.loose:.3g} % of the particles", ""))
    note = (
        "Diameters of circles of equal area. Loose: what no longer hangs together with the largest "
        "piece of the body. The regions are projections, hole included; there the last column is "
        "their area. A hole and its mirror images are given once, as it is in the modelled part."
    )
    title = f"Holes in {found.plate.body.id} at {show(found.plate.time, 's')}"
    return Table(title, ("hole", "loose parts away", f"{found.plate.broken} away too"), rows, note)


def _rows_of_hole(plate: Plate, hole: HoleAround, number: int) -> list[tuple[str, str, str]]:
    """Rows of the table for one hole; its number is 0 where there is one alone."""
    side, layers = AXES[plate.normal], hole.layers
    head = "through the plate" if number == 0 else f"{number}: through the plate"
    place = "" if hole.size == 0 else f" at {_place(plate, hole)}"
    several = f", {hole.copies} of them in the whole" if hole.copies > 1 else ""
    holes = {
        f"{head}{place}{several}": hole.through,
        f"in the face at {side} high": layers[-1],
        f"in the face at {side} low": layers[0],
    }
    if len(layers) > 1:
        holes[f"in the widest {plate.level}"] = max(layers, key=lambda h: h.seen.area)
        holes[f"in the narrowest {plate.level}"] = min(layers, key=lambda h: h.seen.area)
    rows = [(name, *_both(one)) for name, one in holes.items()]
    for name, region in hole.damaged.items():
        area = f"{1e6 * region.area:.3g} mm2"
        rows.append((f"{name} in some {plate.level} around it", show(region.diameter, "m"), area))
    return rows


def _place(plate: Plate, hole: HoleAround) -> str:
    """'(30, 30) mm in x, y'."""
    i, j = plate.plane
    size = plate.body.spacing
    x, y = (1e3 * (0.0 if abs(value) < 0.5 * size else value) for value in hole.middle)
    return f"({x:.3g}, {y:.3g}) mm in {AXES[i]}, {AXES[j]}"


def _both(hole: Hole) -> tuple[str, str]:
    return show(hole.seen.diameter, "m"), show(hole.pushed.diameter, "m")


def draw_perforation(found: Perforation, folder: Path) -> list[Picture]:
    """Write `hole_<body>.png`, and `hole_<body>_2.png` and so on for further holes, to a folder."""
    pictures = []
    for number, hole in enumerate(found.holes[:MOST_PICTURES], 1):
        end = f"_{number}" if number > 1 else ""
        path = folder / f"hole_{found.plate.body.id}{end}.png"
        several = f", hole {number} of {len(found.holes)}" if len(found.holes) > 1 else ""
        pictures.append(_draw_hole(found, hole, path, several))
    return pictures


def _draw_hole(found: Perforation, hole: HoleAround, path: Path, several: str) -> Picture:
    """Both faces, the cut and the hole ply by ply of one hole."""
    plate, through = found.plate, hole.through
    figure = plt.figure(figsize=(7.5, 6.2))
    rows = figure.add_gridspec(2, 1, height_ratios=[1.8, 1])
    faces = rows[0].subgridspec(1, 2).subplots()
    cut, plies = rows[1].subgridspec(1, 2, width_ratios=[1.7, 1]).subplots()
    middle = np.where(np.isfinite(hole.middle), hole.middle, 0.0)
    widest = max([through.pushed, *(h.seen for h in hole.layers)], key=lambda o: o.area)
    window = REACH * max(widest.diameter, 6 * plate.body.spacing)
    for axis, side in zip(faces, (1, -1), strict=True):
        _draw_face(axis, found, through, side, (middle, window))
    draw_cut(cut, found, (middle, window))
    _draw_layers(plies, plate, hole)
    linear_bar(figure, DAMAGE_COLOURS, list(faces), "damage [-]", fraction=0.04, pad=0.01)
    at = "" if hole.size == 0 else f" at {_place(plate, hole)}"
    images = f" ({hole.copies} of them in the whole)" if hole.copies > 1 else ""
    caption = (
        f"Body {plate.body.id} of {plate.body.material or 'unknown material'}, "
        f"{1e3 * plate.body.spacing:.3g} mm between particles, at {show(plate.time, 's')}, loose "
        f"particles taken away. Hole through the plate{at}{images}: "
        f"{show(through.seen.diameter, 'm')} (red: circle of equal area), with {plate.broken} "
        f"taken away too {show(through.pushed.diameter, 'm')} (dashed)."
    )
    return Picture(save(figure, path), f"Hole in {plate.body.id}{several}", caption)


def _draw_face(axis, found: Perforation, through: Hole, side: int, view: tuple) -> None:
    """One face of the plate as one sees it: the damage of the particle on top, white where open."""
    plate, (middle, window) = found.plate, view
    image, extent = _face_image(found.raster, plate, side, view)
    colours = DAMAGE.with_extremes(bad=HOLE)
    axis.imshow(image.T, extent=extent, origin="lower", cmap=colours, vmin=0, vmax=1)
    angle = np.linspace(0, 2 * np.pi, 200)
    for opening, line in ((through.seen, "-"), (through.pushed, "--")):
        if opening.area > 0:
            x, y = (
                1e3 * (opening.middle[d] + opening.diameter / 2 * f(angle))
                for d, f in enumerate((np.cos, np.sin))
            )
            axis.plot(x, y, line, color=RED, lw=1.2)
    axis.set_xlim(1e3 * (middle[0] - window), 1e3 * (middle[0] + window))
    axis.set_ylim(1e3 * (middle[1] - window), 1e3 * (middle[1] + window))
    i, j = plate.plane
    axis.set_xlabel(f"{AXES[i]} [mm]")
    axis.set_ylabel(f"{AXES[j]} [mm]")
    axis.set_title(f"face at {AXES[plate.normal]} {'high' if side > 0 else 'low'}")
    axis.grid(False)


def _face_image(raster: Raster, plate: Plate, side: int, view: tuple):
    """Damage in a window of the raster, nan where one sees through; its extent [mm]."""
    middle, window = view
    low = np.floor((middle - window - raster.low) / raster.pixel).astype(int)
    size = int(np.ceil(2 * window / raster.pixel))
    image = np.full((size, size), np.nan)
    rows = np.flatnonzero(plate.stays)
    rows = rows[np.argsort(side * plate.points[rows, plate.normal], kind="stable")]
    half = 0.5 * np.abs(plate.edges[rows]).sum(axis=1)[:, plate.plane].mean()
    reach = int(np.ceil(half / raster.pixel))
    points, damage = plate.points[rows][:, plate.plane], plate.field["damage"][rows]
    for sx in (1, -1) if plate.mirrors[0] else (1,):
        for sy in (1, -1) if plate.mirrors[1] else (1,):
            place = np.floor((points * (sx, sy) - raster.low) / raster.pixel).astype(int) - low
            for dx in range(-reach, reach):
                for dy in range(-reach, reach):
                    x, y = place[:, 0] + dx, place[:, 1] + dy
                    there = (x >= 0) & (x < size) & (y >= 0) & (y < size)
                    image[x[there], y[there]] = damage[there]
    start = raster.low + low * raster.pixel
    ends = [v for d in range(2) for v in (start[d], start[d] + size * raster.pixel)]
    return image, [1e3 * v for v in ends]


def draw_cut(axis, found: Perforation, view: tuple) -> None:
    """The layer of particles through the middle of the hole, what came loose as dots."""
    plate, (middle, window) = found.plate, view
    i, j = plate.plane
    place = plate.lattice.place
    rest = plate.points[:, j] - plate.field["displacement"][:, j]
    level = rest[np.argmin(np.abs(rest - middle[1]))]
    rows = np.flatnonzero(place[:, j] == place[np.argmin(np.abs(rest - level)), j])
    size = (72 * 4.0 * plate.body.spacing / (2 * window)) ** 2
    for keep, alpha in ((~plate.stays, 0.35), (plate.stays, 1.0)):
        chosen = rows[keep[rows]]
        for sign in (1, -1) if plate.mirrors[0] else (1,):
            x, z = 1e3 * sign * plate.points[chosen, i], 1e3 * plate.points[chosen, plate.normal]
            colour = plate.field["damage"][chosen]
            axis.scatter(
                x, z, s=max(size, 0.3), c=colour, cmap=DAMAGE, vmin=0, vmax=1, alpha=alpha,
                marker="s", lw=0, rasterized=True,
            )  # fmt: skip
    axis.set_xlim(1e3 * (middle[0] - window), 1e3 * (middle[0] + window))
    around = plate.body.low[plate.normal], plate.body.high[plate.normal]
    thick = around[1] - around[0]
    axis.set_ylim(1e3 * (around[0] - 0.9 * thick), 1e3 * (around[1] + 0.9 * thick))
    axis.set_aspect("equal")
    axis.set_xlabel(f"{AXES[i]} [mm]")
    axis.set_ylabel(f"{AXES[plate.normal]} [mm]")
    level = 0.0 if abs(level) < plate.body.spacing else 1e3 * level
    axis.set_title(f"cut through the hole at {AXES[j]} = {level:.3g} mm; pale: loose")
    axis.grid(False)


def _draw_layers(axis, plate: Plate, hole: HoleAround) -> None:
    """Diameter of the hole in each ply, or layer of particles."""
    number = np.arange(1, len(hole.layers) + 1)
    for name, colour, values in (
        ("loose parts away", BLUE, [h.seen.diameter for h in hole.layers]),
        (f"{plate.broken} away", RED, [h.pushed.diameter for h in hole.layers]),
    ):
        axis.plot(1e3 * np.array(values), number, "o-", ms=3, color=colour, label=name)
    axis.axvline(1e3 * hole.through.seen.diameter, color=BLUE, lw=0.9, ls=":")
    axis.axvline(1e3 * hole.through.pushed.diameter, color=RED, lw=0.9, ls=":")
    axis.set_xlim(left=0)
    axis.set_ylim(0.5, len(number) + 0.5)
    axis.yaxis.set_major_locator(plt.MaxNLocator(8, integer=True))
    axis.set_xlabel("diameter of the hole [mm]")
    what = plate.level
    axis.set_ylabel(f"{what}, from {AXES[plate.normal]} low")
    axis.set_title("hole by " + what)
    axis.legend(loc="best", fontsize=7.5, handlelength=1.2)
