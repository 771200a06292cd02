"""Densities sqrt(1-t^2) phi(t) on [-1, 1]: Gauss nodes, the expansion in U_k, and its integrals in closed form.

With phi = sum a_k U_k(t), and with rho^-n in place of T_n(t) for t outside [-1, 1], where
rho = t + sign(t) sqrt(t^2-1):

    int sqrt(1-s^2) U_k(s)/(t-s) ds      = pi T_(k+1)(t)
    int sqrt(1-s^2) U_k(s) ln|t-s| ds    = (L_k - L_(k+2))/2,  L_0 = pi (ln|rho| - ln 2),  L_n = -(pi/n) T_n(t)

Both hold at the edges and beyond them, where quadrature would lose all digits.
"""

from __future__ import annotations

import numpy as np

from weier.kernels.arrays import Array
from weier.kernels.jit import kernel


@kernel
def nodes(count: int) -> Array:
    """Gauss-Chebyshev nodes of the second kind in descending order: cos(q pi/(count+1)), q = 1..count."""
    node = np.empty(count)
    for q in range(count):
        node[q] = np.cos((q + 1) * (np.pi / (count + 1)))
    return node


@kernel
def weights(count: int) -> Array:
    """Weights of the quadrature for int sqrt(1-s^2) phi(s) ds at `nodes`."""
    weight = np.empty(count)
    for q in range(count):
        weight[q] = np.pi / (count + 1) * np.sin((q + 1) * (np.pi / (count + 1))) ** 2
    return weight


@kernel
def collocation_point(a: int, count: int) -> float:
    """Zero number a = 0..count of T_(count+1), at which the quadrature of the Cauchy integral is exact."""
    return np.cos((a + 0.5) * (np.pi / (count + 1)))


@kernel
def _sines(count: int) -> Array:
    """sin(j pi/(count+1)) over one period of the sine, j = 0..2 count + 1."""
    sine = np.empty(2 * count + 2)
    for j in range(sine.size):
        sine[j] = np.sin(j * (np.pi / (count + 1)))
    return sine


@kernel
def expansion_coefficients(values: Array) -> Array:
    """Coefficients a_k of the sum a_k U_k that takes `values` at the nodes."""
    count = values.size
    sine = _sines(count)
    a = np.zeros(count)
    for k in range(count):
        for q in range(count):
            a[k] += sine[q + 1] * sine[(k + 1) * (q + 1) % (2 * count + 2)] * values[q]
        a[k] *= 2 / (count + 1)
    return a


@kernel
def evaluate_expansion(a: Array, t: float) -> float:
    """phi(t) = sum a_k U_k(t), -1 <= t <= 1, by Clenshaw's recurrence."""
    b_after, b = 0.0, 0.0
    for k in range(a.size - 1, -1, -1):
        b, b_after = a[k] + 2 * t * b - b_after, b
    return b


@kernel
def integrals(a: Array, t: float) -> tuple[float, float, float]:
    """The Cauchy integral, its derivative in t and the logarithmic potential at any real t.

    The derivative has no finite value at t = 1 and t = -1.
    """
    # Within [-1, 1], T_k and U_k follow y_(k+1) = 2 t y_k - y_(k-1). Outside, rho^-k stands for T_k, and its
    # derivative over k for U_(k-1); both follow y_(k+1) = y_k/rho. So one recurrence with two factors serves all.
    if abs(t) <= 1:
        rho, T, factor, factor_before, U = 0.0, t, 2 * t, 1.0, 1.0
    else:
        root = np.copysign(np.sqrt((t - 1) * (t + 1)), t)
        rho = t + root
        T, factor, factor_before, U = 1 / rho, 1 / rho, 0.0, -1 / (rho * root)
    cauchy, slope = 0.0, 0.0
    potential = 0.5 * a[0] * (np.log(abs(rho)) if rho != 0 else 0.0) - 0.5 * a[0] * np.log(2.0)
    T_before, U_before = 1.0, 0.0
    # In round k, T is T_(k+1), U is U_k, and T_(k+1)' = (k+1) U_k. Without their factors of pi:
    # cauchy = sum a_k T_(k+1), slope = sum a_k T_(k+1)', potential = sum a_k (L_k - L_(k+2))/2.
    for k in range(a.size):
        cauchy += a[k] * T
        slope += a[k] * (k + 1) * U
        T_after = factor * T - factor_before * T_before
        if k > 0:
            potential -= 0.5 * a[k] * T_before / k
        potential += 0.5 * a[k] * T_after / (k + 2)
        T_before, T = T, T_after
        U_before, U = U, factor * U - factor_before * U_before
    return np.pi * cauchy, np.pi * slope, np.pi * potential


def log_weights(count: int) -> Array:
    """Weights of the quadrature for int sqrt(1-s^2) phi(s) ln|s| ds at `nodes`."""
    k = np.arange(1, count + 2)
    L = -np.pi * np.append(np.log(2.0), np.array([1, 0, -1, 0])[k % 4] / k)  # T_k(0) = 1, 0, -1, 0
    q = np.arange(1, count + 1)
    sine = np.sin(np.outer(q, q) % (2 * count + 2) * (np.pi / (count + 1)))
    return np.asarray(sine[0] * (sine @ (L[:-2] - L[2:])) / (count + 1))


@kernel
def partial_integral(a: Array, t: float) -> float:
    """int_-1^t sqrt(1-s^2) phi(s) ds, -1 <= t <= 1."""
    angle = np.arccos(min(max(t, -1.0), 1.0))
    total = 0.5 * a[0] * (np.pi - angle + 0.5 * np.sin(2 * angle))
    for k in range(1, a.size):
        total += 0.5 * a[k] * (np.sin((k + 2) * angle) / (k + 2) - np.sin(k * angle) / k)
    return total
