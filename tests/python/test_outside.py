# SPDX-License-Identifier: MIT
"""A run and what happens around it: another run in its folder, signals, a full standard output."""

import os
import pty
import re
import signal
import subprocess
import sys

import pytest
from test_run import BRISANCE, DECK, ROOT, run, tables, wait_for
from tiers import slow

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


# A blast that runs along the radius for a second or more before its first step in the grid.
BLAST = """\
&run t_end=4e-3, symmetry='x','y','z' /
&air box=0,3, 0,3, 0,3, cells=15,15,15 /
&charge id='tnt', mass=1, eos='jwl', start='1d', at=0,0,0 /
&gauge id='far', at=2.5,0,0, quantity='overpressure' /
&output history_every=1e-5, report_every=0.1 /
"""
PATH = ROOT / "inputs" / "material" / "bilinear_rebar.nml"
STOPS = [signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGQUIT, signal.SIGUSR2]
ONE_THREAD = {**os.environ, "OMP_NUM_THREADS": "1"}


# Signals of the terminal as a shell in the foreground hands them on (0), or ignored (1).
AFTER = """
import os, signal, sys
for number in signal.SIGHUP, signal.SIGINT, signal.SIGQUIT:
    signal.signal(number, signal.Handlers(int(sys.argv[1])))
os.execv(sys.argv[2], sys.argv[2:])
"""


def with_signals(handler):
    """The program and its deck, behind what sets the signals."""
    return [sys.executable, "-c", AFTER, str(int(handler)), str(BRISANCE), "run", "slab.nml"]


def ask_while_set_up(scene, number, handler=signal.SIG_DFL):
    """A run that gets a signal as soon as the blast along its radius moves; its code and words."""
    (scene / "slab.nml").write_text(BLAST)
    process = subprocess.Popen(
        with_signals(handler), cwd=scene, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        text=True, env=ONE_THREAD,
    )  # fmt: skip
    try:
        assert process.stdout.readline() == "set-up       air, blast in 1-D\n"
        assert "s, front at" in process.stdout.readline()
        process.send_signal(number)
        out, words = process.communicate(timeout=60)
    finally:
        process.kill()
    return process.returncode, out, words


@pytest.fixture(scope="module")
def whole_blast(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole")
    (folder / "slab.nml").write_text(BLAST)
    run("run", "slab.nml", cwd=folder, env=ONE_THREAD)
    return tables(folder / "out" / "slab")


@pytest.mark.parametrize(
    "number", [n if n in (signal.SIGTERM, signal.SIGUSR2) else slow(n) for n in STOPS]
)
def test_a_stop_during_the_set_up(number, scene, whole_blast):
    """A checkpoint of the first step, and a restart continues it."""
    code, _, words = ask_while_set_up(scene, number)
    assert code == 75, words
    assert number.name in words
    assert [path.name for path in (scene / "out" / "slab").glob("chk*")] == ["chk_000001.h5"]
    run("run", "slab.nml", "--restart", "latest", cwd=scene, env=ONE_THREAD)
    assert tables(scene / "out" / "slab") == whole_blast


def test_a_checkpoint_during_the_set_up(scene, whole_blast):
    code, _, words = ask_while_set_up(scene, signal.SIGUSR1)
    assert code == 0, words
    assert len(list((scene / "out" / "slab").glob("chk*"))) == 2  # of the request and of the end
    assert tables(scene / "out" / "slab") == whole_blast


def test_what_is_ignored_stays_ignored(scene):
    """As under nohup."""
    code, _, words = ask_while_set_up(scene, signal.SIGHUP, signal.SIG_IGN)
    assert code == 0, words


def test_a_stop_along_the_radius(scene):
    radial = BLAST.replace("symmetry='x','y','z'", "").replace("t_end=4e-3", "t_end=1")
    radial = radial.replace("box=0,3, 0,3, 0,3, cells=15,15,15", "geometry='spherical'")
    (scene / "slab.nml").write_text(radial)
    process = subprocess.Popen(
        [BRISANCE, "run", "slab.nml"], cwd=scene, stderr=subprocess.PIPE, text=True
    )
    try:
        wait_for(lambda: list((scene / "out" / "slab").glob("gauges.csv")))
        process.send_signal(signal.SIGUSR1)
        process.send_signal(signal.SIGTERM)
        _, words = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == 75, words
    assert "--replace" in words
    assert len((scene / "out" / "slab" / "gauges.csv").read_text().splitlines()) > 1


@pytest.mark.parametrize(
    "args",
    [["run", "slab.nml"], ["run", "slab.nml", "--check"], ["--help"], ["--version"],
     ["--describe"], ["--describe", "--markdown"], ["mat", PATH], ["mat", PATH, "--check"]],
)  # fmt: skip
def test_a_full_standard_output_is_an_error_at_the_end(args, scene):
    with open("/dev/full", "w") as full:
        done = subprocess.run([BRISANCE, *args], cwd=scene, stdout=full, stderr=subprocess.PIPE,
                              text=True, timeout=60)  # fmt: skip
    assert done.returncode == 4
    assert "standard output: No space left on device" in done.stderr
    if len(args) == 2 and args[0] == "run":
        energy = (scene / "out" / "slab" / "energy.csv").read_text().splitlines()
        assert float(energy[-1].split(",")[0]) == pytest.approx(4e-5)


def test_closed_standard_units_are_no_files(scene):
    """What is printed must not get into the first file that is opened."""
    shell = f"exec {BRISANCE} run slab.nml --set output.report_every=0 <&- >&- 2>&-"
    done = subprocess.run(["sh", "-c", shell], cwd=scene, timeout=60)
    assert done.returncode == 0
    lock = (scene / "out" / "slab" / ".brisance.lock").read_text()
    assert re.fullmatch(r"process \d+ on \S+", lock)


def test_a_run_outlives_its_reader(scene):
    """What is piped to `head` goes on to its end; the code tells that lines are lost."""
    process = subprocess.Popen(
        [BRISANCE, "run", "slab.nml", "--set", "output.report_every=0"],
        cwd=scene, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    process.stdout.readline()
    process.stdout.close()
    words = process.stderr.read()
    assert process.wait(timeout=60) == 4
    assert "Broken pipe" in words
    energy = (scene / "out" / "slab" / "energy.csv").read_text().splitlines()
    assert float(energy[-1].split(",")[0]) == pytest.approx(4e-5)


def test_a_run_whose_terminal_closes_ends_with_a_checkpoint(scene):
    """SIGHUP, and no terminal to write to."""
    child, terminal = pty.fork()
    if child == 0:
        os.chdir(scene)
        os.execv(sys.executable, [*with_signals(signal.SIG_DFL), *ENDLESS])
    wait_for(lambda: list((scene / "out" / "slab").glob("*_00001.vtkhdf")))
    os.close(terminal)
    _, code = os.waitpid(child, 0)
    assert os.waitstatus_to_exitcode(code) == 75
