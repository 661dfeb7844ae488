# SPDX-License-Identifier: MIT
"""Kinetic and internal energy over time, of each body and of each material."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from post.balance import whole_factor
from post.errors import PostError
from post.reader import Run


@dataclass(frozen=True)
class Energies:
    """Energies of a part of the whole scene, mirror images included; all of shape (n)."""

    name: str
    time: np.ndarray  # [s]
    kinetic: np.ndarray  # [J]
    internal: np.ndarray  # [J], elastic and what was spent

    @property
    def total(self) -> np.ndarray:
        """Kinetic and internal energy [J]."""
        return self.kinetic + self.internal


def body_energies(run: Run) -> dict[str, Energies]:
    """Energies of each body by its id. PostError where the run has no bodies.csv."""
    history, found = run.bodies, {}
    factor = whole_factor(run, "kinetic", "J")
    for body in history.owners():
        names = [f"{body}:kinetic", f"{body}:internal"]
        if all(name in history for name in names):
            kinetic, internal = (factor * history[name] for name in names)
            found[body] = Energies(body, history.time, kinetic, internal)
    return found


def material_energies(run: Run) -> dict[str, Energies]:
    """Sums over the bodies of each material, by the id of the material in the deck."""
    of_body = {body.id: body.material for body in run.deck.bodies()}
    found: dict[str, Energies] = {}
    for name, one in body_energies(run).items():
        material = of_body.get(name, name)
        so_far = found.get(material)
        kinetic, internal = one.kinetic, one.internal
        if so_far is not None:
            kinetic, internal = kinetic + so_far.kinetic, internal + so_far.internal
        found[material] = Energies(material, one.time, kinetic, internal)
    return found


def energy_of(run: Run, bodies: list[str]) -> Energies:
    """Sum over some bodies. PostError if the run has none of them."""
    every = body_energies(run)
    there = [every[name] for name in bodies if name in every]
    if not there:
        raise PostError(f"{run.folder}: bodies.csv has none of {', '.join(bodies)}")
    kinetic, internal = (np.sum([getattr(e, kind) for e in there], axis=0)
                         for kind in ("kinetic", "internal"))  # fmt: skip
    return Energies(", ".join(bodies), there[0].time, kinetic, internal)
