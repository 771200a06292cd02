"""Elastic half-plane under periodic pressure: displacements by pressure elements and line forces.

docs/bem.md, "The discrete problem", and docs/patches.md, "Contacts and gaps", derive the formulas. Elements form a
circulant matrix with exact eigenvalues, without truncated image sums (Section 5.1; Johnson 1985, Eq. 2.37). For
arrays, sine and logarithm are evaluated by their series, in branch-free loops that the compiler vectorises: three
times as fast.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TypeVar

import numpy as np
import scipy  # Its submodules are loaded on first use.

from weier.kernels.arrays import Array
from weier.kernels.jit import fused, kernel

Number = TypeVar("Number", float, Array)

# 2 sin(pi u)/u in powers of u^2: for |u| <= 1/2 the next term is below a relative 1e-16
SINE = tuple(float(2 * (-1) ** k * np.pi ** (2 * k + 1) / np.prod(np.arange(1.0, 2 * k + 2))) for k in range(11))
MANTISSA_BITS = 52  # bits of the mantissa of a double (IEEE 754)
SQRT_HALF_BITS = int(np.float64(0.5**0.5).view(np.int64))  # bits of 1/sqrt(2) as an integer
LN_2 = float(np.log(2.0))


@lru_cache(maxsize=16)  # holds one hierarchy of grids, which the next profile uses again
def eigenvalues(points: int, period: float = 1.0) -> Array:
    """Return the eigenvalues of the influence matrix, displacement per pressure for each number of waves.

    Parameters
    ----------
    points : int
        Nodes N in one period.
    period : float
        Length of the period, in lambda_0.

    Returns
    -------
    array, shape (points//2 + 1,)
        In g_0/p_0*, for 0, 1, ... waves a period, in the order of `numpy.fft.rfft`; the first is 0. Do not write
        to it: the next call returns the same array.

    Notes
    -----
    A triangle of pressure has the spectrum sinc^2; its aliases at nu + j sum to Hurwitz zeta functions:
    sin^2(pi nu)/(pi^2 N) [zeta(3, nu) + zeta(3, 1 - nu)] with nu = k/N.

    """
    nu = np.arange(1, points // 2 + 1) / points
    aliases = scipy.special.zeta(3, nu) + scipy.special.zeta(3, 1 - nu)
    values = np.concatenate([[0.0], period * np.sin(np.pi * nu) ** 2 / (np.pi**2 * points) * aliases])
    values.flags.writeable = False
    return values


def influence_coefficients(points: int, period: float = 1.0) -> Array:
    """Return the displacement of node j by unit pressure at node 0, shape (points,), in g_0/p_0*."""
    return np.fft.irfft(eigenvalues(points, period), points)


@kernel
def displacement_at_distance(x: float, period: float) -> float:
    """Return the displacement at x of a unit line force and its images, -2 ln|2 sin(pi x/L)|, of mean 0."""
    return -2 * np.log(abs(2 * np.sin(np.pi / period * x)))


def punch_displacement(half_width: Number, period: float) -> Number:
    """Return the displacement under a narrow flat punch of unit force, -2 ln(pi r/L)."""
    return -2 * np.log(np.pi / period * half_width)


@fused
def replace_by_influence(d: Array, period: float, dipoles: bool) -> None:
    """Replace distances d by ln|2 sin(pi d/L)| or, for dipoles, by 1/sin^2(pi d/L); by 0 where d = 0."""
    for i in range(d.size):
        u = d[i] / period
        u -= np.floor(u + 0.5)
        q, series = u * u, SINE[10]
        series = SINE[8] + q * (SINE[9] + q * series)
        series = SINE[5] + q * (SINE[6] + q * (SINE[7] + q * series))
        series = SINE[2] + q * (SINE[3] + q * (SINE[4] + q * series))
        d[i] = abs(u * (SINE[0] + q * (SINE[1] + q * series)))
    if dipoles:
        for i in range(d.size):
            d[i] = 4 / (d[i] * d[i]) if d[i] > 0 else 0.0
    else:
        take_logarithms(d)


@fused
def take_logarithms(x: Array) -> None:
    """Replace x >= 0 by ln x, and 0 by 0.

    With x = 2^k m and m between 1/sqrt(2) and sqrt(2), ln m = 2 artanh s with s = (m-1)/(m+1), |s| < 0.172. The
    exponent bits of x as an integer give k.
    """
    bits = x.view(np.int64)
    for i in range(x.size):
        is_positive, k = x[i] > 0, (bits[i] - SQRT_HALF_BITS) >> MANTISSA_BITS
        bits[i] -= k << MANTISSA_BITS  # x is m now
        s = (x[i] - 1) / (x[i] + 1)
        q = s * s
        series = 1 / 15 + q * (1 / 17 + q * (1 / 19 + q * (1 / 21 + q / 23)))
        series = 1 / 7 + q * (1 / 9 + q * (1 / 11 + q * (1 / 13 + q * series)))
        series = 1 + q * (1 / 3 + q * (1 / 5 + q * series))
        x[i] = k * LN_2 + 2 * s * series if is_positive else 0.0
