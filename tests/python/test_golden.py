# SPDX-License-Identifier: MIT
"""The decks of inputs/material give the curves that they gave before."""

import golden
import numpy as np
import pytest


def test_every_deck_has_its_curve():
    assert [f.stem for f in sorted(golden.GOLDEN.glob("*.csv"))] == golden.names()


@pytest.mark.parametrize("name", golden.names())
def test_curve(tmp_path, name):
    found = golden.drive(name, tmp_path / "found.csv")
    assert np.isfinite(found[1]).all()
    assert golden.differences(golden.read(golden.GOLDEN / f"{name}.csv"), found) == []


@pytest.mark.parametrize("change", ["b=292.1e6", "c=0.02501", "m=1.0901", "specific_heat=383.1"])
def test_a_constant_cannot_change_unseen(tmp_path, change):
    name = "johnson_cook_shear"
    found = golden.drive(name, tmp_path / "found.csv", "--set", f"material.{change}")
    assert golden.differences(golden.read(golden.GOLDEN / f"{name}.csv"), found) != []
