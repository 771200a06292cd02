"""Crests, the local maxima, of a cosine series sum a_n cos(2 pi k_n x/L + phi_n) with k_n waves in a period L.

They are bracketed by samples and found by Newton's method on Taylor polynomials. docs/numerics.md, "Heights of any
number of waves", derives these and their remainder. Distances t are in steps L/N between N nodes. With 4 nodes per
finest wave, theta_n = 2 pi k_n/N <= pi/2; a polynomial is used up to one step from its node, where the second
derivative has the largest remainder, 3e-16 of sum |a_n| theta_n^2.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Indices

NODES_PER_WAVE = 4  # nodes per finest wave, so that theta_n <= pi/2
ORDER = 22  # gives the remainder 3e-16, see above
# Degrees of the terms of a polynomial, and binomial coefficients for its translation.
DEGREE = np.arange(ORDER + 1.0)
BINOMIAL = np.array([[math.comb(j, i) for j in range(ORDER + 1)] for i in range(ORDER + 1)], float)
SAMPLES_PER_WAVE = 16  # samples per finest wave that resolve every crest
MAX_SAMPLES = 2**17  # samples per period up to which all crests are located before a solution
MAX_NEWTON_STEPS = 60  # more than bisection of a step to rounding takes
# middles of nine parts of an interval of length 1, with its own middle first: equal heights leave a crest at a node
PARTS = np.array(sorted(range(-4, 5), key=abs)) / 9
# factors of |c_j| in bounds of the second, third and fourth derivative for |t| <= 1/2
MAX_CURVATURE = DEGREE * (DEGREE - 1) / 2 ** (DEGREE - 2)
MAX_THIRD = DEGREE * (DEGREE - 1) * (DEGREE - 2) / 2 ** (DEGREE - 3)
MAX_FOURTH = 2 * (DEGREE - 3) * MAX_THIRD
MAX_SAMPLED_WAVES = 10**6  # finest waves whose samples take 128 MB

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
    nodes, waves = count_nodes(waves_per_period[-1]), np.array(waves_per_period)
    spectrum = np.zeros((nodes // 2 + 1, ORDER + 1), complex)
    spectrum[waves] = 0.5 * nodes * np.exp(1j * phase)[:, None] * _wave_coefficients(amplitude, waves, nodes)
    return np.asarray(np.fft.irfft(spectrum, nodes, axis=0))


def _wave_coefficients(amplitude: Array, waves: Indices, nodes: int) -> NDArray[np.complex128]:
    """Return the coefficients a (i theta)^j/j! of each wave, shape (terms, ORDER + 1)."""
    factor = np.empty((waves.size, ORDER + 1), complex)
    factor[:, 0] = amplitude
    factor[:, 1:] = (2j * np.pi / nodes) * waves[:, None] / DEGREE[1:]
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


def countable(waves: int) -> bool:
    """Return whether all crests are located in advance, by the number of the finest waves in a period."""
    return waves * SAMPLES_PER_WAVE <= MAX_SAMPLES


def sample(amplitude: Array, waves_per_period: Sequence[int], phase: Array, points: int) -> Array:
    """Return the series at equal steps over one period, shape (points,), by an FFT.

    Waves are reduced in integers to those of the same values at the points, so that no digit is lost to fine waves.
    """
    coefficient = np.zeros(points, complex)
    np.add.at(coefficient, [k % points for k in waves_per_period], amplitude * np.exp(1j * phase))
    return np.asarray(np.fft.ifft(coefficient).real * points)


class Crests(NamedTuple):
    """The crests of a series, in any order, among the nodes that it is expanded about.

    node, offset : the nearest node, and the distance from there, at most half a step, shape (crests,)
    expansion : coefficients about each crest, shape (crests, ORDER + 1); the slope is 0
    """

    node: Indices
    offset: Array
    expansion: Expansions


def find_crests(amplitude: Array, waves_per_period: Sequence[int], expansion: Expansions) -> Crests:
    """Return all crests of a series that is expanded about all nodes, as by `expand`.

    Each is the fall of the slope through 0 between two of `_slope_signs`. On a flat crest the slope is rounding, and
    the crest is in the middle. The steps of Newton's method are counted from a node: the slope at a crest is 0 to
    rounding, however fine the waves.
    """
    nodes = len(expansion)
    rounding = 4 * np.finfo(float).eps * float(np.abs(amplitude) @ waves_per_period) * 2 * np.pi / nodes
    node, t, rises = _slope_signs(expansion, rounding)
    (before,) = np.nonzero(rises & ~np.roll(rises, -1))
    after = (before + 1) % node.size
    width = (node[after] - node[before]) % nodes + t[after] - t[before]
    steps = np.rint(t[before] + width / 2)
    node, low = (node[before] + steps.astype(np.int64)) % nodes, t[before] - steps
    offset = _newton(expansion[node], low, low + width, rounding)
    steps = np.rint(offset)
    node, offset = (node + steps.astype(np.int64)) % nodes, offset - steps
    about = move(expansion[node], offset)
    about[:, 1] = 0.0
    return Crests(node, offset, about)


def _slope_signs(expansion: Expansions, rounding: float) -> tuple[Indices, Array, NDArray[np.bool_]]:
    """Return points in ascending order, node and distance, and whether the slope s is positive or negative there.

    Between two neighbouring points s changes its sign once at most, or is rounding. On an interval t +- w, with
    M >= |s''|, |s - s(t)| <= w |s'(t)| + w^2 M/2 = r, and s is monotonic if |s'(t)| > w M. A step about a node is
    divided until |s(t)| > r, which gives a point, s is monotonic, which gives both ends, or s is rounding.
    """
    row, t, w = np.arange(len(expansion)), np.zeros(len(expansion)), 0.5
    largest, found = np.abs(expansion) @ MAX_THIRD, list[tuple[Indices, Array, Array]]()
    while row.size > 0:
        slope, curvature = derivatives(expansion[row], t)
        bend = w * largest[row]
        reach = w * (np.abs(curvature) + bend / 2)
        one_sign = np.abs(slope) > reach + rounding
        monotonic = ~one_sign & (np.abs(curvature) > bend)
        found.append((row[one_sign], t[one_sign], slope[one_sign]))
        for end in (t[monotonic] - w, t[monotonic] + w):
            found.append((row[monotonic], end, derivatives(expansion[row[monotonic]], end)[0]))
        divided = ~one_sign & ~monotonic & (np.abs(slope) + reach > 4 * rounding)
        w /= 4
        row, t = np.repeat(row[divided], 4), (t[divided, None] + w * np.array([-3, -1, 1, 3])).ravel()
    row, t, slope = map(np.concatenate, zip(*found, strict=True))
    known = np.abs(slope) > rounding
    order = np.lexsort((t[known], row[known]))
    return row[known][order], t[known][order], slope[known][order] > 0


def _newton(expansion: Expansions, low: Array, high: Array, rounding: float) -> Array:
    """Return zeros of falling slopes between two ends, by Newton's method with bisection."""
    t, unsettled = 0.5 * (low + high), np.arange(low.size)
    for _ in range(MAX_NEWTON_STEPS):
        slope, curvature = derivatives(expansion[unsettled], t[unsettled])
        off = np.abs(slope) > rounding
        if not off.any():
            break
        unsettled, slope, curvature = unsettled[off], slope[off], np.minimum(curvature[off], -1e-300)
        at = t[unsettled]
        low[unsettled] = np.where(slope > 0, at, low[unsettled])
        high[unsettled] = np.where(slope > 0, high[unsettled], at)
        step, middle = at - slope / curvature, 0.5 * (low + high)[unsettled]
        inside = (step > low[unsettled]) & (step < high[unsettled])
        t[unsettled] = np.where(inside, step, middle)
    return t


def highest_crest(
    amplitude: Array, waves_per_period: Sequence[int], phase: Array, period: float
) -> tuple[float, float]:
    """Return position and height of the highest point of a series, by branch and bound.

    A crest within w of a point is higher by at most w^2/2 times the largest curvature there, by which samples are
    chosen, and then parts of the step about each of them, as long as these may be higher than the highest point so
    far. On a plateau the curvature is rounding. ValueError is raised if the samples would not fit into memory.
    """
    if waves_per_period[-1] > MAX_SAMPLED_WAVES:
        raise ValueError(
            f"the highest crest is looked for among at most {MAX_SAMPLED_WAVES} waves in a period, got "
            f"{waves_per_period[-1]:.2g}: take fewer terms, or a gamma of smaller numbers"
        )
    waves, points = np.array(waves_per_period), SAMPLES_PER_WAVE * waves_per_period[-1]
    angle, size = 2 * np.pi / points * waves, np.abs(amplitude)
    spectrum = np.zeros(points // 2 + 1, complex)
    spectrum[waves] = 0.5 * points * amplitude * np.exp(1j * phase)
    z, half_width = np.fft.irfft(spectrum, points), 0.5
    curvature, rounding = float(size @ angle**2), float(np.finfo(float).eps * size.sum())
    if waves.size > 32:  # the bound of Ehlich and Zeller by samples, which is lower for many waves
        spectrum[waves] *= angle**2
        curvature = float(np.abs(np.fft.irfft(spectrum, points)).max() / np.cos(np.pi / SAMPLES_PER_WAVE))
    (node,) = (z >= z.max() - curvature * half_width**2 / 2 - rounding).nonzero()
    theta = phase_angle(waves, node[:, None], points) + phase
    expansion = (np.exp(1j * theta) @ _wave_coefficients(amplitude, waves, points)).real
    largest = np.abs(expansion) @ MAX_CURVATURE  # a bound of |z''| on the step about each node
    row, t, z, best = np.arange(node.size), np.zeros(node.size), z[node], (-np.inf, 0, 0.0)
    while row.size > 0:
        highest = z.argmax()
        best = max(best, (z[highest], row[highest], t[highest]), key=lambda point: point[0])
        (kept,) = (z + largest[row] * half_width**2 / 2 > best[0] + rounding).nonzero()
        row, part = row[kept], t[kept, None] + 2 * half_width * PARTS
        z = (np.cos(theta[row, None] + part[..., None] * angle) @ amplitude).ravel()
        row, t, half_width = np.repeat(row, PARTS.size), part.ravel(), half_width / PARTS.size
    height, highest, offset = best
    theta = theta[highest]
    at = theta + offset * angle
    if (downward := np.cos(at) @ (amplitude * angle**2)) > rounding:  # Newton's step for the position
        newton = offset - np.sin(at) @ (amplitude * angle) / downward
        stepped = np.cos(theta + newton * angle) @ amplitude
        if stepped >= height - rounding:  # It may leave a flat crest, where both derivatives are rounding.
            offset, height = newton, stepped
    return float((node[highest] + offset) % points * (period / points)), float(height)


def crest_heights(
    amplitude: Array, waves_per_period: Sequence[int], phase: Array, period: float, position: Array
) -> list[Any]:
    """Return heights of the crests near these positions in 40 digits, for the parameters of the series as floats.

    The heights of twin crests may be equal as floats. The error of a position, slope/curvature, is corrected by
    adding slope^2/(2 curvature) to the height.
    """
    import mpmath as mp  # few profiles need this import of a tenth of a second

    with mp.workdps(40):
        k = [2 * mp.pi * mp.mpf(int(n)) / mp.mpf(period) for n in waves_per_period]
        phi, a = [mp.mpf(float(p)) for p in phase], [mp.mpf(float(a_n)) for a_n in amplitude]
        heights = []
        for x in position:
            theta = [k_n * mp.mpf(float(x)) + phi_n for k_n, phi_n in zip(k, phi, strict=True)]
            slope = -mp.fsum(a_n * k_n * mp.sin(t) for a_n, k_n, t in zip(a, k, theta, strict=True))
            curvature = -mp.fsum(a_n * k_n**2 * mp.cos(t) for a_n, k_n, t in zip(a, k, theta, strict=True))
            heights.append(mp.fdot(a, map(mp.cos, theta)) - slope**2 / (2 * curvature))
        return heights
