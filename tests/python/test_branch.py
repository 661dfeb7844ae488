# SPDX-License-Identifier: MIT
"""A run that branches off the checkpoint of another one: the same as if its deck had been run from
the start, to the bit; what differs before the checkpoint is refused.
"""

import csv
import subprocess
import sys
from pathlib import Path

import pytest
from test_gpu import EMULATOR, stamp
from test_gpu import run as on_gpu
from test_loads import BRISANCE, STEEL
from test_ranks import needs_mpirun, start
from test_restart import ALONE, state

sys.path.insert(0, str(Path(__file__).parents[2]))

from post.__main__ import main

LOAD = f"""\
&run t_end=2e-5, energy_band=0.5 /
{STEEL}
&body id='b', box=0,0.02, 0,0.006, 0,0.004, spacing=1e-3, material='s', fix='x-' /
&load id='p', body='b', faces='x+', time=0,4e-6,8e-6,1.1e-5,1.5e-5,2e-5,
      pressure=0,1e8,5e7,5e7,5e7,0 /
&load id='g', body='b', acceleration=0,0,-10, time=0,1.1e-5,2e-5, scale=1,1,1 /
&gauge id='m', body='b', at=0.02,0.003,0.002, quantity='displacement_x' /
&gauge id='i', body='b', quantity='impulse_x' /
&output history_every=0, checkpoint_every=1e-5, dump_every=1e-5 /
"""
MOTION = f"""\
&run t_end=2e-5, energy_band=0.5 /
{STEEL}
&body id='b', box=0,0.02, 0,0.006, 0,0.004, spacing=1e-3, material='s' /
&motion id='m', body='b', box=0,1e-3, 0,0.006, 0,0.004, time=0,1.1e-5,2e-5,
        velocity=1,0,0, 2,0,0, 2,0,0 /
&gauge id='m', body='b', at=0.02,0.003,0.002, quantity='displacement_x' /
&output history_every=0, checkpoint_every=1e-5, dump_every=1e-5 /
"""
INFLOW = """\
&run t_end=2e-3, dimension=1 /
&air box=0,1, 0,1, 0,1, cells=60,1,1 /
&inflow id='w', face='x-', time=0,1.1e-3,2e-3, overpressure=3e5,2e5,0 /
&gauge id='a', at=0.2,0.5,0.5, quantity='pressure' /
&gauge id='b', at=0.2,0.5,0.5, quantity='density', width=0.1 /
&output history_every=0, checkpoint_every=1e-3, dump_every=1e-3 /
"""
LATER = {
    "load": (LOAD, "load(p).pressure=0,1e8,5e7,5e7,9e7,0"),
    "gravity": (LOAD, "load(g).scale=1,1,1e6"),
    "motion": (MOTION, "motion(m).velocity=1,0,0, 2,0,0, 0,0,3"),
    "inflow": (INFLOW, "inflow(w).overpressure=3e5,2e5,4e5"),
    "nothing": (LOAD, "run.title='the same'"),
}


def run(folder, *args):
    """Exit code and words of a run of deck.nml."""
    command = [BRISANCE, "run", "deck.nml", *args]
    done = subprocess.run(command, cwd=folder, env=ALONE, capture_output=True, text=True)
    return done.returncode, done.stderr


def begin(folder, deck=LOAD):
    """The run that is left, with its first checkpoint."""
    (folder / "deck.nml").write_text(deck)
    code, words = run(folder, "--out", "first")
    assert code == 0, words
    return str(sorted((folder / "first").glob("chk_*.h5"))[0].relative_to(folder))


def times(folder, name):
    """Rows of a history as lines, the first number of each as time."""
    rows = (folder / name).read_text().splitlines()[1:]
    return {float(row.split(",")[0]): row for row in rows}


@pytest.mark.parametrize("what", LATER)
def test_a_branch_is_the_run_of_its_deck(tmp_path, what):
    deck, change = LATER[what]
    left = begin(tmp_path, deck)
    for args in (("--out", "branch", "--branch", left), ("--out", "whole")):
        code, words = run(tmp_path, "--set", change, *args)
        assert code == 0, words
    whole, branch = (state(tmp_path / name, 0) for name in ("whole", "branch"))
    last = {k: v for k, v in branch.items() if k.startswith(("chk", "gauges", "bodies", "energy"))}
    assert "gauges.csv" in last and any(k.startswith("chk") for k in last)
    for name, value in last.items():
        if not any(word in name for word in ("deck", "title", "clock/dump")):
            assert value == whole[name], name
    first, now = (times(tmp_path / name, "gauges.csv") for name in ("first", "branch"))
    late = 1.1e-3 if what == "inflow" else 1.1e-5
    early = [t for t in first if t < late]
    assert len(early) > 20 and all(first[t] == now[t] for t in early)
    changed = [t for t in first if t >= late and first[t] != now.get(t)]
    assert (len(changed) > 5) == (what != "nothing")


@pytest.mark.parametrize(("change", "words"), [
    ("load(p).pressure=0,1e8,5e7,6e7,5e7,0", "&load id='p': pressure at t = "),
    ("load(p).pressure=0,2e8,5e7,5e7,5e7,0", "is 2.5e7 in the deck of the checkpoint and 5e7"),
    ("load(p).time=1e-6,4e-6,8e-6,1.1e-5,1.5e-5,2e-5", "&load id='p': pressure at t = "),
    ("load(g).scale=1,2,1", "&load id='g': scale at t = "),
    ("body(b).spacing=5e-4", 'there "&body spacing = 0.001", here "&body spacing = 5e-4"'),
    ("load(p).faces='y+'", "a branch may change histories of &load"),
    ("gauge(i).quantity='impulse_y'", "impulse_x"),
])  # fmt: skip
def test_what_differs_before_is_refused(tmp_path, change, words):
    left = begin(tmp_path)
    code, told = run(tmp_path, "--out", "branch", "--branch", left, "--set", change)
    assert code == 2 and words in told, told
    assert not list((tmp_path / "branch").glob("*.csv"))


def test_a_branch_needs_a_folder_of_its_own(tmp_path):
    left = begin(tmp_path)
    kept = (tmp_path / "first/gauges.csv").read_bytes()
    for args, code, words in [
        (("--out", "first"), 4, "holds results of another run"),
        (("--out", "b", "--replace"), 2, "--branch replaces no results"),
        (("--out", "b", "--restart", "latest"), 2, "give one of them"),
        (("--out", "b", "--branch", "latest"), 2, "name the file of the checkpoint"),
    ]:
        got, told = run(tmp_path, "--branch", left, *args)
        assert got == code and words in told, told
    assert (tmp_path / "first/gauges.csv").read_bytes() == kept


def test_a_branch_may_have_other_gauges(tmp_path):
    """A gauge more: its history begins at the checkpoint, the others are the whole ones."""
    left = begin(tmp_path)
    deck = LOAD + "&gauge id='n', body='b', at=0.01,0.003,0.002, quantity='speed' /\n"
    (tmp_path / "deck.nml").write_text(deck)
    code, words = run(tmp_path, "--out", "branch", "--branch", left)
    assert code == 0 and "gauges.csv: begins at the checkpoint" in words, words
    first, now = (times(tmp_path / name, "gauges.csv") for name in ("first", "branch"))
    assert 1e-5 < min(now) < 1.03e-5 and max(now) == max(first)
    assert all(now[t].split(",")[:3] == first[t].split(",") for t in now)
    for name in ("bodies.csv", "energy.csv"):
        assert times(tmp_path / "branch", name) == times(tmp_path / "first", name)


def test_a_branch_goes_on_where_it_was_stopped(tmp_path):
    left = begin(tmp_path)
    change = ("--set", LATER["load"][1])
    assert run(tmp_path, *change, "--out", "whole")[0] == 0
    steps = int(left[-9:-3]) + 40
    stop = ("--out", "branch", "--branch", left, "--set", f"run.max_steps={steps}")
    assert run(tmp_path, *change, *stop)[0] == 0
    code, words = run(tmp_path, *change, "--out", "branch", "--restart", "latest")
    assert code == 0, words
    rows = times(tmp_path / "branch", "gauges.csv")
    assert rows == times(tmp_path / "whole", "gauges.csv")


LATE_STUDY = """\
[study]
deck = "deck.nml"
{late}
results = ["m:displacement_x end"]
surrogate = false
[parameter.p]
values = [10, 90]
unit = "MPa"
set = {{"load(p).pressure" = "0,1e8,5e7,5e7,x,0"}}
"""


def test_a_study_of_what_acts_late(tmp_path):
    """One beginning and two branches: the same as whole runs but for the step that is cut, with
    histories from the start."""
    (tmp_path / "deck.nml").write_text(LOAD)
    ends = {}
    for name, late in (("late", 'late = "load(p).pressure"\nstart = 1e-5'), ("whole", "")):
        (tmp_path / f"{name}.toml").write_text(LATE_STUDY.format(late=late))
        out = tmp_path / name
        assert main(["study", str(tmp_path / f"{name}.toml"), "--out", str(out)]) == 0
        rows = list(csv.DictReader((out / "study.csv").open()))
        ends[name] = [float(row["m:displacement_x end[m]"]) for row in rows]
        assert len(list((out / "runs").glob("*/result.json"))) == (3 if late else 2)
        for row in rows:
            assert min(times(out / "runs" / row["key"] / "out", "gauges.csv")) == 0
    assert ends["late"] == pytest.approx(ends["whole"], rel=1e-3)
    assert abs(ends["whole"][1] / ends["whole"][0]) > 2


@needs_mpirun
def test_a_branch_on_several_processes(tmp_path):
    left = begin(tmp_path)
    change = ("--set", LATER["load"][1])
    assert run(tmp_path, *change, "--out", "whole")[0] == 0
    done = start(2, "run", "deck.nml", *change, "--out", "branch", "--branch", left, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    rows = [times(tmp_path / name, "gauges.csv") for name in ("branch", "whole")]
    assert rows[0] == rows[1]


@pytest.mark.skipif(not EMULATOR.exists(), reason="make emulator builds it")
def test_a_branch_on_the_gpu(tmp_path):
    """To the bit as the run of its deck there, and off a checkpoint of the CPU too."""
    (tmp_path / "good.ptx").write_text(f"// {stamp()}\n")
    left = begin(tmp_path)
    change = ("--set", LATER["load"][1], "--backend", "gpu")
    for args in (("--out", "first_gpu"), (*change, "--out", "whole"),
                 (*change, "--out", "other", "--branch", left)):  # fmt: skip
        done = on_gpu(tmp_path, "deck.nml", "--backend", "gpu", *args)
        assert done.returncode == 0, done.stderr
    left = sorted((tmp_path / "first_gpu").glob("chk_*.h5"))[0]
    done = on_gpu(tmp_path, "deck.nml", *change, "--out", "branch", "--branch", str(left))
    assert done.returncode == 0, done.stderr
    branch, whole, other = (times(tmp_path / n, "gauges.csv") for n in ("branch", "whole", "other"))
    assert branch == whole
    for one, two in zip(branch.values(), other.values(), strict=True):
        a, b = ([float(x) for x in row.split(",")] for row in (one, two))
        assert a == pytest.approx(b, rel=1e-6, abs=1e-9)
