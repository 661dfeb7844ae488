# SPDX-License-Identifier: MIT
"""A made-up run in the layout of Brisance: a blast above a clamped plate, quarter model.

The numbers are formulas, not physics that was computed; they have the right size and shape, so
that the reader, the measurements and the pictures can be tested without a solver.
"""

import json
from pathlib import Path

import h5py
import numpy as np

P0 = 101325.0
HALF = 0.125  # half side of the plate [m]
THICK = 0.0042
CHARGE_Z = 0.4
T_END = 0.45e-3

DECK = """Complete deck in SI units; values that are defaults are marked.

&run
  title = 'Synthetic blast on a plate'
  t_end = {t_end}
  symmetry = 'x', 'y'
/

&air
  box = 0.0, 0.1344, 0.0, 0.1344, -0.0392, 0.4648
  cells = {nx}, {nx}, {nz}
  density = 1.225 ! default
  pressure = 101325.0 ! default
/

&charge
  id = 'tnt'
  explosive = 'tnt' ! default
  shape = 'sphere' ! default
  mass = 0.168
  at = 0.0, 0.0, 0.4
/

&material
  id = 'cfrp'
  model = 'orthotropic_ply'
/

&body
  id = 'plate'
  shape = 'box' ! default
  box = -0.125, 0.125, -0.125, 0.125, -0.0042, 0.0
  spacing = {spacing}
  material = 'cfrp'
  fix = 'sides'
/

&gauge
  id = 'A'
  at = 0.0, 0.0, 0.0028
  quantity = 'pressure' ! default
/

&gauge
  id = 'free'
  at = 0.0, 0.0, 0.2
  quantity = 'pressure' ! default
/

&gauge
  id = 'mid'
  at = 0.0, 0.0, -0.0021
  quantity = 'displacement_z'
  body = 'plate'
/

&gauge
  id = 'mid_v'
  at = 0.0, 0.0, -0.0021
  quantity = 'velocity_z'
  body = 'plate'
/
"""

ENERGY = [
    "time[s]",
    "air_kinetic[J]",
    "air_internal[J]",
    "air_outflow[J]",
    "solid_kinetic[J]",
    "solid_internal[J]",
    "hourglass[J]",
    "artificial[J]",
    "viscous[J]",
    "hourglass_heat[J]",
    "plastic[J]",
    "damage[J]",
    "air_work[J]",
    "load_work[J]",
    "coupling[J]",
    "total[J]",
    "error[-]",
    "air_mass[kg]",
    "air_outflow[kg]",
    "impulse_x[N s]",
    "impulse_y[N s]",
    "impulse_z[N s]",
    "mass_error[-]",
    "momentum_error[-]",
]


def friedlander(t, arrival, peak, duration, decay=1.3):
    """Overpressure of the ideal blast wave at a point [Pa]."""
    s = (np.asarray(t, float) - arrival) / duration
    with np.errstate(over="ignore"):
        return np.where(s >= 0, peak * (1 - s) * np.exp(-decay * np.clip(s, 0, 50)), 0.0)


def arrival_at(r):
    """Time at which the made-up shock is at distance r [s]."""
    return 0.1625e-3 * (np.maximum(r, 1e-3) / 0.4) ** 1.6


def overpressure(r, t):
    """Made-up spherical wave at distance r and time t [Pa], smeared over a few millimetres."""
    r = np.maximum(r, 0.02)
    peak = 1.9e6 * (0.4 / r) ** 2.2
    front = 1 / (1 + np.exp(-(t - arrival_at(r)) / 2e-6))
    s = np.clip((t - arrival_at(r)) / (0.06e-3 + 0.1e-3 * r / 0.4), 0, 30)
    return front * peak * (0.06 + 0.94 * np.exp(-2 * s)) - front * 4e4 * np.clip(s - 3, 0, 1)


def deflection(x, y, t):
    """Displacement of the plate along z [m]."""
    phase = np.clip((t - 0.16e-3) / 0.26e-3, 0, 1.1)
    shape = np.clip(1 - (x / HALF) ** 2, 0, 1) ** 1.3 * np.clip(1 - (y / HALF) ** 2, 0, 1) ** 1.3
    return -9.6e-3 * np.sin(0.5 * np.pi * phase) * shape


def write_run(folder, nx=12, frames=7, spacing=2.8e-3, rows=900):
    """Write a complete made-up run and return its folder."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    nz = round(nx * 3.75)
    deck = DECK.format(nx=nx, nz=nz, spacing=spacing, t_end=T_END)
    (folder / "demo.echo.nml").write_text(deck)
    times = np.linspace(0, T_END, frames)
    for number, time in enumerate(times):
        about = {"deck": deck, "job": "demo", "time": time, "cycle": number * 10}
        write_air(folder / f"air_{number:05d}.vtkhdf", time, nx, nz, about)
        write_solid(folder / f"solid_{number:05d}.vtkhdf", time, spacing, about)
    for kind in ("air", "solid"):
        files = [{"name": f"{kind}_{i:05d}.vtkhdf", "time": float(t)} for i, t in enumerate(times)]
        text = json.dumps({"file-series-version": "1.0", "files": files})
        (folder / f"{kind}.vtkhdf.series").write_text(text)
    write_histories(folder, np.linspace(0, T_END, rows))
    return folder


def begin(path, kind, about):
    """A dump with its attributes, and the group /VTKHDF."""
    file = h5py.File(path, "w")
    root = file.create_group("VTKHDF")
    root.attrs["Version"] = np.array([2, 0], "i4")
    root.attrs.create("Type", kind.encode(), dtype=f"S{len(kind)}")
    root["FieldData/time"] = np.array([about["time"]])
    root["FieldData/cycle"] = np.array([about["cycle"]], "i4")
    group = file.create_group("brisance")
    group.attrs["schema"] = np.array([1], "i4")
    for key, value in (("units", "SI"), ("version", "0.0.0"), ("commit", "none")):
        group.attrs[key] = np.bytes_(value)
    for key in ("deck", "job"):
        group.attrs[key] = np.bytes_(about[key])
    return file, root


def write_air(path, time, nx, nz, about):
    """The air of the made-up blast."""
    file, root = begin(path, "ImageData", about)
    with file:
        n, low, high = (nx, nx, nz), (0.0, 0.0, -0.0392), (0.1344, 0.1344, 0.4648)
        spacing = [(b - a) / k for a, b, k in zip(low, high, n, strict=True)]
        root.attrs["WholeExtent"] = np.array([0, nx, 0, nx, 0, nz], "i4")
        root.attrs["Origin"] = np.array(low)
        root.attrs["Spacing"] = np.array(spacing)
        root.attrs["Direction"] = np.eye(3).ravel()
        x, y, z = (low[d] + (np.arange(n[d]) + 0.5) * spacing[d] for d in range(3))
        z, y, x = np.meshgrid(z, y, x, indexing="ij")
        side = np.hypot(x, y)
        over = overpressure(np.hypot(side, z - CHARGE_Z), time)
        image = overpressure(np.hypot(side, z + CHARGE_Z), time) * 4
        over = np.where(z > 0, over + image, 0.1 * over)
        solid = (np.abs(z + THICK / 2) < spacing[2] / 2) & (x < HALF) & (y < HALF)
        over[solid] = 0
        root["CellData/pressure"] = (over + P0).astype("f4")
        root["CellData/overpressure"] = over.astype("f4")
        root["CellData/density"] = (1.225 * (1 + over / P0) ** 0.6).astype("f4")
        root["CellData/velocity"] = np.zeros((*over.shape, 3), "f4")
        root["CellData/solid"] = solid.astype("i1")


def write_solid(path, time, spacing, about):
    """The plate of the made-up blast."""
    n = round(HALF / spacing)
    layers = max(round(THICK / spacing), 1)
    axis = (np.arange(n) + 0.5) * HALF / n
    depth = -THICK + (np.arange(layers) + 0.5) * THICK / layers
    z, y, x = (a.ravel() for a in np.meshgrid(depth, axis, axis, indexing="ij"))
    move = np.zeros((x.size, 3))
    move[:, 2] = deflection(x, y, time)
    rim = np.exp(-(((HALF - np.maximum(x, y)) / 0.012) ** 2))
    centre = 0.8 * np.exp(-(x**2 + y**2) / 0.03**2)
    grown = np.clip((time - 0.18e-3) / 0.15e-3, 0, 1)
    damage = np.clip(grown * (rim + centre) * (0.8 + 0.2 * np.cos(90 * x) * np.cos(90 * y)), 0, 1)
    file, root = begin(path, "PolyData", about)
    with file:
        count = x.size
        root["NumberOfPoints"] = np.array([count])
        root["Points"] = (np.stack([x, y, z], 1) + move).astype("f4")
        for kind in ("Vertices", "Lines", "Polygons", "Strips"):
            cells = count if kind == "Vertices" else 0
            root[f"{kind}/NumberOfCells"] = np.array([cells])
            root[f"{kind}/NumberOfConnectivityIds"] = np.array([cells])
            root[f"{kind}/Offsets"] = np.arange(cells + 1)
            root[f"{kind}/Connectivity"] = np.arange(cells)
        data = root.create_group("PointData")
        data["id"] = np.arange(1, count + 1, dtype="i4")
        for name in ("body", "material", "ply"):
            data[name] = np.ones(count, "i4")
        data["fixed"] = (np.maximum(x, y) > HALF - 3 * spacing).astype("i1")
        data["velocity"] = (move * 4e3).astype("f4")
        data["displacement"] = move.astype("f4")
        data["pressure"] = np.zeros(count, "f4")
        data["stress"] = np.zeros((count, 6), "f4")
        data["damage"] = damage.astype("f4")
        data["damage_fibre_tension"] = (0.3 * damage).astype("f4")
        data["energy"] = np.zeros(count, "f4")


def write_histories(folder, t):
    """The three history files."""
    late = np.clip((t - 0.16e-3) / 0.26e-3, 0, 1.1)
    bend = np.sin(0.5 * np.pi * late)
    column = {name: np.zeros_like(t) for name in ENERGY}
    column["time[s]"] = t
    start = 180180.0
    given = 140 * np.clip(late * 2, 0, 1)
    column["air_kinetic[J]"] = 1.1e5 * np.clip(t / 0.1e-3, 0, 1) * np.exp(-t / 0.8e-3)
    column["air_outflow[J]"] = 4e4 * np.clip(t / 0.2e-3 - 1, 0, 2)
    column["solid_kinetic[J]"] = given * np.cos(0.5 * np.pi * np.clip(late, 0, 1)) ** 2
    column["damage[J]"] = 6 * np.clip(late, 0, 1) ** 2
    column["viscous[J]"] = 3 * np.clip(late, 0, 1)
    column["hourglass[J]"] = 0.8 * bend
    column["solid_internal[J]"] = given - column["solid_kinetic[J]"] - column["hourglass[J]"]
    column["air_work[J]"] = given
    column["load_work[J]"] = given * 0.998
    column["coupling[J]"] = given * 0.002
    column["total[J]"] = start * (1 + 3e-13 * np.sin(t / 3e-5))
    column["air_internal[J]"] = (
        column["total[J]"] - column["air_kinetic[J]"] - column["air_outflow[J]"] - given
    )
    column["error[-]"] = column["total[J]"] / start - 1
    column["impulse_z[N s]"] = -5.1 * np.clip(late * 1.5, 0, 1)
    column["mass_error[-]"] = 1e-15 * np.ones_like(t)
    column["momentum_error[-]"] = 2e-15 * np.ones_like(t)
    save(folder / "energy.csv", column)
    save(
        folder / "gauges.csv",
        {
            "time[s]": t,
            "A:pressure[Pa]": P0 + friedlander(t, 0.17e-3, 6.8e6, 0.2e-3),
            "free:pressure[Pa]": P0 + overpressure(np.array(0.2), t),
            "mid:displacement_z[m]": deflection(0.0, 0.0, t),
            "mid_v:velocity_z[m/s]": np.gradient(deflection(0.0, 0.0, t), t),
        },
    )
    save(
        folder / "bodies.csv",
        {
            "time[s]": t,
            "plate:mass[kg]": np.full_like(t, 0.0984),
            "plate:x[m]": np.full_like(t, 0.0625),
            "plate:y[m]": np.full_like(t, 0.0625),
            "plate:z[m]": -0.0021 + 0.35 * deflection(0.0, 0.0, t),
            "plate:velocity_z[m/s]": 0.35 * np.gradient(deflection(0.0, 0.0, t), t),
            "plate:kinetic[J]": column["solid_kinetic[J]"],
            "plate:internal[J]": column["solid_internal[J]"],
            "plate:damage_mean[-]": 0.12 * np.clip(late, 0, 1),
            "plate:load_work[J]": column["load_work[J]"],
            "plate:reaction_z[N s]": 3 * np.clip(late, 0, 1),
        },
    )


def save(path, columns):
    """One history file."""
    rows = np.stack([np.broadcast_to(v, columns["time[s]"].shape) for v in columns.values()], 1)
    with path.open("w") as file:
        file.write(",".join(columns) + "\n")
        for row in rows:
            file.write(",".join(f"{value:.16e}" for value in row) + "\n")
