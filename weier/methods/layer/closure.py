"""The closure of a layer: its compression w(p), a table of ln w over ln p with slopes and cubics between the rows."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array
from weier.kernels.jit import kernel

MAX_PRESSURE_STEP = 50.0  # of ln p, in steps of ln w: where dw/dp is tiny, longer steps are not trusted
MAX_NEWTON_STEPS = 60  # for the pressure; 2-4 are usual
MAX_PRESSURE_ERROR = 1e-3  # of ln p: the first guess of a wave needs it no closer
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


@kernel
def compression(closure: Closure, log_pressure: float) -> tuple[float, float]:
    """Compression w and dw/d ln p, from the cubic through the values and slopes of ln w.

    The two slopes of a cubic are limited to three times its chord. The limit looks at no other row, so that a table
    that is continued to other pressures has the same values between the rows that it had before.
    """
    scaled, rows = (log_pressure - closure.origin) / POSITION_SCALE, closure.position.size
    position, stretch = math.asinh(scaled), POSITION_SCALE * math.sqrt(1 + scaled**2)
    if position <= closure.position[0]:
        return _power(closure, 0, log_pressure)
    if position >= closure.position[rows - 1]:
        return _power(closure, rows - 1, log_pressure)
    low, high = 0, rows - 1
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if position > closure.position[middle] else (low, middle)
    length, start = closure.position[high] - closure.position[low], closure.log_compression[low]
    t, chord = (position - closure.position[low]) / length, (closure.log_compression[high] - start) / length
    left = min(closure.slope[low], MAX_SLOPE_RATIO * chord)
    right = min(closure.slope[high], MAX_SLOPE_RATIO * chord)
    quadratic, cubic = 3 * chord - 2 * left - right, left + right - 2 * chord
    w = math.exp(start + length * t * (left + t * (quadratic + t * cubic)))
    return w, w * (left + t * (2 * quadratic + 3 * t * cubic)) / stretch


@kernel
def _power(closure: Closure, row: int, log_pressure: float) -> tuple[float, float]:
    """The power law through the first or last row."""
    position = closure.position[row]
    power = closure.slope[row] / (POSITION_SCALE * math.cosh(position))
    distance = log_pressure - closure.origin - POSITION_SCALE * math.sinh(position)
    w = math.exp(closure.log_compression[row] + power * distance)
    return w, w * power


@kernel
def compressions(closure: Closure, log_pressure: Array) -> tuple[Array, Array]:
    """ln w and d ln w/d ln p at each ln p, of shape (n,)."""
    log_w, slope = np.zeros(log_pressure.size), np.zeros(log_pressure.size)
    for i in range(log_pressure.size):
        w, rate = compression(closure, log_pressure[i])
        log_w[i], slope[i] = math.log(w), rate / w
    return log_w, slope


@kernel
def log_pressure_of(closure: Closure, log_w: float, log_p: float) -> float:
    """The ln p at which the layer is compressed to w, near a given ln p: Newton's method in logarithms."""
    for _ in range(MAX_NEWTON_STEPS):
        w, rate = compression(closure, log_p)
        step = (log_w - math.log(w)) * w / max(rate, w / MAX_PRESSURE_STEP)
        log_p += step
        if abs(step) < MAX_PRESSURE_ERROR:
            break
    return log_p
