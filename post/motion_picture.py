# SPDX-License-Identifier: MIT
"""Motion of the bodies: displacement and velocity gauges, or what the dumps show."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from post.compare import Reference
from post.gauges import Gauge, list_gauges
from post.labels import note
from post.reader import Run
from post.reference_lines import draw_references
from post.style import CYCLE, Picture, legend_above, new_figure, save
from post.units import scale_for, show


def draw_motion(run: Run, references: list[Reference], folder: Path) -> Picture | None:
    """Displacement and velocity gauges of the bodies; None if there is nothing to draw."""
    gauges = [g for g in list_gauges(run) if g.quantity.startswith(("displacement", "velocity"))]
    gauges = [g for g in gauges if g.body]
    groups = [
        [g for g in gauges if g.quantity.startswith(kind)] for kind in ("displacement", "velocity")
    ]
    if not groups[0] and any(frame.solid_path for frame in run.frames):
        return _draw_dumped_motion(run, folder)
    groups = [group for group in groups if group]
    if not groups or not len(run.gauges):
        return None
    figure, axes = new_figure(len(groups), 2.7, sharex=True, squeeze=False)
    texts = []
    for axis, group in zip(axes[:, 0], groups, strict=True):
        texts += _draw_motions(axis, run, group, references)
    unit = scale_for(run.gauges.time, "s")[1]
    axes[-1, 0].set_xlabel(f"time [{unit}]")
    return Picture(save(figure, folder / "motion.png"), "Motion of the bodies", " ".join(texts))


def _draw_motions(axis, run: Run, group: list[Gauge], references: list[Reference]) -> list[str]:
    """Gauges of one kind in one panel; returns a sentence for each."""
    time, texts = run.gauges.time, []
    tf, _ = scale_for(time, "s")
    vf, vu = scale_for(np.concatenate([run.gauges[g.column] for g in group]), group[0].unit)
    kind = group[0].quantity.split("_")[0]
    for i, gauge in enumerate(group):
        values, color = run.gauges[gauge.column], CYCLE[i % len(CYCLE)]
        direction = gauge.quantity.split("_")[-1]
        axis.plot(
            time / tf, values / vf, color=color, label=f"{gauge.id}: {kind} along {direction}"
        )
        if not np.isfinite(values).all():
            texts.append(f"{gauge.id} holds values that are not finite.")
            continue
        top = int(np.argmax(np.abs(values)))
        text = f"{show(values[top], gauge.unit)} at {show(time[top], 's')}"
        axis.plot(time[top] / tf, values[top] / vf, "o", color=color, ms=4.5)
        note(axis, text, (time[top] / tf, values[top] / vf), color=color)
        texts.append(f"Largest {kind} of {gauge.id}: {text}.")
    for gauge in group:
        draw_references(axis, gauge, references, (tf, vf))
    axis.set_ylabel(f"{kind} [{vu}]")
    axis.set_title(kind.capitalize())
    axis.set_xlim(time[0] / tf, time[-1] / tf)
    axis.margins(y=0.12)
    legend_above(axis)
    return texts


def _draw_dumped_motion(run: Run, folder: Path) -> Picture:
    """Without a displacement gauge: the particle that moved farthest, from the dumps."""
    frames = [frame for frame in run.frames if frame.solid_path]
    last = frames[-1].solid("displacement", "id").field
    row = int(np.argmax(np.linalg.norm(last["displacement"], axis=1)))
    number = last["id"][row]
    time = np.array([frame.time for frame in frames])
    move = np.array([frame.solid("displacement").field["displacement"][row] for frame in frames])
    figure, axis = new_figure(1, 3.0)
    tf, tu = scale_for(time, "s")
    vf, vu = scale_for(move, "m")
    for d, name in enumerate("xyz"):
        axis.plot(time / tf, move[:, d] / vf, "o-", ms=3.5, label=f"along {name}")
    axis.set_xlabel(f"time [{tu}]")
    axis.set_ylabel(f"displacement [{vu}]")
    axis.set_title(f"Displacement of particle {number}")
    axis.legend()
    caption = f"Particle {number}, which is displaced farthest at the end; one mark per dump."
    return Picture(save(figure, folder / "motion.png"), "Motion of the bodies", caption)
