"""Contact conditions of a wave on a layer, checked on a freshly applied operator (docs/layer.md, "What is checked").

Displacements are summed as a cosine series, without the matrices of the mesh.
"""

from __future__ import annotations

import numpy as np
import scipy  # its modules are imported on first use, a tenth of a second each

from weier.kernels.arrays import Array
from weier.methods.layer.closure import Closure, log_compression
from weier.methods.layer.wave import Depth, log_pressure_factor, reference_heights

POINTS_OUTSIDE = 8  # points outside the contact at which the gap is checked


def violations(state: Array, log_load: Array, closure: Closure, h: Array) -> Array:
    """Return the largest violation of a contact condition, relative to depth and load, shape (loads,).

    The conditions are u + w = h - 2 sin^2(pi x) in contact and at its edge, >= outside, and the mean pressure.
    """
    points, depth, load = state.shape[1] - 1, reference_heights(state[:, -1]), np.exp(log_load)
    excess = np.expm1(state[:, :-1])
    series = load[:, None] * scipy.fft.dct(excess, axis=1) / (points * np.maximum(np.arange(points), 1))
    series[:, 0] = 0  # coefficients of cos(k theta) in u
    rise = np.sin((np.arange(points) + 0.5) * (np.pi / (2 * points))) ** 2
    displacement = scipy.fft.dct(series, type=3, axis=1) / 2 - (load * depth.log_sine)[:, None]
    log_p = log_load[:, None] + state[:, :-1] + log_pressure_factor(state[:, -1], rise)[0]
    height = 2 * np.exp(depth.log_sine)[:, None] * (1 - rise)
    inside = np.abs(displacement + np.exp(log_compression(closure, log_p)[0]) + height - h[:, None])
    breach = np.maximum(inside.max(axis=1), _overlap(series, load, depth, h))
    return np.asarray(breach / depth.total + np.abs(excess.mean(axis=1)))


def _overlap(series: Array, load: Array, depth: Depth, h: Array) -> Array:
    """Return the largest overlap outside the contact, or deviation of the gap from 0 at the edge."""
    # theta = i eta outside: sin(pi x) = sin(pi a) cosh(eta/2)
    farthest = 2 * np.arccosh(np.exp(-depth.log_sine / 2))
    eta = farthest * np.arange(POINTS_OUTSIDE + 1)[:, None] / POINTS_OUTSIDE
    u = np.polynomial.polynomial.polyval(np.exp(-eta), series.T, tensor=False) - load * (depth.log_sine + eta)
    gap = u + depth.trough + 2 * np.exp(depth.log_sine) * np.cosh(eta / 2) ** 2 - h
    return np.maximum(np.abs(gap[0]), -gap[1:].min(axis=0))
