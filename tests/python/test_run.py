# SPDX-License-Identifier: MIT
"""The program from outside: exit codes, restart, requests to stop, and what it leaves behind."""

import json
import os
import shutil
import signal
import subprocess
import time
from pathlib import Path

import h5py
import numpy as np
import pytest
from tiers import slow

ROOT = Path(__file__).parents[2]
BRISANCE = ROOT / "bin" / "brisance"

# A shock runs into an elastic slab that is held at one end: everything of the step takes part.
DECK = """\
&run title='shock on a slab', t_end=4e-5, dimension=2 /
&air box=0,0.04, 0,0.02, 0,0.001, cells=40,20,1, bc='wall' /
&gas id='driver', box=0,0.01, 0,0.02, 0,0.001, density=10, pressure=3e6 /
&material id='soft', model='linear_elastic', density=1000,
          youngs_modulus=5e8, poisson_ratio=0.3 /
&body id='slab', box=0.02,0.026, 0,0.012, 0,0.001, spacing=1e-3, material='soft', fix='y-',
      fix_layers=2 /
&gauge id='front', at=0.0185,0.006,0.0005, quantity='pressure' /
&gauge id='top', at=0.0205,0.0115,0.0005, quantity='displacement_x', body='slab' /
&output dump_every=1e-5, checkpoint_every=1e-5, history_every=0 /
"""


def run(*args, cwd, code=0, **kwargs):
    """Run the program; its exit code must be `code`."""
    done = subprocess.run(
        [BRISANCE, *map(str, args)], cwd=cwd, capture_output=True, text=True, timeout=300, **kwargs
    )
    assert done.returncode == code, f"exit code {done.returncode}\n{done.stdout}\n{done.stderr}"
    assert "Fortran runtime error" not in done.stderr
    return done


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    """A folder with the deck `slab.nml` and the results of a whole run in `out/slab`."""
    folder = tmp_path_factory.mktemp("run")
    (folder / "slab.nml").write_text(DECK)
    run("run", "slab.nml", cwd=folder)
    return folder


def tables(folder):
    return {p.name: p.read_bytes() for p in sorted(Path(folder).glob("*.csv"))}


def history(file):
    """The columns of a history by name."""
    return np.genfromtxt(file, delimiter=",", names=True, deletechars="", replace_space=" ")


def arrays(file):
    """All arrays of an HDF5 file, by path."""
    found = {}
    with h5py.File(file) as h5:
        h5.visititems(
            lambda name, node: found.update({name: node[()]}) if hasattr(node, "shape") else None
        )
    return found


def assert_same_results(a, b):
    assert tables(a) == tables(b)
    last = sorted(p.name for p in Path(a).glob("*.vtkhdf"))
    assert last == sorted(p.name for p in Path(b).glob("*.vtkhdf"))
    for name in last:
        first, second = arrays(Path(a) / name), arrays(Path(b) / name)
        assert first.keys() == second.keys()
        for path, values in first.items():
            assert np.array_equal(values, second[path]), f"{name}: {path} differs"


def test_run_leaves_its_results(scene):
    out = scene / "out" / "slab"
    names = {p.name for p in out.iterdir()}
    assert {"slab.echo.nml", "energy.csv", "gauges.csv", "bodies.csv"} <= names
    assert {"air.vtkhdf.series", "solid.vtkhdf.series"} <= names
    energy = history(out / "energy.csv")
    assert energy["time[s]"][-1] == pytest.approx(4e-5, rel=1e-12)
    assert np.abs(energy["mass_error[-]"]).max() < 1e-12
    assert np.abs(energy["momentum_error[-]"]).max() < 1e-12
    assert np.abs(energy["error[-]"]).max() < 2e-3
    top = history(out / "gauges.csv")
    moved = next(n for n in top.dtype.names if n.startswith("top"))
    assert top[moved][-1] > 1e-7, "the shock does not move the slab"


def test_errors_follow_from_the_columns(scene):
    """Each error of energy.csv is what its other columns say."""
    energy = history(scene / "out" / "slab" / "energy.csv")
    mass = energy["air_mass[kg]"] + energy["air_outflow[kg]"]
    assert np.allclose(energy["mass_error[-]"], mass / mass[0] - 1, rtol=0, atol=1e-15)
    lost = np.zeros(len(energy))
    for axis in "xyz":
        parts = ("air_momentum", "air_outflow", "impulse", "ambient")
        momentum = sum(energy[f"{part}_{axis}[N s]"] for part in parts)
        lost = np.maximum(lost, np.abs(momentum - momentum[0]))
        assert np.abs(energy[f"air_momentum_{axis}[N s]"]).max() > 0 or axis == "z"
    scale = energy["momentum_scale[N s]"]
    assert np.allclose(energy["momentum_error[-]"], lost / scale, rtol=1e-6, atol=1e-20)
    gas = energy["air_mass[kg]"] + energy["air_outflow[kg]"]
    assert np.allclose(scale, gas * np.sqrt(1.4 * 101325 / 1.225), rtol=1e-12)

    held = ["air_kinetic", "air_internal", "air_outflow", "solid_kinetic"]
    held += ["solid_internal", "hourglass", "artificial", "contact"]
    total = sum(energy[f"{name}[J]"] for name in held)
    total += energy["reference_work[J]"] - energy["drive_work[J]"]
    assert np.allclose(energy["total[J]"], total, rtol=1e-14)
    terms = [np.abs(energy[f"{name}[J]"]) for name in held]
    terms += [np.abs(energy[f"{name}[J]"]) for name in ("air_work", "load_work", "drive_work")]
    largest = np.maximum.accumulate(np.max(terms, axis=0))
    assert np.allclose(energy["energy_scale[J]"], largest, rtol=1e-14)
    error = (energy["total[J]"] - energy["total[J]"][0]) / largest
    assert np.allclose(energy["error[-]"], error, rtol=0, atol=1e-16)
    lost = energy["air_work[J]"] - energy["reference_work[J]"] - energy["load_work[J]"]
    assert np.allclose(energy["coupling[J]"], lost, rtol=0, atol=1e-12 * largest[-1])
    mass = energy["air_mass[kg]"]
    beyond = energy["air_kinetic[J]"] + energy["air_internal[J]"] - mass * 101325 / 0.4 / 1.225
    parts = [np.abs(energy["load_work[J]"]), energy["air_kinetic[J]"], beyond]
    scale = np.maximum.accumulate(np.max(parts, axis=0))
    assert np.allclose(energy["coupling_scale[J]"], scale, rtol=1e-6, atol=1e-9 * largest[-1])
    assert np.allclose(
        energy["coupling_error[-]"], energy["coupling[J]"] / energy["coupling_scale[J]"]
    )
    assert 0 < np.abs(energy["coupling_error[-]"]).max() < 0.01  # in the first rows, too
    assert energy["load_work[J]"][-1] > 0


ON_FLOOR = """\
&run t_end=1e-3, symmetry='x', backend='cpu' /
&air box=0,2,-2,2,0,2, cells=16,32,16,
     bc='symmetry','outflow','outflow','outflow','wall','outflow' /
&material id='m', model='linear_elastic', density=2000, youngs_modulus=2e10, poisson_ratio=0.2 /
&body id='block', box=0,0.5, -0.5,0.5, 0,1, spacing=0.0625, material='m',
    formulation='rigid', fix='all' /
&output history_every=5e-4 /
"""


def test_still_air_gives_no_impulse_to_what_stands_on_a_floor_or_is_cut(tmp_path):
    """A block of 1 m on a floor and half of it beyond a plane of symmetry: its open faces feel the
    pressure of the atmosphere, which the impulse leaves out and which stands beside it.

    Of the face of a cell at an edge of the block its wall covers part: three edges of two faces of
    64 and 32 cells, a third of one each at most."""
    (tmp_path / "block.nml").write_text(ON_FLOOR)
    run("run", "block.nml", cwd=tmp_path)
    energy = history(tmp_path / "out" / "block" / "energy.csv")
    atmosphere = 101325 * 0.5 * 1e-3  # [N s] on half of the roof, and as much on the side
    for axis, ambient, edges in (("x", -2, 0.01), ("y", 0, 1e-9), ("z", -1, 0.01)):
        assert abs(energy[f"impulse_{axis}[N s]"]).max() < 1e-9 * atmosphere
        felt = energy[f"ambient_{axis}[N s]"] / atmosphere
        assert felt[-1] == pytest.approx(ambient, rel=edges, abs=1e-9)
        # of the same walls at any time
        assert np.allclose(felt, felt[-1] * energy["time[s]"] / energy["time[s]"][-1], atol=1e-9)
    assert energy["momentum_error[-]"].max() < 1e-12
    assert not energy["coupling_error[-]"].any()


HELD_BAR = """\
&run t_end=2e-5, dimension=1, energy_band=0.1 /
&material id='m', model='linear_elastic', density=2000, youngs_modulus=2e10, poisson_ratio=0 /
&body id='bar', box=0,0.1, 0,1, 0,1, spacing=1e-3, material='m', fix='x-'{motion} /
&output history_every=0 /
"""


def test_a_scene_at_rest_has_no_energy_error(tmp_path):
    """Rounding is all the energy that there is."""
    (tmp_path / "rest.nml").write_text(HELD_BAR.format(motion=""))
    run("run", "rest.nml", cwd=tmp_path)
    energy = history(tmp_path / "out" / "rest" / "energy.csv")
    assert len(energy) > 20
    assert energy["energy_scale[J]"][-1] > 0
    assert np.all(energy["error[-]"] == 0)


def test_a_scene_that_starts_from_rest_is_not_judged_too_early(tmp_path):
    """The first steps book the drive and the motion by halves: only what came before is judged."""
    motion = ", motion_time=0,1e-5, motion_velocity=0,0,0, 5,0,0"
    (tmp_path / "bar.nml").write_text(HELD_BAR.format(motion=motion))
    run("run", "bar.nml", cwd=tmp_path)
    energy = history(tmp_path / "out" / "bar" / "energy.csv")
    error = np.abs(energy["error[-]"])
    assert error[1] == 0
    assert 0 < error.max() < 0.05
    assert error[-1] < 1e-3


def test_restart_continues_bit_for_bit(scene, tmp_path):
    """N steps = k steps + restart + N-k steps, histories and dumps included."""
    whole = scene / "out" / "slab"
    shutil.copy(scene / "slab.nml", tmp_path)
    run("run", "slab.nml", "--set", "run.max_steps=60", cwd=tmp_path)
    run("run", "slab.nml", "--restart", "latest", cwd=tmp_path)
    assert_same_results(whole, tmp_path / "out" / "slab")


def test_checkpoints_do_not_change_results(scene, tmp_path):
    shutil.copy(scene / "slab.nml", tmp_path)
    run("run", "slab.nml", "--set", "output.checkpoint_every=1", cwd=tmp_path)
    assert_same_results(scene / "out" / "slab", tmp_path / "out" / "slab")


def test_results_do_not_depend_on_threads(scene, tmp_path):
    shutil.copy(scene / "slab.nml", tmp_path)
    run("run", "slab.nml", cwd=tmp_path, env={**os.environ, "OMP_NUM_THREADS": "3"})
    assert_same_results(scene / "out" / "slab", tmp_path / "out" / "slab")


def test_dumps_at_listed_times(scene, tmp_path):
    """Each time gives one dump, at the first step that reaches it, also after a restart."""
    shutil.copy(scene / "slab.nml", tmp_path)
    end = 4e-5
    times = [0.21 * end, 0.5 * end, 0.9 * end]
    listed = ",".join(f"{t:.6e}" for t in times)
    options = ["--set", f"output.dump_times={listed}", "--set", f"output.dump_every={end / 4}",
               "--set", f"output.dump_from={0.7 * end}"]  # fmt: skip
    run("run", "slab.nml", *options, cwd=tmp_path)
    series = json.loads((tmp_path / "out/slab/solid.vtkhdf.series").read_text())["files"]
    found = [entry["time"] for entry in series]
    wanted = [0.0, *times[:2], 0.75 * end, times[2], end]
    step = end / 20
    assert len(found) == len(wanted)
    assert all(w <= f <= w + step for f, w in zip(found, wanted, strict=True))
    half = ["--out", "half", *options]
    run("run", "slab.nml", *half, "--set", "run.max_steps=20", cwd=tmp_path)
    run("run", "slab.nml", *half, "--restart", "latest", cwd=tmp_path)
    again = json.loads((tmp_path / "half/solid.vtkhdf.series").read_text())["files"]
    assert [e["time"] for e in again if e["time"] in found] == found


def test_results_are_not_overwritten(scene):
    before = tables(scene / "out" / "slab")
    done = run("run", "slab.nml", cwd=scene, code=4)
    assert "--replace" in done.stderr
    assert tables(scene / "out" / "slab") == before


def test_restart_refuses_another_deck(scene):
    done = run("run", "slab.nml", "--restart", "latest", "--set", "body(slab).spacing=2e-3",
               "--out", "out/slab", cwd=scene, code=4)  # fmt: skip
    assert "belongs to another deck" in done.stderr


@pytest.mark.parametrize(
    ("number", "code"), [(signal.SIGUSR2, 75), slow(signal.SIGTERM, 75), (signal.SIGUSR1, 0)]
)
def test_signals(scene, tmp_path, number, code):
    """USR2 and TERM stop with a checkpoint that a restart continues; USR1 goes on."""
    shutil.copy(scene / "slab.nml", tmp_path)
    longer = ["--set", "output.checkpoint_every=1", "--set", "run.t_end=4e-4"]
    run("run", "slab.nml", "--out", "whole", *longer, cwd=tmp_path)
    process = subprocess.Popen([BRISANCE, "run", "slab.nml", *longer], cwd=tmp_path)
    try:
        history = tmp_path / "out" / "slab" / "energy.csv"
        wait_for(history.exists)
        time.sleep(0.05)
        process.send_signal(number)
        assert process.wait(timeout=60) == code
    finally:
        process.kill()
    assert list((tmp_path / "out" / "slab").glob("chk_*.h5"))
    if code == 75:
        run(
            "run",
            "slab.nml",
            "--restart",
            "latest",
            *longer,
            cwd=tmp_path,
        )
    assert tables(tmp_path / "whole") == tables(tmp_path / "out" / "slab")


def wait_for(condition, seconds=20):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.005)


def test_stop_file(scene, tmp_path):
    shutil.copy(scene / "slab.nml", tmp_path)
    (tmp_path / "slab.stop").touch()
    run("run", "slab.nml", cwd=tmp_path, code=75)
    assert not (tmp_path / "slab.stop").exists()
    run("run", "slab.nml", "--restart", "latest", cwd=tmp_path)
    assert_same_results(scene / "out" / "slab", tmp_path / "out" / "slab")


def test_walltime(scene, tmp_path):
    shutil.copy(scene / "slab.nml", tmp_path)
    run("run", "slab.nml", "--walltime", "0", cwd=tmp_path, code=75)
    assert list((tmp_path / "out" / "slab").glob("chk_*.h5"))


def test_small_time_step_is_a_numerical_error(scene, tmp_path):
    shutil.copy(scene / "slab.nml", tmp_path)
    done = run("run", "slab.nml", "--set", "run.dt_min=1e-3", cwd=tmp_path, code=3)
    assert "dt_min" in done.stderr


def test_energy_out_of_its_band_is_a_numerical_error(scene, tmp_path):
    shutil.copy(scene / "slab.nml", tmp_path)
    done = run("run", "slab.nml", "--set", "run.energy_band=1e-9", cwd=tmp_path, code=3)
    assert "energy" in done.stderr
    error = history(tmp_path / "out" / "slab" / "energy.csv")["error[-]"]
    assert abs(error[-1]) > 1e-9, "the rows up to the failure are missing"


def test_echo_runs_the_same(scene, tmp_path):
    """The echo is a complete deck: it gives the same results, and its own echo."""
    shutil.copy(scene / "out" / "slab" / "slab.echo.nml", tmp_path / "slab.nml")
    run("run", "slab.nml", cwd=tmp_path)
    assert_same_results(scene / "out" / "slab", tmp_path / "out" / "slab")
    echo = tmp_path / "out" / "slab" / "slab.echo.nml"
    assert echo.read_text() == (tmp_path / "slab.nml").read_text()


def test_full_disk_keeps_the_last_checkpoint(scene, tmp_path):
    """A file size limit stands in for a full disk: code 4, and the run can be continued."""
    shutil.copy(scene / "slab.nml", tmp_path)
    run("run", "slab.nml", "--set", "run.max_steps=60", cwd=tmp_path)
    script = f"ulimit -f 8; exec {BRISANCE} run slab.nml --restart latest"
    done = subprocess.run(["bash", "-c", script], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 4, done.stderr
    run("run", "slab.nml", "--restart", "latest", cwd=tmp_path)
    assert_same_results(scene / "out" / "slab", tmp_path / "out" / "slab")


def test_check_runs_nothing(scene, tmp_path):
    shutil.copy(scene / "slab.nml", tmp_path)
    done = run("run", "slab.nml", "--check", cwd=tmp_path)
    assert "particles" in done.stdout and "cells" in done.stdout
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("args", "code", "word"),
    [
        (["--version"], 0, "GNU Fortran"),
        (["--help"], 0, "usage"),
        (["run", "--help"], 0, "usage"),
        (["mat", "deck.nml", "-h"], 0, "usage"),
        ([], 0, "usage"),
        (["--describe", "air"], 0, "cells"),
        (["--describe", "airs"], 2, "air"),
        (["fly"], 2, "unknown command"),
        (["run"], 2, "no deck"),
        (["run", "absent.nml"], 2, "absent.nml"),
        (["run", "slab.nml", "--chek"], 2, "--check"),
        (["run", "slab.nml", "--walltime", "soon"], 2, "HH:MM:SS"),
        (["run", "slab.nml", "--out"], 2, "needs a value"),
        (["run", "slab.nml", "--backend", "abacus"], 2, "cpu"),
        (["run", "slab.nml", "--set", "air.densty=1"], 2, "density"),
        (["run", "slab.nml", "--backend", "gpu"], 5, "GPU"),
        (["run", "slab.nml", "--restart", "absent.h5", "--out", "new"], 4, "absent.h5"),
    ],
)
def test_command_line(scene, args, code, word):
    done = run(*args, cwd=scene, code=code)
    assert word in done.stdout + done.stderr
