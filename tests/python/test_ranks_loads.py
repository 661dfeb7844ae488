# SPDX-License-Identifier: MIT
"""Loads on bodies without air on several processes: the results and restarts of one."""

import numpy as np
import pytest
from test_ranks import equal_bodies, needs_mpirun, start
from test_run import history

# A blast on a plate at a plane of symmetry, a history on all sides of a block that
# turns, a rigid body that is pressed and pushed, a bar that is driven and pressed where it is held.
LOADED = """\
&run title = 'loaded', t_end = 3e-5, symmetry = 'y', energy_band = 0.5 /
&material id = 's', preset = 'rebar' /
&material id = 'm', model = 'linear_elastic', density = 1200, youngs_modulus = 5e9,
     poisson_ratio = 0.3 /
&body id = 'plate', box = -0.02,0.02, -0.02,0.02, -0.004,0, spacing = 2e-3, material = 's',
     fix = 'sides' /
&body id = 'block', box = 0.03,0.044, 0.03,0.042, 0.03,0.044, spacing = 2e-3, material = 'm',
     spin = 0, 900, 2000, velocity = 30, 0, 300 /
&body id = 'die', box = 0.05,0.062, 0.02,0.03, 0,0.01, spacing = 2e-3, material = 'm',
     formulation = 'rigid', spin = 0, 0, 3000 /
&body id = 'bar', box = 0.03,0.05, 0.05,0.058, 0,0.008, spacing = 2e-3, material = 'm', fix = 'x+',
     motion_time = 0, 1, motion_velocity = 40, 90, 9,  40, 90, 9 /
&interaction law = 'none' /
&load id = 'blast', body = 'plate', faces = 'z+', mass = 0.05, at = 0.004, 0, 0.12 /
&load id = 'press', body = 'block', faces = 'x-', 'z+', time = 0, 1e-5, 4e-5, pressure = 0, 3e7, 0 /
&load id = 'push', body = 'die', acceleration = 1e6, 0, 4e5 /
&load id = 'side', body = 'die', faces = 'y+', pressure = 2e7 /
&load id = 'end', body = 'bar', faces = 'x+', 'z+', pressure = 1e7 /
&gauge id = 'plate', body = 'plate', at = 0.001,0.001,-0.002, quantity = 'velocity_z' /
&gauge id = 'block', body = 'block', at = 0.031,0.031,0.043, quantity = 'speed' /
&gauge id = 'die', body = 'die', at = 0.05,0.02,0, quantity = 'speed' /
&output dump_every = 1e-5, history_every = 0 /
"""


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    folder = tmp_path_factory.mktemp("loaded")
    (folder / "deck.nml").write_text(LOADED)
    done = start(0, "run", "deck.nml", "--out", "out", cwd=folder)
    assert done.returncode == 0, done.stderr
    bodies = history(folder / "out/bodies.csv")
    for name in ("plate", "block", "die", "bar"):
        assert np.abs(bodies[f"{name}:load_work[J]"]).max() > 0
    return folder / "out"


@needs_mpirun
@pytest.mark.parametrize("n", [2, 3, 4])
def test_loads_do_not_depend_on_processes(n, alone, tmp_path):
    (tmp_path / "deck.nml").write_text(LOADED)
    done = start(n, "run", "deck.nml", "--out", "out", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    equal_bodies(alone, tmp_path / "out")


@needs_mpirun
@pytest.mark.parametrize(("n", "m"), [(0, 2), (3, 0), (2, 4)])
def test_loaded_bodies_go_on_on_other_processes(n, m, alone, tmp_path):
    (tmp_path / "deck.nml").write_text(LOADED)
    done = start(n, "run", "deck.nml", "--out", "out", "--set", "run.max_steps=15", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    done = start(m, "run", "deck.nml", "--out", "out", "--restart", "latest", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    equal_bodies(alone, tmp_path / "out")
