# SPDX-License-Identifier: MIT
"""P4: a steel plate under TNT, by a load of Kingery-Bulmash and by air."""

from dataclasses import replace

from studies.comparisons import bricks, kingery, plate
from studies.comparisons.case import Case, Quantity, Run

HALF, THICK, END = 0.125, 0.0042, 700e-6
MASS, AT = 0.168, (0.0, 0.0, 0.4)
STEEL = (
    "&material id = 'm', model = 'bilinear_j2', density = 7800, youngs_modulus = 200e9\n"
    "    poisson_ratio = 0.3, yield_stress = 350e6, tangent_modulus = 1e9 /"
)
LOAD = f"&load body = 'plate', faces = 'z+', mass = {MASS}, at = 0, 0, {AT[2]} /"
AIR = f"""&air
    box = 0, 0.2688,  0, 0.2688,  -0.0392, 0.4648,  cells = 48, 48, 90
    bc = 'symmetry', 'outflow',  'symmetry', 'outflow',  'outflow', 'outflow'
/
&charge id = 'tnt', mass = {MASS}, explosive = 'tnt', eos = 'ideal', at = 0, 0, {AT[2]} /"""
RADIAL = f"""&air
    box = 0, 0.2688,  0, 0.2688,  -0.0392, 0.672,  cells = 48, 48, 127
    bc = 'symmetry', 'outflow',  'symmetry', 'outflow',  'outflow', 'outflow'
/
&charge
    id = 'tnt', mass = {MASS}, explosive = 'tnt', eos = 'jwl', start = '1d', at = 0, 0, {AT[2]}
/"""
THREE, WIDE = plate.Shape(HALF, THICK, 3), plate.Shape(HALF, THICK, 3, 3)
STEP, START = 5e-6, 150e-6  # of CalculiX; the front arrives in the middle at 162 us
FEM = bricks.Plate(
    HALF,
    12,
    ((THICK, 2, "STEEL"),),
    {"STEEL": bricks.isotropic(200e9, 0.3, 7800, "350e6, 0.\n2360e6, 2.")},
    END,
    STEP,
)


def _ours(shape: plate.Shape, load: str, name: str, size: str = "", slow: bool = True) -> Run:
    run = plate.run("Steel plate under 168 g of TNT at 0.4 m", shape,
                    material=STEEL, load=load, t_end=END)  # fmt: skip
    return replace(run, name=name, size=run.size + size, slow=slow)


def _write_fem(folder):
    text = bricks.blast(FEM, START, kingery.load(MASS, AT, STEP))
    (folder / "model.inp").write_text(text, encoding="utf-8")


def _read_fem(folder):
    history = [(0.0, 0.0), *bricks.deflection(folder, START)]
    return plate.measures(history), history


CASE = Case(
    name="plate_blast",
    mark="P4",
    title="Steel plate under 168 g of TNT at 0.4 m",
    setting="Clamped plate, 250 x 250 x 4.2 mm, steel of P3. Kingery-Bulmash: 474 Pa s in the "
    "middle, 437 on average.",
    reference="CalculiX and OpenRadioss with a load of Kingery-Bulmash",
    quantities=(
        Quantity("peak", "peak", "mm", 1e3, 3, 6.98e-3, 0.05),
        Quantity("peak_time", "at", "us", 1e6, 3, 606e-6, 0.05),
    ),
    runs=(
        _ours(THREE, LOAD, "Brisance, &load, 3 layers"),
        _ours(plate.Shape(HALF, THICK, 5), LOAD, "Brisance, &load, 5 layers"),
        _ours(WIDE, LOAD, "Brisance, &load, 3 wide layers", slow=False),
        _ours(plate.Shape(HALF, THICK, 5, 3), LOAD, "Brisance, &load, 5 wide layers", slow=False),
        _ours(THREE, AIR, "Brisance, air, 3 layers", ", 207,360 cells"),
        _ours(THREE, RADIAL, "Brisance, air, JWL, 1-D, 3 layers", ", 292,608 cells"),
        Run(
            "CalculiX 12 x 12 x 2, K-B",
            "calculix",
            "12 x 12 x 2 C3D20R",
            _write_fem,
            _read_fem,
        ),
    ),
    axes=("time after detonation [us]", "deflection [mm]"),
    scales=(1e6, 1e3),
    remarks={
        "Brisance, air, 3 layers": "the load of the air is below the curves, mostly for want of "
        "heat and because the plate has edges (B3)",
        "Brisance, air, JWL, 1-D, 3 layers": "without the jet of a start on the grid in the middle",
        "Brisance, &load, 3 layers": "five to six times the time of 288 quadratic bricks, as three "
        "layers are 25,392 particles and short steps; aspect = 3, 3, 1 takes a tenth of it (P4')",
        "Brisance, &load, 3 wide layers": "an eighth of the particles of cubes",
        "OpenRadioss /LOAD/PBLAST": "the same load on 6,400 bricks: eight times quicker; its "
        "rule for faces hit obliquely was mended in February 2023",
        "CalculiX 12 x 12 x 2, K-B as recorded": "by which rule for faces hit "
        "obliquely is not told",
        "CalculiX 12 x 12 x 2, K-B": "the same load on 288 quadratic bricks: five to six times "
        "quicker than ours; begins when the front is there",
        "Brisance 592ab95, air, wide box": "right by two errors: a load that is 17 % low over the "
        "plate, a plate that was 13 % too soft",
    },
)
