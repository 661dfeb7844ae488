# SPDX-License-Identifier: MIT
"""Energies by body and material, pieces of a broken plate, rings of cracks: known answers."""

import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE.parents[1]), str(HERE)]

from synthetic_run import write_run  # noqa: E402
from test_perforation import Made  # noqa: E402
from test_post_compare import star  # noqa: E402

from post.cracks import circumferential_cracks, crossings_along  # noqa: E402
from post.energies import body_energies, energy_of, material_energies  # noqa: E402
from post.errors import PostError  # noqa: E402
from post.fragments import find_fragments, fragment_table, largest_piece  # noqa: E402
from post.reader import Run  # noqa: E402
from post.surface import edges_of, find_lattice  # noqa: E402


def test_energies_are_those_of_the_whole(tmp_path):
    run = Run(write_run(tmp_path / "one", nx=4, frames=1, rows=50, spacing=0.0125))
    energies = body_energies(run)
    assert list(energies) == ["plate"]
    assert energies["plate"].kinetic == pytest.approx(4 * run.energy["solid_kinetic"])  # a quarter
    assert energies["plate"].total == pytest.approx(
        4 * (run.bodies["plate:kinetic"] + run.bodies["plate:internal"])
    )
    assert material_energies(run)["cfrp"].internal == pytest.approx(energies["plate"].internal)
    assert energy_of(run, ["plate", "ball"]).kinetic == pytest.approx(energies["plate"].kinetic)
    with pytest.raises(PostError, match="none of ball"):
        energy_of(run, ["ball"])


def thrown(made, folder, chosen, velocity):
    """A plate of which some particles have moved together, with masses and velocities."""
    made.move[chosen] = [0, 0, 0.01]
    run = made.run(folder)
    speed = np.zeros_like(made.x)
    speed[chosen] = velocity
    with h5py.File(run.frames[-1].solid_path, "a") as file:
        data = file["VTKHDF/PointData"]
        data["mass"] = np.full(len(made.x), 1600 * made.spacing**3)
        data["density"] = np.full(len(made.x), 1600.0)
        data["velocity"] = speed
    return Run(folder)


@pytest.mark.parametrize("quarter", [False, True])
def test_a_plug_is_one_piece(tmp_path, quarter):
    """A plug on the axis: the same mass, size and speed from the whole and from a quarter."""
    made = Made(quarter)
    run = thrown(made, tmp_path, made.within(3e-3), [1.0, 2.0, 30.0])
    plate, plug = find_fragments(run, run.frames[-1], "plate")
    images = 4 if quarter else 1
    volume = images * made.within(3e-3).sum() * made.spacing**3
    assert plug.mass == pytest.approx(1600 * volume)
    assert plug.size == pytest.approx((6 * volume / np.pi) ** (1 / 3))
    # across a plane of symmetry the velocities of the images cancel
    assert plug.velocity == pytest.approx([0, 0, 30] if quarter else [1, 2, 30])
    assert plug.copies == plate.copies == 1
    assert plate.mass + plug.mass == pytest.approx(images * 1600 * len(made.x) * made.spacing**3)


def test_pieces_beside_the_planes_have_images(tmp_path):
    made = Made(quarter=True)
    run = thrown(made, tmp_path, made.within(2e-3, (8e-3, 8e-3)), [3.0, 0, 4.0])
    found = find_fragments(run, run.frames[-1], "plate")
    assert [one.copies for one in found] == [1, 4]
    assert found[1].speed == pytest.approx(5)
    table = fragment_table(found, "plate", most=1)
    assert table.rows[1][0] == "4 more" and table.rows[1][3] == "up to 5.00 m/s"
    with pytest.raises(PostError, match="no body 'ball'"):
        find_fragments(run, run.frames[-1], "ball")


def test_rings_are_counted_and_radial_cracks_are_not():
    face = star(8)
    assert np.median(circumferential_cracks(face)) == 0
    count = len(face.values)
    x = (np.arange(count) + 0.5) * face.step[0] + face.low[0]
    radius = np.hypot(*np.meshgrid(x, x, indexing="ij"))
    for ring in (0.2, 0.35):
        face.values[np.abs(radius - ring) < 0.006] = 1.0
    assert np.median(circumferential_cracks(face)) == 2
    assert crossings_along(face, 0.3, (0.05, 0.3)) == 1
    assert crossings_along(face, 0.3, (0.22, 0.3)) == 0


def test_what_stood_apart_at_the_start_is_not_loose():
    """Two bars of one body, of 30 and of 12 layers; the shorter one loses its last three."""
    places = [(0, 0, k) for k in range(30)] + [(4, 0, k) for k in range(12)]
    rest = 1e-3 * np.array([(x + i, y + j, z) for x, y, z in places for i in (0, 1)
                            for j in (0, 1)], float)  # fmt: skip
    lattice = find_lattice(rest, 1e-3)
    points = rest.copy()
    torn = (rest[:, 0] > 3e-3) & (rest[:, 2] > 8.5e-3)
    points[torn, 2] += 5e-3
    held = edges_of(points, lattice)[1]
    stays = largest_piece(lattice, held, np.ones(len(rest), bool))
    assert torn.sum() == 12 and np.array_equal(stays, ~torn)
    failed = rest[:, 2] > 20e-3  # what holds nothing is no part of a piece
    assert np.array_equal(largest_piece(lattice, held, ~failed), ~torn & ~failed)
