# SPDX-License-Identifier: MIT
"""A movie of a run: the cut of the contact sheet at every dump, with one scale for all."""

from __future__ import annotations

import subprocess
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from PIL import Image

from post.errors import PostError
from post.reader import Frame, Run
from post.section import (
    cut_air,
    cut_bodies,
    draw_air,
    draw_bodies,
    dress,
    range_of_strips,
    view_of,
)
from post.space import choose_cut
from post.style import (
    DAMAGE_COLOURS,
    GREY,
    WIDTH,
    highest,
    linear_bar,
    pressure_bar,
    pressure_colours,
)
from post.tints import Tints, tints_of
from post.units import scale_for

RATE = 6  # dumps a second
DOTS = 160  # per inch
LEFT_OUT = 1  # dumps at the start whose pressure, of a charge just burnt, is not in the scale


def make_movie(run: Run, path: Path | None = None, rate: float = RATE) -> Path:
    """Write `movie.mp4` into the folder of a run, or a movie to a path ending in .mp4 or .gif.

    Without an encoder (the package imageio-ffmpeg) a GIF is written. PostError without dumps.
    """
    frames = [frame for frame in run.frames if frame.solid_path or frame.air_path]
    if len(frames) < 2:
        raise PostError(f"{run.folder}: a movie needs two dumps or more")
    encoder = find_encoder()
    path = path or run.folder / ("movie.mp4" if encoder else "movie.gif")
    if path.suffix == ".mp4" and not encoder:
        raise PostError("there is no encoder for mp4 (pip install imageio-ffmpeg); name a .gif")
    with tempfile.TemporaryDirectory() as folder:
        pictures = draw_frames(run, frames, Path(folder))
        if path.suffix == ".mp4":
            _encode(encoder, Path(folder), path, rate)
        else:
            _animate(pictures, path, rate)
    return path


def find_encoder() -> str | None:
    """The program ffmpeg of the package imageio-ffmpeg; None without it."""
    try:
        import imageio_ffmpeg  # noqa: PLC0415 (may be missing)

        return imageio_ffmpeg.get_ffmpeg_exe()
    except (ImportError, RuntimeError):
        return None


def draw_frames(run: Run, frames: list[Frame], folder: Path) -> list[Path]:
    """A picture of each dump, `00000.png` and so on, all of one size and in one scale."""
    first = cut_air(run, frames[0])
    cut, tints = choose_cut(run.deck, first.cells if first else None), tints_of(run.deck)
    bodies = [cut_bodies(run, frame, cut, tints) for frame in frames]
    tops = [highest(frame.air("pressure").field["pressure"]) for frame in frames if frame.air_path]
    colours = None
    if tops:
        colours = pressure_colours(run.deck.ambient, max(tops[LEFT_OUT:] or tops))
    view = view_of(run, first, bodies, cut)
    strip = range_of_strips(bodies) if any(len(quads) for quads, *_ in bodies) else None
    found = []
    for number, frame in enumerate(frames):
        figure, axes = _panels(view, strip, colours, tints)
        air = cut_air(run, frame)
        if air is not None:
            draw_air(axes[0], air, cut, colours)
        draw_bodies(axes[0], bodies[number][0])
        dress(axes[0], view, cut)
        axes[0].set_title(f"{run.deck.title or run.job}\n{_clock(run, frame.time)}", fontsize=9)
        if strip is not None:
            _draw_strip(axes[1], bodies[number], strip, view, cut)
        path = folder / f"{number:05d}.png"
        figure.savefig(path, dpi=DOTS)
        plt.close(figure)
        found.append(path)
    return found


def _clock(run: Run, time: float) -> str:
    factor, unit = scale_for([run.end], "s")
    return f"{time / factor:.4f} {unit}"


def _panels(view: np.ndarray, strip, colours, tints: Tints):
    """Figure of an even number of dots with the scene and, below it, the bodies stretched."""
    slope = float(np.ptp(view[1]) / np.ptp(view[0]))
    height = float(np.clip((WIDTH - 1.2) * slope, 1.5, 6.0))
    ratios = [height] if strip is None else [height, 1.3]
    total = sum(ratios) + 1.0 + (tints.height if strip is not None else 0.0)
    total = 2 * round(total * DOTS / 2) / DOTS  # an encoder wants even numbers
    figure, axes = plt.subplots(
        len(ratios), 1, figsize=(WIDTH, total), height_ratios=ratios, squeeze=False
    )
    axes = axes[:, 0]
    if colours is not None:
        pressure_bar(figure, colours, axes[0], fraction=0.04, pad=0.02)
    if strip is not None:
        linear_bar(figure, DAMAGE_COLOURS, axes[-1], "damage [-]", fraction=0.04, pad=0.02)
        tints.legend(figure)
    return figure, axes


def _draw_strip(axis, bodies: tuple, strip: tuple[float, float], view: np.ndarray, cut) -> None:
    """The bodies alone, coloured by damage, the vertical axis stretched."""
    low, high = strip
    margin = 0.08 * (high - low)
    draw_bodies(axis, *bodies[:2])
    dress(axis, np.array([view[0], [low - margin, high + margin]]), cut)
    axis.set_aspect("auto")
    axis.axhline(0, color=GREY, lw=0.4, zorder=0)


def _encode(encoder: str, folder: Path, path: Path, rate: float) -> None:
    """H.264 in the form that browsers and slides play."""
    command = [encoder, "-y", "-loglevel", "error", "-framerate", str(rate)]
    command += ["-i", str(folder / "%05d.png"), "-c:v", "libx264", "-pix_fmt", "yuv420p"]
    command += ["-crf", "20", "-movflags", "+faststart", str(path)]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise PostError(f"{path}: the encoder failed: {done.stderr.strip()[-300:]}")


def _animate(pictures: list[Path], path: Path, rate: float) -> None:
    few = Image.Quantize.MAXCOVERAGE  # keeps rare colours
    images = [Image.open(one).convert("RGB").quantize(256, few, dither=0) for one in pictures]
    images[0].save(
        path, save_all=True, append_images=images[1:], duration=round(1000 / rate), loop=0
    )
