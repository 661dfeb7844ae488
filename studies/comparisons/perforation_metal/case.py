# SPDX-License-Identifier: MIT
"""Aluminium through aluminium at 3.1 km/s (docs/evidence/validation.md)."""

from studies.comparisons import cylinder
from studies.comparisons.case import Case, Quantity

CASE = Case(
    name="perforation_metal",
    mark="I1",
    title="Aluminium through 2 mm at 3.1 km/s",
    setting="Howell and Ball, J. Comput. Phys. 2002: plane strain, cylinder of 10 mm, elastic, "
    "perfectly plastic metal, after 8 us. Hole: between the edges of what hangs together with the "
    "ends of the plate; opening: the same between the planes of its faces.",
    reference="Howell and Ball, Eulerian, as quoted by later papers",
    quantities=(
        Quantity("hole", "hole", "mm", 1e3, 3, 19.2e-3, 0.06),
        Quantity("opening", "opening", "mm", 1e3, 3),
    ),
    runs=(
        cylinder.ours(0.25e-3),
        cylinder.ours(0.125e-3),
        cylinder.lammps(0.25e-3, 1.0, 0.0),
        cylinder.lammps(0.125e-3, 1.0, 0.0),
    ),
    remarks={
        "Brisance, 0.125 mm": "fragments that touch the edge count; by neighbours on the lattice "
        "it is 18.4 mm (validation.md)",
        "LAMMPS, ULSPH, 0.25 mm, q1 1": "the same opening as ours; nothing parts, as its updated "
        "Lagrangian particles have no limit in tension",
        "SPH of others, quoted": "higher by what the edge of a hole is taken to be",
    },
    text="LAMMPS: package MACHDYN, updated Lagrangian, Tait's equation of state with the exponent "
    "4 s - 1, which bends the compression curve as ours does. The table of "
    "[validation.md](../../docs/evidence/validation.md) has the hole against time, yield stress "
    "and spall limit: each moves it by more than the codes differ.",
)
