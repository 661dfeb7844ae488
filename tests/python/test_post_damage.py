# SPDX-License-Identifier: MIT
"""Runs that are not as they should be: one line and an exit code, and a report of what is left."""

import re
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
from tiers import slow  # noqa: E402

from post.__main__ import main  # noqa: E402
from post.reader import Run  # noqa: E402


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sound") / "run"
    return write_run(folder, nx=4, frames=5, rows=60, spacing=0.0125)


@pytest.fixture
def folder(sound, tmp_path, monkeypatch):
    monkeypatch.setattr("post.scene.TALL", (200, 200))
    monkeypatch.setattr("post.scene.WIDE", (200, 200))
    monkeypatch.setitem(matplotlib.rcParams, "savefig.dpi", 30)
    return Path(shutil.copytree(sound, tmp_path / "run"))


def put(path, field, value, rows=slice(None)):
    """Overwrite a field of a dump, or some rows of it."""
    with h5py.File(path, "a") as file:
        values = file["VTKHDF"][field][()]
        values[rows] = value
        file["VTKHDF"][field][...] = values


def report(folder, capsys):
    """Exit code, notes and errors of a report."""
    code = main(["report", str(folder)])
    found = capsys.readouterr()
    assert (folder / "report.html").is_file() == (code in (0, 3, 4) and not found.err)
    return code, found.out, found.err


def test_what_is_not_finite_is_told(folder, capsys, recwarn):
    """In every kind of file; the slow tests that follow have each alone, and other columns."""
    put(folder / "solid_00004.vtkhdf", "PointData/displacement", np.nan, slice(0, 5))
    put(folder / "air_00003.vtkhdf", "CellData/pressure", np.inf, slice(0, 2))
    lines = (folder / "energy.csv").read_text().splitlines()
    name, cells = re.sub(r"\[.*", "", lines[0].split(",")[5]), lines[7].split(",")
    lines[7] = ",".join([*cells[:5], "inf", *cells[6:]])
    (folder / "energy.csv").write_text("\n".join(lines) + "\n")
    (folder / "gauges.csv").write_text("time[s],A:pressure[Pa]\n0.0,1e5\n1e-4,nan\n")
    code, out, _ = report(folder, capsys)
    assert code == 3 and "no picture" not in out
    assert "solid_00004.vtkhdf: 'displacement' is not finite at t = 0.00045 s" in out
    assert "air_00003.vtkhdf: 'pressure' is not finite" in out
    assert f"energy.csv: '{name}' is not finite" in out
    assert "'A:pressure' is not finite" in out
    assert (folder / "report" / "energy.png").is_file()
    assert not [w for w in recwarn if "invalid value" in str(w.message)]


def test_dumps_that_are_damaged_or_zero_are_left_out(folder, capsys):
    """The slow tests that follow have each alone, and other kinds."""
    path = folder / "air_00002.vtkhdf"
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    put(folder / "solid_00003.vtkhdf", "PointData/id", 0)
    put(folder / "air_00001.vtkhdf", "CellData/pressure", 0)
    code, out, _ = report(folder, capsys)
    assert code == 4 and "no picture" not in out
    assert f"{path}: is damaged or not HDF5" in out
    assert "solid_00003.vtkhdf: 'id' is zero throughout; it is left out" in out
    assert "air_00001.vtkhdf: 'pressure' is zero throughout; it is left out" in out
    run = Run(folder)
    run.leave_out_damaged()
    assert [frame.number for frame in run.frames] == [0, 4]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("field", "value"),
    [("Points", np.inf), ("PointData/displacement", np.nan), ("PointData/damage", np.nan)],
)
def test_particles_that_are_not_finite(folder, capsys, recwarn, field, value):
    put(folder / "solid_00004.vtkhdf", field, value, slice(0, 5))
    code, out, _ = report(folder, capsys)
    name = field.split("/")[-1]
    assert code == 3 and f"solid_00004.vtkhdf: '{name}' is not finite at t = 0.00045 s" in out
    assert not [w for w in recwarn if "invalid value" in str(w.message)]


@pytest.mark.slow
@pytest.mark.parametrize(("number", "value"), [(2, np.inf), (4, np.nan)])
def test_air_that_is_not_finite(folder, capsys, number, value):
    put(folder / f"air_0000{number}.vtkhdf", "CellData/pressure", value, slice(0, 2))
    code, out, _ = report(folder, capsys)
    assert code == 3 and f"air_0000{number}.vtkhdf: 'pressure' is not finite" in out
    assert "no picture" not in out


@pytest.mark.slow
@pytest.mark.parametrize(("column", "value"), [(0, "nan"), (5, "inf"), (17, "inf")])
def test_history_that_is_not_finite(folder, capsys, column, value):
    lines = (folder / "energy.csv").read_text().splitlines()
    cells = lines[7].split(",")
    cells[column] = value
    lines[7] = ",".join(cells)
    (folder / "energy.csv").write_text("\n".join(lines) + "\n")
    code, out, _ = report(folder, capsys)
    name = re.sub(r"\[.*", "", lines[0].split(",")[column])
    assert code == 3 and f"energy.csv: '{name}' is not finite" in out
    assert (folder / "report" / "energy.png").is_file() or column == 0


@pytest.mark.parametrize("content", [bytes(range(256)) * 20, slow(b"")])
def test_echo_that_is_no_deck(folder, capsys, content):
    (folder / "demo.echo.nml").write_bytes(content)
    code, out, _ = report(folder, capsys)
    assert code == 0 and "demo.echo.nml cannot be read: the deck is that of a dump" in out
    assert Run(folder).deck.title == "Synthetic blast on a plate"
    for path in folder.glob("*.vtkhdf"):
        with h5py.File(path, "a") as file:
            del file["brisance"].attrs["deck"]
    assert main(["report", str(folder)]) == 2
    err = capsys.readouterr().err
    assert "demo.echo.nml" in err and err.count("\n") == 1 and len(err) < 400


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "number", "content"),
    [("air", 2, "cut"), ("solid", 2, "zeros"), ("solid", 4, "cut"), ("air", 0, "text")],
)
def test_damaged_dump_is_told_and_left_out(folder, capsys, kind, number, content):
    path = folder / f"{kind}_0000{number}.vtkhdf"
    whole = path.read_bytes()
    left = {"cut": whole[: len(whole) // 2], "zeros": bytes(len(whole)), "text": b"not HDF5"}
    path.write_bytes(left[content])
    code, out, _ = report(folder, capsys)
    assert code == 4
    assert f"{path}: is damaged or not HDF5" in out and "it is left out" in out
    assert "no picture" not in out
    run = Run(folder)
    run.leave_out_damaged()
    assert [frame.number for frame in run.frames] == [n for n in range(5) if n != number]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "field"), [("air", "CellData/pressure"), ("solid", "PointData/id")]
)
def test_dump_of_zeros_is_told(folder, capsys, kind, field):
    put(folder / f"{kind}_00002.vtkhdf", field, 0)
    code, out, _ = report(folder, capsys)
    name = field.split("/")[-1]
    assert code == 4 and f"{kind}_00002.vtkhdf: '{name}' is zero throughout; it is left out" in out


def test_every_dump_damaged(folder, capsys):
    for path in folder.glob("*.vtkhdf"):
        path.write_bytes(bytes(100))
    code = main(["report", str(folder)])
    err = capsys.readouterr().err
    assert code == 4 and err.count("\n") == 1 and "is damaged or not HDF5" in err
