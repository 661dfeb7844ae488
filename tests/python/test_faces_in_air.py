# SPDX-License-Identifier: MIT
"""The stress of the material at faces that the air loads: brz_face_stress."""

import h5py
import numpy as np
import pytest
from notes import note
from test_gpu import follows_the_cpu
from test_loads import run
from test_ranks import go, in_two, needs_mpirun
from tiers import slow


def block(dimension, form, per_cell, layers, sides="x"):
    """A block behind planes of symmetry; from `sides` air of 2 MPa comes slowly."""
    cell, span, cells, bc, planes = per_cell * 1e-3, [], [], [], []
    for a in range(3):
        if a >= dimension:
            span, cells, bc = [*span, 0, 1], [*cells, 1], [*bc, "symmetry", "symmetry"]
            continue
        high = layers * 1e-3 + (6e-3 if "xyz"[a] in sides else 0)
        span, cells = [*span, 0, high], [*cells, round(high / cell)]
        bc += ["symmetry", "outflow" if "xyz"[a] in sides else "wall"]
        planes.append("xyz"[a])
    box = [0, layers * 1e-3] * dimension + [0, 1] * (3 - dimension)
    words = [
        f"""\
&run t_end=3e-4, dimension={dimension}, symmetry={", ".join(map(repr, planes))} /
&air box={", ".join(map(str, span))}, cells={", ".join(map(str, cells))},
     bc={", ".join(map(repr, bc))} /
&material id='s', model='linear_elastic', density=2000, youngs_modulus=10e9, poisson_ratio=0.2 /
&body id='b', box={", ".join(map(str, box))}, spacing=1e-3, material='s', formulation='{form}' /
&output dump_every=1e-5 /
"""
    ]
    words += [f"""\
&inflow face='{a}+', time=0,1.5e-4,1, density=1.225,2.4,2.4, velocity=0,0,0, 0,0,0, 0,0,0,
        pressure=101325,2101325,2101325 /
""" for a in sides]  # fmt: skip
    return "".join(words)


def pressures(folder, layers, a=0, after=26):
    """Mean stress along an axis of the layers from its face inwards [Pa]."""
    found = []
    for path in sorted(folder.glob("solid_*.vtkhdf"))[after:]:
        with h5py.File(path) as file:
            x = np.array(file["VTKHDF/Points"])[:, a]
            s = np.array(file["VTKHDF/PointData/stress"]).reshape(len(x), -1)[:, a]
        layer = np.floor(x / 1e-3).astype(int)
        found.append([s[layer == k].mean() for k in reversed(range(layers))])
    return -np.mean(found, axis=0)


# The load of a face of the air is spread over two cells; the stress of the outermost layer meets
# the pressure, and so do those below: 0.1 to 0.9 of it where they feel what acts above them alone.
@pytest.mark.parametrize(("dimension", "per_cell", "layers", "form"), [
    (*case, form) if case[0] == 2 or form == "bending" else slow(*case, form)
    for case in [(1, 2, 12), (1, 3, 12), (2, 2, 6), (3, 2, 4)]
    for form in ("bending", "corrected_hourglass", "total_lagrangian")
])  # fmt: skip
def test_the_stress_at_a_face_meets_the_air(tmp_path, dimension, per_cell, layers, form):
    tables = run(tmp_path, block(dimension, form, per_cell, layers))
    energy = tables["energy"]
    assert np.abs(energy["coupling_error[-]"]).max() < 1e-5
    pressed = pressures(tmp_path / "out" / "load", layers) / 2e6
    for layer, value in enumerate(pressed[:3], 1):
        note(f"face_in_air_{dimension}_{per_cell}_{form}_{layer}", value)
    assert pressed == pytest.approx(np.ones(layers), abs=0.03)
    # the energy of the block, less that of what lies above the mean depth of the load, which the
    # air does not pay: the nodes of a cell bear a third on its face and two thirds a cell below
    depth = (np.arange(2 * per_cell) + 0.5) / per_cell
    weight = np.maximum(1 - depth, 0) / 1.5 + (1 - abs(1 - depth)) / 1.5
    depth = per_cell * (depth * weight).sum() / weight.sum()
    softness = (1 - 2 * 0.2**2 / (1 - 0.2), 1 - 0.2**2, 1)[dimension - 1] / 10e9
    volume = (layers * 1e-3) ** (dimension - 1) * (layers - depth) * 1e-3
    held = 2e6**2 / 2 * softness * volume
    assert energy["solid_internal[J]"][-1] == pytest.approx(held, rel=0.02)


# Air that presses on a block from all sides alike: the same stress in every layer, at rest. At the
# free edge nodes bear loads by mass, a third too little at it and a sixth too much beside it.
@pytest.mark.parametrize("form", ["bending", "corrected_hourglass"])
def test_air_from_all_sides_presses_evenly(tmp_path, form):
    tables = run(tmp_path, block(2, form, 2, 8, sides="xy"))
    for a in (0, 1):
        pressed = pressures(tmp_path / "out" / "load", 8, a) / 2e6
        note(f"face_in_air_even_{form}_{'xy'[a]}", pressed[0])
        assert pressed == pytest.approx(np.ones(8), abs=0.06)
    energy = tables["energy"]
    assert energy["solid_kinetic[J]"][-1] < 1e-2 * energy["solid_internal[J]"][-1]
    assert np.abs(energy["coupling_error[-]"]).max() < 1e-5


# Two columns at a corner, with a part of the faces in each process: the bits of one process, which
# go on alike from a checkpoint. And on the emulated GPU.
@needs_mpirun
def test_faces_on_several_processes_and_after_a_restart(tmp_path):
    deck = block(2, "bending", 2, 26, "xy").replace("3e-4", "6e-5")
    deck = deck.replace("dump_every=1e-5", "dump_every=1e-5, checkpoint_every=2e-5")
    deck += "&gauge id='g', body='b', at=0.0255,0.0135,0.5, quantity='velocity_x' /\n"
    folders = [tmp_path / name for name in ("one", "four", "parts")]
    for folder, n in zip(folders, (0, 4, 0), strict=True):
        folder.mkdir()
        if folder.name == "parts":
            (folder / "deck.nml").write_text(deck)
            in_two(n, n, 25, folder)
        else:
            go(n, deck, folder)
    names = sorted(path.name for path in (folders[0] / "out").glob("solid_*.vtkhdf"))
    for name in names[1:]:
        values = []
        for folder in folders:
            with h5py.File(folder / "out" / name) as file:
                values.append(np.array(file["VTKHDF/PointData/stress"]))
        assert (values[1] == values[0]).all()
        assert (values[2] == values[0]).all()
    assert np.abs(values[0]).max() > 1e5
    (tmp_path / "gpu").mkdir()
    (tmp_path / "gpu" / "deck.nml").write_text(deck)
    follows_the_cpu(folders[0] / "out", tmp_path / "gpu")


@pytest.mark.parametrize(("layers", "per_cell"), [(2, 2), (3, 3), (4, 2)])
def test_air_on_both_sides_of_a_thin_plate(tmp_path, layers, per_cell):
    high = layers * 1e-3
    deck = f"""\
&run t_end=3e-4, dimension=1 /
&air box=-6e-3,{6e-3 + high}, 0,1, 0,1, cells={round((12 + layers) / per_cell)},1,1 /
&material id='s', model='linear_elastic', density=2000, youngs_modulus=10e9, poisson_ratio=0.2 /
&body id='b', box=0,{high}, 0,1, 0,1, spacing=1e-3, material='s' /
&output dump_every=1e-5 /
"""
    for side in ("x-", "x+"):
        deck += f"""\
&inflow face='{side}', time=0,1.5e-4,1, density=1.225,2.4,2.4, velocity=0,0,0, 0,0,0, 0,0,0,
        pressure=101325,2101325,2101325 /
"""
    tables = run(tmp_path, deck)
    pressed = pressures(tmp_path / "out" / "load", layers) / 2e6
    assert pressed == pytest.approx(np.ones(layers), abs=0.03)
    assert abs(tables["bodies"]["b:velocity_x[m/s]"][-1]) < 1e-9
