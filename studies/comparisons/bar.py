# SPDX-License-Identifier: MIT
"""Taylor's bar: a deck of Brisance, a model of LAMMPS, and what is measured on the bar at rest.

The bar flies down at a wall that holds its foot in z, as a plane of symmetry does. Length: of the
highest particle, and half a spacing. Foot: radius of the surface, told from the mean r/R of the
outer ring of the widest layer, as finite elements tell it; `rim`: the outermost particle.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from post.reader import Run as Results
from studies.comparisons.case import History, Measures, Run


@dataclass(frozen=True)
class Bar:
    """SI units."""

    radius: float
    length: float
    speed: float
    spacing: float
    material: str  # of Brisance, id 'm'
    t_end: float = 80e-6


DECK = """Taylor's bar, a quarter of it, written by studies/comparisons/bar.py.
The plane z = 0 is the wall.

&run t_end = {end}, symmetry = 'x', 'y', 'z' /
{material}
&body
    id = 'bar', shape = 'cylinder'
    centre = 0, 0, {middle}, radius = {radius}, length = {length}
    spacing = {spacing}, material = 'm', velocity = 0, 0, -{speed}{more}
/
&gauge id = 'top', at = 0, 0, {length}, body = 'bar', quantity = 'displacement_z' /
&output dump_every = {end}, history_every = {every} /
"""


def measure(bar: Bar, start: np.ndarray, end: np.ndarray) -> Measures:
    """Shape of the bar from the places (n, 3) of its particles before and after."""
    before, after = (np.hypot(p[:, 0], p[:, 1]) for p in (start, end))
    ring = before > bar.radius - bar.spacing
    layer = (start[ring, 2] / bar.spacing).astype(int)
    widths = np.bincount(layer, after[ring] / before[ring]) / np.bincount(layer)
    return {
        "length": float(end[:, 2].max() + bar.spacing / 2),
        "foot": float(bar.radius * widths.max()),
        "rim": float(after.max()),
    }


def ours(bar: Bar, name: str, more: str = "") -> Run:
    """A run of Brisance; `more`: further keys of the body."""

    def write(folder: Path) -> None:
        text = DECK.format(end=bar.t_end, material=bar.material, middle=bar.length / 2,
                           radius=bar.radius, length=bar.length, spacing=bar.spacing,
                           speed=bar.speed, more=more and f"\n    {more}",
                           every=bar.t_end / 200)  # fmt: skip
        (folder / "deck.nml").write_text(text, encoding="utf-8")

    def read(folder: Path) -> tuple[Measures, History]:
        run = Results(folder / "out" / "deck")
        solid = run.frames[-1].solid("displacement")
        found = measure(bar, solid.points - solid.field["displacement"], solid.points)
        return found, []

    return Run(name, "brisance", f"{count(bar) // 4:,} particles (a quarter)", write, read)


def count(bar: Bar) -> int:
    """Particles of the whole bar, about."""
    return round(np.pi * bar.radius**2 * bar.length / bar.spacing**3)


# The total-Lagrangian SPH of LAMMPS (package MACHDYN), the whole bar.
MODEL = """# Taylor's bar, written by studies/comparisons/bar.py
units si
dimension 3
boundary f f f
atom_style smd
atom_modify map array
comm_modify vel yes
newton off
region space block -{wide} {wide} -{wide} {wide} -{spacing} {high} units box
create_box 1 space
lattice sc {spacing} origin 0.5 0.5 0.5
region bar cylinder z 0 0 {radius} 0 {length} units box
create_atoms 1 region bar
group tlsph type 1
region low block INF INF INF INF INF {spacing} units box
group foot region low
set group all volume {volume}
set group all smd/mass/density {density}
set group all diameter {reach}
neighbor {skin} bin
neigh_modify every 10 delay 0 check yes
pair_style smd/tlsph
pair_coeff 1 1 *COMMON {density} {young} {poisson} {q1} 0.0 {hourglass} 1.0 &
    *STRENGTH_LINEAR_PLASTIC {yield_stress} {hardening} &
    *EOS_LINEAR &
    *END
velocity all set 0.0 0.0 -{speed} units box
velocity foot set NULL NULL 0.0 units box
timestep 1e-9
fix step all smd/adjust_dt 0.1
fix move all smd/integrate_tlsph
fix wall foot smd/setvel NULL NULL 0.0
"""
LAST = """dump shape all custom 100000000 shape.*.dump id x y z
dump_modify shape sort id
thermo 2000
run 0
variable now equal time
fix done all halt 20 v_now >= {end} error continue
run 10000000
write_dump all custom end.dump id x y z modify sort id
"""


def lammps(bar: Bar, name: str, **constants: float) -> Run:
    """A run of LAMMPS. Constants: density, young, poisson, yield_stress, hardening (SI), hourglass
    and q1, the linear artificial viscosity."""

    def write(folder: Path) -> None:
        text = (MODEL + LAST).format(
            wide=5 * bar.radius, high=1.2 * bar.length, spacing=bar.spacing, radius=bar.radius,
            length=bar.length, volume=bar.spacing**3, reach=2.01 * 1.5 * bar.spacing,
            skin=0.5 * bar.spacing, speed=bar.speed, end=bar.t_end, **constants)  # fmt: skip
        (folder / "model.lmp").write_text(text, encoding="utf-8")

    def read(folder: Path) -> tuple[Measures, History]:
        start, end = (dumped(next(folder.glob(n))) for n in ("shape.0.dump", "end.dump"))
        return measure(bar, start, end), []

    return Run(name, "lammps", f"about {count(bar):,} particles", write, read)


def dumped(path: Path) -> np.ndarray:
    """Places of a dump, sorted by number."""
    lines = path.read_text(encoding="utf-8").split("ITEM: ATOMS id x y z")[1].split()
    table = np.array(lines, float).reshape(-1, 4)
    return table[np.argsort(table[:, 0]), 1:]
