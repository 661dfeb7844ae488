# SPDX-License-Identifier: MIT
"""Studies with a formula in place of the program: points, store, limits, tables, messages."""

import csv
import fcntl
import json
import math
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np
import pyarrow.parquet as pq
import pytest

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parents[1]), str(HERE)]

from post.__main__ import main  # noqa: E402
from post.designs import Design, Parameter, points_of  # noqa: E402
from post.errors import PostError  # noqa: E402
from post.expressions import evaluate  # noqa: E402
from post.runner import Program, meaning_of  # noqa: E402
from post.study_file import read_study  # noqa: E402

STUB = HERE / "stub_program.py"
GRID = """[study]
deck = "a.nml"
results = ["mid:displacement_y peak"]
[parameter.x]
values = [1, 2, 3]
unit = "mm"
set = {{"run.x" = "x*1000"}}
[parameter.y]
values = [1, 10]
set = ["run.y"]
[slots]
jobs = {jobs}
"""
DECK = "&run t_end = 1 {more} /\n"


@pytest.fixture
def page():
    """The page of the study is drawn."""


@pytest.fixture
def room(tmp_path, monkeypatch, request):
    """A folder with a deck; `study(text)` runs one, `begun()` tells the runs that were begun.

    Pages are drawn for tests that are marked `usefixtures("page")` alone.
    """
    if "page" not in request.fixturenames:
        monkeypatch.setattr("post.study_page.make_study_page", lambda *_: (tmp_path, ""))
    monkeypatch.setenv("BRISANCE", str(STUB))
    monkeypatch.setenv("STUB_LOG", str(tmp_path / "begun.txt"))
    (tmp_path / "a.nml").write_text(DECK.format(more=""))

    class Room:
        folder = tmp_path

        def study(self, text, *more):
            (tmp_path / "s.toml").write_text(text)
            return main(["study", str(tmp_path / "s.toml"), "--out", str(tmp_path / "o"), *more])

        def begun(self):
            path = tmp_path / "begun.txt"
            return len(path.read_text().splitlines()) if path.is_file() else 0

        def rows(self, name="study.csv"):
            with (tmp_path / "o" / name).open() as file:
                return list(csv.DictReader(file))

    return Room()


# --- points, formulas, files --------------------------------------------------------------------


def test_distributions_have_their_medians_and_ends():
    share = np.array([0.1587, 0.5, 0.8413])
    normal = Parameter("n", law="normal", numbers=(10.0, 2.0)).quantile(share)
    assert normal == pytest.approx([8, 10, 12], abs=1e-3)
    logs = Parameter("l", law="lognormal", numbers=(10.0, 0.2)).quantile(share)
    assert logs[1] == pytest.approx(10) and logs[2] / 10 == pytest.approx(
        math.exp(math.sqrt(math.log(1.04))), rel=1e-4
    )
    tri = Parameter("t", law="triangular", numbers=(0.0, 1.0, 2.0)).quantile(np.array([0, 0.5, 1]))
    assert tri == pytest.approx([0, 1, 2])
    weibull = Parameter("w", law="weibull", numbers=(3.0, 2.0)).quantile(np.array(1 - 1 / math.e))
    assert weibull == pytest.approx(3)


@pytest.mark.parametrize("kind", ["lhs", "sobol"])
def test_random_points_fill_every_range_and_are_the_same_again(kind):
    rows = [Parameter(n, law="uniform", numbers=(0.0, 1.0)) for n in "ab"]
    rows.append(Parameter("word", values=("p", "q")))
    points = points_of(rows, Design(kind, 64, 3))
    assert points == points_of(rows, Design(kind, 64, 3))
    assert points != points_of(rows, Design(kind, 64, 4))
    for name in "ab":  # one in each 64th, or in each 16th
        cells = {int(p[name] * (64 if kind == "lhs" else 16)) for p in points}
        assert len(cells) == (64 if kind == "lhs" else 16)
    assert sum(p["word"] == "p" for p in points) == 32


def test_designs_without_chance():
    rows = [Parameter("a", values=(1.0, 2.0, 3.0)), Parameter("b", values=(5.0, 6.0, 7.0))]
    assert len(points_of(rows, Design("grid"))) == 9
    assert points_of(rows, Design("list"))[2] == {"a": 3.0, "b": 7.0}
    one = points_of(rows, Design("one_at_a_time"))
    assert one[0] == {"a": 2.0, "b": 6.0} and len(one) == 5


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("__import__('os')", "no function"),
        ("().__class__", "only numbers"),
        ("10**10**10", "no value|too large"),
        ("1e20*1e20", "too large"),
        ("a + nothing", "no number is called 'nothing'"),
        ("eval(1)", "no function 'eval'"),
        ("2 +", "is no formula"),
        ("1/0", "no value"),
        ("(-1)**0.5", "no value|too large"),
        ("1" * 400, "longer than"),
    ],
)
def test_formulas_that_are_refused(text, word):
    begin = time.perf_counter()
    with pytest.raises(PostError, match=word) as told:
        evaluate(text, {"a": 1.0}, "s.toml:7")
    assert str(told.value).startswith("s.toml:7: ") and time.perf_counter() - begin < 0.1


def test_formulas():
    names = {"a": 8.0, "steel": "rebar"}
    assert evaluate("2*a**(1/3) - min(1, a)", names, "") == pytest.approx(3)
    assert evaluate(" steel ", names, "") == "rebar"


ONE = '[parameter.x]\nvalues = [1]\nset = ["run.x"]\n'
WRONG = {
    "no_toml": ("[study\n", 1, "is no TOML"),
    "no_deck": ('[study]\ndeck = "b.nml"\n', 2, "there is no deck"),
    "unknown_key": ('[study]\ndeck = "a.nml"\nresluts = ["x"]\n', 3, "did you mean 'results'"),
    "unknown_section": ('[study]\ndeck = "a.nml"\n[paramter.x]\nvalues = [1]\n', 3, "parameter"),
    "unit": ('[study]\ndeck = "a.nml"\n[parameter.x]\nvalues = [1]\nunit = "inch"\n', 5, "inch"),
    "two_ways": ('[study]\ndeck = "a.nml"\n[parameter.x]\nvalues = [1]\nnormal = [1, 2]\n', 3,
                 "values and normal"),
    "useless": ('[study]\ndeck = "a.nml"\n[parameter.x]\nvalues = [1]\n', 3, "changes nothing"),
    "law": ('[study]\ndeck = "a.nml"\ndesign = "lhs"\nruns = 4\n[parameter.x]\nset = ["run.x"]\n'
            "triangular = [3, 2, 1]\n", 7, "do not fit"),
    "grid_law": ('[study]\ndeck = "a.nml"\n[parameter.x]\nset = ["run.x"]\nnormal = [3, 2]\n', 5,
                 "design = 'lhs'"),
    "key": ('[study]\ndeck = "a.nml"\n[parameter.x]\nvalues = [1]\nset = ["x"]\n', 5, "group.key"),
    "formula": ('[study]\ndeck = "a.nml"\n[parameter.x]\nvalues = [1]\nset = {"run.x" = "x*z"}\n',
                5, "no number is called 'z'"),
    "certify": ('[study]\ndeck = "a.nml"\ncertify = "all"\n' + ONE, 3, 'certify is "centre"'),
    "repeat": ('[study]\ndeck = "a.nml"\nrepeat = 2\n[limit]\nunknown = "x"\nresult = "r"\n'
               'target = 1\nlow = 1\nhigh = 2\nset = ["run.x"]\n', 3, "kind = 'fragility'"),
    "late": ('[study]\ndeck = "a.nml"\nlate = "run.y"\n' + ONE, 3, "belong together"),
    "start": ('[study]\ndeck = "a.nml"\nlate = "run.y"\nstart = 1\nstart_unit = "m"\n' + ONE,
              4, "a time after 0"),
    "late_key": ('[study]\ndeck = "a.nml"\nlate = "run.y"\nstart = 1\n' + ONE, 3,
                 "no parameter sets run.y alone"),
    "bracket": ('[study]\ndeck = "a.nml"\n[limit]\nunknown = "x"\nresult = "r"\ntarget = 1\n'
                'low = 3\nhigh = 2\nset = ["run.x"]\n', 7, "0 < low < high"),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_messages_have_file_line_and_remedy(room, capsys, case):
    text, line, word = WRONG[case]
    assert room.study(text) == 2
    told = capsys.readouterr().err
    assert f"s.toml:{line}: " in told and word in told and room.begun() == 0


def test_a_point_that_the_program_refuses(room, capsys):
    assert room.study(GRID.format(jobs=1).replace("run.y", "run.z")) == 2
    told = capsys.readouterr().err
    assert "point 1 is refused" in told and "unknown key z" in told and room.begun() == 0


# --- runs, store, tables ------------------------------------------------------------------------


def test_grid_table_and_files(room, page):
    assert room.study(GRID.format(jobs=2)) == 0
    rows = room.rows()
    assert len(rows) == 6 == room.begun()
    for row in rows:
        size = (1000 * float(row["x[m]"])) ** 1.5 * float(row["y[-]"])
        assert float(row["mid:displacement_y peak[m]"]) == pytest.approx(-size, rel=1e-3)
        assert row["state"] == "done" and row["exit_code"] == "0"
    table = pq.read_table(room.folder / "o" / "study.parquet")
    assert table.schema.field("x").metadata[b"unit"] == b"m"
    assert table.column("mid:displacement_y peak").to_pylist() == [
        float(row["mid:displacement_y peak[m]"]) for row in rows
    ]
    assert table.to_pandas()["y"].tolist() == [float(row["y[-]"]) for row in rows]
    told = json.loads((room.folder / "o" / "manifest.json").read_text())
    assert "study.csv" in told["files"] and told["parameters"][0]["unit"] == "m"
    page = (room.folder / "o" / "study.html").read_text()
    assert "Response curves" in page and "data:image/png" in page


def test_nothing_runs_twice(room, capsys):
    """Order, comments, title, output and slots are no other study; a changed value is one run."""
    room.study(GRID.format(jobs=1))
    first = room.rows()
    text = GRID.format(jobs=3).replace("[1, 2, 3]", "[3, 1.0, 2]").replace("[1, 10]", "[10, 1]")
    (room.folder / "a.nml").write_text("a comment\n&run t_end=1.0 /\n&output history_every=2 /\n")
    assert room.study("# other words\n" + text) == 0 and room.begun() == 6
    assert "6 known" in capsys.readouterr().out
    assert {r["key"] for r in room.rows()} == {r["key"] for r in first}
    room.study(text.replace("[10, 1]", "[10, 2]"))
    assert room.begun() == 9


def test_another_program_runs_all_again(room, monkeypatch):
    room.study(GRID.format(jobs=1))
    monkeypatch.setenv("STUB_VERSION", "Stub 1.1 (abd)")
    room.study(GRID.format(jobs=1))
    assert room.begun() == 12
    monkeypatch.setenv("STUB_VERSION", "Stub 1.1 (abd-dirty)")
    assert len(Program(STUB).stamp.splitlines()) == 2  # an unknown state is told by its bytes


def test_a_file_that_a_deck_names_is_part_of_it(room):
    (room.folder / "a.nml").write_text(DECK.format(more="! file = 'wall.stl'"))
    (room.folder / "wall.stl").write_text("solid\n")
    room.study(GRID.format(jobs=1))
    (room.folder / "wall.stl").write_text("solid!\n")
    room.study(GRID.format(jobs=1))
    assert room.begun() == 12
    assert (room.folder / "o" / "runs" / room.rows()[0]["key"] / "wall.stl").exists()


def test_meaning_of_a_deck():
    one = "&run\n  title = 'a'\n  t_end = 1.0 ! default\n/\n\n&output\n  dump_every = 1.0\n/\n"
    two = "text\n&run\n  title = 'b'\n  t_end = 1.0\n/\n&output\n  dump_every = 2.0\n/\n"
    assert meaning_of(one) == meaning_of(two) == "&run\nt_end = 1.0\n/"


def test_side_by_side_gives_the_same(room):
    room.study(GRID.format(jobs=1))
    one = [(r["key"], r["mid:displacement_y peak[m]"]) for r in room.rows()]
    (room.folder / "o").rename(room.folder / "first")
    room.study(GRID.format(jobs=4))
    assert one == [(r["key"], r["mid:displacement_y peak[m]"]) for r in room.rows()]


def test_failures_are_rows(room, page, capsys):
    """The point with y = 10 and x = 3 fails, and stays failed until it is asked for again."""
    rule = '"run.y" = "y", "run.fail" = "max(0, y - 9)"'
    text = GRID.format(jobs=2).replace('["run.y"]', f"{{{rule}}}").replace("[1, 10]", "[1, 2, 10]")
    text = text.replace("[1, 2, 3]", "[1]")
    assert room.study(text) == 3
    assert [r["state"] for r in room.rows()] == ["done", "done", "failed"]
    assert "1 x the energy is out of its band" in capsys.readouterr().err
    assert room.study(text) == 3 and room.begun() == 3
    assert room.study(text, "--retry-failed") == 3 and room.begun() == 4
    assert "Runs without results" in (room.folder / "o" / "study.html").read_text()


def test_a_study_that_fails_all_over_is_given_up(room, capsys):
    text = GRID.format(jobs=1).replace('"x*1000"', '"x*1000", "run.fail" = "1"')
    assert room.study(text.replace("[1, 10]", "[1, 2, 3, 4]")) == 3
    assert "more than a fifth" in capsys.readouterr().err
    assert 5 <= room.begun() < 12 and room.rows()[-1]["state"] == "stopped"


def test_check_runs_nothing(room, capsys):
    assert room.study(GRID.format(jobs=1), "--check") == 0
    assert "6 points, 6 different runs, 0 known" in capsys.readouterr().out and room.begun() == 0
    assert room.study(GRID.format(jobs=1), "--list") == 0
    assert capsys.readouterr().out.count("run.y=10") == 3 and room.begun() == 0


def test_a_time_limit_is_a_failure(room, capsys):
    text = GRID.format(jobs=6) + 'time_limit = "2 s"\n'
    text += '[parameter.w]\nvalues = [0, 30]\nset = ["run.wait"]\n'
    assert room.study(text.replace("[1, 2, 3]", "[1]").replace("[1, 10]", "[1]")) == 3
    assert "1 x took longer than the time limit" in capsys.readouterr().err


def test_a_study_that_is_killed_goes_on(room):
    """KILL at several moments: in the end every row is there, and what was complete ran once."""
    text = GRID.format(jobs=2) + '[parameter.w]\nvalues = [0.15]\nset = ["run.wait"]\n'
    (room.folder / "s.toml").write_text(text)
    command = [sys.executable, "-m", "post", "study", room.folder / "s.toml"]
    command += ["--out", room.folder / "o"]
    for begun in (1, 4, 7):
        going = subprocess.Popen(
            command, cwd=HERE.parents[1], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        while room.begun() < begun:
            assert going.poll() is None
            time.sleep(0.02)
        os.kill(going.pid, signal.SIGKILL)
        going.wait()
    for path in (room.folder / "o" / "runs").glob("*/.study.lock"):
        with path.open("w") as file:
            fcntl.flock(file, fcntl.LOCK_EX)  # a run that was going on ends by itself
    complete = len(list((room.folder / "o" / "runs").glob("*/result.json")))
    before = room.begun()
    assert complete < 6 < before
    assert room.study(text) == 0
    assert len(room.rows()) == 6 and room.begun() == before + 6 - complete
    assert before - complete <= 3 * 2  # lost were those that were going on


def test_histories_lie_in_one_file(room):
    """Points x 256 times, with units; points without results are not a number."""
    rule = 'set = {"run.y" = "y", "run.fail" = "max(0, y - 9)"}'
    text = GRID.format(jobs=2).replace('set = ["run.y"]', rule).replace("[1, 2, 3]", "[1]")
    room.study(text)
    with h5py.File(room.folder / "o" / "histories.h5") as file:
        group = file["mid:displacement_y"]
        assert group["value"].shape == group["time"].shape == (2, 256)
        assert group["value"].attrs["unit"] == "m" and group["time"].attrs["unit"] == "s"
        assert group["value"][0].min() == pytest.approx(-(1000**1.5) * 1e-3**1.5, rel=1e-3)
        assert np.isnan(group["value"][1]).all()
    told = json.loads((room.folder / "o" / "manifest.json").read_text())
    assert "histories.h5" in told["files"]


def test_members_of_a_point(room, page):
    """Three members of two points, 1 and 10, each (1 + seed/1000) times as large: a deviation of
    1e-3 sqrt((1 + 100)/2) about a mean of 5.5.
    """
    text = GRID.format(jobs=2).replace("[1, 2, 3]", "[1]")
    assert room.study(text.replace("[study]", "[study]\nrepeat = 3")) == 0
    rows = room.rows()
    assert [row["seed"] for row in rows] == ["1", "2", "3"] * 2 and room.begun() == 6
    assert len({row["split"] for row in rows[:3]}) == 1
    peaks = np.array([float(row["mid:displacement_y peak[m]"]) for row in rows])
    assert peaks[1:3] / peaks[0] == pytest.approx([1.002 / 1.001, 1.003 / 1.001])
    told = (room.folder / "o" / "study.html").read_text()
    assert "Scatter by chance" in told and "0.13 %" in told


AIR = "&run t_end = 1 /\n&air box = 0,1,0,1,0,1, cells = 100,1,1 /\n"


def test_the_certificate_of_the_centre(room, page):
    """100 cells are 1 % off at any point: the interval of the middle goes with every row."""
    (room.folder / "a.nml").write_text(AIR)
    text = GRID.format(jobs=2).replace("[study]", '[study]\ncertify = "centre"')
    assert room.study(text) == 0
    shares = [float(row["U:mid:displacement_y peak[m]"]) / -float(row["mid:displacement_y peak[m]"])
              for row in room.rows()]  # fmt: skip
    assert shares == pytest.approx([shares[0]] * 6) and 0.01 < shares[0] < 0.05
    assert (room.folder / "o" / "certify" / "certify.html").is_file()
    told = (room.folder / "o" / "study.html").read_text()
    assert "By cells, at the middle of the ranges: mid:displacement_y peak +-" in told
    begun = room.begun()
    assert room.study(text) == 0 and room.begun() == begun


def test_a_centre_without_partners_is_told(room, page, capsys):
    (room.folder / "a.nml").write_text(AIR.replace("100", "4"))
    assert room.study(GRID.format(jobs=2).replace("[study]", '[study]\ncertify = "centre"')) == 0
    assert "no certificate" in capsys.readouterr().err
    assert not any(head.startswith("U:") for head in room.rows()[0])


LATE = 'late = ["run.y"]\nstart = 5\nstart_unit = "ms"'


def test_late_keys_share_their_beginning(room, capsys):
    """y acts from 5 ms on: one beginning for each x, then a branch for each point."""
    text = GRID.format(jobs=2).replace("[study]", f"[study]\n{LATE}")
    assert room.study(text) == 0
    assert room.begun() == 3 + 6 and "beginnings that runs share: 3" in capsys.readouterr().out
    log = (room.folder / "begun.txt").read_text()
    assert log.count("t_end = 0.005") == 3
    rows = room.rows()
    assert [row["state"] for row in rows] == ["done"] * 6 and len({r["key"] for r in rows}) == 6
    assert room.study(text) == 0 and room.begun() == 9
    assert room.study(text.replace("[1, 10]", "[1, 10, 100]")) == 0 and room.begun() == 9 + 3
    room.study(GRID.format(jobs=2))  # from their start they are other runs
    assert room.begun() == 12 + 6


def test_a_study_that_is_stopped_goes_on(room, capsys):
    """Code 75, rows of what was done; the same command runs the others alone."""
    text = GRID.format(jobs=1) + '[parameter.w]\nvalues = [0.4]\nset = ["run.wait"]\n'
    assert room.study(text, "--stop-after", "1.2") == 75
    assert "the same command goes on" in capsys.readouterr().err
    states = [row["state"] for row in room.rows()]
    assert set(states) <= {"done", "stopped"} and "stopped" in states
    begun = room.begun()
    assert room.study(text) == 0 and room.begun() == begun + states.count("stopped")


# --- limits -------------------------------------------------------------------------------------

LIMIT = """[study]
deck = "a.nml"
[parameter.y]
values = [1, 2, 4, 8]
set = ["run.y"]
[limit]
kind = "{kind}"
unknown = "x"
low = 1
high = 400
set = ["run.x"]
result = "mid:displacement_y peak"
target = 100
tolerance = 0.005
[slots]
jobs = {jobs}
"""


@pytest.mark.parametrize("jobs", [1, 4])
def test_limits_along_a_parameter(room, page, jobs):
    """x**1.5 y = 100, to a share of 0.5 % in the response; the runs do not hang on the slots."""
    assert room.study(LIMIT.format(kind="limit", jobs=jobs)) == 0
    for row in room.rows("limits.csv"):
        x, y = float(row["x[-]"]), float(row["y[-]"])
        assert x == pytest.approx((100 / y) ** (2 / 3), rel=0.004)
        assert int(row["runs"]) <= 5
    assert room.begun() <= 16
    assert len(room.rows()) == sum(int(r["runs"]) for r in room.rows("limits.csv"))
    assert "Limits" in (room.folder / "o" / "study.html").read_text()


def test_an_event_is_bracketed(room, page):
    text = LIMIT.format(kind="limit", jobs=1).replace("[1, 2, 4, 8]", "[2]")
    text = text.replace('result = "mid:displacement_y peak"\ntarget = 100\n',
                        "event = 'mid:displacement_y peak < -100'\n")  # fmt: skip
    assert room.study(text.replace("low = 1\nhigh = 400", "low = 20\nhigh = 25")) == 0
    (row,) = room.rows("limits.csv")
    low, high = float(row["low[-]"]), float(row["high[-]"])
    assert low < 50 ** (2 / 3) < high and high / low <= 1.005
    assert {20.0, 25.0} <= {float(r["x[-]"]) for r in room.rows()} | {25.0}


def test_a_result_that_is_not_there(room, capsys):
    text = LIMIT.format(kind="limit", jobs=1).replace("displacement_y peak", "peak")
    assert room.study(text) == 2
    assert "there is no result 'mid:peak'; this deck gives mid:disp" in capsys.readouterr().err


def test_study_files_of_the_inputs_are_sound():
    for path in sorted((HERE.parents[1] / "inputs" / "studies").glob("*.toml")):
        study = read_study(path)
        assert study.points() and study.title
