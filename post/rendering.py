# SPDX-License-Identifier: MIT
"""Off-screen rendering on machines with and without a display: find a way that works, once.

A graphics library that is missing or broken may end the whole process, so each way is first tried
in a process of its own.
"""

from __future__ import annotations

import os
import subprocess
import sys
from functools import cache

from post.errors import PostError

WINDOWS = ("vtkEGLRenderWindow", "vtkOSOpenGLRenderWindow")
TRIAL = """
import pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=(64, 64))
plotter.background_color = "white"
plotter.add_mesh(pyvista.Sphere(), color="black")
picture = plotter.screenshot(None, return_img=True)
assert picture.min() < 100 and picture.max() > 200, "the picture is of one colour"
"""
HELP = (
    "nothing can be rendered here: neither EGL nor OSMesa works. On Debian or Ubuntu install "
    "libegl1 and libegl-mesa0, or libosmesa6"
)


@cache
def prepare() -> str:
    """Set the environment for off-screen pictures; the name of the window class that works.

    A VTK_DEFAULT_OPENGL_WINDOW that is set is tried first. PostError if nothing renders. Call it
    before pyvista is imported.
    """
    os.environ["PYVISTA_OFF_SCREEN"] = "true"
    given = os.environ.get("VTK_DEFAULT_OPENGL_WINDOW")
    ways = dict.fromkeys([given, *WINDOWS] if given else WINDOWS)
    trials = {}
    for window in ways:
        trials[window] = _try_out(window)
        if not trials[window]:
            os.environ["VTK_DEFAULT_OPENGL_WINDOW"] = window
            return window
    reasons = "; ".join(f"{window}: {reason}" for window, reason in trials.items())
    raise PostError(f"{HELP} ({reasons})")


def _try_out(window: str) -> str:
    """An empty text if a small picture can be made, or else the reason why not."""
    environment = dict(os.environ, VTK_DEFAULT_OPENGL_WINDOW=window)
    try:
        trial = subprocess.run(
            [sys.executable, "-c", TRIAL],
            env=environment,
            capture_output=True,
            text=True,
            timeout=120,
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        return str(error)
    if trial.returncode == 0:
        return ""
    lines = trial.stderr.strip().splitlines()
    return lines[-1][:200] if lines else f"ended with code {trial.returncode}"
