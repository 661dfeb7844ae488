# SPDX-License-Identifier: MIT
"""The results of a run that are asked for first, each as one number with a name and a unit.

`results(run)` gives them all; the report and the comparison show them, studies and certificates
take them by name. docs/manual/results.md says how each is measured.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from post.balance import TOTALS, total_of, whole_factor
from post.blast import Pulse
from post.certificate import interval_text, read_certificate
from post.cracks import (
    LIMIT,
    WHOLE,
    circumferential_cracks,
    damaged_share,
    radial_cracks,
    rings_of,
)
from post.crater import face_loss
from post.damage import WORDS, damaged_volumes
from post.deck import Body
from post.deflection import measure_deflection
from post.energies import material_energies
from post.errors import PostError
from post.face import face_map, thin_faces
from post.gauges import PRESSURES, Gauge, list_gauges, measure
from post.impact import Cloud, Outcome, Shot, measure_shot, shots_of
from post.perforation import LEAST, Plate, load_plate, measure_perforation
from post.reader import Frame, Run
from post.tables import Table
from post.units import show

SCENE = ("shot", "hole", "crater", "damage", "cracks")  # groups beside gauges and sums

OF_BODY = ("velocity_x", "velocity_y", "velocity_z", "damage_mean")  # at the end of a run
KINK = 0.02  # of a peak: neighbours that are lower are not on the same parabola


@dataclass(frozen=True)
class Result:
    """One number of a run, in SI units; not a number where the run does not tell."""

    name: str  # subject and quantity: 'rod residual_velocity', 'mid:displacement_z peak'
    value: float
    unit: str
    group: str  # 'gauge', 'energy', 'body', 'material' or one of `SCENE`
    remark: str = ""


def results(run: Run, groups: tuple[str, ...] | None = None) -> list[Result]:
    """All results of a run, or those of some groups; what cannot be measured is left out."""
    found: list[Result] = []
    for kinds, make in MAKERS:
        if groups and not set(kinds) & set(groups):
            continue
        try:
            found += [one for one in make(run) if not groups or one.group in groups]
        except (PostError, StopIteration):
            continue  # the run has no such file
    return list({one.name: one for one in found}.values())


def _of_gauges(run: Run) -> Iterator[Result]:
    for gauge in list_gauges(run):
        values = run.gauges[gauge.column]
        if not np.isfinite(values).all() or not len(values):
            continue
        if gauge.quantity in PRESSURES and not gauge.body:
            yield from _of_pulse(run, gauge)
        elif gauge.quantity.startswith("displacement"):
            yield from _of_displacement(run, gauge)
        else:
            top = int(np.argmax(np.abs(values)))
            yield Result(f"{gauge.column} peak", float(values[top]), gauge.unit, "gauge")
            yield Result(f"{gauge.column} end", float(values[-1]), gauge.unit, "gauge")


def _of_pulse(run: Run, gauge: Gauge) -> Iterator[Result]:
    pulse: Pulse = measure(run, gauge)
    remark = "" if pulse.complete else pulse.remark
    for name, unit in (("arrival", "s"), ("peak", "Pa"), ("duration", "s"), ("impulse", "Pa s")):
        value = getattr(pulse, name)
        if name == "peak" and pulse.reached:
            value = vertex(run.gauges.time, run.gauges[gauge.column])[1]
            value -= pulse.ambient if gauge.quantity == "pressure" else 0.0
        yield Result(f"{gauge.column} {name}", value, unit, "gauge", remark)


def _of_displacement(run: Run, gauge: Gauge) -> Iterator[Result]:
    time, move = run.gauges.time, run.gauges[gauge.column]
    found = measure_deflection(time, move)
    # the side to which it goes first: what swings to both sides alike has no largest one
    first = int(np.argmax(np.abs(move) >= 0.5 * np.abs(move).max()))
    sign = math.copysign(1.0, move[first])
    when, peak = vertex(time, sign * move)
    remark = "still growing" if found.growing else ""
    yield Result(f"{gauge.column} peak", sign * peak, "m", "gauge", remark)
    yield Result(f"{gauge.column} peak_time", when, "s", "gauge", remark)
    yield Result(f"{gauge.column} end", found.end, "m", "gauge")
    ringing = f"± {show(found.spread, 'm')} of ringing" if math.isfinite(found.spread) else ""
    yield Result(f"{gauge.column} permanent_set", found.permanent, "m", "gauge", ringing)


def vertex(time: np.ndarray, values: np.ndarray) -> tuple[float, float]:
    """Time [s] and size of the largest of some values, by the parabola through three samples: a
    sampled peak lies anywhere within a step. The sample itself where a neighbour is more than
    `KINK` lower: no parabola is seen there, and one through a front would be far too high.
    """
    i = int(np.argmax(values))
    t, v = float(time[i]), float(values[i])
    if not 0 < i < len(values) - 1:
        return t, v
    a, b = values[i - 1], values[i + 1]
    bend = a - 2 * v + b
    if bend >= 0 or v - min(a, b) > KINK * abs(v):
        return t, v
    s = 0.5 * (a - b) / bend
    return float(t + 0.5 * s * (time[i + 1] - time[i - 1])), float(v - 0.25 * (a - b) * s)


def _of_energies(run: Run) -> Iterator[Result]:
    history = run.energy
    for names, _ in TOTALS:
        values = total_of(history, names)
        unit = "N s" if names[0].startswith("impulse") else "J"
        factor = whole_factor(run, names[0], unit)
        if values is None or not factor or not np.any(values != 0):
            continue
        top = int(np.argmax(np.abs(values)))
        yield Result(f"energy {names[0]} peak", factor * float(values[top]), unit, "energy")
        yield Result(f"energy {names[0]} end", factor * float(values[-1]), unit, "energy")


def _of_bodies(run: Run) -> Iterator[Result]:
    history = run.bodies
    for body in history.owners():
        for quantity in OF_BODY:
            name = f"{body}:{quantity}"
            if name in history and np.any(history[name] != 0):
                value, unit = float(history[name][-1]), history.unit(name)
                yield Result(f"{body} {quantity}", value, unit, "body")


def _of_materials(run: Run) -> Iterator[Result]:
    for name, one in material_energies(run).items():
        for kind in ("kinetic", "internal"):
            values = getattr(one, kind)
            if len(values) and np.any(values != 0):
                top = float(np.max(values))
                yield Result(f"{name} {kind} peak", top, "J", "material")
                yield Result(f"{name} {kind} end", float(values[-1]), "J", "material")


def _of_shots(run: Run) -> Iterator[Result]:
    for shot in shots_of(run):
        try:
            outcome = measure_shot(run, shot)
        except PostError:
            continue
        yield from _of_outcome(shot, outcome)


def _of_outcome(shot: Shot, found: Outcome) -> Iterator[Result]:
    rod, plate = shot.projectile.id, shot.target.id
    what = {"perforated": "residual_velocity"}.get(found.verdict, "velocity_now")
    yield Result(f"{rod} {what}", found.velocity, "m/s", "shot", found.verdict)
    yield Result(f"{rod} main_mass", found.mass, "kg", "shot")
    if found.plug is not None:
        along = float(found.plug.velocity @ shot.direction)
        speed = max(found.plug.speed, 1e-300)
        angle = math.degrees(math.acos(min(max(along / speed, -1.0), 1.0)))
        yield Result(f"{plate} plug_mass", found.plug.mass, "kg", "shot")
        yield Result(f"{plate} plug_velocity", along, "m/s", "shot", f"{angle:.0f} deg to the shot")
        yield Result(f"{plate} plug_angle", math.radians(angle), "rad", "shot")
    for name, cloud in (("debris", found.behind), ("ejecta", found.before)):
        yield from _of_cloud(f"{plate} {name}", cloud)


def _of_cloud(name: str, cloud: Cloud) -> Iterator[Result]:
    if cloud.mass == 0:
        return
    remark = f"{cloud.pieces} pieces, {100 * cloud.dust:.0f} % of it dust"
    yield Result(f"{name}_mass", cloud.mass, "kg", "shot", remark)
    yield Result(f"{name}_velocity", cloud.velocity, "m/s", "shot", "momentum over mass")
    yield Result(f"{name}_angle", cloud.half_angle, "rad", "shot", "half of the mass within")


def last_solid(run: Run) -> Frame:
    """The last dump of the bodies. PostError without one."""
    frame = next((f for f in reversed(run.frames) if f.solid_path), None)
    if frame is None:
        raise PostError(f"{run.folder}: there are no dumps of the solid")
    return frame


def struck_sides(run: Run, body: Body) -> dict[int, str]:
    """'front' and 'rear' of a plate by what strikes it; 'low' and 'high' where that is not told.

    Front is the face that a shot meets first, or that looks at the only charge.
    """
    normal = int(np.argmin(body.high - body.low))
    for shot in shots_of(run):
        if shot.target.id == body.id:
            return {shot.side: "front", -shot.side: "rear"}
    places = [group.get("at") for group in run.deck.groups("charge")]
    places += [g.get("at") for g in run.deck.groups("load") if g.get("mass") is not None]
    if len(places) == 1 and places[0] is not None:
        side = 1 if places[0][normal] > (body.low + body.high)[normal] / 2 else -1
        return {side: "front", -side: "rear"}
    return {-1: "low", 1: "high"}


def _of_plates(run: Run) -> Iterator[Result]:
    frame = last_solid(run)
    for body in run.deck.bodies():
        if body.shape != "box":
            continue
        try:
            plate = load_plate(run, frame, body.id)
        except PostError:
            continue  # on no lattice
        sides = struck_sides(run, body)
        three = int(run.deck.get("run", "dimension", 3)) == 3
        if three and not plate.stays.all():
            yield from _of_holes(plate, sides)
        for side, name in sides.items():
            yield from _of_face(plate, side, name, three)
            if three:
                yield from _of_cracks(run, frame, body.id, (side, name))


def _of_holes(plate: Plate, sides: dict[int, str]) -> Iterator[Result]:
    found = measure_perforation(plate).widest
    if found.through.seen.diameter <= LEAST * plate.body.spacing:
        return
    yield Result(f"{plate.body.id} hole", found.through.seen.diameter, "m", "hole")
    for side, name in sides.items():
        layer = found.layers[0 if side < 0 else -1]
        yield Result(f"{plate.body.id} hole_{name}", layer.seen.diameter, "m", "hole")


def _of_face(plate: Plate, side: int, name: str, three: bool) -> Iterator[Result]:
    """What a face has lost; in the plane its depth alone, as there are no circles."""
    what = {"front": "crater", "rear": "spall"}.get(name, f"crater_{name}")
    loss = face_loss(plate, side)
    if loss.area == 0:
        return
    remark = "goes through" if loss.through else ""
    head = f"{plate.body.id} {what}"
    yield Result(f"{head}_depth", loss.depth, "m", "crater", remark)
    if three:
        yield Result(f"{head}_diameter", loss.diameter, "m", "crater", remark)
        yield Result(f"{head}_volume", loss.volume, "m3", "crater", remark)


def _of_cracks(run: Run, frame: Frame, body: str, which: tuple[int, str]) -> Iterator[Result]:
    side, name = which
    tensile = frame.solid("damage_tension", lacking=True).field.get("damage_tension")
    if tensile is None or not (tensile > LIMIT).any():
        return  # no material that cracks
    low, high = thin_faces(run, body)
    one = face_map(run, frame, body, low if side < 0 else high)
    share = damaged_share(one)
    if share == 0:
        return
    if share > WHOLE:
        for kind in ("radial", "circumferential"):
            head = f"{body} cracks_{kind}_{name}"
            yield Result(head, math.nan, "-", "cracks", "whole face damaged")
        return
    radial, around = radial_cracks(one, rings_of(one)), circumferential_cracks(one)
    for kind, counts in (("radial", radial), ("circumferential", around)):
        remark = f"{counts.min()} to {counts.max()}"
        head = f"{body} cracks_{kind}_{name}"
        yield Result(head, float(np.median(counts)), "-", "cracks", remark)


def _of_damage(run: Run) -> Iterator[Result]:
    frame = last_solid(run)
    for body in run.deck.bodies():
        for kind, volume in damaged_volumes(run, frame, body.id).items():
            yield Result(f"{body.id} {kind}_volume", volume, "m3", "damage", WORDS[kind])


MAKERS: tuple[tuple[tuple[str, ...], Callable[[Run], Iterator[Result]]], ...] = (
    (("gauge",), _of_gauges),
    (("energy",), _of_energies),
    (("body",), _of_bodies),
    (("material",), _of_materials),
    (("shot",), _of_shots),
    (("hole", "crater", "cracks"), _of_plates),
    (("damage",), _of_damage),
)


def results_table(run: Run) -> Table:
    """What is asked for first of what happened to the bodies, for the report and the terminal."""
    known = read_certificate(run.folder)
    rows = []
    for one in results(run, SCENE):
        wide = interval_text(known[one.name]) if one.name in known else ""
        remark = "; ".join(text for text in (wide, one.remark) if text)
        rows.append((one.name.replace("_", " "), text_of(one), remark))
    note = (
        "Of the whole scene, at the last dump. Loose: what no longer hangs together with the "
        "largest piece of a body, or of its part where it was several at the start. Crater, spall: "
        "what is missing from the unloaded face inwards, loose matter away. Angles are those to "
        "the shot. How each is measured: the manual, Results."
    )
    return Table("Results", ("what", "value", ""), rows, note)


def text_of(one: Result) -> str:
    """A result with its unit for people."""
    if one.unit == "rad":
        return f"{math.degrees(one.value):.3g} deg"
    if one.unit == "m3":
        return f"{1e6 * one.value:.3g} cm3"
    if one.unit == "kg" and abs(one.value) < 0.1:
        return f"{1e3 * one.value:.3g} g"
    return show(one.value, one.unit)


def material_table(run: Run) -> Table:
    """Energies of each material at the end and at their largest, of the whole scene."""
    rows = []
    try:
        energies = material_energies(run)
    except PostError:
        energies = {}
    for name, one in energies.items():
        if not len(one.time) or not np.any(one.total != 0):
            continue
        cells = [show(float(v), "J") for part in (one.kinetic, one.internal)
                 for v in (part.max(), part[-1])]  # fmt: skip
        rows.append((name, *cells))
    heads = ("material", "kinetic, largest", "at the end", "internal, largest", "at the end")
    note = "Of the whole scene, mirror images included. Internal: elastic and what was spent."
    return Table("Energies by material", heads, rows, note)
