# SPDX-License-Identifier: MIT
"""Intervals of exact series, verdicts, partners of decks, certificates of a formula."""

import csv
import json
import math
import sys
from pathlib import Path

import numpy as np
import pytest

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parents[1]), str(HERE)]

from post.__main__ import main  # noqa: E402
from post.certificate import certificate_table, read_certificate  # noqa: E402
from post.convergence import band_of, fit_scatter, interval, observed_order  # noqa: E402
from post.deck import Deck  # noqa: E402
from post.ensemble import scatter_of  # noqa: E402
from post.partners import by_spacing, make_plan, misfit, ratio_for  # noqa: E402

STUB = HERE / "stub_program.py"


@pytest.mark.parametrize("p", [0.7, 1.0, 1.5, 2.0])
@pytest.mark.parametrize("r", [1.48, 1.69, 2.2])
@pytest.mark.parametrize("a", [0.02, -0.02])
def test_an_exact_series_has_its_order_and_holds_the_truth(p, r, a):
    h = [1.0, r, r * r * 1.02]  # whole layers never give one ratio twice
    f = [1 + a * x**p for x in h]
    found = interval(h, f, 1.0)
    assert observed_order(h, f) == pytest.approx(p, abs=1e-6)
    assert found.promised and found.low <= 1 <= found.high
    assert found.verdict == (f"order {p:.1f}, taken as 1" if found.order > 1 else f"order {p:.1f}")
    assert abs(found.best - 1) < abs(f[0] - 1)


def test_the_interval_by_hand():
    """1.00, 1.02, 1.06 at 1, 1.5, 2.25: order 1.71; both differences leave 0.04, twice that."""
    found = interval([1, 1.5, 2.25], [1.0, 1.02, 1.06], 1.0)
    assert found.order == pytest.approx(math.log(2) / math.log(1.5), abs=1e-9)
    assert found.half == pytest.approx(2 * max(0.02 / 0.5, 0.04 / 0.5 / 1.5))
    assert found.best == pytest.approx(1.0 - 0.5 * 0.02 / 0.5)
    two = interval([1, 1.5], [1.0, 1.02], 1.0)
    assert two.half == pytest.approx(3 * 0.02 / 0.5) and not two.promised


@pytest.mark.parametrize(
    ("f", "verdict", "promised", "half"),
    [
        ([1.0, 1.001, 1.002], "converged", True, 0.005),
        ([1.0, 1.02, 0.97], "oscillates, settling", True, 0.05 / 0.75),
        ([1.0, 1.03, 1.02], "oscillates", True, 2 * 0.03 / 0.5),
        ([1.0, 1.05, 1.07], "not converging", False, 3 * 0.05 / 0.5),
        ([1.0, 1.5, 1.9], "too coarse", False, 3 * 0.5 / 0.5),
    ],
)
def test_verdicts(f, verdict, promised, half):
    found = interval([1.0, 1.5, 2.25], f, 1.0)
    assert (found.verdict, found.promised) == (verdict, promised)
    assert found.half == pytest.approx(half)


def test_a_fourth_level_adds_its_scatter():
    """On a fit nothing is added; off all of them at most what a straight line leaves."""
    h = [1.0, 1.5, 2.25, 3.375]
    for series in (lambda x: 1 + 0.1 * x**0.8, lambda x: 1 + 0.1 * x - 0.02 * x**2):
        f = [series(x) for x in h]
        assert fit_scatter(h, f) < 1e-4 * f[0]
        assert interval(h, f, 1.0).half == pytest.approx(interval(h[:3], f[:3], 1.0).half, rel=1e-2)
    f = [1.0, 1.02, 0.97, 1.05]
    one, three = interval(h, f, 1.0), interval(h[:3], f[:3], 1.0)
    assert one.half == pytest.approx(three.half + fit_scatter(h, f)) and one.promised
    weight = 1 / np.array(h) / np.sum(1 / np.array(h))
    columns = np.stack([np.ones(4), h], axis=1)
    normal = columns.T @ (weight[:, None] * columns)
    rest = columns @ np.linalg.solve(normal, columns.T @ (weight * f)) - f
    assert 0 < fit_scatter(h, f) <= math.sqrt(4 * float(weight @ rest**2) / 2) + 1e-12


def test_numbers_of_levels_that_are_refused():
    for h, f in (([1.0], [1.0]), ([1.0, 0.9], [1, 1]), ([1, 2, 3], [1, 1])):
        with pytest.raises(ValueError, match="two to four levels"):
            interval(h, f, 1.0)


def test_the_band_of_a_shock_holds_the_truth():
    """Fronts that are late and smeared with the spacing, before a decay: exact at no spacing."""
    t = np.linspace(0, 1, 600)

    def history(h):
        front = 0.4 + 0.02 * h
        decay = np.exp(-3 * np.clip(t - front, 0, None)) * (1 - 0.05 * h)
        return decay / (1 + np.exp(-(t - front) / (0.004 * h + 1e-3)))

    h = [1.0, 1.5, 2.25]
    band = band_of(h, [(t, history(x)) for x in h])
    truth = np.interp(band.time, t, history(0.0))
    inside = (truth >= band.low - 1e-12) & (truth <= band.high + 1e-12)
    assert inside.mean() > 0.97 and band.low.min() >= -1e-9  # no suction that nobody has
    assert band.low[band.time < 0.3].max() < 1e-6 and np.median(band.high - band.low) < 0.15
    at, late = band.arrival
    assert abs(at - 0.4) <= late


# --- partners -----------------------------------------------------------------------------------

PLATE = """&run t_end = 1e-3, dimension = {d} /
&material id = 'm', model = 'bilinear_j2' /
&body id = 'plate', box = 0, 0.1, 0, 0.012, 0, 1, spacing = {h}, material = 'm', fix = 'x-' /
{more}
"""


def plan_of(layers, d=2, more="", **options):
    return make_plan(Deck(PLATE.format(d=d, h=0.012 / layers, more=more)), **options)


@pytest.mark.parametrize(
    ("layers", "numbers"),
    [(12, [12, 7, 4]), (8, [8, 5, 3]), (7, [7, 4, 3]), (6, [6, 4, 3]), (5, [5, 4, 3]), (4, [4, 3])],
)
def test_levels_of_layers(layers, numbers):
    plan = plan_of(layers)
    assert [level.numbers[0] for level in plan.levels] == numbers and not plan.refusal
    widths = [level.width for level in plan.levels]
    assert widths == pytest.approx([layers / n for n in numbers])
    assert f"body(plate).spacing={0.012 / numbers[1]!r}" in plan.levels[1].sets
    fixed = f"body(plate).fix_width={3 * (0.012 / layers)!r}"  # three layers of the user
    assert all(fixed in level.sets for level in plan.levels)


def test_four_levels_share_the_budget():
    plan = plan_of(24, most=4)
    assert [level.numbers[0] for level in plan.levels] == [24, 14, 8, 5]
    assert plan.extra == pytest.approx(0.25, abs=0.03)
    assert [level.numbers[0] for level in plan_of(5, most=4).levels] == [5, 4, 3]


def test_three_layers_have_no_coarser_partner():
    plan = plan_of(3)
    assert len(plan.levels) == 1
    assert "--finer (a partner of 5 layers, 4.6 times" in plan.refusal
    assert "--hold plate" in plan.refusal
    finer = plan_of(3, finer=True)
    assert [level.numbers[0] for level in finer.levels] == [5, 3] and finer.levels[1].width == 1
    assert "two levels only" in finer.notes[0]
    held = plan_of(3, hold=("plate",), more="&air box=0,1,0,1,0,1, cells=60,60,1 /")
    assert [level.numbers for level in held.levels] == [(60,), (36,), (21,)] or held.levels
    assert held.scarce.name == "air.cells" and "'plate' keeps its spacing" in held.notes[0]


def test_the_budget_is_what_partners_cost():
    for d, ratio in ((1, 2.20), (2, 1.69), (3, 1.48)):
        assert ratio_for(d) == pytest.approx(ratio, abs=0.005)
        x = ratio_for(d, 0.4) ** -(d + 1)
        assert x + x * x == pytest.approx(0.4)


def test_cells_follow_the_layers_and_faces_fit_them():
    air = "&air box=-0.1,0.2,-0.012,0.024,0,1, cells=360,36,1 /"
    plan = plan_of(12, more=air)
    assert plan.scarce.owner == "plate"
    for level in plan.levels[1:]:
        cells = level.numbers[0]
        deck = Deck(PLATE.format(d=2, h=1e-3, more=air))
        assert misfit(deck, cells)[0] < 0.1  # partners keep faces on faces of cells
        text = next(s for s in level.sets if s.startswith("air.cells="))
        assert text == f"air.cells={10 * cells},{cells},1"
    crooked = plan_of(12, more=air.replace("-0.012", "-0.0123"))
    assert any("lies" in note and "'plate'" in note for note in crooked.notes)


def test_materials_that_break_by_their_spacing():
    deck = PLATE.replace("'bilinear_j2'", "'bilinear_j2', failure_strain = 0.2 {gf}")
    assert by_spacing(Deck(deck.format(d=2, h=1e-3, more="", gf=""))) == {
        "plate": "its particles fail at a strain"
    }
    assert by_spacing(Deck(deck.format(d=2, h=1e-3, more="", gf=", gf = 1e5"))) == {}
    none = deck.replace("{gf}", ", failure = 'none'")
    assert by_spacing(Deck(none.format(d=2, h=1e-3, more=""))) == {}


# --- the command --------------------------------------------------------------------------------

SCENE = "&run t_end = 1 {more} /\n&air box = 0,1,0,1,0,1, cells = {n},1,1 /\n"
PEAK = "mid:displacement_y peak"


@pytest.fixture
def room(tmp_path, monkeypatch):
    """A folder with a scene; `certify(more, ...)` runs the command on it."""
    monkeypatch.setenv("BRISANCE", str(STUB))
    monkeypatch.setenv("STUB_LOG", str(tmp_path / "begun.txt"))

    def certify(*more, n=100, keys=""):
        (tmp_path / "a.nml").write_text(SCENE.format(n=n, more=keys))
        return main(["certify", str(tmp_path / "a.nml"), "--out", str(tmp_path / "o"), *more])

    return certify


def test_a_certificate(room, tmp_path, capsys):
    """100 cells: 1.01 of 1; partners of 46 and 21 cells; the truth lies inside."""
    assert room("--results", PEAK, "--want", "2%") == 0
    told = capsys.readouterr().out
    assert "100 > 46 > 21" in told and "For 2 %" in told
    with (tmp_path / "o" / "certify.csv").open() as file:
        row = next(r for r in csv.DictReader(file) if r["result"] == PEAK)
    assert float(row["low"]) < -1 < float(row["high"]) and row["promised"] == "yes"
    assert float(row["order"]) == pytest.approx(1, abs=0.01)
    assert float(row["best"]) == pytest.approx(-1.005, abs=1e-3)  # half of the way
    made = json.loads((tmp_path / "o" / "certify.json").read_text())
    assert [level["numbers"]["air.cells"] for level in made["levels"]] == [100, 46, 21]
    page = (tmp_path / "o" / "certify.html").read_text()
    for title in ("Error against seconds", "Histories with bands", "Intervals", "Levels"):
        assert title in page
    assert room() == 0 and len((tmp_path / "begun.txt").read_text().splitlines()) == 3


def test_a_certificate_of_four_levels(room, tmp_path, capsys):
    assert room("--results", PEAK, "--levels", "4") == 0
    assert "100 > 45 > 20 > 9" in capsys.readouterr().out
    with (tmp_path / "o" / "certify.csv").open() as file:
        row = next(r for r in csv.DictReader(file) if r["result"] == PEAK)
    assert float(row["f4"]) < float(row["f1"]) and row["promised"] == "yes"
    assert float(row["low"]) < -1 < float(row["high"])


def test_an_ensemble_by_the_command(room, tmp_path, capsys):
    """Members 1 to 4 are 1 + seed/1000 as large, at 100 cells and at 46; they run once."""
    assert room("--results", PEAK, "--ensemble", "4") == 0
    assert "Ensemble" in capsys.readouterr().out
    made = json.loads((tmp_path / "o" / "certify.json").read_text())
    found, alone = made["ensemble"][PEAK], abs(made["results"][PEAK]["value"])
    assert found["members"] == 4 and found["mean"] == pytest.approx(-1.0025 * alone)
    assert found["deviation"] == pytest.approx(1e-3 * alone * np.std([1, 2, 3, 4], ddof=1))
    assert "Ensemble" in (tmp_path / "o" / "certify.html").read_text()
    assert room("--results", PEAK, "--ensemble", "4") == 0
    assert len((tmp_path / "begun.txt").read_text().splitlines()) == 3 + 8


def test_the_report_takes_a_certificate_from_the_folder_of_a_run(room, tmp_path):
    room()
    run = tmp_path / "run"
    run.mkdir()
    (tmp_path / "o").rename(run / "certify")
    assert read_certificate(run)[PEAK]["promised"]
    rows = {row[0]: row[1] for row in certificate_table(run).rows}
    assert "±" in rows[PEAK] and certificate_table(tmp_path).rows == []


def test_partners_that_fail_are_named(room, capsys):
    assert room(keys=", fail = 30") == 3
    told = capsys.readouterr().out
    assert "the level 21 has no results: the energy is out of its band" in told
    assert "two levels only" in told
    assert room(keys=", fail = 60") == 3
    assert "the level 46 has no results" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("more", "word"),
    [
        (["--results", "nothing"], "there is no result 'nothing'; this deck gives mid:"),
        (["--budget", "much"], "--budget much: must be a share"),
        (["--set", "run.z=1"], "unknown key z"),
        (["--brisance", "no/program"], "no/program: there is no such program"),
        (["--fine", "nowhere"], "nowhere"),
    ],
)
def test_arguments_that_are_wrong(room, capsys, more, word):
    assert room(*more) == 2
    assert word in capsys.readouterr().err


def test_a_result_that_is_asked_for_and_not_promised(room, capsys):
    """With two levels alone nothing is: code 1."""
    assert room("--results", PEAK, n=5) == 1
    assert "two levels only" in capsys.readouterr().out


def test_a_scene_that_cannot_be_coarser(room, capsys):
    assert room(n=4) == 2
    assert "no coarser partner" in capsys.readouterr().err


def test_an_ensemble_by_hand():
    """Means 10 and 10.6 at 1 and 1.5; deviation 1; t of 3 degrees of freedom is 2.353."""
    found = scatter_of([9, 10, 11, 10], [10.6, 10.6], 1.5)
    s = math.sqrt(2 / 3)
    assert (found.mean, found.deviation) == pytest.approx((10, s))
    assert found.mean_half == pytest.approx(3 * 0.6 / 0.5 + 2.3534 * s / 2, rel=1e-4)
    assert found.one_half == pytest.approx(2.3534 * s * math.sqrt(1.25), rel=1e-4)
    with pytest.raises(ValueError, match="two members"):
        scatter_of([1.0, math.nan], [1.0, 2.0], 1.5)


# --- the promise --------------------------------------------------------------------------------


def test_the_corpus_holds_the_promise(capsys):
    """Nine in ten of the promised results hold the truth, every scene of the same weight, also with
    factors from the other scenes alone; and they are of some use.
    """
    sys.path.insert(0, str(HERE.parents[1] / "studies"))
    from corpus import cases_of, held, one_left_out, read_ladder  # noqa: PLC0415

    cases = cases_of(read_ladder())
    good = [c for c in cases if interval(c.h, c.values, c.scale).promised]
    every, by_scene, wide = held(good)
    assert len({c.scene for c in good}) >= 6 and len(good) >= 200
    assert min(every, by_scene) >= 0.9 and min(one_left_out(good)[:2]) >= 0.85
    assert len(good) >= 0.6 * len(cases) and np.median(wide) <= 0.06
