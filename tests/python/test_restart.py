# SPDX-License-Identifier: MIT
"""A run in pieces leaves the bytes of a run in one go, in scenes that are drawn at random.

Some scenes by default; `BRISANCE_SCENES=0:500` draws those. Without removal by what a checkpoint
holds, or with a first row written again after a restart at step 0, some of the default ones fail.
"""

import os
import random
import re
import subprocess

import pytest
from random_scenes import draw
from test_run import BRISANCE, ROOT, arrays, tables
from tiers import slow

FEW = "160:200"
QUICK = range(160, 170)  # of them
ALONE = {**os.environ, "OMP_NUM_THREADS": "1"}


def seeds():
    first, last = os.environ.get("BRISANCE_SCENES", FEW).split(":")
    for seed in range(int(first), int(last)):
        yield seed if seed in QUICK or "BRISANCE_SCENES" in os.environ else slow(seed)


def run(folder, *args):
    """Exit code and words of a run; the scene may well be one that cannot go on."""
    command = [BRISANCE, "run", "scene.nml", *args]
    try:
        done = subprocess.run(command, cwd=folder, env=ALONE, capture_output=True, text=True,
                              timeout=100)  # fmt: skip
    except subprocess.TimeoutExpired:
        pytest.skip("a body is crushed, and its time step with it")
    return done.returncode, done.stderr


def state(folder, code):
    """Histories, dumps and the last checkpoint in a folder, name by name."""
    last = sorted(folder.glob("chk_*.h5"))[-1:] if code == 0 else []
    found = {"series": [p.read_text() for p in sorted(folder.glob("*.series"))], **tables(folder)}
    for file in [*folder.glob("*.vtkhdf"), *last]:
        for path, values in arrays(file).items():
            same = values.tolist() if values.dtype == object else values.tobytes()
            found[f"{file.name}: {path}"] = values.dtype, values.shape, same
    return found


@pytest.mark.parametrize("seed", seeds())
def test_pieces_leave_the_bytes_of_the_whole(seed, tmp_path):
    (tmp_path / "scene.nml").write_text(draw(seed))
    rng = random.Random(seed)
    steps = rng.randint(20, 100)
    code, words = run(tmp_path, "--out", "whole", "--set", f"run.max_steps={steps}")
    assert code in (0, 3), words
    begin = []
    for last in [*sorted(rng.sample(range(steps), rng.choice([1, 1, 2, 3]))), steps]:
        again, words = run(tmp_path, "--out", "parts", "--set", f"run.max_steps={last}", *begin)
        begin = ["--restart", "latest"]
        if again:
            break
    assert again == code, words
    whole, parts = (state(tmp_path / name, code) for name in ("whole", "parts"))
    assert whole.keys() == parts.keys()
    assert not [name for name in whole if whole[name] != parts[name]]


REMOVAL = """\
&run t_end=3e-6, dimension=2 /
&material id='s', preset='al2024' /
&body id='a', box=-0.004,0,-0.004,0.004,0,1, spacing=5e-4, material='s', velocity=1500,0,0 /
&body id='b', box=0.0005,0.004,-0.004,0.004,0,1, spacing=5e-4, material='s' /
&interaction law='contact' /
&solid region=-0.0045,0.003,-0.0045,0.0045,-1,1, leave='remove' /
"""


def test_what_presses_is_left_in_after_a_restart_too(tmp_path):
    """Two bodies that collide are cut at the border of the region while they press."""
    (tmp_path / "scene.nml").write_text(REMOVAL)
    run(tmp_path, "--out", "whole")
    for last in (35, 37, 39, 41):
        run(tmp_path, "--out", f"{last}", "--set", f"run.max_steps={last}")
        run(tmp_path, "--out", f"{last}", "--restart", "latest")
        assert tables(tmp_path / f"{last}") == tables(tmp_path / "whole")


BESIDE_A_RIGID_BODY = """\
&run t_end=1e-6, dimension=1 /
&material id='s', preset='steel_4340' /
&body id='a', box=0,0.0006,-1,1,-1,1, spacing=2e-4, material='s', formulation='rigid' /
&body id='b', box=0.0006,0.0014,-1,1,-1,1, spacing=2e-4, material='s', velocity=-900,0,0 /
&interaction law='contact', shared_pressure=.true. /
&output history_every=0 /
"""


def test_a_restart_behind_its_end_says_that_nothing_is_left(tmp_path):
    (tmp_path / "scene.nml").write_text(BESIDE_A_RIGID_BODY)
    assert run(tmp_path, "--out", "a", "--set", "run.t_end=5e-7") == (0, "")
    words = {}
    for key in ("run.t_end=5e-7", "run.t_end=2e-7", "run.max_steps=2"):
        code, words[key] = run(tmp_path, "--out", "a", "--restart", "latest", "--set", key)
        assert code == 0
        assert "nothing is left to compute" in words[key] and key.split("=")[0] in words[key]
        assert words[key].count("\n") == 1
    times = re.findall(r"= (\S+) s", words["run.t_end=2e-7"])
    assert [float(t) for t in times] == pytest.approx([5e-7, 2e-7], rel=1e-6)
    code, words = run(tmp_path, "--out", "a", "--restart", "latest", "--set", "run.t_end=1e-6")
    assert (code, words) == (0, "")


ROUND_AND_SHARED = """\
&run t_end=1.5e-6, dimension=2 /
&material id='s', preset='al2024' /
&body id='wheel', shape='sphere', centre=0,0.0026,0, radius=0.002, spacing=5e-4, material='s',
      formulation='rigid', velocity=300,-400,0 /
&body id='plate', box=-0.004,0.004,-0.002,0,0,1, spacing=5e-4, material='s' /
&body id='flyer', box=-0.004,0.004,-0.0045,-0.0028,0,1, spacing=5e-4, material='s',
      velocity=0,900,0 /
&interaction law='contact', friction=0.3 /
&interaction law='shared', bodies='plate','flyer' /
"""


METAL = """\
&run t_end=4e-6, dimension=2 /
&material id='s', preset={} /
&body id='a', box=0,0.004,-0.002,0.002,0,1, spacing=5e-4, material='s', velocity=600,0,0 /
&body id='b', box=0.0041,0.008,-0.002,0.002,0,1, spacing=5e-4, material='s' /
&interaction law='contact' /
"""


@pytest.mark.parametrize("metal", ["'mild_steel', failure_strain=0.02",
                                   "'ofhc_copper_za', heating='energy'",
                                   "'armco_iron_za', d1=0.02, d5=1"])  # fmt: skip
def test_metals_go_on_after_a_restart(metal, tmp_path):
    """Plastic strain, temperature, energy on the isentrope and damage are kept."""
    (tmp_path / "scene.nml").write_text(METAL.format(metal))
    code, words = run(tmp_path, "--out", "whole")
    assert code == 0, words
    run(tmp_path, "--out", "parts", "--set", "run.max_steps=25")
    run(tmp_path, "--out", "parts", "--restart", "latest")
    assert state(tmp_path / "parts", 0) == state(tmp_path / "whole", 0)


def test_wheels_and_shared_sums_go_on_after_a_restart(tmp_path):
    """The weights of a round surface are kept; who shares its sums follows from the state."""
    (tmp_path / "scene.nml").write_text(ROUND_AND_SHARED)
    code, words = run(tmp_path, "--out", "whole")
    assert code == 0, words
    for last in (4, 17, 30):
        run(tmp_path, "--out", f"{last}", "--set", f"run.max_steps={last}")
        run(tmp_path, "--out", f"{last}", "--restart", "latest")
        assert state(tmp_path / f"{last}", 0) == state(tmp_path / "whole", 0)


def test_a_rigid_body_shares_what_it_has_after_a_restart_too(tmp_path):
    """The pressure and viscosity that a rigid body shares are nothing, not what a sort left."""
    (tmp_path / "scene.nml").write_text(BESIDE_A_RIGID_BODY)
    run(tmp_path, "--out", "whole")
    for last in range(3, 12):
        run(tmp_path, "--out", f"{last}", "--set", f"run.max_steps={last}")
        run(tmp_path, "--out", f"{last}", "--restart", "latest")
        assert tables(tmp_path / f"{last}") == tables(tmp_path / "whole")


def test_the_gas_pushes_rigid_bodies_on_after_a_restart(tmp_path):
    """What the gas did to a body in its last step decides how its walls move in the next."""
    deck = (ROOT / "tests" / "scenes" / "blown_square.nml").read_text()
    (tmp_path / "scene.nml").write_text(deck)
    steps = "--set", "run.max_steps=60"
    assert run(tmp_path, "--out", "whole", *steps)[0] == 0
    run(tmp_path, "--out", "parts", "--set", "run.max_steps=31")
    run(tmp_path, "--out", "parts", *steps, "--restart", "latest")
    assert state(tmp_path / "parts", 0) == state(tmp_path / "whole", 0)


# glue that is pulled, a region and a rigid body that are driven, one that strikes, one that sticks
ELSEWHERE = """\
&run t_end=1e-4, dimension=2 /
&material id='m', model='linear_elastic', density=1000, youngs_modulus=1e9, poisson_ratio=0.3 /
&body id='a', box=0,0.01, 0,0.005, 0,1, spacing=0.001, material='m', fix='y-' /
&body id='b', box=0,0.01, 0.005,0.01, 0,1, spacing=0.001, material='m' /
&body id='ram', box=0.0102,0.0152, 0,0.004, 0,1, spacing=0.001, material='m',
      formulation='rigid', motion_time=0,1e-6, motion_velocity=0,0,0, -60,0,0 /
&body id='flyer', box=-0.0055,-0.0005, 0.001,0.009, 0,1, spacing=0.001, material='m',
      velocity=50,4,0 /
&motion id='lift', body='b', box=0,0.01, 0.009,0.01, 0,1, axes='y', velocity=0,4,0 /
&load body='b', faces='x+', time=0,1e-5, pressure=1e6,0 /
&interaction law='contact', friction=0.3 /
&interaction bodies='a','b', law='cohesive', tensile_strength=1e6, shear_strength=2e6,
  gi=30, gii=60 /
&gauge id='grip', body='b', motion='lift', quantity='reaction_y' /
&gauge id='rest', body='a', quantity='reaction_y' /
&gauge id='ram', body='ram', quantity='reaction_x' /
&gauge id='met', body='a', with='ram', quantity='contact_x' /
&gauge id='sum', body='a', with='ram', quantity='impulse_x' /
&gauge id='rub', body='flyer', with='b', quantity='contact_y' /
&gauge id='all', body='b', quantity='impulse_x' /
&output history_every=0 /
"""


@pytest.mark.parametrize("last", [3, 27, 48, 70])
def test_a_new_folder_goes_on_with_the_rows_of_the_whole(last, tmp_path):
    """Histories of forces, impulses and interfaces begin behind the checkpoint as they went on."""
    (tmp_path / "scene.nml").write_text(ELSEWHERE)
    assert run(tmp_path, "--out", "whole", "--set", "run.max_steps=80")[0] == 0
    run(tmp_path, "--out", "first", "--set", f"run.max_steps={last}")
    begin = "--restart", f"first/chk_{last:06}.h5"
    code, words = run(tmp_path, "--out", "more", "--set", "run.max_steps=80", *begin)
    assert code == 0, words
    for name, text in tables(tmp_path / "whole").items():
        lines = text.splitlines(keepends=True)
        assert (tmp_path / "more" / name).read_bytes() == b"".join([lines[0], *lines[last + 2 :]])
