# SPDX-License-Identifier: MIT
"""What a case is: quantities with a reference, and runs of several codes that give them."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

HERE = Path(__file__).parent
CASES = (
    "plate_elastic",
    "plate_elastic_large",
    "plate_laminate",
    "plate_steel",
    "plate_blast",
    "plate_impulse",
    "taylor_bilinear",
    "taylor_copper",
    "reflected_blast",
    "air_load",
    "stress_wave",
    "spall",
    "panel_load",
    "panel",
    "perforation_metal",
    "rod_concrete",
    "paper_plate",
)

Measures = dict[str, float]
History = list[tuple[float, float]]


@dataclass(frozen=True)
class Quantity:
    """A number that every code gives."""

    key: str  # column of results.csv
    label: str
    unit: str
    scale: float = 1.0  # shown = value*scale
    digits: int = 3  # significant
    reference: float | None = None
    tolerance: float | None = None  # of Brisance, relative

    def shown(self, value: float | None) -> str:
        return "" if value is None else f"{value * self.scale:#.{self.digits}g}".rstrip(".")


@dataclass(frozen=True)
class Run:
    """One code, one resolution."""

    name: str  # as in tables: 'CalculiX 10 x 10 x 1'
    program: str  # key of comparisons.programs.PROGRAMS
    size: str  # '3,872 particles (a quarter)'
    write: Callable[[Path], None]  # inputs into a folder
    read: Callable[[Path], tuple[Measures, History]]  # what came out of it
    slow: bool = False  # over three minutes: only when it is asked for by name


@dataclass(frozen=True)
class Case:
    name: str
    mark: str  # 'P1'
    title: str
    setting: str  # what is computed, in one or two sentences
    reference: str  # where the reference comes from
    quantities: tuple[Quantity, ...]
    runs: tuple[Run, ...] = ()
    remarks: dict[str, str] = field(default_factory=dict)  # by name of a row: the last column
    axes: tuple[str, str] = ("time [us]", "")
    scales: tuple[float, float] = (1e6, 1.0)  # of time and value in the picture
    lines: dict[str, str] = field(default_factory=dict)  # by name of a history: dashes or so
    text: str = ""  # a paragraph under the table
    exact: Callable[[], History] | None = None  # drawn beneath the others

    @property
    def folder(self) -> Path:
        return HERE / self.name


def load_case(name: str) -> Case:
    """The case of a folder of that name."""
    return importlib.import_module(f"studies.comparisons.{name}.case").CASE


def load_cases(names: list[str] | None = None) -> list[Case]:
    """Some cases, or all of them."""
    return [load_case(name) for name in (names or CASES)]
