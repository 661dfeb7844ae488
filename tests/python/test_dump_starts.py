# SPDX-License-Identifier: MIT
"""Going on from a dump: as the run that wrote it, or a refusal that names what can."""

import subprocess

import h5py
import numpy as np
import pytest
from notes import note
from test_loads import BRISANCE, STEEL

RUN = """\
&run t_end={end} /
{material}
&body id='b', {shape}, spacing=1e-3, material='s', formulation='{form}' /
&output dump_every={end} /
"""
BAR = "box=0,0.03, 0,0.005, 0,0.003, start_file='v.csv'"
AGAIN = BAR.replace("v.csv", "s.vtkhdf")
START = "start_file='s.vtkhdf', start_stress=.true."
METAL = "&material id='s', preset='ofhc_copper' /"
HALF = 1e-5


def last_dump(folder):
    """Velocities of the last dump (n, 3), by the places of the particles in the unloaded body."""
    with h5py.File(sorted(folder.glob("solid_*.vtkhdf"))[-1]) as f:
        data = f["VTKHDF/PointData"]
        return np.asarray(data["velocity"])[np.argsort(data["id"])]


def go(tmp_path, end, shape, form, material=STEEL):
    (tmp_path / "d.nml").write_text(RUN.format(end=end, shape=shape, form=form, material=material))
    return subprocess.run([BRISANCE, "run", "d.nml", "--out", "out", "--replace"], cwd=tmp_path,
                          capture_output=True, text=True)  # fmt: skip


def swing(tmp_path, form, material=STEEL):
    """A bar whose ends bend up has run for HALF, and its dump is s.vtkhdf."""
    x, y, z = np.meshgrid(*((np.arange(n) + 0.5) * 1e-3 for n in (30, 5, 3)))
    up = 20 * np.cos(2 * np.pi * x / 0.03)
    table = np.stack([x, y, z, 0 * x, up], axis=-1).reshape(-1, 5)
    np.savetxt(tmp_path / "v.csv", table, fmt="%.9g", delimiter=",", comments="",
               header="x,y,z,velocity_x,velocity_y")  # fmt: skip
    done = go(tmp_path, HALF, BAR, form, material)
    assert done.returncode == 0, done.stderr
    dump = sorted((tmp_path / "out").glob("solid_*.vtkhdf"))[-1]
    (tmp_path / "s.vtkhdf").write_bytes(dump.read_bytes())


FORMS = ["bending", "total_lagrangian", "corrected_hourglass", "corrected", "uncorrected"]


@pytest.mark.parametrize("form", FORMS)
def test_a_bar_goes_on_from_its_dump(form, tmp_path):
    """Laid as the run before, with the displacements of the dump, it does what that does."""
    swing(tmp_path, form)
    done = go(tmp_path, 2 * HALF, BAR, form)
    assert done.returncode == 0, done.stderr
    wanted = last_dump(tmp_path / "out")
    done = go(tmp_path, HALF, AGAIN + ", start_stress=.true.", form)
    assert done.returncode == 0, done.stderr
    assert "warning" not in done.stderr
    error = abs(last_dump(tmp_path / "out") - wanted).max() / abs(wanted).max()
    note(f"dump_start_{form}", error)
    assert error < 0.005


@pytest.mark.parametrize("form", FORMS)
def test_a_body_laid_at_the_points_of_a_dump(form, tmp_path):
    """It is unloaded there: only what does not remember another place can go on."""
    swing(tmp_path, form)
    done = go(tmp_path, HALF, f"shape='particles', file='s.vtkhdf', {START}", form)
    if form in ("corrected", "uncorrected"):
        assert done.returncode == 0, done.stderr
        return
    assert done.returncode == 2
    assert ": &body id='b': start_file is a dump at whose points the body lies" in done.stderr


def test_stresses_that_are_left_behind_are_told_of(tmp_path):
    """A metal cannot start with the stress of a dump; without it, its start is no going on."""
    swing(tmp_path, "corrected", METAL)
    done = go(tmp_path, 1e-7, AGAIN + ", start_stress=.true.", "corrected", METAL)
    assert done.returncode == 2
    assert "only a body of model='linear_elastic'" in done.stderr
    done = go(tmp_path, 1e-7, AGAIN, "corrected", METAL)
    assert done.returncode == 0, done.stderr
    assert "warning: the body starts with the velocities of start_file, without its" in done.stderr
    assert "--restart" in done.stderr
