# SPDX-License-Identifier: MIT
"""The scenes of Chen et al.: each in its smallest size to its end, and what holds in each."""

import csv
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from tiers import slow

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "studies"))
import paper  # noqa: E402

BRISANCE = Path(os.environ.get("BRISANCE", ROOT / "bin" / "brisance"))
TINY = paper.cases("tiny")


def run(case, folder, *more, code=0):
    """Run a case; what it printed."""
    command = [BRISANCE, "run", *case.arguments(), "--out", folder, *more]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600)
    assert done.returncode == code, done.stdout[-2000:] + done.stderr[-2000:]
    return done.stdout + done.stderr


def history(file):
    with file.open(encoding="utf-8") as rows:
        names = next(csv.reader(rows))
        values = np.loadtxt(rows, delimiter=",", ndmin=2)
    return dict(zip(names, values.T, strict=True))


TIERS = [case if case.name == "slab_1" else slow(case) for case in TINY]


@pytest.mark.long("scenes of the paper, coarse")
@pytest.mark.parametrize("case", TIERS, ids=lambda case: case.name)
def test_scene_runs_to_its_end(case, tmp_path):
    """Diagnostics closed, gas sound, and the bodies have felt the load."""
    run(case, tmp_path / "out", "--backend", "cpu")
    energy = history(tmp_path / "out" / "energy.csv")
    assert np.all(np.isfinite(list(energy.values())))
    assert abs(energy["error[-]"][-1]) < 5e-3
    assert abs(energy["mass_error[-]"]).max() < 1e-11
    assert abs(energy["momentum_error[-]"]).max() < 1e-11
    assert energy["solid_internal[J]"][-1] > 0
    gauges = history(tmp_path / "out" / "gauges.csv")
    if case.name.startswith("slab"):
        # it moves away from the charge, by less than it would unsupported
        impulse = energy["impulse_z[N s]"].max() / 0.25**2
        mass = 44e-3 * 1500
        assert 0 < gauges["mid:displacement_z[m]"][-1] < impulse / mass * gauges["time[s]"][-1]
    if case.name == "fragments_460":
        # the sphere on the axis has gone into the slab and is slowed down, but goes on
        speed = gauges["f0_v:velocity_z[m/s]"]
        assert 440 < speed[1] < 480
        assert 0 < speed[-1] < 0.8 * speed[1]


def test_every_size_that_is_told_exists():
    for size in paper.SIZES:
        for case in paper.cases(size):
            assert case.deck.is_file()
    with pytest.raises(ValueError, match="no size"):
        paper.cases("coarse", ["hvi_0075"])
    with pytest.raises(KeyError):
        paper.cases("full", ["slab_5"])


def test_campaign_goes_on_where_it_stopped(tmp_path):
    """Stopped by a file, then the same command again; a third time nothing is to do."""
    command = [sys.executable, ROOT / "studies" / "paper.py", "tiny", "slab_1"]
    command += ["--out", tmp_path, "--brisance", BRISANCE, "--backend", "cpu"]
    folder = tmp_path / "tiny"
    (case,) = paper.cases("tiny", ["slab_1"])
    (folder / case.name).mkdir(parents=True)
    (folder / case.name / f"{case.deck.stem}.stop").touch()
    run(case, folder / case.name, "--backend", "cpu", code=75)
    for _ in range(2):
        done = subprocess.run(command, capture_output=True, text=True, timeout=600)
        assert done.returncode == 0, done.stdout + done.stderr
        assert "done" in done.stdout
    assert (folder / "slab_1.log").read_text(encoding="utf-8").count("$ ") == 2


def test_each_gpu_takes_the_longest_case_that_waits(tmp_path, monkeypatch, capsys):
    program = tmp_path / "program"
    program.write_text(
        '#!/bin/sh\nsleep 0.2\necho "on $CUDA_VISIBLE_DEVICES"\n'
        'case "$*" in *slab_3*) exit 4;; esac\n'
    )
    program.chmod(0o755)
    monkeypatch.setenv("CUDA_VISIBLE_DEVICES", "5,7")
    command = ["paper.py", "quarter", "--out", str(tmp_path), "--brisance", str(program)]
    monkeypatch.setattr(sys, "argv", [*command, "--gpus", "2"])
    assert paper.main() == 4
    told = [line for line in capsys.readouterr().out.splitlines() if line.startswith("[")]
    order = [line.split()[1] for line in told]
    assert len(told) == 11 and set(order[:2]) == {"hvi_0075", "plate"} and order[-1] == "hvi_0600"
    logs = {name: (tmp_path / "quarter" / f"{name}.log").read_text() for name in order}
    assert all(re.search(r"^on [57]$", text, re.MULTILINE) for text in logs.values())
    assert any("slab_3" in line and "exit code 4" in line for line in told)
    monkeypatch.setattr(sys, "argv", [*command, "--gpus", "3"])
    with pytest.raises(SystemExit):
        paper.main()


def test_several_gpus_share_a_case(tmp_path, monkeypatch, capsys):
    (tmp_path / "mpirun").write_text('#!/bin/sh\necho "mpirun $* on $CUDA_VISIBLE_DEVICES"\n')
    (tmp_path / "mpirun").chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setenv("CUDA_VISIBLE_DEVICES", "0,1,2,3,4")
    command = ["paper.py", "quarter", "plate", "slab_1", "--out", str(tmp_path), "--processes"]
    monkeypatch.setattr(sys, "argv", [*command, "2"])
    assert paper.main() == 0
    logs = [(tmp_path / "quarter" / f"{name}.log").read_text() for name in ("plate", "slab_1")]
    assert all(re.search(r"^mpirun -n 2 --bind-to none \S*bin/brisance run", x, re.M) for x in logs)
    assert all(re.search(r"--backend gpu on (0,1|2,3)$", text, re.MULTILINE) for text in logs)
    monkeypatch.setattr(sys, "argv", [*command, "6"])
    with pytest.raises(SystemExit):
        paper.main()
    assert "there are 5 GPUs for 6 processes" in capsys.readouterr().err


SPHERES = """\
&run t_end=1e-6, symmetry='x' /
&material id='m', model='linear_elastic', density=1000, youngs_modulus=1e9, poisson_ratio=0.3 /
&body id='right', shape='sphere', centre=0.02,0,0, radius=0.01, spacing=2e-3, material='m',
      velocity=5,1,0, spin=0,10,20 /
&body id='left', shape='sphere', centre=-0.02,0,0, radius=0.01, spacing=2e-3, material='m',
      velocity=-5,1,0, spin=0,-10,-20 /
&gauge id='l', at=-0.02,0,0, quantity='velocity_x', body='left' /
"""


def check(deck, tmp_path, code):
    (tmp_path / "spheres.nml").write_text(deck)
    command = [BRISANCE, "run", "spheres.nml", "--check"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert done.returncode == code, done.stdout + done.stderr
    return done.stdout + done.stderr


def test_mirror_image_is_left_out(tmp_path):
    """A body beyond a plane is dropped where it is the image of another, else refused."""
    text = check(SPHERES, tmp_path, 0)
    assert "'left': is left out: the symmetry makes it from 'right'" in text
    assert "left: " not in text
    for wrong in ("velocity=-5,1,1", "velocity=5,1,0"):
        text = check(SPHERES.replace("velocity=-5,1,0", wrong), tmp_path, 2)
        assert "left" in text and "plane of symmetry" in text
    check(SPHERES.replace("spin=0,-10,-20", "spin=0,-10,20"), tmp_path, 2)
    check(SPHERES.replace("centre=-0.02,0,0", "centre=-0.021,0,0"), tmp_path, 2)


# One deck of each kind: a load, cylinders, air, interfaces, bars.
KINDS = ("slab_2_cylinder", "slab_2_glue_breaks")
DECKS = [
    (size, case.name) if size == "questions" and case.name in KINDS else slow(size, case.name)
    for size in paper.QUESTIONS
    for case in paper.cases(size)
]


@pytest.mark.parametrize(("size", "name"), DECKS)
def test_runs_of_the_questions_are_sound_decks(size, name):
    case = next(case for case in paper.cases(size) if case.name == name)
    command = [BRISANCE, "run", *case.arguments(), "--check"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    assert "verdict" in done.stdout
