"""Polynomials on the nodes about a contact or a gap: fitted, differentiated, and expanded on an interval.

A polynomial is the array of its coefficients c_0, c_1, ... of 1, s, s^2, ..., shape (TERMS,).
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.jit import kernel
from weier.methods.chebyshev import gauss_rule

DEGREE = 8  # over half a wave, a cosine differs from its best polynomial of this degree by 1e-6
TERMS = DEGREE + 1
EDGE = 0.384947631413  # nodes from the last one in contact to the edge of a flat punch, in the mean of a step
MAX_BEYOND = 1.5  # nodes from the last one in contact to its edge: half a node in all that a grid can miss
MARGIN = 2  # nodes beyond a contact or a gap that its polynomial is fitted on, at each end; more if it has few itself
MAX_MARGIN = (TERMS + 1) // 2 + MARGIN
CREST_MARGIN = DEGREE // 2  # and beyond the highest node of a gap, or the node of least pressure in a contact
MAX_FITTED = 25  # nodes that a polynomial is fitted on: more add nothing
MIN_POLYNOMIAL = 3  # nodes of a window: a parabola


# The nodes of Chebyshev: mean values over them are exact for all products of two such polynomials.
NODES, _, _, _EXPANSION = gauss_rule(TERMS + 1, of_second_kind=False)
MEANS = np.array([0.0 if k % 2 else math.comb(k, k // 2) / 2**k for k in range(TERMS + 4)])  # of t^k over these nodes


_CHEBYSHEV = np.eye(TERMS + 2)  # T_0, T_1, ... in powers of s
for _k in range(2, TERMS + 2):
    _CHEBYSHEV[_k] = 2 * np.roll(_CHEBYSHEV[_k - 1], 1) - _CHEBYSHEV[_k - 2]


@kernel
def value(polynomial: Array, s: float) -> float:
    """The polynomial at s."""
    total = 0.0
    for k in range(polynomial.size - 1, -1, -1):
        total = total * s + polynomial[k]
    return total


@kernel
def size(terms: Array, s: float) -> float:
    """The sizes of two polynomials at s, together."""
    return abs(value(terms[0], s)) + abs(value(terms[1], s))


@kernel
def slopes(polynomial: Array, s: float) -> tuple[float, float, float]:
    """Its first three derivatives at s."""
    total = first = second = third = 0.0
    for k in range(polynomial.size - 1, -1, -1):
        third = third * s + second
        second = second * s + first
        first = first * s + total
        total = total * s + polynomial[k]
    return first, 2 * second, 6 * third


@kernel
def shift(polynomial: Array, by: float) -> None:
    """Make of the coefficients those of powers of s - by."""
    for i in range(polynomial.size - 1):
        for k in range(polynomial.size - 2, i - 1, -1):
            polynomial[k] += by * polynomial[k + 1]


@kernel
def derivative(polynomial: Array) -> Array:
    """Its derivative, as long an array with a last coefficient of 0."""
    slope = np.zeros(polynomial.size)
    for k in range(1, polynomial.size):
        slope[k - 1] = k * polynomial[k]
    return slope


@kernel
def expansion(polynomial: Array, centre: float, half_width: float) -> Array:
    """Coefficients of T_0, T_1, ... on the interval, shape (TERMS,)."""
    coefficients = np.zeros(TERMS)
    for i in range(NODES.size):
        here = value(polynomial, centre + half_width * NODES[i])
        for k in range(TERMS):
            coefficients[k] += _EXPANSION[k, i] * here
    return coefficients


class Windows(NamedTuple):
    """Fits for windows of w = 0, 1, ... nodes, in s from -1 at the first to 1 at the last; those below 2 are empty.

    fitted : nodes that are fitted on, shape (windows,)
    degree : of the polynomial, shape (windows,)
    offset : of these nodes from the first of the window, shape (windows, MAX_FITTED)
    coefficient : of s^k for a value of 1 at one of these nodes, shape (windows, MAX_FITTED, TERMS)
    following : what the fit makes of the two Chebyshev polynomials after its degree, shape (windows, 2, TERMS)
    """

    fitted: Indices
    degree: Indices
    offset: Indices
    coefficient: Array
    following: Array


@lru_cache(maxsize=4)
def make_windows(most: int) -> Windows:
    """Fits for windows of up to so many nodes, by least squares in Chebyshev polynomials."""
    windows = Windows(
        np.zeros(most + 1, np.int64), np.zeros(most + 1, np.int64), np.zeros((most + 1, MAX_FITTED), np.int64),
        np.zeros((most + 1, MAX_FITTED, TERMS)), np.zeros((most + 1, 2, TERMS)),
    )  # fmt: skip
    for window in range(2, most + 1):
        fitted = min(window, MAX_FITTED)
        degree = min(DEGREE, fitted - 1)
        for i in range(fitted):
            windows.offset[window, i] = (i * (window - 1) + (fitted - 1) // 2) // (fitted - 1)
        s = windows.offset[window, :fitted] / scale_of(window) - 1
        windows.fitted[window], windows.degree[window] = fitted, degree
        basis = np.polynomial.chebyshev.chebvander(s, degree + 2)
        fit = np.linalg.lstsq(basis[:, : degree + 1], np.eye(fitted), rcond=None)[0]
        windows.coefficient[window, :fitted] = fit.T @ _CHEBYSHEV[: degree + 1, :TERMS]
        windows.following[window] = basis[:, degree + 1 :].T @ windows.coefficient[window, :fitted]
    return windows


@kernel
def scale_of(window: int) -> float:
    """The nodes in one s of a window of so many."""
    return (window - 1) / 2


@kernel
def without_own(field: Array, own: Array, table: Array, start: int, margin: int, offset: Indices) -> Array:
    """The field at nodes of a window that begins `margin` nodes before a run, less what its `own` nodal values do.

    The run begins at `start`. `table` tells what a value of 1 does to the field at 0, 1, 2, ... nodes from it.
    """
    values = np.empty(offset.size)
    for i in range(offset.size):
        node = offset[i] - margin
        values[i] = field[(start + node) % field.size]
        for j in range(own.size):
            values[i] -= table[abs(node - j)] * own[j]
    return values


@kernel
def fit_without(field: Array, own: Array, table: Array, start: int, margin: int, windows: Windows) -> Array:
    """The polynomial of what that leaves, fitted on the run and `margin` more nodes at both ends, shape (TERMS,)."""
    window = own.size + 2 * margin
    coefficient = windows.coefficient[window]
    values = without_own(field, own, table, start, margin, windows.offset[window, : windows.fitted[window]])
    polynomial = np.zeros(TERMS)
    for i in range(values.size):
        for k in range(TERMS):
            polynomial[k] += coefficient[i, k] * values[i]
    return polynomial


@kernel
def remainder(polynomial: Array, windows: Windows, window: int, angle: float, rest: Array) -> None:
    """Write what the fit to a window leaves of an odd and an even term beyond its degree, polynomials, into `rest`.

    The terms are of T_(degree + 1) and T_(degree + 2), less what the fit makes of them. Their coefficients are those
    of a wave whose phase turns by `angle` from node to node and by `ratio` in one s: they alternate, and fall by
    `ratio`^2/(4 k (k + 1)) from one of a parity to the next; where they fell more slowly so far, they go on like
    that. A last one that is smaller than the one before tells, as where waves cancel in it, counts as large as that.
    """
    degree, ratio = windows.degree[window], scale_of(window) * angle
    coefficients = expansion(polynomial, 0.0, 1.0)
    for j in range(2):
        last, before = (abs(coefficients[max(degree - 1 + j, 0)]), abs(coefficients[max(degree - 3 + j, 0)]))
        fall = ratio * ratio / (4 * (degree + j) * (degree + 1 + j))
        ratio_of_falls = (degree + j - 2) * (degree + j - 1) / ((degree + j) * (degree + j + 1))
        magnitude = max(last, fall * before / ratio_of_falls) if ratio_of_falls > 0 else last
        if ratio_of_falls * last > fall * before:
            fall = min(ratio_of_falls * last / before, 1.0)
        factor = -fall * np.copysign(magnitude, coefficients[max(degree - 1 + j, 0)])
        for k in range(TERMS + 2):
            fitted = windows.following[window, j, k] if k < TERMS else 0.0
            rest[j, k] = (_CHEBYSHEV[degree + 1 + j, k] - fitted) * factor


@kernel
def margin_of(edge: Indices, run: int) -> int:
    """Nodes beyond both ends of a run that belong to no further one, at most as many as the polynomial needs."""
    before, nodes = edge[run + 1] - edge[run], edge[run + 2] - edge[run + 1]
    after = edge[run + 3] - edge[run + 2] if run + 3 < edge.size else edge[2] - edge[1]
    return min(max(MARGIN, (TERMS - nodes + 1) // 2), before, after)


@kernel
def average_under_triangle(polynomial: Array, scale: float) -> Array:
    """The moving average of a polynomial under a triangle of the nodes' spacing."""
    second = derivative(derivative(polynomial))
    fourth = derivative(derivative(second))
    return polynomial + second / (12 * scale**2) + fourth / (360 * scale**4)


@kernel
def added_by_triangles(polynomial: Array, nodes: int, scale: float) -> Array:
    """What that average adds at the nodes of a run."""
    added = average_under_triangle(polynomial, scale) - polynomial
    values = np.empty(nodes)
    for i in range(nodes):
        values[i] = value(added, (i - (nodes - 1) / 2) / scale)
    return values


@kernel
def side_margin(node: int, contact: Flags) -> int:
    """Nodes to each side of this one that are in contact if it is, and not if it is not; at most CREST_MARGIN."""
    margin, here, n = 1, contact[node], contact.size
    while margin < CREST_MARGIN and contact[node - margin - 1] == here == contact[(node + margin + 1) % n]:
        margin += 1
    return margin
