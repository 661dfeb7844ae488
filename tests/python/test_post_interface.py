# SPDX-License-Identifier: MIT
"""What post shows of cohesive interfaces: areas of the whole scene, maps and curves."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(ROOT), str(HERE)]

from test_cohesive import PEEL  # noqa: E402

from post.__main__ import main  # noqa: E402
from post.interface import draw_interfaces, interface_table, interfaces  # noqa: E402
from post.reader import Run  # noqa: E402

# a quarter of a stamp of 20 x 12 mm that is torn off at one edge: the row at x = 9 to 10 mm first
STAMP = """\
&run t_end={end}, symmetry='x','y' /
&material id='m', model='linear_elastic', density=1000, youngs_modulus=1e9, poisson_ratio=0.3 /
&body id='floor', box=0,0.01, 0,0.006, 0,0.002, spacing=0.001, material='m', fix='z-' /
&body id='stamp', box=0,0.01, 0,0.006, 0.002,0.004, spacing=0.001, material='m',
  fix_box=0.009,0.01, 0,0.006, 0.002,0.004, motion_time=0,1, motion_velocity=0,0,0.5, 0,0,0.5 /
&interaction bodies='floor','stamp', law='cohesive', tensile_strength=1e6, shear_strength=2e6,
  gi=30, gii=60 /
&output dump_every={end} /
"""


def run_of(folder, deck):
    (folder / "glue.nml").write_text(deck)
    done = subprocess.run([ROOT / "bin" / "brisance", "run", "glue.nml"], cwd=folder,
                          capture_output=True, text=True)  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    return Run(folder / "out" / "glue")


@pytest.fixture(scope="module")
def stamp(tmp_path_factory):
    return run_of(tmp_path_factory.mktemp("stamp"), STAMP.format(end=2e-4))


def test_areas_are_of_the_whole_scene(stamp):
    (one,) = interfaces(stamp, stamp.frames[-1])
    assert one.name == "floor+stamp" and one.normal == 2
    assert one.area.sum() == pytest.approx(20e-3 * 12e-3, rel=1e-5)
    table = stamp.history("bodies")
    ours = 4 * table["floor+stamp:broken"][-1]
    assert 0 < one.broken < one.area.sum()
    assert one.broken == pytest.approx(ours, rel=1e-5)
    row = interface_table(stamp).rows[0]
    assert row[0] == "floor+stamp" and row[1] == "240"
    assert float(row[2]) == pytest.approx(1e6 * one.broken, rel=1e-3)


def test_places_are_those_of_the_unloaded_bodies(stamp):
    (first,), (last,) = (interfaces(stamp, stamp.frames[k]) for k in (0, -1))
    np.testing.assert_allclose(first.points, last.points, atol=1e-9)
    assert not first.damage.any()
    edge = np.abs(last.points[:, 0]) > 0.009
    middle = np.abs(last.points[:, 0]) < 0.001
    assert last.damage[edge].min() > 0.99 and last.damage[middle].max() < 0.5


def test_a_map_of_what_is_debonded(stamp, tmp_path):
    picture = draw_interfaces(stamp, tmp_path)
    assert picture.path.is_file()
    (one,) = interfaces(stamp, stamp.frames[-1])
    assert f"{1e6 * one.broken:.4g} of 240 mm2 broken" in picture.caption


@pytest.mark.long("a run and its report")
def test_in_two_dimensions_the_report_has_a_curve(tmp_path, capsys, monkeypatch):
    for size in ("TALL", "WIDE"):
        monkeypatch.setattr(f"post.scene.{size}", (300, 300))
    run = run_of(tmp_path, PEEL)
    assert main(["report", str(run.folder)]) == 0
    assert "Cohesive interfaces" in capsys.readouterr().out
    assert (run.folder / "report" / "interfaces.png").is_file()


def test_a_scene_without_interfaces_has_none(tmp_path):
    deck = "\n".join(x for x in PEEL.replace("2.2e-3", "1e-5").splitlines() if "bodies=" not in x)
    deck = deck.replace("  gi=30, gii=60 /\n", "")
    run = run_of(tmp_path, deck)
    assert interfaces(run, run.frames[-1]) == [] and draw_interfaces(run, tmp_path) is None
    assert interface_table(run).rows == []
