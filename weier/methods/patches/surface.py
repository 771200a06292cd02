"""A profile as the solver needs it: its heights, and the tensions of full contact, both evaluated from their crests.

A crest is a local maximum of a cosine series. A contact that has just been born lies so close to a crest that the
difference of height between the two would be lost in rounding, if both heights were sums over all waves. Therefore
positions are given as a crest and the distance from it, and heights relative to the highest crest.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Indices
from weier.kernels.jit import kernel
from weier.theory.crests import crest_heights, find_crests
from weier.theory.limits import check_crests
from weier.theory.waves import Waves

# Of the sum of amplitudes: crests that differ by less, which is rounding of the phases, are equally high; and those
# that differ by less than the latter are told apart in more digits than a float has.
MAX_HEIGHT_ROUNDING, TWIN_HEIGHT = 1e-14, 1e-6
MAX_SERIES_ANGLE = 0.3  # up to it sin(y) - y, which would cancel, is summed as a power series


class CosineSeries(NamedTuple):
    """S(x) = sum a_n cos(k_n x + phi_n) with its crests, in arrays for the kernels.

    S is a height, in g_0, or a tension, in p_0*.

    amplitude : a_n, in the unit of S, shape (terms,)
    wavenumber : k_n, in radians per lambda_0, increasing, shape (terms,)
    period : L, in lambda_0
    crest_position : in lambda_0, increasing, shape (crests,)
    crest_cosine, crest_sine : of the phases k_n x + phi_n at each crest, shape (crests, terms)
    crest_curvature : -S'' at each crest, shape (crests,)
    crest_offset : S at each crest less the maximum of S, <= 0, in the unit of S, shape (crests,)
    maximum : S at the highest crest
    """

    amplitude: Array
    wavenumber: Array
    period: float
    crest_position: Array
    crest_cosine: Array
    crest_sine: Array
    crest_curvature: Array
    crest_offset: Array
    maximum: float


class Surface(NamedTuple):
    """The two series that the solver looks at.

    heights : z, in g_0: the first contact is on its highest crest
    tensions : the pressure of full contact with its sign turned and without its mean, in p_0*: the last gap is at
        its highest crest
    total_amplitude : sum g_n, in g_0
    """

    heights: CosineSeries
    tensions: CosineSeries
    total_amplitude: float

    @property
    def full_contact_load(self) -> float:
        """The mean pressure that makes up for the largest tension: contact is full from here on, in p_0*."""
        return self.tensions.maximum

    def series(self, dual: bool) -> CosineSeries:
        """The heights, for segments that are contacts, or the tensions, for segments that are gaps (dual)."""
        return self.tensions if dual else self.heights


def surface_of(profile: Waves) -> Surface:
    """The series of a profile with a finite number of terms; ValueError if its waves are too many for a computer."""
    check_crests(profile)
    waves = profile.waves_per_period, profile.phase, profile.period
    return Surface(
        make_series(profile.amplitude, *waves),
        make_series(-profile.full_contact_pressure, *waves),
        profile.total_amplitude,
    )


def make_series(amplitude: Array, waves_per_period: Sequence[int], phase: Array, period: float) -> CosineSeries:
    """The series with its crests."""
    wavenumber = 2 * np.pi * np.array(waves_per_period, float) / period
    x, theta = find_crests(amplitude, waves_per_period, phase, period)
    x = _round_positions(x, period)
    order = np.argsort(x, kind="stable")
    x, theta = x[order], theta[order]
    cosine, most = np.cos(theta), float(np.abs(amplitude).sum())
    height = cosine @ amplitude
    maximum = float(height.max())
    offset = height - maximum
    twins = np.flatnonzero(offset > -TWIN_HEIGHT * most)
    if twins.size > 1:
        exact = crest_heights(amplitude, waves_per_period, phase, period, x[twins])
        offset[twins] = [float(each - max(exact)) for each in exact]
    offset[offset > -MAX_HEIGHT_ROUNDING * most] = 0.0
    crests = x, cosine, np.sin(theta), cosine @ (amplitude * wavenumber**2), offset, maximum
    return CosineSeries(amplitude, wavenumber, float(period), *crests)


def _round_positions(x: Array, period: float) -> Array:
    """Positions within [0, L), rounded so that a period more or less leaves them all their digits."""
    x = (x % period + 4 * period) - 4 * period
    return np.asarray(np.where(x < period, x, 0.0))


@kernel
def evaluate_series(series: CosineSeries, crest: int, y: float) -> tuple[float, float, float]:
    """S - max S, S' and S'' at the distance y from a crest, without cancellation for small y."""
    value, slope, curvature = series.crest_offset[crest], 0.0, 0.0
    for n in range(series.amplitude.size):
        a, k = series.amplitude[n], series.wavenumber[n]
        c, s = series.crest_cosine[crest, n], series.crest_sine[crest, n]
        angle = k * y
        half_sine, half_cosine = np.sin(0.5 * angle), np.cos(0.5 * angle)
        sine, cosine_less_one = 2 * half_sine * half_cosine, -2 * half_sine * half_sine
        value += a * (c * cosine_less_one - s * _sine_less_angle(angle, sine))
        slope -= a * k * (c * sine + s * cosine_less_one)
        curvature -= a * k * k * (c * (1 + cosine_less_one) - s * sine)
    return value, slope, curvature


@kernel
def _sine_less_angle(y: float, sine: float) -> float:
    """sin(y) - y = -y^3/3! + y^5/5! - ..."""
    if abs(y) > MAX_SERIES_ANGLE:
        return sine - y
    q = y * y
    return -y * q / 6 * (1 - q / 20 * (1 - q / 42 * (1 - q / 72 * (1 - q / 110 * (1 - q / 156)))))


@kernel
def evaluate_at(series: CosineSeries, crest: Indices, y: Array, derivative: int) -> Array:
    """S - max S, S' or S'' at the distances y from crests."""
    value = np.empty(y.size)
    for i in range(y.size):
        value[i] = evaluate_series(series, crest[i], y[i])[derivative]
    return value


@kernel
def nearest_crests(series: CosineSeries, x: Array) -> tuple[Indices, Array]:
    """Indices of the crests nearest to positions x on the periodic line, and the distances y of x from them."""
    period, crest, nearest, y = series.period, series.crest_position, np.zeros(x.size, np.int64), np.empty(x.size)
    for i in range(x.size):
        after, y[i] = np.searchsorted(crest, x[i] - period * np.floor(x[i] / period)), np.inf
        for neighbour in ((after - 1) % crest.size, after % crest.size):
            distance = x[i] - crest[neighbour]
            distance -= period * np.rint(distance / period)
            if abs(distance) < abs(y[i]):
                nearest[i], y[i] = neighbour, distance
    return nearest, y
