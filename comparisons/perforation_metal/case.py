# SPDX-License-Identifier: MIT
"""Aluminium through aluminium at 3.1 km/s (docs/validation.md)."""

from comparisons.case import Case, Quantity

CASE = Case(
    name="perforation_metal",
    mark="I1",
    title="Aluminium through 2 mm at 3.1 km/s",
    setting="Howell and Ball, J. Comput. Phys. 2002: plane strain, cylinder of 10 mm, elastic, "
    "perfectly plastic metal, "
    "hole after 8 us.",
    reference="Howell and Ball, Eulerian, as quoted by later papers",
    quantities=(Quantity("hole", "hole", "mm", 1e3, 3, 19.2e-3, 0.06),),
    remarks={
        "Brisance, 0.25 mm": "half a spacing of it is how the edge is told; the slot opens at 0.4 "
        "mm/us",
        "SPH of others, quoted": "higher by what the edge of a hole is taken to be",
    },
    text="The table of [validation.md](validation.md) has the hole against time, yield stress and "
    "spall limit: each moves "
    "it by more than the codes differ.",
)
