# SPDX-License-Identifier: MIT
"""The figures of the paper, drawn from runs: histories with its numbers, energies by material."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from post.energies import energy_of, material_energies
from post.errors import PostError
from post.face import draw_faces, face_map
from post.gauges import expect, list_gauges
from post.paper_measures import Printed, resolution
from post.reader import Run
from post.section import draw_sheet
from post.style import CYCLE, GREY, Picture, legend_above, new_figure, save
from post.units import scale_for, show

Curve = tuple[str, np.ndarray, np.ndarray]  # label, times [s], values


def label_of(run: Run) -> str:
    """'slab_2, 6 mm, cells 12 mm': the finest spacing stands for all."""
    finest = min(body.spacing for body in run.deck.bodies())
    cells = resolution(run)[1]
    text = f"{run.job}, {1e3 * finest:.3g} mm"
    return text if cells == "–" else f"{text}, cells {cells}"


def gauge_curves(
    runs: list[Run], column: str, less: float = 0.0, factor: float = 1.0
) -> list[Curve]:
    """A gauge in all runs that have it, less a value and times a factor."""
    found = []
    for run in runs:
        history = run.history("gauges")
        if history is not None and column in history:
            found.append((label_of(run), history.time, factor * (history[column] - less)))
    return found


def draw_curves(
    panels: list[tuple[str, str, list[Curve], list[tuple[str, float]]]], path: Path, title: str
) -> Picture | None:
    """Panels (title, unit, curves, levels of the paper) above each other; None without curves."""
    panels = [panel for panel in panels if panel[2]]
    if not panels:
        return None
    figure, axes = new_figure(len(panels), 2.5, sharex=True, squeeze=False)
    names = list(dict.fromkeys(label for _, _, curves, _ in panels for label, _, _ in curves))
    tf, tu = scale_for(np.concatenate([c[1] for p in panels for c in p[2]]), "s")
    for axis, (name, unit, curves, levels) in zip(axes[:, 0], panels, strict=True):
        every = [c[2] for c in curves] + [np.array([level for _, level in levels])]
        factor, shown = scale_for(np.concatenate(every), unit)
        for label, time, values in curves:
            colour = CYCLE[names.index(label) % len(CYCLE)]
            axis.plot(time / tf, values / factor, color=colour, label=label)
        for text, level in levels:
            axis.axhline(level / factor, color=GREY, ls="--", lw=1)
            axis.annotate(
                text, (1, level / factor), xycoords=("axes fraction", "data"), fontsize=7.5,
                ha="right", va="bottom", color=GREY,
            )  # fmt: skip
        axis.set_title(name)
        axis.set_ylabel(f"[{shown}]")
        axis.margins(x=0)
        legend_above(axis)
    axes[-1, 0].set_xlabel(f"time [{tu}]")
    caption = "; ".join(name for name, *_ in panels)
    return Picture(save(figure, path), title, f"{caption}. Dashed: the paper, or what is named.")


def levels_of(printed: list[Printed], measures: tuple[str, ...], case: str = "") -> list:
    """What the paper prints for some measures, as lines in a picture."""
    return [
        (f"{one.case}: paper {show(one.value, one.unit)}", one.value)
        for one in printed
        if one.measure in measures and case in ("", one.case)
    ]


def reflected_level(runs: list[Run]) -> list[tuple[str, float]]:
    """Reflected peak of Kingery-Bulmash at gauge A."""
    for run in runs:
        for gauge in list_gauges(run):
            found = expect(run.deck, gauge) if gauge.id == "A" else None
            if found is not None:
                return [(f"Kingery-Bulmash {show(found.peak, 'Pa')}", found.peak)]
    return []


def draw_material_energies(runs: list[Run], path: Path, title: str) -> Picture | None:
    """Kinetic and internal energy of each material, a panel for each run."""
    panels = []
    for run in runs:
        if run.history("bodies") is None or not len(run.bodies):
            continue
        panels.append((run, material_energies(run)))
    if not panels:
        return None
    figure, axes = new_figure(len(panels), 2.3, sharex=True, squeeze=False)
    names = list(dict.fromkeys(name for _, found in panels for name in found))
    tf, tu = scale_for(np.concatenate([run.bodies.time for run, _ in panels]), "s")
    for axis, (run, found) in zip(axes[:, 0], panels, strict=True):
        for name, one in found.items():
            colour = CYCLE[names.index(name) % len(CYCLE)]
            axis.plot(one.time / tf, one.kinetic, color=colour, label=f"{name}, kinetic")
            axis.plot(one.time / tf, one.internal, "--", color=colour, label=f"{name}, internal")
        axis.set_title(label_of(run))
        axis.set_ylabel("energy [J]")
        axis.margins(x=0)
        axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), handlelength=1.6)
    axes[-1, 0].set_xlabel(f"time [{tu}]")
    caption = (
        "Energies of the whole scene by material: kinetic (full lines) and internal (dashed; "
        "elastic energy and what was spent)."
    )
    return Picture(save(figure, path), title, caption)


def draw_stress(run: Run, body: str, times: tuple[float, ...], path: Path) -> Picture | None:
    """Von Mises stress on both faces of a body at the dumps nearest to some times [s]."""
    frames = [frame for frame in run.frames if frame.solid_path]
    chosen = [min(frames, key=lambda f, t=t: abs(f.time - t)) for t in times if t <= run.end * 1.01]
    chosen = list({frame.number: frame for frame in chosen}.values())
    try:
        maps = [face_map(run, frame, body, face, "von_mises") for frame in chosen
                for face in ("z-", "z+")]  # fmt: skip
    except PostError:
        return None
    if not maps:
        return None
    picture = draw_faces(maps, path, [label_of(run)] * len(maps))
    return Picture(picture.path, f"Stress in {body}, {run.job}", picture.caption)


def draw_fragment_speeds(runs: list[Run], path: Path, levels: list) -> Picture | None:
    """Velocity of the mass centre of each fragment along z."""
    curves: list[Curve] = []
    for run in runs:
        history = run.history("bodies")
        for body in history.owners() if history is not None else []:
            name = f"{body}:velocity_z"
            if body.startswith("f") and body[1:].isdigit() and name in history:
                curves.append((f"{label_of(run)}: {body}", history.time, history[name]))
    return draw_curves([("Velocity of the fragments along z", "m/s", curves, levels)], path,
                       "Velocities of the fragments")  # fmt: skip


def draw_story(run: Run, folder: Path, name: str, title: str) -> Picture | None:
    """The cut at five times (`section.draw_sheet`) under a name of its own."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{name}.png"
    with TemporaryDirectory(dir=folder) as own:  # others draw theirs at the same time
        picture = _tried(lambda: draw_sheet(run, Path(own)))
        if picture is None:
            return None
        picture.path.replace(path)
    return Picture(path, title, f"{label_of(run)}. {picture.caption}")


def _tried(draw: Callable[[], Picture]) -> Picture | None:
    try:
        return draw()
    except (PostError, ValueError, LookupError):
        return None


def draw_slab_energy(runs: list[Run], path: Path) -> Picture | None:
    """Kinetic energy of the slab alone (cfrp, concrete, bars), with and without fragments."""
    curves: list[Curve] = []
    for run in runs:
        try:
            one = energy_of(run, ["cfrp", "concrete", "bars_x", "bars_y"])
        except PostError:
            continue
        curves.append((label_of(run), one.time, one.kinetic))
    found = draw_curves([("Kinetic energy of the slab, whole", "J", curves, [])], path,
                        "Kinetic energy of the slab")  # fmt: skip
    return found
