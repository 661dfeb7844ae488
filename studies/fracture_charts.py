#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What cracks cost, drawn from short runs: notched strips of three spacings, a glued beam.

usage: fracture_charts.py STRIPS.png BEAM.png    (half a minute of one core)
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

BRISANCE = Path(__file__).parents[1] / "bin" / "brisance"
LIGAMENT = 0.012  # half of it [m]
STRIP = """\
&run t_end={time}, dimension=2, symmetry='x','y' /
&material id='m', {material} /
&material id='air', model='linear_elastic', density=10, youngs_modulus=1e6, poisson_ratio=0.3 /
&body id='strip', box=0,0.016, 0,0.02, 0,1, spacing={spacing}, material='m', {plies}
      fix='x+', fix_layers=1, motion_time=0, motion_velocity={speed},0,0 /
&body id='notch', box=0,{spacing}, 0.012,0.02, 0,1, spacing={spacing}, material='air',
      formulation='rigid', cuts='strip' /
&interaction bodies='strip','notch', law='none' /
&output history_every={every}, dump_every={time} /
"""
# name, keys, speed of the end [m/s], time [s], energy of the deck [J/m2]
STRIPS = (
    ("concrete_48", "preset='concrete_48'", 0.15, 8e-4, 146.5),
    ("hjc_48, which has no energy", "preset='hjc_48'", 0.15, 8e-4, None),
    ("cfrp_ud across, gmt = 10 kJ/m2", "preset='cfrp_ud', gft=1e4, gmt=1e4", 1.0, 5e-4, 1e4),
)
SPACINGS = (0.004, 0.002, 0.001)
YOUNG, POISSON, ENERGY, HIGH, START, SPEED = 60e9, 0.3, 500.0, 0.006, 0.025, 0.28
BEAM = """\
&run t_end=1.5e-3, dimension=2 /
&material id='m', model='linear_elastic', density=1600, youngs_modulus=60e9, poisson_ratio=0.3 /
&body id='low', box=0,0.07, -0.006,0, 0,1, spacing={dx}, material='m',
  fix_box=0,{dx}, -0.0042,-0.0033, 0,1,
  motion_time=0,3e-4, motion_velocity=0,0,0, 0,-0.28,0 /
&body id='high', box=0,0.07, 0,0.006, 0,1, spacing={dx}, material='m',
  fix_box=0,{dx}, 0.0018,0.0027, 0,1,
  motion_time=0,3e-4, motion_velocity=0,0,0, 0,0.28,0 /
&interaction bodies='low','high', law='cohesive', tensile_strength=60e6, shear_strength=60e6,
  gi=500, gii=1000, open_box=0,0.02575,-1,1,0,1 /
&output history_every=3.75e-6, dump_every=1 /
"""


def run(deck):
    """Run a deck in a folder of its own: energy.csv, and places and damage of the last dump."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "a.nml").write_text(deck, encoding="utf-8")
        subprocess.run([BRISANCE, "run", "a.nml"], cwd=folder, check=True, capture_output=True)
        out = Path(folder) / "out" / "a"
        energy = np.genfromtxt(
            out / "energy.csv", delimiter=",", names=True, deletechars="", replace_space=" "
        )
        with h5py.File(sorted(out.glob("solid_*.vtkhdf"))[-1]) as file:
            group = file["VTKHDF"]
            data = {name: group["PointData"][name][:] for name in group["PointData"]}
            data["x"] = group["Points"][:] - data["displacement"]
    return energy, data


def draw_strips(picture):
    """Stress over opening of the end, work over the spacing, and where the strip is cracked."""
    fig, axes = plt.subplots(1, 4, figsize=(15, 4.2), constrained_layout=True)
    maps = {}
    for at, (name, keys, speed, time, wanted) in enumerate(STRIPS):
        works = []
        for spacing in SPACINGS:
            plies = "plies='90'," if "ud" in keys else ""
            energy, data = run(STRIP.format(material=keys, speed=speed, time=time, plies=plies,
                                            spacing=spacing, every=time / 200))  # fmt: skip
            work, t = energy["drive_work[J]"], energy["time[s]"]
            works.append(2 * work[-1] / LIGAMENT)
            print(f"{name}, {1e3 * spacing:g} mm: {works[-1]:.4g} J/m2", flush=True)
            if at < 2:
                stress = np.gradient(work, t)[3:] / speed / LIGAMENT
                axes[at].plot(2e6 * speed * t[3:], stress / 1e6, label=f"{1e3 * spacing:g} mm")
            if at == 0:
                maps[spacing] = data
        if at < 2:
            axes[at].set(title=name, xlabel="way of the ends [um]", ylim=(-0.3, 7))
            axes[at].set_ylabel("mean stress of the ligament [MPa]")
            axes[at].legend(frameon=False)
        line = axes[2].plot(1e3 * np.array(SPACINGS), works, "o-", label=name)[0]
        if wanted:
            axes[2].axhline(wanted, color=line.get_color(), ls=":")
    axes[2].set(xscale="log", yscale="log", xlabel="spacing [mm]", ylim=(50, 5e4))
    axes[2].set(title="work per cracked area; dotted: the deck", ylabel="J/m2")
    axes[2].set_xticks([1, 2, 4], ["1", "2", "4"], minor=False)
    axes[2].minorticks_off()
    axes[2].legend(frameon=False, fontsize=8)
    for k, (spacing, data) in enumerate(maps.items()):
        strip = (data["body"] == data["body"].min()) & (data["x"][:, 1] < LIGAMENT + 0.008)
        x, y = 1e3 * data["x"][strip, 0] + 18 * k, 1e3 * data["x"][strip, 1]
        shown = {"c": data["damage_tension"][strip], "vmin": 0, "vmax": 1, "cmap": "inferno_r"}
        size = (4600 * spacing) ** 2  # points^2, a cell of the lattice
        drawn = axes[3].scatter(x, y, s=size, marker="s", linewidths=0, **shown)
        axes[3].text(18 * k, 21, f"{1e3 * spacing:g} mm")
    axes[3].set(title="concrete_48 at the end (a quarter each)", aspect="equal", yticks=[])
    axes[3].set(xlim=(-1, 54), ylim=(-1, 24), xticks=[])
    fig.colorbar(drawn, ax=axes[3], label="damage_tension", shrink=0.6, location="bottom")
    fig.savefig(picture, dpi=110)


def beam_load(crack):
    """Load by corrected beam theory [N per metre of width] of a crack of that length [m]."""
    shear = YOUNG / (2 * (1 + POISSON))
    gamma = 1.18 * YOUNG / shear
    chi = np.sqrt(YOUNG / (11 * shear) * (3 - 2 * (gamma / (1 + gamma)) ** 2))
    return np.sqrt(ENERGY * YOUNG / (1 - POISSON**2) * HIGH**3 / 12) / (crack + chi * HIGH)


def draw_beam(picture):
    """Load of a double cantilever beam over its crack, beside beam theory."""
    fig, ax = plt.subplots(figsize=(6, 4), constrained_layout=True)
    for dx in (0.0015, 0.001):
        energy, _ = run(BEAM.format(dx=dx))
        crack = START - 0.00075 + energy["bond_heat[J]"] / ENERGY
        load = np.gradient(energy["drive_work[J]"], energy["time[s]"]) / 2 / SPEED
        kept = energy["time[s]"] > 3.2e-4
        ax.plot(1e3 * crack[kept], 1e-3 * load[kept], label=f"{1e3 * dx:g} mm")
    crack = np.linspace(0.025, 0.036, 50)
    ax.plot(1e3 * crack, 1e-3 * beam_load(crack), "k:", label="corrected beam theory")
    ax.set(xlabel="length of the crack [mm]", ylabel="load [kN per m of width]")
    ax.set(title="double cantilever beam, gi = 500 J/m2", ylim=(0, None))
    ax.legend(frameon=False)
    fig.savefig(picture, dpi=110)


if __name__ == "__main__":
    draw_strips(sys.argv[1])
    draw_beam(sys.argv[2])
