"""Polynomials through a few nodes: fitted, differentiated, and expanded in Chebyshev polynomials on an interval.

A polynomial is the array of its coefficients c_0, c_1, ... of 1, s, s^2, ..., shape (TERMS,).
"""

from __future__ import annotations

import math

import numpy as np

from weier.kernels.arrays import Array
from weier.kernels.jit import kernel

DEGREE = 8  # over half a wave, a cosine differs from its best polynomial of this degree by 1e-6
TERMS = DEGREE + 1
REST = 1.6  # times the next two terms of a polynomial (`remainder`), for all further ones
_ANGLES = np.pi * (np.arange(TERMS + 1) + 0.5) / (TERMS + 1)
NODES = np.cos(_ANGLES)  # of Chebyshev: mean values over them are exact for all products of two such polynomials
MEANS = np.array([0.0 if k % 2 else math.comb(k, k // 2) / 2**k for k in range(TERMS + 4)])  # of t^k over these nodes
_EXPANSION = np.cos(np.arange(TERMS)[:, None] * _ANGLES) * np.where(np.arange(TERMS) > 0, 2, 1)[:, None] / NODES.size


_CHEBYSHEV = np.array(
    [
        np.pad(np.polynomial.chebyshev.cheb2poly(row[: k + 1]), (0, TERMS + 1 - k))
        for k, row in enumerate(np.eye(TERMS + 2))
    ]
)  # T_0, T_1, ... in powers of s


@kernel
def fit_polynomials(s: Array, values: Array, degree: int) -> Array:
    """Least-squares polynomials of this degree, shape (k, TERMS), for values at s, shapes (k, nodes) and (nodes,)."""
    terms = degree + 1
    basis = np.empty((terms, s.size))
    triangle = np.zeros((terms, terms))
    for j in range(terms):  # Gram and Schmidt on the powers of s, each row freed of those before
        basis[j] = s**j
        for i in range(j):
            triangle[i, j] = np.sum(basis[i] * basis[j])
            basis[j] -= triangle[i, j] * basis[i]
        triangle[j, j] = np.sqrt(np.sum(basis[j] ** 2))
        basis[j] /= triangle[j, j]
    fitted = np.zeros((values.shape[0], TERMS))
    for k in range(values.shape[0]):
        for j in range(terms - 1, -1, -1):
            rest = np.sum(basis[j] * values[k])
            for i in range(j + 1, terms):
                rest -= triangle[j, i] * fitted[k, i]
            fitted[k, j] = rest / triangle[j, j]
    return fitted


@kernel
def next_terms(s: Array, degree: int) -> Array:
    """The two Chebyshev polynomials after `degree` at s, shape (2, nodes)."""
    values = np.empty((2, s.size))
    for j in range(2):
        for i in range(s.size):
            values[j, i] = value(_CHEBYSHEV[degree + 1 + j], s[i])
    return values


@kernel
def remainder(polynomial: Array, fitted_next: Array, degree: int, ratio: float) -> Array:
    """What a fit of this degree leaves of an odd and an even term beyond it, as polynomials, shape (2, TERMS + 2).

    The terms are of T_(degree + 1) and T_(degree + 2), less what the fit makes of them, `fitted_next`. Their
    coefficients are those of a wave: they alternate, and fall by `ratio`^2/(4 k (k + 1)) from one of a parity to the
    next; where they fell more slowly so far, they go on like that. A last one that is smaller than the one before
    tells, as where waves cancel in it, counts as large as that.
    """
    coefficients = expansion(polynomial, 0.0, 1.0)
    rest = np.empty((2, TERMS + 2))
    for j in range(2):
        last, before = (abs(coefficients[max(degree - 1 + j, 0)]), abs(coefficients[max(degree - 3 + j, 0)]))
        fall = ratio * ratio / (4 * (degree + j) * (degree + 1 + j))
        slower = (degree + j - 2) * (degree + j - 1) / ((degree + j) * (degree + j + 1))
        size = max(last, fall * before / slower) if slower > 0 else last
        if slower * last > fall * before:
            fall = min(slower * last / before, 1.0)
        rest[j] = _CHEBYSHEV[degree + 1 + j]
        rest[j, :TERMS] -= fitted_next[j]
        rest[j] *= -fall * np.copysign(size, coefficients[max(degree - 1 + j, 0)])
    return rest


@kernel
def value(polynomial: Array, s: float) -> float:
    """The polynomial at s."""
    total = 0.0
    for k in range(polynomial.size - 1, -1, -1):
        total = total * s + polynomial[k]
    return total


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


@kernel
def second_kind(coefficients: Array) -> Array:
    """Coefficients of U_0, U_1, ... from those of T_0, T_1, ...: 2 T_k = U_k - U_(k-2)."""
    converted = coefficients / 2
    converted[0] = coefficients[0]
    converted[:-2] -= coefficients[2:] / 2
    return converted
