# SPDX-License-Identifier: MIT
"""Several processes as a user starts them: what is printed, exit codes, what is refused."""

import os
import shutil
import subprocess

import pytest
from test_run import BRISANCE, ROOT

ALONE = {**os.environ, "OMP_NUM_THREADS": "1"}
TOGETHER = {**ALONE, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
MPIRUN = "mpirun -q --oversubscribe --mca mpi_yield_when_idle 1 --mca pml ob1 --mca btl self,vader"
needs_mpirun = pytest.mark.skipif(not shutil.which("mpirun"), reason="there is no mpirun")


def start(n, *args, cwd=None, **more):
    """A run on n processes; on one without mpirun if n is 0."""
    command = [*(f"{MPIRUN} -n {n}".split() if n else []), BRISANCE, *args]
    return subprocess.run(command, cwd=cwd, env={**TOGETHER, **more}, capture_output=True,
                          text=True, timeout=300, check=False)  # fmt: skip


@needs_mpirun
def test_the_first_of_them_speaks():
    done = start(3, "--version")
    assert done.returncode == 0
    assert done.stdout.count("Brisance") == 1
    assert not done.stderr
    done = start(3, "run", "no_such.nml")
    assert done.returncode == 2
    assert done.stderr.count("no_such.nml") == 1
    assert "process" not in done.stderr


@needs_mpirun
@pytest.mark.parametrize(
    ("library", "reason"),
    [("/nowhere/libmpi.so", "was not found"), ("libz.so.1", "is not that of Open MPI")],
)
def test_without_its_library_nothing_begins(library, reason):
    done = start(3, "run", ROOT / "inputs/shock_tube.nml", BRISANCE_MPI=library)
    assert done.returncode == 5
    assert len(done.stderr.splitlines()) == 1
    assert reason in done.stderr
    assert "BRISANCE_MPI" in done.stderr


def test_another_mpi_is_named():
    done = start(0, "run", "deck.nml", PMI_RANK="0", PMI_SIZE="4")
    assert done.returncode == 5
    assert "not Open MPI" in done.stderr
    assert start(0, "--version", PMI_RANK="0", PMI_SIZE="1").returncode == 0


@needs_mpirun
@pytest.mark.parametrize(
    ("deck", "args", "reason"),
    [
        ("demo.nml", [], "does not have scenes with bodies on several processes"),
        ("free_air.nml", [], "air along one line"),
        ("reflection.nml", ["--backend", "gpu"], "does not have GPUs on several processes"),
        ("reflection.nml", ["--set", "air.cells=11,11,21"], "2 at most"),
    ],
)
def test_what_is_not_distributed_is_refused(deck, args, reason, tmp_path):
    done = start(3, "run", ROOT / "inputs" / deck, "--out", tmp_path / "out", *args)
    assert done.returncode == 2
    last = done.stderr.splitlines()[-1]
    assert reason in last
    assert "run" in last
    assert not (tmp_path / "out").exists()


def test_a_check_tells_what_processes_get():
    done = start(0, "run", ROOT / "inputs/reflection.nml", "--check", "--ranks", "4")
    assert done.returncode == 0
    assert "processes    4, the largest box over the mean 1.143" in done.stdout
    assert done.stdout.count("of its own") == 4
    assert "cells 1-44 1-24 1-40, 42240 of its own, 8844 of neighbours" in done.stdout
    done = start(0, "run", ROOT / "inputs/reflection.nml", "--check", "--ranks", "zero")
    assert done.returncode == 2
