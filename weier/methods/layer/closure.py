"""Closure w(p) of a layer: a table of ln w over ln p with cubic interpolation.

docs/layer.md derives the formulas: "One scale" defines w, "Tables" its interpolation.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy  # its modules are imported on first use, a tenth of a second each

from weier.kernels.arrays import Array


class Closure(NamedTuple):
    """ln w - `log_height` as cubics over the position asinh(ln p - origin); outside, w is a power of p.

    In this variable the curvature of ln w is uniform over hundreds of decades.
    """

    cubics: scipy.interpolate.PPoly
    origin: float
    log_height: float


def closure_from_table(position: Array, log_compression: Array, slope: Array) -> Closure:
    """Return the closure of a table: ln w and its slope at increasing positions, each of shape (rows,).

    The two slopes of a cubic are limited to three times its chord.
    """
    length = np.diff(position)
    chord = np.diff(log_compression) / length
    # A cubic is monotone up to slopes of three times its chord (Fritsch and Carlson 1980).
    first, last = (np.minimum(at_end, 3 * chord) for at_end in (slope[:-1], slope[1:]))
    quadratic, cubic = (3 * chord - 2 * first - last) / length, (first + last - 2 * chord) / length**2
    return Closure(scipy.interpolate.PPoly([cubic, quadratic, first, log_compression[:-1]], position), 0.0, 0.0)


def position_in(closure: Closure, log_pressure: Array) -> tuple[Array, Array]:
    """Return positions of ln p, clipped to the rows, and the excess beyond both ends, linear in ln p."""
    position = np.arcsinh(log_pressure - closure.origin)
    inside = np.clip(position, *closure.cubics.x[[0, -1]])
    excess = log_pressure - closure.origin - np.sinh(inside)
    return inside, np.where(inside == position, 0.0, excess / np.cosh(inside))


def log_compression(closure: Closure, log_pressure: Array) -> tuple[Array, Array]:
    """Return ln w and d ln w/d ln p at each ln p."""
    position, excess = position_in(closure, log_pressure)
    slope = closure.cubics(position, 1)
    log_w = closure.log_height + closure.cubics(position) + slope * excess
    return log_w, slope / np.cosh(position)
