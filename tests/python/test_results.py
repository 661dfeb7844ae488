# SPDX-License-Identifier: MIT
"""The results that are asked for first, on made-up particles with known answers and on a run."""

import json
import math
import os
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parents[1]), str(HERE)]
BINARY = Path(os.environ.get("BRISANCE", HERE.parents[1] / "bin" / "brisance"))

from synthetic_run import begin, save  # noqa: E402
from test_perforation import Made  # noqa: E402

from post.crater import face_loss  # noqa: E402
from post.damage import damaged_volumes  # noqa: E402
from post.deflection import measure_deflection, permanent_set  # noqa: E402
from post.impact import find_shots, measure_shot, shots_of  # noqa: E402
from post.perforation import load_plate  # noqa: E402
from post.reader import Run  # noqa: E402
from post.results import results, results_table, vertex  # noqa: E402

# --- permanent set ------------------------------------------------------------------------------


def ringing(t, stays=-18e-3, decay=0.3, mode=0.0):
    """A plate that goes to its largest deflection and rings about `stays`; and a quick mode."""
    rise = np.clip(t / 1.0, 0, 1)
    move = stays * np.sin(0.5 * np.pi * rise)
    late = np.clip(t - 1, 0, None)
    return move + 0.1 * stays * np.sin(7 * late) * np.exp(-decay * late) + mode * np.sin(90 * t)


@pytest.mark.parametrize(("end", "mode"), [(3.0, 0), (4.0, 4e-4), (9.0, 0), (9.0, 4e-4)])
def test_permanent_set_is_the_mean_of_the_ringing(end, mode):
    t = np.linspace(0, end, 3000)
    found = measure_deflection(t, ringing(t, mode=mode))
    assert found.permanent == pytest.approx(-18e-3, rel=0.01)
    assert abs(found.end + 18e-3) <= 2.2 * found.spread + 2 * mode


def test_a_plate_that_has_stopped_has_a_permanent_set():
    """No swing is needed where nothing moves any more; half a swing is no rest."""
    t = np.linspace(0, 4, 800)
    stopped = 5e-3 * np.sin(0.5 * np.pi * np.clip(t, 0, 1))
    assert permanent_set(t, stopped) == pytest.approx((5e-3, 0), abs=3e-5)
    for end in (1.0, 1.05, 1.2):  # the top of a swing is flat, and yet no rest
        t = np.linspace(0, end, 800)
        assert math.isnan(permanent_set(t, np.sin(0.5 * np.pi * t))[0])
    assert permanent_set(t, np.zeros_like(t)) == (0.0, 0.0)


def test_a_sampled_peak_is_the_vertex_of_a_parabola():
    t = np.linspace(0, 1, 30)
    when, size = vertex(t, 3 - 5 * (t - 0.4321) ** 2)
    assert (when, size) == pytest.approx((0.4321, 3), rel=1e-12)
    front = np.where(t > 0.5, np.exp(-t), 0)  # a shock: the sample, and nothing above it
    first = int(np.argmax(front))
    assert vertex(t, front) == (t[first], front[first])


def test_what_swings_to_both_sides_has_its_peak_on_the_first(tmp_path):
    """An elastic swing of -1.00 and +1.01 mm: the first, whichever is the larger by a little."""
    t = np.linspace(0, 1, 2001)
    folder = tmp_path / "out"
    folder.mkdir()
    (folder / "a.echo.nml").write_text(
        "&run t_end=1 /\n&gauge id='mid', body='p', quantity='displacement_y', at=0,0,0 /\n"
    )
    for late in (1.01, 0.99):
        move = -1e-3 * np.sin(12 * t) * np.where(t > 0.4, late, 1)
        save(folder / "gauges.csv", {"time[s]": t, "mid:displacement_y[m]": move})
        values = {one.name: one.value for one in results(Run(folder))}
        top = 1.0 if late < 1 else 1.01  # later swings to the same side count
        assert values["mid:displacement_y peak"] == pytest.approx(-1e-3 * top, rel=1e-4)


# --- craters ------------------------------------------------------------------------------------


def sum_of_images(made, chosen):
    """Particles of the whole plate; those on a plane of symmetry are their own images."""
    return sum(2 ** int(x > 1e-9) * 2 ** int(y > 1e-9) for x, y, _ in made.x[chosen])


@pytest.mark.parametrize("quarter", [False, True])
def test_crater_and_spall_of_known_depth(tmp_path, quarter):
    """A crater of 7 mm, two layers deep, in the high face; a spall of 5 mm and three layers."""
    made = Made(quarter)
    crater = made.within(7e-3) & (made.layer > 4)
    spall = made.within(5e-3) & (made.layer <= 3)
    made.fling(crater | spall)
    run = made.run(tmp_path)
    plate = load_plate(run, run.frames[-1])
    h = made.spacing
    for side, lost, radius, layers in ((1, crater, 7e-3, 2), (-1, spall, 5e-3, 3)):
        found = face_loss(plate, side)
        assert found.depth == pytest.approx(layers * h, rel=0.01)
        assert found.diameter == pytest.approx(2 * radius, abs=h)
        volume = sum_of_images(made, lost) if quarter else lost.sum()
        assert found.volume == pytest.approx(volume * h**3, rel=0.01)
        assert not found.through


def test_a_hole_is_a_crater_that_goes_through_and_a_crack_is_none(tmp_path):
    made = Made()
    x = made.x
    crack = (np.abs(x[:, 1]) < made.spacing) & (x[:, 0] > 8e-3)  # two particles wide
    made.fling(made.within(3e-3) | crack)
    run = made.run(tmp_path)
    found = face_loss(load_plate(run, run.frames[-1]), 1)
    assert found.through and found.depth == pytest.approx(2.4e-3, rel=0.01)
    assert found.diameter == pytest.approx(6e-3, abs=0.5 * made.spacing)
    made.move[:] = 0
    made.broken = made.within(4e-3) & (made.layer > 5)
    run = made.run(tmp_path / "broken")
    plate = load_plate(run, run.frames[-1])
    assert face_loss(plate, 1).area == 0  # it lies where it was
    assert face_loss(plate, 1, brushed=True).diameter == pytest.approx(8e-3, abs=made.spacing)


# --- shots --------------------------------------------------------------------------------------

H = 1e-3
SHOT = """
&run title = 'A rod through a plate', t_end = 1e-4 /
&material id = 'm', model = 'bilinear_j2' /
&body id = 'plate', shape = 'box', box = -0.02,0.02, -0.02,0.02, -0.004,0, spacing = 1e-3,
      material = 'm' /
&body id = 'rod', shape = 'box', box = -0.003,0.003, -0.003,0.003, 0.001,0.013, spacing = 1e-3,
      material = 'm', velocity = 0, 0, -800 /
"""


def block(low, high):
    """Particles of a box, shape (n, 3) [m]."""
    axes = [np.arange(round((b - a) / H)) * H + a + H / 2 for a, b in zip(low, high, strict=True)]
    return np.stack([a.ravel() for a in np.meshgrid(*axes, indexing="ij")], 1)


class Range:
    """A rod of 6 x 6 x 12 mm behind a plate of 4 mm that it has struck; mass 8 mg a particle."""

    deck = SHOT

    def __init__(self, fallen=0.05):
        self.plate = block((-0.02, -0.02, -0.004), (0.02, 0.02, 0))
        self.rod = block((-0.003, -0.003, 0.001), (0.003, 0.003, 0.013))
        self.move = [np.zeros_like(self.plate), np.zeros_like(self.rod)]
        self.speed = [np.zeros_like(self.plate), np.zeros_like(self.rod)]
        self.damage = [np.zeros(len(self.plate)), np.zeros(len(self.rod))]
        self.move[1][:, 2] = -fallen
        self.speed[1][:, 2] = -500.0

    def plug(self, mass_particles_radius, way, speed):
        """Push a disc out of the plate; how many particles it has."""
        chosen = np.hypot(*self.plate[:, :2].T) < mass_particles_radius
        self.move[0][chosen], self.speed[0][chosen] = way, speed
        return int(chosen.sum())

    def run(self, folder, slowing=0.0):
        folder.mkdir()
        (folder / "hit.echo.nml").write_text(self.deck)
        path = folder / "solid_00001.vtkhdf"
        about = {"deck": self.deck, "job": "hit", "time": 1e-4, "cycle": 1}
        file, root = begin(path, "PolyData", about)
        points = np.concatenate([self.plate, self.rod])
        with file:
            move = np.concatenate(self.move)
            root["Points"] = points + move
            data = root.create_group("PointData")
            data["displacement"], data["velocity"] = move, np.concatenate(self.speed)
            data["body"] = np.repeat([1, 2], [len(self.plate), len(self.rod)]).astype("i4")
            data["damage"] = np.concatenate(self.damage)
            data["mass"], data["density"] = np.full(len(points), 8e-6), np.full(len(points), 8e3)
        series = {"files": [{"name": path.name, "time": 1e-4}]}
        (folder / "solid.vtkhdf.series").write_text(json.dumps(series))
        rows = ["time[s],rod:velocity_z[m/s]"]
        for t in np.linspace(0, 1e-4, 101):
            v = -800 + 300 * min(t / 3e-5, 1) + slowing * max(t - 3e-5, 0)
            rows.append(f"{t},{v}")
        (folder / "bodies.csv").write_text("\n".join(rows) + "\n")
        return Run(folder)


def test_residual_velocity_plug_and_debris(tmp_path):
    """A plug of 7 mm flies straight, a chip beside it at 45 degrees, a failed particle is dust."""
    made = Range()
    count = made.plug(3.5e-3, [0, 0, -0.08], [0, 0, -550.0])
    chip = (made.plate[:, 0] > 0.015) & (made.plate[:, 1] > 0.015) & (made.plate[:, 2] < -0.002)
    made.move[0][chip], made.speed[0][chip] = [0.02, 0, -0.02], [100.0, 0, -100.0]
    lone = np.flatnonzero(np.hypot(*made.plate[:, :2].T) > 0.019)[0]
    made.damage[0][lone] = 1.0
    made.move[0][lone], made.speed[0][lone] = [0, 0, -0.03], [0, 0, -300.0]
    run = made.run(tmp_path / "out")
    (shot,) = find_shots(run.deck)
    assert (shot.projectile.id, shot.target.id, shot.side) == ("rod", "plate", 1)
    assert shot.speed == 800 and shot.diameter == pytest.approx(6e-3)
    found = measure_shot(run, shot)
    assert found.verdict == "perforated" and found.velocity == pytest.approx(500)
    assert found.mass == pytest.approx(432 * 8e-6) and found.angle == pytest.approx(0)
    assert found.plug.mass == pytest.approx(count * 8e-6)
    assert found.plug.velocity[2] == pytest.approx(-550)
    n = int(chip.sum())
    assert found.behind.mass == pytest.approx((n + 1) * 8e-6) and found.behind.pieces == 1
    assert found.behind.velocity == pytest.approx((100 * n + 300) / (n + 1))
    assert found.behind.half_angle == pytest.approx(math.pi / 4)
    assert found.behind.dust == pytest.approx(1 / (n + 1)) and found.before.mass == 0
    values = {one.name: one.value for one in results(run)}
    assert values["rod residual_velocity"] == pytest.approx(500)
    assert values["plate plug_velocity"] == pytest.approx(550)
    assert values["plate failed_volume"] == pytest.approx(1e-9)
    assert values["plate hole_rear"] == pytest.approx(7e-3, abs=H)
    assert any("plug mass" in row[0] for row in results_table(run).rows)


def test_what_is_not_through_is_not_a_residual_velocity(tmp_path):
    """A rod that still brakes, one that stays in the plate, one that comes back."""
    run = Range(fallen=0.05).run(tmp_path / "brakes", slowing=1e6)
    assert measure_shot(run, find_shots(run.deck)[0]).verdict == "not finished"
    run = Range(fallen=0.006).run(tmp_path / "inside")  # its tail is in the plate
    assert measure_shot(run, find_shots(run.deck)[0]).verdict == "not finished"
    names = [one.name for one in results(run, ("shot",))]
    assert "rod velocity_now" in names and "rod residual_velocity" not in names
    for name, way, fallen, verdict in (
        ("stuck", 500 / 7e-5, 0.006, "stopped"),
        ("back", 600 / 7e-5, -0.03, "rebounded"),
    ):
        run = Range(fallen).run(tmp_path / name, slowing=way)
        history = run.bodies
        stop = -800 + 300 + way * 7e-5
        history.data["rod:velocity_z"][history.time > 8e-5] = stop
        assert measure_shot(run, find_shots(run.deck)[0]).verdict == verdict


SMALL = """
&run t_end=4e-5, dimension=2 /
&material id='p', preset='al2024' /
&material id='f', preset='steel_4340', failure='none' /
&body id='plate', box=0,0.004,-0.03,0.03,0,1, spacing=1e-3, material='p', fix='y-','y+' /
&body id='rod', box=-0.0062,-0.0002,-0.003,0.003,0,1, spacing=1e-3, material='f',
      velocity=800,0,0 /
&output history_every=2e-7 /
"""


def test_a_rod_from_a_file_is_a_shot(tmp_path):
    """Its box is that of its particles, with their images: 25.4 mm thick, from z = 0.185 m on."""
    jobs = HERE.parents[1] / "inputs" / "jobs"
    deck = (jobs / "rod_concrete.nml").read_text().replace("ogive_rod.stl", f"{jobs}/ogive_rod.stl")
    (tmp_path / "a.nml").write_text(deck)
    coarse = ("--set", "body(slab).spacing=0.03", "--set", "run.max_steps=1")
    subprocess.run([BINARY, "run", "a.nml", "--out", "o", *coarse], cwd=tmp_path, check=True,
                   capture_output=True)  # fmt: skip
    run = Run(tmp_path / "o")
    assert find_shots(run.deck) == []
    (shot,) = shots_of(run)
    assert (shot.projectile.id, shot.target.id, shot.side) == ("rod", "slab", 1)
    assert shot.diameter == pytest.approx(0.0254, rel=0.1)
    assert shot.projectile.low[2] == pytest.approx(0.185, abs=0.004)
    assert {r.name: r.remark for r in results(run)}["rod velocity_now"] == "not finished"


def test_a_rod_through_a_plate(tmp_path):
    """A run: the rod stays whole, what it loses in momentum is in plug, debris and plate."""
    (tmp_path / "shot.nml").write_text(SMALL)
    environment = os.environ | {"OMP_NUM_THREADS": "1"}
    command = [BINARY, "run", "shot.nml", "--backend", "cpu"]
    subprocess.run(
        command, cwd=tmp_path, env=environment, check=True, capture_output=True, timeout=100
    )
    run = Run(tmp_path / "out" / "shot")
    found = {one.name: one for one in results(run)}
    speed, mass = found["rod residual_velocity"], found["rod main_mass"]
    assert speed.remark == "perforated" and 580 < speed.value < 625
    assert mass.value == pytest.approx(7830 * 0.006 * 0.006, rel=0.01)
    lost = mass.value * (800 - speed.value)
    thrown = sum(
        found[f"plate {name}_mass"].value * found[f"plate {name}_velocity"].value
        for name in ("plug", "debris")
    )
    assert 0.5 * lost < thrown < lost  # the rest bends the plate and goes into its frame
    loose = found["plate loose_volume"].value * 2785
    assert found["plate plug_mass"].value + found["plate debris_mass"].value <= 1.3 * loose
    assert found["plate spall_depth"].value == pytest.approx(4e-3, rel=0.01)
    assert "plate hole" not in found  # there are no circles in the plane


def test_damage_by_kind(tmp_path):
    made = Made(quarter=True)
    made.broken = made.within(4e-3)
    run = made.run(tmp_path)
    found = damaged_volumes(run, run.frames[-1], "plate")
    volume = 4 * made.broken.sum() * made.spacing**3
    assert found == pytest.approx({"failed": volume, "fibre": volume})


@pytest.mark.parametrize("share", [0.3, 1.0])
def test_a_face_that_is_damaged_as_a_whole_has_no_cracks_to_count(tmp_path, share):
    made = Made()
    made.broken = made.within(1.0) if share == 1 else np.abs(made.x[:, 1]) < made.spacing
    run = made.run(tmp_path)
    with h5py.File(tmp_path / "solid_00001.vtkhdf", "a") as file:
        data = file["VTKHDF/PointData"]
        data["damage_tension"] = data["damage"][:]
    found = {one.name: one for one in results(run, ("cracks",))}
    for face in ("low", "high"):
        one = found[f"plate cracks_radial_{face}"]
        if share == 1:
            assert math.isnan(one.value) and one.remark == "whole face damaged"
        else:
            assert one.value == 2 and one.remark == "2 to 2"
    if share == 1:
        assert ("plate cracks radial low", "–", "whole face damaged") in results_table(run).rows
