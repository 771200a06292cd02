"""Densities sqrt(1-t^2) phi(t) on [-1, 1]: Gauss nodes, expansion in U_k, and their closed-form integrals.

With phi = sum a_k U_k(t), t inside or outside [-1, 1], and T_n(t) replaced outside by rho^-n,
rho = t + sign(t) sqrt(t^2-1):

    int sqrt(1-s^2) U_k(s)/(t-s) ds      = pi T_(k+1)(t)
    int sqrt(1-s^2) U_k(s) ln|t-s| ds    = (L_k - L_(k+2))/2,  L_0 = pi (ln|rho| - ln 2),  L_n = -(pi/n) T_n(t)

so that both are exact up to and beyond the edges, where a plain quadrature fails.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from weier.kernels.jit import kernel

Array = NDArray[np.float64]


@kernel
def nodes(count: int) -> Array:
    """Gauss-Chebyshev nodes of the second kind, descending: cos(q pi/(count+1)), q = 1..count."""
    node = np.empty(count)
    for q in range(count):
        node[q] = np.cos((q + 1) * (np.pi / (count + 1)))
    return node


@kernel
def weights(count: int) -> Array:
    """Weights for int sqrt(1-s^2) phi(s) ds at `nodes`."""
    weight = np.empty(count)
    for q in range(count):
        weight[q] = np.pi / (count + 1) * np.sin((q + 1) * (np.pi / (count + 1))) ** 2
    return weight


@kernel
def collocation_point(a: int, count: int) -> float:
    """Zero a = 0..count of T_(count+1), where the quadrature of the Cauchy integral is exact."""
    return np.cos((a + 0.5) * (np.pi / (count + 1)))


@kernel
def _sines(count: int) -> Array:
    """sin(j pi/(count+1)) over a whole turn."""
    sine = np.empty(2 * count + 2)
    for j in range(sine.size):
        sine[j] = np.sin(j * (np.pi / (count + 1)))
    return sine


@kernel
def coefficients(values: Array) -> Array:
    """Coefficients a_k of sum a_k U_k through `values` at the nodes."""
    count = values.size
    sine = _sines(count)
    a = np.zeros(count)
    for k in range(count):
        for q in range(count):
            a[k] += sine[q + 1] * sine[(k + 1) * (q + 1) % (2 * count + 2)] * values[q]
        a[k] *= 2 / (count + 1)
    return a


@kernel
def series(a: Array, t: float) -> float:
    """phi(t) = sum a_k U_k(t), -1 <= t <= 1 (Clenshaw)."""
    after, here = 0.0, 0.0
    for k in range(a.size - 1, -1, -1):
        here, after = a[k] + 2 * t * here - after, here
    return here


@kernel
def integrals(a: Array, t: float) -> tuple[float, float, float]:
    """The Cauchy integral, its derivative and the logarithmic potential at t, any real t; no derivative at +-1."""
    # Both T_k and U_k go on as ratio * here - stretch * before: 2 t and 1 within [-1, 1]; beyond, where rho^-k stands
    # for T_k and its derivative over k for U_(k-1), 1/rho and 0.
    if abs(t) <= 1:
        rho, first, ratio, stretch, steep = 0.0, t, 2 * t, 1.0, 1.0
    else:
        root = np.copysign(np.sqrt((t - 1) * (t + 1)), t)
        rho = t + root
        first, ratio, stretch, steep = 1 / rho, 1 / rho, 0.0, -1 / (rho * root)
    along, slope = 0.0, 0.0
    about = 0.5 * a[0] * (np.log(abs(rho)) if rho != 0 else 0.0) - 0.5 * a[0] * np.log(2.0)
    before, here = 1.0, first  # T_k, T_(k+1)
    flat = 0.0  # U_(k-1), and steep is U_k: T_(k+1)' = (k+1) U_k
    # along = sum a_k T_(k+1), slope = sum a_k T_(k+1)', about = sum a_k (L_k - L_(k+2))/(2 pi), L_n/pi = -T_n/n.
    for k in range(a.size):
        along += a[k] * here
        slope += a[k] * (k + 1) * steep
        after = ratio * here - stretch * before
        if k > 0:
            about -= 0.5 * a[k] * before / k
        about += 0.5 * a[k] * after / (k + 2)
        before, here = here, after
        flat, steep = steep, ratio * steep - stretch * flat
    return np.pi * along, np.pi * slope, np.pi * about


@kernel
def central_logarithm(count: int) -> Array:
    """Weights of int sqrt(1-s^2) phi(s) ln|s| ds for phi through values at the nodes."""
    sine = _sines(count)
    row = np.zeros(count)
    unit = np.zeros(count)
    for k in range(count):
        unit[k] = 1.0
        potential = integrals(unit, 0.0)[2]
        unit[k] = 0.0
        for q in range(count):
            row[q] += potential * 2 / (count + 1) * sine[q + 1] * sine[(k + 1) * (q + 1) % (2 * count + 2)]
    return row


@kernel
def partial_integral(a: Array, t: float) -> float:
    """int_-1^t sqrt(1-s^2) phi(s) ds, -1 <= t <= 1."""
    angle = np.arccos(min(max(t, -1.0), 1.0))
    total = 0.5 * a[0] * (np.pi - angle + 0.5 * np.sin(2 * angle))
    for k in range(1, a.size):
        total += 0.5 * a[k] * (np.sin((k + 2) * angle) / (k + 2) - np.sin(k * angle) / k)
    return total
