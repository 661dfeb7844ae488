#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Period of a ring of particles over theory: what gradients and hourglass forces make of its wall.

usage: ring_modes.py [LAYERS...]

A ring whose radius is eight times its wall swings in its lowest mode (two waves, inextensional,
plane, nu = 0). The energy of the particles is V E/2 of the strain that their corrected gradients
see, with the force as its adjoint, and that of a stiff hourglass force zeta G. Printed is the
period of the eigenmode that is nearest to the mode of theory, and that of the prescribed mode, in
which nothing gives way; both over that of theory (Rayleigh quotient of the same mode, exact
through the wall). Lattices: 'square', all points of a square lattice within the wall; 'aligned',
rings of particles behind each other; 'own', rings each with its own number of particles. Tilts
(docs/theory/plates.md) have the radial normal of each particle.
"""

import sys

import numpy as np

SLENDER = 8  # radius over wall
REACH = 2.4  # of the kernel [spacings]
OUTSIDE = 0.055  # how far outside its place a face sees the strain [spacings]
ROWS = (
    ("square", False, 0.0),
    ("square", True, 0.0),
    ("square", True, 0.1),
    ("square", False, 0.1),
    ("square", False, 0.5),
    ("square", False, 2.0),
    ("aligned", False, 0.0),
    ("aligned", True, 0.0),
    ("own", False, 0.0),
    ("own", True, 0.0),
)


def places(layers, lattice):
    """Positions (n, 2) and volumes (n) of particles a spacing apart."""
    inner, outer = (SLENDER - 0.5) * layers, (SLENDER + 0.5) * layers
    if lattice == "square":
        axis = np.arange(-int(outer) - 3, int(outer) + 3) + 0.5
        x = np.stack(np.meshgrid(axis, axis, indexing="ij"), -1).reshape(-1, 2)
        r = np.hypot(*x.T)
        x = x[(r > inner) & (r < outer)]
        return x, np.full(len(x), np.pi * (outer**2 - inner**2) / len(x))
    x, volume = [], []
    for k in range(layers):
        r = inner + k + 0.5
        n = round(2 * np.pi * (SLENDER * layers if lattice == "aligned" else r))
        angle = np.arange(n) * 2 * np.pi / n
        x.append(r * np.stack([np.cos(angle), np.sin(angle)], -1))
        volume.append(np.full(n, np.pi * ((inner + k + 1) ** 2 - (inner + k) ** 2) / n))
    return np.concatenate(x), np.concatenate(volume)


def shape(x, radius):
    """The inextensional mode at places x, and radial and tangential unit vectors."""
    angle, z = np.arctan2(x[:, 1], x[:, 0]), np.hypot(*x.T) - radius
    out = np.stack([np.cos(angle), np.sin(angle)], -1)
    along = np.stack([-out[:, 1], out[:, 0]], -1)
    slide = (1.5 * z / radius - 0.5) * np.sin(2 * angle)
    return np.cos(2 * angle)[:, None] * out + slide[:, None] * along, out, along


def theory(layers):
    """Elastic energy of the mode of amplitude 1 at E = 1, and its circular frequency."""
    radius = SLENDER * layers
    z = (np.arange(2000) + 0.5) / 2000 * layers - layers / 2
    step = layers / 2000
    energy = np.pi / 2 * np.sum((3 * z / radius) ** 2 / (radius + z)) * step
    kinetic = np.pi / 2 * np.sum((1 + (0.5 - 1.5 * z / radius) ** 2) * (radius + z)) * step
    return energy, np.sqrt(energy / kinetic)


def arms(r, weight, across, along):
    """Arms y_ij of a face, X_ij where a particle lies inside."""
    z, t = r @ across, r @ along
    a = [np.sum(weight * t**2 * z**k) for k in range(3)]
    if abs(a[1] / a[2]) < 0.5:
        return r
    d = -np.sign(a[1]) * OUTSIDE
    return r + ((d * a[0] - a[1]) / (a[2] - d * a[1]) * z * t)[:, None] * along


def gradient(r, weight, y):
    """What each displacement, that of the particle first, adds to the gradient (n + 1, 2)."""
    m = np.einsum("j,ja,jb->ab", weight, r, y)
    g = (weight[:, None] * y) @ np.linalg.inv(m)
    return np.concatenate([g.sum(0)[None], -g])


def stiffness(x, volume, tilted, zeta, axes):
    """Stiffness matrix of all particles, E = 1 and G = 1/2. Axes: radial, tangential vectors."""
    k = np.zeros((2 * len(x), 2 * len(x)))
    distance = np.sqrt(((x[:, None] - x[None]) ** 2).sum(-1))
    for i in range(len(x)):
        j = np.flatnonzero((distance[i] < REACH) & (distance[i] > 0))
        r, q = x[i] - x[j], 2 * distance[i, j] / REACH
        weight = volume[j] * 140 / (np.pi * REACH**4) * (1 - q / 2) ** 3
        y = arms(r, weight, axes[0][i], axes[1][i]) if tilted else r
        g = gradient(r, weight, y)
        b = np.zeros((3, 2 * len(g)))  # strain xx, yy and sqrt(2) xy
        b[0, 0::2] = g[:, 0]
        b[1, 1::2] = g[:, 1]
        b[2, 0::2], b[2, 1::2] = g[:, 1] / np.sqrt(2), g[:, 0] / np.sqrt(2)
        part = volume[i] * b.T @ b
        if zeta > 0:
            plain = gradient(r, weight, r)
            for n in range(len(j)):
                e = -plain @ r[n]
                e[0] += 1
                e[n + 1] -= 1
                held = volume[i] * weight[n] * zeta / 2 * np.outer(e, e)
                part[0::2, 0::2] += held
                part[1::2, 1::2] += held
        own = np.concatenate([[i], j])
        own = np.stack([2 * own, 2 * own + 1], -1).reshape(-1)
        k[np.ix_(own, own)] += part
    return k


def periods(layers, lattice, tilted, zeta):
    """Period of the eigenmode, and of the prescribed mode by its energy, over theory."""
    x, volume = places(layers, lattice)
    u, *axes = shape(x, SLENDER * layers)
    k, u = stiffness(x, volume, tilted, zeta, axes), u.reshape(-1)
    energy, frequency = theory(layers)
    root = np.sqrt(np.repeat(volume, 2))
    square, modes = np.linalg.eigh(k / root[:, None] / root[None])
    nearest = np.argmax((modes.T @ (u * root)) ** 2)
    return frequency / np.sqrt(square[nearest]), np.sqrt(2 * energy / (u @ k @ u))


def main():
    layers = [int(word) for word in sys.argv[1:]] or [3, 4, 5]
    print("layers, lattice, tilts, zeta: period, that of the prescribed mode")
    for n in layers:
        for lattice, tilted, zeta in ROWS:
            free, held = periods(n, lattice, tilted, zeta)
            print(
                f"{n} {lattice:8} {'radial' if tilted else '-':7} {zeta:3.1f}: "
                f"{free:.3f} {held:.3f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
