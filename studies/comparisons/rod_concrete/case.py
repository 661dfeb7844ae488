# SPDX-License-Identifier: MIT
"""A rod through 178 mm of concrete (inputs/jobs/rod_concrete.nml, docs/evidence/validation.md)."""

from studies.comparisons.case import Case, Quantity

CASE = Case(
    name="rod_concrete",
    mark="I2",
    title="A rigid rod through 178 mm of concrete",
    setting="Hanchak, Forrestal, Young and Ehrgott 1992: 0.5 kg, 25.4 mm, ogive of CRH 3, "
    "concrete of 48 MPa; velocity "
    "behind the slab for three velocities before it.",
    reference="experiment",
    quantities=(
        Quantity("v434", "from 434", "m/s", 1, 3, 214, 0.1),
        Quantity("v749", "from 749", "m/s", 1, 3, 615, 0.05),
        Quantity("v1058", "from 1058", "m/s", 1, 3, 947, 0.05),
    ),
    remarks={
        "Brisance, hjc_48, 3 mm": "434 m/s is near the limit of perforation: 1 % of the energy "
        "that the slab takes is 3 % of the velocity",
        "LS-DYNA, modified HJC": "a third stress invariant and a damage of its own in tension; "
        "ours has both in concrete_48",
    },
    text="None of the codes that can be installed from packages has a law for concrete under "
    "pressure (LAMMPS: von Mises; CalculiX: no equation of state). Published beside it: "
    "Polanco-Loria, Hopperstad, Borvik and Berstad, Int. J. Impact Eng. "
    "35 (2008) 290, a modified "
    "HJC model in LS-DYNA: ballistic limits of concrete slabs within 8 % of experiments "
    "(abstract). Ours of this slab is "
    "not told; at 434 m/s and 3 mm hjc_48 takes 19 % and concrete_48 15 % less energy out of the "
    "rod than was measured.",
)
