# SPDX-License-Identifier: MIT
"""Cohesive interfaces on several processes and GPUs: the bits of one. A ball on concrete that is
glued to plies, between which there are interfaces, too; some break, some are damaged. All
flies, so that particles change processes."""

import numpy as np
import pytest
from test_gpu import EMULATOR, stamp
from test_ranks import equal_bodies, needs_mpirun, start
from test_run import arrays, history
from tiers import slow

GLUED = """\
&run title = 'glued', t_end = 2.1e-6, energy_band = 1 /
&material id = 'm', model = 'linear_elastic', density = 1600, youngs_modulus = 10e9,
     poisson_ratio = 0.3 /
&material id = 'cfrp', preset = 'cfrp_ud', pressure = 'anderson' /
&body id = 'slab', shape = 'box', box = -0.0031, 0.0029, -0.0021, 0.0019, 0, 0.003, spacing = 5e-4,
     material = 'm', velocity = 500, 300, 0, spin = 0, 5000, 300 /
&body id = 'plies', shape = 'box', box = -0.0031, 0.0029, -0.0021, 0.0019, -0.002, 0,
     spacing = 5e-4, material = 'cfrp', plies = '45/0/-45/90', delamination = 'cohesive',
     velocity = 505, 302, -20 /
&body id = 'ball', shape = 'sphere', centre = 3e-4, 2e-4, 0.0042, radius = 0.0012, spacing = 5e-4,
     material = 'm', velocity = 700, 350, -900 /
&interaction law = 'contact', friction = 0.2 /
&interaction bodies = 'slab', 'plies', law = 'cohesive', tensile_strength = 40e6,
     shear_strength = 30e6, gi = 30, gii = 60 /
&interaction bodies = 'plies', 'plies', law = 'cohesive', tensile_strength = 60e6,
     shear_strength = 80e6, gi = 250, gii = 700 /
&output history_every = {every}, dump_every = 1.05e-6 /
&gauge id = 'g', body = 'slab', at = 1e-4, 1e-4, 1e-4, quantity = 'velocity_z' /
"""


def go(n, folder, out, backend, *more):
    every = 0 if backend == "gpu" else 5e-7  # a row tells all processes the state of all points
    (folder / "deck.nml").write_text(GLUED.format(every=every))
    (folder / "good.ptx").write_text(f"// {stamp()}\n")
    gpu = {"LD_LIBRARY_PATH": str(EMULATOR), "BRISANCE_PTX": str(folder / "good.ptx")}
    done = start(n, "run", "deck.nml", "--backend", backend, "--out", out, *more, cwd=folder,
                 **gpu if backend == "gpu" else {})  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout


def points(out):
    """State of all points in the last checkpoint."""
    last = arrays(sorted(out.glob("chk_*.h5"))[-1])
    return [last[f"solid/interface_{name}"] for name in ("damage", "spent", "held")]


@pytest.fixture(name="alone", scope="module", params=["cpu", "gpu"])
def _alone(request, tmp_path_factory):
    """Backend, folder and summary of a run on one process."""
    folder = tmp_path_factory.mktemp(request.param)
    said = go(0, folder, "out", request.param)
    damage = points(folder / "out")[0]
    assert np.count_nonzero(damage == 1) > 80
    assert np.count_nonzero((damage > 0) & (damage < 1)) > 10
    return request.param, folder / "out", broken(said)


def broken(said):
    lines = [line for line in said.splitlines() if line.startswith("interface ")]
    assert len(lines) == 4, said
    return lines


def equal_glued(one, other):
    equal_bodies(one, other)
    for a, b in zip(points(one), points(other), strict=True):
        np.testing.assert_array_equal(a, b)
    a, b = (history(folder / "energy.csv") for folder in (one, other))
    for column in ("bond[J]", "bond_heat[J]"):
        np.testing.assert_array_equal(a[column], b[column])


@needs_mpirun
@pytest.mark.parametrize("n", [slow(2), slow(4)])
def test_interfaces_do_not_depend_on_processes(n, alone, tmp_path):
    backend, one, said = alone
    assert broken(go(n, tmp_path, "out", backend)) == said
    equal_glued(one, tmp_path / "out")


@needs_mpirun
@pytest.mark.parametrize(("n", "m"), [slow(2, 0), (3, 2)])
def test_others_go_on_with_interfaces(n, m, alone, tmp_path):
    backend, one, said = alone
    go(n, tmp_path, "out", backend, "--set", "run.max_steps=50")
    assert np.count_nonzero(points(tmp_path / "out")[0] == 1) > 0
    assert broken(go(m, tmp_path, "out", backend, "--restart", "latest")) == said
    equal_glued(one, tmp_path / "out")
