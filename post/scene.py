# SPDX-License-Identifier: MIT
"""Rendered views of the whole scene: the blast around the bodies, and the bodies alone."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize

from post import rendering
from post.deck import Deck, as_list
from post.errors import PostError
from post.reader import AirGrid, Frame, Run
from post.space import (
    Cut,
    air_in,
    choose_cut,
    first_arrival,
    magnification_for,
    mirrored,
    whole_air,
)
from post.style import (
    DAMAGE_COLOURS,
    DPI,
    WIDTH,
    Picture,
    highest,
    linear_bar,
    pressure_bar,
    pressure_colours,
    save,
)
from post.surface import skin_of
from post.tints import tints_of
from post.units import scale_for, show

TALL, WIDE = (1200, 1200), (1500, 1150)  # pixels
MOST_CELLS = 4_000_000  # of the air that is contoured; a larger grid is thinned out
# seen from the camera: places and strengths. With AMBIENT and DIFFUSE below no face gets brighter
# than its colour, whichever way it looks: a white face would look like a hole
LIGHTS = (((0, 0, 1), 0.45), ((-0.5, 0.9, 0.4), 0.5), ((-0.5, -0.9, 0.4), 0.5))
AMBIENT, DIFFUSE = 0.5, 0.5
LITTLE_DAMAGE = 0.02
AXES = "xyz"


@dataclass(frozen=True)
class Solids:
    """What is drawn of the bodies: faces with damage, and points of those without a lattice."""

    corners: np.ndarray  # (m, 4, 3) [m]
    face: np.ndarray  # (m) row of the particle that a face belongs to
    points: np.ndarray  # (k, 3) [m]
    point: np.ndarray  # (k) row of the particle
    damage: np.ndarray  # (n) of all particles
    body: np.ndarray  # (n) number of their bodies
    distance: np.ndarray  # (n) displacement [m]
    size: float  # of a point [m]
    magnification: float

    @property
    def largest(self) -> float:
        """Largest displacement [m]."""
        return float(self.distance.max(initial=0.0))


def draw_blast(run: Run, folder: Path, frame: Frame | None = None) -> Picture:
    """The blast cut open and the bodies, at a frame (default: as the shock leaves the body)."""
    if not any(f.air_path for f in run.frames):
        raise PostError("the run has no dumps of the air")
    frame = frame or _frame_of_reflection(run)
    air = whole_air(frame.air("pressure", "solid"), run.deck.mirrors)
    if min(air.cells) == 1:
        raise PostError("a scene of one or two dimensions is not rendered")
    cut = choose_cut(run.deck, air.cells)
    solids = gather_solids(run, frame, 1.0) if frame.solid_path else None
    colours = pressure_colours(run.deck.ambient, highest(air.field["pressure"]))
    tints = tints_of(run.deck)
    paint = None if solids is None else tints.paint(solids.damage, solids.body)
    pressure = (colours, run.deck.ambient)
    image, level = _render_blast(air, cut, (solids, paint), pressure, _elevation(run.deck))
    plane = f"{AXES[cut.normal]} = {show(cut.level, 'm', 6)}"
    caption = (
        f"t = {1e3 * frame.time:.3f} ms. Pressure of the air in the plane {plane} where it is "
        f"above ambient (logarithmic) and, behind it, the shell in which it exceeds "
        f"{show(level, 'Pa', 2)}. "
    )
    if any(run.deck.mirrors):
        caption += "The scene is mirrored over its planes of symmetry. "
    if solids is not None:
        caption += "Bodies at true scale, coloured by damage."
    room = 0.0 if solids is None else tints.height
    figure, axes = _compose([image], [f"Blast at {1e3 * frame.time:.3f} ms"], room)
    place = {"fraction": 0.04, "pad": 0.01, "shrink": 0.8}
    if solids is not None:
        linear_bar(figure, DAMAGE_COLOURS, axes[0], "damage [-]", **place)
        tints.legend(figure)
    pressure_bar(figure, colours, axes[0], **place)
    path = save(figure, folder / "blast.png")
    return Picture(path, "Blast and bodies", caption)


def draw_bodies(run: Run, folder: Path, frame: Frame | None = None) -> Picture:
    """The bodies deformed and coloured by damage, at a frame (default: largest displacement)."""
    if not any(f.solid_path for f in run.frames):
        raise PostError("the run has no dumps of the solid")
    frame = frame or _frame_of_largest_displacement(run)
    solids = gather_solids(run, frame)
    tints, little = tints_of(run.deck), float(solids.damage.max(initial=0.0)) < LITTLE_DAMAGE
    if little and solids.largest > 0:
        factor, unit = scale_for([solids.largest], "m")
        colours = ScalarMappable(Normalize(0, solids.largest / factor), "viridis")
        label = f"displacement [{unit}]"
        paint = colours.to_rgba(solids.distance / factor)[:, :3]
    else:
        colours, label = DAMAGE_COLOURS, "damage [-]"
        paint = tints.paint(solids.damage, solids.body)
    images = [_render_bodies(solids, paint, elevation) for elevation in (28, -28)]
    when = f"{1e3 * frame.time:.3f} ms"
    room = tints.height if colours is DAMAGE_COLOURS else 0.0
    figure, axes = _compose(images, [f"Bodies at {when}, from above", "From below"], room)
    linear_bar(figure, colours, axes, label, fraction=0.03, pad=0.01, shrink=0.6)
    if colours is DAMAGE_COLOURS:
        tints.legend(figure)
    scale = solids.magnification
    how = "true scale" if scale == 1 else f"displacements magnified {scale:g} times"
    caption = f"t = {when}, {how}; largest displacement {show(solids.largest, 'm')}, "
    caption += f"largest damage {float(solids.damage.max(initial=0.0)):.2g}."
    if colours is not DAMAGE_COLOURS:
        caption += " There is hardly any damage, so the colour is the displacement."
    if any(run.deck.mirrors):
        caption += " Mirrored over the planes of symmetry."
    return Picture(save(figure, folder / "bodies.png"), "Bodies and damage", caption)


def gather_solids(run: Run, frame: Frame, magnification: float | None = None) -> Solids:
    """Faces and points of all bodies with their mirror images.

    Without a `magnification` a round one is chosen that makes the largest displacement visible.
    """
    solid = frame.solid("displacement", "body", "damage")
    move, mirrors = solid.field["displacement"].astype(float), run.deck.mirrors
    known = solid.known
    distance = np.where(known, np.linalg.norm(move, axis=1), 0.0)
    if magnification is None:
        extent = np.ptp(mirrored(solid.points[known], mirrors), axis=0)
        magnification = magnification_for(
            float(extent.max(initial=0.0)), float(distance.max(initial=0.0))
        )
    corners, face, points, point, size = [np.zeros((0, 4, 3))], [], [np.zeros((0, 3))], [], 0.0
    for body in run.deck.bodies():
        own = np.flatnonzero((solid.field["body"] == body.number) & known)
        skin = skin_of(solid.points[own], move[own], body.step, mirrors, magnification)
        if skin is not None:
            corners.append(mirrored(skin.corners, mirrors))
            face.append(np.tile(own[skin.particle], run.deck.images))
        else:
            moved = solid.points[own] + (magnification - 1) * move[own]
            points.append(mirrored(moved, mirrors))
            point.append(np.tile(own, run.deck.images))
            size = max(size, float(body.step.max()))
    return Solids(
        np.concatenate(corners),
        np.concatenate([np.zeros(0, int), *face]),
        np.concatenate(points),
        np.concatenate([np.zeros(0, int), *point]),
        solid.field["damage"],
        solid.field["body"],
        distance,
        size,
        magnification,
    )


def _frame_of_reflection(run: Run) -> Frame:
    """The frame a little after the first arrival at a body, or the middle of the run."""
    arrival = first_arrival(run)
    frames = [frame for frame in run.frames if frame.air_path]
    wanted = 1.08 * arrival if arrival is not None else 0.5 * frames[-1].time
    return min(frames, key=lambda frame: abs(frame.time - wanted))


def _frame_of_largest_displacement(run: Run) -> Frame:
    frames = [frame for frame in run.frames if frame.solid_path]
    return max(frames, key=_farthest)


def _farthest(frame: Frame) -> float:
    """Largest component of a displacement [m]."""
    solid = frame.solid("displacement")
    return float(np.abs(solid.field["displacement"][solid.known]).max(initial=0.0))


def _elevation(deck: Deck) -> float:
    """From where a blast is seen [deg]: from below if its charges lie below the bodies."""
    charges = [(as_list(group.get("at")) + [0.0] * 3)[2] for group in deck.groups("charge")]
    bodies = [(body.low[2] + body.high[2]) / 2 for body in deck.bodies()]
    below = charges and bodies and max(charges) < min(bodies)
    return -18.0 if below else 22.0


def _render_blast(air: AirGrid, cut: Cut, bodies: tuple, pressure: tuple, elevation: float):
    """The picture as an array, and the pressure of the surface [Pa]."""
    colours, ambient = pressure
    plotter = _plotter(TALL)
    level = ambient + max(0.12 * (colours.norm.vmax - ambient), 0.2 * ambient)
    _add_front(plotter, air, cut, (level, colours.to_rgba(level)[:3]))
    _add_slice(plotter, air, cut, colours, ambient)
    if bodies[0] is not None:
        _add_solids(plotter, *bodies)
    plotter.add_mesh(_outline(air), color="#8a929b", line_width=1.5)
    low, high = air.low, air.low + air.cells * air.spacing
    _look(plotter, low, high, azimuth=-62, elevation=elevation, zoom=0.98)
    return _shoot(plotter), level


def _render_bodies(solids: Solids, paint: np.ndarray, elevation: float) -> np.ndarray:
    plotter = _plotter(WIDE)
    _add_solids(plotter, solids, paint)
    every = np.concatenate([solids.corners.reshape(-1, 3), solids.points])
    if not len(every):
        raise PostError("there are no particles to draw")
    _look(plotter, every.min(0), every.max(0), azimuth=-60, elevation=elevation, zoom=1.1)
    return _shoot(plotter)


def _plotter(pixels: tuple[int, int]):
    rendering.prepare()
    import pyvista  # noqa: PLC0415 (the environment must be set before)

    plotter = pyvista.Plotter(off_screen=True, window_size=pixels, lighting="none")
    for place, strength in LIGHTS:
        light = pyvista.Light(position=place, intensity=strength, light_type="camera light")
        plotter.add_light(light)
    plotter.background_color = "white"
    plotter.enable_anti_aliasing("ssaa")
    return plotter


def _shoot(plotter) -> np.ndarray:
    image = plotter.screenshot(None, return_img=True)
    plotter.close()
    return image


def _look(plotter, low: np.ndarray, high: np.ndarray, **view: float) -> None:
    """Camera at a distance that holds a box, z upwards; angles in degrees."""
    centre, size = (low + high) / 2, float(np.linalg.norm(high - low))
    a, e = math.radians(view["azimuth"]), math.radians(view["elevation"])
    way = np.array([math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)])
    plotter.camera.position = centre + 1.9 * size * way
    plotter.camera.focal_point = centre
    plotter.camera.up = (0.0, 0.0, 1.0)
    plotter.camera.zoom(view["zoom"])
    plotter.camera.clipping_range = (0.1 * size, 5 * size)


def _outline(air: AirGrid):
    import pyvista  # noqa: PLC0415

    high = air.low + air.cells * air.spacing
    return pyvista.Box(np.stack([air.low, high], 1).ravel()).extract_feature_edges()


def _add_slice(plotter, air: AirGrid, cut: Cut, colours, ambient: float) -> None:
    """The pressure in the plane of the cut, where it is above that of the undisturbed air."""
    import pyvista  # noqa: PLC0415

    pressure = air_in(cut, air, "pressure")
    paint = (255 * colours.to_rgba(pressure)).astype("u1")
    shown = (pressure > 1.03 * ambient) & (air_in(cut, air, "solid") == 0)
    paint[..., 3] = np.where(shown, 255, 0)
    axes = [air.low[d] + np.arange(air.cells[d] + 1) * air.spacing[d] for d in range(3)]
    axes[cut.normal] = np.array([cut.level])
    plane = pyvista.RectilinearGrid(*axes)
    plane.cell_data["colour"] = paint.reshape(-1, 4)
    plotter.add_mesh(plane, scalars="colour", rgba=True, lighting=False, show_scalar_bar=False)


def _add_front(plotter, air: AirGrid, cut: Cut, front: tuple) -> None:
    """A translucent surface of constant pressure, on the far side of the cut alone."""
    import pyvista  # noqa: PLC0415

    level, colour = front
    stride = max(1, math.ceil((np.prod(air.cells.astype(float)) / MOST_CELLS) ** (1 / 3)))
    centres = [air.centres(d)[::stride] for d in range(3)]
    values = air.field["pressure"][::stride, ::stride, ::stride]
    grid = pyvista.RectilinearGrid(*centres)
    grid.point_data["pressure"] = values.ravel()
    surface = grid.contour([level], scalars="pressure")
    if surface.n_points == 0:
        return
    normal, origin = np.zeros(3), np.zeros(3)
    normal[cut.normal], origin[cut.normal] = -1.0, cut.level
    surface = surface.clip(normal=normal, origin=origin)
    if surface.n_points:
        plotter.add_mesh(
            surface,
            color=colour,
            opacity=0.5,
            smooth_shading=True,
            specular=0.2,
            show_scalar_bar=False,
        )


def _add_solids(plotter, solids: Solids, paint: np.ndarray) -> None:
    """Faces and points in the colours (n, 3) of the particles."""
    import pyvista  # noqa: PLC0415

    paint = (255 * paint).astype("u1")
    options = {"scalars": "colour", "rgb": True, "show_scalar_bar": False}
    if len(solids.corners):
        count = len(solids.corners)
        cells = np.concatenate([np.full((count, 1), 4), np.arange(4 * count).reshape(-1, 4)], 1)
        mesh = pyvista.PolyData(solids.corners.reshape(-1, 3), cells.ravel())
        mesh.cell_data["colour"] = paint[solids.face]
        plotter.add_mesh(mesh, ambient=AMBIENT, diffuse=DIFFUSE, **options)
    if len(solids.points):
        cloud = pyvista.PolyData(solids.points)
        cloud.point_data["colour"] = paint[solids.point]
        shape = {"style": "points_gaussian", "emissive": False, "point_size": solids.size}
        plotter.add_mesh(cloud, **shape, **options)


def _compose(images: list[np.ndarray], titles: list[str], room: float):
    """Figure and axes with rendered pictures above each other, each without its empty rim.

    `room` [inch] is left for a legend below.
    """
    images = [_trim(image) for image in images]
    heights = [(WIDTH - 1.2) * image.shape[0] / image.shape[1] for image in images]
    shrink = min(1.0, 6.0 / sum(heights))
    heights = [0.3 + shrink * height for height in heights]
    figure, axes = plt.subplots(
        len(images),
        1,
        figsize=(WIDTH, sum(heights) + room),
        gridspec_kw={"height_ratios": heights},
        squeeze=False,
        dpi=DPI,
    )
    for axis, image, title in zip(axes[:, 0], images, titles, strict=True):
        axis.imshow(image, interpolation="lanczos")
        axis.set_axis_off()
        axis.set_title(title)
    return figure, axes[:, 0].tolist()


def _trim(image: np.ndarray) -> np.ndarray:
    used = np.argwhere((image[..., :3] < 250).any(axis=2))
    if not len(used):
        raise PostError("the rendered picture is empty")
    (top, left), (bottom, right) = used.min(0), used.max(0) + 1
    return image[max(top - 15, 0) : bottom + 15, max(left - 15, 0) : right + 15]
