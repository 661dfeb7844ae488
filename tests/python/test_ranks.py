# SPDX-License-Identifier: MIT
"""Several processes as a user starts them: what is printed, exit codes, what is refused."""

import os
import shutil
import signal
import subprocess
import time

import numpy as np
import pytest
import pyvista
from test_run import BRISANCE, ROOT, arrays, history
from tiers import slow

from post.errors import PostError
from post.reader import Run

ALONE = {**os.environ, "OMP_NUM_THREADS": "1"}
TOGETHER = {**ALONE, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
MPIRUN = "mpirun -q --oversubscribe --mca mpi_yield_when_idle 1 --mca pml ob1 --mca btl self,vader"
needs_mpirun = pytest.mark.skipif(not shutil.which("mpirun"), reason="there is no mpirun")


def start(n, *args, cwd=None, **more):
    """A run on n processes; on one without mpirun if n is 0."""
    command = [*(f"{MPIRUN} -n {n}".split() if n else []), BRISANCE, *args]
    return subprocess.run(command, cwd=cwd, env={**TOGETHER, **more}, capture_output=True,
                          text=True, timeout=300, check=False)  # fmt: skip


def go(n, deck, folder, *args, out="out"):
    """A run of a deck in a folder that must end well."""
    (folder / "deck.nml").write_text(deck)
    done = start(n, "run", "deck.nml", "--out", out, *args, cwd=folder)
    assert done.returncode == 0, done.stderr
    return done


# steel and something soft; a ball that meets what lies below z = 0
MATERIALS = """\
&material id = 's', preset = 'rebar' /
&material id = 'm', model = 'linear_elastic', density = 1200, youngs_modulus = 5e9,
     poisson_ratio = 0.3 /
"""
BALL = """\
&body id = 'ball', shape = 'sphere', centre = 0, 0, 0.0032, radius = 0.003, spacing = 1e-3,
     material = 's', velocity = 60, 0, -300 /
"""


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
def test_more_processes_than_boxes_are_refused(tmp_path):
    done = start(3, "run", ROOT / "inputs/reflection.nml", "--out", tmp_path / "out",
                 "--set", "air.cells=11,11,21")  # fmt: skip
    assert done.returncode == 2
    assert "run 2 at most" in done.stderr.splitlines()[-1]
    assert not (tmp_path / "out").exists()


@needs_mpirun
def test_the_first_computes_the_air_along_a_line(tmp_path):
    for n in (0, 3):
        done = start(n, "run", ROOT / "inputs/free_air.nml", "--out", tmp_path / str(n),
                     "--set", "charge.radial_cells=60")  # fmt: skip
        assert done.returncode == 0, done.stderr
        assert ("one of 3 computes a geometry = 'spherical'" in done.stdout) == (n == 3)
    for file in (tmp_path / "0").glob("*.csv"):
        assert file.read_text() == (tmp_path / "3" / file.name).read_text()
    done = start(3, "run", ROOT / "inputs/free_air.nml", "--out", tmp_path / "3")
    assert done.returncode == 4
    assert done.stderr.count("--replace") == 1


def test_a_check_tells_what_processes_get():
    done = start(0, "run", ROOT / "inputs/reflection.nml", "--check", "--ranks", "4")
    assert done.returncode == 0
    assert "processes    4, the largest box over the mean 1.143" in done.stdout
    assert done.stdout.count("of its own") == 4
    assert "cells 1-44 1-24 1-40, 42240 of its own, 8844 of neighbours" in done.stdout
    done = start(0, "run", ROOT / "inputs/reflection.nml", "--check", "--ranks", "zero")
    assert done.returncode == 2
    done = start(0, "run", ROOT / "inputs/reflection.nml", "--ranks", "4")
    assert done.returncode == 2
    assert "mpirun -n 4" in done.stderr


# A burst of gas with products between all kinds of boundary, gauges across the cuts: some seconds.
AIR = """\
&run title = 'burst', t_end = 1e-4 /
&air box = 0, 0.96,  0, 0.64,  0, 0.76, cells = 24, 16, 19, reconstruction = 'muscl',
     flux = 'hllc', bc = 'symmetry', 'outflow',  'periodic', 'periodic',  'wall', 'outflow',
     integrator = 'ssprk2' /
&charge id = 'c', mass = 13, gamma = 1.3, at = 0.35, 0.3, 0.4 /
&gas id = 'g', box = 0.5, 0.8,  0.1, 0.5,  0.2, 0.6, density = 2, pressure = 3e5 /
&gauge id = 'floor', at = 0.3, 0.31, 0, quantity = 'overpressure' /
&gauge id = 'cut', at = 0.47, 0.33, 0.36, quantity = 'speed' /
&output dump_every = 3e-5, history_every = 0 /
"""


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """The folder of a run on one process."""
    folder = tmp_path_factory.mktemp("alone")
    go(0, AIR, folder)
    return folder / "out"


def equal_results(one, other):
    """Histories are the same text, dumps the same numbers."""
    for name in ("gauges.csv", "energy.csv"):
        assert (one / name).read_text() == (other / name).read_text(), name
    equal_air(one, other)


def equal_air(one, other):
    """All dumps of the air hold the same numbers."""
    frames = [Run(folder).frames for folder in (one, other)]
    assert len(frames[0]) == len(frames[1]) > 0
    for a, b in zip(*frames, strict=True):
        x, y = a.air(), b.air()
        assert list(x.field) == list(y.field)
        assert all((x.field[name] == y.field[name]).all() for name in x.field)
        assert (x.cells == y.cells).all()


@needs_mpirun
@pytest.mark.parametrize("n", [1, slow(2), 3, slow(4)])
def test_results_do_not_depend_on_processes(n, alone, tmp_path):
    done = go(n, AIR, tmp_path)
    assert done.stdout.count("results    out") == 1
    equal_results(alone, tmp_path / "out")
    if n < 2:
        return
    part = tmp_path / "out/air_00001.part002.h5"
    mesh = [pyvista.read(folder / "air_00001.vtkhdf") for folder in (alone, tmp_path / "out")]
    assert all((mesh[0].cell_data[k] == mesh[1].cell_data[k]).all() for k in mesh[0].cell_data)
    part.unlink()
    with pytest.raises(PostError, match=r"part air_00001\.part002\.h5 is missing"):
        Run(tmp_path / "out").frames[1].air("pressure")


# Decks that come with the program, short: a blast that starts in one dimension, a tube.
SHORT = {
    "reflection": ["air.cells=16,16,32", "run.t_end=6e-4", "output.dump_every=1e-4"],
    "shock_tube": ["output.dump_every=1e-2"],
}


@needs_mpirun
@pytest.mark.parametrize("numbers", [(0, 3), slow((0, 2, 4))])
@pytest.mark.parametrize("name", SHORT)
def test_decks_of_the_program_give_the_same(name, numbers, tmp_path):
    changes = [word for change in SHORT[name] for word in ("--set", change)]
    for n in numbers:
        done = start(n, "run", ROOT / f"inputs/{name}.nml", "--out", tmp_path / str(n), *changes)
        assert done.returncode == 0, done.stderr
        if n > 0:
            equal_results(tmp_path / "0", tmp_path / str(n))
            assert f"processes  {n}, the largest box over the mean" in done.stdout


BLOWN = """\
&run t_end = 3e-4 /
&air box = 0, 0.96,  0, 0.64,  0, 0.76, cells = 24, 16, 19 /
&inflow face = 'x-', time = 0, 1e-4, 3e-4, overpressure = 4e5, 2e5, 0 /
&inflow face = 'z+', mach = 1.5, pressure = 2e5, 3e5, time = 1e-4, 2e-4 /
&gauge id = 'a', at = 0.1, 0.31, 0.4, quantity = 'overpressure' /
&output dump_every = 1e-4, history_every = 0 /
"""


@needs_mpirun
@pytest.mark.parametrize("numbers", [(0, 3), slow((0, 2, 4))])
def test_what_comes_in_does_not_depend_on_processes_or_pieces(numbers, tmp_path):
    (tmp_path / "deck.nml").write_text(BLOWN)
    for n in numbers:
        done = start(n, "run", "deck.nml", "--out", str(n), cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        equal_results(tmp_path / "0", tmp_path / str(n))
    start(3, "run", "deck.nml", "--out", "parts", "--set", "run.max_steps=11", cwd=tmp_path)
    done = start(0, "run", "deck.nml", "--out", "parts", "--restart", "latest", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    equal_results(tmp_path / "0", tmp_path / "parts")
    assert history(tmp_path / "0/gauges.csv")["a:overpressure[Pa]"].max() > 2e5


@needs_mpirun
@pytest.mark.parametrize("n", [0, slow(2), 3, slow(4)])
def test_any_number_of_processes_goes_on(n, alone, tmp_path):
    (tmp_path / "deck.nml").write_text(AIR)
    done = start(n, "run", "deck.nml", "--out", "out", "--set", "run.max_steps=20", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    for m in (0, 2, 3, 4) if n == 3 else (2, 3):
        shutil.copytree(tmp_path / "out", tmp_path / str(m))
        done = start(m, "run", "deck.nml", "--out", str(m), "--restart", "latest", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        equal_results(alone, tmp_path / str(m))


@needs_mpirun
def test_a_checkpoint_without_a_part_is_refused(tmp_path):
    (tmp_path / "deck.nml").write_text(AIR)
    start(3, "run", "deck.nml", "--out", "out", "--set", "run.max_steps=5", cwd=tmp_path)
    (tmp_path / "out/chk_000005.part003.h5").unlink()
    for m in (0, 2):
        done = start(m, "run", "deck.nml", "--out", "out", "--restart", "latest", cwd=tmp_path)
        assert done.returncode == 4
        assert "chk_000005.part003.h5: is lost, one of the 3 parts" in done.stderr
    part = tmp_path / "out/chk_000005.part001.h5"
    part.write_bytes(part.read_bytes()[:-100] + bytes(100))
    done = start(2, "run", "deck.nml", "--restart", "out/chk_000005.h5", cwd=tmp_path)
    assert done.returncode == 4
    assert "part001.h5: is damaged" in done.stderr


@needs_mpirun
def test_a_lost_cell_is_told_once_and_alike(tmp_path):
    (tmp_path / "deck.nml").write_text(AIR)
    changes = ["air.fallback=.false.", "air.ramp_steps=0", "air.cfl=0.9", "gas(g).pressure=1e3",
               "gas(g).velocity=3000,0,0", "air.reconstruction='weno5z'",
               "air.integrator='ssprk3'"]  # fmt: skip
    words = []
    for n in (0, 3):
        done = start(n, "run", "deck.nml", "--out", f"out{n}",
                     *(word for change in changes for word in ("--set", change)),
                     cwd=tmp_path)  # fmt: skip
        assert done.returncode == 3, done.stderr
        words.append([line for line in done.stderr.splitlines() if "the air is lost" in line])
    assert len(words[0]) == 1
    assert words[0] == words[1]


@needs_mpirun
@pytest.mark.parametrize("name", ["air_00001.part002.h5", "chk_000020.part002.h5"])
def test_what_one_cannot_write_ends_all(name, tmp_path):
    """The second process finds a folder in the place of its part; the checkpoint before counts."""
    (tmp_path / "deck.nml").write_text(AIR)
    (tmp_path / "out" / name / "in the way").mkdir(parents=True)
    often = ("--set", "output.dump_every=5e-6", "--set", "output.checkpoint_every=2e-6")
    begin = ("run", "deck.nml", "--out", "out", "--replace", *often)
    done = start(3, *begin, "--set", "run.max_steps=20", cwd=tmp_path)
    assert done.returncode == 4, done.stderr
    assert done.stderr.count("process 2 of 3: ") == 1
    assert not list((tmp_path / "out").glob("*.tmp"))
    shutil.rmtree(tmp_path / "out" / name)
    done = start(2, "run", "deck.nml", "--out", "out", "--restart", "latest", cwd=tmp_path)
    assert done.returncode == 0, done.stderr


def running(folder, n, *args):
    """A run on n processes that would take minutes, after its first rows."""
    (folder / "deck.nml").write_text(AIR)
    command = [*f"{MPIRUN} -n {n}".split(), BRISANCE, "run", "deck.nml", "--out", "out", "--set",
               "run.t_end=0.4", "--set", "air.cells=48,32,38", *args]  # fmt: skip
    run = subprocess.Popen(command, cwd=folder, env=TOGETHER, text=True,
                           stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)  # fmt: skip
    while not (folder / "out/air.vtkhdf.series").exists():
        time.sleep(0.1)
        assert run.poll() is None
    return run


@needs_mpirun
def test_signals_and_stop_files_reach_all(tmp_path):
    run = running(tmp_path, 3)
    run.send_signal(signal.SIGUSR1)
    while not list((tmp_path / "out").glob("chk_??????.h5")):
        time.sleep(0.1)
        assert run.poll() is None
    run.send_signal(signal.SIGUSR2)
    words = run.communicate(timeout=60)[1]
    assert run.returncode == 75
    assert words.count("stopped by SIGUSR2") == 1
    run = running(tmp_path, 2, "--restart", "latest")
    (tmp_path / "deck.stop").write_text("")
    words = run.communicate(timeout=60)[1]
    assert run.returncode == 75
    assert "stopped by a stop file" in words


@needs_mpirun
def test_a_killed_process_ends_all_and_the_wall_clock_stops_all(tmp_path):
    run = running(tmp_path, 3, "--set", "output.checkpoint_every=1e-6")
    while not list((tmp_path / "out").glob("chk_??????.h5")):
        time.sleep(0.1)
    ranks = subprocess.run(["pgrep", "-P", str(run.pid)], capture_output=True, text=True,
                           check=True).stdout.split()  # fmt: skip
    os.kill(int(ranks[-1]), signal.SIGKILL)
    run.communicate(timeout=30)
    assert run.returncode not in (0, 75)
    done = start(2, "run", "deck.nml", "--out", "out", "--restart", "latest", "--walltime", "1",
                 "--set", "run.t_end=0.4", "--set", "air.cells=48,32,38", cwd=tmp_path)  # fmt: skip
    assert done.returncode == 75, done.stderr
    assert "stopped by the wall-clock limit" in done.stderr


# Bodies that meet: friction, a rigid body that turns and one that is driven, bonds that break, at a
# plane of symmetry.
def in_two(n, m, steps, folder):
    """Run deck.nml of a folder for some steps on n processes, then to its end on m."""
    for k, more in ((n, ("--set", f"run.max_steps={steps}")), (m, ("--restart", "latest"))):
        done = start(k, "run", "deck.nml", "--out", "out", *more, cwd=folder)
        assert done.returncode == 0, done.stderr


def equal_bodies(one, other):
    """Dumps and gauges are the same; diagnostics are sums over steps, which processes round
    apart."""
    assert (one / "gauges.csv").read_text() == (other / "gauges.csv").read_text()
    names = sorted(file.name for file in one.glob("*.vtkhdf"))
    assert names == sorted(file.name for file in other.glob("*.vtkhdf"))
    for name in names:
        first, second = arrays(one / name), arrays(other / name)
        assert first.keys() == second.keys()
        assert all(np.array_equal(first[path], second[path]) for path in first)
    for name in ("bodies.csv", "energy.csv"):
        a, b = history(one / name), history(other / name)
        for column in a.dtype.names:
            scale = np.abs(a[column]).max()
            if name == "energy.csv":
                scale = 1 if column == "error[-]" else max(scale, a["energy_scale[J]"].max())
            assert np.abs(a[column] - b[column]).max() <= 1e-12 * scale, column
