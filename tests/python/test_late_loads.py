# SPDX-License-Identifier: MIT
"""Loads that arrive late: bodies sleep until then; a load that never arrives is told of."""

import os
import shutil
import subprocess

import numpy as np
import pytest
from test_loads import BRISANCE, STEEL, run

LATE = (
    STEEL
    + """\
&run t_end={t_end}, backend='cpu' /
&body id='b', box=-0.02,0.02, -0.02,0.02, -0.01,0, spacing=5e-3, material='s'{form} /
&load id='p', body='b', faces='z+', mass=100, at=0,0,30{start} /
&output dump_every=0.02, history_every=0.01 /
"""
)
ARRIVAL = 0.0601  # [s] of 100 kg at 30 m, about


def late(t_end=0.0604, start="", form=""):
    return LATE.format(t_end=t_end, start=start, form=form)


@pytest.mark.parametrize("form", ["", ", formulation='total_lagrangian'", ", formulation='rigid'"])
def test_bodies_sleep_until_the_load_arrives(tmp_path, form):
    """They then move as they do where the charge detonates before the run, and outputs stand at
    their times."""
    tables = run(tmp_path, late(form=form))["bodies"]
    assert tables["time[s]"] == pytest.approx([*np.arange(7) * 0.01, 0.0604], rel=1e-12)
    assert not tables["b:velocity_z[m/s]"][:7].any()
    steps = [int(f.stem.split("_")[1]) for f in (tmp_path / "out/load").glob("chk_*.h5")]
    assert max(steps) < 2000  # 160,000 without sleep
    end = tables["b:velocity_z[m/s]"][-1]
    soon = run(tmp_path, late(t_end=0.0004, start=", detonation_time=-0.06", form=form))["bodies"]
    assert end == pytest.approx(soon["b:velocity_z[m/s]"][-1], rel=1e-6)
    assert abs(end) > 1e-3


def test_a_wait_goes_on_after_a_restart(tmp_path):
    """From a checkpoint of the wait, to the bits of the whole run."""
    deck = late().replace("dump_every", "checkpoint_every=0.025, dump_every")
    whole = run(tmp_path, deck)["bodies"]
    first = min((tmp_path / "out/load").glob("chk_*.h5"), key=os.path.getmtime)
    shutil.copy(first, tmp_path / "wait.h5")
    again = run(tmp_path, deck, "--restart", "wait.h5")["bodies"]
    assert again["time[s]"][-1] == whole["time[s]"][-1]
    for name in ("velocity_z[m/s]", "internal[J]", "load_work[J]"):
        assert again[f"b:{name}"][-1] == whole[f"b:{name}"][-1] != 0


def check(folder, deck):
    (folder / "late.nml").write_text(deck)
    return subprocess.run([BRISANCE, "run", "late.nml", "--check"], cwd=folder,
                          capture_output=True, text=True)  # fmt: skip


def test_a_load_after_the_end_is_warned_of(tmp_path):
    for deck, remedy in (
        (late(t_end=0.05), "detonation_time"),
        (late().replace("mass=100, at=0,0,30", "time=0.1,0.2,0.3, pressure=0,1e5,0"), "t_end"),
    ):
        done = check(tmp_path, deck)
        assert "after the end of the run" in done.stderr and remedy in done.stderr
        assert "warning(s)" in done.stdout and "sound" not in done.stdout.split("verdict")[1]
    soon = late(t_end=0.001, start=", detonation_time=-0.06").replace("0.02, h", "5e-4, h")
    for deck in (late(), soon.replace("every=0.01", "every=1e-4")):
        done = check(tmp_path, deck)
        assert not done.stderr and "the deck is sound" in done.stdout


def test_what_moves_or_is_pushed_does_not_wait(tmp_path):
    """A body with a velocity, and one that falls, before a load arrives."""
    fall = "&load id='g', body='b', acceleration=0,0,-9.81 /\n"
    fast = late(t_end=2e-5).replace("material='s'", "material='s', velocity=0,0,1")
    for deck, speed in ((fast, 1.0), (late(t_end=2e-5) + fall, -9.81 * 2e-5)):
        bodies = run(tmp_path, deck)["bodies"]
        assert bodies["b:velocity_z[m/s]"][-1] == pytest.approx(speed, rel=1e-6)
