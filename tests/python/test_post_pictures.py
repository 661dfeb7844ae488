# SPDX-License-Identifier: MIT
"""What pictures and tables say of made-up scenes of several bodies: planes, times, labels."""

import json
import re
import sys
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parents[1]), str(HERE)]

from synthetic_run import begin, write_run  # noqa: E402

from post.balance import balance_table, body_table, energy_put_in, totals_table  # noqa: E402
from post.compare import compare, read_references  # noqa: E402
from post.gauge_picture import draw_gauges  # noqa: E402
from post.labels import NOTE, note, settle  # noqa: E402
from post.motion_picture import draw_motion  # noqa: E402
from post.reader import Run  # noqa: E402
from post.scene import draw_bodies, gather_solids  # noqa: E402
from post.section import draw_sheet  # noqa: E402
from post.space import boxes_of, choose_cut, particles_in, pick_frames  # noqa: E402
from post.style import new_figure, plt  # noqa: E402
from post.surface import find_lattice, skin_of  # noqa: E402
from post.tables import as_text  # noqa: E402
from post.tints import TINTS, tints_of  # noqa: E402

DECK = """
&run title = 'Slab, bars and spheres', t_end = 1e-3, symmetry = 'x', 'y' /
&material id = 'c', model = 'hjc' /
&material id = 's', model = 'johnson_cook' /
&body id = 'slab', shape = 'box', box = -0.2, 0.2, -0.2, 0.2, 0, 0.03, spacing = 0.01, material = 'c' /
&body id = 'bars', shape = 'bars', box = -0.2, 0.2, -0.2, 0.2, 0.03, 0.04, spacing = 0.01, material = 's' /
&body id = 'near', shape = 'sphere', centre = 0, 0, -0.1, radius = 0.02, spacing = 0.01, material = 's' /
&body id = 'far', shape = 'sphere', centre = 0.09, 0.09, -0.1, radius = 0.02, spacing = 0.01, material = 's' /
"""  # noqa: E501


def grid(*axes):
    return np.stack([a.ravel() for a in np.meshgrid(*axes, indexing="ij")], 1)


def bodies():
    """Unloaded places of the four bodies: bars along x at y = 37.5 and 112.5 mm."""
    half, ball = (np.arange(20) + 0.5) * 0.01, (np.arange(4) - 1.5) * 0.01
    slab = grid(half, half, (np.arange(3) + 0.5) * 0.01)
    bars = grid(half, [0.0375, 0.1125], [0.035])
    near = grid(ball[2:], ball[2:], ball - 0.1)
    return [slab, bars, near, grid(ball, ball, ball) + [0.09, 0.09, -0.1]]


def write_scene(folder, times=(1e-4,), damage=0.0, rise=0.0):
    """The scene as dumps of the solid alone; the slab rises by `rise` times the time."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scene.echo.nml").write_text(DECK)
    parts = bodies()
    x, body = np.concatenate(parts), np.repeat(np.arange(1, 5), [len(part) for part in parts])
    files = []
    for number, time in enumerate(times):
        path = folder / f"solid_{number:05d}.vtkhdf"
        file, root = begin(
            path, "PolyData", {"deck": DECK, "job": "scene", "time": time, "cycle": 1}
        )
        move = np.zeros_like(x)
        move[:, 2] = rise * time * (body < 3)
        with file:
            root["Points"] = (x + move).astype("f4")
            data = root.create_group("PointData")
            data["displacement"] = move.astype("f4")
            data["id"] = np.arange(1, len(x) + 1, dtype="i4")
            data["body"] = body.astype("i4")
            data["damage"] = np.full(len(x), damage, "f4")
        files.append({"name": path.name, "time": time})
    (folder / "solid.vtkhdf.series").write_text(json.dumps({"files": files}))
    return Run(folder)


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    return write_scene(tmp_path_factory.mktemp("scene"))


# --- sections -----------------------------------------------------------------------------------


def test_section_holds_what_is_in_the_plane(scene):
    solid = scene.frames[0].solid("displacement", "body")
    cut = choose_cut(scene.deck)
    rows = particles_in(cut, solid, boxes_of(scene, solid))
    assert (cut.normal, cut.level) == (1, 0.0)
    assert set(solid.field["body"][rows]) == {1, 3}  # neither bars nor the sphere beside the plane
    assert len(rows) == 20 * 3 + 2 * 4 and (solid.points[rows, 1] < 0.006).all()


def test_section_between_two_bars_and_through_one(scene):
    solid = scene.frames[0].solid("displacement", "body")
    for level, there in ((0.0375, {1, 2}), (0.075, {1, 4}), (0.09, {1, 4}), (0.15, {1})):
        cut = type(choose_cut(scene.deck))(1, 0, 2, level)
        rows = particles_in(cut, solid, boxes_of(scene, solid))
        assert set(solid.field["body"][rows]) == there
        away = np.abs(solid.points[rows, 1] - level)
        assert away.max() < 0.0087 and (np.diff(away) < 1e-9).all()  # half a diagonal; nearest last


def test_all_of_a_plane_scene_is_in_its_plane(scene):
    """Particles of a scene in two dimensions lie in the middle of the box, wherever that is."""
    deck = type(scene.deck)(scene.deck.text.replace("t_end = 1e-3", "t_end = 1e-3, dimension = 2"))
    solid = scene.frames[0].solid("displacement", "body")
    cut = choose_cut(deck, np.array([8, 6, 1]))
    assert (cut.normal, cut.across, cut.up) == (2, 0, 1)
    assert len(particles_in(cut, solid, boxes_of(scene, solid))) == len(solid.points)


# --- skins ----------------------------------------------------------------------------------------


def area(skin):
    a, b = (skin.corners[:, i + 2] - skin.corners[:, i] for i in (0, 1))
    return 0.5 * np.linalg.norm(np.cross(a, b), axis=1).sum()


def test_bars_that_stand_apart_are_as_wide_as_they_are():
    bars = bodies()[1]
    skin = skin_of(bars, np.zeros_like(bars), 0.01)
    assert area(skin) == pytest.approx(2 * (4 * 0.2 * 0.01 + 2 * 0.01**2))
    assert np.ptp(skin.corners[..., 1]) == pytest.approx(0.075 + 0.01)
    lattice = find_lattice(bars, 0.01)
    assert lattice.step == pytest.approx([0.01, 0.01, 0.01])
    assert len(set(map(tuple, lattice.place))) == len(bars)


def test_no_face_is_as_white_as_the_paper(tmp_path, monkeypatch):
    """Undamaged bodies, which are pale, cover what dark ones cover, from above and from below."""
    monkeypatch.setattr("post.scene.WIDE", (500, 400))
    drawn = []
    monkeypatch.setattr("post.scene._trim", lambda image: drawn.append(image) or image)
    for damage in (0.0, 1.0):
        folder = tmp_path / str(damage)
        draw_bodies(write_scene(folder, damage=damage), folder)
    for pale, dark in ((drawn[0], drawn[2]), (drawn[1], drawn[3])):
        seen, there = (image[..., :3].min(2) < 245 for image in (pale, dark))
        assert there.sum() > 20000 and (seen & there).sum() > 0.99 * there.sum()


# --- colours and names --------------------------------------------------------------------------


def test_each_material_has_its_colour_and_its_name(scene):
    tints = tints_of(scene.deck)
    assert tints.of_body == {1: 0, 2: 1, 3: 1, 4: 1}
    assert tints.labels == ["c (hjc): slab at 10 mm", "s (johnson_cook): bars, near, far at 10 mm"]
    pale = tints.paint(np.zeros(2), np.array([1, 2]))
    assert len({tuple(np.round(colour, 3)) for colour in pale}) == 2
    dark = tints.paint(np.ones(2), np.array([1, 2]))
    np.testing.assert_array_equal(dark[0], dark[1])  # the scale of damage is that of all
    assert len(TINTS) == len(set(TINTS))


def test_bodies_of_one_material_have_a_colour_each(tmp_path):
    run = write_scene(tmp_path)
    run.deck = type(run.deck)(DECK.replace("material = 's'", "material = 'c'"))
    assert tints_of(run.deck).of_body == {1: 0, 2: 1, 3: 2, 4: 3}


# --- times and stretch --------------------------------------------------------------------------


def test_the_sheet_shows_the_loading(tmp_path):
    """Half of the times of a blast lie where the impulse is given, at 0.16 to 0.33 ms of 3 ms."""
    folder = write_run(tmp_path / "a", nx=4, frames=301, rows=30, spacing=0.0125)
    time = np.linspace(0, 3e-3, 3001)
    for name, columns in (
        ("energy", {"solid_kinetic[J]": 50 * np.exp(-(((time - 0.3e-3) / 1e-4) ** 2)),
                    "impulse_z[N s]": np.clip((time - 0.16e-3) / 0.17e-3, 0, 1)}),
    ):  # fmt: skip
        rows = np.column_stack([time, *columns.values()])
        head = ",".join(["time[s]", *columns])
        np.savetxt(folder / f"{name}.csv", rows, delimiter=",", header=head, comments="")
    series = folder / "solid.vtkhdf.series"
    files = json.loads(series.read_text())["files"]
    for kind in ("air", "solid"):
        later = [
            dict(f, name=f["name"].replace("solid", kind), time=1e-5 * i)
            for i, f in enumerate(files)
        ]
        (folder / f"{kind}.vtkhdf.series").write_text(json.dumps({"files": later}))
    times = np.array([frame.time for frame in pick_frames(Run(folder), 5)])
    assert len(times) == 5 and times[-1] == pytest.approx(3e-3)
    assert (times < 0.16e-3).sum() == 1
    assert ((times > 0.16e-3) & (times < 0.5e-3)).sum() >= 3


def test_few_dumps_are_all_shown(tmp_path):
    run = write_scene(tmp_path, times=(0.0, 1e-4, 2e-4, 3e-4))
    assert [frame.number for frame in pick_frames(run, 5)] == [1, 2, 3]


def test_the_stretch_of_the_strips_is_told(tmp_path, monkeypatch):
    run = write_scene(tmp_path, times=(1e-4, 2e-4), rise=50.0)
    kept = []
    monkeypatch.setattr("post.section.save", lambda figure, path: kept.append(figure) or path)
    picture = draw_sheet(run, tmp_path)
    told = float(re.search(r"stretched ([\d.]+) times", picture.caption)[1])
    strip = next(a for a in kept[0].axes if " : 1" in a.get_ylabel())
    box = strip.get_window_extent()
    across, up = box.width / np.ptp(strip.get_xlim()), box.height / np.ptp(strip.get_ylim())
    assert told == pytest.approx(up / across, rel=0.06)
    assert strip.get_ylim()[0] > -0.05  # the spheres below are no part of the range
    texts = [text.get_text() for legend in kept[0].legends for text in legend.get_texts()]
    assert texts == tints_of(run.deck).labels
    plt.close(kept[0])


# --- labels ---------------------------------------------------------------------------------------


def notes_of(figure):
    return [(a, t) for a in figure.axes for t in a.texts if t.get_gid() == NOTE]


def check_notes(figure):
    """Every note lies inside its panel and on no other one."""
    figure.draw_without_rendering()
    boxes = []
    for axis, text in notes_of(figure):
        box, frame = text.get_window_extent(), axis.get_window_extent()
        assert box.x0 >= frame.x0 and box.x1 <= frame.x1, text.get_text()
        assert box.y0 >= frame.y0 and box.y1 <= frame.y1, text.get_text()
        assert not any(box.overlaps(other) for other in boxes), text.get_text()
        boxes.append(box)
    assert boxes


@pytest.mark.parametrize("at", [(0.0, 0.0), (1.0, 1.0), (0.0, 1.0), (1.0, 0.0), (0.02, 0.5)])
def test_notes_stay_inside_and_apart(at):
    figure, axis = new_figure()
    axis.plot([0, 1], [0, 1])
    axis.set_xlim(0, 1)
    axis.set_ylim(0, 1)
    for text in ("impulse 62.2 Pa s", "peak 3.55 MPa at 0.0670 ms", "arrival 0.0549 ms"):
        note(axis, text, at)
    settle(figure)
    check_notes(figure)
    plt.close(figure)


def test_labels_of_gauges_and_references(tmp_path, monkeypatch):
    """An early pulse, references of all kinds: no label on a title or frame, every line named."""
    folder = write_run(tmp_path / "a", nx=4, frames=2, rows=900, spacing=0.0125)
    (tmp_path / "r.csv").write_text(
        "quantity, gauge, value, unit, source\n"
        "arrival, A, 0.12, ms, paper\npeak, mid, 8, mm, paper\nfinal, mid, 5.6, mm, paper\n"
    )
    references = read_references(tmp_path / "r.csv")
    run, kept = Run(folder), []
    run.gauges.data["free:pressure"] = np.roll(run.gauges.data["free:pressure"], -90)
    for name in ("gauge_picture", "motion_picture"):
        monkeypatch.setattr(f"post.{name}.save", lambda figure, path: kept.append(figure) or path)
    draw_gauges(run, references, tmp_path)
    draw_motion(run, references, tmp_path)
    named = [
        t.get_text()
        for f in kept
        for a in f.axes
        if a.get_legend()
        for t in a.get_legend().get_texts()
    ]
    for text in ("arrival 0.120 ms: paper", "peak 8.00 mm: paper", "final 5.60 mm: paper"):
        assert text in named
    assert "arrival, 10 % of the peak" in named
    for figure in kept:
        settle(figure)
        check_notes(figure)
        plt.close(figure)


# --- totals ---------------------------------------------------------------------------------------


def write_totals(folder, columns, time=None):
    """A run of the quarter of a plate whose energy.csv has these columns."""
    write_run(folder, nx=4, frames=2, rows=30, spacing=0.0125)
    time = np.linspace(0, 4.5e-4, 10) if time is None else time
    rows = np.column_stack([time, *(np.broadcast_to(v, time.shape) for v in columns.values())])
    head = ",".join(["time[s]", *columns])
    np.savetxt(folder / "energy.csv", rows, delimiter=",", header=head, comments="")
    return Run(folder)


def test_numerical_shares_are_those_of_the_energy_put_in(tmp_path):
    """Bodies that start at 4000 J and get 100 J by the air: 1000 J of viscosity are 24.4 %."""
    ramp = np.linspace(0, 1, 10)
    columns = {"solid_kinetic[J]": 4000 - 3000 * ramp, "load_work[J]": 100 * ramp}
    columns |= {"viscous[J]": 1000 * ramp, "contact_heat[J]": 410 * ramp, "coupling[J]": ramp}
    run = write_totals(tmp_path, columns)
    assert energy_put_in(run.energy) == pytest.approx(4100)
    text = as_text(balance_table(run))
    assert re.search(r"artificial viscosity.*of the energy put in +24 % +24 %", text)
    assert re.search(r"contact: springs and heat, of the energy put in +10 % +10 %", text)
    assert re.search(r"work lost between air and bodies, of the work of the air +1 % +1 %", text)
    assert "4.10 kJ (16.4 kJ whole)" in balance_table(run).note


def test_a_quarter_is_told_of_the_whole_too(tmp_path):
    ramp = np.linspace(0, 1, 10)
    columns = {"solid_kinetic[J]": 87.5 * np.sin(np.pi * ramp), "impulse_x[N s]": ramp}
    columns |= {"impulse_z[N s]": -60 * ramp}
    run = write_totals(tmp_path, columns)
    rows = {row[0]: row for row in totals_table(run).rows}
    top = 4 * run.energy["solid_kinetic"].max()
    assert rows["kinetic energy of the bodies"][4] == f"{top:.0f} J"
    assert rows["impulse of the air on the bodies, z"][4:] == ("-240 N s", "-240 N s")
    assert rows["impulse of the air on the bodies, x"][4:] == ("0 N s", "0 N s")
    (plate,) = body_table(run).rows
    assert plate[1] == "0.0984 kg (0.394 kg)"
    (tmp_path / "r.csv").write_text(
        "quantity, gauge, value, unit, source\npeak, whole:solid_kinetic, 350, J, paper\n"
        "peak, solid_kinetic, 87.5, J, paper\nfinal, whole:plate:mass, 0.4, kg, paper\n"
    )
    found = compare(run, read_references(tmp_path / "r.csv"))[-3:]
    assert found[0].measured == pytest.approx(top) and found[1].measured == pytest.approx(top / 4)
    assert found[2].measured == pytest.approx(4 * 0.0984)


def test_the_whole_scene_needs_no_second_figures(tmp_path):
    run = write_totals(tmp_path, {"solid_kinetic[J]": 5.0})
    run.deck = type(run.deck)(run.deck.text.replace("symmetry = 'x', 'y'", ""))
    assert totals_table(run).heads == ("what", "largest", "at", "at the end")


# --- bodies in three dimensions -------------------------------------------------------------------


def test_faces_know_their_particles(scene):
    solids = gather_solids(scene, scene.frames[0], 1.0)
    assert len(solids.face) == len(solids.corners) and not len(solids.point)
    middle = np.abs(solids.corners.mean(1))
    rest = np.concatenate(bodies())[solids.face]
    assert np.abs(middle - np.abs(rest)).max() < 0.0051


def test_bodies_picture_names_materials(scene, tmp_path):
    picture = draw_bodies(scene, tmp_path)
    assert matplotlib.image.imread(picture.path).shape[1] >= 900
