# SPDX-License-Identifier: MIT
"""A clamped square plate that bends with shear (Mindlin), under a short even pressure: by modes.

Ritz: deflection and both rotations as polynomials that vanish at the edges, over the quarter; the
response of each mode to a rectangular pulse is exact. Small deflections of an isotropic plate.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial.legendre import Legendre, leggauss

from studies.comparisons.case import History

SHEAR = 5 / 6  # Reissner


def _basis(n: int, odd: bool, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values and slopes at x (0..1) of n functions that vanish at 1: even or odd ones."""
    values, slopes = [], []
    edge, slope = 1 - x**2, -2 * x
    for k in range(n):
        p = Legendre.basis(2 * k + odd)
        values.append(edge * p(x))
        slopes.append(slope * p(x) + edge * p.deriv()(x))
    return np.array(values), np.array(slopes)


@dataclass(frozen=True)
class Square:
    """A clamped plate; SI units."""

    half: float  # of its side
    thickness: float
    young: float
    poisson: float
    density: float


def modes(plate: Square, n: int = 10) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Angular frequencies, deflection of the middle in each mode, push of an even pressure 1 Pa.

    Of the quarter; modes have unit mass.
    """
    thickness, young, poisson, density = (
        plate.thickness,
        plate.young,
        plate.poisson,
        plate.density,
    )
    points, weights = leggauss(2 * n + 6)
    x, w = (points + 1) / 2, weights / 2
    even, odd = _basis(n, False, x), _basis(n, True, x)

    def pair(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return np.einsum("ip,jp,p->ij", a, b, w)

    e, e1 = even
    o, o1 = odd
    a = plate.half
    bend = young * thickness**3 / (12 * (1 - poisson**2))
    shear = SHEAR * young / (2 * (1 + poisson)) * thickness
    g = (1 - poisson) / 2
    kron = np.kron
    # w: even, even; rotation u: odd in x, even in y; v: even in x, odd in y (lengths over half)
    k_ww = shear * (kron(pair(e1, e1), pair(e, e)) + kron(pair(e, e), pair(e1, e1)))
    k_wu = -shear * a * kron(pair(e1, o), pair(e, e))
    k_wv = -shear * a * kron(pair(e, e), pair(e1, o))
    k_uu = bend * (kron(pair(o1, o1), pair(e, e)) + g * kron(pair(o, o), pair(e1, e1)))
    k_uu += shear * a**2 * kron(pair(o, o), pair(e, e))
    k_vv = bend * (kron(pair(e, e), pair(o1, o1)) + g * kron(pair(e1, e1), pair(o, o)))
    k_vv += shear * a**2 * kron(pair(e, e), pair(o, o))
    k_uv = bend * (poisson * kron(pair(o1, e), pair(e, o1)) + g * kron(pair(o, e1), pair(e1, o)))
    stiff = np.block([[k_ww, k_wu, k_wv], [k_wu.T, k_uu, k_uv], [k_wv.T, k_uv.T, k_vv]])
    zero = np.zeros((n * n, n * n))
    m_w = density * thickness * a**2 * kron(pair(e, e), pair(e, e))
    turn = density * thickness**3 / 12 * a**2
    m_u = turn * kron(pair(o, o), pair(e, e))
    m_v = turn * kron(pair(e, e), pair(o, o))
    mass = np.block([[m_w, zero, zero], [zero, m_u, zero], [zero, zero, m_v]])
    root = np.linalg.inv(np.linalg.cholesky(mass))
    squares, vectors = np.linalg.eigh(root @ stiff @ root.T)
    shapes = root.T @ vectors
    middle = np.kron(*(2 * [_basis(n, False, np.zeros(1))[0][:, 0]]))
    push = a**2 * np.kron(e @ w, e @ w)
    return np.sqrt(squares), middle @ shapes[: n * n], push @ shapes[: n * n]


def pulse_deflection(plate: Square, pressure: float, duration: float, times: np.ndarray) -> History:
    """Deflection of the middle under a pressure that lasts from 0 to `duration`."""
    omega, middle, push = modes(plate)
    t = np.asarray(times)[:, None]
    held = 1 - np.cos(omega * t)
    after = np.cos(omega * (t - duration)) - np.cos(omega * t)
    response = np.where(t < duration, held, after) / omega**2
    w = pressure * response @ (middle * push)
    return [(float(a), float(b)) for a, b in zip(times, w, strict=True)]
