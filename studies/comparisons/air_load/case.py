# SPDX-License-Identifier: MIT
"""B3: what the load of our air on a plate is made of: charge, cells, box, edges, boundary."""

import math

from post.blast import free_air
from studies.comparisons.case import Case, History, Quantity, Run
from studies.comparisons.reading import column, impulses

MASS, AT, HALF, THICK, END = 0.168, 0.4, 0.125, 0.0042, 0.7e-3
SPACING, RIM, DENSITY = 1.4e-3, 0.1292, 7.8e6  # of a rigid plate so heavy that it stays
SIDE = 6  # gauges along a side of the quarter
PLACES = [(k + 0.5) * HALF / SIDE for k in range(SIDE)]
WORDS = {"ideal": "eos = 'ideal'", "ideal, 1-D": "eos = 'ideal', start = '1d'",
         "JWL, 1-D": "eos = 'jwl', start = '1d'",
         "JWL, 2-D": "eos = 'jwl', start = '2d'",
         "ideal, 4.52 MJ/kg": "eos = 'ideal', energy = 4.52e6"}  # fmt: skip
DECK = """The load of a charge on {what}, a quarter, written by studies/comparisons/air_load.

&run t_end = {end}, symmetry = 'x', 'y' /
&air
    box = 0, {wide:g},  0, {wide:g},  {low:g}, {top:g},  cells = {n}, {n}, {m}
    bc = 'symmetry', 'outflow',  'symmetry', 'outflow',  '{floor}', 'outflow'
/
&charge id = 'tnt', mass = {mass}, explosive = 'tnt', {charge}, at = 0, 0, {at} /
{body}{gauges}
&output history_every = 4e-7 /
"""
PLATE = """&material id = 'm', model = 'linear_elastic', density = {density}
    youngs_modulus = 200e9, poisson_ratio = 0.3 /
&body id = 'plate', box = -{rim:g}, {rim:g}, -{rim:g}, {rim:g}, -{thick}, 0
    spacing = {spacing}, material = 'm', formulation = 'rigid' /
&gauge id = 'speed', at = 0, 0, -{middle:g}, body = 'plate', quantity = 'velocity_z' /
"""


def impulse(history: History) -> float:
    """Of the positive phase: the most that the integral over time comes to [Pa s]."""
    return max(total for _, total in impulses(history))


def curves() -> tuple[float, float]:
    """Kingery-Bulmash: impulse in the middle, and the mean at the gauges [Pa s]."""

    def at(x: float, y: float) -> float:
        distance = math.hypot(x, y, AT)
        return free_air(MASS, distance).on_surface(math.acos(AT / distance))[1]

    return at(0, 0), sum(at(x, y) for x in PLACES for y in PLACES) / SIDE**2


def run(charge: str, cell: float, wide: float = 0.2688, rim: float = 0.0, slow: bool = True) -> Run:
    """On a rigid floor, or on a rigid plate of half a side `rim` in the air."""
    low = -7 * cell if rim else 0.0
    top = 0.672 if "-D" in charge else 0.4704  # the blast leaves its line where the box ends
    n, m = round(wide / cell), round((top - low) / cell)

    def write(folder):
        plate = PLATE.format(density=DENSITY, rim=rim, thick=THICK, spacing=SPACING,
                             middle=THICK / 2)  # fmt: skip
        places = [("A", 0.0, 0.0)]
        places += [(f"g{j}{k}", x, y) for j, y in enumerate(PLACES) for k, x in enumerate(PLACES)]
        gauges = [
            f"&gauge id = '{name}', at = {x:.6g}, {y:.6g}, {cell / 2:.6g}, "
            "quantity = 'overpressure' /"
            for name, x, y in places
        ]
        text = DECK.format(what="a rigid plate" if rim else "a rigid floor", end=END, wide=wide,
                           low=low, top=top, n=n, m=m,
                           floor="outflow" if rim else "wall", mass=MASS,
                           charge=WORDS[charge], at=AT, body=plate if rim else "",
                           gauges="\n".join(gauges))  # fmt: skip
        (folder / "deck.nml").write_text(text, encoding="utf-8")

    def read(folder):
        middle = column(folder, "A")
        names = [f"g{j}{k}" for j in range(SIDE) for k in range(SIDE)]
        found = {
            "middle": impulse(middle),
            "mean": sum(impulse(column(folder, name)) for name in names) / SIDE**2,
            "peak": max(p for _, p in middle),
        }
        if rim:
            found["body"] = -min(v for _, v in column(folder, "speed")) * DENSITY * THICK
        return found, middle

    place = "floor" if not rim else f"plate of {2 * rim:.2f} m"
    box = "" if wide == 0.2688 else f", box of {wide:.2f} m"
    name = f"Brisance, {charge}, {1e3 * cell:.1f} mm, {place}{box}"
    return Run(name, "brisance", f"{n * n * m:,} cells", write, read, slow)


MIDDLE, MEAN = curves()
COARSE, FINE = 5.6e-3, 5.6e-3 * 2 / 3
CASE = Case(
    name="air_load",
    mark="B3",
    title="What the load of our air on a plate is made of",
    setting="The charge of P4 over a rigid floor, and over a rigid plate in the air, as wide as "
    "that of P4 with its clamp or as wide as the box. Impulses of the positive phase: in the "
    "middle, the mean over the 250 x 250 mm of P4 (36 gauges), and what a rigid plate takes up, "
    "over its whole face.",
    reference="Kingery-Bulmash, on a wall without end",
    quantities=(
        Quantity("mean", "mean", "Pa s", 1, 3, MEAN),
        Quantity("middle", "middle", "Pa s", 1, 3, MIDDLE),
        Quantity("body", "taken up", "Pa s", 1, 3),
        Quantity("peak", "peak", "MPa", 1e-6, 3, free_air(MASS, AT).reflected_overpressure),
    ),
    runs=(
        run("ideal", COARSE, slow=False),
        run("ideal", FINE),
        run("ideal", COARSE, wide=0.4032),
        run("ideal, 4.52 MJ/kg", COARSE),
        run("ideal, 1-D", COARSE),
        run("JWL, 1-D", COARSE),
        run("JWL, 1-D", FINE),
        run("JWL, 2-D", COARSE),
        run("ideal", COARSE, rim=0.2688),
        run("ideal", COARSE, rim=RIM),
    ),
    remarks={
        "Brisance, ideal, 5.6 mm, floor": "the air of P4 over a wall without end: 6 % low in the "
        "middle, 13 % over the plate",
        "Brisance, ideal, 3.7 mm, floor": "finer cells: 2 % more over the plate, but 9 % more in "
        "the middle: a charge started on the grid throws a jet along its axes",
        "Brisance, ideal, 5.6 mm, floor, box of 0.40 m": "the sides of the box give nothing back",
        "Brisance, ideal, 4.52 MJ/kg, 5.6 mm, floor": "2.7 % for 5.3 % more energy",
        "Brisance, ideal, 1-D, 5.6 mm, floor": "started along the radius: no jet; 11 % low is what "
        "an ideal gas of that energy gives",
        "Brisance, JWL, 2-D, 5.6 mm, floor": "the same sphere started in its plane: 0.2 % of the "
        "1-D start's mean impulse, 1.3 % in the middle",
        "Brisance, JWL, 1-D, 3.7 mm, floor": "14 % low is what TNT gives that does not burn on in "
        "the air (validation.md)",
        "Brisance, ideal, 5.6 mm, plate of 0.54 m": "the immersed boundary of a plate is a wall: "
        "the same within 1e-5",
        "Brisance, ideal, 5.6 mm, plate of 0.26 m": "the air flows round the edges: 7 % less over "
        "the plate, which the curves do not know; the rigid plate takes up 4 % more than the "
        "gauges over it say",
    },
    text="So of the 20 % by which the load of our air on the plate of P4 (mean 351 Pa s at the "
    "gauges) is below the curves, 11 % are heat of the products that is missing or comes later, "
    "2 % cells of 5.6 mm, 6 % the edges of a plate that hangs in the air, and less than 1 % that "
    "it yields; box and immersed boundary give nothing. The middle is right by chance: a jet from "
    "the start on the grid adds 6 to 16 % there. Only the 2 % are an error of the scheme. "
    "Started along the radius the air has 0.93 of the impulse of the middle over the plate, the "
    "curves have 0.92.",
    axes=("time [us]", "overpressure in the middle [MPa]"),
    scales=(1e6, 1e-6),
)
