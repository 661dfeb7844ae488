# SPDX-License-Identifier: MIT
"""Scenes that are their own mirror images: a half or a quarter of them is the whole."""

import subprocess

import numpy as np
import pytest
from test_gauges import gauges
from test_loads import BRISANCE, run

PLY = """\
&material id='u', model='orthotropic_ply', density=1600, e1=1.3e11, e2=9e9, e3=9e9, g12=5e9,
    g13=5e9, g23=3e9, nu12=0.3, nu13=0.3, nu23=0.4 /
"""
LAMINATE = (
    "&run t_end=3e-6 {planes} /\n"
    + PLY
    + """\
&body id='b', box=-0.004,0.004, -0.003,0.005, -0.003,0.003, spacing=1e-3, material='u',
    formulation='{form}', plies='{plies}', fix='y-', fix_layers=1 /
&load body='b', faces='x-','x+','z-','z+', time=0,2e-6, pressure=1e7,0 /
"""
)
POINTS = "0.0025,0.0015,0.0005", "0.0005,0.0035,0.0015", "0.0035,0.0045,0.0025"


def measured(folder, deck, planes, more=""):
    """Gauges of a deck with and without planes of symmetry: (whole, part)."""
    return [gauges(run(folder, deck.replace("{planes}", text) + more))
            for text in ("", f", symmetry={planes}")]  # fmt: skip


def equal(whole, part):
    assert whole.keys() == part.keys()
    for name, column in whole.items():
        most = abs(column).max()
        assert most > 0, name
        assert np.allclose(part[name], column, rtol=0, atol=1e-9 * most), name


@pytest.mark.parametrize("planes", ["'z'", "'x','z'"])
@pytest.mark.parametrize("plies", ["0/90/30/30/90/0", "90/0/90"])
@pytest.mark.parametrize("form", ["bending", "uncorrected"])
def test_a_cut_laminate_has_the_plies_of_the_whole(tmp_path, planes, plies, form):
    """Across the plies, between two of them or within one; in their plane with 0 and 90 alone."""
    if "x" in planes:
        plies = plies.replace("30", "0")
    more = "&output history_every=0, dump_every=1 /\n"
    for k, at in enumerate(POINTS):
        for name in ("stress_xx", "stress_yy", "velocity_y"):
            more += f"&gauge id='{name}{k}', body='b', at={at}, quantity='{name}' /\n"
    equal(*measured(tmp_path, LAMINATE.replace("{plies}", plies).replace("{form}", form),
                    planes, more))  # fmt: skip


# A block on the planes; others that are drawn to it and to a plane, from both sides of it
DRAWN = """\
&run t_end=5e-6 {planes} /
&material id='s', model='linear_elastic', density=7800, youngs_modulus=200e9, poisson_ratio=0.3 /
&body id='a', box=-0.002,0.002, -0.002,0.002, 0,0.004, spacing=1e-3, material='s' /
&body id='b', box=0.00202,0.00502, -0.002,0.002, 0,0.004, spacing=1e-3, material='s' /
&body id='c', box=-0.00502,-0.00202, -0.002,0.002, 0,0.004, spacing=1e-3, material='s' /
&load body='b', acceleration=-5e6,0,1e6 /
&load body='c', acceleration=5e6,0,1e6 /
&load body='b', faces='y-','y+','x+', mass=1e-3, at=0,0,0.04, detonation_time=-1.2e-5 /
&load body='c', faces='y-','y+','x-', mass=1e-3, at=0,0,0.04, detonation_time=-1.2e-5 /
&load body='a', faces='z+', mass=1e-3, at=0,0,0.04, detonation_time=-8e-6 /
&interaction law='contact', friction=0.3 /
&gauge id='sa', body='a', at=0.0015,0.0015,0.0025, quantity='stress_xx' /
&gauge id='sb', body='b', at=0.0025,0.0015,0.0025, quantity='stress_xx' /
&gauge id='vb', body='b', at=0.0025,0.0015,0.0025, quantity='velocity_x' /
&output history_every=0, dump_every=1 /
"""


@pytest.mark.parametrize("planes", ["'x'", "'x','y'"])
def test_what_is_drawn_to_a_plane_of_symmetry(tmp_path, planes):
    equal(*measured(tmp_path, DRAWN, planes))


HOT = """\
&run t_end=2e-5, dimension=2 {planes} /
&air box={low},0.02, -0.02,0.02, -0.5,0.5, cells={n},20,1 /
&gas id='hot', box=-0.006,0.006, -0.02,-0.01, -1,1, density=5, pressure=5e6 /
&gauge id='vx', at=0.0003,-0.003,0, quantity='velocity_x' /
&gauge id='vy', at=0.0003,-0.003,0, quantity='velocity_y' /
&gauge id='p', at=0.0003,-0.003,0 /
&output history_every=0, dump_every=1 /
"""


def test_a_gauge_of_the_air_beside_a_plane_of_symmetry(tmp_path):
    """Nothing flows through it: the normal velocity goes over to nothing."""
    whole, part = (
        gauges(run(tmp_path, HOT.format(low=low, n=n, planes=planes)))
        for low, n, planes in ((-0.02, 20, ""), (0, 10, ", symmetry='x'"))
    )
    equal(whole, part)
    assert abs(whole["vx"]).max() > 1


@pytest.mark.parametrize(("plane", "plies", "keys", "told"), [
    ("z", "0/90/0", "", False), ("z", "0/90", "", True), ("x", "0/90", "", False),
    ("y", "90/-90", "", False), ("x", "0/45/45/0", "", True), ("x", "0/30", ", woven=.true.", True),
    ("x", "0/45", ", woven=.true.", False),
])  # fmt: skip
def test_plies_that_are_not_their_own_images_are_told(tmp_path, plane, plies, keys, told):
    deck = f"&run t_end=1e-6, symmetry='{plane}' /\n" + PLY.replace(" /", f"{keys} /")
    deck += "&body id='b', box=-0.006,0.006, -0.006,0.006, -0.006,0.006, spacing=1e-3,\n"
    (tmp_path / "case.nml").write_text(deck + f"    material='u', plies='{plies}' /\n")
    done = subprocess.run([BRISANCE, "run", "case.nml", "--check"], cwd=tmp_path,
                          capture_output=True, text=True)  # fmt: skip
    text = f"case.nml:4: warning: &body id='b': the plane of symmetry {plane}=0 cuts plies that "
    assert done.returncode == 0 and (text in done.stderr) == told, done.stderr
