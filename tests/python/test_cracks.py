# SPDX-License-Identifier: MIT
"""Cracks cost what the material says: a notched strip drawn apart, whatever the spacing."""

import subprocess
from pathlib import Path

import numpy as np
import pytest
from tiers import slow

BRISANCE = Path(__file__).parents[2] / "bin" / "brisance"
LIGAMENT = 0.012  # half of it, as modelled [m]

# material, speed of the end [m/s], time until it is apart [s]
CONCRETE = "preset='concrete_48'", 0.15, 8e-4
PLY = "preset='cfrp_ud', gft=1e4, gmt=1e4", 1.0, 5e-4


def work_of_separation(folder, strip, formulation, spacing):
    """Work per cracked area, and the largest mean stress of the ligament [J/m2, Pa]."""
    material, speed, time = strip
    deck = f"""\
&run t_end={time}, dimension=2, symmetry='x','y' /
&material id='m', {material} /
&material id='air', model='linear_elastic', density=10, youngs_modulus=1e6, poisson_ratio=0.3 /
&body id='strip', box=0,0.016, 0,0.02, 0,1, spacing={spacing}, material='m', plies='90',
      formulation='{formulation}', fix='x+', fix_layers=1,
      motion_time=0,{time}, motion_velocity={speed},0,0,{speed},0,0 /
&body id='notch', box=0,{spacing}, {LIGAMENT},0.02, 0,1, spacing={spacing}, material='air',
      formulation='rigid', cuts='strip' /
&interaction bodies='strip','notch', law='none' /
&output history_every={time / 200}, dump_every={time} /
"""
    if "ud" not in material:
        deck = deck.replace(" plies='90',", "")
    (folder / "strip.nml").write_text(deck)
    done = subprocess.run(
        [BRISANCE, "run", "strip.nml"], cwd=folder, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
    table = np.genfromtxt(
        folder / "out" / "strip" / "energy.csv",
        delimiter=",",
        names=True,
        deletechars="",
        replace_space=" ",
    )
    work = table["drive_work[J]"]
    force = np.gradient(work, table["time[s]"])[3:] / speed
    assert abs(table["error[-]"][-1]) < 1e-3
    assert abs(force[-20:].mean()) < 0.02 * force.max()
    return 2 * work[-1] / LIGAMENT, force.max() / LIGAMENT


@pytest.mark.parametrize("formulation", ["corrected_hourglass", "bending"])
@pytest.mark.parametrize("spacing", [0.004, 0.002, slow(0.001)])
def test_strip_of_concrete(tmp_path, formulation, spacing):
    """gf = 146.5 J/m2; the ligament carries ft = 3.51 MPa and a little more, as the crack opens."""
    energy, stress = work_of_separation(tmp_path, CONCRETE, formulation, spacing)
    assert energy == pytest.approx(146.5, rel=0.1)
    assert 1.0 < stress / 3.51e6 < 1.2


@pytest.mark.parametrize("formulation", ["corrected_hourglass", "bending"])
@pytest.mark.parametrize("spacing", [0.004, 0.002, slow(0.001)])
def test_strip_of_a_ply(tmp_path, formulation, spacing):
    """10 kJ/m2 across the fibres. In bending the hourglass force takes 5 % beside it."""
    energy, stress = work_of_separation(tmp_path, PLY, formulation, spacing)
    assert energy == pytest.approx(1e4, rel=0.06)
    assert stress == pytest.approx(63.7e6, rel=0.06)


def test_a_body_too_coarse_for_its_energy_is_told(tmp_path):
    """1 J/m2 in concrete: 2 E gf/ft^2 is some 5 mm, so 4 mm of spacing are too many."""
    deck = """\
&run t_end=1e-6, dimension=2 /
&material id='m', preset='concrete_48', gf=1 /
&body id='b', box=0,0.04, 0,0.04, 0,1, spacing=0.004, material='m', velocity=9,0,0 /
"""
    (tmp_path / "b.nml").write_text(deck)

    def check(*args):
        return subprocess.run(
            [BRISANCE, "run", "b.nml", "--check", *args],
            cwd=tmp_path,
            capture_output=True,
            text=True,
        )

    done = check()
    assert done.returncode == 0
    assert "full strength with spacings up to 2.39" in done.stdout
    assert "warning: a crack is 8.4 mm wide" in done.stderr
    assert "falls to 77 %" in done.stderr
    refused = check("--set", "body.crack_band=refuse")
    assert refused.returncode == 2
    assert "too wide for its fracture energy" in refused.stderr
    assert check("--set", "body.spacing=0.002").stderr == ""
