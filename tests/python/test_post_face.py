# SPDX-License-Identifier: MIT
"""Maps of a field on a face: which particles they show, where, and in which unit."""

import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parents[1]), str(HERE)]

from test_post_pictures import write_scene  # noqa: E402

from post.__main__ import main  # noqa: E402
from post.errors import PostError  # noqa: E402
from post.face import draw_faces, face_map, thin_faces  # noqa: E402
from post.reader import Run  # noqa: E402


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """The slab has the damage 0.1, 0.5, 0.9 in its layers from below; stress xy = x in MPa."""
    folder = tmp_path_factory.mktemp("faces")
    write_scene(folder, rise=20.0)
    path = folder / "solid_00000.vtkhdf"
    with h5py.File(path, "a") as file:
        data = file["VTKHDF/PointData"]
        rest = file["VTKHDF/Points"][()] - data["displacement"][()]
        data["damage"][...] = np.select([rest[:, 2] < 0.01, rest[:, 2] < 0.02], [0.1, 0.5], 0.9)
        stress = np.zeros((len(rest), 6), "f4")
        stress[:, 3] = 1e6 * rest[:, 0]
        data["stress"] = stress
        data["stress"].attrs["units"] = np.bytes_("Pa")
    return Run(folder)


@pytest.mark.parametrize(("face", "damage"), [("z-", 0.1), ("z+", 0.9)])
def test_outermost_particles_of_the_whole_body(run, face, damage):
    found = face_map(run, run.frames[0], "slab", face)
    assert found.values.shape == (40, 40)  # the quarter and its images
    np.testing.assert_allclose(found.values, damage, rtol=1e-6)
    assert found.extent == pytest.approx([-200, 200, -200, 200])
    assert found.plane == (0, 1) and found.unit == "-"


def test_side_face(run):
    found = face_map(run, run.frames[0], "slab", "x+")
    assert found.values.shape == (40, 3)
    np.testing.assert_allclose(found.values[7], [0.1, 0.5, 0.9], rtol=1e-6)


def test_components_turn_over_with_the_mirror(run):
    found = face_map(run, run.frames[0], "slab", "z+", "stress:xy")
    x = (np.arange(40) - 19.5) * 0.01
    sign = np.where(x > 0, 1, -1)  # xy changes its sign over either plane
    np.testing.assert_allclose(found.values, 1e6 * np.outer(np.abs(x) * sign, sign), rtol=1e-5)
    assert found.unit == "Pa"
    moved = face_map(run, run.frames[0], "slab", "z+", "displacement")
    np.testing.assert_allclose(moved.values, 20.0 * run.frames[0].time, rtol=1e-5)


def test_bars_leave_gaps(run):
    found = face_map(run, run.frames[0], "bars", "z+")
    filled = np.isfinite(found.values)
    assert filled.sum() == 4 * 2 * 20 and filled[0].sum() == 4


def test_a_round_body_shows_its_outermost_particles(run):
    found = face_map(run, run.frames[0], "far", "z-")
    assert np.isfinite(found.values).sum() == 4 * 16  # with its images
    assert found.extent == pytest.approx([-110, 110, -110, 110])


@pytest.mark.parametrize(
    ("body", "face", "field", "text"),
    [
        ("slab", "up", "damage", "must be one of x-, x\\+"),
        ("wall", "z-", "damage", "no body 'wall'; there are slab, bars"),
        ("slab", "z-", "stress", "name a component, such as stress:xx"),
        ("slab", "z-", "stress:q", "no component 'q'; it has xx, yy"),
        ("slab", "z-", "damage:x", "no component 'x'; it has none"),
        ("slab", "z-", "soot", "no field soot"),
    ],
)
def test_refusals(run, body, face, field, text):
    with pytest.raises(PostError, match=text):
        face_map(run, run.frames[0], body, face, field)


def test_command(run, capsys):
    folder = str(run.folder)
    assert thin_faces(run, "slab") == ("z-", "z+")
    assert main(["frame", folder, "--body", "slab", "--time", "1e-4"]) == 0
    out = capsys.readouterr().out
    assert "face_slab_damage.png" in out and "z+: 100 % of the face has more than 0.5" in out
    assert "c, 10 mm between particles, at 0.100 ms" in out
    assert main(["frame", folder, "--body", "slab", "--face", "z-", "--field", "stress:xy"]) == 0
    assert (run.folder / "report" / "face_slab_z-_stress_xy.png").is_file()
    assert main(["frame", folder, "--face", "z-"]) == 2
    assert main(["frame", folder, "--body", "slab", "--time", "9"]) == 2


def test_one_scale_for_all_maps(run, tmp_path):
    maps = [face_map(run, run.frames[0], "slab", face, "stress:xy") for face in ("z-", "z+", "x+")]
    picture = draw_faces(maps, tmp_path / "maps.png")
    assert picture.path.is_file() and "0.5" not in picture.caption
