#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Flexural waves in an infinite plate: how far their period in layers of particles is off.

usage: plate_waves.py [metal]

The equations of docs/theory/solids.md and plates.md, linear, on a lattice without edges (h =
1.2 spacings, one layer a ply or two), against elasticity in space (quadratic elements across, two
per ply). Printed is the error of the period along the fibres of the outer plies, across them and at
45 degrees. So bending (long waves) and transverse shear (short ones) are told apart, without a
clamp.

With `metal` the plate has one material and no hourglass force, its faces the tilt of metals,
without and with the lift. A Poisson's ratio near 1/2 stands for plastic flow, which keeps its
volume.
"""

import sys

import numpy as np
import plate_reference as reference

H = 1.2  # smoothing length over spacing
OUTSIDE = 0.055  # how far outside its place a face of metal sees the strain [spacings]
REACH = range(-2, 3)
OFFSETS = [
    np.array((a, b, c), float)
    for a in REACH
    for b in REACH
    for c in REACH
    if 0 < a * a + b * b + c * c < 4 * H * H
]


def weight(r):
    """Slope of the kernel, F."""
    return 21 / (16 * np.pi * H**3) * 5 * (1 - r / (2 * H)) ** 3 / H**2


def exact(plies, kx, ky):
    """Lowest frequency of elasticity in space: unit thickness, E1 and density."""
    across = reference.through(len(plies), 1.0)
    n = across.shape[-1]
    k, m = np.zeros((3 * n, 3 * n), complex), np.zeros((3 * n, 3 * n), complex)
    wave = (1j * kx, 1j * ky, 1)
    for i, first in enumerate(reference.STRAINS):
        for j, second in enumerate(reference.STRAINS):
            for field, along in first:
                for other, across_it in second:
                    z = sum(c[i, j] * across[p, int(along == 2), int(across_it == 2)]
                            for p, c in enumerate(plies))  # fmt: skip
                    rows, columns = slice(field * n, field * n + n), slice(other * n, other * n + n)
                    k[rows, columns] += np.conj(wave[along]) * wave[across_it] * z
    for f in range(3):
        m[f * n : f * n + n, f * n : f * n + n] = across[:, 0, 0].sum(0)
    low = np.linalg.inv(np.linalg.cholesky(m))
    return np.sqrt(np.linalg.eigvalsh(low @ k @ low.conj().T)[0])


def pairs(layer, n, tilt, lift=0.0):
    """Weight, offset of the neighbour, x_ij and arm of all pairs of a particle of a layer."""
    for o in OFFSETS:
        if 0 <= layer + o[2] < n:
            arm = -o + (tilt * o[2] * o[0], tilt * o[2] * o[1], lift * (o[0] ** 2 + o[1] ** 2))
            yield weight(np.linalg.norm(o)), o, -o, arm


def tilt_of(layer, n, outside=0.0):
    """Tilt c of a layer, 0 where it is small, and its lift."""
    a = [sum(w * x[0] ** 2 * x[2] ** k for w, _, x, _ in pairs(layer, n, 0)) for k in range(3)]
    if abs(a[1]) < 0.05 * a[2]:
        return 0, 0
    d = -np.sign(a[1]) * outside
    square = sum(w * (x[0] ** 2 + x[1] ** 2) ** 2 for w, _, x, _ in pairs(layer, n, 0))
    return (d * a[0] - a[1]) / (a[2] - d * a[1]), -2 * a[1] / square


def discrete(plies, hold, kx, ky, faces=(0.0, False)):
    """The same for layers of particles, one for each entry of `plies`, hold: their K.

    faces: how far outside its place a face sees the strain [spacings], and if it has a lift.
    """
    n = len(plies)
    kx, ky = kx / n, ky / n
    energy = np.zeros((3 * n, 3 * n), complex)
    for layer in range(n):
        tilt, lift = tilt_of(layer, n, faces[0])
        found = list(pairs(layer, n, tilt, lift * faces[1]))
        gradient = np.zeros((2, 3, n), complex)  # with the arms, and plain
        for g, arms in ((0, [p[3] for p in found]), (1, [p[2] for p in found])):
            m = sum(p[0] * np.outer(p[2], y) for p, y in zip(found, arms, strict=True))
            for (w, o, _, _), y in zip(found, arms, strict=True):
                part = w * y @ np.linalg.inv(m)
                gradient[g, :, layer] += part
                gradient[g, :, layer + int(o[2])] -= part * np.exp(1j * (kx * o[0] + ky * o[1]))
        strain = np.zeros((6, 3 * n), complex)
        for i, parts in enumerate(reference.STRAINS):
            for field, along in parts:
                strain[i, field * n : field * n + n] += gradient[0, along]
        energy += strain.conj().T @ plies[layer] @ strain
        for w, o, x, _ in found:
            miss = x @ gradient[1]
            miss[layer] -= 1
            miss[layer + int(o[2])] += np.exp(1j * (kx * o[0] + ky * o[1]))
            for f in range(3):
                part = slice(f * n, f * n + n)
                energy[part, part] += w * hold[layer][f] * np.outer(miss.conj(), miss)
    squares, modes = np.linalg.eigh(energy)
    bends = np.argmax(np.abs(modes[2 * n :].sum(0)))  # moves all layers across
    return np.sqrt(squares[bends]) * n


def metal():
    """Print the table of one material."""
    print("layers,Poisson's ratio,wavelength over thickness,without lift,with it")
    for layers in (3, 4, 5, 6):
        for ratio in (0.0, 0.3, 0.49):
            shear = (1 / (2 + 2 * ratio),) * 3
            one = reference.stiffness({"E": (1.0,) * 3, "nu": (ratio,) * 3, "G": shear}, 0)
            hold = [(0, 0, 0)] * layers
            for length in (40, 20, 10, 6):
                k = 2 * np.pi / length
                theory = exact([one, one], k, 0)
                off = [
                    theory / discrete([one] * layers, hold, k, 0, (OUTSIDE, lift)) - 1
                    for lift in (False, True)
                ]
                print(f"{layers},{ratio},{length},{off[0]:.4f},{off[1]:.4f}")


def main():
    """Print the table of laminates."""
    if sys.argv[1:] == ["metal"]:
        metal()
        return
    ply = reference.PLY
    e1, e2, g = ply["E"][0], ply["E"][1], min(ply["G"][:2])
    normal = g / 2 / e1
    own = {0: (1, e2 / e1), 90: (e2 / e1, 1)}
    share = 1 / (12 * 4 / 15 * H**2)
    print("layers,wavenumber times thickness,along,across,45 degrees")
    for layers, angles in ((1, (0, 90, 0)), (2, (0, 90, 0)), (1, (0, 90, 0, 90, 0))):
        plies = [reference.stiffness(ply, angle) for angle in angles]
        each = [c for c in plies for _ in range(layers)]
        hold = [
            (*(max(share * e - 0.75 * normal, normal) for e in own[angle]), normal)
            for angle in angles
            for _ in range(layers)
        ]
        for k in (0.1, 0.3, 0.47, 0.7):
            ways = ((k, 0), (0, k), (k / 2**0.5, k / 2**0.5))
            off = [exact(plies, *way) / discrete(each, hold, *way) - 1 for way in ways]
            print(f"{len(each)},{k}" + "".join(f",{x:.4f}" for x in off))


if __name__ == "__main__":
    main()
