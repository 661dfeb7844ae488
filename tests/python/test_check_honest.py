# SPDX-License-Identifier: MIT
"""What `--check` must not call sound, or must tell: foam, scattered particles, cost, layers."""

import os
import re
import subprocess
from itertools import product
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
BRISANCE = Path(os.environ.get("BRISANCE", ROOT / "bin" / "brisance"))

FOAM = """
&run t_end=2e-4 /
&material id='f', model='linear_elastic', density=100, youngs_modulus=2e7, poisson_ratio=0.3 /
&body id='foam', box=0,0.02, 0,0.02, 0,0.02, spacing=2e-3, material='f', fix='z-' /
&load id='p', body='foam', faces='z+', time=0,1e-5,2e-4, pressure=0,1e7,1e7 /
"""
STEEL = "&material id='s', preset='steel_4340', failure='none' /\n"


def check(folder, deck, *sets):
    """Output and messages of `--check` of a deck that is accepted."""
    (folder / "a.nml").write_text(deck)
    more = [part for one in sets for part in ("--set", one)]
    command = [BRISANCE, "run", "a.nml", "--check", *more]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    return done.stdout, done.stderr


def seconds(text):
    """The core-seconds that a check tells."""
    number, unit = re.search(r"time +about ([\d.]+) (ms|s|min|h) of one core", text).groups()
    return float(number) * {"ms": 1e-3, "s": 1, "min": 60, "h": 3600}[unit]


def test_foam_under_its_modulus_is_warned_of(tmp_path):
    """10 MPa on 20 MPa of Young's modulus ends with code 3; a hundredth of it is no matter."""
    out, told = check(tmp_path, FOAM)
    assert "a.nml:4: &body id='foam': warning: it is loaded by up to 10.0 MPa, 60 %" in told
    assert "foam needs a law that crushes" in told
    assert "1 warning(s)" in out
    _, told = check(tmp_path, FOAM, "load.pressure=0,1e5,1e5")
    assert told == ""
    near = (
        FOAM[: FOAM.index("&load")]
        + "&load id='p', body='foam', faces='z+', mass={}, at=0,0,0.5 /\n"
    )
    _, told = check(tmp_path, near.format(1), "run.t_end=2e-3")
    assert "% of its bulk modulus" in told
    _, told = check(tmp_path, near.format(1e-3), "run.t_end=2e-3")
    assert told == ""


def test_foam_that_crushes_runs(tmp_path):
    """A layer with held sides, of the law that the message names, carries the load."""
    (tmp_path / "a.nml").write_text("""
&run t_end=2e-4, dimension=1 /
&material id='f', model='hjc', density=100, shear_modulus=7.7e6, a=0.5, b=0.5, n=0.8, c=0, fc=1e6
  t=1e5, efmin=0.5, smax=10, d1=1, d2=1, p_crush=8e5, mu_crush=0.05, p_lock=2e7, mu_lock=4, k1=1e9
  k2=0, k3=0 /
&body id='foam', box=0,0.02, 0,1, 0,1, spacing=2e-3, material='f', fix='x-' /
&load id='p', body='foam', faces='x+', time=0,1e-5,2e-4, pressure=0,1e7,1e7 /
""")
    command = [BRISANCE, "run", "a.nml", "--out", "o"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    error = float(re.search(r"energy error +(-?[0-9.E+-]+)\n", done.stdout)[1])
    assert abs(error) < 3e-3


@pytest.mark.parametrize(("scatter", "told"), [(0, False), (0.01, False), (0.1, True)])
def test_scattered_particles_are_warned_of(scatter, told, tmp_path):
    """Particles of a file off their lattice; a lattice that lies askew is one."""
    rng = np.random.default_rng(3)
    x = np.array(list(product(range(9), repeat=3))) + rng.uniform(-scatter, scatter, (729, 3))
    turn = np.array([[0.8, -0.6, 0], [0.6, 0.8, 0], [0, 0, 1]])
    np.savetxt(tmp_path / "p.csv", 1e-3 * x @ turn, "%.9e", ",", header="x,y,z", comments="")
    deck = "&run t_end=1e-6 /\n" + STEEL + "&body id='b', shape='particles', file='p.csv', "
    _, said = check(tmp_path, deck + "spacing=1e-3, material='s' /\n")
    assert ("its particles lie on no lattice" in said) == told, said
    if told:
        assert "a.nml:3: &body id='b': warning" in said


RIGID = """
&run t_end=1e-3 /
&air box=0,0.2, 0,0.2, 0,0.2, cells=10,10,10 /
&material id='s', preset='steel_paper' /
&body id='b', box=0.08,0.12, 0.08,0.12, 0.08,0.12, spacing=0.01, material='s'
  formulation='rigid', fix='all' /
"""


def test_rigid_bodies_have_no_time_step(tmp_path):
    """Their step was said to be the largest number there is."""
    out, _ = check(tmp_path, RIGID)
    assert "+308" not in out
    assert "solid steps" not in out
    alone = "\n".join(line for line in RIGID.splitlines() if "&air" not in line)
    out, _ = check(tmp_path, alone)
    assert "+308" not in out


PLATE = (
    "&run t_end=1e-4 /\n{}&body id='b', box=0,0.1, 0,0.1, 0,{}, spacing=2e-3, material='s', "
    "fix='x-', fix_width=0.004 /\n"
)


def test_what_a_plate_is_told(tmp_path):
    """Held particles; wide ones for a thin plate that never breaks; four layers that lock."""
    out, _ = check(tmp_path, PLATE.format(STEEL, 0.01))
    assert "500 particles are fixed" in out
    assert "aspect = 3.0, 3.0, 1.0" in out
    assert "four layers" not in out
    out, _ = check(tmp_path, PLATE.format(STEEL, 0.008))
    assert "four layers" in out
    out, _ = check(tmp_path, PLATE.format(STEEL.replace(", failure='none'", ""), 0.01))
    assert "aspect" not in out


def test_the_cost_knows_the_formulation(tmp_path):
    """Plies cost more than metals, total_lagrangian less; seconds are those of a core."""
    ply = "&material id='s', preset='cfrp_ud' /\n"
    metal = check(tmp_path, PLATE.format(STEEL, 0.01))[0]
    steps = float(re.search(r"about (\d+) steps", metal)[1])
    assert 0.7e-6 < seconds(metal) / steps / 12500 < 2.8e-6
    plies = check(tmp_path, PLATE.format(ply, 0.01))[0]
    per = seconds(plies) / float(re.search(r"about (\d+) steps", plies)[1])
    assert per > seconds(metal) / steps * 0.9
    total = check(tmp_path, PLATE.format(STEEL, 0.01), "body.formulation=total_lagrangian")[0]
    assert seconds(total) < 0.9 * seconds(metal)


@pytest.mark.parametrize(
    ("spacing", "words"), [(4e-3, "3 particles per bar"), (6e-3, "too soft in bending")]
)
def test_bars_say_what_they_can(spacing, words, tmp_path):
    """Two particles across stretch right, three bend right too; one needs a body around it."""
    bar = "&body id='r', shape='bars', axis='x', box=0,0.1, 0,0.012, 0,0.012, diameter=0.012, "
    deck = "&run t_end=1e-6 /\n" + STEEL + bar + f"spacing={spacing}, material='s' /\n"
    out, _ = check(tmp_path, deck)
    assert words in out
    (tmp_path / "b.nml").write_text(deck.replace(f"spacing={spacing}", "spacing=0.012"))
    done = subprocess.run(
        [BRISANCE, "run", "b.nml", "--check"], cwd=tmp_path, capture_output=True, text=True
    )
    assert done.returncode == 2
    assert "b.nml:3: &body id='r': one particle across a bar" in done.stderr
    assert "two stretch right, three bend right too" in done.stderr
