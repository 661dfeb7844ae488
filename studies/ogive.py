#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Write the surface of a rod with an ogive nose as a binary STL file.

usage: ogive.py FILE --radius R --length L [--crh 3] [--segments 32] [--rings 16]

Metres. The axis is z, the tip is at the origin and points to -z, L is the whole length. CRH is the
radius of the ogive's arc over the diameter of the rod.
"""

import argparse
import itertools

import numpy as np


def profile(radius, length, crh, rings):
    """Radius rho against distance z from the tip, both (rings + 1) in m."""
    arc = crh * 2 * radius
    nose = np.sqrt(arc**2 - (arc - radius) ** 2)
    if length <= nose:
        raise ValueError(f"the nose alone is {nose:g} m long")
    z = nose * (1 - np.cos(np.linspace(0, np.pi / 2, rings)))
    rho = np.sqrt(arc**2 - (nose - z) ** 2) + radius - arc
    rho[0] = 0
    return np.append(z, length), np.append(rho, radius)


def surface(z, rho, segments):
    """Triangles (n, 3 corners, 3) of the closed surface of revolution, seen from outside."""
    angle = np.linspace(0, 2 * np.pi, segments, endpoint=False)
    round_ = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    points = zip(z, rho, strict=True)
    rings = [np.column_stack([r * round_, np.full(segments, h)]) for h, r in points]
    parts = []
    for k, (low, high) in enumerate(itertools.pairwise(rings)):
        low_next, high_next = np.roll(low, -1, axis=0), np.roll(high, -1, axis=0)
        if k > 0:
            parts.append(np.stack([low, low_next, high_next], axis=1))
        parts.append(np.stack([low, high_next, high], axis=1))
    end = np.broadcast_to([0, 0, z[-1]], rings[-1].shape)
    parts.append(np.stack([end, rings[-1], np.roll(rings[-1], -1, axis=0)], axis=1))
    return np.concatenate(parts)


def volume(triangles):
    """Volume within a closed surface [m3], positive where its triangles are seen from outside."""
    a, b, c = triangles.transpose(1, 0, 2)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def write_stl(file, triangles):
    """Binary STL: a header of 80 bytes, the number of triangles, 50 bytes for each."""
    record = np.zeros(len(triangles), dtype=[("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")])
    record["v"] = triangles
    with open(file, "wb") as out:
        out.write(bytes(80) + np.uint32(len(triangles)).tobytes() + record.tobytes())


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    parser.add_argument("--radius", type=float, required=True)
    parser.add_argument("--length", type=float, required=True)
    parser.add_argument("--crh", type=float, default=3.0)
    parser.add_argument("--segments", type=int, default=32)
    parser.add_argument("--rings", type=int, default=16)
    args = parser.parse_args()
    triangles = surface(*profile(args.radius, args.length, args.crh, args.rings), args.segments)
    write_stl(args.file, triangles)
    print(f"{len(triangles)} triangles, {volume(triangles):.6e} m3")


if __name__ == "__main__":
    main()
