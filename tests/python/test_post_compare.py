# SPDX-License-Identifier: MIT
"""Several runs side by side: tables, overlays, decks, damage in one scale, cracks counted."""

import shutil
import sys
from pathlib import Path

import h5py
import matplotlib
import numpy as np
import pytest

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parents[1]), str(HERE)]

from synthetic_run import write_run  # noqa: E402

from post.__main__ import main  # noqa: E402
from post.comparison import crack_table  # noqa: E402
from post.cracks import crossings, radial_cracks, rings_of  # noqa: E402
from post.deck import Body, Deck  # noqa: E402
from post.deck_difference import deck_table  # noqa: E402
from post.errors import PostError  # noqa: E402
from post.face import FaceMap  # noqa: E402
from post.overlay import common_time, compare_faces, damaged_bodies, history_panels  # noqa: E402
from post.reader import Run  # noqa: E402
from post.side_by_side import body_speed, name_runs, summary_table  # noqa: E402
from post.units import base_of, factor_of  # noqa: E402


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    """A run, and one without symmetry and with twice its energies and displacements."""
    path = tmp_path_factory.mktemp("runs")
    one = write_run(path / "one", nx=4, frames=3, rows=200, spacing=0.0125)
    two = Path(shutil.copytree(one, path / "two"))
    for deck in two.glob("*.echo.nml"):
        text = deck.read_text().replace("  symmetry = 'x', 'y'\n", "")
        deck.write_text(text.replace("mass = 0.168", "mass = 0.2"))
    twice = {"gauges.csv": "mid:displacement_z", "energy.csv": "solid_kinetic"}
    for name, column in twice.items():
        lines = (two / name).read_text().splitlines()
        place = next(i for i, head in enumerate(lines[0].split(",")) if head.startswith(column))
        rows = [line.split(",") for line in lines[1:]]
        for row in rows:
            row[place] = f"{2 * float(row[place]):.16e}"
        (two / name).write_text("\n".join([lines[0], *map(",".join, rows)]) + "\n")
    return [one, two]


@pytest.fixture(scope="module")
def runs(folders):
    return [Run(folder) for folder in folders]


# --- tables ---------------------------------------------------------------------------------------


def test_one_table_for_all(runs):
    table = summary_table(runs)
    assert table.heads == ("quantity", "one", "two")
    rows = {row[0]: row[1:] for row in table.rows}
    assert rows["displacement z of mid, largest"][0].startswith("-9.60 mm at ")
    assert rows["displacement z of mid, largest"][1].startswith("-19.2 mm at ")
    kinetic = [run.energy["solid_kinetic"].max() for run in runs]
    whole = (4 * kinetic[0], kinetic[1])  # the first is a quarter of its scene, the second is all
    assert [text.split(" at ")[0] for text in rows["kinetic energy of the bodies, largest"]] == [
        f"{value:.0f} J" for value in whole
    ]
    assert rows["modelled part"] == ("1/4", "–")
    assert rows["peak overpressure at A"][0] == rows["peak overpressure at A"][1]
    assert rows["artificial viscosity of the bodies, share"][0] == "2.1 %"
    assert rows["energy not accounted for"] == ("3.0e-13", "3.0e-13")


def test_names_of_runs_tell_them_apart(tmp_path, runs):
    for place in ("a/out", "b/out"):
        shutil.copytree(runs[0].folder, tmp_path / place)
    found = name_runs([Run(tmp_path / "a/out"), Run(tmp_path / "b/out")])
    assert found == ["a/out", "b/out"]
    assert name_runs([runs[0], runs[0]])[1].endswith("(2)")


def test_decks_differ_where_they_differ(runs):
    rows = {row[0]: row[1:] for row in deck_table([r.deck for r in runs], ["a", "b"]).rows}
    assert rows == {"run.symmetry": ("x, y", "–"), "charge(tnt).mass": ("0.168", "0.2")}


def test_groups_that_one_deck_lacks_take_one_row():
    one = Deck("&run t_end = 1 /\n&body id = 'a', spacing = 1e-3, material = 'm' /")
    two = Deck(
        "&run t_end = 2 /\n&body id = 'a', spacing = 2e-3, material = 'm' /\n"
        "&body id = 'b', spacing = 1e-3, material = 'm' /"
    )
    assert deck_table([one, two], ["a", "b"]).rows == [
        ("run.t_end", "1", "2"),
        ("body(a).spacing", "0.001", "0.002"),
        ("&body(b)", "–", "yes"),
    ]


def test_speed_of_a_body(runs):
    speed = body_speed(runs[0], "plate")
    np.testing.assert_allclose(speed, np.abs(runs[0].bodies["plate:velocity_z"]))
    assert body_speed(runs[0], "ball") is None


# --- overlays -------------------------------------------------------------------------------------


def test_panels_hold_what_the_runs_share(runs):
    panels = {panel.title: panel for panel in history_panels(runs)}
    one, two = panels["mid: displacement along z"].curves
    np.testing.assert_allclose(two[1], 2 * one[1])
    one, two = panels["Kinetic energy of the bodies, whole"].curves
    np.testing.assert_allclose(one[1], 2 * two[1])  # 4 quarters beside twice a whole
    assert "A: pressure" in panels and panels["A: pressure"].unit == "Pa"
    assert not any("x, whole" in title for title in panels)  # nothing there, or it cancels


def test_faces_at_one_time_in_one_scale(runs):
    assert common_time(runs) == pytest.approx(0.45e-3)
    maps = compare_faces(runs, "plate", time=2.2e-4)
    assert [one.face for one in maps] == ["z-", "z+", "z-", "z+"]
    assert {one.time for one in maps} == {2.25e-4}
    assert maps[0].extent == pytest.approx([-125, 125, -125, 125])
    assert maps[2].extent == pytest.approx([0, 125, 0, 125], abs=1e-5)
    assert damaged_bodies(runs) == ["plate"]
    with pytest.raises(PostError, match=r"no.* body 'wall'"):
        compare_faces(runs, "wall")
    with pytest.raises(PostError, match=r"end at 0\.00045 s"):
        common_time(runs, 1.0)


# --- cracks ---------------------------------------------------------------------------------------


def star(rays, half=0.5, step=0.005, width=0.009, turn=0.1):
    """A face with straight cracks from the middle outwards."""
    count = round(2 * half / step)
    x = (np.arange(count) + 0.5) * step - half
    x, y = np.meshgrid(x, x, indexing="ij")
    values = np.zeros((count, count))
    for angle in turn + 2 * np.pi * np.arange(rays) / rays:
        along, across = x * np.cos(angle) + y * np.sin(angle), y * np.cos(angle) - x * np.sin(angle)
        values[(along > 0) & (np.abs(across) < width / 2)] = 1.0
    body = Body("slab", 1, "box", np.zeros(3), np.ones(3), step)
    return FaceMap(body, "z+", "damage", "-", 0.0, values, np.full(2, -half), np.full(2, step))


@pytest.mark.parametrize("rays", [0, 1, 6, 14])
@pytest.mark.parametrize("turn", [0.0, 0.1, 0.77])
def test_cracks_of_a_star_are_counted(rays, turn):
    face = star(rays, turn=turn)
    rings = rings_of(face)
    assert rings[[0, -1]] == pytest.approx([0.15, 0.4])
    assert radial_cracks(face, rings).tolist() == [rays] * len(rings)


def test_a_ring_that_leaves_the_face_counts_nothing():
    assert crossings(star(6), 0.6) == 0
    assert crossings(star(6), 0.2, centre=(0.4, 0.0)) == 0


def test_what_is_cracked_all_around_is_no_crack():
    face = star(6)
    face.values[...] = 1.0
    assert crossings(face, 0.3) == 0


def test_table_of_cracks(runs, monkeypatch):
    faces = [star(6), star(4), star(14), star(0)]
    monkeypatch.setattr("post.comparison.compare_faces", lambda *args, **kwargs: faces)
    table = crack_table(runs, ["one", "two"], "plate")
    assert table.rows[:2] == [
        ("radial, face at low", "6 (6 to 6)", "14 (14 to 14)"),
        ("radial, face at high", "4 (4 to 4)", "0 (0 to 0)"),
    ]


# --- the command ----------------------------------------------------------------------------------


@pytest.fixture
def quick(monkeypatch):
    monkeypatch.setitem(matplotlib.rcParams, "savefig.dpi", 40)


def test_the_command_writes_one_page(folders, tmp_path, capsys, quick):
    out = tmp_path / "new" / "page"
    assert main(["compare", *map(str, folders), "--out", str(out)]) == 0
    text = capsys.readouterr().out
    for part in ("Runs side by side", "Differences of the decks", "Cracks of plate"):
        assert part in text
    page = (out / "compare.html").read_text()
    assert page.count("data:image/png;base64,") == len(list(out.glob("*.png"))) >= 3
    assert (out / "face_plate.png").is_file()


def test_the_command_refuses(folders, tmp_path, capsys, quick):
    one, two = map(str, folders)
    out = ["--out", str(tmp_path)]
    assert main(["compare", one, *out]) == 2
    assert main(["compare", one, str(tmp_path / "none"), *out]) == 2
    assert main(["compare", one, two, "--body", "wall", *out]) == 2
    assert main(["compare", one, two, "--time", "9", *out]) == 2
    err = capsys.readouterr().err
    assert err.count("\n") == 4 and "no body 'wall'" in err.replace("none of the runs has a", "no")


def test_a_damaged_dump_is_told(folders, tmp_path, capsys, quick):
    broken = Path(shutil.copytree(folders[1], tmp_path / "broken"))
    (broken / "solid_00001.vtkhdf").write_bytes(bytes(1000))
    assert main(["compare", str(folders[0]), str(broken), "--out", str(tmp_path / "page")]) == 4
    assert "broken: " in capsys.readouterr().out


def test_values_that_are_not_finite_are_told(folders, tmp_path, capsys, quick):
    broken = Path(shutil.copytree(folders[1], tmp_path / "broken"))
    with h5py.File(broken / "solid_00002.vtkhdf", "a") as file:
        file["VTKHDF/PointData/damage"][:4] = np.nan
    assert main(["compare", str(folders[0]), str(broken), "--out", str(tmp_path / "page")]) == 3
    assert "'damage' is not finite" in capsys.readouterr().out


def test_units_of_references():
    """Prefixes in front of every part; kilograms, hertz and what has none are SI already."""
    one = {
        "kPa ms": 1.0,
        "MPa": 1e6,
        "g": 1e-3,
        "kg": 1.0,
        "mm": 1e-3,
        "%": 0.01,
        "us": 1e-6,
        "-": 1.0,
    }
    assert {unit: factor_of(unit) for unit in one} == pytest.approx(one)
    assert [base_of(unit) for unit in ("kPa ms", "g", "km/s", "%")] == ["Pa s", "kg", "m/s", "-"]
    with pytest.raises(ValueError, match="unknown unit 'furlong'"):
        factor_of("furlong")
