# SPDX-License-Identifier: MIT
"""Where THOR applies to a shot: a compact steel fragment on a plate of mild steel."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from post.compare import Comparison
from post.deck import AXES, Body, Deck
from post.errors import PostError
from post.impact import Shot, find_shots, measure_shot
from post.reader import Run
from post.reference_curves import GRAIN, constants, thor, thor_limit
from post.style import BLUE, GREEN, GREY, Picture, new_figure, save
from post.units import scale_for, show

STEEL = (7600.0, 8100.0), (70e9, 85e9)  # density [kg/m3] and shear modulus [Pa] of a steel
MILD = 200e6, 320e6  # first yield of mild steel, at rest [Pa]
COMPACT = 2.0  # longest side over shortest of a fragment


@dataclass(frozen=True)
class FragmentShot:
    """A shot to which THOR applies, in SI units."""

    shot: Shot
    mass: float  # of the fragment [kg]
    area: float  # of the fragment as the plate sees it [m2]
    thickness: float  # of the plate [m]
    angle: float  # of the shot to the normal of the plate [rad]

    def residual(self, velocity) -> np.ndarray:
        """Residual velocity [m/s] by THOR; `velocity` [m/s] of any shape."""
        return thor(velocity, self.mass, self.area, self.thickness, self.angle)

    @property
    def limit(self) -> float:
        """Velocity at which THOR leaves nothing [m/s]."""
        return thor_limit(self.mass, self.area, self.thickness, self.angle)

    @property
    def label(self) -> str:
        """'THOR (quoted from memory), 1.16 g on 6 mm'."""
        return f"{LABEL}, {1e3 * self.mass:.3g} g on {1e3 * self.thickness:.3g} mm"


LABEL = "THOR (quoted from memory)"


def fragment_shots(deck: Deck) -> list[FragmentShot]:
    """The shots of a deck within the range of THOR for mild steel: in space, a box, ball or
    cylinder of steel without a bore that is compact, on a box of mild steel, and of a mass as those
    of its tests.
    """
    found = []
    low, high = (GRAIN * one for one in constants("thor_mild_steel")["mass_grains"])
    for shot in find_shots(deck) if int(deck.get("run", "dimension", 3)) == 3 else []:
        law = _law(deck, shot.projectile)
        solid = _solid(deck, shot.projectile)
        if solid is None or not _is_steel(law) or not _is_mild(_law(deck, shot.target)):
            continue
        volume, sides, area = solid(shot.direction)
        mass = volume * float(law["density"])
        if not low <= mass <= high or max(sides) > COMPACT * min(sides):
            continue
        thickness = float((shot.target.high - shot.target.low)[shot.normal])
        angle = math.acos(min(abs(float(shot.direction[shot.normal])), 1.0))
        found.append(FragmentShot(shot, mass, area, thickness, angle))
    return found


def _law(deck: Deck, body: Body) -> dict:
    return next((g for g in deck.groups("material") if g.get("id") == body.material), {})


def _is_steel(law: dict) -> bool:
    """Whether density and stiffness are those of a steel."""
    shear = law.get("shear_modulus")
    if shear is None and law.get("youngs_modulus") is not None:
        shear = float(law["youngs_modulus"]) / (2 + 2 * float(law.get("poisson_ratio") or 0.0))
    values = float(law.get("density") or 0.0), float(shear or 0.0)
    return all(a <= v <= b for v, (a, b) in zip(values, STEEL, strict=True))


def _is_mild(law: dict) -> bool:
    """Whether it is a steel that first yields as mild steel does."""
    first = law.get("a") if law.get("model") == "johnson_cook" else law.get("yield_stress")
    return _is_steel(law) and first is not None and MILD[0] <= float(first) <= MILD[1]


def _solid(deck: Deck, body: Body):
    """A function that gives the volume of a body [m3], its sides (2 or 3) [m] and the area of its
    shadow along a unit vector [m2]; None for what is no box, ball or cylinder. A body on a plane of
    symmetry is one with its image.
    """
    group = deck.groups("body")[body.number - 1]
    cut = np.array(deck.mirrors) & (body.low >= 0) & (body.low < body.spacing / 2)
    sides = body.high - np.where(cut, -body.high, body.low)
    axis = AXES.index(group.get("axis") or "z")
    radius, length = float(group.get("radius") or 0.0), float(group.get("length") or 0.0)
    if group.get("file") or group.get("inner_radius"):
        return None
    if body.shape == "box":
        faces = sides.prod() / sides
        return lambda way: (float(sides.prod()), sides, float(np.abs(way) @ faces))
    if body.shape == "sphere":
        ball = 4 / 3 * math.pi * radius**3
        return lambda way: (ball, (2 * radius,), math.pi * radius**2)
    if body.shape == "cylinder":
        disc = math.pi * radius**2

        def cylinder(way):
            along = min(abs(float(way[axis])), 1.0)
            shadow = disc * along + 2 * radius * length * math.sqrt(1 - along**2)
            return disc * length, (2 * radius, length), shadow

        return cylinder
    return None


def fragment_rows(run: Run) -> list[Comparison]:
    """The residual velocity of each shot within the range of THOR beside it; not a number as
    measured while the fragment is neither through nor at rest.
    """
    rows = []
    for one in fragment_shots(run.deck):
        left = float(one.residual(one.shot.speed))
        limit = f"limit {show(one.limit, 'm/s')}"
        rows.append(
            Comparison("residual velocity", one.shot.projectile.id, _measured(run, one.shot),
                       left, "m/s", f"{one.label}, {limit}")
        )  # fmt: skip
    return rows


def _measured(run: Run, shot: Shot) -> float:
    """Residual velocity of a shot [m/s]; 0 where it was stopped or came back."""
    try:
        found = measure_shot(run, shot)
    except PostError:
        return math.nan
    known = {"perforated": found.velocity, "stopped": 0.0, "rebounded": 0.0}
    return known.get(found.verdict, math.nan)


def draw_fragments(run: Run, folder: Path) -> Picture | None:
    """THOR's residual velocity over the striking velocity, and what the run has; None where it
    does not apply.
    """
    shots = fragment_shots(run.deck)
    if not shots:
        return None
    figure, axis = new_figure(1, 3.4)
    top = max(2 * one.limit if one.shot.speed < one.limit else 1.5 * one.shot.speed
              for one in shots)  # fmt: skip
    factor, unit = scale_for(np.array([top]), "m/s")
    texts = []
    for one, shade in zip(shots, (GREEN, GREY, BLUE), strict=False):
        draw_thor(axis, one, (0.0, top), (factor, factor), shade)
        v = _measured(run, one.shot)
        name = one.shot.projectile.id
        if math.isfinite(v):
            axis.plot(one.shot.speed / factor, v / factor, "o", color=BLUE, ms=6, label=name)
            said = f"{show(v, 'm/s')} are left"
        else:
            axis.axvline(one.shot.speed / factor, color=BLUE, lw=1, ls=":", label=name)
            said = "it is neither through nor at rest"
        left = show(float(one.residual(one.shot.speed)), "m/s")
        texts.append(f"{name}, {show(one.shot.speed, 'm/s')}: {said}, by THOR {left}.")
    axis.plot([0, top / factor], [0, top / factor], color=GREY, lw=0.9, ls=":",
              label="nothing lost")  # fmt: skip
    axis.set_xlim(0, top / factor)
    axis.set_ylim(-0.03 * top / factor, top / factor)
    axis.set_xlabel(f"striking velocity [{unit}]")
    axis.set_ylabel(f"residual velocity [{unit}]")
    axis.legend(loc="upper left")
    about = constants("thor_mild_steel")
    caption = (
        f"Compact steel fragments on mild steel: {about['source']}; not verified: quoted from "
        "memory. Area: that which the plate sees along the shot. " + " ".join(texts)
    )
    return Picture(save(figure, folder / "thor.png"), "Residual velocity and THOR", caption)


def draw_thor(axis, one: FragmentShot, ends: tuple, scale: tuple, color: str = GREY) -> None:
    """THOR's curve between two striking velocities [m/s], named in the legend; `scale` is that of
    the two axes.
    """
    grid = np.linspace(*ends, 200)
    xf, yf = scale
    name = f"{one.label}: limit {show(one.limit, 'm/s')}"
    axis.plot(grid / xf, one.residual(grid) / yf, color=color, lw=1.2, ls="--", label=name)


def fragment_shot_of(folder: Path) -> FragmentShot | None:
    """The only shot within the range of THOR of a run whose deck lies in a folder, or None."""
    try:
        shots = fragment_shots(Run(folder).deck)
    except PostError:
        return None
    return shots[0] if len(shots) == 1 else None
