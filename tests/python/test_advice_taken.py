# SPDX-License-Identifier: MIT
"""What `--check` advises is better: runs with and without it, longer than those of test_advice."""

import subprocess

import numpy as np
import pytest
from notes import note
from test_advice import BALL, BRISANCE, FAR_OFF, farthest_apart, histories


@pytest.mark.slow
def test_a_charge_of_few_cells_is_better_started_along_its_radius(tmp_path):
    """Nearer to the blast along the radius alone: impulse of an ideal balloon of 4 cells in its
    radius."""
    deck = tmp_path / "ball.nml"
    deck.write_text(BALL, encoding="utf-8")
    radial = BALL.split("&charge")[1].replace("start = '3d', ", "")
    (tmp_path / "radius.nml").write_text(
        f"&run t_end = 4e-4 /\n&air geometry = 'spherical' /\n&charge{radial}", encoding="utf-8"
    )
    impulse = {}
    for name, sets in (("ball", []), ("better", ["--set", "charge(tnt).start=1d"]), ("radius", [])):
        path = deck if name == "better" else tmp_path / f"{name}.nml"
        command = [BRISANCE, "run", path, "--out", tmp_path / name, "--backend", "cpu", *sets]
        done = subprocess.run(command, capture_output=True, text=True, timeout=300)
        assert done.returncode == 0, done.stdout + done.stderr
        rows = np.genfromtxt(tmp_path / name / "gauges.csv", delimiter=",", skip_header=1)
        total = np.cumsum(np.diff(rows[:, 0]) * (rows[1:, 1] + rows[:-1, 1]) / 2)
        impulse[name] = total.max()
    errors = [abs(impulse[name] / impulse["radius"] - 1) for name in ("ball", "better")]
    note("advice_start_3d", errors[0])
    note("advice_start_1d", errors[1])
    assert errors[1] < 0.7 * errors[0]


@pytest.mark.slow
def test_products_that_arrive_late(tmp_path):
    """The same run, but longer: there one gas is another."""
    deck = tmp_path / "far.nml"
    deck.write_text(FAR_OFF, encoding="utf-8")
    apart = farthest_apart(*(histories(tmp_path, deck, name, *sets) for name, sets in (
        ("two", []), ("one", ["charge(tnt).gamma=1.4"]))))  # fmt: skip
    late = farthest_apart(*(histories(tmp_path, deck, f"late_{name}", "run.t_end=1.6e-3", *sets)
                            for name, sets in (
        ("two", []), ("one", ["charge(tnt).gamma=1.4"]))))  # fmt: skip
    note("advice_one_gas_late", late[0])
    assert late[0] > 10 * apart[0]
