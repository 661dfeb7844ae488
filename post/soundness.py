# SPDX-License-Identifier: MIT
"""Dumps that hold what cannot be: numbers that are not finite, or nothing but zeros."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from post.reader import Frame


def not_finite_in(frame: Frame, some: dict[str, tuple] | None = None) -> list[str]:
    """Fields that are not finite, among all or among `some` of 'air' and of 'solid'."""
    found = []
    for kind, path in (("air", frame.air_path), ("solid", frame.solid_path)):
        if path is None:
            continue
        load = frame.air if kind == "air" else frame.solid
        dump = load(*(some[kind] if some else ()))
        fields = dump.field | ({"Points": dump.points} if kind == "solid" else {})
        for name, values in fields.items():
            if not np.isfinite(values).all():
                found.append(f"{path.name}: '{name}' is not finite at t = {frame.time:g} s")
    return found


def zeros_in(frame: Frame) -> list[str]:
    """Dumps of a time that hold nothing but zeros where there must be something."""
    found = []
    for path, load, name in (
        (frame.air_path, frame.air, "pressure"),
        (frame.solid_path, frame.solid, "id"),
    ):
        if path is not None:
            values = load(name).field[name]
            if values.size and not values.any():
                found.append(f"{path}: '{name}' is zero throughout")
    return found
