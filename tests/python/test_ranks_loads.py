# SPDX-License-Identifier: MIT
"""Loads on bodies without air on several processes: the results and restarts of one."""

import numpy as np
import pytest
from test_ranks import MATERIALS, equal_bodies, go, in_two, needs_mpirun, start
from test_run import arrays, history
from tiers import slow

# A blast on a plate at a plane of symmetry, a history on all sides of a block that
# turns, a rigid body that is pressed and pushed, a bar that is driven and pressed where it is held.
LOADED = f"""\
&run title = 'loaded', t_end = 1.2e-5, symmetry = 'y', energy_band = 0.5 /
{MATERIALS}\
&body id = 'plate', box = -0.02,0.02, -0.02,0.02, -0.004,0, spacing = 2e-3, material = 's',
     fix = 'sides' /
&body id = 'block', box = 0.03,0.044, 0.03,0.042, 0.03,0.044, spacing = 2e-3, material = 'm',
     spin = 0, 900, 2000, velocity = 30, 0, 300 /
&body id = 'die', box = 0.05,0.062, 0.02,0.03, 0,0.01, spacing = 2e-3, material = 'm',
     formulation = 'rigid', spin = 0, 0, 3000 /
&body id = 'bar', box = 0.03,0.05, 0.05,0.058, 0,0.008, spacing = 2e-3, material = 'm', fix = 'x+',
     motion_time = 0, 1, motion_velocity = 40, 90, 9,  40, 90, 9 /
&interaction law = 'none' /
&load id = 'blast', body = 'plate', faces = 'z+', mass = 0.05, at = 0.004, 0, 0.12,
     detonation_time = -2.4e-5 /
&load id = 'press', body = 'block', faces = 'x-', 'z+', time = 0, 4e-6, 1.6e-5,
     pressure = 0, 3e7, 0 /
&load id = 'push', body = 'die', acceleration = 1e6, 0, 4e5 /
&load id = 'side', body = 'die', faces = 'y+', pressure = 2e7 /
&load id = 'end', body = 'bar', faces = 'x+', 'z+', pressure = 1e7 /
&gauge id = 'plate', body = 'plate', at = 0.001,0.001,-0.002, quantity = 'velocity_z' /
&gauge id = 'block', body = 'block', at = 0.031,0.031,0.043, quantity = 'speed' /
&gauge id = 'wide', body = 'block', at = 0.037,0.037,0.037, quantity = 'velocity_z',
       width = 0.01, 0.02, 0.005 /
&gauge id = 'die', body = 'die', at = 0.05,0.02,0, quantity = 'speed' /
&output dump_every = 4e-6, history_every = 0 /
"""


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    folder = tmp_path_factory.mktemp("loaded")
    go(0, LOADED, folder)
    bodies = history(folder / "out/bodies.csv")
    for name in ("plate", "block", "die", "bar"):
        assert np.abs(bodies[f"{name}:load_work[J]"]).max() > 0
    return folder / "out"


@pytest.mark.long("runs on several processes")
@needs_mpirun
@pytest.mark.parametrize("n", [slow(2), 3, slow(4)])
def test_loads_do_not_depend_on_processes(n, alone, tmp_path):
    go(n, LOADED, tmp_path)
    equal_bodies(alone, tmp_path / "out")


@needs_mpirun
@pytest.mark.parametrize(("n", "m"), [(0, 2), (3, 0), slow(2, 4)])
def test_loaded_bodies_go_on_on_other_processes(n, m, alone, tmp_path):
    (tmp_path / "deck.nml").write_text(LOADED)
    in_two(n, m, 15, tmp_path)
    equal_bodies(alone, tmp_path / "out")


# A loaded plate that flies apart: facets span between particles that are far from each other, some
# of them removed.
TORN = """\
&run title = 'torn', t_end = 3e-4, energy_band = 10 /
&material id = 'm', model = 'linear_elastic', density = 1200, youngs_modulus = 1e5,
     poisson_ratio = 0.3 /
&body id = 'plate', box = -0.012,0.012, -0.01,0.01, 0,0.004, spacing = 2e-3, material = 'm',
     spin = 0, 0, 4e4 /
&solid region = -1, 0.05, -1, 1, -1, 1, leave = 'remove' /
&load id = 'press', body = 'plate', faces = 'z+', 'x-', time = 0, 1e-4, 3e-4,
     pressure = 0, 3e6, 0 /
&gauge id = 'plate', body = 'plate', at = 0.011,0.009,0.003, quantity = 'speed' /
&output dump_every = 1e-4, history_every = 0 /
"""


@needs_mpirun
@pytest.mark.parametrize(("n", "m"), [(2, 3), slow(4, 4)])
def test_a_loaded_face_may_be_torn_on_processes(n, m, tmp_path):
    (tmp_path / "deck.nml").write_text(TORN)
    done = start(0, "run", "deck.nml", "--out", "one", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    end = arrays(sorted((tmp_path / "one").glob("chk_*.h5"))[-1])
    assert 10 < (end["solid/fixed"] == 2).sum() < 100
    assert np.ptp(end["solid/x"][:, :2], axis=0).min() > 0.1
    in_two(n, m, 50, tmp_path)
    equal_bodies(tmp_path / "one", tmp_path / "out")


LOST = """\
&run t_end = 1e-4 /
&material id = 'm', model = 'linear_elastic', density = 1200, youngs_modulus = 1e9,
     poisson_ratio = 0.3 /
&body id = 'bar', box = 0,0.06, 0,0.004, 0,0.004, spacing = 2e-3, material = 'm' /
&load body = 'bar', faces = 'x+', time = 0, 2e-5, 3e-5, pressure = 0, 0, 1e250 /
&output checkpoint_every = 5e-6 /
"""


@needs_mpirun
@pytest.mark.parametrize("n", [0, 3])
def test_a_place_that_is_no_number_ends_all(n, tmp_path):
    """At one end of a bar; what was before is in a checkpoint."""
    (tmp_path / "deck.nml").write_text(LOST)
    done = start(n, "run", "deck.nml", "--out", "out", cwd=tmp_path)
    assert done.returncode == 3
    assert done.stderr.count("particle of body 'bar' has a place that is no number") == 1
    done = start(2, "run", "deck.nml", "--out", "out", "--restart", "latest", "--set",
                 "run.t_end=1.9e-5", cwd=tmp_path)  # fmt: skip
    assert done.returncode == 0, done.stderr


# Three blocks that meet with friction, one of them rigid, one held; what each pair does, and what
# holds and loads them.
MET = """\
&run title = 'met', t_end = 2e-6, dt_max = 2.5e-8 /
&material id = 's', model = 'linear_elastic', density = 7800, youngs_modulus = 200e9,
     poisson_ratio = 0.3 /
&body id = 'a', box = 0,0.005, 0,0.004, 0,0.004, spacing = 1e-3, material = 's',
     velocity = 40, 3, 0 /
&body id = 'c', box = 0.00505,0.01005, 0,0.004, 0,0.004, spacing = 1e-3, material = 's' /
&body id = 'd', box = 0.0101,0.0151, 0,0.004, 0,0.004, spacing = 1e-3, material = 's',
     velocity = -30, 0, -2, formulation = 'rigid' /
&body id = 'e', box = 0,0.015, -0.00505,-0.00005, 0,0.004, spacing = 1e-3, material = 's',
     fix = 'y-' /
&interaction law = 'contact', friction = 0.2 /
&load body = 'a', acceleration = 0, -1e7, 0 /
&gauge id = 'ac', body = 'a', with = 'c', quantity = 'contact_x' /
&gauge id = 'ca', body = 'c', with = 'a', quantity = 'impulse_x' /
&gauge id = 'cd', body = 'c', with = 'd', quantity = 'impulse_x' /
&gauge id = 'dc', body = 'd', with = 'c', quantity = 'contact_z' /
&gauge id = 'ea', body = 'e', with = 'a', quantity = 'impulse_y' /
&gauge id = 'c', body = 'c', quantity = 'contact_x' /
&gauge id = 'd', body = 'd', quantity = 'contact_x' /
&gauge id = 'e', body = 'e', quantity = 'reaction_y' /
&gauge id = 'm', body = 'e', quantity = 'moment_x', at = 0.007, 0, 0.001 /
&gauge id = 'l', body = 'a', quantity = 'load_y' /
&gauge id = 'i', body = 'a', quantity = 'impulse_y' /
&output history_every = 0, checkpoint_every = 5e-7 /
"""


@pytest.fixture(scope="module")
def met(tmp_path_factory):
    """Gauges of these blocks on one process, as text."""
    folder = tmp_path_factory.mktemp("met")
    go(0, MET, folder)
    gauges = history(folder / "out/gauges.csv")
    assert all(np.abs(gauges[name]).max() > 0 for name in gauges.dtype.names)
    return (folder / "out/gauges.csv").read_text()


@pytest.mark.long("processes that wait for each other on two cores")
@needs_mpirun
@pytest.mark.parametrize("n", [slow(1), 2, slow(4)])
def test_forces_on_bodies_do_not_depend_on_processes(n, met, tmp_path):
    go(n, MET, tmp_path)
    assert (tmp_path / "out/gauges.csv").read_text() == met


@pytest.mark.long("processes that wait for each other on two cores")
@needs_mpirun
@pytest.mark.parametrize(("n", "m"), [(0, 2), slow(4, 0)])
def test_forces_on_bodies_go_on_on_other_processes(n, m, met, tmp_path):
    (tmp_path / "deck.nml").write_text(MET)
    in_two(n, m, 40, tmp_path)
    assert (tmp_path / "out/gauges.csv").read_text() == met
