# SPDX-License-Identifier: MIT
"""P3: a steel plate that yields."""

from functools import partial

from studies.comparisons import bricks, plate
from studies.comparisons.case import Case, Quantity, Run

HALF, THICK, END = 0.1, 0.01, 600e-6
PRESSURE, DURATION = 100e6, 50e-6
STEEL = (
    "&material id = 'm', model = 'bilinear_j2', density = 7800, youngs_modulus = 200e9\n"
    "    poisson_ratio = 0.3, yield_stress = 350e6, tangent_modulus = 1e9 /"
)
HARDENING = "350e6, 0.\n2360e6, 2."
LOAD = (
    f"&load body = 'plate', faces = 'z+', time = 0, {DURATION}, pressure = {PRESSURE:g}, "
    f"{PRESSURE:g} /"
)
MEASURE = partial(plate.measures, residual=(400e-6, 600e-6))


def _ours(layers: int, wide: float = 0) -> Run:
    return plate.run("Steel plate that yields", plate.Shape(HALF, THICK, layers, wide), MEASURE,
                     material=STEEL, load=LOAD, t_end=END)  # fmt: skip


def _peer(elements: int, slow: bool = False) -> Run:
    steel = bricks.isotropic(200e9, 0.3, 7800, HARDENING)
    fem = bricks.Plate(HALF, elements, ((THICK, 2, "STEEL"),), {"STEEL": steel}, END, 2.5e-6)
    return bricks.run(fem, PRESSURE, DURATION, MEASURE, slow)


CASE = Case(
    name="plate_steel",
    mark="P3",
    title="Steel plate that yields",
    setting="The plate of P1 of bilinear J2 steel (350 MPa, tangent modulus 1 GPa), 100 MPa for "
    "50 us.",
    reference="mean of CalculiX and of four fully integrated OpenRadioss, 18.1 to 19.4 mm",
    quantities=(
        Quantity("peak", "peak", "mm", 1e3, 4, 18.7e-3, 0.05),
        Quantity("peak_time", "at", "us", 1e6, 4),
        Quantity("stays", "mean of 400 to 600 us", "mm", 1e3, 4, 17.7e-3, 0.05),
    ),
    runs=(
        _ours(3),
        _ours(4),
        _ours(5),
        _ours(3, 3),
        _ours(4, 3),
        _ours(5, 3),
        _peer(10),
        _peer(20, slow=True),
    ),
    axes=("time [us]", "deflection [mm]"),
    scales=(1e6, 1e3),
    remarks={
        "OpenRadioss HEPH 20 x 20 x 4": "quick, and the softest to its own refinement",
        "OpenRadioss Isolid 18, 20 x 20 x 4": "as near as our cubes in half the time, as our five "
        "wide layers in the same",
        "CalculiX 10 x 10 x 2, as recorded": "its impulse is some 3 to 5 % too large",
        "Brisance, 3 layers": "twice the time of bricks as near, ten times that of one-point "
        "bricks: 60 neighbours a particle",
        "Brisance, 3 wide layers": "aspect = 3, 3, 1: a tenth of the time of cubes, and less than "
        "one-point bricks that are 6 % off",
        "Brisance, 4 wide layers": "as cubes of four layers: their plastic moment is 1.03",
        "Brisance, 4 layers": "four keep 2 % less than three and 4 % less than five (solid.md)",
    },
)
