# SPDX-License-Identifier: MIT
"""The stress of the material at faces in contact: brz_contact_face, brz_contact_edges."""

import h5py
import numpy as np
import pytest
from notes import note
from test_loads import run
from tiers import slow

ROCK = "&material id='s', model='linear_elastic', density=2000, youngs_modulus=10e9,\n"
ROCK += "          poisson_ratio=0.2 /\n"


def layers(folder, count, first, number=1):
    """Mean compressive stress along x of the layers of body `number` over the dumps from `first`
    on [Pa]."""
    rows = []
    for path in sorted((folder / "out" / "load").glob("solid_*.vtkhdf"))[first:]:
        with h5py.File(path) as file:
            data = file["VTKHDF/PointData"]
            mine = np.array(data["body"]) == number
            x = np.array(file["VTKHDF/Points"])[mine, 0]
            stress = np.array(data["stress"]).reshape(len(mine), -1)[mine, 0]
        order = np.argsort(x, kind="stable").reshape(count, -1)
        rows.append(stress[order].mean(axis=1))
    return -np.mean(rows, axis=0)


# Slowly pressed between rigid platens that are wider than it, a block has the same stress in all
# layers: 0.52 of it in the outermost without the stress that contact brings by the faces.
@pytest.mark.parametrize(("dimension", "form"), [
    (n, form) if n == 2 or form == "bending" else slow(n, form)
    for n in (1, 2, 3)
    for form in ("bending", "corrected_hourglass", "total_lagrangian")
])  # fmt: skip
def test_the_stress_at_a_face_in_contact_meets_the_traction(tmp_path, dimension, form):
    n = (12, 10, 6)[dimension - 1]
    side = n * 1e-3
    across = [0, side] * (dimension - 1) + [0, 1] * (3 - dimension)
    wide = [-0.003, side + 0.003] * (dimension - 1) + [0, 1] * (3 - dimension)
    body = "&body material='s', spacing=1e-3, "
    deck = f"""\
&run t_end=2.2e-4, dimension={dimension} /
{ROCK}{body}id='b', box=0, {side}, {str(across)[1:-1]}, formulation='{form}' /
{body}id='low', box=-0.003, 0, {str(wide)[1:-1]}, formulation='rigid',
      motion_time=0,1, motion_velocity=0,0,0, 0,0,0 /
{body}id='high', box={side}, {side + 0.003}, {str(wide)[1:-1]}, formulation='rigid',
      motion_time=0,2e-5,8e-5,1e-4,1, motion_velocity=0,0,0, -0.01,0,0, -0.01,0,0, 0,0,0, 0,0,0 /
&interaction law='contact', friction=0 /
&output dump_every=2e-6 /
"""
    tables = run(tmp_path, deck)
    assert abs(tables["energy"]["error[-]"]).max() < 1e-2
    stress = layers(tmp_path, n, 60)
    inner = stress[n // 3 : n - n // 3].mean()
    for k in range(3):
        note(f"contact_face_{dimension}_{form}_{k + 1}", stress[k] / inner)
    assert inner > 1e5
    assert stress[[0, -1]] == pytest.approx(inner, rel=0.03)
    assert stress[1:-1] == pytest.approx(inner, rel=0.055)


# The same where two elastic bodies meet.
def test_the_stress_meets_the_traction_on_both_sides(tmp_path):
    deck = f"""\
&run t_end=2.6e-4, dimension=2, symmetry='y' /
{ROCK}&body id='a', box=0,0.01, 0,0.008, 0,1, spacing=1e-3, material='s' /
&body id='b', box=0.01,0.02, 0,0.008, 0,1, spacing=1e-3, material='s' /
&load id='p', body='b', faces='x+', time=0,1e-4,1, pressure=0,1e6,1e6 /
&load id='q', body='a', faces='x-', time=0,1e-4,1, pressure=0,1e6,1e6 /
&interaction law='contact', friction=0 /
&output dump_every=2e-6 /
"""
    run(tmp_path, deck)
    for number in (1, 2):
        stress = layers(tmp_path, 10, 80, number)
        face = stress[-1] if number == 1 else stress[0]
        note(f"contact_face_both_{number}", face / 1e6)
        assert face == pytest.approx(1e6, rel=0.04)


PRISM = """\
&run t_end=1.4e-3, symmetry='x','y' /
&material id='c', preset='concrete_48' /
&material id='s', preset='steel_4340' /
"""
BETWEEN = (
    PRISM
    + """\
&body id='p', box=-0.03,0.03, -0.03,0.03, 0,0.12, spacing=7.5e-3, material='c' /
&body id='low', box=-0.045,0.045, -0.045,0.045, -0.015,0, spacing=7.5e-3, material='s',
      formulation='rigid', motion_time=0,1, motion_velocity=0,0,0.12, 0,0,0.12 /
&body id='high', box=-0.045,0.045, -0.045,0.045, 0.12,0.135, spacing=7.5e-3, material='s',
      formulation='rigid', motion_time=0,1, motion_velocity=0,0,-0.12, 0,0,-0.12 /
&interaction law='contact', friction=0 /
&gauge id='f', body='low', quantity='contact_z', with='p' /
&output dump_every=1 /
"""
)
DRIVEN = (
    PRISM
    + """\
&body id='p', box=-0.03,0.03, -0.03,0.03, -0.015,0.135, spacing=7.5e-3, material='c' /
&motion id='low', body='p', box=-1,1, -1,1, -0.02,0, axes='z', velocity=0,0,0.12 /
&motion id='high', body='p', box=-1,1, -1,1, 0.12,0.14, axes='z', velocity=0,0,-0.12 /
&gauge id='f', body='p', quantity='reaction_z', motion='low' /
&output dump_every=1 /
"""
)


# A prism of concrete between frictionless platens carries what one with driven ends does: 0.89 of
# it where its outermost layers are asked at half of their stress and crush first.
def test_a_prism_between_platens_carries_what_a_driven_one_does(tmp_path):
    peak = []
    for name, deck in (("between", BETWEEN), ("driven", DRIVEN)):
        folder = tmp_path / name
        folder.mkdir()
        gauges = run(folder, deck)["gauges"]
        force = np.abs(next(v for k, v in gauges.items() if k.startswith("f")))
        peak.append(np.convolve(force, np.ones(9) / 9, "valid").max() / 0.03**2)
    note("prism_between_platens", peak[0] / 1e6)
    note("prism_driven", peak[1] / 1e6)
    assert peak[0] == pytest.approx(peak[1], rel=0.03)


# An elastic ball on a stiff plate has the force of Hertz, 4/3 E* sqrt(R) w^1.5: 1.22 of it at 8 per
# radius without the strain of the half layers.
@pytest.mark.long("slow loading, so that no wave counts")
@pytest.mark.parametrize(
    ("per_radius", "bound"), [(5, 0.15), pytest.param(8, 0.08, marks=pytest.mark.slow)]
)
def test_a_ball_on_a_plate_has_the_force_of_hertz(tmp_path, per_radius, bound):
    radius, speed = 0.01, 0.5
    spacing = radius / per_radius
    deck = f"""\
&run t_end={0.03 * radius / speed}, symmetry='x','y' /
{ROCK.replace("0.2", "0.3")}&material id='hard', model='linear_elastic', density=2000,
          youngs_modulus=1e12, poisson_ratio=0.3 /
&body id='ball', shape='sphere', centre=0,0,{radius}, radius={radius}, spacing={spacing},
      material='s', formulation='bending' /
&motion id='top', body='ball', box=-1,1, -1,1, {radius}, 1, velocity=0,0,-{speed} /
&body id='plate', box=-0.012,0.012, -0.012,0.012, {-3 * spacing},0, spacing={spacing},
      material='hard', formulation='rigid', motion_time=0,1, motion_velocity=0,0,0, 0,0,0 /
&interaction law='contact', friction=0 /
&gauge id='f', body='plate', quantity='contact_z', with='ball' /
&output dump_every=1 /
"""
    gauges = run(tmp_path, deck)["gauges"]
    force = 4 * np.abs(next(v for k, v in gauges.items() if k.startswith("f")))[-20:].mean()
    hertz = 4 / 3 * 10e9 / (1 - 0.3**2) * radius**0.5 * (0.03 * radius) ** 1.5
    note(f"hertz_{per_radius}", force / hertz)
    assert force == pytest.approx(hertz, rel=bound)
