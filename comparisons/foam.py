# SPDX-License-Identifier: MIT
"""A blast on a rigid floor for rhoCentralFoam of OpenFOAM: a wedge of 2 degrees about the axis.

The axis is x (upwards from the floor at 0), y the radius. Cells are square. Kurganov's flux,
minmod (with van Leer's and van Albada's limiters this balloon ends in a negative temperature),
Euler steps at a Courant number of 0.2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from comparisons.case import History

HEAD = "FoamFile {{ version 2.0; format ascii; class {kind}; object {name}; }}\n"
GAS = 287.05  # J/(kg K)


@dataclass(frozen=True)
class Balloon:
    """Hot gas at rest, in SI units."""

    radius: float
    at: float  # height over the floor
    density: float
    pressure: float


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
    inside = f"dimensions {dimensions};\ninternalField uniform {value};\n"
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


def write(
    folder: Path, space: tuple[float, float], cell: float, balloon: Balloon, end: float
) -> None:
    """Write the case: a space of a height and a radius, a balloon over its floor."""
    height, radius = space
    for name in ("0", "constant", "system"):
        (folder / name).mkdir()

    def put(place: str, kind: str, text: str) -> None:
        name = place.split("/")[1]
        (folder / place).write_text(HEAD.format(kind=kind, name=name) + text, encoding="utf-8")

    (folder / "system/blockMeshDict").write_text(_mesh(height, radius, cell), encoding="utf-8")
    still = 101325 / (GAS * 1.225)
    for name, dimensions, value, kind in (
        ("p", "[1 -1 -2 0 0 0 0]", "101325", "scalar"),
        ("T", "[0 0 0 1 0 0 0]", f"{still:.6f}", "scalar"),
        ("U", "[0 1 -1 0 0 0 0]", "(0 0 0)", "vector"),
    ):
        text = _field(name, dimensions, value, kind, "zeroGradient")
        (folder / "0" / name).write_text(text, encoding="utf-8")
    put("constant/thermophysicalProperties", "dictionary", f"""thermoType
{{ type hePsiThermo; mixture pureMixture; transport const; thermo eConst;
  equationOfState perfectGas;
  specie specie; energy sensibleInternalEnergy; }}
mixture {{ specie {{ molWeight {8314.46 / GAS:.6f}; }}
  thermodynamics {{ Cv {GAS / 0.4:.4f}; Hf 0; }}
  transport {{ mu 0; Pr 1; }} }}
""")  # fmt: skip
    put("constant/turbulenceProperties", "dictionary", "simulationType laminar;\n")
    put("system/fvSchemes", "dictionary", """fluxScheme Kurganov;
ddtSchemes { default Euler; }
gradSchemes { default Gauss linear; }
divSchemes { default none; div(tauMC) Gauss linear; }
laplacianSchemes { default Gauss linear corrected; }
interpolationSchemes { default linear; reconstruct(rho) Minmod; reconstruct(U) Minmod;
  reconstruct(T) Minmod; }
snGradSchemes { default corrected; }
""")  # fmt: skip
    put("system/fvSolution", "dictionary", """solvers
{ "(rho|rhoU|rhoE)" { solver diagonal; }
  U { solver smoothSolver; smoother GaussSeidel; tolerance 1e-9; relTol 0.01; }
  e { $U; tolerance 1e-10; relTol 0; } }
""")  # fmt: skip
    put("system/controlDict", "dictionary", f"""application rhoCentralFoam;
startFrom startTime; startTime 0; stopAt endTime; endTime {end}; deltaT 1e-10; adjustTimeStep yes;
maxCo 0.2; maxDeltaT 1; writeControl adjustableRunTime; writeInterval {end}; runTimeModifiable no;
functions {{ floor {{ type probes; libs (sampling); fields (p);
  writeControl timeStep; writeInterval 1;
  probeLocations (({cell / 2} {cell / 2} 0)); }} }}
""")  # fmt: skip
    hot = balloon.pressure / (GAS * balloon.density)
    put("system/setFieldsDict", "dictionary", f"""defaultFieldValues ();
regions ( sphereToCell {{ centre ({balloon.at} 0 0); radius {balloon.radius};
  fieldValues ( volScalarFieldValue p {balloon.pressure} volScalarFieldValue T {hot} ); }} );
""")  # fmt: skip


def pressure(folder: Path) -> History:
    """Overpressure in the first cell over the floor, on the axis."""
    path = next((folder / "postProcessing").rglob("p"))
    lines = path.read_text(encoding="utf-8").splitlines()
    rows = [line.split() for line in lines if line.strip() and not line.startswith("#")]
    return [(float(row[0]), float(row[1]) - 101325) for row in rows]
