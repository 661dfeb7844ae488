# SPDX-License-Identifier: MIT
"""Scenes of several bodies from outside: restart, threads, and what a run says of them."""

import os
import re

import h5py
import pytest
from test_run import history, run, tables

# A driven rigid punch, a bonded liner that breaks loose, a free rigid ball; friction everywhere.
DECK = """\
&run title='bodies', t_end=3e-5 /
&material id='soft', model='linear_elastic', density=1000,
          youngs_modulus=5e8, poisson_ratio=0.3 /
&body id='block', box=0,0.008, 0,0.008, 0,0.006, spacing=1e-3, material='soft', fix='z-',
      fix_layers=1 /
&body id='liner', box=0,0.008, 0,0.008, 0.006,0.008, spacing=1e-3, material='soft' /
&body id='punch', box=0.002,0.006, 0.002,0.006, 0.008,0.010, spacing=1e-3, material='soft',
      formulation='rigid', motion_time=0,1e-5, motion_velocity=0,0,-60, 20,0,-60 /
&body id='ball', shape='sphere', centre=-0.0021,0.004,0.004, radius=0.002, spacing=1e-3,
      material='soft', formulation='rigid', velocity=80,0,0, spin=0,3e3,0 /
&interaction law='contact', friction=0.3 /
&interaction law='bonded', bodies='block','liner', tensile_strength=4e6, shear_strength=4e6 /
&output checkpoint_every=1e-5, history_every=0 /
"""


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    """A folder with the deck `bodies.nml` and the results of a whole run in `out/bodies`."""
    folder = tmp_path_factory.mktemp("bodies")
    (folder / "bodies.nml").write_text(DECK)
    run("run", "bodies.nml", cwd=folder)
    return folder


def test_every_law_acts_and_energy_closes(scene):
    energy = history(scene / "out" / "bodies" / "energy.csv")
    assert energy["friction[J]"][-1] > 0
    assert energy["contact_heat[J]"][-1] > 0
    assert energy["drive_work[J]"][-1] > 0
    assert abs(energy["error[-]"][-1]) < 0.01


def test_restart_goes_on_with_the_same_bytes(scene):
    run("run", "bodies.nml", "--out", "half", "--set", "run.max_steps=41", cwd=scene)
    run("run", "bodies.nml", "--out", "half", "--restart", "latest", cwd=scene)
    assert tables(scene / "half") == tables(scene / "out" / "bodies")


def test_threads_do_not_matter(scene):
    run("run", "bodies.nml", "--out", "three", cwd=scene, env=os.environ | {"OMP_NUM_THREADS": "3"})
    assert tables(scene / "three") == tables(scene / "out" / "bodies")


LONE = """\
&run title='lone', t_end=1e-5 /
&material id='soft', model='linear_elastic', density=1000,
          youngs_modulus=5e8, poisson_ratio=0.3 /
&body id='one', box=0,0.001, 0,0.001, 0,0.001, spacing=1e-3, material='soft', velocity=50,0,0 /
&body id='sheet', box=0.0012,0.0022, -0.003,0.004, -0.003,0.004, spacing=1e-3, material='soft' /
&solid region=-1,0.00172, -1,1, -1,1 /
"""


def test_one_particle_meets_a_single_layer_and_what_leaves_is_told(tmp_path):
    (tmp_path / "lone.nml").write_text(LONE)
    done = run("run", "lone.nml", cwd=tmp_path)
    energy = history(tmp_path / "out" / "lone" / "energy.csv")
    assert abs(energy["error[-]"][-1]) < 0.01
    assert energy["contact_heat[J]"][-1] > 0
    assert energy["outside[kg]"][-1] > 0
    assert "have left the region" in done.stderr
    bodies = history(tmp_path / "out" / "lone" / "bodies.csv")
    assert bodies["sheet:velocity_x[m/s]"][-1] > 0
    momentum = sum(
        bodies[f"{b}:mass[kg]"] * bodies[f"{b}:velocity_x[m/s]"] for b in ("one", "sheet")
    )
    assert abs(momentum / momentum[0] - 1).max() < 1e-12


def test_leaving_can_stop_a_run(tmp_path):
    (tmp_path / "lone.nml").write_text(LONE.replace("&solid ", "&solid leave='stop', "))
    done = run("run", "lone.nml", cwd=tmp_path, code=3)
    assert "have left the region" in done.stderr and "checkpoint" in done.stderr
    assert list((tmp_path / "out" / "lone").glob("chk_*.h5"))


def test_a_collapsed_time_step_ends_with_a_checkpoint(tmp_path):
    deck = LONE.replace("t_end=1e-5", "t_end=1e-5, dt_min=3e-7")
    deck = deck.replace("velocity=50", "velocity=1500").replace("0.0012,0.0022", "0.005,0.006")
    (tmp_path / "lone.nml").write_text(deck)
    done = run("run", "lone.nml", cwd=tmp_path, code=3)
    assert "is not above its floor" in done.stderr and "checkpoint" in done.stderr
    assert list((tmp_path / "out" / "lone").glob("chk_*.h5"))
    run("run", "lone.nml", "--restart", "latest", "--set", "run.dt_min=0", cwd=tmp_path)


def test_two_particles_at_one_place_are_refused(tmp_path):
    (tmp_path / "twins.csv").write_text("x,y,z\n0,0,0\n\n1e-3,0,0\n1e-3,0,1e-8\n")
    deck = LONE.replace("box=0,0.001, 0,0.001, 0,0.001", "shape='particles', file='twins.csv'")
    (tmp_path / "lone.nml").write_text(deck)
    done = run("run", "lone.nml", cwd=tmp_path, code=2)
    line = next(n for n, row in enumerate(deck.splitlines(), 1) if "twins.csv" in row)
    assert f"lone.nml:{line}: &body id=" in done.stderr
    assert "particles 2 and 3 are at the same place" in done.stderr
    assert "m: lines 4 and 5 of twins.csv; leave one of them out" in done.stderr


def test_overlapping_bodies_are_both_named(tmp_path):
    (tmp_path / "lone.nml").write_text(LONE.replace("0.0012,0.0022", "0.0004,0.0022"))
    done = run("run", "lone.nml", "--check", cwd=tmp_path, code=2)
    assert re.match(r"lone\.nml:\d+: &body id='one'", done.stderr), "file and line"
    assert "overlaps the body 'sheet'" in done.stderr
    assert "cuts=" in done.stderr, "the remedy"


@pytest.mark.parametrize(
    "shape",
    [
        "shape='sphere', centre=0.0005,0.0005,0.0005, radius=0.0001",
        "shape='stl', file='sliver.stl'",
        "box=0.0013,0.0021, 0,0.001, 0,0.001",
    ],
)
def test_a_body_without_particles_is_refused(tmp_path, shape):
    corners = [(0, 0, 0), (1e-4, 0, 0), (0, 1e-4, 0), (0, 0, 1e-4)]
    sides = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    text = "".join(
        "facet normal 0 0 0\nouter loop\n"
        + "".join("vertex {} {} {}\n".format(*corners[c]) for c in side)
        + "endloop\nendfacet\n"
        for side in sides
    )
    (tmp_path / "sliver.stl").write_text(f"solid sliver\n{text}endsolid sliver\n")
    deck = LONE.replace("box=0,0.001, 0,0.001, 0,0.001", shape)
    deck = deck.replace("id='sheet'", "id='sheet', cuts='one'")
    (tmp_path / "lone.nml").write_text(deck)
    done = run("run", "lone.nml", cwd=tmp_path, code=2)
    assert "&body id='one'" in done.stderr, done.stderr
    assert "holds no particle" in done.stderr or "larger than the body" in done.stderr


BLOCK = """\
&run title='block', t_end=1e-6 /
&material id='soft', model='linear_elastic', density=1000,
          youngs_modulus=5e8, poisson_ratio=0.3 /
&body id='block', box=0,0.004, 0,0.003, 0,0.002, spacing=1e-3, material='soft', velocity=9,0,0 /
&output dump_every=1e-6 /
"""


def mass_of(folder, body):
    """Mass of a body as bodies.csv has it."""
    return history(folder / "bodies.csv")[f"{body}:mass[kg]"][0]


def test_particles_come_from_hdf5(tmp_path):
    (tmp_path / "block.nml").write_text(BLOCK)
    run("run", "block.nml", cwd=tmp_path)
    with h5py.File(tmp_path / "out/block/solid_00000.vtkhdf") as file:
        points = file["VTKHDF/Points"][:]
    assert points.shape == (24, 3)
    box = "box=0,0.004, 0,0.003, 0,0.002"
    dump = "shape='particles', file='out/block/solid_00000.vtkhdf'"
    (tmp_path / "dump.nml").write_text(BLOCK.replace(box, dump))
    run("run", "dump.nml", cwd=tmp_path)
    block, again = tmp_path / "out/block", tmp_path / "out/dump"
    assert mass_of(again, "block") == pytest.approx(mass_of(block, "block"), rel=1e-12)
    with h5py.File(tmp_path / "own.h5", "w") as file:
        file["VTKHDF/Points"] = points[:4]
        file["VTKHDF/PointData/volume"] = [1e-9, 2e-9, 3e-9, 4e-9]
    own = "shape='particles', file='own.h5'"
    (tmp_path / "own.nml").write_text(BLOCK.replace(box, own))
    run("run", "own.nml", cwd=tmp_path)
    assert mass_of(tmp_path / "out/own", "block") == pytest.approx(1e-5, rel=1e-12)


LAMINATE = """\
&run title='laminate', t_end=1, max_steps=1 /
&material id='cfrp', preset='cfrp_ud' /
&body id='block', shape='particles', file='block.csv', spacing=1e-3, material='cfrp',
      plies='0/90/90/0', ply_axis='x' /
"""


def test_particles_that_a_plane_cuts_have_the_plies_of_all(tmp_path):
    """Plies count in the box of all particles of the file, those behind the plane too."""
    places = [(i + 0.5, j + 0.5, 0.5) for i in range(-4, 4) for j in range(3)]
    rows = [",".join(f"{1e-3 * x:g}" for x in place) for place in places]
    (tmp_path / "block.csv").write_text("\n".join(["x,y,z", *rows, ""]))
    plies = []
    for name, planes in (("whole", ""), ("half", "symmetry='x' /")):
        (tmp_path / f"{name}.nml").write_text(LAMINATE.replace("/", planes or "/", 1))
        run("run", f"{name}.nml", cwd=tmp_path)
        with h5py.File(tmp_path / f"out/{name}/solid_00000.vtkhdf") as file:
            x, ply = file["VTKHDF/Points"][:, 0], file["VTKHDF/PointData/ply"][:]
        plies.append(sorted({(round(1e3 * a, 2), p) for a, p in zip(x, ply, strict=True) if a > 0}))
    assert plies[0] == plies[1] == [(0.5, 3), (1.5, 3), (2.5, 4), (3.5, 4)]


def flat(file):
    file["VTKHDF/Points"] = [0.0, 1.0, 2.0]


def empty(file):
    file.create_group("VTKHDF")


def negative(file):
    file["VTKHDF/Points"] = [[0.0, 0.0, 0.0]]
    file["VTKHDF/PointData/volume"] = [-1.0]


@pytest.mark.parametrize(
    ("fill", "code", "words"),
    [
        (flat, 2, "is no table of three columns"),
        (negative, 2, "a volume is not positive"),
        (empty, 4, "VTKHDF/Points"),
        (None, 4, "own.h5: cannot open it, or it is damaged"),
    ],
)
def test_a_bad_hdf5_file_is_refused(tmp_path, fill, code, words):
    if fill:
        with h5py.File(tmp_path / "own.h5", "w") as file:
            fill(file)
    else:
        (tmp_path / "own.h5").write_bytes(b"no HDF5 at all")
    deck = BLOCK.replace("box=0,0.004, 0,0.003, 0,0.002", "shape='particles', file='own.h5'")
    (tmp_path / "block.nml").write_text(deck)
    done = run("run", "block.nml", cwd=tmp_path, code=code)
    assert "&body id='block'" in done.stderr and words in done.stderr, done.stderr


FRAGMENT = """\
&run title='fragment', t_end=3e-6, symmetry='y','z' /
&material id='al', model='gruneisen', density=2785, sound_speed=5328, s1=1.338,
          gruneisen_gamma=2.0, shear_modulus=27.6e9, yield_stress=0.29e9 /
&body id='plate', box=0,0.003, -0.010,0.010, -0.010,0.010, spacing=1e-3, material='al', cfl=0.6 /
&body id='ball', shape='sphere', centre=-0.0035,0,0, radius=0.003, spacing=1e-3, material='al',
      velocity=6000,0,0, cfl=0.6 /
"""


def test_a_fragment_at_6_km_per_s_keeps_its_energy(tmp_path):
    (tmp_path / "fragment.nml").write_text(FRAGMENT)
    run("run", "fragment.nml", cwd=tmp_path)
    energy = history(tmp_path / "out" / "fragment" / "energy.csv")
    assert abs(energy["error[-]"]).max() < 0.01


CHIP = """\
&run title='chip', t_end=7e-5 /
&air box=-0.01,0.02, -0.01,0.014, -0.01,0.014, cells=30,24,24 /
&material id='soft', model='linear_elastic', density=1000,
          youngs_modulus=5e8, poisson_ratio=0.3 /
&body id='chip', box=0,0.003, 0,0.004, 0,0.004, spacing=5e-4, material='soft', velocity=100,0,0 /
&body id='block', box=-0.006,-0.002, 0,0.004, 0,0.004, spacing=5e-4, material='soft' /
&solid region=-0.009,0.006, -1,1, -1,1, leave='remove' /
&output dump_every=7e-5 /
"""


def test_what_leaves_can_be_taken_out(tmp_path):
    """The chip is gone, for neighbours and air, and a restart in between gives the same bytes.

    With it goes the energy that the start in still air and its drag leave: of 1.2 %, 0.7 %, 0.5 %
    of it with 2, 4, 8 cells across the chip at 50 us."""
    (tmp_path / "chip.nml").write_text(CHIP)
    done = run("run", "chip.nml", cwd=tmp_path)
    assert "they are taken out" in done.stderr
    out = tmp_path / "out" / "chip"
    energy = history(out / "energy.csv")
    bodies = history(out / "bodies.csv")
    removed = energy["removed[kg]"]
    assert removed[0] == 0 and removed[len(removed) * 2 // 3] > 0
    assert abs(removed[-1] / bodies["chip:mass[kg]"][0] - 1) < 1e-12
    assert 0.99 < energy["removed[J]"][-1] / bodies["chip:kinetic[J]"][0] < 1
    assert abs(energy["error[-]"]).max() < 1e-3
    assert abs(energy["mass_error[-]"]).max() < 1e-12
    assert bodies["chip:kinetic[J]"][-1] == bodies["chip:kinetic[J]"][-2]
    with h5py.File(sorted(out.glob("solid_*.vtkhdf"))[-1]) as dump:
        assert (dump["VTKHDF/PointData/fixed"][:] == 2).sum() == 6 * 8 * 8
    for steps in (80, 120):
        run(
            "run",
            "chip.nml",
            "--out",
            f"half{steps}",
            "--set",
            f"run.max_steps={steps}",
            cwd=tmp_path,
        )
        run("run", "chip.nml", "--out", f"half{steps}", "--restart", "latest", cwd=tmp_path)
        assert tables(tmp_path / f"half{steps}") == tables(out)


def test_what_is_outside_from_the_start_stays(tmp_path):
    deck = CHIP.replace("region=-0.009,0.006", "region=-0.009,0.002")
    (tmp_path / "chip.nml").write_text(deck)
    done = run("run", "chip.nml", "--set", "run.max_steps=1", cwd=tmp_path)
    assert "outside from the start stays, and later ones are taken out" in done.stderr
