"""The law of a layer: its compression w(p) as a table of ln w over ln p, with slopes, and cubics between the rows."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.jit import kernel

Array = NDArray[np.float64]

STEEPEST = 50.0  # where dw/dp is tiny, steps of ln p up to so many times those of ln w are trusted
MOST_STEPS = 60  # of Newton's method for the pressure; 2-4 do
CLOSE = 1e-3  # of ln p: nearer than the first guess that it is for


class Layer(NamedTuple):
    """ln w and d ln w/d ln p at increasing ln p, each of shape (rows,); power laws beyond both ends."""

    log_pressure: Array
    log_compression: Array
    slope: Array


@kernel
def compression(layer: Layer, log_pressure: float) -> tuple[float, float]:
    """Compression w and dw/d ln p, from the cubic through values and slopes of ln w."""
    y = layer.log_pressure
    low, high = 0, y.size - 1
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if log_pressure > y[middle] else (low, middle)
    length, left, right = y[high] - y[low], layer.slope[low], layer.slope[high]
    start, end = layer.log_compression[low], layer.log_compression[high]
    t, secant = (log_pressure - y[low]) / length, (end - start) / length
    if t <= 0:
        value, slope = start + left * length * t, left
    elif t >= 1:
        value, slope = end + right * length * (t - 1), right
    else:
        bend, twist = 3 * secant - 2 * left - right, left + right - 2 * secant
        value = start + length * t * (left + t * (bend + t * twist))
        slope = left + t * (2 * bend + 3 * t * twist)
    w = math.exp(value)
    return w, w * slope


@kernel
def compressions(layer: Layer, log_pressure: Array) -> tuple[Array, Array]:
    """ln w and d ln w/d ln p at each ln p, of shape (n,)."""
    log_w, slope = np.zeros(log_pressure.size), np.zeros(log_pressure.size)
    for i in range(log_pressure.size):
        w, stiffness = compression(layer, log_pressure[i])
        log_w[i], slope[i] = math.log(w), stiffness / w
    return log_w, slope


@kernel
def log_pressure_of(layer: Layer, log_w: float, log_p: float) -> float:
    """The ln p at which the layer is compressed to w, near a given ln p: Newton's method in logarithms."""
    for _ in range(MOST_STEPS):
        w, stiffness = compression(layer, log_p)
        step = (log_w - math.log(w)) * w / max(stiffness, w / STEEPEST)
        log_p += step
        if abs(step) < CLOSE:
            break
    return log_p
