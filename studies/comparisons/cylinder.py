# SPDX-License-Identifier: MIT
"""A cylinder through a plate in plane strain: decks of Brisance and LAMMPS, the hole in the plate.

The cylinder flies along x; the plate is 2 mm thick and 60 mm wide. The hole: twice the least height
of the particles that hang together with the outer end of the plate (nearer than 1.6 spacings), less
a spacing. The opening: the same of those that are where the plate was, between its faces.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from post.reader import Run as Results
from studies.comparisons.bar import dumped
from studies.comparisons.case import History, Measures, Run

RADIUS, THICK, HALF, SPEED, END = 5e-3, 2e-3, 0.03, 3100.0, 8e-6
DENSITY, SOUND, SLOPE, SHEAR, YIELD = 2785.0, 5328.0, 1.338, 27.6e9, 0.3e9
AROUND = [(a, b) for a in (-1, 0, 1) for b in (-1, 0, 1)]
DECK = f"""Aluminium through aluminium, half of it, written by studies/comparisons/cylinder.py.

&run t_end = {END}, dimension = 2, symmetry = 'y' /
&material
    id = 'm', model = 'gruneisen', density = {DENSITY}, sound_speed = {SOUND}, s1 = {SLOPE}
    gruneisen_gamma = 2, shear_modulus = {SHEAR:g}, yield_stress = {YIELD:g}, pressure_cutoff = -1e9
/
&body
    id = 'cylinder', shape = 'cylinder', centre = -{{centre:.7g}}, 0, 0.5, radius = {RADIUS}
    length = 1, spacing = {{spacing:g}}, material = 'm', velocity = {SPEED}, 0, 0
/
&body
    id = 'plate', box = {{low:.7g}}, {{high:.7g}}, -{HALF}, {HALF}, 0, 1
    spacing = {{spacing:g}}, material = 'm'
/
&output dump_every = {END}, history_every = {{every:.7g}} /
"""
MODEL = """# A cylinder through a plate, written by studies/comparisons/cylinder.py
units si
dimension 2
boundary s s p
atom_style smd
atom_modify map array
comm_modify vel yes
newton off
region space block -{wide} {wide} -{wide} {wide} -{flat} {flat} units box
create_box 1 space
lattice sq {spacing} origin 0.5 0.5 0
region ball sphere -{centre} 0 0 {radius} units box
region plate block {low} {high} -{half} {half} -{flat} {flat} units box
create_atoms 1 region ball
group ball region ball
create_atoms 1 region plate
set group all volume {volume}
set group all smd/mass/density {density}
set group all diameter {reach}
neighbor {skin} bin
neigh_modify every 5 delay 0 check yes
pair_style smd/ulsph *DENSITY_CONTINUITY *VELOCITY_GRADIENT *NO_GRADIENT_CORRECTION
pair_coeff 1 1 *COMMON {density} {sound} {q1} 1.0 {hourglass} &
    *EOS_TAIT {exponent} &
    *STRENGTH_LINEAR_PLASTIC {shear} {yield_stress} 0.0 &
    *END
velocity ball set {speed} 0.0 0.0 units box
timestep 1e-10
fix step all smd/adjust_dt 0.1
fix move all smd/integrate_ulsph
thermo 500
run 0
write_dump all custom start.dump id x y z modify sort id
variable now equal time
fix done all halt 5 v_now >= {end} error continue
run 10000000
write_dump all custom end.dump id x y z modify sort id
"""


def heaps(points: np.ndarray, reach: float) -> np.ndarray:
    """Number of the heap of each point (n, 2): neighbours within a reach hang together."""
    cells: dict[tuple[int, int], list[int]] = {}
    for k, cell in enumerate(map(tuple, np.floor(points / reach).astype(int))):
        cells.setdefault(cell, []).append(k)
    heap = np.full(len(points), -1)
    for first in range(len(points)):
        if heap[first] >= 0:
            continue
        heap[first], waiting = first, [first]
        while waiting:
            k = waiting.pop()
            i, j = np.floor(points[k] / reach).astype(int)
            near = [n for a, b in AROUND for n in cells.get((i + a, j + b), ()) if heap[n] < 0]
            if near:
                close = np.hypot(*(points[near] - points[k]).T) < reach
                found = [n for n, c in zip(near, close, strict=True) if c]
                heap[found] = first
                waiting += found
    return heap


def measures(start: np.ndarray, end: np.ndarray, spacing: float) -> Measures:
    """From the places (n, 2) of all particles before and after [m]; no hole: 0."""
    heap = heaps(end, 1.6 * spacing)
    outer, inner = np.argmax(start[:, 1]), np.argmin(np.hypot(*(start + (RADIUS, 0)).T))
    height = end[:, 1]
    plate = (heap == heap[outer]) & (height > 0)
    between = plate & (end[:, 0] > 0) & (end[:, 0] < THICK + spacing)
    found = {"opening": float(2 * height[between].min() - spacing)}
    if heap[outer] != heap[inner]:
        found["hole"] = float(2 * height[plate].min() - spacing)
    return found


def ours(spacing: float) -> Run:
    """A run of Brisance: the half above the axis of the cylinder."""
    gap = spacing / 2

    def write(folder: Path) -> None:
        text = DECK.format(centre=RADIUS + gap, spacing=spacing, low=gap, high=THICK + gap,
                           every=END / 100)  # fmt: skip
        (folder / "deck.nml").write_text(text, encoding="utf-8")

    def read(folder: Path) -> tuple[Measures, History]:
        solid = Results(folder / "out" / "deck").frames[-1].solid("displacement")
        end, moved = solid.points[:, :2], solid.field["displacement"][:, :2]
        return measures(end - moved, end, spacing), []

    count = round((np.pi * RADIUS**2 / 2 + THICK * HALF) / spacing**2)
    name = f"Brisance, {1e3 * spacing:g} mm"
    return Run(name, "brisance", f"about {count:,} particles (a half)", write, read)


def lammps(spacing: float, q1: float, hourglass: float) -> Run:
    """A run of LAMMPS: updated Lagrangian particles, the whole. The exponent of its equation of
    state (Tait) is that which bends the compression curve as the slope of the shock does."""

    def write(folder: Path) -> None:
        gap = spacing / 2
        text = MODEL.format(wide=2 * HALF, flat=spacing / 2, spacing=spacing, centre=RADIUS + gap,
                            radius=RADIUS, low=gap, high=THICK + gap, half=HALF,
                            volume=spacing**2, density=DENSITY, reach=3.015 * spacing,
                            skin=0.5 * spacing, sound=SOUND, q1=q1, hourglass=hourglass,
                            exponent=4 * SLOPE - 1, shear=SHEAR, yield_stress=YIELD,
                            speed=SPEED, end=END)  # fmt: skip
        (folder / "model.lmp").write_text(text, encoding="utf-8")

    def read(folder: Path) -> tuple[Measures, History]:
        start, end = (dumped(folder / f"{name}.dump")[:, :2] for name in ("start", "end"))
        return measures(start, end, spacing), []

    count = round((np.pi * RADIUS**2 + 2 * THICK * HALF) / spacing**2)
    name = f"LAMMPS, ULSPH, {1e3 * spacing:g} mm, q1 {q1:g}"
    return Run(name, "lammps", f"about {count:,} particles", write, read)
