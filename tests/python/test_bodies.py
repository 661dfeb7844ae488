# SPDX-License-Identifier: MIT
"""Scenes of several bodies from outside: restart, threads, and what a run says of them."""

import os

import pytest
from test_run import history, run, tables

# A driven rigid punch, a bonded liner that breaks loose, a free rigid ball; friction everywhere.
DECK = """\
&run title='bodies', t_end=3e-5 /
&material id='soft', model='linear_elastic', density=1000,
          youngs_modulus=5e8, poisson_ratio=0.3 /
&body id='block', box=0,0.008, 0,0.008, 0,0.006, spacing=1e-3, material='soft', fix='z-',
      fix_layers=1 /
&body id='liner', box=0,0.008, 0,0.008, 0.006,0.008, spacing=1e-3, material='soft' /
&body id='punch', box=0.002,0.006, 0.002,0.006, 0.008,0.010, spacing=1e-3, material='soft',
      formulation='rigid', motion_time=0,1e-5, motion_velocity=0,0,-60, 20,0,-60 /
&body id='ball', shape='sphere', centre=-0.0021,0.004,0.004, radius=0.002, spacing=1e-3,
      material='soft', formulation='rigid', velocity=80,0,0, spin=0,3e3,0 /
&interaction law='contact', friction=0.3 /
&interaction law='bonded', bodies='block','liner', tensile_strength=4e6, shear_strength=4e6 /
&output checkpoint_every=1e-5, history_every=0 /
"""


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    """A folder with the deck `bodies.nml` and the results of a whole run in `out/bodies`."""
    folder = tmp_path_factory.mktemp("bodies")
    (folder / "bodies.nml").write_text(DECK)
    run("run", "bodies.nml", cwd=folder)
    return folder


def test_every_law_acts_and_energy_closes(scene):
    energy = history(scene / "out" / "bodies" / "energy.csv")
    assert energy["friction[J]"][-1] > 0
    assert energy["contact_heat[J]"][-1] > 0
    assert energy["drive_work[J]"][-1] > 0
    assert abs(energy["error[-]"][-1]) < 0.01


def test_restart_goes_on_with_the_same_bytes(scene):
    run("run", "bodies.nml", "--out", "half", "--set", "run.max_steps=41", cwd=scene)
    run("run", "bodies.nml", "--out", "half", "--restart", "latest", cwd=scene)
    assert tables(scene / "half") == tables(scene / "out" / "bodies")


def test_threads_do_not_matter(scene):
    run("run", "bodies.nml", "--out", "one", cwd=scene, env=os.environ | {"OMP_NUM_THREADS": "1"})
    assert tables(scene / "one") == tables(scene / "out" / "bodies")
