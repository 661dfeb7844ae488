# SPDX-License-Identifier: MIT
"""Several processes with a GPU each, on an emulated driver: the results of one GPU, restarts on any
number, errors of one process, what is refused."""

import csv
import subprocess

import pytest
from test_gpu import EMULATOR, stamp
from test_ranks import AIR, MPIRUN, TOGETHER, equal_air, needs_mpirun, start
from test_run import BRISANCE, ROOT


@pytest.fixture(name="gpu", scope="module")
def _gpu(tmp_path_factory):
    """What a run on the GPU needs in its environment."""
    code = tmp_path_factory.mktemp("code") / "good.ptx"
    code.write_text(f"// {stamp()}\n", encoding="utf-8")
    return {"LD_LIBRARY_PATH": str(EMULATOR), "BRISANCE_PTX": str(code)}


def go(n, folder, gpu, *args, out="out", **more):
    (folder / "deck.nml").write_text(AIR)
    return start(n, "run", "deck.nml", "--backend", "gpu", "--out", out, *args, cwd=folder,
                 **gpu, **more)  # fmt: skip


@pytest.fixture(name="alone", scope="module")
def _alone(gpu, tmp_path_factory):
    """The folder of a run on one GPU."""
    folder = tmp_path_factory.mktemp("alone")
    done = go(0, folder, gpu)
    assert done.returncode == 0, done.stderr
    return folder / "out"


def rows(path):
    with path.open(encoding="utf-8") as file:
        return [[float(x) for x in row] for row in list(csv.reader(file))[1:]]


@needs_mpirun
@pytest.mark.parametrize("n", [1, 2, 4])
def test_air_does_not_depend_on_gpus(n, gpu, alone, tmp_path):
    done = go(n, tmp_path, gpu, BRISANCE_EMULATOR_DEVICES="4")
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("Emulated GPU") == 1
    assert (f", each of {n} processes on one" in done.stderr) == (n > 1)
    for name in ("gauges.csv", "energy.csv"):
        assert (alone / name).read_text() == (tmp_path / "out" / name).read_text(), name
    equal_air(alone, tmp_path / "out")


@needs_mpirun
@pytest.mark.parametrize(("n", "m"), [(0, 2), (2, 0), (2, 3), (4, 2)])
def test_other_gpus_go_on(n, m, gpu, alone, tmp_path):
    """The state has the same bits; what has left through the boundaries is added up anew."""
    done = go(n, tmp_path, gpu, "--set", "run.max_steps=20")
    assert done.returncode == 0, done.stderr
    done = go(m, tmp_path, gpu, "--restart", "latest")
    assert done.returncode == 0, done.stderr
    assert (alone / "gauges.csv").read_text() == (tmp_path / "out/gauges.csv").read_text()
    equal_air(alone, tmp_path / "out")
    largest = max(abs(x) for row in rows(alone / "energy.csv") for x in row)
    for a, b in zip(rows(alone / "energy.csv"), rows(tmp_path / "out/energy.csv"), strict=True):
        assert a == pytest.approx(b, rel=1e-11, abs=1e-14 * largest)


@needs_mpirun
def test_the_gpus_of_a_machine_are_shared_out(gpu, tmp_path):
    done = go(3, tmp_path, gpu, "--set", "run.max_steps=1", BRISANCE_EMULATOR_DEVICES="2")
    assert done.returncode == 0, done.stderr
    assert ", 3 processes of a machine share the 2 that each of them sees" in done.stderr


@needs_mpirun
@pytest.mark.parametrize(
    ("fault", "words"),
    [
        ("BRISANCE_EMULATOR_FAIL=cuDeviceGetCount", "no GPU: the CUDA driver is there but shows"),
        ("BRISANCE_EMULATOR_MEMORY=100000", "MiB on the GPU, but only 0 MiB are free"),
        ("BRISANCE_EMULATOR_FAIL=cuLaunchKernel:40", "launching "),
        ("BRISANCE_EMULATOR_FAIL=cuMemcpyDtoH_v2:9", "a kernel before it"),
    ],
)
def test_what_goes_wrong_in_one_ends_all(fault, words, gpu, tmp_path):
    (tmp_path / "deck.nml").write_text(AIR)
    program = f"{BRISANCE} run deck.nml --backend gpu --out out"
    command = f"{MPIRUN} -n 1 {program} : -n 1 env {fault} {program} : -n 1 {program}"
    done = subprocess.run(command.split(), cwd=tmp_path, env={**TOGETHER, **gpu}, check=False,
                          capture_output=True, text=True, timeout=60)  # fmt: skip
    assert done.returncode == 5, done.stderr
    said = [line for line in done.stderr.splitlines() if "process 2 of 3: " in line]
    assert len(said) == 1, done.stderr
    assert words in said[0]


@needs_mpirun
def test_a_driver_that_cannot_pin_memory_serves(gpu, alone, tmp_path):
    done = go(2, tmp_path, gpu, BRISANCE_EMULATOR_FAIL="cuMemHostRegister_v2")
    assert done.returncode == 0, done.stderr
    equal_air(alone, tmp_path / "out")


@needs_mpirun
def test_the_cpu_is_taken_where_nothing_is_asked_for(gpu, tmp_path):
    (tmp_path / "deck.nml").write_text(AIR)
    done = start(2, "run", "deck.nml", "--set", "run.max_steps=1", cwd=tmp_path, **gpu)
    assert done.returncode == 0, done.stderr
    assert "GPU" not in done.stderr


@needs_mpirun
def test_bodies_on_several_gpus_are_refused(gpu, tmp_path):
    done = start(2, "run", ROOT / "inputs/rod_concrete.nml", "--backend", "gpu", "--out",
                 tmp_path / "out", **gpu)  # fmt: skip
    assert done.returncode == 2
    assert "does not have bodies on GPUs on several processes" in done.stderr
