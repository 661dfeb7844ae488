# SPDX-License-Identifier: MIT
"""The paper's plate under blast: by our air, by our load, by the same load on elements."""

from __future__ import annotations

from studies.comparisons import bricks, kingery, plate
from studies.comparisons.case import Case, Quantity, Run

HALF, THICK, END = 0.125, 0.0042, 450e-6
MASS, AT = 0.168, (0.0, 0.0, 0.4)
STEP, START = 5e-6, 150e-6
E, NU, G = (55e9, 55e9, 7e9), (0.25, 0.25, 0.25), (4.5e9, 1.8e9, 1.8e9)
ELASTIC = """&material
    id = 'm', model = 'orthotropic_ply', density = 1500, woven = .true.
    e1 = 55e9, e2 = 55e9, e3 = 7e9
    nu12 = 0.25, nu13 = 0.25, nu23 = 0.25, g12 = 4.5e9, g13 = 1.8e9, g23 = 1.8e9
/"""
BREAKS = "&material id = 'm', preset = 'cfrp_woven' /"
LOAD = f"&load body = 'plate', faces = 'z+', mass = {MASS}, at = 0, 0, {AT[2]} /"
FEM = bricks.Plate(
    HALF,
    12,
    ((THICK, 2, "CLOTH"),),
    {"CLOTH": bricks.orthotropic(E, NU, G, 1500)},
    END,
    STEP,
)


def measures(history):
    """Deflection at 0.3 and 0.42 ms."""

    def at(time):
        return min(history, key=lambda point: abs(point[0] - time))[1]

    return {"w300": at(300e-6), "w420": at(420e-6)}


def _ours(name: str, material: str, wide: float = 0, reach: float = 0) -> Run:
    shape = plate.Shape(HALF, THICK, 3, wide, reach)

    def write(folder):
        plate.write(
            folder,
            "The paper's plate under 168 g of TNT, without air",
            shape,
            material=material,
            load=LOAD,
            t_end=END,
        )

    def read(folder):
        history = plate.deflection(folder)
        return measures(history), history

    return Run(name, "brisance", plate.size(shape), write, read, slow=not wide)


def _write_fem(folder):
    text = bricks.blast(FEM, START, kingery.load(MASS, AT, STEP))
    (folder / "model.inp").write_text(text, encoding="utf-8")


def _read_fem(folder):
    history = [(0.0, 0.0), *bricks.deflection(folder, START)]
    return measures(history), history


CASE = Case(
    name="paper_plate",
    mark="B2",
    title="The paper's plate of CFRP under 168 g of TNT",
    setting="Chen et al., section 3.1.2: woven plate, 250 x 250 x 4.2 mm, clamped, charge at 0.4 "
    "m. Without strengths (elastic) "
    "the load of Kingery-Bulmash in both codes; with them (breaks) by that load and by air.",
    reference="CalculiX, elastic, K-B",
    quantities=(
        Quantity("w300", "at 0.3 ms", "mm", 1e3, 3),
        Quantity("w420", "at 0.42 ms", "mm", 1e3, 3),
    ),
    runs=(
        _ours("Brisance, &load, elastic", ELASTIC),
        Run("CalculiX, K-B, elastic", "calculix", "12 x 12 x 2 C3D20R", _write_fem, _read_fem),
        _ours("Brisance, &load, breaks", BREAKS),
        _ours("Brisance, &load, elastic, wide", ELASTIC, 3, 0.27),
    ),
    axes=("time after detonation [us]", "deflection [mm]"),
    scales=(1e6, 1e3),
    remarks={
        "Brisance, air, breaks, 0.3 mm": "the resolution of the paper, "
        "docs/evidence/validation.md: the load of the air is 0.84 of "
        "Kingery-Bulmash's, and the plate breaks through",
        "Brisance, &load, elastic": "eight times the time of 288 quadratic bricks; 0.9 s on an "
        "H200",
        "Brisance, &load, elastic, wide": "on one machine 36 s for the first 250 us, cubes 105 s "
        "for 74 us: a tenth; what breaks takes cubes",
        "CalculiX, K-B, elastic": "eight times quicker; it has no progressive damage of "
        "plies, so it cannot follow the plate further",
        "Chen et al. (paper)": "largest deflection; what is left open there (clamp, load, "
        "compression) decides",
    },
)
