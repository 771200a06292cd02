"""Chebyshev polynomials on an interval: Gauss's quadrature, and densities with their integrals in closed form.

docs/patches.md, "Chebyshev polynomials", derives the formulas and their use.

A density is sqrt(1-t^2) phi(t) in the coordinate t of its interval, -1..1. With phi = sum a_k U_k(t), and with rho^-n
in place of T_n(t) outside the interval, where rho = t + sign(t) sqrt(t^2-1), its integrals have closed forms:

    int sqrt(1-s^2) U_k(s)/(t-s) ds      = pi T_(k+1)(t)
    int sqrt(1-s^2) U_k(s) ln|t-s| ds    = (L_k - L_(k+2))/2,  L_0 = pi (ln|rho| - ln 2),  L_n = -(pi/n) T_n(t)

Both hold at the edges and beyond them, where quadrature would lose all digits.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array
from weier.kernels.jit import kernel

Table = NDArray[np.float64]  # shape (degrees, nodes)


class Rule(NamedTuple):
    """Gauss's quadrature at the zeros of T_K, for int phi/sqrt(1-t^2) dt, or of U_K, for int sqrt(1-t^2) phi dt.

    node : t, ascending, shape (K,)
    weight : quadrature weight of each node, shape (K,)
    polynomial : T_k or U_k at the nodes, one k a row, shape (K, K)
    expansion : matrix from values at the nodes to coefficients in T_k or U_k, shape (K, K)
    """

    node: Array
    weight: Array
    polynomial: Table
    expansion: Table


@lru_cache(maxsize=256)
def gauss_rule(count: int, second_kind: bool) -> Rule:
    """Return the rule with this number of nodes; angles are reduced in integers, exact for the highest degrees."""
    if second_kind:
        degree, angle = np.arange(1, count + 1), np.arange(count, 0, -1)
        sine = np.sin(np.pi / (count + 1) * angle)
        weight, scale = np.pi / (count + 1) * sine**2, np.pi / (count + 1)
        polynomial = np.sin(scale * (degree[:, None] * angle % (2 * count + 2))) / sine
    else:
        degree, angle = np.arange(count), np.arange(2 * count - 1, 0, -2)
        weight, scale = np.full(count, np.pi / count), np.pi / (2 * count)
        polynomial = np.cos(scale * (degree[:, None] * angle % (4 * count)))
    expansion = 2 / np.pi * polynomial * weight
    if not second_kind:
        expansion[0] *= 0.5
    return Rule(np.cos(scale * angle), weight, polynomial, expansion)


@kernel
def evaluate_expansion(a: Array, t: float) -> float:
    """Return phi(t) = sum a_k U_k(t), -1 <= t <= 1, by Clenshaw's recurrence."""
    b_after, b = 0.0, 0.0
    for k in range(a.size - 1, -1, -1):
        b, b_after = a[k] + 2 * t * b - b_after, b
    return b


@kernel
def _outer_radius(t: float) -> float:
    """Return rho = t + sign(t) sqrt(t^2-1) of a point t outside [-1, 1]."""
    return t + np.copysign(np.sqrt((t - 1) * (t + 1)), t)


@kernel
def cauchy_integral(a: Array, t: float) -> float:
    """Return int sqrt(1-s^2) phi(s)/(t-s) ds = pi sum a_k T_(k+1)(t) at any real t."""
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
    """Return int sqrt(1-s^2) phi(s) ln|t-s| ds at any real t: a sum of T_n/n with the factors (a_(n-2) - a_n)/2."""
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
def gap_expansion(a: Array) -> Array:
    """Return the U_k coefficients of int_-1^t sqrt(1-s^2) phi(s) ds/(1-t^2)^(3/2), for a gap (a_0 = 0).

    The integral of sqrt(1-s^2) U_k is -(1-t^2)^(3/2) U_k'/(k (k+2)).
    """
    integral = np.zeros(a.size)
    for k in range(1, a.size):
        integral[k] = -a[k] / (k * (k + 2))
    return derivative_expansion(integral)


@kernel
def derivative_expansion(a: Array) -> Array:
    """Return coefficients in U_k of phi', from U_k' = 2 (k U_(k-1) + (k-2) U_(k-3) + ...)."""
    b, total, total_of_next = np.zeros(a.size), 0.0, 0.0
    for k in range(a.size - 1, 0, -1):
        total, total_of_next = total_of_next + a[k], total
        b[k - 1] = 2 * k * total
    return b
