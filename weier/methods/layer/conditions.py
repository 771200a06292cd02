"""The contact conditions of a wave, checked in contact and outside on a freshly applied operator.

The displacements of a state of `weier.methods.layer.wave` are summed again as a cosine series, without the matrices
of the mesh.
"""

from __future__ import annotations

import math

import numpy as np

from weier.kernels.arrays import Array
from weier.kernels.jit import kernel
from weier.methods.layer.closure import Closure, compression
from weier.methods.layer.wave import Solutions, depth_of, excesses, log_pressure_factor

POINTS_OUTSIDE = 8  # of the gap where it is checked


@kernel
def violations(solutions: Solutions, log_load: Array, closure: Closure) -> Array:
    """`violation` of every load, shape (loads,)."""
    worst, cosine = np.zeros(log_load.size), cosines(solutions.state.shape[1] - 1)
    for i in range(log_load.size):
        worst[i] = violation(solutions.state[i], log_load[i], closure, solutions.compliance[i], cosine)
    return worst


@kernel
def violation(state: Array, log_load: float, closure: Closure, h: float, cosine: Array) -> float:
    """Largest breach of a contact condition, on a freshly applied operator; relative to the depth and the load.

    The conditions: u + w = h - 2 sin^2(pi x) in contact and at its edge, no less beyond it, and the mean pressure.
    """
    excess, mean = excesses(state)
    series = _series(excess, math.exp(log_load), cosine)
    inside = _inside(state, log_load, closure, h, series, cosine)
    outside = _outside(state, log_load, h, series)
    return max(inside, outside) / depth_of(state[-1])[2] + abs(mean)


@kernel
def cosines(points: int) -> Array:
    """cos(k phi) at the midpoints, shape (k, midpoints)."""
    table = np.empty((points, points))
    for k in range(points):
        for j in range(points):
            table[k, j] = math.cos(k * (j + 0.5) * (math.pi / points))
    return table


@kernel
def _series(excess: Array, load: float, cosine: Array) -> Array:
    """Coefficients of cos(k phi) in u, shape (k,), from those of q."""
    points = excess.size
    series = np.zeros(points)
    for order in range(1, points):
        for j in range(points):
            series[order] += 2 * load / (points * order) * cosine[order, j] * excess[j]
    return series


@kernel
def _inside(state: Array, log_load: float, closure: Closure, h: float, series: Array, cosine: Array) -> float:
    """Largest deviation of u + w from h - 2 sin^2(pi x) at the nodes."""
    points, edge = series.size, state[-1]
    log_sine, _, _ = depth_of(edge)
    displacement, worst = np.full(points, -math.exp(log_load) * log_sine), 0.0
    for order in range(1, points):
        for j in range(points):
            displacement[j] += series[order] * cosine[order, j]
    for j in range(points):
        rise = math.sin((j + 0.5) * (math.pi / (2 * points))) ** 2
        factor, _ = log_pressure_factor(edge, rise)
        w, _ = compression(closure, log_load + state[j] + factor)
        worst = max(worst, abs(displacement[j] + w + 2 * math.exp(log_sine) * (1 - rise) - h))
    return worst


@kernel
def _outside(state: Array, log_load: float, h: float, series: Array) -> float:
    """Largest overlap beyond the edge, or deviation of the gap from 0 at the edge."""
    log_sine, trough, _ = depth_of(state[-1])
    load, sine_squared, worst = math.exp(log_load), math.exp(log_sine), 0.0
    farthest = 2 * math.acosh(math.exp(-log_sine / 2))  # phi = i eta outside: sin(pi x) = sin(pi a) cosh(eta/2)
    for i in range(POINTS_OUTSIDE + 1):
        eta = farthest * i / POINTS_OUTSIDE
        u, decay = 0.0, math.exp(-eta)
        for order in range(series.size - 1, -1, -1):
            u = u * decay + series[order]
        u -= load * (log_sine + eta)
        gap = u + trough + 2 * sine_squared * math.cosh(eta / 2) ** 2 - h
        worst = max(worst, -gap if i > 0 else abs(gap))
    return worst
