# SPDX-License-Identifier: MIT
"""A quarter of a clamped plate for CalculiX: quadratic bricks (C3D20R), implicit dynamics.

The quarter is 0..half in x and y with planes of symmetry at 0, clamped (all displacements) at
x = half and y = half, and lies below z = 0, where the pressure pushes down.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from studies.comparisons.case import History, Measures, Run


@dataclass(frozen=True)
class Plate:
    """SI units. A layer is (thickness, elements across, material), from the bottom up."""

    half: float
    elements: int  # along each side of the quarter
    layers: tuple[tuple[float, int, str], ...]
    materials: dict[str, str]  # name: lines below *MATERIAL
    t_end: float
    step: float  # longest increment [s]

    @property
    def thickness(self) -> float:
        return sum(layer[0] for layer in self.layers)

    @property
    def count(self) -> str:
        """'10 x 10 x 3'."""
        return f"{self.elements} x {self.elements} x {sum(layer[1] for layer in self.layers)}"


def isotropic(young: float, poisson: float, density: float, plastic: str = "") -> str:
    """Lines of a material; `plastic`: lines of stress, plastic strain."""
    lines = f"*ELASTIC\n{young:g}, {poisson:g}\n*DENSITY\n{density:g}"
    return lines + (f"\n*PLASTIC\n{plastic}" if plastic else "")


def orthotropic(e: Sequence[float], nu: Sequence[float], g: Sequence[float], density: float) -> str:
    """Lines of a material: E1, E2, E3; nu12, nu13, nu23; G12, G13, G23."""
    numbers = [f"{x:.8g}" for x in (*e, *nu, *g)]
    return (
        "*ELASTIC, TYPE=ENGINEERING CONSTANTS\n"
        f"{', '.join(numbers[:8])}\n{numbers[8]}, 293.\n*DENSITY\n{density:g}"
    )


def turned(e: Sequence[float], nu: Sequence[float], g: Sequence[float]) -> tuple:
    """The same with the fibre along axis 2: for a ply of 90 degrees."""
    (e1, e2, e3), (nu12, nu13, nu23), (g12, g13, g23) = e, nu, g
    return (e2, e1, e3), (nu12 * e2 / e1, nu23, nu13), (g12, g23, g13)


class Mesh:
    """Nodes on a lattice of half elements; those inside faces and bricks do not exist."""

    def __init__(self, plate: Plate) -> None:
        self.plate = plate
        self.side = 2 * plate.elements
        self.levels = [-plate.thickness]
        for thickness, n, _ in plate.layers:
            start = self.levels[-1]
            self.levels += [start + thickness * k / (2 * n) for k in range(1, 2 * n + 1)]
        self.top = len(self.levels) - 1

    def number(self, i: int, j: int, k: int) -> int:
        return 1 + i + (self.side + 1) * (j + (self.side + 1) * k)

    def nodes(self) -> list[tuple[int, int, int]]:
        """Places of the nodes: at most one index is odd."""
        rows = range(self.side + 1)
        every = ((i, j, k) for k in range(self.top + 1) for j in rows for i in rows)
        return [place for place in every if sum(index % 2 for index in place) <= 1]

    def node_line(self, place: tuple[int, int, int]) -> str:
        h = self.plate.half / self.side
        i, j, k = place
        return f"{self.number(i, j, k)}, {i * h:.9g}, {j * h:.9g}, {self.levels[k]:.9g}"

    def brick(self, a: int, b: int, c: int) -> list[int]:
        """Nodes of a brick: corners below and above, middles below, above, upright."""
        ring = ((0, 0), (2, 0), (2, 2), (0, 2))
        middle = ((1, 0), (2, 1), (1, 2), (0, 1))
        places = [(*p, 0) for p in ring] + [(*p, 2) for p in ring]
        places += [(*p, 0) for p in middle] + [(*p, 2) for p in middle] + [(*p, 1) for p in ring]
        return [self.number(2 * a + i, 2 * b + j, 2 * c + k) for i, j, k in places]

    def elements(self) -> list[tuple[int, str, list[int]]]:
        """(number, material, nodes), layer by layer; the struck ones come last."""
        found, c = [], 0
        for _, n, material in self.plate.layers:
            for _ in range(n):
                for b in range(self.plate.elements):
                    for a in range(self.plate.elements):
                        found.append((len(found) + 1, material, self.brick(a, b, c)))
                c += 1
        return found

    def struck(self) -> list[tuple[int, float, float]]:
        """(number, x, y) of the elements under the load, at their middles."""
        n = self.plate.elements
        first = len(self.elements()) - n * n + 1
        h = self.plate.half / n
        return [
            (first + a + n * b, (a + 0.5) * h, (b + 0.5) * h) for b in range(n) for a in range(n)
        ]


def _in_lines(numbers: Sequence[int]) -> list[str]:
    return [", ".join(map(str, numbers[k : k + 12])) + "," for k in range(0, len(numbers), 12)]


def _head(mesh: Mesh) -> list[str]:
    """Nodes, elements, sections, held nodes."""
    plate, nodes = mesh.plate, mesh.nodes()
    lines = ["*NODE, NSET=ALL", *(mesh.node_line(place) for place in nodes)]
    elements = mesh.elements()
    for material in plate.materials:
        lines.append(f"*ELEMENT, TYPE=C3D20R, ELSET={material}")
        for number, of, brick in elements:
            if of == material:
                lines += [f"{number}, {', '.join(map(str, brick[:10]))},",
                          ", ".join(map(str, brick[10:]))]  # fmt: skip
    for material, text in plate.materials.items():
        lines += [f"*MATERIAL, NAME=M{material}", text]
        lines += [f"*SOLID SECTION, ELSET={material}, MATERIAL=M{material}"]
    for name, keep in (("X0", lambda i, j: i == 0), ("Y0", lambda i, j: j == 0),
                       ("RIM", lambda i, j: mesh.side in (i, j))):  # fmt: skip
        lines += [
            f"*NSET, NSET={name}",
            *_in_lines([mesh.number(*p) for p in nodes if keep(*p[:2])]),
        ]
    lines += [f"*NSET, NSET=MID\n{mesh.number(0, 0, 0)}", "*BOUNDARY"]
    return [*lines, "X0, 1, 1, 0.", "Y0, 2, 2, 0.", "RIM, 1, 3, 0."]


PRINT = "*NODE PRINT, NSET=MID\nU\n*END STEP"


def pulse(plate: Plate, pressure: float, duration: float) -> str:
    """Deck of a plate under a pressure from 0 to a time, a whole number of increments."""
    half = plate.step / 2

    def mean(_x: float, _y: float, t: float) -> float:
        return pressure * max(0.0, min(t + half, duration) - max(t - half, 0.0)) / plate.step

    return blast(plate, -plate.step, mean, even=True)


def blast(plate: Plate, start: float, pressure: Callable[[float, float, float], float],
          *, even: bool = False) -> str:  # fmt: skip
    """Deck of a plate under a load that differs from element to element (or is even everywhere).

    `pressure(x, y, t)` is the mean over an increment about t, so that impulses are exact whatever
    the increment. The run begins at `start` (a multiple of the increment), which must lie before
    the load: CalculiX starts from no acceleration.
    """
    mesh = Mesh(plate)
    lines = _head(mesh)
    steps = round((plate.t_end - start) / plate.step)
    struck = mesh.struck()
    if even:
        lines += ["*ELSET, ELSET=STRUCK", *_in_lines([number for number, _, _ in struck])]
        struck = [("STRUCK", 0.0, 0.0)]
    loads = []
    for name, x, y in struck:
        lines.append(f"*AMPLITUDE, NAME=A{name}, TIME=TOTAL TIME")
        points = [
            (n * plate.step, pressure(x, y, start + n * plate.step)) for n in range(steps + 1)
        ]
        lines += [f"{t:.9g}, {p:.7g}" for t, p in points]
        loads += [f"*DLOAD, AMPLITUDE=A{name}", f"{name}, P2, 1."]
    lines += ["*STEP, NLGEOM, INC=100000", "*DYNAMIC, DIRECT"]
    lines += [f"{plate.step:g}, {steps * plate.step:.9g}", *loads, PRINT]
    return "\n".join(lines) + "\n"


def printed(folder: Path, component: int = 3) -> History:
    """Time and one component of the one node in model.dat."""
    found, time = [], None
    for line in (folder / "model.dat").read_text(encoding="utf-8").splitlines():
        words = line.split()
        if "time" in words:
            time = float(words[-1])
        elif time is not None and len(words) == 4:
            # an exponent of three digits leaves no room for its letter
            value = words[component]
            found.append((time, float(value) if "E" in value else 0.0))
            time = None
    return found


def deflection(folder: Path, start: float = 0.0) -> History:
    """Deflection of the middle away from the load against time."""
    return [(start, 0.0), *((start + t, -u) for t, u in printed(folder))]


def run(plate: Plate, pressure: float, duration: float,
        measure: Callable[[History], Measures], slow: bool = False) -> Run:  # fmt: skip
    """A run of CalculiX: an even pressure from 0 to a time, and the measures of its middle."""

    def write(folder: Path) -> None:
        (folder / "model.inp").write_text(pulse(plate, pressure, duration), encoding="utf-8")

    def read(folder: Path) -> tuple[Measures, History]:
        history = deflection(folder, -plate.step)
        return measure(history), history

    count = plate.count
    return Run(f"CalculiX {count}", "calculix", f"{count} C3D20R", write, read, slow)
