# SPDX-License-Identifier: MIT
"""The page of the paper's scenes: its numbers, ours beside them, and what was not run."""

import re
import shutil
import sys
from pathlib import Path
from types import SimpleNamespace

import matplotlib
import numpy as np
import pytest
from PIL import Image

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parents[1]), str(HERE)]

from synthetic_run import write_run  # noqa: E402

from post import paper  # noqa: E402
from post.__main__ import main  # noqa: E402
from post.deck import Deck  # noqa: E402
from post.document import Document, Heading, View, write_small  # noqa: E402
from post.errors import PostError  # noqa: E402
from post.paper import CASES, Campaign, find_runs, numbers_table, smaller  # noqa: E402
from post.paper_hand import areal_mass, launch_speed, load_on_slab  # noqa: E402
from post.paper_measures import MEASURES, impact, printed_numbers, value_of  # noqa: E402
from post.paper_tables import INPUTS, difference_table, reasons  # noqa: E402
from post.reader import Run  # noqa: E402
from post.tables import Table  # noqa: E402


@pytest.fixture(scope="module")
def campaign(tmp_path_factory):
    """A folder with one run, of the plate, and one that is no scene of the paper."""
    folder = tmp_path_factory.mktemp("campaign")
    other = write_run(folder / "other", nx=4, frames=3, rows=300, spacing=0.0042)
    plate = Path(shutil.copytree(other, folder / "plate"))
    for name in plate.glob("*.echo.nml"):
        name.rename(plate / "plate.echo.nml")
    for dump in plate.glob("*.vtkhdf"):
        rename_job(dump, "plate")
    (folder / "plate.log").write_text("wall clock 12.5 s (air 1)\nwall clock 3.5 s (air 1)\n")
    return folder


def rename_job(dump, job):
    import h5py  # noqa: PLC0415

    with h5py.File(dump, "a") as file:
        file["brisance"].attrs["job"] = job


# --- the numbers of the paper ---------------------------------------------------------------------


def test_table_of_the_paper_is_sound():
    rows = printed_numbers()
    assert {one.case for one in rows} <= set(CASES)
    assert {one.measure for one in rows} == set(MEASURES)
    assert all(CASES[one.case] == one.section for one in rows)
    late = {one.case: one.value for one in rows if one.measure == "displacement_late"}
    assert late == pytest.approx({"slab_1": 7.4e-3, "slab_2": 5.6e-3, "slab_3": 5e-3,
                                  "slab_4": 2.1e-3})  # fmt: skip
    assert all((INPUTS / f"{case}.nml").is_file() for case in CASES)


SLAB = """\
&run symmetry = 'x', 'y' /
&charge mass = 0.2, at = 0, 0, -0.4 /
&material id = 'm', density = {density} /
&body id = 'slab', shape = 'box', box = -0.5, 0.5, -0.5, 0.5, 0, 0.044, material = 'm' /
&body id = 'f0', shape = 'sphere', centre = 0, 0, -0.18, radius = 0.01, material = 'm' /
"""


def test_hand_calculations():
    """Kingery-Bulmash over a slab of 1 x 1 m under 0.2 kg at 0.4 m: 273.5 N s; 639 J of a plate of
    66 kg/m2 whose elements keep their impulse; a steel sphere of 20 mm at 0.22 m: 12.5 m/s.
    """
    light, steel = (Deck(SLAB.format(density=rho)) for rho in (1500, 7830))
    assert areal_mass(light) == pytest.approx(66)
    impulse, energy = load_on_slab(light)
    assert impulse == pytest.approx(273.5, rel=1e-3)
    assert energy == pytest.approx(639, rel=1e-3)
    assert load_on_slab(steel)[1] == pytest.approx(energy * 1500 / 7830)
    assert launch_speed(steel) == pytest.approx(12.5, rel=0.01)


def test_a_fragment_hits_when_it_slows_down(campaign):
    run = Run(campaign / "plate")
    values = 460 - 20 * np.exp(-run.gauges.time / 2e-5)
    values[run.gauges.time > 3e-4] = 120.0
    run.gauges.data["mid_v:velocity_z"][:] = values
    time, top = impact(run, "mid_v")
    assert time == pytest.approx(3e-4, abs=3e-6)
    assert top == pytest.approx(460, rel=1e-3)
    run.gauges.data["mid_v:velocity_z"][:] = 460.0
    assert np.isnan(impact(run, "mid_v")[0])


# --- ours beside them -----------------------------------------------------------------------------


def test_numbers_stand_beside_those_of_the_paper(campaign, tmp_path):
    runs, problems = find_runs([campaign])
    assert list(runs) == ["plate"] and any("no scene of inputs/paper" in text for text in problems)
    run = runs["plate"][0]
    table = numbers_table(Campaign(runs, tmp_path), printed_numbers())
    rows = {row[1]: row for row in table.rows}
    value = np.abs(run.gauges["mid:displacement_z"]).max()
    assert value_of(run, "displacement_peak") == pytest.approx(value)
    row = rows["plate: largest displacement of the middle"]
    assert row[2] == "10.2 mm" and row[3] == f"{1e3 * value:.2f} mm"
    assert "4.2 mm, cells" in row[5]
    assert rows["slab_1: displacement of the middle at 1.2 ms"][3] == "not run"
    # it ends before the deck does: no difference is given
    assert smaller(run) == "not the whole 0.500 ms" and row[4] == "–"


@pytest.mark.parametrize("case", CASES)
def test_a_run_of_the_whole_deck_is_compared(case):
    """Also of decks with bars and spheres."""
    text = (INPUTS / f"{case}.nml").read_text(encoding="utf-8")
    deck = Deck(text, case)
    run = SimpleNamespace(job=case, deck=deck, end=float(deck.get("run", "t_end")))
    assert smaller(run) == ""
    run.end *= 0.9
    assert smaller(run).startswith("not the whole")
    run.deck = Deck(text.replace(
        "box = -0.5, 0.5,  -0.5, 0.5", "box = -0.25, 0.25,  -0.25, 0.25"), case)  # fmt: skip
    if case.startswith("slab"):
        assert smaller(run) == "0.5 m wide instead of 1 m"


def test_what_differs_has_a_reason_or_says_that_none_is_known(campaign, tmp_path, monkeypatch):
    assert set(reasons()) <= {(one.case, one.measure) for one in printed_numbers()}
    runs, _ = find_runs([campaign])
    assert difference_table(Campaign(runs, tmp_path)).rows == []  # it is not all of the deck
    monkeypatch.setattr("post.paper_tables.smaller", lambda _: "")
    rows = {row[0]: row for row in difference_table(Campaign(runs, tmp_path)).rows}
    front = rows["plate: arrival at the plate"]
    assert front[1] == "0.120 ms" and front[-1] == reasons()["plate", "arrival"]
    monkeypatch.setattr("post.paper_tables.reasons", dict)
    assert difference_table(Campaign(runs, tmp_path)).rows[0][-1] == "not known"


def test_the_command_writes_both_pages(campaign, tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(matplotlib.rcParams, "savefig.dpi", 40)
    page = tmp_path / "docs" / "mine.md"
    page.parent.mkdir()
    command = ["paper", str(campaign), "--out", str(tmp_path / "out"), "--markdown", str(page)]
    assert main(command) == 0
    assert "1 runs" in capsys.readouterr().out
    html = (tmp_path / "out" / "paper.html").read_text()
    assert "srcdoc" in html and 'src="http' not in html and len(html.encode()) < 20e6
    text = page.read_text()
    assert "Not run: hvi, slab_1, slab_2, slab_3, slab_4, fragments, fragments_460." in text
    assert "16.0 s" in text  # both parts of its log
    links = re.findall(r"!\[[^\]]*\]\(([^)]+)\)", text)
    assert len(links) >= 3 and all((page.parent / link).is_file() for link in links)
    assert all(len(line) <= 120 or line.startswith("|") for line in text.splitlines())
    assert main(["paper", str(campaign / "other")]) == 2


def test_views_share_the_room_that_is_left(campaign, tmp_path, monkeypatch):
    """A page of less than so many bytes, whatever its pictures take."""
    monkeypatch.setitem(matplotlib.rcParams, "savefig.dpi", 40)
    runs, _ = find_runs([campaign])
    monkeypatch.setattr("post.paper.find_runs", lambda _: (runs, []))
    sizes = []
    for most in (2e5, 1.08e5):  # some 40 kB are kept free for what frames a view
        monkeypatch.setattr("post.paper.LARGEST", most)
        page, _ = paper.make_paper_page([campaign], tmp_path / "out", tmp_path / "page.md")
        assert "srcdoc" in page.read_text() and page.stat().st_size < most
        sizes.append(page.stat().st_size)
    assert sizes[1] < sizes[0], sizes


def test_document_in_two_forms(tmp_path):
    document = Document("Title", problems=["a <fault>"])
    document.add(Heading("Part"), "words", None, Table("empty", ("a",), []))
    document.add(Table("T", ("a", "b"), [("1|2", "3")], "note"), View("<iframe></iframe>"))
    html = document.html()
    assert "a &lt;fault&gt;" in html and "<iframe>" in html and "empty" not in html
    text = document.markdown(tmp_path / "p.md", tmp_path / "pictures")
    assert "| 1\\|2 | 3 |" in text and "iframe" not in text and "## Part" in text


@pytest.mark.parametrize("workers", [1, 3])
def test_parts_are_made_side_by_side_and_stay_in_order(workers):
    def fails():
        raise PostError("no second part")

    document = Document("Title", problems=["before"])
    document.add_made(
        [Heading("Part"), lambda: "first", fails, lambda: ["third", None, "fourth"]], workers
    )
    assert document.blocks == [Heading("Part"), "first", "third", "fourth"]
    assert document.problems == ["before", "no second part"]


def test_small_pictures_keep_rare_colours(tmp_path):
    """A thin scale of many colours beside a large picture in others."""
    x = np.linspace(0, 1, 300)
    large = np.stack(np.broadcast_arrays(200 + 55 * x[:, None], 90 + 60 * x, 40.0), 2)
    large[:4] = 255 * matplotlib.colormaps["viridis"](x)[None, :, :3]
    Image.fromarray(large.astype("u1")).save(tmp_path / "a.png")
    write_small(tmp_path / "a.png", tmp_path / "b.png")
    small = np.asarray(Image.open(tmp_path / "b.png").convert("RGB")).astype(int)
    assert np.abs(small - large).max() < 16
