# SPDX-License-Identifier: MIT
"""A blast on a rigid floor for rhoCentralFoam of OpenFOAM: a wedge of 2 degrees about the axis.

The axis is x (upwards from the floor at 0), y the radius. Cells are square; those that the surface
of the balloon cuts hold their share of its mass and energy. Euler steps at a Courant number of 0.2.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from studies.comparisons.case import History

HEAD = "FoamFile {{ version 2.0; format ascii; class {kind}; object {name}; }}\n"
GAS = 287.05  # J/(kg K)


@dataclass(frozen=True)
class Balloon:
    """Hot gas at rest, in SI units."""

    radius: float
    at: float  # height over the floor
    density: float
    pressure: float


@dataclass(frozen=True)
class Scheme:
    """Flux ('Tadmor', 'Kurganov') and limiters of density and temperature, and of velocity."""

    flux: str = "Kurganov"
    limiter: str = "vanLeer"
    of_velocity: str = "vanLeerV"


SCHEME = Scheme()


def _field(name: str, dimensions: str, value: str, kind: str, outer: str) -> str:
    walls = {
        "floor": "slip" if kind == "vector" else "zeroGradient",
        "top": outer,
        "side": outer,
        "axis": "empty",
        "front": "wedge",
        "back": "wedge",
    }
    body = "\n".join(f"    {patch} {{ type {text}; }}" for patch, text in walls.items())
    title = HEAD.format(kind=f"vol{kind.capitalize()}Field", name=name)
    inside = f"dimensions {dimensions};\ninternalField {value};\n"
    return f"{title}{inside}boundaryField\n{{\n{body}\n}}\n"


def _mesh(height: float, radius: float, cell: float) -> str:
    s, c = math.sin(math.radians(1)), math.cos(math.radians(1))
    points = [(0, 0, 0), (height, 0, 0)]
    points += [(x, radius * c, z * radius * s) for z in (-1, 1) for x in (0, height)]
    vertices = " ".join(f"({x:.9g} {y:.9g} {z:.9g})" for x, y, z in points)
    n, m = round(height / cell), round(radius / cell)
    return (
        HEAD.format(kind="dictionary", name="blockMeshDict")
        + f"""vertices ({vertices});
blocks ( hex (0 1 3 2 0 1 5 4) ({n} {m} 1) simpleGrading (1 1 1) );
edges ();
boundary
(
    floor {{ type wall; faces ((0 4 2 0)); }}
    top {{ type patch; faces ((1 3 5 1)); }}
    side {{ type patch; faces ((2 4 5 3)); }}
    axis {{ type empty; faces ((0 1 1 0)); }}
    front {{ type wedge; faces ((0 2 3 1)); }}
    back {{ type wedge; faces ((0 1 5 4)); }}
);
"""
    )


def shares(space: tuple[float, float], cell: float, balloon: Balloon) -> np.ndarray:
    """Share of each cell (along the axis, along the radius) that lies in the balloon."""
    fine = 32
    n, m = (round(side / cell) for side in space)
    x = (np.arange(n * fine) + 0.5) * cell / fine - balloon.at
    y = (np.arange(m * fine) + 0.5) * cell / fine
    found = np.zeros((n, m))
    for k in range(m * fine):  # a ring of points; its weight is its radius
        inside = (x**2 + y[k] ** 2 < balloon.radius**2).reshape(n, fine).mean(axis=1)
        found[:, k // fine] += inside * y[k]
    return found / y.reshape(m, fine).sum(axis=1)


def cells(values: Sequence[float]) -> str:
    """A field that differs from cell to cell, in the order of the mesh."""
    numbers = " ".join(f"{v:.9g}" for v in values)
    return f"nonuniform List<scalar> {len(values)} ({numbers})"


def write(
    folder: Path, space: tuple[float, float], cell: float, balloon: Balloon, end: float
) -> None:
    """Write the case: a space of a height and a radius, a balloon over its floor."""
    folders(folder)
    height, radius = space
    (folder / "system/blockMeshDict").write_text(_mesh(height, radius, cell), encoding="utf-8")
    share = shares(space, cell, balloon)
    pressure = share * balloon.pressure + (1 - share) * 101325
    density = share * balloon.density + (1 - share) * 1.225
    for name, dimensions, value, kind in (
        ("p", "[1 -1 -2 0 0 0 0]", cells(pressure.T.ravel()), "scalar"),
        ("T", "[0 0 0 1 0 0 0]", cells((pressure / (GAS * density)).T.ravel()), "scalar"),
        ("U", "[0 1 -1 0 0 0 0]", "uniform (0 0 0)", "vector"),
    ):
        text = _field(name, dimensions, value, kind, "zeroGradient")
        (folder / "0" / name).write_text(text, encoding="utf-8")
    numerics(folder, end, f"({cell / 2} {cell / 2} 0)")


def folders(folder: Path) -> None:
    """The three folders of a case."""
    for name in ("0", "constant", "system"):
        (folder / name).mkdir()


def put(folder: Path, place: str, kind: str, text: str) -> None:
    """Write a file, its head first."""
    name = place.split("/")[1]
    (folder / place).write_text(HEAD.format(kind=kind, name=name) + text, encoding="utf-8")


def numerics(folder: Path, end: float, places: str, scheme: Scheme = SCHEME) -> None:
    """Air, schemes, steps, and the places where pressures are read in every step."""
    put(folder, "constant/thermophysicalProperties", "dictionary", f"""thermoType
{{ type hePsiThermo; mixture pureMixture; transport const; thermo eConst;
  equationOfState perfectGas;
  specie specie; energy sensibleInternalEnergy; }}
mixture {{ specie {{ molWeight {8314.46 / GAS:.6f}; }}
  thermodynamics {{ Cv {GAS / 0.4:.4f}; Hf 0; }}
  transport {{ mu 0; Pr 1; }} }}
""")  # fmt: skip
    put(folder, "constant/turbulenceProperties", "dictionary", "simulationType laminar;\n")
    put(folder, "system/fvSchemes", "dictionary", f"""fluxScheme {scheme.flux};
ddtSchemes {{ default Euler; }}
gradSchemes {{ default Gauss linear; }}
divSchemes {{ default none; div(tauMC) Gauss linear; }}
laplacianSchemes {{ default Gauss linear corrected; }}
interpolationSchemes {{ default linear; reconstruct(rho) {scheme.limiter};
  reconstruct(U) {scheme.of_velocity}; reconstruct(T) {scheme.limiter}; }}
snGradSchemes {{ default corrected; }}
""")  # fmt: skip
    put(folder, "system/fvSolution", "dictionary", """solvers
{ "(rho|rhoU|rhoE)" { solver diagonal; }
  U { solver smoothSolver; smoother GaussSeidel; tolerance 1e-9; relTol 0.01; }
  e { $U; tolerance 1e-10; relTol 0; } }
""")  # fmt: skip
    put(folder, "system/controlDict", "dictionary", f"""application rhoCentralFoam;
startFrom startTime; startTime 0; stopAt endTime; endTime {end}; deltaT 1e-10; adjustTimeStep yes;
maxCo 0.2; maxDeltaT 1; writeControl adjustableRunTime; writeInterval {end}; runTimeModifiable no;
functions {{ probes {{ type probes; libs (sampling); fields (p);
  writeControl timeStep; writeInterval 1;
  probeLocations ({places}); }} }}
""")  # fmt: skip


def probed(folder: Path) -> list[tuple[float, list[float]]]:
    """Times and pressures at the places."""
    path = next((folder / "postProcessing").rglob("p"))
    lines = path.read_text(encoding="utf-8").splitlines()
    rows = [line.split() for line in lines if line.strip() and not line.startswith("#")]
    return [(float(row[0]), [float(p) for p in row[1:]]) for row in rows]


def pressure(folder: Path) -> History:
    """Overpressure in the first cell over the floor, on the axis."""
    return [(t, p[0] - 101325) for t, p in probed(folder)]
