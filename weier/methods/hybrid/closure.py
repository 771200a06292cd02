"""Closure of the layer at a node: pressure as a function of the nodal unknown Y (docs/hybrid.md, "The equations")."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import scipy  # its modules are imported on first use, a tenth of a second each

from weier.kernels.arrays import Array
from weier.methods import layer
from weier.methods.layer.tables import MIN_LOADS
from weier.surface.profile import Profile

ROWS = 400  # of ln p over ln Y: as accurate as the table of the layer
MIN_LOAD, MAX_LOAD = MIN_LOADS[0], 1e3  # range of the rows, in p_0*


class NodalClosure(NamedTuple):
    """Layer at a node: ln p over ln Y = ln(w + A_00 p), its inverse, and the self-influence A_00."""

    log_pressure: scipy.interpolate.CubicHermiteSpline
    log_unknown: scipy.interpolate.CubicHermiteSpline
    self_influence: float


def closure_at_nodes(kept: Profile, self_influence: float) -> NodalClosure:
    """Return the layer of all terms after these, in the units of the first wave, at nodes of this self-influence."""
    D, gamma, n = kept.D, float(kept.gamma), kept.terms
    peaks = 1 / math.expm1((D - 1) * math.log(gamma))  # of all resolved waves in full contact, in p_k*, at most
    log_xi = np.linspace(math.log(MIN_LOAD), math.log(MAX_LOAD + peaks), ROWS)
    log_W, power = layer.tail_closure(log_xi, D, gamma)
    compression, pressure = gamma ** ((D - 2) * n) * np.exp(log_W), gamma ** ((D - 1) * n) * np.exp(log_xi)
    unknown = compression + self_influence * pressure
    slope = unknown / (power * compression + self_influence * pressure)  # d ln p/d ln Y
    return NodalClosure(
        scipy.interpolate.CubicHermiteSpline(np.log(unknown), np.log(pressure), slope),
        scipy.interpolate.CubicHermiteSpline(np.log(pressure), np.log(unknown), 1 / slope),
        self_influence,
    )


def pressure_at(unknown: Array, closure: NodalClosure) -> tuple[Array, Array]:
    """Return p(Y) and dp/dY, shape (N,): 0 for Y <= 0, a power law outside the table."""
    inside = unknown > 0
    positive = np.where(inside, unknown, 1.0)
    log_unknown = np.log(positive)
    log_p, power = _extrapolated(closure.log_pressure, log_unknown)
    p = np.where(inside, np.exp(log_p), 0.0)
    return p, power * p / positive


def unknown_at(pressure: Array, closure: NodalClosure) -> Array:
    """Return Y(p), shape (N,); A_00 p for negative pressures."""
    inside = pressure > 0
    log_unknown, _ = _extrapolated(closure.log_unknown, np.log(np.where(inside, pressure, 1.0)))
    return np.where(inside, np.exp(log_unknown), closure.self_influence * pressure)


def _extrapolated(spline: scipy.interpolate.CubicHermiteSpline, x: Array) -> tuple[Array, Array]:
    """Return a spline and its slope, which is that of the nearest end beyond its ends."""
    near = np.clip(x, *spline.x[[0, -1]])
    slope = spline(near, 1)
    return spline(near) + slope * (x - near), slope
