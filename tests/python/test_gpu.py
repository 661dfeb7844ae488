# SPDX-License-Identifier: MIT
"""The GPU path of the program where there is no GPU: an emulated driver runs the kernels."""

import json
import os
import re
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest
from test_damage import seal

ROOT = Path(__file__).parents[2]
BINARY = ROOT / "bin" / "brisance"
EMULATOR = ROOT / "build" / "gpu" / "emulator"
DECK = """&run title='t', t_end=2e-4 /
&air box=0,1, 0,0.4, 0,0.3, cells=30,12,9, bc='outflow', reconstruction='weno3' /
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


def run(folder, *arguments, driver=True, limit="unlimited", **extra):
    env = {k: v for k, v in os.environ.items() if not k.startswith("BRISANCE")}
    env["LD_LIBRARY_PATH"] = str(EMULATOR) if driver else "/nonexistent"
    env["BRISANCE_PTX"] = str(folder / "good.ptx")
    env.update(extra)
    limited = f'ulimit -f {limit}; exec "$@"'  # of the size of a file, in kB
    command = ["bash", "-c", limited, "bash", str(BINARY), "run", *arguments]
    return subprocess.run(command, cwd=folder, env=env, capture_output=True, text=True, check=False)


def follows_the_cpu(alone, folder):
    """Run deck.nml of a folder on the GPU: its histories are those in `alone`, of the CPU."""
    (folder / "good.ptx").write_text(f"// {stamp()}\n", encoding="utf-8")
    done = run(folder, "deck.nml", "--out", "out", "--backend", "gpu")
    assert done.returncode == 0, done.stderr
    for name in ("gauges", "bodies"):
        one, other = (np.loadtxt(f / f"{name}.csv", delimiter=",", skiprows=1)
                      for f in (alone, folder / "out"))  # fmt: skip
        assert one.shape == other.shape
        assert (abs(one - other).max(axis=0) <= 1e-8 * abs(one).max(axis=0) + 1e-12).all(), name


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


def test_a_check_needs_no_state_on_the_gpu(deck):
    done = run(deck, "a.nml", "--backend", "gpu", "--check")
    assert done.returncode == 0, done.stderr
    assert "the deck is sound" in done.stdout


def test_a_checkpoint_of_one_backend_serves_the_other(deck):
    assert run(deck, "a.nml", "--backend", "gpu", "--out", "whole").returncode == 0
    first = ("--set", "run.max_steps=12", "--out", "parts")
    assert run(deck, "a.nml", "--backend", "cpu", *first).returncode == 0
    second = ("--restart", "latest", "--out", "parts")
    done = run(deck, "a.nml", "--backend", "gpu", *second)
    assert done.returncode == 0, done.stderr
    whole, parts = (rows(deck / name / "gauges.csv") for name in ("whole", "parts"))
    assert parts[-1] == pytest.approx(whole[-1], rel=1e-9)


BLOWN = """&run t_end=4e-4 /
&air box=0,0.4, 0,0.3, 0,0.2, cells=20,15,10, density=1.2, pressure=1e5 /
&inflow face='x-', time=5e-5,1e-4,3e-4, overpressure=4e5,2e5,0 /
&inflow face='z+', table='wind.csv' /
&gauge id='g', at=0.11,0.13,0.07, quantity='overpressure' /
&gauge id='h', at=0.31,0.13,0.17, quantity='speed' /
&output dump_every=1e-4, checkpoint_every=2e-5, history_every=1e-6 /
"""
WIND = "time [s],density,pressure,velocity_z\n0,1.2,1e5,0\n1e-4,1.2,1e5,0\n2e-4,3,2e5,-500\n"


def equal_backends(deck, text, steps, names, near):
    """A GPU has the tables of the CPU, after a restart from a few steps of the CPU, too. Returned
    is the last of these tables."""
    (deck / "scene.nml").write_text(text, encoding="utf-8")
    for backend in ("gpu", "cpu"):
        done = run(deck, "scene.nml", "--backend", backend, "--out", backend)
        assert done.returncode == 0, done.stderr
        assert ("Emulated GPU" in done.stderr) == (backend == "gpu")
    first = ("--set", f"run.max_steps={steps}", "--out", "parts")
    assert run(deck, "scene.nml", "--backend", "cpu", *first).returncode == 0
    done = run(deck, "scene.nml", "--backend", "gpu", "--restart", "latest", "--out", "parts")
    assert done.returncode == 0, done.stderr
    for name in names:
        whole, here, parts = (rows(deck / x / f"{name}.csv") for x in ("gpu", "cpu", "parts"))
        for a, b in zip(whole, here, strict=True):
            assert a == pytest.approx(b, rel=1e-8, abs=near)
        assert parts[-1] == pytest.approx(whole[-1], rel=1e-8, abs=near)
    return whole


def test_what_comes_in_is_that_of_the_cpu_after_a_restart_too(deck):
    (deck / "wind.csv").write_text(WIND, encoding="utf-8")
    equal_backends(deck, BLOWN, 20, ("energy", "gauges"), 1e-8)
    gauges = list(zip(*rows(deck / "gpu" / "gauges.csv"), strict=True))
    assert min(max(abs(x) for x in column) for column in gauges[1:]) > 100  # both are reached


LOADED = """&run t_end=4e-6 /
&material id='m', model='linear_elastic', density=7800, youngs_modulus=2e11, poisson_ratio=0.3 /
&body id='b', box=0,0.005, 0,0.004, 0,0.003, spacing=0.001, material='m', fix='x-' /
&body id='r', box=0,0.002, 0,0.002, 0.00305,0.00505, spacing=0.001, material='m', velocity=0,0,-50,
    formulation='rigid' /
&load body='b', faces='x+','z-', mass=1, at=0.4,0.1,-0.2, detonation_time=-1.4e-4 /
&load body='b', acceleration=0,1e5,0 /
&load body='r', faces='y-', time=0,2e-6,4e-6, pressure=0,1e8,0 /
&interaction law='contact', friction=0.2 /
&gauge id='f', body='b', quantity='reaction_x' /
&gauge id='m', body='b', quantity='moment_y', at=0,0,0.001 /
&gauge id='l', body='b', quantity='load_z' /
&gauge id='c', body='b', quantity='contact_z' /
&gauge id='d', body='r', quantity='contact_y' /
&gauge id='w', body='b', with='r', quantity='contact_z' /
&gauge id='v', body='r', with='b', quantity='impulse_z' /
&gauge id='i', body='r', quantity='impulse_y' /
&gauge id='s', body='b', at=0.002,0,0, quantity='stress_xx' /
&gauge id='e', body='b', at=0.002,0,0, to=0.005,0.004,0.003, quantity='strain' /
&output dump_every=1, checkpoint_every=5e-7, history_every=1e-7 /
"""


def test_loads_are_those_of_the_cpu_after_a_restart_too(deck):
    whole = equal_backends(deck, LOADED, 12, ("bodies", "gauges"), 1e-9)
    for column in zip(*whole, strict=True):  # none of the gauges has nothing to say
        assert max(abs(x) for x in column) > 1e-6


def test_the_time_of_each_kernel_is_printed(deck):
    done = run(deck, "a.nml", "--backend", "gpu", "--out", "a", "--profile", "--calls")
    assert done.returncode == 0, done.stderr
    table = [line.split() for line in done.stdout.split("kernel ", 1)[1].splitlines()[1:]]
    table = table[: [row[0] for row in table].index("all") + 1]
    seconds = [float(row[2]) for row in table[:-1]]
    assert seconds == sorted(seconds, reverse=True)
    assert 0.9 * float(table[-1][2]) < sum(seconds) <= float(table[-1][2]) + 0.01
    steps = int(re.search(r"after (\d+) steps", done.stdout)[1])
    marches = [int(row[1]) for row in table if row[0].startswith("march_")]
    assert marches, table
    assert all(n % steps == 0 for n in marches), (steps, marches)
    parts = re.findall(r"^(air|time step) +(\d+) +([\d.]+) +([\d.]+)", done.stdout, re.M)
    assert [(row[0], int(row[1])) for row in parts] == [("time step", steps), ("air", steps)]
    launches = sum(int(row[1]) for row in table[:-1] if row[0].startswith(("march_", "last_")))
    assert float(parts[1][3]) >= launches / steps
    done = run(deck, "a.nml", "--backend", "cpu", "--out", "b", "--profile")
    assert done.returncode == 2
    assert "on the CPU" in done.stderr


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
        ({"BRISANCE_EMULATOR_FAIL": "cuLaunchKernel:40"}, True, "launching "),
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


SOLID = """&run title='t', t_end=8e-7, symmetry='x' /
&material id='cu', preset='ofhc_copper' /
&material id='ply', preset='cfrp_woven' /
&body id='rod', shape='cylinder', axis='z', centre=0,0,0.003, radius=0.002, length=0.006,
      spacing=0.0005, material='cu', velocity=0,0,-190, fix='z-' /
&body id='plate', shape='box', box=0.0021,0.0061, 0,0.004, 0,0.0015, spacing=0.0005, material='ply',
      plies='3*(0/90)', velocity=0,0,150, fix='x+' /
&interaction bodies='rod','plate', law='LAW' /
&gauge id='g', body='rod', at=0,0,0.005, quantity='velocity_z' /
&gauge id='w', body='rod', at=0,0,0.005, quantity='velocity_z', width=0.002 /
&output dump_every=4e-7, checkpoint_every=2e-7, history_every=1e-7 /
"""


@pytest.fixture(name="solid")
def _solid(deck):
    (deck / "s.nml").write_text(SOLID.replace("LAW", "contact"), encoding="utf-8")
    return deck


def same(first, second, folder):
    """The histories of two runs agree to rounding, column by column."""
    for name in ("energy.csv", "bodies.csv", "gauges.csv"):
        columns = [zip(*rows(folder / x / name), strict=True) for x in (first, second)]
        for a, b in zip(*columns, strict=True):
            scale = max(map(abs, b)) + 1e-30
            if name == "energy.csv" or scale > 1e-12:
                assert a == pytest.approx(b, rel=1e-8, abs=max(1e-8 * scale, 1e-9))


def test_bodies_on_the_gpu_are_those_of_the_cpu(solid):
    for backend in ("gpu", "cpu"):
        done = run(solid, "s.nml", "--backend", backend, "--out", backend)
        assert done.returncode == 0, done.stderr
        assert ("the bodies run on Emulated" in done.stderr) == (backend == "gpu")
    same("gpu", "cpu", solid)
    with (
        h5py.File(solid / "gpu/solid_00002.vtkhdf") as a,
        h5py.File(solid / "cpu/solid_00002.vtkhdf") as b,
    ):
        for key in ("Points", "PointData/velocity", "PointData/stress"):
            x, y = a["VTKHDF/" + key][:], b["VTKHDF/" + key][:]
            assert abs(x - y).max() <= 1e-5 * abs(y).max(), key


def test_a_checkpoint_of_bodies_serves_both_backends(solid):
    assert run(solid, "s.nml", "--backend", "gpu", "--out", "whole").returncode == 0
    first = ("--set", "run.max_steps=9", "--out", "parts")
    for backend, more in (("gpu", first), ("cpu", ("--set", "run.max_steps=20")), ("gpu", ())):
        restart = () if more is first else ("--restart", "latest", "--out", "parts")
        done = run(solid, "s.nml", "--backend", backend, *more, *restart)
        assert done.returncode == 0, done.stderr
    same("whole", "parts", solid)


def test_a_restart_on_the_gpu_gives_the_same_bits(solid):
    assert run(solid, "s.nml", "--backend", "gpu", "--out", "a").returncode == 0
    first = ("--set", "run.max_steps=9", "--out", "b")
    assert run(solid, "s.nml", "--backend", "gpu", *first).returncode == 0
    second = ("--restart", "latest", "--out", "b")
    assert run(solid, "s.nml", "--backend", "gpu", *second).returncode == 0
    assert rows(solid / "a" / "gauges.csv") == rows(solid / "b" / "gauges.csv")
    assert rows(solid / "a" / "bodies.csv")[-1][:8] == rows(solid / "b" / "bodies.csv")[-1][:8]


DAMAGED = """&run title='t', t_end=2.5e-6 /
&material id='m', preset='hjc_48' /
&body id='b', box=0,0.02, 0,0.02, 0,0.02, spacing=2e-3, material='m', velocity=0,0,-100 /
&body id='f', box=0,0.02, 0,0.02, -0.01,0, spacing=2e-3, material='m', fix='all' /
&gauge id='d', at=0.01,0.01,0.001, quantity='damage', body='b' /
&gauge id='v', at=0.01,0.01,0.001, quantity='velocity_z', body='b' /
&gauge id='w', at=0.01,0.01,0.001, quantity='damage', body='b', width=0.01 /
&output history_every=5e-7 /
"""


def test_a_gauge_of_damage_sees_the_gpu(deck):
    """What is not the motion of a particle is brought from the GPU as well."""
    (deck / "d.nml").write_text(DAMAGED, encoding="utf-8")
    for backend in ("gpu", "cpu"):
        done = run(deck, "d.nml", "--backend", backend, "--out", backend)
        assert done.returncode == 0, done.stderr
    gpu, cpu = (rows(deck / name / "gauges.csv") for name in ("gpu", "cpu"))
    assert cpu[-1][1] > 0.01
    for a, b in zip(gpu, cpu, strict=True):
        assert a == pytest.approx(b, rel=1e-8, abs=1e-10)


def test_what_bodies_cannot_do_on_the_gpu_is_told(solid):
    air = "&air box=0,1, 0,1, 0,1, cells=8,8,8, bc='outflow' /\n&coupling scheme='paper' /\n"
    (solid / "d.nml").write_text(air + SOLID.replace("LAW", "none"), encoding="utf-8")
    words = "scheme='paper'"
    done = run(solid, "d.nml", "--backend", "gpu", "--check")
    assert done.returncode == 5, done.stderr
    assert words in done.stderr
    done = run(solid, "d.nml", "--backend", "auto", "--check")
    assert done.returncode == 0, done.stderr
    assert "runs on the CPU" in done.stderr and words in done.stderr


def test_a_lost_particle_is_reported(solid):
    fast = ("--set", "body(rod).velocity=0,0,-9e5", "--out", "o")
    done = run(solid, "s.nml", "--backend", "gpu", *fast)
    assert done.returncode == 3, done.stderr
    assert "particle" in done.stderr and "impossible state" in done.stderr


def test_a_failure_leaves_the_last_checkpoint(deck):
    fail = {"BRISANCE_EMULATOR_FAIL": "cuLaunchKernel:900"}
    done = run(deck, "a.nml", "--backend", "gpu", "--out", "o", **fail)
    assert done.returncode == 5, done.stderr
    done = run(deck, "a.nml", "--backend", "gpu", "--out", "o", "--restart", "latest")
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("launch", range(200, 240, 15))
def test_what_copies_write_gets_its_name_after_a_failure(deck, launch):
    """Dumps and checkpoints of every step: some are under way when the GPU fails."""
    every = "output.checkpoint_every=1e-9", "output.dump_every=1e-9", "air.cells=8,8,8"
    sets = [part for text in every for part in ("--set", text)]
    fail = {"BRISANCE_EMULATOR_FAIL": f"cuLaunchKernel:{launch}"}
    done = run(deck, "a.nml", "--backend", "gpu", "--out", "o", *sets, **fail)
    assert done.returncode == 5, done.stderr
    files = sorted(path.name for path in (deck / "o").glob("air_*.vtkhdf"))
    series = json.loads((deck / "o/air.vtkhdf.series").read_text(encoding="utf-8"))
    assert [entry["name"] for entry in series["files"]] == files
    steps = [int(path.stem[4:]) for path in sorted((deck / "o").glob("chk_*.h5"))]
    assert steps in ([len(files) - 2, len(files) - 1], [len(files) - 3, len(files) - 2])
    assert not list((deck / "o").glob("*.tmp"))


def test_a_full_disk_ends_the_run_and_leaves_the_checkpoint(deck):
    """Dumps and checkpoints are written beside the run; what they report is heard."""
    assert run(deck, "a.nml", "--backend", "gpu", "--out", "whole").returncode == 0
    first = ("--set", "run.max_steps=30", "--out", "o")
    assert run(deck, "a.nml", "--backend", "gpu", *first).returncode == 0
    more = ("--backend", "gpu", "--restart", "latest", "--out", "o")
    done = run(deck, "a.nml", *more, limit="200")
    assert done.returncode == 4, done.stderr
    assert done.stderr.count("File too large") == 1, done.stderr
    assert done.stderr.count("could not be written") == 1, done.stderr
    assert done.stderr.count("runs on Emulated GPU") == 1, done.stderr
    done = run(deck, "a.nml", *more)
    assert done.returncode == 0, done.stderr
    for name in ("gauges.csv", "air.vtkhdf.series"):
        assert (deck / "o" / name).read_bytes() == (deck / "whole" / name).read_bytes()
    with (
        h5py.File(deck / "o/air_00002.vtkhdf") as a,
        h5py.File(deck / "whole/air_00002.vtkhdf") as b,
    ):
        for key in ("pressure", "velocity"):
            assert (a["VTKHDF/CellData/" + key][:] == b["VTKHDF/CellData/" + key][:]).all()


def test_a_lost_cell_ends_the_run_and_leaves_the_checkpoint(deck):
    first = ("--set", "run.max_steps=12", "--out", "o")
    assert run(deck, "a.nml", "--backend", "gpu", *first).returncode == 0
    good = sorted((deck / "o").glob("chk_*.h5"))[-1]
    (deck / "bad.h5").write_bytes(good.read_bytes())
    with h5py.File(deck / "bad.h5", "r+") as file:
        file["air/u"][0, 3 + 5, 3 + 7, 3 + 20] = -1.0  # density
    seal(deck / "bad.h5")
    before = good.read_bytes()
    done = run(deck, "a.nml", "--backend", "gpu", "--restart", str(deck / "bad.h5"), "--out", "p")
    assert done.returncode == 3, done.stderr
    told = re.search(r"cell (\d+), (\d+), (\d+) would have", done.stderr)
    assert told, done.stderr
    cell = [int(x) for x in told.groups()]
    assert all(abs(a - b) <= 3 for a, b in zip(cell, (21, 8, 6), strict=True)), cell
    assert good.read_bytes() == before
    done = run(deck, "a.nml", "--backend", "gpu", "--restart", "latest", "--out", "o")
    assert done.returncode == 0, done.stderr
