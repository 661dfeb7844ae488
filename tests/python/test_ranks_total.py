# SPDX-License-Identifier: MIT
"""Total-Lagrangian bodies that meet others on several processes and GPUs: the bits of one. They
belong to processes by where they were unloaded; one flies past the places of others, one is drawn
to nearly twice its length."""

import re

import numpy as np
import pytest
from test_gpu import EMULATOR, stamp
from test_ranks import BALL, MATERIALS, equal_bodies, needs_mpirun, start
from test_run import history
from tiers import slow

MET = f"""\
&run title = 'met', t_end = 6.5e-6, symmetry = 'y', energy_band = 0.5 /
{MATERIALS}{BALL}\
&body id = 'plate', shape = 'box', box = -0.006,0.006, 0,0.006, -0.002,0, spacing = 1e-3,
     material = 'm', formulation = 'total_lagrangian' /
&body id = 'side', shape = 'box', box = 0.006,0.009, 0,0.004, -0.002,0, spacing = 1e-3,
     material = 'm', velocity = -600, 0, 0 /
&body id = 'flier', shape = 'box', box = 0.007,0.012, 0,0.005, 0.001,0.003, spacing = 1e-3,
     material = 'm', velocity = -1200, 0, -100, spin = 0, 2e4, 0,
     formulation = 'total_lagrangian' /
&body id = 'die', shape = 'box', box = -0.003,0.001, 0,0.003, -0.005,-0.002, spacing = 1e-3,
     material = 'm', formulation = 'rigid', velocity = 20, 0, 80 /
&body id = 'rope', shape = 'box', box = -0.004,0.006, 0,0.002, 0.01,0.012, spacing = 1e-3,
     material = 'm', formulation = 'total_lagrangian', fix = 'x+',
     motion_time = 0,1e-6,1, motion_velocity = 0,0,0, 1500,0,300, 1500,0,300 /
&interaction law = 'contact', friction = 0.3 /
&gauge id = 'edge', body = 'plate', at = 0.0055,0.001,-0.001, quantity = 'speed' /
&gauge id = 'nose', body = 'flier', at = 0.0075,0.001,0.0015, quantity = 'velocity_x' /
&gauge id = 'on', body = 'flier', with = 'plate', quantity = 'impulse_z' /
&output dump_every = 3.3e-6, history_every = 0 /
"""


def go(n, folder, out, backend, *more):
    (folder / "deck.nml").write_text(MET)
    (folder / "good.ptx").write_text(f"// {stamp()}\n")
    gpu = {"LD_LIBRARY_PATH": str(EMULATOR), "BRISANCE_PTX": str(folder / "good.ptx")}
    done = start(n, "run", "deck.nml", "--backend", backend, "--out", out, *more, cwd=folder,
                 **gpu if backend == "gpu" else {})  # fmt: skip
    assert done.returncode == 0, done.stderr


@pytest.fixture(name="alone", scope="module", params=["cpu", slow("gpu")])
def _alone(request, tmp_path_factory):
    """Backend, and the folder of a run on one process. Everything has met."""
    folder = tmp_path_factory.mktemp(request.param)
    go(0, folder, "out", request.param)
    bodies = history(folder / "out/bodies.csv")
    assert bodies["flier:x[m]"][-1] < 0.004
    for name in ("ball", "plate", "side", "flier", "die"):
        turned = np.ptp(bodies[f"{name}:velocity_z[m/s]"])
        assert turned > 1, name
    assert np.ptp(bodies["rope:x[m]"]) > 0.002
    assert abs(history(folder / "out/gauges.csv")["on:impulse_z[N s]"][-1]) > 1e-4
    return request.param, folder / "out"


@pytest.mark.long("several GPUs are emulated")
@needs_mpirun
@pytest.mark.parametrize(("n", "m"), [(2, None), slow(4, 3)])
def test_total_lagrangian_bodies_that_meet_do_not_depend_on_processes(n, m, alone, tmp_path):
    backend, one = alone
    go(n, tmp_path, "out", backend, *([] if m is None else ["--set", "run.max_steps=50"]))
    if m is not None:
        go(m, tmp_path, "out", backend, "--restart", "latest")
    equal_bodies(one, tmp_path / "out")


def test_a_check_counts_what_flies_past_other_regions(tmp_path):
    """Of a body that belongs elsewhere the others need ghosts where they meet it."""
    (tmp_path / "deck.nml").write_text(MET)
    done = start(0, "run", "deck.nml", "--check", "--ranks", "3", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    own, ghosts = zip(*re.findall(r"(\d+) particles of its own, (\d+) of neigh", done.stdout),
                      strict=True)  # fmt: skip
    assert sum(map(int, own)) == 362
    assert 0 < min(map(int, ghosts)) <= max(map(int, ghosts)) < 362
