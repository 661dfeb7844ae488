# SPDX-License-Identifier: MIT
"""`brisance mat`: one material point along a path, from outside."""

import subprocess
import sys
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
BRISANCE = ROOT / "bin" / "brisance"
GOLDEN = ROOT / "tests" / "golden"
sys.path.insert(0, str(ROOT))

from post import material  # noqa: E402
from post.__main__ import main  # noqa: E402

ELASTIC = """\
&material id='m' model='linear_elastic' density=1000
          youngs_modulus=1e9 poisson_ratio=0.3 /
"""
GRUNEISEN = """\
&material id='m', model='gruneisen', density=2785, sound_speed=5328, s1=1.338,
          gruneisen_gamma=2.0, gruneisen_a=0.48, shear_modulus=27.6e9, yield_stress=265e6 /
"""
PLY = """\
&material id='m', model='orthotropic_ply', density=1550, e1=150e9, e2=8.2e9, e3=8.2e9, nu12=0.34,
          nu13=0.34, nu23=0.53, g12=4.34e9, g13=4.34e9, g23=2.7e9 /
"""


def drive(folder, deck, *args, code=0):
    """Run a deck in a folder; the table, and what the program said."""
    (folder / "path.nml").write_text(deck)
    done = subprocess.run(
        [BRISANCE, "mat", "path.nml", *args], cwd=folder, capture_output=True, text=True, timeout=60
    )
    assert done.returncode == code, f"exit code {done.returncode}\n{done.stdout}\n{done.stderr}"
    assert "Fortran runtime error" not in done.stderr
    file = folder / "out" / "path.csv"
    return (read(file) if file.exists() else None), done


def read(file):
    return np.genfromtxt(file, delimiter=",", names=True, deletechars="", replace_space=" ")


def test_columns_and_rows(tmp_path):
    path = "&point material='m', steps=20, output_every=7 /\n"
    path += "&segment duration=1e-3, l=-1,0,0, 0,0,0, 0,0,0 /\n" * 2
    table, _ = drive(tmp_path, ELASTIC + path)
    expected = "time[s],rho[kg/m3],e[J/kg],p[Pa],q[Pa],sxx[Pa],syy[Pa],szz[Pa],syz[Pa],sxz[Pa],"
    expected += "sxy[Pa],eps_xx[-],eps_yy[-],eps_zz[-],eps_yz[-],eps_xz[-],eps_xy[-],eps_p[-],"
    expected += "damage[-],T[K],plastic_work[J/kg],damage_work[J/kg]"
    assert list(table.dtype.names) == expected.split(",")
    steps = np.array([0, 7, 14, 20, 27, 34, 40])
    assert table["time[s]"] == pytest.approx(steps * 5e-5, rel=1e-14)
    assert table["eps_xx[-]"] == pytest.approx(-steps * 5e-5, rel=1e-12)
    assert table["rho[kg/m3]"] == pytest.approx(1000 * np.exp(steps * 5e-5), rel=1e-12)


def test_gradient_is_read_row_by_row(tmp_path):
    """dv_x/dy alone turns the stress clockwise: sxx = G (1 - cos g), sxy = G sin g."""
    path = "&point material='m', steps=500 /\n&segment duration=1, l=0,1,0, 0,0,0, 0,0,0 /\n"
    table, _ = drive(tmp_path, ELASTIC + path)
    shear = 1e9 / 2.6
    assert table["sxx[Pa]"][-1] == pytest.approx(shear * (1 - np.cos(1)), rel=1e-5)
    assert table["sxy[Pa]"][-1] == pytest.approx(shear * np.sin(1), rel=1e-5)
    assert table["eps_xy[-]"][-1] == pytest.approx(0.5, rel=1e-12)


@pytest.mark.parametrize("axis", "xyz")
def test_uniaxial_stress_is_uniaxial(tmp_path, axis):
    """Young's modulus, Poisson's ratio, then the yield stress; the same along every axis."""
    path = "&point material='m', steps=100 /\n"
    path += f"&segment duration=1e-3, control='uniaxial_stress', axis='{axis}', rate=0.01 /\n"
    path += f"&segment duration=1e-3, control='uniaxial_stress', axis='{axis}', rate=20 /\n"
    path += f"&segment duration=1e-4, control='uniaxial_stress', axis='{axis}', rate=-10 /\n"
    table, _ = drive(tmp_path, GRUNEISEN + path)
    lateral = [c for c in "xyz" if c != axis]
    along = table[f"s{axis}{axis}[Pa]"]
    bulk, shear = 2785 * 5328**2, 27.6e9
    young = 9 * bulk * shear / (3 * bulk + shear)
    assert along[100] == pytest.approx(young * 1e-5, rel=1e-4)
    ratio = -table[f"eps_{lateral[0]}{lateral[0]}[-]"][100] / 1e-5
    assert ratio == pytest.approx(young / (2 * shear) - 1, rel=1e-4)
    assert along[200] == pytest.approx(265e6, rel=1e-9)
    assert along[300] == pytest.approx(265e6 - young * 1e-3, rel=1e-2)
    for c in lateral:
        assert np.abs(table[f"s{c}{c}[Pa]"]).max() < 1e-8 * 265e6


@pytest.mark.parametrize("angle", [0, 30, 45, 90])
def test_uniaxial_stress_of_a_turned_ply(tmp_path, angle):
    """Young's modulus off the axes, with all shear stresses zero as well."""
    path = f"&point material='m', steps=10, rotation={angle} /\n"
    path += "&segment duration=1e-6, control='uniaxial_stress', rate=1 /\n"
    table, _ = drive(tmp_path, PLY + path)
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    compliance = c**4 / 150e9 + s**4 / 8.2e9 + c**2 * s**2 * (1 / 4.34e9 - 2 * 0.34 / 150e9)
    assert table["sxx[Pa]"][-1] == pytest.approx(1e-6 / compliance, rel=1e-5)
    for name in ["syy[Pa]", "szz[Pa]", "sxy[Pa]", "syz[Pa]", "sxz[Pa]"]:
        assert np.abs(table[name]).max() < 1e-8 * table["sxx[Pa]"][-1]


def test_refused_step_ends_the_path(tmp_path):
    """Exit code 3, where and in what state; the rows so far are kept."""
    path = "&point material='m', steps=4 /\n"
    path += "&segment duration=1, l=0.1,0,0, 0,0,0, 0,0,0 /\n"
    path += "&segment duration=1, l=9,0,0, 0,0,0, 0,0,0 /\n"
    table, done = drive(tmp_path, ELASTIC + path, code=3)
    assert "segment 2, step 1" in done.stderr
    assert "take more steps" in done.stderr
    assert len(table) == 5
    assert np.isfinite([list(row) for row in table]).all()


def test_lateral_stress_vanishes_in_one_step(tmp_path):
    """From 1.6 GPa all around to a free side: a rate 1e4 times the given one for one step."""
    path = "&point material='m', steps=1000, output_every=1 /\n"
    path += "&segment duration=1e-3, l=-7,0,0, 0,-7,0, 0,0,-7 /\n"
    path += "&segment duration=1e-3, control='uniaxial_stress', axis='x', rate=-1 /\n"
    table, _ = drive(tmp_path, GRUNEISEN + path)
    assert table["syy[Pa]"][1000] < -1.5e9
    assert np.abs(table["syy[Pa]"][1001:]).max() < 100
    assert table["sxx[Pa]"][1001:].min() >= -265e6 * (1 + 1e-9)
    assert table["eps_yy[-]"][1001] > 0


def test_a_fluid_without_stress_keeps_its_volume(tmp_path):
    water = "&material id='m', model='polynomial', density=1000, bulk_modulus=2.2e9 /\n"
    path = "&point material='m', steps=20 /\n"
    path += "&segment duration=1e-3, control='uniaxial_stress', axis='z', rate=-50 /\n"
    table, _ = drive(tmp_path, water + path)
    assert np.ptp(table["rho[kg/m3]"]) < 1e-9
    assert table["eps_xx[-]"][-1] == pytest.approx(0.025, rel=1e-12)


def test_stress_that_cannot_vanish_is_reported(tmp_path):
    """A gas pushes sideways whatever the rates: no uniaxial stress, and no row that says so."""
    gas = "&material id='m', model='ideal_gas', density=1.2, gamma=1.4, pressure=1e5 /\n"
    path = "&point material='m' /\n"
    path += "&segment duration=1e-3, control='uniaxial_stress', rate=-10 /\n"
    table, done = drive(tmp_path, gas + path, code=3)
    assert "no rates give the stresses that are to be held" in done.stderr
    assert table.size == 1


def test_table_is_not_overwritten(tmp_path):
    path = "&point material='m' /\n&segment duration=1, l=0,1e-3,0, 0,0,0, 0,0,0 /\n"
    drive(tmp_path, ELASTIC + path)
    before = (tmp_path / "out" / "path.csv").read_bytes()
    _, done = drive(tmp_path, ELASTIC + path, "--set", "segment.duration=2", code=4)
    assert "--replace" in done.stderr
    assert (tmp_path / "out" / "path.csv").read_bytes() == before
    drive(tmp_path, ELASTIC + path, "--set", "segment.duration=2", "--replace")
    assert (tmp_path / "out" / "path.csv").read_bytes() != before
    drive(tmp_path, ELASTIC + path, "--out", "other/table.csv")
    assert (tmp_path / "other" / "table.csv").read_bytes() == before


def test_check_writes_nothing(tmp_path):
    path = "&point material='m' /\n&segment duration=1, l=0,1e-3,0, 0,0,0, 0,0,0 /\n"
    table, done = drive(tmp_path, ELASTIC + path, "--check")
    assert table is None
    assert "linear_elastic" in done.stdout


@pytest.mark.parametrize(
    ("deck", "message"),
    [
        ("&point material='m' /", "there is no &segment"),
        ("&segment duration=1, l=9*0.0 /", "&point is missing"),
        ("&point material='n' /\n&segment duration=1, l=9*0.0 /", "did you mean 'm'?"),
        ("&point material='m' /\n&segment duration=1 /", "key 'l' is missing"),
        ("&point material='m' /\n&segment duration=1, l=1,2,3 /", "expects 9 numbers"),
        (
            "&point material='m' /\n&segment duration=1, l=9*0.0, rate=3 /",
            "key 'rate' has no place with control='strain'",
        ),
        (
            "&point material='m' /\n&segment duration=1, control='uniaxial_stress' /",
            "key 'rate' is missing",
        ),
    ],
)
def test_bad_decks(tmp_path, deck, message):
    _, done = drive(tmp_path, ELASTIC + deck + "\n", code=2)
    assert message in done.stderr


@pytest.mark.parametrize(
    ("names", "titles"),
    [
        (["johnson_cook_tension"], ["Pressure", "Stress path", "Stress and strain", "State"]),
        (["jwl_expansion"], ["Pressure", "Expansion", "Stress and strain", "Energy"]),
        (["bilinear_rebar", "johnson_cook_tension"], ["Pressure", "Damage"]),
    ],
)
def test_pictures(tmp_path, monkeypatch, names, titles):
    """Four panels, drawn to the limits of the table and not beyond."""
    drawn = {}

    def keep(figure, path):
        drawn["figure"] = figure
        return save(figure, path)

    save = material.save
    monkeypatch.setattr(material, "save", keep)
    files = [str(GOLDEN / f"{name}.csv") for name in names]
    assert main(["material", *files, "--out", str(tmp_path / "p.png")]) == 0
    assert matplotlib.image.imread(tmp_path / "p.png").std() > 0.05
    panels = [axes for axes in drawn["figure"].axes if axes.get_title(loc="left")]
    assert len(panels) == 4
    assert {axes.get_title(loc="left") for axes in panels} >= set(titles)
    table = read(files[0])
    mu = table["rho[kg/m3]"] / table["rho[kg/m3]"][0] - 1
    assert panels[0].lines[0].get_xdata() == pytest.approx(mu, abs=1e-12)
    assert all(np.isfinite(line.get_ydata()).all() for axes in panels for line in axes.lines)


def test_pictures_of_something_else_are_refused(tmp_path, capsys):
    (tmp_path / "energy.csv").write_text("time[s],total[J]\n0,1\n1,1\n")
    assert main(["material", str(tmp_path / "energy.csv")]) != 0
    assert "no table of `brisance mat`" in capsys.readouterr().err
