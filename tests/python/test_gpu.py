# SPDX-License-Identifier: MIT
"""The GPU path of the program where there is no GPU: an emulated driver runs the kernels."""

import os
import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
BINARY = ROOT / "bin" / "brisance"
EMULATOR = ROOT / "build" / "gpu" / "emulator"
DECK = """&run title='t', t_end=2e-4 /
&air box=0,1, 0,0.4, 0,0.3, cells=40,16,12, bc='outflow', reconstruction='weno3' /
&gas id='hot', box=0,0.3, 0,0.2, 0,0.1, density=3, pressure=2e6 /
&gauge id='g', at=0.61,0.23,0.17, quantity='overpressure' /
&output dump_every=1e-4, checkpoint_every=2e-5, history_every=1e-6 /
"""


def stamp():
    """What the program expects in the first line of the GPU code."""
    text = (ROOT / "build" / "cpu" / "version.f90").read_text(encoding="utf-8")
    return re.search(r"device_code = &\s*'(\w+)'", text)[1]


@pytest.fixture(name="deck")
def _deck(tmp_path):
    (tmp_path / "a.nml").write_text(DECK, encoding="utf-8")
    (tmp_path / "good.ptx").write_text(f"// {stamp()}\n", encoding="utf-8")
    return tmp_path


def run(folder, *arguments, driver=True, **extra):
    env = {k: v for k, v in os.environ.items() if not k.startswith("BRISANCE")}
    env["LD_LIBRARY_PATH"] = str(EMULATOR) if driver else "/nonexistent"
    env["BRISANCE_PTX"] = str(folder / "good.ptx")
    env.update(extra)
    command = [str(BINARY), "run", *arguments]
    return subprocess.run(command, cwd=folder, env=env, capture_output=True, text=True, check=False)


def rows(path):
    """Numbers of a history, without the line of names."""
    lines = path.read_text(encoding="utf-8").splitlines()[1:]
    return [[float(x) for x in line.split(",")] for line in lines]


def test_gpu_gives_what_the_cpu_gives(deck):
    for backend in ("gpu", "cpu"):
        done = run(deck, "a.nml", "--backend", backend, "--out", backend)
        assert done.returncode == 0, done.stderr
        assert ("Emulated GPU" in done.stderr) == (backend == "gpu")
    for name in ("gauges.csv", "energy.csv"):
        for a, b in zip(rows(deck / "gpu" / name), rows(deck / "cpu" / name), strict=True):
            assert a == pytest.approx(b, rel=1e-9, abs=1e-9)


def test_a_checkpoint_of_one_backend_serves_the_other(deck):
    assert run(deck, "a.nml", "--backend", "gpu", "--out", "whole").returncode == 0
    first = ("--set", "run.max_steps=12", "--out", "parts")
    assert run(deck, "a.nml", "--backend", "cpu", *first).returncode == 0
    second = ("--restart", "latest", "--out", "parts")
    done = run(deck, "a.nml", "--backend", "gpu", *second)
    assert done.returncode == 0, done.stderr
    whole, parts = (rows(deck / name / "gauges.csv") for name in ("whole", "parts"))
    assert parts[-1] == pytest.approx(whole[-1], rel=1e-9)


def test_two_runs_on_the_gpu_give_the_same_bits(deck):
    for out in ("a", "b"):
        assert run(deck, "a.nml", "--backend", "gpu", "--out", out).returncode == 0
    assert (deck / "a" / "gauges.csv").read_bytes() == (deck / "b" / "gauges.csv").read_bytes()
    assert (deck / "a" / "energy.csv").read_bytes() == (deck / "b" / "energy.csv").read_bytes()


@pytest.mark.parametrize(
    ("extra", "driver", "words"),
    [
        ({}, False, "no CUDA driver"),
        ({"BRISANCE_EMULATOR_FAIL": "cuInit"}, True, "shows no device"),
        ({"BRISANCE_EMULATOR_FAIL": "cuDeviceGetCount"}, True, "shows no device"),
        ({"BRISANCE_EMULATOR_MEMORY": "100000"}, True, "MiB on the GPU, but only 0 MiB are free"),
        ({"BRISANCE_EMULATOR_FAIL": "cuModuleLoadDataEx"}, True, "loading"),
        ({"BRISANCE_EMULATOR_FAIL": "cuMemAlloc_v2"}, True, "out of memory"),
        ({"BRISANCE_EMULATOR_FAIL": "cuLaunchKernel:40"}, True, "launching air_"),
        ({"BRISANCE_EMULATOR_FAIL": "cuMemcpyDtoH_v2:20"}, True, "a kernel before it"),
        ({"BRISANCE_PTX": "missing.ptx"}, True, "make gpu"),
    ],
)
def test_what_goes_wrong_is_told(deck, extra, driver, words):
    done = run(deck, "a.nml", "--backend", "gpu", "--out", "o", driver=driver, **extra)
    assert done.returncode == 5, done.stderr
    assert words in done.stderr


def test_gpu_code_of_other_sources_is_refused(deck):
    (deck / "old.ptx").write_text("// 0123456789abcdef\n" * 9, encoding="utf-8")
    done = run(deck, "a.nml", "--backend", "gpu", BRISANCE_PTX=str(deck / "old.ptx"))
    assert done.returncode == 5
    assert "make gpu again" in done.stderr


def test_auto_takes_the_cpu_where_there_is_no_gpu(deck):
    done = run(deck, "a.nml", "--out", "o", driver=False)
    assert done.returncode == 0
    assert "GPU" not in done.stderr
    done = run(deck, "a.nml", "--out", "p", BRISANCE_PTX="missing.ptx")
    assert done.returncode == 0
    assert "runs on the CPU" in done.stderr


def test_bodies_are_not_on_the_gpu_yet(deck):
    (deck / "b.nml").write_text(
        DECK
        + "&material id='m', model='linear_elastic', density=1e3,"
        + " youngs_modulus=1e9, poisson_ratio=0.3 /\n"
        + "&body id='b', shape='box', box=0.4,0.6, 0.1,0.2, 0.1,0.2, spacing=0.02,"
        + " material='m' /\n",
        encoding="utf-8",
    )
    done = run(deck, "b.nml", "--backend", "gpu", "--check")
    assert done.returncode == 5, done.stderr
    assert "no bodies" in done.stderr


def test_a_failure_leaves_the_last_checkpoint(deck):
    fail = {"BRISANCE_EMULATOR_FAIL": "cuLaunchKernel:900"}
    done = run(deck, "a.nml", "--backend", "gpu", "--out", "o", **fail)
    assert done.returncode == 5, done.stderr
    done = run(deck, "a.nml", "--backend", "gpu", "--out", "o", "--restart", "latest")
    assert done.returncode == 0, done.stderr
