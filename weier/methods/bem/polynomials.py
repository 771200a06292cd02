"""Polynomials through a few nodes: fitted, differentiated, and expanded in Chebyshev polynomials on an interval.

A polynomial is the array of its coefficients c_0, c_1, ... of 1, s, s^2, ..., shape (TERMS,).
"""

from __future__ import annotations

import numpy as np

from weier.kernels.arrays import Array
from weier.kernels.jit import kernel

DEGREE = 8  # over half a wave, a cosine differs from its best polynomial of this degree by 1e-6
TERMS = DEGREE + 1
_ANGLES = np.pi * (np.arange(TERMS + 1) + 0.5) / (TERMS + 1)
NODES = np.cos(_ANGLES)  # of Chebyshev: mean values over them are exact for all products of two such polynomials
_EXPANSION = np.cos(np.arange(TERMS)[:, None] * _ANGLES) * np.where(np.arange(TERMS) > 0, 2, 1)[:, None] / NODES.size


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
def value(polynomial: Array, s: float) -> float:
    """The polynomial at s."""
    total = 0.0
    for k in range(polynomial.size - 1, -1, -1):
        total = total * s + polynomial[k]
    return total


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
