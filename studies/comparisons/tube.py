# SPDX-License-Identifier: MIT
"""The shock tube of the panel for rhoCentralFoam of OpenFOAM, in a plane: a rigid panel on a step.

Blocks of about square cells; the panel is a gap of one millimetre in the middle row of blocks, the
step a gap in the lowest one. Pressures are read in the cells before and behind the panel.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from studies.comparisons import foam
from studies.comparisons.case import History

ALONG = (-0.12, 0.0, 0.001, 0.12)
UP = (0.0, 0.015, 0.065, 0.08)
BLOCKS = ((0, 0), (0, 1), (0, 2), (1, 2), (2, 1), (2, 2))  # (along, up); the others are solid


@dataclass(frozen=True)
class Shock:
    """A state behind a front that stands at x = place; SI units."""

    place: float
    density: float
    pressure: float
    speed: float


def _counts(edges: tuple, cell: float) -> list[int]:
    return [max(1, round((b - a) / cell)) for a, b in pairwise(edges)]


def _mesh(cell: float) -> str:
    points = [(x, y, z) for z in (0, cell) for y in UP for x in ALONG]
    vertices = " ".join(f"({x:g} {y:g} {z:g})" for x, y, z in points)
    nx, ny = _counts(ALONG, cell), _counts(UP, cell)

    def corner(i: int, j: int, k: int) -> int:
        return i + 4 * j + 16 * k

    blocks, faces = [], {"left": [], "right": [], "walls": [], "sides": []}
    for i, j in BLOCKS:
        ring = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
        low, high = ([corner(*p, k) for p in ring] for k in (0, 1))
        corners = " ".join(map(str, low + high))
        blocks.append(f"hex ({corners}) ({nx[i]} {ny[j]} 1) simpleGrading (1 1 1)")
        faces["sides"] += [low, high]
        for side, beside in enumerate(((i, j - 1), (i + 1, j), (i, j + 1), (i - 1, j))):
            if beside in BLOCKS:
                continue
            a, b = ring[side], ring[(side + 1) % 4]
            patch = {-1: "left", 3: "right"}.get(beside[0], "walls")
            faces[patch].append([corner(*a, 0), corner(*b, 0), corner(*b, 1), corner(*a, 1)])
    kinds = {"left": "patch", "right": "patch", "walls": "wall", "sides": "empty"}
    patches = []
    for name, kind in kinds.items():
        listed = " ".join(f"({' '.join(map(str, face))})" for face in faces[name])
        patches.append(f"{name} {{ type {kind}; faces ({listed}); }}")
    lines = ";\nedges ();\nboundary (\n" + "\n".join(patches) + "\n);\n"
    return f"vertices ({vertices});\nblocks ( " + "\n".join(blocks) + " )" + lines


def write(folder: Path, cell: float, shock: Shock, still: tuple[float, float], end: float) -> None:
    """Write the case; `still`: density and pressure before the front."""
    foam.folders(folder)
    foam.put(folder, "system/blockMeshDict", "dictionary", _mesh(cell))
    nx, ny = _counts(ALONG, cell), _counts(UP, cell)
    behind = []
    for i, j in BLOCKS:
        step = (ALONG[i + 1] - ALONG[i]) / nx[i]
        row = [ALONG[i] + (k + 0.5) * step < shock.place for k in range(nx[i])]
        behind += row * ny[j]
    pressure = [shock.pressure if b else still[1] for b in behind]
    density = [shock.density if b else still[0] for b in behind]
    heat = [p / (foam.GAS * d) for p, d in zip(pressure, density, strict=True)]
    speeds = " ".join(f"({shock.speed if b else 0} 0 0)" for b in behind)
    patches = {"left": "zeroGradient", "right": "zeroGradient", "walls": "", "sides": "empty"}
    for name, dimensions, value, wall, kind in (
        ("p", "[1 -1 -2 0 0 0 0]", foam.cells(pressure), "zeroGradient", "volScalarField"),
        ("T", "[0 0 0 1 0 0 0]", foam.cells(heat), "zeroGradient", "volScalarField"),
        ("U", "[0 1 -1 0 0 0 0]", f"nonuniform List<vector> {len(behind)} ({speeds})", "slip",
         "volVectorField"),
    ):  # fmt: skip
        sides = "\n".join(f"{n} {{ type {kind_of or wall}; }}" for n, kind_of in patches.items())
        foam.put(folder, f"0/{name}", kind, f"dimensions {dimensions};\n"
                 f"internalField {value};\nboundaryField\n{{\n{sides}\n}}\n")  # fmt: skip
    places = " ".join(f"({x:g} {y:g} {cell / 2:g})" for x, y in probes(cell))
    foam.numerics(folder, end, places)


def probes(cell: float, behind: float = 0.5) -> list[tuple[float, float]]:
    """Places of the pressures: up the panel, in the cell before it and `behind` cells behind."""
    n = _counts(UP, cell)[1]
    rows = [UP[1] + (k + 0.5) * (UP[2] - UP[1]) / n for k in range(n)]
    return [(x, y) for y in rows for x in (-cell / 2, ALONG[2] + behind * cell)]


def mode(x: float) -> float:
    """First mode of a clamped beam of length 1, 1 at its tip."""
    b, c = 1.8751040687, 0.7340955138
    even, odd = math.cosh(b * x) - math.cos(b * x), math.sinh(b * x) - math.sin(b * x)
    return (even - c * odd) / 2


def load(rows: list[tuple[float, list[float]]], cell: float) -> History:
    """The even pressure that pushes the first mode of the panel as those before and behind it."""
    places = probes(cell)[::2]
    weights = [mode((y - UP[1]) / (UP[2] - UP[1])) for _, y in places]
    found = []
    for t, p in rows:
        net = [a - b for a, b in zip(p[::2], p[1::2], strict=True)]
        found.append((t, sum(w * n for w, n in zip(weights, net, strict=True)) / sum(weights)))
    return found


def count(cell: float) -> int:
    """Cells of the mesh."""
    nx, ny = _counts(ALONG, cell), _counts(UP, cell)
    return sum(nx[i] * ny[j] for i, j in BLOCKS)
