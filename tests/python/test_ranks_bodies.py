# SPDX-License-Identifier: MIT
"""Bodies on several processes: the bits of one."""

import re

import numpy as np
import pytest
from test_ranks import BALL, MATERIALS, equal_bodies, go, needs_mpirun, start
from test_run import arrays, history
from tiers import slow

MEETING = f"""\
&run title = 'meeting', t_end = 8e-6, symmetry = 'y', energy_band = 0.5 /
{MATERIALS}{BALL}\
&body id = 'plate', shape = 'box', box = -0.006,0.006, 0,0.006, -0.002,0, spacing = 1e-3,
     material = 'm' /
&body id = 'glued', shape = 'box', box = 0.006,0.01, 0,0.004, -0.002,0, spacing = 1e-3,
     material = 'm', velocity = 300, 0, 20 /
&body id = 'die', shape = 'box', box = -0.003,0.001, 0,0.003, -0.005,-0.002, spacing = 1e-3,
     material = 'm', formulation = 'rigid', velocity = 20, 0, 80 /
&body id = 'ram', shape = 'box', box = -0.01,-0.007, 0,0.004, -0.002,0, spacing = 1e-3,
     material = 'm', formulation = 'rigid', motion_time = 0,1, motion_velocity = 300,0,0, 300,0,0 /
&interaction law = 'contact', friction = 0.3 /
&interaction bodies = 'plate', 'glued', law = 'bonded', tensile_strength = 1e8 /
&gauge id = 'edge', body = 'plate', at = 0.0055,0.001,-0.001, quantity = 'speed' /
&output dump_every = 4e-6, history_every = 0 /
"""

# Bodies that do not meet, some seconds: steel that is drawn until it fails beside two planes of
# symmetry, a total-Lagrangian plate, one of variable smoothing length whose particles leave.
BODIES = f"""\
&run title = 'bodies', t_end = 4e-6, symmetry = 'x', 'z', energy_band = 0.5 /
{MATERIALS}\
&body id = 'bar', shape = 'box', box = 0,0.008, 0,0.005, 0,0.005, spacing = 1e-3, material = 's',
     fix = 'x+', motion_time = 0,1e-6,1, motion_velocity = 0,0,0, 900,10,30, 900,10,30 /
&body id = 'plate', shape = 'box', box = 0,0.009, 0.03,0.032, 0,0.009, spacing = 1e-3,
     material = 'm', velocity = 0,900,0, formulation = 'total_lagrangian' /
&body id = 'block', shape = 'box', box = 0,0.007, 0.035,0.039, 0.03,0.037, spacing = 1e-3,
     material = 's', velocity = 0,400,900, variable_h = .true. /
&solid region = -1,1, -1,0.04, -1,1, leave = 'remove' /
&interaction law = 'none' /
&gauge id = 'end', body = 'bar', at = 0.0075,0.001,0.001, quantity = 'displacement_x' /
&gauge id = 'middle', body = 'block', at = 0.004,0.036,0.034, quantity = 'speed' /
&gauge id = 'foil', body = 'bar', at = 0,0,0, to = 0.008,0.005,0.005, quantity = 'strain' /
&gauge id = 'across', body = 'block', at = 0,0.035,0.03, to = 0.007,0.039,0.037,
     quantity = 'strain' /
&output dump_every = 2e-6, history_every = 0 /
"""


SCENES = {"apart": BODIES, "meeting": MEETING}


@pytest.fixture(scope="module")
def bodies_alone(tmp_path_factory):
    """The folders of runs of bodies on one process."""
    found = {}
    for name, deck in SCENES.items():
        folder = found[name] = tmp_path_factory.mktemp(name)
        done = go(0, deck, folder)
        assert ("they are taken out" in done.stderr) == (name == "apart")
    checkpoint = sorted((found["meeting"] / "out").glob("chk_*.h5"))[-1]
    bond = arrays(checkpoint)["solid/bond"]
    assert (bond == 1).any()
    assert (bond == 2).any()
    energy = history(found["meeting"] / "out/energy.csv")
    assert all(np.abs(energy[name]).max() > 0 for name in ("friction[J]", "contact[J]"))
    return {name: folder / "out" for name, folder in found.items()}


@needs_mpirun
@pytest.mark.long("three processes on two cores, until the bodies have met and left each other")
@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("n", [slow(2), 3, slow(4)])
def test_bodies_do_not_depend_on_processes(n, name, bodies_alone, tmp_path):
    done = go(n, SCENES[name], tmp_path)
    assert "the most particles over the mean" in done.stdout
    equal_bodies(bodies_alone[name], tmp_path / "out")


@needs_mpirun
@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize(("n", "m"), [(0, 3), (2, 0), slow(4, 3)])
def test_bodies_go_on_on_other_processes(n, m, name, bodies_alone, tmp_path):
    (tmp_path / "deck.nml").write_text(SCENES[name])
    done = start(n, "run", "deck.nml", "--out", "out", "--set", "run.max_steps=50", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    done = start(m, "run", "deck.nml", "--out", "out", "--restart", "latest", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    equal_bodies(bodies_alone[name], tmp_path / "out")


@needs_mpirun
def test_what_leaves_bodies_that_meet_does_not_depend_on_processes(tmp_path):
    """Removed for good, unless they press on others, whose pressures other processes may know."""
    deck = MEETING + "&solid region = -1,0.0115, -1,1, -0.0022,1, leave = 'remove' /\n"
    (tmp_path / "deck.nml").write_text(deck)
    for n, out, more in [(0, "one", []), (4, "four", []), (2, "two", ["--set", "run.max_steps=50"]),
                         (3, "two", ["--restart", "latest"])]:  # fmt: skip
        done = start(n, "run", "deck.nml", "--out", out, *more, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
    equal_bodies(tmp_path / "one", tmp_path / "four")
    equal_bodies(tmp_path / "one", tmp_path / "two")
    fixed = arrays(sorted((tmp_path / "one").glob("chk_*.h5"))[-1])["solid/fixed"]
    assert 10 < (fixed == 2).sum() < 100


def test_a_check_tells_the_particles_of_processes(tmp_path):
    (tmp_path / "deck.nml").write_text(BODIES)
    done = start(0, "run", "deck.nml", "--check", "--ranks", "3", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    own = [int(words[0]) for line in done.stdout.splitlines() if " of its own" in line
           for words in [line.split(":")[1].split()]]  # fmt: skip
    assert len(own) == 3
    assert sum(own) == 8 * 5 * 5 + 9 * 2 * 9 + 7 * 4 * 7
    assert max(own) < 1.2 * sum(own) / 3


def test_images_in_planes_need_no_ghosts_far_away(tmp_path):
    """A block that ends in three planes: who has no particle near a cut sends none."""
    (tmp_path / "deck.nml").write_text("""\
&run title = 'corner', t_end = 1e-6, symmetry = 'x', 'y', 'z' /
&material id = 's', model = 'linear_elastic', density = 1e3, youngs_modulus = 1e7,
     poisson_ratio = 0.3 /
&body id = 'b', shape = 'box', box = 0, 0.04, 0, 0.01, 0, 0.01, spacing = 1e-3, material = 's' /
""")
    done = start(0, "run", "deck.nml", "--check", "--ranks", "2", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    ghosts = re.findall(r"of its own, (\d+) of neighbours", done.stdout)
    assert 100 <= min(map(int, ghosts)) <= max(map(int, ghosts)) <= 300
