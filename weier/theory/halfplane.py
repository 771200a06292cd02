"""The elastic half-plane under periodic pressure: what N equal elements of linear pressure do to the surface.

A pressure wave p_k displaces the surface by u_k = p_k/|k|, with k in waves per lambda_0; the mean pressure is
removed, u_0 = 0. On N equal elements with linear pressure the same is a circulant matrix, known exactly through its
eigenvalues: no sum over image loads is cut off (Section 5.1 of the paper; Johnson 1985, Eq. 2.37 and Fig. 5.17c).
"""

from __future__ import annotations

from functools import lru_cache
from typing import TypeVar

import numpy as np
import scipy  # its parts load when they are used

from weier.kernels.arrays import Array
from weier.kernels.jit import kernel

Number = TypeVar("Number", float, Array)


@lru_cache(maxsize=16)  # of one hierarchy of grids, which the next profile has again
def eigenvalues(points: int, period: float = 1.0) -> Array:
    """Displacement per pressure for each wave that `points` nodes can carry.

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
    A triangle of pressure has the spectrum sinc^2; its aliases at kappa + j sum to Hurwitz zeta functions:
    sin^2(pi kappa)/(pi^2 N) [zeta(3, kappa) + zeta(3, 1 - kappa)] with kappa = k/N.

    """
    kappa = np.arange(1, points // 2 + 1) / points
    aliases = scipy.special.zeta(3, kappa) + scipy.special.zeta(3, 1 - kappa)
    values = np.concatenate([[0.0], period * np.sin(np.pi * kappa) ** 2 / (np.pi**2 * points) * aliases])
    values.flags.writeable = False
    return values


def influence_coefficients(points: int, period: float = 1.0) -> Array:
    """Displacement at node j when the pressure is 1 at node 0, shape (points,), in g_0/p_0*."""
    return np.fft.irfft(eigenvalues(points, period), points)


@kernel
def displacement_at_distance(x: float, period: float) -> float:
    """Displacement at the distance x from a unit force on a line, and its images: -2 ln|2 sin(pi x/L)|, of mean 0."""
    return -2 * np.log(abs(2 * np.sin(np.pi / period * x)))


@kernel
def displacement_of_punch(half_width: Number, period: float) -> Number:
    """Displacement under a flat punch of unit force, far narrower than the period: -2 ln(pi r/L)."""
    return -2 * np.log(np.pi / period * half_width)
