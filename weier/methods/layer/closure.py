"""The closure of a layer: its compression w(p), a table of ln w over ln p with slopes and cubics between the rows."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array

POSITION_SCALE = 4.0  # of ln p: up to here positions are even in it
MAX_SLOPE_RATIO = 3.0  # of a slope to the chord of its cubic: above it the cubic may not be monotone


class Closure(NamedTuple):
    """ln w and its slope at increasing positions, each of shape (rows,). Beyond both ends w is a power of p.

    The position of a pressure is asinh((ln p - origin)/4). In it ln w bends evenly over hundreds of decades: near the
    origin the position is ln p but for a factor, far from it a logarithm of ln p.
    """

    position: Array
    log_compression: Array
    slope: Array
    origin: float


def position_in(closure: Closure, log_pressure: Array) -> tuple[Array, Array]:
    """Positions of ln p within the rows, and what the pressures beyond both ends add to them there."""
    position = np.arcsinh((log_pressure - closure.origin) / POSITION_SCALE)
    inside = np.clip(position, closure.position[0], closure.position[-1])
    beyond = log_pressure - closure.origin - POSITION_SCALE * np.sinh(inside)
    return inside, np.where(inside == position, 0.0, beyond / (POSITION_SCALE * np.cosh(inside)))


def log_compression(closure: Closure, log_pressure: Array) -> tuple[Array, Array]:
    """ln w and d ln w/d ln p at each ln p, from the cubics through the values and slopes of ln w.

    The two slopes of a cubic are limited to three times its chord.
    """
    position, beyond = position_in(closure, log_pressure)
    right = np.clip(np.searchsorted(closure.position, position), 1, closure.position.size - 1)
    left = right - 1
    length, start = closure.position[right] - closure.position[left], closure.log_compression[left]
    t, chord = (position - closure.position[left]) / length, (closure.log_compression[right] - start) / length
    first = np.minimum(closure.slope[left], MAX_SLOPE_RATIO * chord)
    last = np.minimum(closure.slope[right], MAX_SLOPE_RATIO * chord)
    quadratic, cubic = 3 * chord - 2 * first - last, first + last - 2 * chord
    slope = first + t * (2 * quadratic + 3 * t * cubic)
    log_w = start + length * t * (first + t * (quadratic + t * cubic)) + slope * beyond
    return log_w, slope / (POSITION_SCALE * np.cosh(position))
