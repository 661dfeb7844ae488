# SPDX-License-Identifier: MIT
"""T1: the bar of copper that codes are tried with, elastic and linearly hardening."""

from studies.comparisons import bar
from studies.comparisons.case import Case, Quantity

COPPER = (
    "&material id = 'm', model = 'bilinear_j2', density = 8930, youngs_modulus = 117e9\n"
    "    poisson_ratio = 0.35, yield_stress = 400e6, tangent_modulus = 99.915e6 /"
)
BAR = bar.Bar(3.2e-3, 32.4e-3, 227.0, 0.64e-3, COPPER)
SAME = {"density": 8930, "young": 117e9, "poisson": 0.35, "yield_stress": 0.4e9, "hardening": 0.1e9}

CASE = Case(
    name="taylor_bilinear",
    mark="T1",
    title="Taylor bar of copper, bilinear",
    setting="32.4 x 6.4 mm, 227 m/s, 8930 kg/m3, E 117 GPa, nu 0.35, yield stress 0.4 GPa, "
    "plastic modulus 0.1 GPa; "
    "after 80 us, the foot held in z.",
    reference="middle of published finite elements (21.4-21.6; 7.0-7.2 mm)",
    quantities=(
        Quantity("length", "length", "mm", 1e3, 4, 21.5e-3, 0.03),
        Quantity("foot", "foot, radius", "mm", 1e3, 3, 7.1e-3),
        Quantity("rim", "outermost particle", "mm", 1e3, 3),
    ),
    runs=(
        bar.ours(BAR, "Brisance"),
        bar.ours(BAR, "Brisance, total_lagrangian",
                 "formulation = 'total_lagrangian', zeta = 0.02, alpha = 0.3"),
        bar.lammps(BAR, "LAMMPS, q1 0.56, hourglass 10", q1=0.56, hourglass=10.0, **SAME),
        bar.lammps(BAR, "LAMMPS, q1 0.06, hourglass 1", q1=0.06, hourglass=1.0, **SAME),
    ),
    remarks={
        "LAMMPS, q1 0.56, hourglass 10": "its usual values: viscosity takes what should be plastic "
        "work; the whole bar, four times our particles",
        "LAMMPS, q1 0.06, hourglass 1": "nearer to the others; fourteen times the time of ours for "
        "four times the particles",
        "Brisance": "length as wanted; the outer ring of the foot comes apart",
        "Brisance, total_lagrangian": "the form for metal that flows far without failing; five "
        "times the time, as its steps follow the most flattened particle",
        "OpenRadioss HEPH, 6 per radius": "as quick as ours, foot too narrow at this resolution",
        "LAMMPS, q1 0.56, hourglass 10, as recorded": "its usual values: viscosity takes what "
        "should be plastic work",
    },
)  # fmt: skip
