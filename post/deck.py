# SPDX-License-Identifier: MIT
"""The complete deck of a run (its echo) and what pictures need to know of the scene."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import f90nml
import numpy as np

from post.errors import USAGE, PostError

AXES = "xyz"


@dataclass(frozen=True)
class Body:
    """Place of a body in the unloaded scene; a box that encloses it."""

    id: str
    number: int  # as in the field `body` of the dumps, from 1
    shape: str
    low: np.ndarray  # (3) [m]
    high: np.ndarray  # (3) [m]
    spacing: float  # [m]
    material: str = ""
    aspect: tuple[float, float, float] = (1.0, 1.0, 1.0)  # sides of a particle over the spacing

    @property
    def step(self) -> np.ndarray:
        """Sides of a particle along x, y, z, shape (3) [m]."""
        return self.spacing * np.array(self.aspect)


class Deck:
    """Groups of a namelist deck in the order of the file; keys in lower case."""

    def __init__(self, text: str, name: str = "deck"):
        try:
            parsed = f90nml.reads(text)
        except Exception as error:  # the parser has no exception of its own
            raise PostError(f"{name}: is not a namelist deck: {error}", USAGE) from error
        if not any(key.lower() == "run" for key in parsed):
            raise PostError(f"{name}: is not a namelist deck: it has no group &run", USAGE)
        self.text = text
        self._groups: dict[str, list[dict[str, Any]]] = {}
        for key, value in parsed.items():
            items = value if isinstance(value, list) else [value]
            self._groups.setdefault(key.lower(), []).extend(dict(item) for item in items)

    @property
    def names(self) -> list[str]:
        """Names of the groups, each once, in the order of the file."""
        return list(self._groups)

    def groups(self, name: str) -> list[dict[str, Any]]:
        """All groups of that name; an empty list if there is none."""
        return self._groups.get(name, [])

    def get(self, group: str, key: str, default: Any = None) -> Any:
        """A value of the first group of that name."""
        groups = self.groups(group)
        value = groups[0].get(key) if groups else None
        return default if value is None else value

    @property
    def title(self) -> str:
        """Title of the scene, or an empty text."""
        return str(self.get("run", "title", "")).strip()

    @property
    def mirrors(self) -> tuple[bool, bool, bool]:
        """Whether the scene is cut at the plane through the origin normal to x, y, z."""
        planes = as_list(self.get("run", "symmetry"))
        return tuple(axis in planes for axis in AXES)

    @property
    def images(self) -> int:
        """How many mirror images make the whole scene: 1, 2, 4 or 8."""
        return 2 ** sum(self.mirrors)

    @property
    def ambient(self) -> float:
        """Pressure of the undisturbed air [Pa]."""
        return float(self.get("air", "pressure", 101325.0))

    @property
    def cell(self) -> np.ndarray | None:
        """Sides of an air cell [m], shape (3); None without air."""
        box = as_list(self.get("air", "box"))
        cells = as_list(self.get("air", "cells"))
        if len(box) < 2 or len(cells) < len(box) // 2:
            return None
        sides = np.ones(3)
        for d in range(len(box) // 2):
            sides[d] = (box[2 * d + 1] - box[2 * d]) / cells[d]
        return sides

    def model_of(self, material: str) -> str:
        """Model of a material, or an empty text."""
        for group in self.groups("material"):
            if group.get("id") == material:
                return str(group.get("model", ""))
        return ""

    def bodies(self) -> list[Body]:
        """The bodies in the order of the deck."""
        return [_body(group, i + 1) for i, group in enumerate(self.groups("body"))]


def as_list(value: Any) -> list:
    """A list of what a key holds: namelists do not tell one value from a list of one."""
    if value is None:
        return []
    return list(value) if isinstance(value, (list, tuple)) else [value]


def _body(group: dict[str, Any], number: int) -> Body:
    shape = str(group.get("shape", "box"))
    if shape == "box":
        box = np.array((as_list(group.get("box")) + [0.0] * 6)[:6], float)
        low, high = box[0::2], box[1::2]
    else:
        centre = np.array((as_list(group.get("centre")) + [0.0] * 3)[:3], float)
        half = np.full(3, float(group.get("radius") or 0.0))
        if shape == "cylinder":
            half[AXES.index(group.get("axis", "z"))] = float(group.get("length") or 0.0) / 2
        low, high = centre - half, centre + half
    spacing = float(group.get("spacing") or math.nan)
    material = str(group.get("material", ""))
    aspect = tuple(float(a) for a in (as_list(group.get("aspect")) + [1.0] * 3)[:3])
    name = str(group.get("id", number))
    return Body(name, number, shape, low, high, spacing, material, aspect)
