# SPDX-License-Identifier: MIT
"""A run and what happens around it: another run in its folder."""

import os
import signal
import subprocess

import pytest
from test_run import BRISANCE, DECK, run, tables, wait_for

ENDLESS = ["--set", "run.t_end=1"]


@pytest.fixture
def scene(tmp_path):
    (tmp_path / "slab.nml").write_text(DECK)
    return tmp_path


def start(scene, *args, **kwargs):
    """A run in its first steps at least."""
    process = subprocess.Popen(
        [BRISANCE, "run", "slab.nml", *args],
        cwd=scene, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **kwargs,
    )  # fmt: skip
    wait_for(lambda: list((scene / "out" / "slab").glob("*_00001.vtkhdf")))
    return process


@pytest.mark.parametrize("how", [[], ["--replace"], ["--restart", "latest"]])
def test_one_run_at_a_time_in_a_folder(how, scene):
    """The second ends with code 4 and has changed nothing; the first goes on."""
    process = start(scene, *ENDLESS)
    try:
        wait_for(lambda: list((scene / "out" / "slab").glob("chk_*.h5")))
        done = run("run", "slab.nml", *how, *ENDLESS, cwd=scene, code=4)
        assert f"process {process.pid} on " in done.stderr
        process.send_signal(signal.SIGTERM)
        _, words = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == 75, words
    energy = tables(scene / "out" / "slab")["energy.csv"].decode().splitlines()
    times = [float(row.split(",")[0]) for row in energy[1:]]
    assert times == sorted(set(times))


def test_a_killed_run_leaves_no_lock(scene):
    process = start(scene, *ENDLESS)
    wait_for(lambda: list((scene / "out" / "slab").glob("chk_*.h5")))
    process.kill()
    process.communicate(timeout=60)
    run("run", "slab.nml", "--restart", "latest", "--walltime", "0:00:01", *ENDLESS, cwd=scene,
        code=75)  # fmt: skip


def test_a_restart_that_is_refused_makes_no_folder(scene):
    done = run("run", "slab.nml", "--restart", "latest", cwd=scene, code=4)
    assert "no checkpoint" in done.stderr
    assert os.listdir(scene) == ["slab.nml"]


def test_a_folder_is_no_stop_file(scene):
    (scene / "slab.stop").mkdir()
    done = run("run", "slab.nml", cwd=scene)
    assert done.stderr.count("slab.stop: is a folder") == 1
    assert (scene / "slab.stop").is_dir()
