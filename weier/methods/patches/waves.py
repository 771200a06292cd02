"""A cosine series seen from its summits, so that differences of height near a summit keep all their digits."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.jit import kernel
from weier.theory.crests import summits

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

ROUNDING = 1e-14  # summits of one height to within this, of the sum of amplitudes, are of one height
SMALL_ANGLE = 0.3  # below it, sin(y) - y comes from its series


class Waves(NamedTuple):
    """S(x) = sum a_n cos(k_n x + phi_n) and its local maxima ("summits"), for the kernels.

    S is a height, in g_0, or a pressure, in p_0*.

    amplitude : a_n, in the unit of S, shape (terms,)
    frequency : k_n, in radians per lambda_0, shape (terms,), increasing
    period : L, in lambda_0
    place : of each summit, in lambda_0, in rising order, shape (summits,)
    cosine, sine : of the phases k_n x + phi_n at each summit, shape (summits, terms)
    rise : height of each summit over the highest, <= 0, in the unit of S, shape (summits,)
    top : height of the highest
    """

    amplitude: Array
    frequency: Array
    period: float
    place: Array
    cosine: Array
    sine: Array
    rise: Array
    top: float


def make_waves(amplitude: Array, wavenumber: list[int], phase: Array, period: float) -> Waves:
    """The summits of the series with whole numbers of waves in one period."""
    frequency = 2 * np.pi * np.array(wavenumber, float) / period
    x, theta = summits(amplitude, wavenumber, phase, period)
    order = np.argsort(x, kind="stable")
    x, theta = x[order], theta[order]
    height = np.cos(theta) @ amplitude
    top = float(height.max())
    rise = height - top
    rise[rise > -ROUNDING * np.abs(amplitude).sum()] = 0.0
    return Waves(amplitude, frequency, float(period), x, np.cos(theta), np.sin(theta), rise, top)


@kernel
def excess(waves: Waves, summit: int, y: float) -> tuple[float, float, float]:
    """S - top, S' and S'' at the distance y from a summit, without cancellation for small y."""
    value, slope, curvature = waves.rise[summit], 0.0, 0.0
    for n in range(waves.amplitude.size):
        a, k = waves.amplitude[n], waves.frequency[n]
        c, s = waves.cosine[summit, n], waves.sine[summit, n]
        angle = k * y
        half = np.sin(0.5 * angle)
        sine, drop = np.sin(angle), -2 * half * half
        value += a * (c * drop - s * _sine_less_angle(angle, sine))
        slope -= a * k * (c * sine + s * drop)
        curvature -= a * k * k * (c * (1 + drop) - s * sine)
    return value, slope, curvature


@kernel
def _sine_less_angle(y: float, sine: float) -> float:
    """sin(y) - y = -y^3/3! + y^5/5! - ..."""
    if abs(y) > SMALL_ANGLE:
        return sine - y
    q = y * y
    return -y * q / 6 * (1 - q / 20 * (1 - q / 42 * (1 - q / 72 * (1 - q / 110 * (1 - q / 156)))))


@kernel
def from_summit(waves: Waves, x: float) -> tuple[int, float]:
    """Index of the summit nearest to x on the periodic line, and the distance y of x from it."""
    after = np.searchsorted(waves.place, x - waves.period * np.floor(x / waves.period))
    n = waves.place.size
    i, j = min((after - 1) % n, after % n), max((after - 1) % n, after % n)
    y, z = _offset(waves, i, x), _offset(waves, j, x)
    return (i, y) if abs(y) <= abs(z) else (j, z)


@kernel
def _offset(waves: Waves, summit: int, x: float) -> float:
    """Distance from a summit to the nearest image of x."""
    y = x - waves.place[summit]
    return y - waves.period * np.rint(y / waves.period)


@kernel
def from_summits(waves: Waves, x: Array) -> tuple[Indices, Array]:
    """The same of places x."""
    summit, y = np.empty(x.size, np.int64), np.empty(x.size)
    for i in range(x.size):
        summit[i], y[i] = from_summit(waves, x[i])
    return summit, y
