# SPDX-License-Identifier: MIT
"""A view of a run that turns and plays in a browser: one file, no server, no other file.

Shown are the particles on surfaces, in planes of symmetry and at cracks, thinned where they are
too many for the size of the file; the page says how many of how many. Numbers are packed as 16
bits.
"""

from __future__ import annotations

import base64
import json
import zlib
from dataclasses import dataclass
from html import escape
from pathlib import Path

import matplotlib as mpl
import numpy as np

from post.deck import Body
from post.errors import PostError
from post.reader import Frame, Run
from post.space import air_in, choose_cut
from post.style import DAMAGE, highest, pressure_colours
from post.surface import edges_of, find_lattice
from post.units import scale_for

TEMPLATE = Path(__file__).parent / "data" / "view.html"
LARGEST = 16e6  # bytes of a page of its own
IN_REPORT = 5e6  # of a view in a report
WIDTH = 6  # numbers of a particle at one time: place, speed, von Mises stress, damage
PACKED = 0.45  # bytes of a page for a byte of numbers, about: compressed, then as text
SHOWN = ("displacement", "velocity", "von_mises", "damage")
MOST_BODIES = 32  # that can be told apart
FULL = 65535
COVER = 0.75  # radius of a dot over the distance of the particles shown


@dataclass(frozen=True)
class Packed:
    """What a view shows: `about` as in the page, and the numbers before they are compressed."""

    about: dict
    numbers: bytes
    shown: int
    total: int


def make_view(run: Run, size: float = LARGEST) -> str:
    """The page of a view of at most `size` bytes. PostError without dumps of the solid."""
    packed, data = _fit(run, size - len(TEMPLATE.read_bytes()) - 20000)
    page = TEMPLATE.read_text(encoding="utf-8")
    about = json.dumps(packed.about).replace("</", "<\\/")
    page = page.replace("@TITLE@", escape(packed.about["title"])).replace("@ABOUT@", about)
    return page.replace("@DATA@", data)


def framed(page: str, name: str = "The scene") -> str:
    """A view inside another page."""
    style = "width:100%;height:600px;border:1px solid #dfe3e7"
    return (
        f"<h2>{escape(name)}, to turn and play</h2>"
        f'<iframe style="{style}" title="view" srcdoc="{escape(page)}"></iframe>'
        '<p class="note">Drag to turn, shift and drag to move, wheel to zoom, space to play.</p>'
    )


def _fit(run: Run, size: float) -> tuple[Packed, str]:
    """About as many particles as fit: their numbers, and these as text."""
    most = min(int(2e6), max(int(size / (PACKED * 2 * WIDTH * max(len(run.frames), 1))), 100))
    for _ in range(6):
        packed = pack(run, most)
        data = base64.b64encode(zlib.compress(packed.numbers, 6)).decode()
        if len(data) <= size:
            return packed, data
        most = int(0.9 * packed.shown * size / len(data))
    raise PostError("the view does not become small enough")


def pack(run: Run, most: int) -> Packed:
    """Choose at most `most` particles and pack what is shown of them."""
    frames = [frame for frame in run.frames if frame.solid_path]
    if not frames:
        raise PostError("there are no dumps of the solid, so there is no view")
    first = frames[0].solid("displacement", "body")
    bodies = run.deck.bodies()[:MOST_BODIES]
    seen = _on_surfaces(run, first, frames[-1], bodies)
    rows, share = _thinned(first.field["body"], seen, bodies, most)
    if not len(rows):
        raise PostError("the dumps hold no particles")
    rest = _finite((first.points - first.field["displacement"])[rows])
    dumps = [_read(frame, rows, rest) for frame in frames]
    low = np.min([rest.min(axis=0), *(d["place"].min(axis=0) for d in dumps)], axis=0)
    high = np.max([rest.max(axis=0), *(d["place"].max(axis=0) for d in dumps)], axis=0)
    size = np.maximum(high - low, 1e-9)
    tops = {name: max(highest(d[name]) for d in dumps) or 1.0 for name in ("speed", "von_mises")}
    parts, old = [_as_16_bits((rest - low) / size).tobytes()], np.zeros((WIDTH, len(rows)), "u2")
    for dump in dumps:
        place = _as_16_bits((dump["place"] - low) / size).T
        values = [dump["speed"] / tops["speed"], dump["von_mises"] / tops["von_mises"]]
        values = _as_16_bits(np.array([*values, dump["damage"]]))
        now = np.concatenate([place, values])
        parts.append((now - old).astype("<u2").tobytes())  # differences, modulo 65536
        old = now
    number = {body.number: k for k, body in enumerate(bodies)}
    which = np.array([number.get(int(b), len(bodies) - 1) for b in first.field["body"][rows]], "u1")
    parts.append(which.tobytes())
    air, sheets = _air(run, frames)
    parts += sheets
    about = {
        "title": run.deck.title or run.job,
        "said": _said(run, len(rows), int(seen.sum()), len(first.points)),
        "particles": len(rows),
        "total": len(first.points),
        "width": WIDTH,
        "times": [frame.time for frame in frames],
        "low": low.tolist(),
        "size": size.tolist(),
        "mirrors": list(run.deck.mirrors),
        "fields": _fields(dumps, rest, tops),
        "maps": {"damage": _hexes(DAMAGE), "values": _hexes(mpl.colormaps["viridis"]),
                 "blast": _hexes(_blast(air).cmap)},
        "bodies": [{"name": f"{b.id} ({b.material})", "radius": COVER * b.step.max() / share[k]}
                   for k, b in enumerate(bodies)],
        "air": air,
        **_camera(run, rest),
    }  # fmt: skip
    return Packed(about, b"".join(parts), len(rows), len(first.points))


def _finite(values: np.ndarray) -> np.ndarray:
    """The values, 0 where they are not finite."""
    return np.where(np.isfinite(values), values, 0.0)


def _as_16_bits(values: np.ndarray) -> np.ndarray:
    """Numbers from 0 to 1 as 0 to 65535."""
    return np.rint(FULL * np.clip(_finite(values), 0, 1)).astype("<u2")


def _read(frame: Frame, rows: np.ndarray, rest: np.ndarray) -> dict[str, np.ndarray]:
    """What is shown of one dump; zeros for what it lacks. What is nowhere stays at `rest`."""
    solid = frame.solid(*SHOWN, lacking=True)
    zeros = np.zeros(len(rows))
    velocity = solid.field.get("velocity")
    speed = zeros if velocity is None else np.linalg.norm(velocity[rows], axis=1)
    stress = solid.field.get("von_mises")
    return {
        "place": np.where(solid.known[rows, None], solid.points[rows], rest),
        "speed": _finite(speed),
        "von_mises": zeros if stress is None else _finite(stress[rows]),
        "damage": solid.field["damage"][rows] if "damage" in solid.field else zeros,
    }


def _on_surfaces(run: Run, first, last: Frame, bodies: list[Body]) -> np.ndarray:
    """Whether a particle is on a surface of its unloaded body or of a crack at the end, (n).

    Planes of symmetry count as surfaces: without mirror images one looks into the bodies there.
    """
    end = last.solid("id")
    points, known = end.points, first.known & end.known
    rest = first.points - first.field["displacement"]
    seen = np.zeros(len(rest), bool)
    for body in bodies:
        own = np.flatnonzero((first.field["body"] == body.number) & known)
        lattice = find_lattice(rest[own], body.step) if len(own) else None
        if lattice is None:
            seen[own] = True
            continue
        _, held = edges_of(points[own], lattice)
        for axis in range(int(run.deck.get("run", "dimension", 3))):
            for bare in held[axis]:
                seen[own] |= ~bare
    return seen


def _thinned(body: np.ndarray, seen: np.ndarray, bodies: list[Body], most: int):
    """Rows that are shown, and the share of the distances between them body by body, at most 1."""
    chance, wanted = np.random.default_rng(0), np.flatnonzero(seen)
    count = {b.number: int((body[wanted] == b.number).sum()) for b in bodies}
    small = sum(n for n in count.values() if n <= most / (2 * len(bodies)))
    large = sum(count.values()) - small
    part = min(1.0, max(most - small, 1) / large) if large else 1.0
    rows, share = [], []
    for b in bodies:
        own = wanted[body[wanted] == b.number]
        thin = 1.0 if count[b.number] <= most / (2 * len(bodies)) else part
        rows.append(own if thin == 1 else own[chance.random(len(own)) < thin])
        share.append(float(np.sqrt(thin)))
    return np.sort(np.concatenate(rows)), share


def _fields(dumps: list[dict], rest: np.ndarray, tops: dict) -> list[dict]:
    """What the colours may show: place in the record, largest value, unit and its factor."""
    moved = max(highest(np.linalg.norm(d["place"] - rest, axis=1)) for d in dumps) or 1.0
    rows = [
        ("damage", "-", 1.0, 2, "damage"),
        ("displacement", "m", moved, 3, "values"),
        ("speed", "m/s", tops["speed"], 0, "values"),
        ("von Mises stress", "Pa", tops["von_mises"], 1, "values"),
    ]
    found = []
    for name, unit, top, place, colours in rows:
        factor, shown = scale_for([top], unit)
        found.append({"name": name, "unit": shown, "scale": factor, "top": top, "place": place,
                      "stored": place < 3, "map": colours})  # fmt: skip
    return found


def _said(run: Run, shown: int, seen: int, total: int) -> str:
    text = f"{shown:,} of {total:,} particles: ".replace(",", " ")
    text += "those on surfaces, in planes of symmetry and at cracks"
    if shown < seen:
        text += f", {100 * shown / seen:.0f} % of them at random"
    if run.deck.images > 1:
        text += f"; 1/{run.deck.images} is modelled, the rest are mirror images"
    return text + ". Between dumps everything moves along straight lines."


def _camera(run: Run, rest: np.ndarray) -> dict:
    """Box of the whole unloaded scene, its middle and half of its diagonal."""
    low, high = rest.min(axis=0), rest.max(axis=0)
    low = np.where(run.deck.mirrors, -high, low)
    return {
        "box": [low.tolist(), high.tolist()],
        "middle": ((low + high) / 2).tolist(),
        "reach": float(np.linalg.norm(high - low) / 2),
    }


def _hexes(colours) -> str:
    """256 colours of a map, six hexadecimal digits each."""
    return "".join(f"{int(255.5 * v):02x}" for i in range(256) for v in colours(i / 255)[:3])


def _blast(air: dict | None):
    return pressure_colours(101325.0, 1e6) if air is None else pressure_colours(
        air["ambient"], air["high"])  # fmt: skip


def _air(run: Run, frames: list[Frame]) -> tuple[dict | None, list[bytes]]:
    """The pressure in the cut of the scene at each dump, as bytes: 0 where a cell holds solid."""
    grids = [frame.air("pressure", "solid") if frame.air_path else None for frame in frames]
    known = [grid for grid in grids if grid is not None]
    if len(known) < len(frames) or min(known[0].cells) < 2:
        return None, []
    cut = choose_cut(run.deck, known[0].cells)
    top = max(highest(grid.field["pressure"]) for grid in known[1:] or known)
    norm = pressure_colours(run.deck.ambient, top).norm
    sheets = []
    for grid in known:
        code = 1 + 254 * np.clip(norm(air_in(cut, grid, "pressure")).filled(0), 0, 1)
        code[air_in(cut, grid, "solid") > 0] = 0
        sheets.append(np.nan_to_num(code).astype("u1").tobytes())
    grid, unit = known[0], np.eye(3)
    size = grid.cells * grid.spacing
    origin = grid.low.copy()
    origin[cut.normal] = cut.level
    about = {
        "width": int(grid.cells[cut.across]),
        "height": int(grid.cells[cut.up]),
        "origin": origin.tolist(),
        "across": (size[cut.across] * unit[cut.across]).tolist(),
        "up": (size[cut.up] * unit[cut.up]).tolist(),
        "normal": cut.normal,
        "low": float(norm.vmin),
        "high": float(norm.vmax),
        "ambient": run.deck.ambient,
        "rest": (1 + 254 * float(norm(run.deck.ambient))) / 255,
        "map": "blast",
    }
    return about, sheets
