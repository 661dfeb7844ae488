# SPDX-License-Identifier: MIT
"""The holes in a plate that was hit: how wide they are through all plies, in each of them, and how
far around them the plate is damaged.

A hole is what one can see through along the normal of the plate once everything that came loose
has been taken away: particles that no longer hang together with the largest piece of the body over
neighbours on its lattice (`surface.TORN` says when two neighbours still hold). Each particle that
stays covers the box that its neighbours leave it, at its displaced place. Its diameter is that of
the circle of equal area. For a round hole in an undeformed plate it is right to half a spacing
(tests/python/test_perforation.py).

A ply of which the fibres are broken has no strength but may stay where it is. So the hole is also
given with all particles taken away whose fibres are broken, as if one had pushed a rod through.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from post.deck import Body
from post.errors import NUMERICAL, USAGE, PostError
from post.fragments import largest_piece
from post.raster import FINE, Opening, Raster, mirrored, openings, region_of, regions
from post.reader import Frame, Run
from post.surface import Lattice, edges_of, find_lattice

LEAST = 3  # spacings: a few particles that came loose are no hole
BROKEN = 0.5  # damage from which a particle counts as broken
FIBRES = ("damage_fibre_tension", "damage_fibre_compression")
PLIES = "orthotropic_ply"  # the model of what has fibres
MODES = {
    "fibres broken": FIBRES,
    "delaminated": ("damage_delamination",),
    "matrix broken": ("damage_matrix_cracking", "damage_matrix_crushing"),
    "damaged at all": ("damage",),
}


@dataclass(frozen=True)
class Plate:
    """One body at one time, as the measurements need it; rows are its particles."""

    body: Body
    time: float  # [s]
    normal: int  # axis across the plate
    points: np.ndarray  # (n, 3) [m]
    lattice: Lattice
    edges: np.ndarray  # (n, 3, 3) edges of the box of each particle [m]
    stays: np.ndarray  # (n) part of the largest piece
    sound: np.ndarray  # (n) part of the largest piece that unbroken fibres hold together
    layer: np.ndarray  # (n) number of the ply, or of the layer of particles, from 1 at the low side
    field: dict[str, np.ndarray]
    mirrors: tuple[bool, bool]  # of the two axes in the plane
    fibres: bool  # it is of plies with fibres; else particles count as broken by their damage

    @property
    def broken(self) -> str:
        """Name of what counts as broken."""
        return "broken fibres" if self.fibres else "failed particles"

    @property
    def level(self) -> str:
        """Name of a layer."""
        several = self.field.get("ply", np.zeros(1)).max(initial=0) > 1
        return "ply" if self.fibres and several else "layer"

    @property
    def plane(self) -> tuple[int, int]:
        """The two axes in the plane of the plate."""
        return tuple(d for d in range(3) if d != self.normal)


@dataclass(frozen=True)
class Hole:
    """Openings with loose particles taken away, and with all that have broken fibres."""

    seen: Opening
    pushed: Opening


@dataclass(frozen=True)
class HoleAround:
    """One hole of a plate and what is around it."""

    through: Hole
    layers: list[Hole]  # from the low side up
    damaged: dict[str, Opening]  # projected region around the hole by kind of damage
    copies: int  # how many there are of it in the whole plate, with its mirror images

    @property
    def middle(self) -> np.ndarray:
        """Its centre of area (2) in the plane of the plate [m]; not a number without a hole."""
        return (self.through.seen if self.through.seen.area > 0 else self.through.pushed).middle

    @property
    def size(self) -> float:
        """Diameter of the hole, or of what broken fibres would leave open [m]."""
        seen, pushed = self.through.seen, self.through.pushed
        return seen.diameter if seen.area > 0 else pushed.diameter


@dataclass(frozen=True)
class Perforation:
    """The holes of a plate, of the part that is modelled; the widest first, and at least one."""

    plate: Plate
    raster: Raster  # of the whole plate
    holes: list[HoleAround]
    loose: float  # share of the particles that came loose

    @property
    def widest(self) -> HoleAround:
        """The widest hole; its openings have the area 0 if there is none."""
        return self.holes[0]


def load_plate(run: Run, frame: Frame, name: str | None = None) -> Plate:
    """The plate `name`, or the widest box of the deck. PostError if it is not on a lattice."""
    body = _choose(run, name)
    solid = frame.solid()
    own = np.flatnonzero(solid.field["body"] == body.number)
    if not len(own):
        raise PostError(f"body '{body.id}' has no particles in this dump")
    if not solid.known[own].all():
        raise PostError(f"body '{body.id}': places of particles are not finite", NUMERICAL)
    points = solid.points[own]
    field = {key: values[own] for key, values in solid.field.items()}
    lattice = find_lattice(points - field["displacement"], body.step)
    if lattice is None:
        raise PostError(f"body '{body.id}': its particles do not lie on a lattice")
    edges, held = edges_of(points, lattice)
    normal = int(np.argmin(body.high - body.low))
    fibres = run.deck.model_of(body.material) == PLIES
    modes = [field[k] for k in FIBRES if k in field and fibres]
    broken = np.max(modes or [field["damage"]], axis=0) > BROKEN
    stays = largest_piece(lattice, held, np.ones(len(own), bool))
    sound = largest_piece(lattice, held, ~broken)
    layer = _layers(field, lattice, normal)
    mirrors = tuple(cut for d, cut in enumerate(run.deck.mirrors) if d != normal)
    return Plate(
        body,
        solid.time,
        normal,
        points,
        lattice,
        edges,
        stays,
        sound,
        layer,
        field,
        mirrors,
        fibres,
    )


def _choose(run: Run, name: str | None) -> Body:
    bodies = [b for b in run.deck.bodies() if b.shape == "box"]
    if name is not None:
        bodies = [b for b in bodies if b.id == name]
    if not bodies:
        wanted = "no box among the bodies" if name is None else f"no body '{name}' that is a box"
        raise PostError(f"{run.job}: {wanted}", USAGE)
    return max(bodies, key=lambda b: float(np.sort(b.high - b.low)[1:].prod()))


def _layers(field: dict, lattice: Lattice, normal: int) -> np.ndarray:
    """Ply of each particle if there are several, else its layer."""
    ply = field.get("ply")
    return ply if ply is not None and len(ply) and ply.max() > 1 else lattice.place[:, normal]


def measure_perforation(plate: Plate) -> Perforation:
    """All holes of a plate wider than `LEAST` spacings, and the widest in any case.

    A plate without a hole has one with openings of area 0. Of holes that are mirror images of each
    other the one in the modelled part is given. A gap in the broken rim of a hole of a hundred
    times its area is no hole of its own.
    """
    raster = _raster_of(plate)

    def both(some: np.ndarray) -> tuple[list[Opening], list[Opening]]:
        return openings_in(plate, some & plate.stays), openings_in(plate, some & plate.sound)

    whole, nothing = mirrored(raster, np.zeros(raster.shape, bool), plate.mirrors)
    none = region_of(whole, nothing)
    through = both(np.ones(len(plate.points), bool))
    layers = [both(plate.layer == k) for k in np.unique(plate.layer)]
    holes = []
    for number, (place, copies) in enumerate(_places(plate, whole, through, none)):
        if number and place.diameter < LEAST * plate.body.spacing:
            continue
        at = [Hole(*(_over(some, place, none) for some in pair)) for pair in (through, *layers)]
        if any(_in_rim(at[0], hole.through) for hole in holes):
            continue
        holes.append(HoleAround(at[0], at[1:], _damage_around(plate, at[0].seen), copies))
    return Perforation(plate, whole, holes, 1 - float(plate.stays.mean()))


def openings_in(plate: Plate, rows: np.ndarray) -> list[Opening]:
    """Openings in the shadow of some particles (n) along the normal, of the whole plate."""
    raster = _raster_of(plate)
    half = 0.5 * np.abs(plate.edges).sum(axis=1)[:, plate.plane]
    half = np.minimum(half, plate.lattice.step[list(plate.plane)] * 0.75)
    dark = raster.shadow(plate.points[rows][:, plate.plane], half[rows])
    return openings(*mirrored(raster, dark, plate.mirrors))


def _in_rim(gap: Hole, hole: Hole) -> bool:
    """Whether a gap is far smaller than a hole, and one with it without the broken fibres."""
    return gap.pushed is hole.pushed and gap.seen.area < 0.01 * hole.seen.area


def _places(plate: Plate, whole: Raster, through: tuple, none: Opening):
    """Openings in the modelled part, each with the number of its mirror images and itself.

    First what one sees through, then what is open only without broken fibres; at least one.
    """
    seen, pushed = through
    hidden = [one for one in pushed if not any((one.pixels & s.pixels).any() for s in seen)]
    found = []
    for opening in [*seen, *hidden]:
        beside = [d for d in range(2) if plate.mirrors[d] and abs(opening.middle[d]) > whole.pixel]
        if all(opening.middle[d] > 0 for d in beside):
            found.append((opening, 2 ** len(beside)))
    return found or [(none, 1)]


def _over(some: list[Opening], place: Opening, none: Opening) -> Opening:
    """The opening that covers most of another one, or none."""
    shared = [(one.pixels & place.pixels).sum() for one in some]
    return some[int(np.argmax(shared))] if any(shared) else none


def _raster_of(plate: Plate) -> Raster:
    """Pixels over what stays and a little more, from the planes of symmetry on if there are any."""
    pixel = plate.body.spacing / FINE
    low, shape = np.zeros(2), []
    for d, axis in enumerate(plate.plane):
        values = plate.points[plate.stays, axis]
        end = values.max() + 2 * plate.body.spacing
        low[d] = 0.0 if plate.mirrors[d] else values.min() - 2 * plate.body.spacing
        shape.append(int(np.ceil((end - low[d]) / pixel)))
    return Raster(low, pixel, tuple(shape))


def _damage_around(plate: Plate, hole: Opening) -> dict[str, Opening]:
    """Projection of the damage that is connected with the hole, in the unloaded plate."""
    i, j = plate.plane
    place = plate.lattice.place
    shape = place[:, i].max(), place[:, j].max()
    step = plate.lattice.step
    raster = Raster(plate.lattice.low[[i, j]] - step[[i, j]] / 2, float(step[i]), shape)
    found = {}
    for name, fields in MODES.items():
        there = [plate.field[key] for key in fields if key in plate.field]
        if not there or not (plate.fibres or name == "damaged at all"):
            continue
        broken = (np.max(there, axis=0) > BROKEN) | ~plate.stays
        mask = np.zeros(shape, bool)
        mask[place[broken, i] - 1, place[broken, j] - 1] = True
        whole, mask = mirrored(raster, mask, plate.mirrors)
        found[name] = region_of(whole, _region_at(whole, mask, hole.middle))
    return found


def _region_at(raster: Raster, mask: np.ndarray, middle: np.ndarray) -> np.ndarray:
    """The region that holds a point, or else the largest one."""
    name = regions(mask)
    if not mask.any():
        return mask
    best = int(np.argmax(np.bincount(name[mask])))
    if np.isfinite(middle).all():
        at = np.floor((middle - raster.low) / raster.pixel).astype(int)
        if mask[tuple(at)]:
            best = name[tuple(at)]
    return name == best
