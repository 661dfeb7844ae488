# SPDX-License-Identifier: MIT
"""Gas from a file at the start of a run: dumps of other runs, other cells, profiles, points."""

import os

import h5py
import numpy as np
import pytest
from notes import note
from test_run import history, run

ALONE = {"env": {**os.environ, "OMP_NUM_THREADS": "1"}}

# A hot spot off the middle, which reaches no side: with products, and without.
FIRST = """\
&run t_end=2e-5 /
&air box=0,0.6, 0,0.5, 0,0.4, cells=30,25,20 /
&charge id='c', mass=2.5, at=0.31,0.27,0.19{more} /
&output dump_every=2e-5 /
"""
# The same gas in cells that fit nowhere, in a larger box that begins elsewhere.
SECOND = """\
&run t_end=1e-9, max_steps=0 /
&air box=-0.13,0.7, -0.07,0.6, -0.11,0.5, cells={cells} /
&gas id='g', file='out/first/air_00001.vtkhdf'{move} /
"""


def totals(file):
    """Volume, mass, momentum, energy and products of a dump, in double precision."""
    with h5py.File(file) as f:
        cell, field, top = f["VTKHDF/CellData"], f["VTKHDF/FieldData"], f["VTKHDF"].attrs
        rho, p = (np.asarray(cell[name], float) for name in ("density", "pressure"))
        v = np.asarray(cell["velocity"], float)
        y = np.asarray(cell["products"], float) if "products" in cell else np.zeros_like(rho)
        heat = 1 / (field["gamma"][0] - 1)
        if "products" in cell:
            heat = (1 - y) * heat + y / (field["gamma_products"][0] - 1)
        volume = np.prod(top["Spacing"])
        energy = p * heat + rho / 2 * (v**2).sum(-1)
        every = [np.ones_like(rho), rho, *(rho * v[..., i] for i in range(3)), energy, rho * y]
        return np.array([volume * a.sum() for a in every])


def books(folder):
    """Mass, energy and products of the first row of energy.csv."""
    names = ("air_mass[kg]", "air_kinetic[J]", "air_internal[J]", "products[kg]")
    rows = history(folder / "energy.csv")
    mass, kinetic, internal, products = (np.atleast_1d(rows[name])[0] for name in names)
    return np.array([mass, kinetic + internal, products])


@pytest.mark.parametrize("more", ["", ", gamma=1.27"])
def test_a_dump_is_put_into_other_cells_without_loss(tmp_path, more):
    (tmp_path / "first.nml").write_text(FIRST.format(more=more))
    run("run", "first.nml", cwd=tmp_path, **ALONE)
    there = totals(tmp_path / "out/first/air_00001.vtkhdf")
    worst = 0
    for name, cells, move in (("fine", "67,59,53", ""), ("coarse", "23,21,19", ""),
                              ("moved", "31,31,31", ", move=-0.1,0.05,-0.08")):  # fmt: skip
        (tmp_path / f"{name}.nml").write_text(SECOND.format(cells=cells, move=move))
        run("run", f"{name}.nml", cwd=tmp_path, **ALONE)
        here = books(tmp_path / "out" / name)
        around = 0.83 * 0.67 * 0.61 - there[0]
        expected = there[[1, 5, 6]] + around * np.array([1.225, 101325 / (1.4 - 1), 0])
        worst = max(worst, (np.abs(here - expected) / np.maximum(expected, 1e-3)).max())
        moved = totals(tmp_path / f"out/{name}/air_00000.vtkhdf")
        assert moved[2:5] == pytest.approx(there[2:5], abs=1e-7 * there[1] * 3000)
    note("gas_file_loss" + ("_products" if more else ""), worst)
    assert worst < 1e-12
    assert there[1] > 1
    assert (there[6] > 1) == bool(more)


def test_a_run_from_a_dump_goes_on_as_the_whole(tmp_path):
    (tmp_path / "first.nml").write_text(FIRST.format(more=""))
    gauge = "&gauge id='g', at=0.45,0.4,0.3, quantity='overpressure' /\n&output history_every=0 /\n"
    whole = FIRST.format(more="").replace("2e-5 /", "1e-4 /", 1).split("&output")[0] + gauge
    (tmp_path / "whole.nml").write_text(whole)
    box = "&air box=0,0.6, 0,0.5, 0,0.4, cells=30,25,20, ramp_steps=0 /\n"
    second = "&run t_end=8e-5 /\n" + box + "&gas id='g', file='out/first/air_00001.vtkhdf' /\n"
    (tmp_path / "second.nml").write_text(second + gauge)
    for name in ("first", "whole", "second"):
        run("run", f"{name}.nml", cwd=tmp_path, **ALONE)
    a, b = (history(tmp_path / f"out/{name}/gauges.csv") for name in ("whole", "second"))
    at = 2e-5 + b["time[s]"]
    p = np.interp(at, a["time[s]"], a["g:overpressure[Pa]"])
    error = np.abs(b["g:overpressure[Pa]"] - p).max() / p.max()
    note("gas_file_goes_on", error)
    assert p.max() > 1e5
    assert error < 5e-3  # other steps in time


def test_a_profile_keeps_its_integrals(tmp_path):
    """A round blast with a shock in a table: mass and energy of the shell, and its symmetry."""
    r = np.linspace(0.005, 0.3, 60)
    rho, u, p = 1.225 + 4 * r, 900 * r, 1e5 + 3e6 * r
    rows = "\n".join(f"{a},{b},{c},{d}" for a, b, c, d in zip(r, rho, u, p, strict=True))
    (tmp_path / "ball.csv").write_text("r [m],density,velocity,pressure\n" + rows)
    (tmp_path / "a.nml").write_text(
        "&run t_end=1, max_steps=0 /\n&air box=-0.4,0.4,-0.4,0.4,-0.4,0.4, cells=48,48,48 /\n"
        "&gas id='g', file='ball.csv', at=0.01,-0.02,0.03 /\n"
    )
    run("run", "a.nml", cwd=tmp_path, **ALONE)
    got = totals(tmp_path / "out/a/air_00000.vtkhdf")
    got -= got[0] * np.array([1, 1.225, 0, 0, 0, 101325 * 2.5, 0])
    x = np.linspace(0, 0.3, 300001)
    f = np.interp(x, r, rho), np.interp(x, r, u), np.interp(x, r, p)
    shell = 4 * np.pi * x**2
    mass = np.trapezoid(shell * (f[0] - 1.225), x)
    energy = np.trapezoid(shell * ((f[2] - 101325) * 2.5 + f[0] * f[1] ** 2 / 2), x)
    error = max(abs(got[1] / mass - 1), abs(got[5] / energy - 1))
    note("gas_file_profile", error)
    assert error < 2e-4  # of 64 points in a cell
    assert np.abs(got[2:5]).max() < 2e-2 * mass * 300


def test_points_and_lines(tmp_path):
    """Nearest points in two dimensions, a line along x: exact where cells and rows agree."""
    air = "&run t_end=1, max_steps=0, dimension=2 /\n&air box=0,1,0,0.5,0,1, cells=20,10,1 /\n"
    x, y = np.meshgrid(np.arange(20) / 20 + 0.025, np.arange(6) / 20 + 0.025, indexing="ij")
    rho, v, p = 1 + x + 3 * y, 100 * x - 20 * y, 1e5 * (2 + x * y)
    table = np.stack([x, y, rho, p, v], -1).reshape(-1, 5)
    np.savetxt(tmp_path / "p.csv", table, delimiter=",", comments="",
               header="x,y,density,pressure,velocity_y")  # fmt: skip
    np.savetxt(tmp_path / "l.csv", table[::6, [0, 2, 3]], delimiter=",", comments="",
               header="x,density,pressure")  # fmt: skip
    for name in "pl":
        (tmp_path / f"{name}.nml").write_text(air + f"&gas id='g', file='{name}.csv' /\n")
        run("run", f"{name}.nml", cwd=tmp_path, **ALONE)
    with h5py.File(tmp_path / "out/p/air_00000.vtkhdf") as f:
        cell = f["VTKHDF/CellData"]
        assert pytest.approx(rho, rel=1e-6) == cell["density"][0, :6].T
        assert pytest.approx(p, rel=1e-6) == cell["pressure"][0, :6].T
        assert pytest.approx(v, rel=1e-5, abs=1e-4) == cell["velocity"][0, :6, :, 1].T
        assert cell["density"][0, 6:] == pytest.approx(1.225)
    with h5py.File(tmp_path / "out/l/air_00000.vtkhdf") as f:
        density = np.asarray(f["VTKHDF/CellData/density"])[0]
    assert density[:, 2:18] == pytest.approx(np.tile(rho[2:18, 0], (10, 1)), rel=1e-6)


@pytest.mark.parametrize(
    ("name", "text", "why"),
    [
        ("a.csv", "x,y\n0,1\n", "must name the columns density"),
        ("a.csv", "r,x,density,pressure\n0,0,1,1\n1,1,1,1\n", "take the columns of x, y, z out"),
        ("a.csv", "x,density,pressure\n0,1,1\n0,1,1\n", "must grow"),
        ("a.csv", "x,density,pressure\n0,1,1\n1,-1,1\n", "not positive"),
        ("a.csv", "x,y,density,pressure\n0,0,1,1\n1,1,1,1\n", "has no column z"),
        ("a.csv", "x,density,pressure\n0,1\n", "row 2 is no 3 numbers"),
        ("a.vtkhdf", "x,density,pressure\n0,1\n", "name a dump air_*.vtkhdf"),
    ],
)
def test_bad_files_are_named(tmp_path, name, text, why):
    (tmp_path / name).write_text(text)
    (tmp_path / "d.nml").write_text(
        f"&run t_end=1 /\n&air box=0,1,0,1,0,1, cells=8,8,8 /\n&gas id='g', file='{name}' /\n"
    )
    done = run("run", "d.nml", cwd=tmp_path, code=2)
    assert why in done.stderr
    assert "d.nml:3: &gas id='g'" in done.stderr


def test_dumps_that_do_not_fit_are_named(tmp_path):
    (tmp_path / "first.nml").write_text(FIRST.format(more="").replace("t_end=2e-5", "t_end=1e-9"))
    run("run", "first.nml", cwd=tmp_path, **ALONE)
    for air, why in (
        ("box=0,1,0,1,0,1, cells=8,8,8, gamma=1.3", "give &air the same"),
        ("box=0,1,0,1,0,1, cells=8,8,1", "several cells along z"),
    ):
        (tmp_path / "d.nml").write_text(
            f"&run t_end=1 /\n&air {air} /\n&gas id='g', file='out/first/air_00000.vtkhdf' /\n"
        )
        done = run("run", "d.nml", cwd=tmp_path, code=2)
        assert why in done.stderr
        assert "d.nml:3: &gas id='g'" in done.stderr
