# SPDX-License-Identifier: MIT
"""Cut cells from a deck: what is refused, a restart, and a shock that throws a disc."""

import subprocess

import pytest
from test_restart import ALONE, run, state
from test_run import BRISANCE, ROOT, history

SCENES = ROOT / "tests/scenes"


def deck(name, *changes, scheme="cut_cells"):
    text = (SCENES / name).read_text() + f"\n&coupling scheme = '{scheme}' /\n"
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return text


SOFT = ("      formulation = 'rigid' /", "/")


def test_a_periodic_box_is_refused(tmp_path):
    (tmp_path / "scene.nml").write_text(
        deck("disc.nml", ("'wall', 'wall'", "'periodic', 'periodic'"))
    )
    done = subprocess.run([BRISANCE, "run", "scene.nml", "--check"], cwd=tmp_path, env=ALONE,
                          capture_output=True, text=True)  # fmt: skip
    assert done.returncode == 2
    assert "in a periodic box" in done.stderr


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
    """The disc is slower than that of the staircase, which is larger than its particles."""
    speeds = []
    for scheme in ("cut_cells", "wall_flux"):
        (tmp_path / "scene.nml").write_text(deck("disc.nml", scheme=scheme))
        code, words = run(tmp_path, "--out", scheme)
        assert code == 0, words
        energy, bodies = (
            history(tmp_path / scheme / name) for name in ("energy.csv", "bodies.csv")
        )
        assert abs(energy["mass_error[-]"][-1]) < 1e-12
        assert abs(energy["momentum_error[-]"][-1]) < 1e-12
        assert abs(energy["error[-]"][-1]) < 1e-6
        speeds.append(bodies["disc:velocity_x[m/s]"][-1])
    assert speeds[0] == pytest.approx(202.3, rel=0.01)
    assert speeds[0] < 0.95 * speeds[1]


@pytest.mark.parametrize(
    "scheme, words",
    [("cut_cells", "within 7 %"), ("wall_flux", "some 50 % too large")],
)
def test_the_check_tells_the_cells_across_a_body(scheme, words, tmp_path):
    """The disc has ten cells across: 490 and 73 % over them, see print_walls.f90."""
    (tmp_path / "scene.nml").write_text(deck("disc.nml", scheme=scheme))
    done = subprocess.run([BRISANCE, "run", "scene.nml", "--check"], cwd=tmp_path, env=ALONE,
                          capture_output=True, text=True)  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "10.0 cells across its smallest side: the impulse of a blast is " + words in done.stdout
