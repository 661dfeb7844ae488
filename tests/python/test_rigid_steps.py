# SPDX-License-Identifier: MIT
"""A rigid body bears the time step of what it meets: fine ones cost few, light ones keep
diagnostics."""

import subprocess
from pathlib import Path

import numpy as np
import pytest
from notes import note
from tiers import slow

BRISANCE = Path(__file__).parents[2] / "bin" / "brisance"

# A rigid body that touches an elastic block of steel and is thrown at it; nothing rubs or yields.
DECK = """\
&run t_end={end}, backend='cpu' /
&material id='steel', model='linear_elastic', density=7800, youngs_modulus=200e9,
  poisson_ratio=0.3 /
&material id='own', model='linear_elastic', density={density}, youngs_modulus=206e9,
  poisson_ratio=0.3 /
&body id='thrown', {shape}, spacing={dx}, material='own', formulation='rigid',
  velocity=0,0,-{speed} /
&body id='block', box=-4e-3,4e-3, -4e-3,4e-3, -6e-3,0, spacing=1e-3, material='steel' /
&output history_every=2e-7, dump_every=1 /
"""
BALL = "shape='sphere', centre=0,0,2e-3, radius=2e-3"
BOX = "box=-2e-3,2e-3, -2e-3,2e-3, 0,2e-3"


def run(folder, name, **keys):
    """Number of steps; largest error of the energy; heat of contact over the first energy."""
    (folder / f"{name}.nml").write_text(DECK.format(**keys))
    done = subprocess.run([BRISANCE, "run", f"{name}.nml"], cwd=folder, capture_output=True,
                          text=True)  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    steps = int(done.stdout.split("after ")[1].split()[0])
    with (folder / "out" / name / "energy.csv").open() as file:
        names = [column.strip() for column in file.readline().split(",")]
        table = np.loadtxt(file, delimiter=",")
    column = {key: table[:, k] for k, key in enumerate(names)}
    heat = column["contact_heat[J]"][-1] / column["solid_kinetic[J]"][0]
    return steps, np.abs(column["error[-]"]).max(), heat


def test_a_fine_rigid_body_costs_few_steps(tmp_path):
    steps = {
        dx: run(tmp_path, f"fine_{k}", end=4e-5, shape=BALL, dx=dx, density=7800, speed=50)[0]
        for k, dx in enumerate((1e-3, 2.5e-4))
    }
    note("rigid_fine_steps", steps[2.5e-4] / steps[1e-3])
    # the waves of its own steel would ask for four times as many; its springs for up to twice
    assert steps[2.5e-4] <= 2 * steps[1e-3]


# The springs of contact and the mass of the body make a period; a step that is a fixed part of it
# keeps the energy.
@pytest.mark.parametrize(("shape", "density", "speed", "dx"), [
    slow(BALL, 20, 30, 1e-3), (BALL, 150, 200, 4e-4), slow(BOX, 30, 100, 5e-4),
    slow(BOX, 30, 10, 1e-3),
])  # fmt: skip
def test_a_light_rigid_body_bounces_without_loss(tmp_path, shape, density, speed, dx):
    keys = {"shape": shape, "dx": dx, "density": density, "speed": speed}
    _, error, heat = run(tmp_path, "light", end=1e-5, **keys)  # it has parted by then
    note(f"rigid_light_{density}_{speed}", abs(heat))
    assert abs(heat) < 2e-3
    assert error < 2e-3
