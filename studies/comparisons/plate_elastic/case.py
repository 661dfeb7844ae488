# SPDX-License-Identifier: MIT
"""P1: an elastic clamped plate under a short pressure, small deflections."""

from functools import partial

import numpy as np

from studies.comparisons import bricks, mindlin, plate
from studies.comparisons.case import Case, Quantity, Run

HALF, THICK, END = 0.1, 0.01, 600e-6
STEEL = (
    "&material id = 'm', model = 'linear_elastic', density = 7800, youngs_modulus = 200e9, "
    "poisson_ratio = 0.3 /"
)
LOAD = "&load body = 'plate', faces = 'z+', time = 0, 50e-6, pressure = {p}, {p} /"


def make(pressure: float, name: str, mark: str, title: str, **more) -> Case:
    """The case for a pressure: here the small one, in plate_elastic_large the large one."""

    def ours(layers: int, wide: float = 0, reach: float = 0) -> Run:
        shape = plate.Shape(HALF, THICK, layers, wide, reach)
        return plate.run(title, shape, partial(plate.measures, swing=True), material=STEEL,
                         load=LOAD.format(p=f"{pressure:g}"), t_end=END)  # fmt: skip

    def peer(elements: int, across: int, slow: bool = False) -> Run:
        fem = bricks.Plate(HALF, elements, ((THICK, across, "STEEL"),),
                           {"STEEL": bricks.isotropic(200e9, 0.3, 7800)}, END, 2.5e-6)  # fmt: skip
        return bricks.run(fem, pressure, 50e-6, partial(plate.measures, swing=True), slow)

    runs = (
        ours(3),
        ours(4),
        ours(4, 3, 0.27),
        ours(5, 3, 0.27),
        peer(10, 1),
        peer(20, 2, slow=True),
    )
    return Case(name=name, mark=mark, title=title, runs=runs, **more)


CASE = make(
    0.1e6,
    "plate_elastic",
    "P1",
    "Elastic plate, small deflection",
    setting="Clamped steel plate, 200 x 200 x 10 mm (E 200 GPa, nu 0.3, 7800 kg/m3), 0.1 MPa for "
    "50 us.",
    reference="modes of a Mindlin plate (studies/comparisons/mindlin.py)",
    quantities=(
        Quantity("peak", "peak", "um", 1e6, 4, 9.229e-6, 0.015),
        Quantity("peak_time", "at", "us", 1e6, 4, 133.1e-6, 0.02),
        Quantity("back", "first back", "us", 1e6, 4, 269.7e-6, 0.015),
    ),
    remarks={
        "CalculiX 20 x 20 x 2": "0.7 % above 10 x 10 x 1 after the second layer of elements, 0.1 % "
        "more after the finer ones, 0.2 % after half the increment; the rest of the 1.2 % is the "
        "clamp, which holds the rim in space and only in the middle plane of Mindlin's",
        "Brisance, 3 layers": "too stiff by 2 % against the same elements",
        "Brisance, 4 layers": "0.7 % below the elements",
        "Brisance, 4 wide layers": "aspect = 3, 3, 1: a sixth of the time of cubes (solid.md)",
    },
    axes=("time [us]", "deflection [um]"),
    scales=(1e6, 1e6),
    exact=lambda: mindlin.pulse_deflection(
        mindlin.Square(HALF, THICK, 200e9, 0.3, 7800), 0.1e6, 50e-6, np.linspace(0, END, 301)
    ),
)
