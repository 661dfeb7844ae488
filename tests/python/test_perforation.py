# SPDX-License-Identifier: MIT
"""Holes of known size in made-up plates, and histories of displacement of known permanent set."""

import json
import math
import re
import sys
from pathlib import Path

import numpy as np
import pytest

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parents[1]), str(HERE)]

from synthetic_run import begin  # noqa: E402
from tiers import slow  # noqa: E402

from post.__main__ import main  # noqa: E402
from post.deflection import displacement_table, measure_deflection  # noqa: E402
from post.errors import PostError  # noqa: E402
from post.fragments import pieces  # noqa: E402
from post.hole_picture import draw_cut, draw_perforation  # noqa: E402
from post.perforation import load_plate, measure_perforation  # noqa: E402
from post.reader import Run  # noqa: E402
from post.report import make_report  # noqa: E402
from post.style import plt  # noqa: E402

SIDE, THICK, SPACING = 0.03, 0.0024, 4e-4

DECK = """
&run title = 'A plate with a hole', t_end = 1e-5 {symmetry} /
&material id = 'm', model = 'orthotropic_ply' /
&body id = 'plate', shape = 'box', box = -0.015, 0.015, -0.015, 0.015, -0.0024, 0,
      spacing = {spacing}, material = 'm' /
"""


class Made:
    """Particles of a plate: all of them stand at `x` when unloaded, and none is broken."""

    def __init__(self, quarter=False, spacing=SPACING):
        n, layers = round(SIDE / spacing), round(THICK / spacing)
        axis = (np.arange(n) + 0.5) * spacing - SIDE / 2
        depth = (np.arange(layers) + 0.5) * spacing - THICK
        axis = axis[axis > 0] if quarter else axis
        z, y, x = (a.ravel() for a in np.meshgrid(depth, axis, axis, indexing="ij"))
        self.x = np.stack([x, y, z], 1)
        self.move = np.zeros_like(self.x)
        self.broken = np.zeros(len(x), bool)
        self.quarter, self.spacing = quarter, spacing
        self.layer = np.rint((self.x[:, 2] + THICK) / spacing + 0.5).astype(int)

    def within(self, radius, centre=(0.0, 0.0)):
        """Particles nearer to an axis along z than a radius [m], which may differ by particle."""
        return np.hypot(self.x[:, 0] - centre[0], self.x[:, 1] - centre[1]) < radius

    def fling(self, chosen):
        """Throw particles away, each on its own."""
        places = np.random.default_rng(1).uniform(-0.5, 0.5, (chosen.sum(), 3))
        self.move[chosen] = places - [0, 0, 1]

    def run(self, folder):
        """The plate as the only dump of a run."""
        symmetry = ", symmetry = 'x', 'y'" if self.quarter else ""
        deck = DECK.format(symmetry=symmetry, spacing=self.spacing)
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "hit.echo.nml").write_text(deck)
        path = folder / "solid_00001.vtkhdf"
        about = {"deck": deck, "job": "hit", "time": 1e-5, "cycle": 1}
        file, root = begin(path, "PolyData", about)
        with file:
            n = len(self.x)
            root["Points"] = (self.x + self.move).astype("f4")
            data = root.create_group("PointData")
            data["displacement"] = self.move.astype("f4")
            data["id"] = np.arange(1, n + 1, dtype="i4")
            data["body"] = np.ones(n, "i4")
            data["ply"] = self.layer.astype("i4")
            for name in ("damage", "damage_fibre_tension"):
                data[name] = self.broken.astype("f4")
        series = {"files": [{"name": path.name, "time": 1e-5}]}
        (folder / "solid.vtkhdf.series").write_text(json.dumps(series))
        return Run(folder)

    def measure(self, folder):
        run = self.run(folder)
        return measure_perforation(load_plate(run, run.frames[-1]))


def area_of(radius, made):
    """Area of the columns of particles that a hole takes away [m2]."""
    return made.within(radius).sum() / made.layer.max() * made.spacing**2


# --- holes --------------------------------------------------------------------------------------


@pytest.mark.parametrize("radius", [slow(1.1e-3), 3.1e-3, slow(7.3e-3)])
def test_round_hole(tmp_path, radius):
    made = Made()
    made.fling(made.within(radius))
    found = made.measure(tmp_path)
    hole = found.widest.through.seen
    assert hole.area == pytest.approx(area_of(radius, made), rel=1e-9)
    assert hole.diameter == pytest.approx(2 * radius, abs=0.5 * SPACING)
    assert hole.middle == pytest.approx([0, 0], abs=1e-6)
    assert found.widest.through.pushed.area == hole.area
    assert found.loose == pytest.approx(made.within(radius).mean())


@pytest.mark.parametrize("spacing", [8e-4, 4e-4, slow(2e-4)])
def test_hole_converges_with_the_spacing(tmp_path, spacing):
    made = Made(spacing=spacing)
    centre = (1.31e-3, -0.77e-3)
    made.fling(made.within(3e-3, centre))
    hole = made.measure(tmp_path).widest.through.seen
    assert hole.diameter == pytest.approx(6e-3, abs=0.5 * spacing)
    assert hole.middle == pytest.approx(centre, abs=0.5 * spacing)


def test_hole_in_a_bent_and_stretched_plate(tmp_path):
    made = Made()
    gone = made.within(3e-3)
    x, y, z = made.x.T
    made.move = np.stack([0.03 * x - 40 * z * x, 0.02 * y + 0.01 * x, 20 * (x**2 + y**2)], 1)
    made.fling(gone)
    hole = made.measure(tmp_path).widest.through.seen
    stretched = area_of(3e-3, made) * 1.03 * 1.02
    assert hole.area == pytest.approx(stretched, rel=0.06)  # the bending narrows it on one side
    assert hole.diameter == pytest.approx(6e-3 * math.sqrt(1.03 * 1.02), abs=0.5 * SPACING)


def test_particles_cover_what_their_neighbours_leave_them(tmp_path):
    made = Made()
    gone = made.within(3e-3)
    made.move[:, 0] = 0.3 * made.x[:, 0]
    made.fling(gone)
    hole = made.measure(tmp_path).widest.through.seen
    assert hole.area == pytest.approx(area_of(3e-3, made) * 1.3, rel=0.015)


def test_quarter_is_the_whole(tmp_path):
    found = []
    for quarter in (False, True):
        made = Made(quarter, 5e-4)
        made.broken = made.within(4.2e-3)
        made.fling(made.within(3.1e-3))
        found.append(made.measure(tmp_path / str(quarter)))
    whole, part = found
    assert part.widest.through.seen.area == pytest.approx(whole.widest.through.seen.area, rel=1e-9)
    assert part.widest.through.pushed.area == pytest.approx(
        whole.widest.through.pushed.area, rel=1e-9
    )
    for name, region in whole.widest.damaged.items():
        assert part.widest.damaged[name].area == pytest.approx(region.area, rel=1e-5)


@pytest.mark.parametrize("quarter", [False, True])
def test_every_hole_is_found(tmp_path, quarter):
    """One hole in the middle, four that are images of each other, and one that is cut in halves."""
    made = Made(quarter, 4e-4)
    places = {(0.0, 0.0): 3.1e-3, (8e-3, 8e-3): 2.4e-3, (9e-3, 0.0): 1.7e-3}
    for (x, y), radius in places.items():
        for sx in (1, -1):
            for sy in (1, -1):
                made.fling(made.within(radius, (sx * x, sy * y)))
    holes = made.measure(tmp_path).holes
    found = {tuple(np.round(hole.middle, 5) + 0.0): hole for hole in holes}
    images = {(0.0, 0.0): 1, (8e-3, 8e-3): 4, (9e-3, 0.0): 2}
    assert len(holes) == (3 if quarter else 7)
    for place, radius in places.items():
        near = min(found, key=lambda at: math.dist(at, place))
        assert math.dist(near, place) < 2e-4
        assert found[near].through.seen.diameter == pytest.approx(2 * radius, abs=2e-4)
        assert all(layer.seen.area > 0 for layer in found[near].layers)
        assert found[near].copies == (images[place] if quarter else 1)


def test_the_cut_goes_through_the_hole_it_names(tmp_path):
    made = Made(quarter=True)
    made.fling(made.within(2e-3, (8e-3, 8e-3)))
    found = made.measure(tmp_path)
    x, y = found.widest.middle
    (picture,) = draw_perforation(found, tmp_path)
    assert (
        f"at ({1e3 * x:.3g}, {1e3 * y:.3g}) mm in x, y (4 of them in the whole)" in picture.caption
    )
    axis = plt.figure().add_subplot()
    draw_cut(axis, found, (found.widest.middle, 4e-3))
    drawn = np.concatenate([dots.get_offsets() for dots in axis.collections])
    here = np.abs(drawn[:, 1]) < 3  # on the plate [mm]
    assert not (np.abs(drawn[here, 0] - 1e3 * x) < 1.8).any() and here.sum() > 100
    level = float(re.search(r"at y = (\S+) mm", axis.get_title(loc="left"))[1])
    assert level == pytest.approx(1e3 * y, abs=0.21)
    plt.close(axis.figure)


def test_debris_in_the_hole_hides_nothing(tmp_path):
    made = Made()
    hole = made.within(3e-3)
    piece = made.within(1.2e-3)
    made.fling(hole)
    made.move[piece] = [0, 0, -2.5 * THICK]  # a plug that hangs together, seen through the hole
    found = made.measure(tmp_path)
    assert found.widest.through.seen.area == pytest.approx(area_of(3e-3, made), rel=1e-9)


def test_broken_fibres_count_apart(tmp_path):
    made = Made()
    made.broken = made.within(5e-3)
    made.fling(made.within(3e-3))
    found = made.measure(tmp_path)
    assert found.widest.through.seen.area == pytest.approx(area_of(3e-3, made), rel=1e-9)
    assert found.widest.through.pushed.area == pytest.approx(area_of(5e-3, made), rel=1e-9)
    assert found.widest.damaged["fibres broken"].area == pytest.approx(
        area_of(5e-3, made), rel=1e-5
    )


@pytest.mark.parametrize(("rim", "holes"), [(13e-3, 1), (9.4e-3, 2)])
def test_a_gap_in_the_broken_rim_is_no_hole_of_its_own(tmp_path, rim, holes):
    """Unless whole fibres lie between it and the hole."""
    made = Made()
    gap = made.within(8e-4, (11.6e-3, 2e-4))
    made.broken = made.within(rim) | gap
    made.fling(made.within(9e-3) | gap)
    found = made.measure(tmp_path)
    assert len(found.holes) == holes
    assert found.widest.through.seen.area == pytest.approx(area_of(9e-3, made), rel=1e-9)


def test_hole_by_ply(tmp_path):
    made = Made()
    made.fling(made.within(2e-3 + 4e-4 * np.abs(made.layer - 3)))
    found = made.measure(tmp_path)
    assert found.widest.through.seen.area == pytest.approx(area_of(2e-3, made), rel=1e-9)
    for k, hole in enumerate(found.widest.layers):
        radius = 2e-3 + 4e-4 * abs(k - 2)
        assert hole.seen.area == pytest.approx(area_of(radius, made), rel=1e-9)


def test_no_hole(tmp_path):
    made = Made()
    x, y, _ = made.x.T
    crack = 0.35 * np.exp(-((x / 3e-3) ** 2)) * np.maximum(1 - (y / 5e-3) ** 2, 0)
    made.move[:, 0] = np.sign(x) * crack * SPACING  # open by 0.7 of a spacing in the middle
    made.broken = made.within(1e-3) & (made.layer == 1)
    found = made.measure(tmp_path)
    assert found.widest.through.seen.area == 0 and found.widest.through.pushed.area == 0
    assert found.loose == 0
    assert found.widest.damaged["fibres broken"].area == pytest.approx(
        area_of(1e-3, made), rel=1e-5
    )


def test_command_and_report(tmp_path, capsys, monkeypatch):
    for size in ("TALL", "WIDE"):
        monkeypatch.setattr(f"post.scene.{size}", (300, 300))
    made = Made(spacing=8e-4)
    made.fling(made.within(3e-3))
    run = made.run(tmp_path)
    assert main(["hole", str(tmp_path)]) == 0
    text = capsys.readouterr().out
    assert "through the plate" in text and (tmp_path / "report" / "hole_plate.png").is_file()
    assert main(["hole", str(tmp_path), "--body", "absent"]) == 2
    page, text = make_report(run)
    assert "Holes in plate" in text and "Hole in plate" in page.read_text()


def test_plate_must_be_a_box_on_a_lattice(tmp_path):
    made = Made(spacing=8e-4)
    made.x[:2] = made.x[2]
    run = made.run(tmp_path)
    with pytest.raises(PostError, match="lattice"):
        load_plate(run, run.frames[-1])


def test_pieces_against_a_search():
    random = np.random.default_rng(5)
    one, other = random.integers(0, 300, (2, 240))
    name = pieces(300, one, other)
    for start in range(300):
        reached, rest = {start}, True
        while rest:
            more = {b for a, b in zip(one, other, strict=True) if a in reached}
            more |= {a for a, b in zip(one, other, strict=True) if b in reached}
            rest = more - reached
            reached |= more
        assert set(np.flatnonzero(name == name[start])) == reached


# --- deflection ---------------------------------------------------------------------------------


def test_permanent_set_is_the_shape_about_which_it_swings():
    t = np.linspace(0, 10, 4001)
    move = -3e-3 * (1 - np.exp(-2 * t)) + 2e-3 * np.sin(5 * t) * np.exp(-0.05 * t)
    found = measure_deflection(t, move)
    assert found.peak == move[np.argmin(move)] and found.peak_time == t[np.argmin(move)]
    assert found.permanent == pytest.approx(-3e-3, rel=0.02) and not found.growing
    noisy = move + np.random.default_rng(2).normal(0, 2e-5, t.size)
    assert measure_deflection(t, noisy).permanent == pytest.approx(-3e-3, rel=0.03)


def test_a_history_that_is_still_growing():
    t = np.linspace(0, 1, 50)
    found = measure_deflection(t, -(t**2))
    assert found.growing and math.isnan(found.permanent) and found.peak == -1


@pytest.mark.parametrize("move", [[], [0.0, math.nan]])
def test_bad_history_of_displacement(move):
    with pytest.raises(ValueError, match="displacements"):
        measure_deflection(np.arange(len(move)), np.array(move))


def test_farthest_particle_of_a_plate(tmp_path):
    made = Made(spacing=8e-4)
    made.move[:, 2] = -5e-4 * np.cos(50 * made.x[:, 0]) * np.cos(50 * made.x[:, 1])
    made.move[0] = [0, 0, 5.0]  # came loose: no deflection
    rows = {row[0]: row for row in displacement_table(made.run(tmp_path)).rows}
    assert rows["plate, farthest"][1] == rows["plate, middle"][1] == "-0.500 mm"
