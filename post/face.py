# SPDX-License-Identifier: MIT
"""Maps of a field on the faces of one body, also where another body hides them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize

from post.deck import AXES, Body
from post.errors import USAGE, PostError
from post.reader import Frame, Run
from post.style import DAMAGE, DPI, WIDTH, Picture, linear_bar, save
from post.surface import find_lattice
from post.units import scale_for

FACES = tuple(f"{axis}{side}" for axis in AXES for side in "-+")
TENSOR = ("xx", "yy", "zz", "xy", "yz", "xz")
OPEN = "#ffffff"  # where the face has no particle


@dataclass(frozen=True)
class FaceMap:
    """A field on one face of a body, of the whole scene; the places are those of the unloaded body.

    `values` [across, up], not a number where there is no particle; `low` and `step` (2) [m] are
    the corner and the sides of its cells.
    """

    body: Body
    face: str  # such as 'z-'
    field: str
    unit: str
    time: float  # [s]
    values: np.ndarray
    low: np.ndarray
    step: np.ndarray

    @property
    def plane(self) -> tuple[int, int]:
        """The two axes along the face."""
        return tuple(d for d in range(3) if AXES[d] != self.face[0])

    @property
    def extent(self) -> list[float]:
        """Limits across and up [mm], as matplotlib's imshow takes them."""
        high = self.low + self.step * self.values.shape
        return [1e3 * v for v in (self.low[0], high[0], self.low[1], high[1])]


def face_map(run: Run, frame: Frame, body: str, face: str, field: str = "damage") -> FaceMap:
    """The outermost particles of a body towards a face ('x-' to 'z+') and a field of theirs.

    Components are named `stress:xx` or `displacement:z`; without one a vector gives its magnitude.
    PostError for a body, face or field that is not there, and for a body that is on no lattice.
    """
    if face not in FACES:
        raise PostError(f"--face {face}: must be one of {', '.join(FACES)}", USAGE)
    which = _body(run, body)
    name, _, component = field.partition(":")
    solid = frame.solid("displacement", "body", name)
    own = np.flatnonzero((solid.field["body"] == which.number) & solid.known)
    if not len(own):
        raise PostError(f"body '{body}' has no particles in this dump")
    rest = solid.points[own] - solid.field["displacement"][own]
    lattice = find_lattice(rest, which.step)
    if lattice is None:
        raise PostError(f"body '{body}': its particles do not lie on a lattice")
    values = _component(solid.field[name][own].astype(float), name, component)
    normal = AXES.index(face[0])
    i, j = (d for d in range(3) if d != normal)
    order = np.argsort(lattice.place[:, normal], kind="stable")
    order = order if face[1] == "+" else order[::-1]  # what is farther out is written later
    places, values = rest[order][:, [i, j]], values[order]
    for d, axis in enumerate((i, j)):
        if run.deck.mirrors[axis]:
            image = places.copy()
            image[:, d] *= -1
            sign = -1.0 if _odd(component, axis) else 1.0
            places, values = np.concatenate([places, image]), np.append(values, sign * values)
    step = lattice.step[[i, j]]
    low = places.min(axis=0) - step / 2
    cell = np.floor((places - low) / step + 1e-3).astype(int)
    picture = np.full(cell.max(axis=0) + 1, np.nan)
    picture[tuple(cell.T)] = values
    unit = frame.unit_of("solid", name)
    return FaceMap(which, face, field, unit, frame.time, picture, low, step)


def thin_faces(run: Run, body: str) -> tuple[str, str]:
    """The two faces across the thinnest direction of a body."""
    which = _body(run, body)
    axis = AXES[int(np.argmin(which.high - which.low))]
    return f"{axis}-", f"{axis}+"


def _body(run: Run, name: str) -> Body:
    for body in run.deck.bodies():
        if body.id == name:
            return body
    known = ", ".join(body.id for body in run.deck.bodies())
    raise PostError(f"{run.job}: there is no body '{name}'; there are {known}", USAGE)


def _component(values: np.ndarray, name: str, component: str) -> np.ndarray:
    """One component of a vector or tensor, the magnitude of a vector, or the scalar itself."""
    names = {1: (), 3: tuple(AXES), 6: TENSOR}.get(1 if values.ndim == 1 else values.shape[1], ())
    if component:
        if component not in names:
            have = ", ".join(names) or "none"
            raise PostError(f"field {name}: has no component '{component}'; it has {have}", USAGE)
        return values[:, names.index(component)]
    if values.ndim == 1:
        return values
    if values.shape[1] == 3:
        return np.linalg.norm(values, axis=1)
    raise PostError(f"field {name}: name a component, such as {name}:{TENSOR[0]}", USAGE)


def _odd(component: str, axis: int) -> bool:
    """Whether a component changes its sign in the mirror image over a plane normal to an axis."""
    return bool(component) and component.count(AXES[axis]) % 2 == 1


def draw_faces(maps: list[FaceMap], path: Path, names: list[str] | None = None) -> Picture:
    """Maps of one field beside each other, in one scale; a caption with what is seen.

    `names` of the runs, one for each map, stand in the titles.
    """
    colours, factor, unit = _scale(maps)
    figure, axes = _panels(maps)
    for axis, one, name in zip(axes, maps, names or [""] * len(maps), strict=True):
        image = np.ma.masked_invalid(one.values.T / factor)
        axis.imshow(image, extent=one.extent, origin="lower", cmap=colours.cmap, norm=colours.norm)
        i, j = one.plane
        axis.set_xlabel(f"{AXES[i]} [mm]")
        axis.set_ylabel(f"{AXES[j]} [mm]")
        when = f"{1e3 * one.time:.3f} ms"
        title = f"{one.body.id}, face at {one.face[0]} {_side(one)}, {when}"
        axis.set_title(f"{name}\n{title}" if name else title, fontsize=9)
        axis.grid(False)
    label = f"{maps[0].field.replace('_', ' ').replace(':', ' ')} [{unit}]"
    linear_bar(figure, colours, axes, label, fraction=0.04, pad=0.02)
    caption = _caption(maps, names or [""] * len(maps))
    return Picture(save(figure, path), f"Faces of {maps[0].body.id}", caption)


def draw_damaged_faces(run: Run, folder: Path, least: float) -> list[Picture]:
    """Both faces of each box-shaped body whose damage exceeds `least` at the end."""
    frame = next((f for f in reversed(run.frames) if f.solid_path), None)
    if frame is None:
        return []
    solid, pictures = frame.solid("body", "damage"), []
    for body in run.deck.bodies():
        damage = solid.field["damage"][solid.field["body"] == body.number]
        if body.shape != "box" or not (damage > least).any():
            continue
        try:
            maps = [face_map(run, frame, body.id, face) for face in thin_faces(run, body.id)]
        except PostError:
            continue  # not on a lattice
        pictures.append(draw_faces(maps, folder / f"face_{body.id}_damage.png"))
    return pictures


def _side(one: FaceMap) -> str:
    return "low" if one.face[1] == "-" else "high"


def _scale(maps: list[FaceMap]) -> tuple[ScalarMappable, float, str]:
    """Colours for all maps, and the factor and name of the unit: damage always from 0 to 1."""
    values = np.concatenate([one.values[np.isfinite(one.values)] for one in maps])
    if maps[0].field.startswith("damage"):
        return ScalarMappable(Normalize(0, 1), DAMAGE), 1.0, "-"
    factor, unit = scale_for(values, maps[0].unit)
    low, high = float(values.min(initial=0.0)) / factor, float(values.max(initial=0.0)) / factor
    if low < 0:
        top = max(-low, high)
        return ScalarMappable(Normalize(-top, top), "RdBu_r"), factor, unit
    return ScalarMappable(Normalize(0, high or 1.0), "viridis"), factor, unit


def _panels(maps: list[FaceMap]):
    """Figure with one panel for each map, two beside each other unless they are long."""
    slope = max(np.ptp(one.extent[2:]) / np.ptp(one.extent[:2]) for one in maps)
    columns = 1 if slope < 0.4 else min(2, len(maps))
    rows = -(-len(maps) // columns)
    height = min((WIDTH - 1.4) / columns * slope, 7.0) + 0.6
    figure, axes = plt.subplots(
        rows, columns, figsize=(WIDTH, rows * height), squeeze=False, dpi=DPI
    )
    for spare in axes.ravel()[len(maps) :]:
        spare.set_visible(False)
    return figure, list(axes.ravel()[: len(maps)])


def _caption(maps: list[FaceMap], names: list[str]) -> str:
    """What is seen, of what it is made, and how much of each face is damaged."""
    text = (
        f"Body {maps[0].body.id}, seen along the axis, at the places of the unloaded body: the "
        "outermost particle of each column. "
    )
    made = [
        f"{f'{name}: ' if name else ''}{one.body.material or 'unknown material'}, "
        f"{1e3 * one.body.spacing:.3g} mm between particles, at {1e3 * one.time:.3f} ms"
        for one, name in zip(maps, names, strict=True)
    ]
    text += "; ".join(dict.fromkeys(made)) + ". "
    for one, name in zip(maps, names, strict=True):
        known = one.values[np.isfinite(one.values)]
        if one.field.startswith("damage") and known.size:
            share = 100 * float((known > 0.5).mean())
            where = f"{name} {one.face}".strip()
            text += f"{where}: {share:.3g} % of the face has more than 0.5. "
    return text.rstrip()
