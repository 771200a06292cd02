"""Taylor polynomials of a cosine series sum a_n cos(2 pi k_n x/L + phi_n) with k_n waves in a period L.

docs/numerics.md, "Heights of any number of waves", derives the method and its remainder. Distances t are in steps L/N
between N nodes. With 4 nodes per finest wave, theta_n = 2 pi k_n/N <= pi/2; a polynomial is used up to one step from
its node, where the second derivative has the largest remainder, 3e-16 of sum |a_n| theta_n^2.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Indices

NODES_PER_WAVE = 4  # nodes per finest wave, so that theta_n <= pi/2
ORDER = 22  # gives the remainder 3e-16, see above
# Degrees of the terms of a polynomial, and binomial coefficients for its translation.
DEGREE = np.arange(ORDER + 1.0)
BINOMIAL = np.array([[math.comb(j, i) for j in range(ORDER + 1)] for i in range(ORDER + 1)], float)

Expansions = NDArray[np.float64]  # of which each row has the coefficients of t^0, t^1, ..., shape (rows, ORDER + 1)


def count_nodes(waves: int) -> int:
    """Return the power of 2 of nodes that resolves this number of finest waves per period."""
    return 1 << (NODES_PER_WAVE * waves - 1).bit_length()


def phase_angle(waves: int | Indices, node: Indices, nodes: int) -> Array:
    """Return the angle 2 pi k x/L of a wave at nodes, reduced in integers, so that no digit is lost to fine waves."""
    return np.asarray((waves * node % nodes) * (2 * np.pi / nodes))


def expand(amplitude: Array, waves_per_period: Sequence[int], phase: Array) -> Expansions:
    """Return the expansions about all `count_nodes` nodes.

    By `irfft`, a wave of k_n in N nodes has the spectrum N/2 a_n exp(i phi_n) at k_n.
    """
    nodes = count_nodes(waves_per_period[-1])
    spectrum = np.zeros((nodes // 2 + 1, ORDER + 1), complex)
    wave = 0.5 * nodes * np.exp(1j * phase)
    spectrum[np.array(waves_per_period)] = wave[:, None] * _wave_coefficients(amplitude, waves_per_period, nodes)
    return np.asarray(np.fft.irfft(spectrum, nodes, axis=0))


def _wave_coefficients(amplitude: Array, waves_per_period: Sequence[int], nodes: int) -> NDArray[np.complex128]:
    """Return the coefficients a (i theta)^j/j! of each wave, shape (terms, ORDER + 1)."""
    factor = np.empty((len(waves_per_period), ORDER + 1), complex)
    factor[:, 0] = amplitude
    factor[:, 1:] = (2j * np.pi / nodes) * np.array(waves_per_period, float)[:, None] / DEGREE[1:]
    return np.asarray(np.multiply.accumulate(factor, axis=1))


def derivatives(expansion: Expansions, t: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the first and second derivative of each row in t, at t of shape (..., rows)."""
    power = np.vander(t.ravel(), ORDER, increasing=True).reshape(*t.shape, ORDER)
    first = DEGREE[1:] * expansion[:, 1:]
    second = DEGREE[1:-1] * first[:, 1:]
    slope = np.einsum("ij,...ij->...i", first, power)
    return slope, np.einsum("ij,...ij->...i", second, power[..., :-1])


def move(expansion: Expansions, t: Array) -> Expansions:
    """Return the polynomials translated to t: the coefficient of order i is sum_j (j over i) c_j t^(j-i)."""
    moved, power = np.empty_like(expansion), np.vander(t, ORDER + 1, increasing=True)
    for i in range(ORDER + 1):
        moved[:, i] = np.einsum("j,ij,ij->i", BINOMIAL[i, i:], expansion[:, i:], power[:, : ORDER + 1 - i])
    return moved
