#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""First frequencies of clamped square plates, and of clamped strips, by elasticity (Ritz).

usage: plate_reference.py [SIDE_OVER_THICKNESS]

Displacements: polynomials that vanish on the sides times quadratic elements through the thickness,
two per ply, so that the warping of a laminate is free. Printed is omega a^2/h sqrt(rho/E1) of the
lowest mode that is even about both middle planes, for growing degree: it falls to the limit from
above. With it the first-order theory (Mindlin, shear factor 5/6), where all plies are one material.
A strip is clamped at two ends, in plane strain, its fibres at 0 degrees along it.
"""

import sys

import numpy as np

ISOTROPIC = {"E": (1.0, 1.0, 1.0), "nu": (0.3, 0.3, 0.3), "G": (1 / 2.6,) * 3}
#: carbon fibre: the deck preset cfrp_ud [GPa]; nu12, nu13, nu23; G23, G13, G12
PLY = {"E": (150.0, 8.2, 8.2), "nu": (0.34, 0.34, 0.53), "G": (2.7, 4.34, 4.34)}


def stiffness(material, angle):
    """6 x 6 stiffness (11, 22, 33, 23, 13, 12) of a ply at 0 or 90 degrees, over E1."""
    e, nu = material["E"], material["nu"]
    s = np.zeros((6, 6))
    for i in range(3):
        s[i, i] = 1 / e[i]
        s[3 + i, 3 + i] = 1 / material["G"][i]
    for (i, j), v in zip(((0, 1), (0, 2), (1, 2)), nu, strict=True):
        s[i, j] = s[j, i] = -v / e[i]
    if angle == 90:
        turn = [1, 0, 2, 4, 3, 5]
        s = s[np.ix_(turn, turn)]
    return np.linalg.inv(s) / e[0]


def in_plane(n):
    """Values and derivatives at Gauss points of n even and n odd functions that vanish at +-1."""
    at, weight = np.polynomial.legendre.leggauss(2 * n + 6)
    table = {}
    for parity in (0, 1):
        shapes = [np.polynomial.legendre.Legendre.basis(2 * k + parity) for k in range(n)]
        values = [(1 - at**2) * p(at) for p in shapes]
        slopes = [(1 - at**2) * p.deriv()(at) - 2 * at * p(at) for p in shapes]
        table[parity] = np.array(values), np.array(slopes)
    return weight, table


def through(plies, thickness):
    """Products of the shapes across the plate, ply by ply: [derivative of a][of b] per ply."""
    at, weight = np.polynomial.legendre.leggauss(4)
    n = 4 * plies + 1
    found = np.zeros((plies, 2, 2, n, n))
    size = thickness / plies / 2
    shape = np.array([at * (at - 1) / 2, 1 - at**2, at * (at + 1) / 2])
    slope = np.array([at - 0.5, -2 * at, at + 0.5]) * 2 / size
    for e in range(2 * plies):
        node = slice(2 * e, 2 * e + 3)
        for a, f in enumerate((shape, slope)):
            for b, g in enumerate((shape, slope)):
                found[e // 2, a, b, node, node] += (f * weight) @ g.T * size / 2
    return found


STRAINS = ([(0, 0)], [(1, 1)], [(2, 2)], [(1, 2), (2, 1)], [(0, 2), (2, 0)], [(0, 1), (1, 0)])
PARITY = ((1, 0), (0, 1), (0, 0))  # of u, v, w along x and y


def frequency(material, angles, ratio, n):
    """Lowest omega a^2/h sqrt(rho/E1)."""
    weight, table = in_plane(n)
    across = through(len(angles), 2 / ratio)
    stiff = [stiffness(material, angle) for angle in angles]
    nz = across.shape[-1]
    size = n * n * nz
    k, m = np.zeros((3 * size, 3 * size)), np.zeros((3 * size, 3 * size))

    def product(axis, a, b):
        (field_a, along_a), (field_b, along_b) = a, b
        f = table[PARITY[field_a][axis]][int(along_a == axis)]
        g = table[PARITY[field_b][axis]][int(along_b == axis)]
        return (f * weight) @ g.T

    def block(a, b):
        return slice(a * size, (a + 1) * size), slice(b * size, (b + 1) * size)

    for i, first in enumerate(STRAINS):
        for j, second in enumerate(STRAINS):
            if not any(c[i, j] for c in stiff):
                continue
            for a in first:
                for b in second:
                    z = sum(
                        c[i, j] * across[p, int(a[1] == 2), int(b[1] == 2)]
                        for p, c in enumerate(stiff)
                    )
                    plane = np.kron(product(0, a, b), product(1, a, b))
                    k[block(a[0], b[0])] += np.kron(plane, z)
    for f in range(3):
        plane = np.kron(product(0, (f, 9), (f, 9)), product(1, (f, 9), (f, 9)))
        m[block(f, f)] = np.kron(plane, across[:, 0, 0].sum(0))
    low = np.linalg.inv(np.linalg.cholesky(m))
    square = np.linalg.eigvalsh(low @ k @ low.T)[0]
    return np.sqrt(square) * 2 * ratio  # the side is 2, the thickness 2/ratio


def strip(angles, ratio, n):
    """Lowest omega a^2/h sqrt(rho/E1) of a strip of carbon fibre plies."""
    weight, table = in_plane(n)
    across = through(len(angles), 2 / ratio)
    stiff = [stiffness(PLY, angle) for angle in angles]
    size = n * across.shape[-1]
    k, m = np.zeros((2 * size, 2 * size)), np.zeros((2 * size, 2 * size))
    strains = {0: [(0, 0)], 2: [(1, 2)], 4: [(0, 2), (1, 0)]}  # of u, w along x, z

    def part(f):
        return slice(f * size, (f + 1) * size)

    def along(a, b):
        return (table[1 - a[0]][int(a[1] == 0)] * weight) @ table[1 - b[0]][int(b[1] == 0)].T

    for i, j in ((0, 0), (0, 2), (2, 0), (2, 2), (4, 4)):
        for a in strains[i]:
            for b in strains[j]:
                z = sum(
                    c[i, j] * across[p, int(a[1] == 2), int(b[1] == 2)] for p, c in enumerate(stiff)
                )
                k[part(a[0]), part(b[0])] += np.kron(along(a, b), z)
    for f in (0, 1):
        m[part(f), part(f)] = np.kron(along((f, 9), (f, 9)), across[:, 0, 0].sum(0))
    low = np.linalg.inv(np.linalg.cholesky(m))
    return np.sqrt(np.linalg.eigvalsh(low @ k @ low.T)[0]) * 2 * ratio


def mindlin(ratio, n):
    """The same by first-order theory for the isotropic plate: u = z a, v = z b, w."""
    weight, table = in_plane(n)
    h, e, nu = 2 / ratio, 1.0, 0.3
    bend, shear = e * h**3 / 12 / (1 - nu**2), 5 / 6 * h / 2.6
    size = n * n
    k, m = np.zeros((3 * size, 3 * size)), np.zeros((3 * size, 3 * size))

    def plane(a, b):
        out = 1
        for axis in (0, 1):
            f = table[PARITY[a[0]][axis]][int(a[1] == axis)]
            g = table[PARITY[b[0]][axis]][int(b[1] == axis)]
            out = np.kron(out, (f * weight) @ g.T)
        return out

    def add(factor, first, second):
        for a in first:
            for b in second:
                rows = slice(a[0] * size, (a[0] + 1) * size)
                k[rows, b[0] * size : (b[0] + 1) * size] += factor * plane(a, b)

    for a, b in ((0, 1), (1, 0)):
        add(bend, [(a, a)], [(a, a)])
        add(bend * nu, [(a, a)], [(b, b)])
        add(shear, [(2, a), (a, 9)], [(2, a), (a, 9)])
    add(bend * (1 - nu) / 2, [(0, 1), (1, 0)], [(0, 1), (1, 0)])
    for f, inertia in enumerate((h**3 / 12, h**3 / 12, h)):
        part = slice(f * size, (f + 1) * size)
        m[part, part] = inertia * plane((f, 9), (f, 9))
    low = np.linalg.inv(np.linalg.cholesky(m))
    return np.sqrt(np.linalg.eigvalsh(low @ k @ low.T)[0]) * 2 * ratio


def main():
    """Print the table."""
    ratio = float(sys.argv[1]) if len(sys.argv) > 1 else 20.0
    plates = {
        "isotropic": (ISOTROPIC, (0,)),
        "carbon 0/90/0": (PLY, (0, 90, 0)),
        "carbon 0/90/0/90/0": (PLY, (0, 90, 0, 90, 0)),
        "carbon 0/90/0/90/0/90/0": (PLY, (0, 90, 0, 90, 0, 90, 0)),
    }
    degrees = (3, 4, 5)
    print("plate," + ",".join(f"{n} x {n} functions" for n in degrees))
    for name, (material, angles) in plates.items():
        print(name + "".join(f",{frequency(material, angles, ratio, n):.4f}" for n in degrees))
    for angles in ((0, 90, 90, 0), (90, 0, 0, 90), (90, 0, 0, 90, 90, 0, 0, 90)):
        found = [strip(angles, ratio, 3 * n) for n in degrees]
        print("strip " + "/".join(map(str, angles)) + "".join(f",{f:.4f}" for f in found))
    print("isotropic, Mindlin" + "".join(f",{mindlin(ratio, n):.4f}" for n in degrees))


if __name__ == "__main__":
    main()
