# SPDX-License-Identifier: MIT
"""A strip in plane strain for CalculiX: one quadratic brick deep, held at its foot, pushed from a
side.

(Bricks that are held in depth, C3D20R: elements CPE8R of CalculiX 2.20 gave a cantilever of this
kind the right deflection but 0.70 of its period.)
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Strip:
    """SI units. It stands along y on y = 0, from x = 0 to its thickness."""

    length: float
    thickness: float
    along: int  # elements
    across: int
    material: str  # lines below *MATERIAL

    @property
    def tip(self) -> int:
        """The node in the middle of the upper end; needs an even number of elements across."""
        return self.number(self.across, 2 * self.along, 0)

    def number(self, i: int, j: int, k: int) -> int:
        """Node of a lattice of half elements."""
        return 1 + i + (2 * self.across + 1) * (j + (2 * self.along + 1) * k)

    def nodes(self) -> list[tuple[int, int, int]]:
        """Places of the nodes: at most one index is odd."""
        rows, columns = range(2 * self.along + 1), range(2 * self.across + 1)
        every = ((i, j, k) for k in range(3) for j in rows for i in columns)
        return [place for place in every if sum(index % 2 for index in place) <= 1]

    def element(self, a: int, b: int) -> list[int]:
        """Corners behind and before, middles behind, before, in depth."""
        ring = ((0, 0), (2, 0), (2, 2), (0, 2))
        middle = ((1, 0), (2, 1), (1, 2), (0, 1))
        places = [(*p, 0) for p in ring] + [(*p, 2) for p in ring]
        places += [(*p, 0) for p in middle] + [(*p, 2) for p in middle] + [(*p, 1) for p in ring]
        return [self.number(2 * a + i, 2 * b + j, k) for i, j, k in places]


def deck(strip: Strip, end: float, step: float, pressure: Callable[[float], float]) -> str:
    """Implicit dynamics; `pressure` against time acts on the side x = 0."""
    h, d = strip.length / (2 * strip.along), strip.thickness / (2 * strip.across)
    lines = ["*NODE, NSET=ALL"]
    lines += [
        f"{strip.number(i, j, k)}, {i * d:.9g}, {j * h:.9g}, {k * h:.9g}"
        for i, j, k in strip.nodes()
    ]
    lines.append("*ELEMENT, TYPE=C3D20R, ELSET=STRIP")
    struck = []
    for b in range(strip.along):
        for a in range(strip.across):
            name = 1 + a + strip.across * b
            brick = strip.element(a, b)
            lines += [f"{name}, {', '.join(map(str, brick[:10]))},",
                      ", ".join(map(str, brick[10:]))]  # fmt: skip
            struck += [name] if a == 0 else []
    foot = [strip.number(*place) for place in strip.nodes() if place[1] == 0]
    lines += ["*ELSET, ELSET=STRUCK", ",\n".join(map(str, struck))]
    lines += ["*NSET, NSET=FOOT", ",\n".join(map(str, foot)), f"*NSET, NSET=MID\n{strip.tip}"]
    lines += ["*MATERIAL, NAME=M", strip.material, "*SOLID SECTION, ELSET=STRIP, MATERIAL=M"]
    lines += ["*BOUNDARY", "FOOT, 1, 2, 0.", "ALL, 3, 3, 0."]
    lines += ["*AMPLITUDE, NAME=PUSH, TIME=TOTAL TIME"]
    steps = round(end / step)
    lines += [f"{n * step:.9g}, {pressure(n * step):.7g}" for n in range(steps + 1)]
    lines += ["*STEP, NLGEOM, INC=100000", "*DYNAMIC, DIRECT", f"{step:g}, {end:g}"]
    lines += ["*DLOAD, AMPLITUDE=PUSH", "STRUCK, P6, 1.", "*NODE PRINT, NSET=MID\nU\n*END STEP"]
    return "\n".join(lines) + "\n"
