# SPDX-License-Identifier: MIT
"""The reader, the measurements, the pictures and the report, on made-up runs."""

import math
import re
import sys
from pathlib import Path

import h5py
import matplotlib.image
import numpy as np
import pytest

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parents[1]), str(HERE)]

from synthetic_run import begin, write_run  # noqa: E402

from post import rendering  # noqa: E402
from post.__main__ import main  # noqa: E402
from post.compare import compare, read_references  # noqa: E402
from post.errors import PostError  # noqa: E402
from post.gauges import expect, list_gauges, measure  # noqa: E402
from post.reader import Run  # noqa: E402
from post.space import choose_cut, magnification_for, whole_air  # noqa: E402
from post.units import base_of, factor_of, show  # noqa: E402


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return Run(write_run(tmp_path_factory.mktemp("run"), rows=3000))


# --- the reader ------------------------------------------------------------------------------


def test_reader_gives_the_scene(run):
    assert run.job == "demo" and run.deck.title == "Synthetic blast on a plate"
    assert run.deck.mirrors == (True, True, False) and run.deck.images == 4
    assert [g["id"] for g in run.deck.groups("gauge")] == ["A", "free", "mid", "mid_v"]
    (plate,) = run.deck.bodies()
    assert plate.id == "plate" and plate.high[0] == 0.125
    assert run.problems == [] and run.exit_code == 0
    assert run.end == pytest.approx(0.45e-3)


def test_reader_gives_histories_with_units(run):
    assert run.gauges.unit("A:pressure") == "Pa"
    assert run.gauges["A:pressure"].shape == run.gauges.time.shape == (3000,)
    assert run.energy.unit("air_outflow[kg]") == "kg"
    assert run.energy.find("air_outflow.*") == ["air_outflow[J]", "air_outflow[kg]"]
    assert run.bodies.owners() == ["plate"]
    with pytest.raises(PostError, match="no column 'B:pressure'; it has time, A:pressure"):
        run.gauges["B:pressure"]


def test_reader_gives_frames(run):
    assert [frame.number for frame in run.frames] == list(range(7))
    air = run.frames[3].air("pressure", "solid")
    assert air.field["pressure"].shape == tuple(air.cells[::-1])
    assert air.centres(0)[0] == pytest.approx(0.0056)
    solid = run.frames[-1].solid()
    assert solid.points.shape == solid.field["displacement"].shape
    assert run.frames[0].mesh("air").n_cells == np.prod(air.cells)
    assert run.frames[0].mesh("solid").n_points == len(solid.points)
    with pytest.raises(PostError, match="no field soot; it has"):
        run.frames[0].air("soot")


def write_small(folder, **options):
    return write_run(folder, **{"nx": 4, "frames": 2, "rows": 30, "spacing": 0.0125, **options})


def test_reader_names_what_is_missing(tmp_path):
    with pytest.raises(PostError, match="no such folder") as error:
        Run(tmp_path / "nowhere")
    assert error.value.code == 2
    with pytest.raises(PostError, match="no results") as error:
        Run(tmp_path)
    assert error.value.code == 4
    folder = write_small(tmp_path / "a")
    (folder / "gauges.csv").unlink()
    assert "gauges.csv is missing" in Run(folder).problems
    (folder / "air_00001.vtkhdf").unlink()
    with pytest.raises(PostError, match=r"air_00001\.vtkhdf, which is missing"):
        Run(folder)


def test_reader_takes_the_deck_from_a_dump(tmp_path):
    folder = write_small(tmp_path / "a")
    (folder / "demo.echo.nml").unlink()
    assert Run(folder).deck.title == "Synthetic blast on a plate"


def test_reader_refuses_other_layouts_and_damage(tmp_path):
    folder = write_small(tmp_path / "a")
    with h5py.File(folder / "solid_00001.vtkhdf", "a") as file:
        file["brisance"].attrs["schema"] = [99]
    with pytest.raises(PostError, match="has layout 99") as error:
        Run(folder)
    assert error.value.code == 4
    for path in folder.glob("*.vtkhdf"):
        path.write_bytes(b"not HDF5")
    with pytest.raises(PostError, match="damaged or not HDF5"):
        Run(folder)


def test_reader_reports_what_is_not_finite(tmp_path):
    folder = write_small(tmp_path / "a")
    with h5py.File(folder / "air_00001.vtkhdf", "a") as file:
        file["VTKHDF/CellData/pressure"][0, 0, 0] = np.nan
    text = (folder / "energy.csv").read_text().splitlines()
    cells = text[7].split(",")
    cells[text[0].split(",").index("solid_kinetic[J]")] = "NaN"
    text[7] = ",".join(cells)
    (folder / "energy.csv").write_text("\n".join(text) + "\n1e-3,2.0")  # and a row cut short
    run = Run(folder)
    assert run.exit_code == 3 and len(run.energy) == 30
    assert any("'solid_kinetic' is not finite" in text for text in run.problems)
    assert any("air_00001.vtkhdf: 'pressure' is not finite" in text for text in run.problems)


def test_a_run_along_the_radius_lacks_nothing(tmp_path):
    (tmp_path / "r.echo.nml").write_text(
        "&run t_end = 1e-3 /\n&air geometry = 'spherical' /\n&gauge id = 'A', at = 0.4, 0, 0 /\n"
    )
    (tmp_path / "gauges.csv").write_text("time[s],A:pressure[Pa]\n0,1e5\n1e-3,1e5\n")
    assert Run(tmp_path).problems == []


def test_reader_says_that_a_run_ended_early(tmp_path):
    folder = write_small(tmp_path / "a")
    deck = folder / "demo.echo.nml"
    deck.write_text(deck.read_text().replace("t_end = 0.00045", "t_end = 0.001"))
    assert any("before t_end = 0.001 s" in text for text in Run(folder).problems)


# --- gauges and what theory expects ------------------------------------------------------------


def test_gauge_on_the_plate_gets_reflected_values(run):
    gauge = list_gauges(run)[0]
    expected = expect(run.deck, gauge)
    assert expected.reflected and expected.distance == pytest.approx(0.4)
    assert expected.peak == pytest.approx(12.2e6, rel=0.01)
    assert expected.blast.arrival == pytest.approx(0.1625e-3, rel=0.001)
    assert expected.impulse == pytest.approx(474, rel=0.002)
    assert measure(run, gauge).peak == pytest.approx(6.8e6, rel=0.01)


def test_an_overpressure_is_measured_as_its_pressure(tmp_path):
    folder = write_small(tmp_path / "a", rows=300)
    file, deck = folder / "gauges.csv", folder / "demo.echo.nml"
    whole = Run(folder)
    gauge = list_gauges(whole)[0]
    head, *rows = file.read_text().splitlines()
    ambient = whole.deck.ambient
    cells = [[float(cell) for cell in row.split(",")] for row in rows]
    over = [",".join(repr(x - ambient * (k == 1)) for k, x in enumerate(row)) for row in cells]
    file.write_text("\n".join([head.replace("pressure", "overpressure", 1), *over]) + "\n")
    deck.write_text(deck.read_text().replace("'pressure'", "'overpressure'", 1))
    part = Run(folder)
    assert list_gauges(part)[0].quantity == "overpressure"
    found = measure(part, list_gauges(part)[0])
    assert found.peak == pytest.approx(measure(whole, gauge).peak)
    assert found.impulse == pytest.approx(measure(whole, gauge).impulse)


def test_gauge_in_free_air_gets_incident_values(run):
    gauge = list_gauges(run)[1]
    expected = expect(run.deck, gauge)
    assert not expected.reflected and expected.distance == pytest.approx(0.2)
    assert expected.peak == expected.blast.incident_overpressure


def test_a_cylinder_gets_the_values_of_a_sphere_of_equal_mass(run):
    deck = type(run.deck)(run.deck.text.replace("shape = 'sphere'", "shape = 'cylinder'"))
    for gauge in list_gauges(run)[:2]:
        sphere, cylinder = expect(run.deck, gauge), expect(deck, gauge)
        assert (cylinder.peak, cylinder.impulse) == (sphere.peak, sphere.impulse)
        assert cylinder.label == f"{sphere.label}, sphere of equal mass"


def test_gauge_behind_the_plate_gets_no_reference(run):
    gauge = list_gauges(run)[0]
    hidden = type(gauge)("B", "B:pressure", "pressure", "Pa", np.array([0, 0, -0.03]))
    assert expect(run.deck, hidden) is None


# --- units and references ------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("unit", "factor", "base"),
    [("MPa", 1e6, "Pa"), ("kPa ms", 1.0, "Pa s"), ("mm", 1e-3, "m"), ("g", 1e-3, "kg")]
    + [("-", 1.0, "-"), ("%", 0.01, "-"), ("m/s", 1.0, "m/s"), ("us", 1e-6, "s")],
)
def test_units(unit, factor, base):
    assert factor_of(unit) == pytest.approx(factor) and base_of(unit) == base


def test_values_are_shown_with_sensible_prefixes():
    assert show(12.23e6, "Pa") == "12.2 MPa"
    assert show(1.624e-4, "s") == "0.162 ms" and show(4.4e-6, "s", 2) == "4.4 µs"
    assert show(0.0102, "m") == "10.2 mm" and show(0.0984, "kg") == "0.0984 kg"
    assert show(math.nan, "Pa") == "–" and show(0.5, "-") == "0.500"


def test_the_references_of_the_demo_meet_their_gauges(run):
    rows = compare(run, read_references(HERE.parents[1] / "inputs" / "demo.reference.csv"))
    table = {(row.quantity, row.gauge, row.source.split(",")[0]): row for row in rows}
    row = table["peak overpressure", "A", "Chen et al."]
    assert row.reference == pytest.approx(6.2e6)
    assert row.difference == pytest.approx(row.measured / 6.2e6 - 1)
    row = table["peak displacement", "mid", "Chen et al."]
    assert row.reference == pytest.approx(0.0102) and row.measured == pytest.approx(
        0.0096, rel=1e-3
    )
    assert ("peak overpressure", "A", "Kingery-Bulmash") in table
    assert math.isnan(table["impulse", "free", "Kingery-Bulmash"].measured)  # ends too early


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a,b", ":1: the columns must be"),
        ("quantity,gauge,value,unit,source\npeak,A,1,MPa", ":2: has 4 values"),
        ("quantity,gauge,value,unit,source\nheight,A,1,MPa,x", "unknown quantity 'height'"),
        ("quantity,gauge,value,unit,source\npeak,A,1,bar,x", "unknown unit 'bar'"),
        ("quantity,gauge,value,unit,source\npeak,A,one,MPa,x", "could not convert"),
    ],
)
def test_bad_reference_files_are_refused(tmp_path, text, message):
    path = tmp_path / "x.reference.csv"
    path.write_text(text)
    with pytest.raises(PostError, match=message) as error:
        read_references(path)
    assert error.value.code == 2


# --- space -------------------------------------------------------------------------------------


def test_whole_air_is_symmetric(run):
    part = run.frames[3].air("pressure", "velocity")
    whole = whole_air(part, run.deck.mirrors)
    p = whole.field["pressure"]
    assert p.shape == (part.cells[2], 2 * part.cells[1], 2 * part.cells[0])
    np.testing.assert_array_equal(p, p[:, ::-1, ::-1])
    assert whole.low[0] == pytest.approx(-0.1344) and whole.low[2] == part.low[2]
    assert choose_cut(run.deck).normal == 1 and choose_cut(run.deck).level == 0.0


def test_mirrored_velocity_points_the_other_way(run):
    part = run.frames[0].air("velocity")
    part.field["velocity"][..., 0] = 3.0
    u = whole_air(part, (True, False, False)).field["velocity"][..., 0]
    assert (u[..., 0] == -3.0).all() and (u[..., -1] == 3.0).all()


def test_magnification_is_round_and_at_least_one():
    assert magnification_for(0.25, 4.2e-3) == 5
    assert magnification_for(0.25, 0.2) == 1 and magnification_for(0.25, 0.0) == 1


# --- pictures and the report ---------------------------------------------------------------------

PICTURES = ("blast", "sheet", "bodies", "face_plate_damage", "gauges", "motion", "energy")


@pytest.fixture(scope="module")
def report(run):
    assert main(["report", str(run.folder)]) == 0
    return run.folder


@pytest.mark.long("a scene and all of its pictures")
@pytest.mark.parametrize("name", PICTURES)
def test_pictures_show_something(report, name):
    image = matplotlib.image.imread(report / "report" / f"{name}.png")
    assert image.shape[1] >= 900
    colours = np.unique((image[::3, ::3, :3] * 15).astype(int).reshape(-1, 3), axis=0)
    assert len(colours) > 25
    assert 0.02 < (image[..., :3].min(2) < 0.97).mean() < 0.98


def test_the_plate_is_seen_whole_and_damaged(report):
    image = matplotlib.image.imread(report / "report" / "bodies.png")
    dark = (image[..., :3].max(2) < 0.6) & (image[..., 2] > image[..., 0])
    columns = np.flatnonzero(dark[:, : int(0.85 * dark.shape[1])].any(0))
    assert np.ptp(columns) > 0.6 * dark.shape[1]  # damaged rims on both sides


def test_the_page_needs_nothing_else(report):
    page = (report / "report.html").read_text()
    assert page.count("data:image/png;base64,") == len(PICTURES)
    text = re.sub(r"data:image/png;base64,[^\"]*", "", page)
    assert "<script" not in text and "http" not in text.replace("http-equiv", "")
    known = ("Synthetic blast on a plate", "Kingery-Bulmash", "Chen et al.", "&amp;charge")
    for text in (*known, "cfrp (orthotropic_ply), 2.8 mm between particles, 4 050 of them"):
        assert text in page


def test_the_terminal_shows_the_comparison(run):
    from post.report import as_text, balance_table, comparison_table  # noqa: PLC0415

    text = as_text(comparison_table(compare(run, []), None))
    line = next(row for row in text.splitlines() if "peak overpressure" in row and " A " in row)
    peak = show(measure(run, list_gauges(run)[0]).peak, "Pa")
    assert peak in ("6.79 MPa", "6.80 MPa") and peak in line
    assert "12.2 MPa" in line and "-44 %" in line
    assert "3.0e-13" in as_text(balance_table(run))


@pytest.fixture
def small_pictures(monkeypatch):
    monkeypatch.setattr("post.scene.TALL", (300, 300))
    monkeypatch.setattr("post.scene.WIDE", (300, 300))


# (make test has test_what_is_not_finite_is_told of test_post_damage.py)
@pytest.mark.slow
def test_a_broken_picture_does_not_stop_the_report(tmp_path, capsys, small_pictures):
    folder = write_small(tmp_path / "a")
    (folder / "gauges.csv").write_text("time[s],A:pressure[Pa]\n0.0,1e5\n1e-4,nan\n")
    assert main(["report", str(folder)]) == 3
    out = capsys.readouterr().out
    assert "'A:pressure' is not finite" in out and (folder / "report.html").exists()


# (make test has a report of solids alone in test_perforation.py)
@pytest.mark.slow
def test_solid_alone(tmp_path, small_pictures):
    solid = write_small(tmp_path / "solid")
    for path in [*solid.glob("air*"), solid / "gauges.csv"]:
        path.unlink()
    deck = (solid / "demo.echo.nml").read_text()
    cut = deck.index("&gauge")
    (solid / "demo.echo.nml").write_text(
        deck[: deck.index("&air")] + deck[deck.index("&mat") : cut]
    )
    assert main(["report", str(solid)]) == 0
    assert sorted(p.stem for p in (solid / "report").iterdir()) == [
        "bodies",
        "energy",
        "face_plate_damage",
        "motion",
        "sheet",
    ]


def test_air_alone(tmp_path, small_pictures):
    air = write_small(tmp_path / "air")
    for path in [*air.glob("solid*"), air / "bodies.csv"]:
        path.unlink()
    assert main(["report", str(air)]) == 0
    assert not (air / "report" / "bodies.png").exists()


def test_a_plane_scene_is_drawn_as_it_is(tmp_path):
    folder = write_small(tmp_path / "a")
    for path in [*folder.glob("solid*"), *folder.glob("air_*"), folder / "air.vtkhdf.series"]:
        path.unlink()
    deck = (folder / "demo.echo.nml").read_text()
    for number in (0, 1):
        about = {"deck": deck, "job": "demo", "time": number * 1e-4, "cycle": number}
        file, root = begin(folder / f"air_{number:05d}.vtkhdf", "ImageData", about)
        with file:
            root.attrs["WholeExtent"] = [0, 8, 0, 6, 0, 0]
            root.attrs["Origin"], root.attrs["Spacing"] = [0.0, 0.0, 0.5], [0.1, 0.1, 1.0]
            ramp = np.linspace(1e5, 9e5, 48, dtype="f4").reshape(1, 6, 8)
            root["CellData/pressure"] = ramp
            root["CellData/solid"] = np.zeros((1, 6, 8), "i1")
    run = Run(folder)
    cut = choose_cut(run.deck, run.frames[1].air().cells)
    assert (cut.normal, cut.across, cut.up) == (2, 0, 1)
    assert main(["frame", str(folder)]) == 0
    assert main(["frame", str(folder), "--view", "cut"]) == 0
    assert main(["frame", str(folder), "--view", "blast"]) == 4  # says that it is not rendered


def test_no_way_to_render_is_said_in_one_sentence(monkeypatch):
    monkeypatch.setattr(rendering, "TRIAL", "raise SystemExit('no library')")
    rendering.prepare.cache_clear()
    with pytest.raises(PostError, match=r"install libegl1 .*no library"):
        rendering.prepare()
    rendering.prepare.cache_clear()


def test_command_line_errors(tmp_path, capsys):
    assert main(["report", str(tmp_path / "none")]) == 2
    folder = write_small(tmp_path / "a")
    assert main(["report", str(folder), "--reference", "none.csv"]) == 2
    assert main(["frame", str(folder), "--time", "1.0"]) == 2
    assert main(["frame", str(folder), "--time", "4.5e-4", "--view", "cut"]) == 0
    assert "the run covers 0 to 0.00045 s" in capsys.readouterr().err
