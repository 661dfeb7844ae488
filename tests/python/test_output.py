# SPDX-License-Identifier: MIT
"""Dumps open in h5py and pyvista as they are, with the right numbers in the right places."""

import shlex
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest
import pyvista as pv

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build" / "cpu"
P_REST = 101325.0


def run(*command):
    return subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Three scenes of three dumps each: 3d, 2d, 1d."""
    path = tmp_path_factory.mktemp("dumps")
    run("make", "-s", "lib")
    flags = shlex.split(run("pkg-config", "--cflags", "--libs-only-L", "hdf5-serial"))
    source = str(Path(__file__).with_name("sample_dumps.f90"))
    modules = ["-I", str(BUILD / "mod"), "-J", str(path)]
    libraries = [
        str(BUILD / "brisance.o"),
        str(BUILD / "obj/version.o"),
        *flags,
        "-lhdf5_fortran",
        "-lhdf5",
        "-lz",
    ]
    run("gfortran", "-fopenmp", *modules, source, "-o", str(path / "sample"), *libraries)
    run(str(path / "sample"), str(path))
    return path


@pytest.fixture(params=["3d", "2d", "1d"])
def scene(request, folder):
    return folder / request.param


def cells_of(scene):
    return {"3d": (5, 4, 3), "2d": (6, 4, 1), "1d": (7, 1, 1)}[scene.name]


SIDES = np.array([0.1, 0.2, 0.4])  # of a cell
LOW = np.array([-1.0, 2.0, 3.0])  # corner of the box


def text(attribute):
    return attribute.decode() if isinstance(attribute, bytes) else str(attribute)


def test_air_opens_in_pyvista(scene):
    grid = pv.read(scene / "air_00001.vtkhdf")
    cells = cells_of(scene)
    assert isinstance(grid, pv.ImageData)
    assert grid.n_cells == np.prod(cells)
    assert grid.dimensions == tuple(n + 1 for n in cells)
    assert grid.spacing == pytest.approx(SIDES)
    # the real extents, also of what is not modelled: volumes and masses of cells are right
    ends = np.stack([LOW, LOW + cells * SIDES], 1)
    assert grid.bounds == pytest.approx(ends.ravel())
    names = {"density", "pressure", "overpressure", "velocity", "solid"}
    assert set(grid.cell_data.keys()) == names
    assert grid.field_data["time"][0] == 0.1
    assert grid.field_data["cycle"][0] == 10


def test_air_values_stand_in_their_cells(scene):
    grid = pv.read(scene / "air_00000.vtkhdf")
    # cell numbers from the place of the cell, not from the order in the file
    middle_of_first = np.array([-0.95, 2.1, 3.2])
    place = np.rint((grid.cell_centers().points - middle_of_first) / SIDES).astype(int) + 1
    i, j, k = place.T
    gas = grid.cell_data["solid"] == 0
    assert (~gas).sum() == 1 and tuple(place[~gas][0]) == (2, 1, 1)
    np.testing.assert_array_equal(grid.cell_data["density"][gas], (1 + i + 10 * j + 100 * k)[gas])
    np.testing.assert_allclose(grid.cell_data["velocity"][gas], place[gas], rtol=1e-6)
    np.testing.assert_allclose(grid.cell_data["overpressure"][gas], 1000.0 * i[gas], rtol=1e-6)
    np.testing.assert_allclose(grid.cell_data["pressure"][gas], P_REST + 1000.0 * i[gas], rtol=1e-6)
    # a cell full of solid shows undisturbed air, never what its place holds
    assert grid.cell_data["pressure"][~gas] == pytest.approx(P_REST)
    assert not grid.cell_data["velocity"][~gas].any()


def test_particles_open_in_pyvista(scene):
    cloud = pv.read(scene / "solid_00002.vtkhdf")
    assert isinstance(cloud, pv.PolyData)
    assert cloud.n_points == 7 and cloud.n_verts == 7 and cloud.n_cells == 7
    data = cloud.point_data
    np.testing.assert_array_equal(data["id"], np.arange(1, 8))
    place = 8 - np.arange(1, 8)  # where the solver keeps particle 1, 2, ...
    np.testing.assert_allclose(cloud.points, np.outer(place, [1, 2, 3]) + 0.25)
    np.testing.assert_allclose(data["displacement"], 0.25)
    np.testing.assert_array_equal(data["body"], [2, 2, 2, 2, 1, 1, 1])
    np.testing.assert_array_equal(data["fixed"], [0, 0, 0, 0, 0, 0, 1])
    np.testing.assert_array_equal(data["ply"], [3, 0, 0, 0, 0, 0, 0])
    velocity = np.outer(place, [1.0, 1.0, 1.0]) + [0, 10, 0]
    velocity[6] = 0  # held
    np.testing.assert_allclose(data["velocity"], velocity)
    np.testing.assert_allclose(data["stress"], np.outer(place, [1, 2, 3, 4, 5, 6]))
    np.testing.assert_allclose(data["pressure"], -2.0 * place)
    mises = np.sqrt(1.5 * (1 + 0 + 1) + 3 * (16 + 25 + 36))  # deviator -1, 0, 1 and shears 4, 5, 6
    np.testing.assert_allclose(data["von_mises"], mises * place, rtol=1e-6)
    tension = np.linalg.eigvalsh([[1, 4, 6], [4, 2, 5], [6, 5, 3]])[-1]
    np.testing.assert_allclose(data["principal_tension"], tension * place, rtol=1e-6)
    np.testing.assert_allclose(data["density"], 3000.0)
    np.testing.assert_allclose(data["mass"], 0.5 * place)
    np.testing.assert_allclose(data["volume"], 0.5 * place / 3000.0, rtol=1e-6)


def test_names_of_bodies_and_materials_stand_in_the_dump(scene):
    field = pv.read(scene / "solid_00002.vtkhdf").field_data
    assert list(field["body_names"]) == ["plate", "a longer name"]
    assert list(field["material_names"]) == ["steel"]


def test_gas_stands_in_the_dump(scene):
    field = pv.read(scene / "air_00001.vtkhdf").field_data
    assert field["gamma"] == pytest.approx([1.4])
    assert field["rest_density"] == pytest.approx([1.225])
    assert field["rest_pressure"] == pytest.approx([P_REST])


@pytest.mark.parametrize("kind", ["air", "solid"])
def test_series_give_the_times(scene, kind):
    reader = pv.get_reader(scene / f"{kind}.vtkhdf.series")
    np.testing.assert_allclose(reader.time_values, [0.0, 0.1, 0.2])
    reader.set_active_time_value(reader.time_values[2])
    assert reader.read().field_data["cycle"][0] == 20


@pytest.mark.parametrize("kind", ["air", "solid"])
def test_origin_of_a_file_is_in_it(scene, kind):
    with h5py.File(scene / f"{kind}_00001.vtkhdf") as file:
        about = file["brisance"].attrs
        deck = text(about["deck"])
        assert deck.startswith("&run") and len(deck) > 100_000  # longer than plain attributes allow
        assert deck == (scene / "sample.echo.nml").read_text()
        assert text(about["units"]) == "SI"
        assert about["schema"][0] == 1
        assert text(about["title"]) == "A sample"
        assert text(about["version"]) and text(about["commit"])
        assert about["time"][0] == 0.1 and about["cycle"][0] == 10


def test_shapes_and_types_in_the_file(scene):
    nx, ny, nz = cells_of(scene)
    with h5py.File(scene / "air_00000.vtkhdf") as file:
        group = file["VTKHDF"]
        assert group.attrs["Type"] == b"ImageData"
        assert list(group.attrs["Version"]) == [2, 0]
        assert group["CellData/pressure"].shape == (nz, ny, nx)
        assert group["CellData/velocity"].shape == (nz, ny, nx, 3)
        assert group["CellData/pressure"].dtype == np.float32
        assert group["CellData/solid"].dtype == np.int8
        assert text(group["CellData/pressure"].attrs["units"]) == "Pa"
    with h5py.File(scene / "solid_00000.vtkhdf") as file:
        group = file["VTKHDF"]
        assert group["Points"].shape == (7, 3)
        assert group["PointData/stress"].shape == (7, 6)
        assert group["Vertices/Offsets"].dtype == np.int64


def test_nothing_half_written_is_left(scene):
    assert not list(scene.glob("*.tmp"))
