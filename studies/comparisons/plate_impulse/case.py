# SPDX-License-Identifier: MIT
"""P4': the plate of P4 under a uniform pulse of the same mean impulse."""

from dataclasses import replace

from studies.comparisons import plate
from studies.comparisons.case import Case, Quantity, Run
from studies.comparisons.plate_blast.case import HALF, STEEL, THICK

PRESSURE, DURATION, END = 8.56e6, 50e-6, 550e-6
LOAD = (
    f"&load body = 'plate', faces = 'z+', time = 0, {DURATION}, pressure = {PRESSURE:g}, "
    f"{PRESSURE:g} /"
)


def _ours(layers: int, wide: float = 0, slow: bool = False) -> Run:
    run = plate.run("Steel plate under 428 Pa s", plate.Shape(HALF, THICK, layers, wide),
                    material=STEEL, load=LOAD, t_end=END)  # fmt: skip
    return replace(run, slow=slow)


CASE = Case(
    name="plate_impulse",
    mark="P4'",
    title="The same plate under an even 428 Pa s",
    setting="The plate of P4 under 8.56 MPa for 50 us: what the plate does without the questions "
    "of its load.",
    reference="OpenRadioss, full integration, as recorded",
    quantities=(
        Quantity("peak", "peak", "mm", 1e3, 3, 6.95e-3, 0.04),
        Quantity("peak_time", "at", "us", 1e6, 3, 440e-6, 0.03),
    ),
    runs=(_ours(3, slow=True), _ours(3, 3), _ours(5, 3)),
    axes=("time [us]", "deflection [mm]"),
    scales=(1e6, 1e3),
    remarks={
        "Brisance, 3 layers": "within 2 %, but four times the time of 6,400 bricks of 8 points: "
        "aspect = 3, 3, 1 takes a tenth of it",
        "Brisance, 3 wide layers": "on one machine 14 s for the first 110 us, cubes 105 s for 84 "
        "us: a tenth",
        "Brisance 592ab95, bending, zeta 0.1": "before plates of metal had tilted gradients",
    },
)
