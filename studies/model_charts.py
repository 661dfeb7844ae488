# SPDX-License-Identifier: MIT
"""What the charts of error against seconds by how much is modelled share: runs, walls, axes."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from post.history import History, read_history

TILES = 5  # of a rigid wall, across a quarter


@dataclass(frozen=True)
class Engine:
    """What runs a deck, and for how long at most [s]."""

    brisance: str = "bin/brisance"
    backend: str = "cpu"
    limit: float | None = None


ONE_CORE = Engine()


def compute(folder: Path, name: str, text: str, engine: Engine = ONE_CORE) -> float:
    """Run one deck; seconds of its one core, or of the wall on a GPU.

    CalledProcessError where it fails, TimeoutExpired where it takes longer than the limit.
    """
    path = folder / f"{name}.nml"
    path.write_text(text, encoding="utf-8")
    command = [engine.brisance, "run", str(path), "--backend", engine.backend]
    command += ["--out", str(folder / name)]
    threads = {"OMP_NUM_THREADS": "1"} if engine.backend == "cpu" else {}
    start = time.monotonic()
    with (folder / f"{name}.log").open("w", encoding="utf-8") as log:
        process = subprocess.Popen([*command, "--replace"], env=os.environ | threads, stdout=log,
                                   stderr=subprocess.STDOUT)  # fmt: skip
        if engine.backend == "cpu":
            _, status, used = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            seconds = used.ru_utime + used.ru_stime
        else:
            try:
                process.wait(engine.limit)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
                raise
            seconds = time.monotonic() - start
    if process.returncode != 0:
        raise subprocess.CalledProcessError(process.returncode, command)
    return seconds


def tiles(side: float) -> list[tuple[str, float, float]]:
    """Name and low corner of each tile of a quarter whose tiles have that side."""
    return [(f"tile_{i}_{j}", i * side, j * side) for i in range(TILES) for j in range(TILES)]


def load_table(history: History, impulse: list[float]) -> str:
    """The table of a &load from an impulse per area [Pa s]: means between its rows."""
    when = [float(t) for t in history["time"]]
    lines = ["time,pressure"]
    for k in range(1, len(when)):
        pressure = (impulse[k] - impulse[k - 1]) / (when[k] - when[k - 1])
        lines.append(f"{(when[k] + when[k - 1]) / 2:.9e},{pressure:.9e}")
    return "\n".join(lines)


def wall_loads(folder: Path, number: int, side: float, load: str, sign: float) -> str:
    """&load groups of what the air gave to the tiles of run_NUMBER_wall; writes their files.

    `load` is the group with {name} for both files, `sign` the direction of the push along z.
    """
    history, text = read(folder / f"run_{number}_wall"), ""
    for tile, x, y in tiles(side):
        name = f"run_{number}_{tile}"
        push = [sign * float(value) / side**2 for value in history[f"{tile}:impulse_z"]]
        (folder / f"{name}.csv").write_text(load_table(history, push), encoding="utf-8")
        (folder / f"{name}.stl").write_text(square(x, y, side), encoding="utf-8")
        text += load.format(name=name)
    return text


def read(folder: Path) -> History:
    """The gauges of a run."""
    return read_history(folder / "gauges.csv")


def square(x: float, y: float, side: float) -> str:
    """A square of the face z = 0 as an STL surface, by its low corner."""
    corners = [(x, y), (x + side, y), (x + side, y + side), (x, y + side)]
    text = "solid square\n"
    for three in ((0, 1, 2), (0, 2, 3)):
        text += "facet normal 0 0 1\nouter loop\n"
        text += "".join(f"vertex {corners[k][0]} {corners[k][1]} 0\n" for k in three)
        text += "endloop\nendfacet\n"
    return text + "endsolid square\n"


def sizes(row: dict[str, str]) -> str:
    """'12 / 6': cells and particles of a row of a table [mm]."""
    return " / ".join(row[key] for key in ("cells_mm", "spacing_mm") if row[key])


def readable(*ticks) -> None:
    """Logarithmic axes with numbers as one says them."""
    from matplotlib.ticker import (  # noqa: PLC0415 (runs are made where it may be missing)
        LogLocator,
        NullFormatter,
        StrMethodFormatter,
    )

    for axis in ticks:
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter(StrMethodFormatter("{x:g}"))
        axis.set_minor_formatter(NullFormatter())
