# SPDX-License-Identifier: MIT
"""Several runs in one picture: histories over each other, faces beside each other in one scale."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from post.balance import total_of, whole_factor
from post.errors import PostError
from post.face import FaceMap, draw_faces, face_map, thin_faces
from post.gauges import PRESSURES
from post.reader import Frame, Run
from post.scene import LITTLE_DAMAGE
from post.side_by_side import common_gauges
from post.style import CYCLE, Picture, new_figure, save
from post.units import scale_for

PER_PICTURE = 4  # panels
LINES = ("-", "--", "-.", ":")
TOTALS = (
    (("solid_kinetic",), "Kinetic energy of the bodies, whole", "J"),
    (("solid_internal",), "Internal energy of the bodies, whole", "J"),
    *(((f"impulse_{axis}",), f"Impulse of the air on the bodies, {axis}, whole", "N s")
      for axis in "xyz"),
)  # fmt: skip


@dataclass(frozen=True)
class Panel:
    """Curves of several runs for one quantity: run by run times [s] and values, or None."""

    title: str
    unit: str
    curves: list[tuple[np.ndarray, np.ndarray] | None]


def history_panels(runs: list[Run]) -> list[Panel]:
    """What is drawn over time: common gauges first, then energies and impulses of the whole."""
    panels = []
    for column in common_gauges(runs, lambda q: q.startswith(("displacement", "velocity"))):
        panels.append(_gauge_panel(runs, column))
    for column in common_gauges(runs, lambda q: q in PRESSURES):
        panels.append(_gauge_panel(runs, column))
    for names, title, unit in TOTALS:
        curves = [_total(run, names, unit) for run in runs]
        if any(curve is not None for curve in curves):
            panels.append(Panel(title, unit, curves))
    return panels


def _gauge_panel(runs: list[Run], column: str) -> Panel:
    curves, unit = [], "-"
    for run in runs:
        history = run.history("gauges")
        if history is None or column not in history:
            curves.append(None)
            continue
        unit = history.unit(column)
        curves.append((history.time, history[column]))
    name, _, quantity = column.partition(":")
    return Panel(f"{name}: {quantity.replace('_', ' along ')}", unit, curves)


def _total(run: Run, names: tuple[str, ...], unit: str):
    history = run.history("energy")
    values = None if history is None or not len(history) else total_of(history, names)
    factor = whole_factor(run, names[0], unit)
    if values is None or not factor or not np.any(values != 0):
        return None
    return history.time, factor * values


def draw_histories(runs: list[Run], names: list[str], folder: Path) -> list[Picture]:
    """The panels of `history_panels`, a colour for each run, as PNG files in a folder."""
    panels, pictures = history_panels(runs), []
    for start in range(0, len(panels), PER_PICTURE):
        group = panels[start : start + PER_PICTURE]
        figure, axes = new_figure(len(group), 2.3, sharex=True, squeeze=False)
        ends = [curve[0] for panel in group for curve in panel.curves if curve is not None]
        tf, tu = scale_for(np.concatenate(ends), "s")
        for axis, panel in zip(axes[:, 0], group, strict=True):
            _draw_panel(axis, panel, names, tf)
        axes[-1, 0].set_xlabel(f"time [{tu}]")
        handles = [axes[0, 0].plot([], [], **_look(i))[0] for i in range(len(names))]
        figure.legend(handles, names, loc="outside upper left", ncols=min(len(names), 4))
        number = start // PER_PICTURE + 1
        path = save(figure, folder / f"histories{'' if number == 1 else f'_{number}'}.png")
        what = "; ".join(panel.title for panel in group)
        pictures.append(Picture(path, "Histories", f"{what}. Runs: {', '.join(names)}."))
    return pictures


def _look(number: int) -> dict:
    return {"color": CYCLE[number % len(CYCLE)], "ls": LINES[number // len(CYCLE) % len(LINES)]}


def _draw_panel(axis, panel: Panel, names: list[str], tf: float) -> None:
    """Curves of one quantity."""
    every = np.concatenate([curve[1] for curve in panel.curves if curve is not None])
    factor, unit = scale_for(every, panel.unit)
    for number, curve in enumerate(panel.curves[: len(names)]):
        if curve is not None:
            axis.plot(curve[0] / tf, curve[1] / factor, **_look(number))
    axis.set_title(panel.title)
    axis.set_ylabel(f"[{unit}]")
    axis.margins(x=0)


def common_time(runs: list[Run], wanted: float | None = None) -> float:
    """A time [s] that all runs have reached: the wanted one, or the end of the shortest."""
    ends = [f.time for run in runs for f in _solid_frames(run)[-1:]]
    if not ends:
        raise PostError("none of the runs has dumps of the solid")
    if wanted is not None and wanted > min(ends) * (1 + 1e-6):
        raise PostError(f"--time {wanted:g}: the dumps of some run end at {min(ends):g} s", 2)
    return min(ends) if wanted is None else wanted


def _solid_frames(run: Run) -> list[Frame]:
    return [frame for frame in run.frames if frame.solid_path]


def compare_faces(
    runs: list[Run], body: str, field: str = "damage", time: float | None = None
) -> list[FaceMap]:
    """Maps of both faces of a body, run by run, at the dumps nearest to a common time.

    Runs without that body are left out. PostError if none has it.
    """
    when, maps = common_time(runs, time), []
    for run in runs:
        if body not in [one.id for one in run.deck.bodies()] or not _solid_frames(run):
            continue
        frame = min(_solid_frames(run), key=lambda f: abs(f.time - when))
        maps += [face_map(run, frame, body, face, field) for face in thin_faces(run, body)]
    if not maps:
        raise PostError(f"none of the runs has a body '{body}' with dumps", 2)
    return maps


def draw_face_comparison(
    runs: list[Run], names: list[str], body: str, folder: Path, time: float | None = None
) -> Picture:
    """Damage of both faces of a body in all runs that have it: one row for each, in one scale."""
    have = [any(one.id == body for one in run.deck.bodies()) for run in runs]
    titles = [name for name, there in zip(names, have, strict=True) if there for _ in range(2)]
    maps = compare_faces(runs, body, time=time)
    return draw_faces(maps, folder / f"face_{body}.png", titles)


def damaged_bodies(runs: list[Run], time: float | None = None) -> list[str]:
    """Boxes whose damage exceeds a little in some run at the common time, in order of the decks."""
    if not any(_solid_frames(run) for run in runs):
        return []
    when, found = common_time([run for run in runs if _solid_frames(run)], time), []
    for run in runs:
        frames = _solid_frames(run)
        if not frames:
            continue
        solid = min(frames, key=lambda f: abs(f.time - when)).solid("body", "damage")
        for body in run.deck.bodies():
            damage = solid.field["damage"][solid.field["body"] == body.number]
            if body.shape == "box" and (damage > LITTLE_DAMAGE).any():
                found.append(body.id)
    return list(dict.fromkeys(found))
