"""Densities sqrt(1-t^2) phi(t) on [-1, 1]: Gauss nodes, the expansion in U_k, and its integrals in closed form.

With phi = sum a_k U_k(t), and with rho^-n in place of T_n(t) for t outside [-1, 1], where
rho = t + sign(t) sqrt(t^2-1):

    int sqrt(1-s^2) U_k(s)/(t-s) ds      = pi T_(k+1)(t)
    int sqrt(1-s^2) U_k(s) ln|t-s| ds    = (L_k - L_(k+2))/2,  L_0 = pi (ln|rho| - ln 2),  L_n = -(pi/n) T_n(t)

Both hold at the edges and beyond them, where quadrature would lose all digits.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Indices
from weier.kernels.jit import kernel

Table = NDArray[np.float64]  # shape (degrees, nodes)


class Rule(NamedTuple):
    """Gauss's quadrature at the zeros of T_K, for int phi/sqrt(1-t^2) dt, or of U_K, for int sqrt(1-t^2) phi dt.

    node : t, ascending, shape (K,)
    weight : of the values at the nodes, shape (K,)
    polynomial : T_k or U_k at the nodes, one k a row, shape (K, K)
    expansion : what makes coefficients in T_k or U_k of values at the nodes, shape (K, K)
    """

    node: Array
    weight: Array
    polynomial: Table
    expansion: Table


@lru_cache(maxsize=256)
def gauss_rule(count: int, of_second_kind: bool) -> Rule:
    """The rule of so many nodes. Angles are reduced in integers, so that the highest degrees lose no digit."""
    if of_second_kind:
        degree, angle = np.arange(1, count + 1), np.arange(count, 0, -1)
        sine = np.sin(np.pi / (count + 1) * angle)
        weight, scale = np.pi / (count + 1) * sine**2, np.pi / (count + 1)
        polynomial = np.sin(scale * (degree[:, None] * angle % (2 * count + 2))) / sine
    else:
        degree, angle = np.arange(count), np.arange(2 * count - 1, 0, -2)
        weight, scale = np.full(count, np.pi / count), np.pi / (2 * count)
        polynomial = np.cos(scale * (degree[:, None] * angle % (4 * count)))
    expansion = 2 / np.pi * polynomial * weight
    if not of_second_kind:
        expansion[0] *= 0.5
    return Rule(np.cos(scale * angle), weight, polynomial, expansion)


@lru_cache(maxsize=256)
def log_moments(count: int) -> Array:
    """int sqrt(1-s^2) U_k ln|s| ds, k = 0..count - 1, from L_k - L_(k+2) at t = 0."""
    moment, k = np.zeros(count), np.arange(0, count, 2)
    T = np.where(k % 4 == 0, 1.0, -1.0)  # T_k(0); that of k + 2 has the other sign
    own = np.append(np.log(2.0), T[1:] / k[1:])
    moment[::2] = -0.5 * np.pi * (own + T / (k + 2))
    return moment


class Blocks(NamedTuple):
    """A matrix for each segment, from values of its own in a row with those of the others to new values in a row.

    table : the entries of all matrices, column by column
    start : where each begins in the table, shape (segments,); several may be the same
    first_row, first_column : the first new and old values of each and, last, the number of all, shape (segments + 1,)
    """

    table: Array
    start: Indices
    first_row: Indices
    first_column: Indices


def make_blocks(matrices: Iterable[Table]) -> Blocks:
    """The matrices of all segments in order."""
    matrices = list(matrices)
    rows, columns = zip(*(each.shape for each in matrices), strict=True)
    start = np.cumsum([0, *(each.size for each in matrices)])
    table = np.concatenate([each.ravel("F") for each in matrices])
    return Blocks(table, start, np.cumsum([0, *rows]), np.cumsum([0, *columns]))


@kernel
def apply_blocks(blocks: Blocks, f: Array) -> Array:
    """The matrix of each segment times its part of f."""
    result = np.zeros(blocks.first_row[-1])
    for j in range(blocks.first_row.size - 1):
        here, entry = result[blocks.first_row[j] : blocks.first_row[j + 1]], blocks.start[j]
        for q in range(blocks.first_column[j], blocks.first_column[j + 1]):
            factor, column = f[q], blocks.table[entry : entry + here.size]
            for i in range(here.size):
                here[i] += factor * column[i]
            entry += here.size
    return result


@kernel
def collocation_point(a: int, count: int) -> float:
    """Zero number a = 0..count of T_(count+1), at which the quadrature of the Cauchy integral is exact."""
    return -np.cos((a + 0.5) * (np.pi / (count + 1)))


@kernel
def evaluate_expansion(a: Array, t: float) -> float:
    """phi(t) = sum a_k U_k(t), -1 <= t <= 1, by Clenshaw's recurrence."""
    b_after, b = 0.0, 0.0
    for k in range(a.size - 1, -1, -1):
        b, b_after = a[k] + 2 * t * b - b_after, b
    return b


@kernel
def _outer_radius(t: float) -> float:
    """rho, of a point outside [-1, 1]."""
    return t + np.copysign(np.sqrt((t - 1) * (t + 1)), t)


@kernel
def cauchy_integral(a: Array, t: float) -> float:
    """int sqrt(1-s^2) phi(s)/(t-s) ds = pi sum a_k T_(k+1)(t) at any real t."""
    if abs(t) > 1:
        total, w = 0.0, 1 / _outer_radius(t)
        for k in range(a.size - 1, -1, -1):
            total = (total + a[k]) * w
        return np.pi * total
    b_after, b = 0.0, 0.0
    for k in range(a.size - 1, -1, -1):
        b, b_after = a[k] + 2 * t * b - b_after, b
    return np.pi * (t * b - b_after)


@kernel
def log_integral(a: Array, t: float) -> float:
    """int sqrt(1-s^2) phi(s) ln|t-s| ds at any real t: a sum of T_n/n with the factors (a_(n-2) - a_n)/2."""
    outside = abs(t) > 1
    w = 1 / _outer_radius(t) if outside else 0.0
    double, back = (w, 0.0) if outside else (2 * t, 1.0)
    b_after, b = 0.0, 0.0
    for n in range(a.size + 1, 0, -1):
        factor = (a[n - 2] if n > 1 else 0.0) - (a[n] if n < a.size else 0.0)
        b, b_after = factor / (2 * n) + double * b - back * b_after, b
    total = w * b if outside else t * b - b_after
    return np.pi * (total - 0.5 * a[0] * (np.log(2.0) + (np.log(abs(w)) if outside else 0.0)))


@kernel
def partial_integral(a: Array, t: float) -> float:
    """int_-1^t sqrt(1-s^2) phi(s) ds, -1 <= t <= 1."""
    angle = np.arccos(min(max(t, -1.0), 1.0))
    total = 0.5 * a[0] * (np.pi - angle + 0.5 * np.sin(2 * angle))
    for k in range(1, a.size):
        total += 0.5 * a[k] * (np.sin((k + 2) * angle) / (k + 2) - np.sin(k * angle) / k)
    return total


def degrees(first_node: Indices) -> Indices:
    """The degree of the polynomial whose coefficient is kept at each node's place, from 0 on each segment."""
    return np.arange(first_node[-1]) - np.repeat(first_node[:-1], np.diff(first_node))


def end_sums(first_node: Indices, coefficient: Array) -> NDArray[np.float64]:
    """The sums of the coefficients of each segment, shape (segments, 2): at -1, with the sign (-1)^k, and at 1."""
    signed = np.where(degrees(first_node) % 2 == 0, coefficient, -coefficient)
    return np.stack([np.add.reduceat(each, first_node[:-1]) for each in (signed, coefficient)], axis=1)
