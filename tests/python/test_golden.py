# SPDX-License-Identifier: MIT
"""The decks of inputs/material give the curves that they gave before."""

import os
import subprocess

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


def test_one_curve_is_written(tmp_path, monkeypatch):
    """CASE alone: the other curves stay as they are, a curve without a deck goes."""
    monkeypatch.setattr(golden, "GOLDEN", tmp_path)
    monkeypatch.setattr(golden, "is_native", lambda version: True)
    for name in ("ply_fibre", "jwl_expansion", "no_deck"):
        (tmp_path / f"{name}.csv").write_text("old\n")
    assert golden.main(["ply_fibre"]) is None
    assert {file.stem for file in tmp_path.iterdir()} == {"ply_fibre", "jwl_expansion"}
    assert (tmp_path / "jwl_expansion.csv").read_text() == "old\n"
    kept = golden.ROOT / "tests/golden/ply_fibre.csv"
    assert golden.differences(golden.read(kept), golden.read(tmp_path / "ply_fibre.csv")) == []
    assert "there is no plywood; CASE is one of bilinear_rebar, " in golden.main(["plywood"])


VERSION = "Brisance 0.1.0\n-fopenmp {} -flto=auto\nworking precision: {}\n"


@pytest.mark.parametrize(
    ("flags", "precision", "native"),
    [
        ("-O3 -march=native", "double", True),
        ("-O3 -march=native", "mixed", False),
        ("-O1 -march=native", "double", False),
        ("-O3 -march=x86-64-v2", "double", False),
    ],
)
def test_only_the_native_build_is_golden(tmp_path, monkeypatch, flags, precision, native):
    monkeypatch.setattr(golden, "GOLDEN", tmp_path)
    program = tmp_path / "brisance"
    program.write_text(f"#!/bin/sh\ncat <<'.'\n{VERSION.format(flags, precision)}.\n")
    program.chmod(0o755)
    monkeypatch.setattr(golden, "BRISANCE", program)
    monkeypatch.setattr(golden, "names", list)
    assert (golden.main([]) is None) == native


@pytest.mark.parametrize("kind", ["QUICK=1", "DEBUG=1", "PORTABLE=1", "PRECISION=mixed"])
def test_make_golden_refuses_other_builds(kind):
    """Before anything is built."""
    env = {k: v for k, v in os.environ.items() if not k.startswith(("MAKE", "MFLAGS"))}
    done = subprocess.run(["make", "golden", kind], cwd=golden.ROOT, env=env,
                          capture_output=True, text=True)  # fmt: skip
    assert done.returncode == 2
    assert "make golden: the curves are those of the native build" in done.stderr
    assert done.stdout == ""
