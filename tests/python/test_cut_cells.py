# SPDX-License-Identifier: MIT
"""Cut cells from a deck: periodic boxes, a restart, and a shock that throws a disc."""

import subprocess

import numpy as np
import pytest
from test_restart import ALONE, run, state
from test_run import BRISANCE, ROOT, arrays, history

SCENES = ROOT / "tests/scenes"


def deck(name, *changes):
    text = (SCENES / name).read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return text


SOFT = ("      formulation = 'rigid' /", "/")


def test_a_small_period_is_refused(tmp_path):
    (tmp_path / "scene.nml").write_text(
        deck("disc.nml", ("'wall', 'wall'", "'periodic', 'periodic'"))
    )
    for cells, code in ((7, 2), (8, 0)):
        done = subprocess.run([BRISANCE, "run", "scene.nml", "--check", "--set",
                               f"air.cells=160,{cells},1"], cwd=tmp_path, env=ALONE,
                              capture_output=True, text=True)  # fmt: skip
        assert done.returncode == code, done.stderr
        assert ("needs 8 or more cells of the air" in done.stderr) == (code == 2)


# Hot gas throws and turns a square in a box that goes on from the other end. The numbers are
# places along x and y.
ROUND = """\
&run title = 'round', t_end = 1, max_steps = 400, dimension = 2, energy_band = 10 /
&air box = 0, 0.4,  0, 0.32,  0, 1, cells = 40, 32, 1, bc = 'periodic', density = 1.2,
     pressure = 101000 /
&gas id = 'hot', box = {:.3f}, {:.3f}, {:.3f}, {:.3f}, -1, 2, density = 4, pressure = 801000 /
&material id = 's', model = 'linear_elastic', density = 20, youngs_modulus = 1e6,
     poisson_ratio = 0.3 /
&body id = 'square', box = {:.3f}, {:.3f}, {:.3f}, {:.3f}, 0, 1, spacing = 2.5e-3, material = 's',
      {}velocity = 60, -40, 0, spin = 0, 0, 300 /
&coupling scheme = 'cut_cells' /
"""
PLACES = 0.03, 0.09, 0.04, 0.12, 0.132, 0.232, 0.113, 0.173


@pytest.mark.parametrize("kind", ["formulation = 'rigid', ", ""], ids=["rigid", "soft"])
def test_a_shifted_scene_in_a_periodic_box_is_the_same(kind, tmp_path):
    """By half a box: the square turns across a corner of it, with the same torque."""
    found = []
    half = np.array([0.2, 0.16, 0])
    for shift in (0 * half, half):
        there = np.reshape(PLACES, (2, 2, 2)) + shift[:2, None]
        (tmp_path / "scene.nml").write_text(ROUND.format(*there.flat, kind))
        code, words = run(tmp_path, "--out", str(len(found)))
        assert code in (0, 3), words
        energy = history(tmp_path / str(len(found)) / "energy.csv")
        for name, bound in ("mass", 1e-13), ("momentum", 1e-13):
            assert abs(energy[f"{name}_error[-]"][-1]) < bound
        found.append(arrays(sorted((tmp_path / str(len(found))).glob("chk_??????.h5"))[-1]))
    here, there = found
    gas = [state["air/u"][:, 0, 3:-3, 3:-3] for state in found]
    gas[1] = np.roll(gas[1], (-16, -20), (1, 2))
    for c in (0, 1, 2, 4):
        assert np.abs(gas[0][c] - gas[1][c]).max() < 1e-8 * np.abs(gas[0][c]).max()
    assert np.abs(there["solid/x"] - half - here["solid/x"]).max() < 1e-9
    assert np.abs(there["solid/v"] - here["solid/v"]).max() < 1e-6
    if kind:
        assert abs(there["solid/rigid"][0, 12] / here["solid/rigid"][0, 12] - 1) < 1e-8


@pytest.mark.parametrize("changes", [(), (SOFT,)], ids=["rigid", "soft"])
def test_a_restart_leaves_the_bytes_of_the_whole(changes, tmp_path):
    (tmp_path / "scene.nml").write_text(deck("disc.nml", *changes))
    code, words = run(tmp_path, "--out", "whole", "--set", "run.max_steps=60")
    assert code in (0, 3), words
    code, words = run(tmp_path, "--out", "parts", "--set", "run.max_steps=37")
    code, words = run(tmp_path, "--out", "parts", "--set", "run.max_steps=60",
                      "--restart", "latest")  # fmt: skip
    assert code in (0, 3), words
    assert state(tmp_path / "parts", 0) == state(tmp_path / "whole", 0)


def test_a_thrown_disc_keeps_the_books(tmp_path):
    (tmp_path / "scene.nml").write_text(deck("disc.nml"))
    code, words = run(tmp_path, "--out", "out")
    assert code == 0, words
    energy, bodies = (history(tmp_path / "out" / name) for name in ("energy.csv", "bodies.csv"))
    assert abs(energy["mass_error[-]"][-1]) < 1e-12
    assert abs(energy["momentum_error[-]"][-1]) < 1e-12
    assert abs(energy["error[-]"][-1]) < 1e-6
    assert bodies["disc:velocity_x[m/s]"][-1] == pytest.approx(202.3, rel=0.01)


def check(tmp_path):
    return subprocess.run([BRISANCE, "run", "scene.nml", "--check"], cwd=tmp_path, env=ALONE,
                          capture_output=True, text=True)  # fmt: skip


def test_the_check_tells_the_cells_across_a_body(tmp_path):
    """The disc has ten cells across: 73 % over them, see print_walls.f90."""
    (tmp_path / "scene.nml").write_text(deck("disc.nml"))
    done = check(tmp_path)
    assert done.returncode == 0, done.stderr
    words = "10.0 cells across its smallest side: the impulse of a blast is within 7 %"
    assert words in done.stdout


def test_a_scheme_of_older_versions_is_refused(tmp_path):
    words = deck("disc.nml") + "\n&coupling scheme = 'wall_flux' /\n"
    (tmp_path / "scene.nml").write_text(words)
    done = check(tmp_path)
    assert done.returncode == 2
    assert "wall_flux" in done.stderr and "cut_cells" in done.stderr
