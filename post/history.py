# SPDX-License-Identifier: MIT
"""History files of a run: comma-separated text, first row names with units."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from post.errors import PostError

# names of columns that files of older versions have, and the present ones
RENAMED = {"held_cells": "limited_cells"}


class History:
    """Columns of a history file by name; the unit of each stands in the first row of the file.

    A column `A:pressure[Pa]` has the name 'A:pressure', the owner 'A' and the unit 'Pa'. Where
    two columns differ in their unit alone, the names keep it: 'outflow[J]' and 'outflow[kg]'.
    """

    def __init__(self, names: list[str], units: list[str], values: np.ndarray, path: Path):
        self.path = path
        self.names = names
        self._unit = dict(zip(names, units, strict=True))
        self.data = np.zeros(len(values), [(name, float) for name in names])
        for i, name in enumerate(names):
            self.data[name] = values[:, i]

    @property
    def time(self) -> np.ndarray:
        """Times of the rows [s], shape (n)."""
        return self.data["time"]

    def __len__(self) -> int:
        return len(self.data)

    def __contains__(self, name: str) -> bool:
        return name in self._unit

    def __getitem__(self, name: str) -> np.ndarray:
        """Values of a column in SI units, shape (n). PostError if there is no such column."""
        if name not in self._unit:
            known = ", ".join(self.names)
            raise PostError(f"{self.path}: there is no column '{name}'; it has {known}")
        return self.data[name]

    def unit(self, name: str) -> str:
        """Unit of a column, '-' where it has none."""
        return self._unit[name]

    def find(self, pattern: str) -> list[str]:
        """Names of the columns that match a regular expression in full, in their order."""
        return [name for name in self.names if re.fullmatch(pattern, name)]

    def owners(self) -> list[str]:
        """What stands before the colon, each once, in the order of the file."""
        return list(dict.fromkeys(n.split(":", 1)[0] for n in self.names if ":" in n))


def _present_name(name: str) -> str:
    """The name of a column, `air_ledger_x` for one, as this version writes it."""
    for old, new in RENAMED.items():
        if name == old or re.fullmatch(old + "_[xyz]", name):
            return new + name[len(old) :]
    return name


def read_history(path: Path) -> History:
    """Read a history file. A last row that was never finished is dropped.

    Raises PostError for a file without rows of names, `time[s]` first, or with text for numbers.
    """
    try:
        lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError as error:
        raise PostError(f"{path}: cannot be read: {error.strerror}") from error
    header = lines[0].split(",") if lines else []
    cells = [re.fullmatch(r"\s*(.*?)\s*(?:\[(.*)\])?\s*", text).groups() for text in header]
    cells = [(_present_name(name or ""), unit) for name, unit in cells]
    names = [name for name, _ in cells]
    if not names or names[0] != "time":
        raise PostError(f"{path}: the first row must name the columns, 'time[s]' first")
    names = [f"{n}[{u}]" if names.count(n) > 1 else n for n, u in cells]
    if len(set(names)) < len(names):
        raise PostError(f"{path}: two columns have the same name")
    rows = [line.split(",") for line in lines[1:] if line.strip()]
    if rows and len(rows[-1]) < len(names):
        rows.pop()
    values = np.empty((len(rows), len(names)))
    for i, row in enumerate(rows):
        try:
            values[i] = row
        except ValueError as error:
            raise PostError(f"{path}:{i + 2}: the row does not fit the names: {error}") from error
    return History(names, [unit or "-" for _, unit in cells], values, path)
