"""Densities sqrt(1-t^2) phi(t) on [-1, 1]: Gauss nodes, the expansion in U_k, and its integrals in closed form.

With phi = sum a_k U_k(t), and with rho^-n in place of T_n(t) for t outside [-1, 1], where
rho = t + sign(t) sqrt(t^2-1):

    int sqrt(1-s^2) U_k(s)/(t-s) ds      = pi T_(k+1)(t)
    int sqrt(1-s^2) U_k(s) ln|t-s| ds    = (L_k - L_(k+2))/2,  L_0 = pi (ln|rho| - ln 2),  L_n = -(pi/n) T_n(t)

Both hold at the edges and beyond them, where quadrature would lose all digits.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Indices
from weier.kernels.jit import kernel


def nodes(count: int) -> Array:
    """Gauss-Chebyshev nodes of the second kind in ascending order: -cos(q pi/(count+1)), q = 1..count."""
    return np.asarray(-np.cos(np.arange(1, count + 1) * (np.pi / (count + 1))))


def weights(count: int) -> Array:
    """Weights of the quadrature for int sqrt(1-s^2) phi(s) ds at `nodes`."""
    return np.asarray(np.pi / (count + 1) * np.sin(np.arange(1, count + 1) * (np.pi / (count + 1))) ** 2)


def log_weights(count: int) -> Array:
    """Weights of the quadrature for int sqrt(1-s^2) phi(s) ln|s| ds at `nodes`, from L_k - L_(k+2) at t = 0."""
    q, k = np.arange(1, count + 1), np.arange(0, count, 2)
    T = np.where(k % 4 == 0, 1.0, -1.0)  # T_k(0); that of k + 2 has the other sign
    own = np.append(-np.log(2.0), -T[1:] / k[1:])
    sine = np.sin(np.pi / (count + 1) * (q[:, None] * (k + 1) % (2 * count + 2)))  # of an angle without rounding
    return np.asarray(np.pi / (count + 1) * np.sin(q * (np.pi / (count + 1))) * (sine @ (own - T / (k + 2))))


@kernel
def collocation_point(a: int, count: int) -> float:
    """Zero number a = 0..count of T_(count+1), at which the quadrature of the Cauchy integral is exact."""
    return -np.cos((a + 0.5) * (np.pi / (count + 1)))


@kernel
def sines(count: int) -> Array:
    """sin(j pi/(count+1)) over one period of the sine, j = 0..2 count + 1."""
    half = count + 1
    sine = np.empty(2 * half)
    sine[0] = sine[half] = 0.0
    for j in range(1, half // 2 + 1):
        sine[j] = sine[half - j] = np.sin(j * (np.pi / half))
        sine[half + j] = sine[2 * half - j] = -sine[j]
    return sine


@kernel
def expansion_coefficients(values: Array) -> Array:
    """Coefficients a_k of the sum a_k U_k that takes `values` at the nodes."""
    count = values.size
    sine = sines(count)
    a = np.zeros(count)
    for k in range(count):
        angle = 0
        for q in range(count):
            angle = advance(angle, k + 1, sine.size)
            a[k] += sine[q + 1] * sine[angle] * values[count - 1 - q]
        a[k] *= 2 / (count + 1)
    return a


@kernel
def advance(angle: int, step: int, period: int) -> int:
    """(angle + step) % period of two numbers below the period, without a division."""
    angle += step
    return angle - period if angle >= period else angle


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
