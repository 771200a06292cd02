"""The theory of 2000: contact area and pressures by a cascade of pressures from each wave to the next finer one.

docs/cascade.md derives the formulas. One wave under the mean pressure q has the pressures of (10); each of them is
the mean pressure on the next finer wave. The fraction F_k of the area on which the pressure of the finest of k
waves exceeds a value t follows from the fraction F_1 of the finest wave alone,

    F_1(xi) = (2/pi) arcsin sqrt(c (1 - S)),    F_k(xi) = (2/pi) int F_{k-1}(gamma^(1-D) p(y; xi)) dy,

with the load xi of the coarsest of k waves over its full-contact pressure and y = pi x over its half wavelength.
Each F_k is a table over ln xi. Pressures are in p_0*.
"""

from __future__ import annotations

import itertools
import math
import sys
from typing import NamedTuple

import numpy as np
import scipy  # Its submodules are loaded on first use.
from numpy.typing import ArrayLike

from weier.kernels.arrays import Array
from weier.methods.curve import Curve
from weier.methods.errors import NotApplicableError
from weier.methods.method import CURVE_SECONDS, Method, Style
from weier.surface.profile import Profile

MIN_LOG_LOAD = math.log(sys.float_info.min)  # least ln xi of a table
MAX_LOG_LOAD = math.log(1e4)  # largest ln xi of a table: heavier waves are flat
CONVERGENCE_TOLERANCE = 1e-5  # relative change by one more wave below which tables of longer series are the same
MAX_TABLES = 200  # one table takes some 20 ms
# beyond, the distance of the exponent of F_k from 1, 2^-k, changes no ratio by more than the tolerance
LIGHT_TABLES = math.log2(-MIN_LOG_LOAD / CONVERGENCE_TOLERANCE)
# Spacing of the rows of a table, in arsinh of ln xi below 0 and in ln xi above, and rows on each side of a kink, for
# a relative error of 1e-4: twice as many change no more (tests/methods/test_cascade.py)
SPACING = 0.025
KINK_OFFSETS = np.geomspace(1e-7, 0.06, 24)


def tanh_sinh(count: int) -> tuple[Array, Array]:
    """Return nodes and weights of tanh-sinh quadrature on (0, 1), for integrands with singular ends.

    The outermost nodes lie the relative rounding of floats from the ends.
    """
    end = math.asinh(-math.log(sys.float_info.epsilon) / math.pi)
    steps, step = np.linspace(-end, end, count, retstep=True)
    nodes = 1 / (1 + np.exp(-np.pi * np.sinh(steps)))
    return nodes, step * np.pi * np.cosh(steps) * nodes * nodes[::-1]


QUADRATURE = tanh_sinh(41)  # as many nodes as that relative error takes: tests/methods/test_cascade.py


class Finest(NamedTuple):
    """F_1: the fraction of one wave on which the pressure exceeds a value, in its own full-contact pressure."""

    pressure: float
    exponent: float = 0.5

    def scaled_at(self, xi: Array, scale: ArrayLike = 1.0) -> Array:
        """Return the fraction under these loads over a power of a scale."""
        exceeding = np.minimum(xi, 1.0) * np.maximum(1 - _limit(xi, self.pressure), 0)
        return np.asarray(2 / np.pi * np.arcsin(np.sqrt(exceeding)) / np.asarray(scale) ** self.exponent)

    @property
    def kinks(self) -> set[float]:
        """The loads at which it is singular: full contact, or a peak or trough at this pressure."""
        return {1.0, *_loads_with(self.pressure)} - {0.0}


class Table:
    """F_k gamma^((D-1) (k-1)) over ln xi, as the ratio to min(xi, 1)^exponent, which hardly varies.

    kinks : the loads at which it is singular
    """

    def __init__(self, rows: Array, ratios: Array, exponent: float, kinks: set[float]) -> None:
        self.exponent, self.kinks = exponent, kinks
        self._ratio = scipy.interpolate.PchipInterpolator(rows, ratios)

    def scaled_at(self, xi: Array, scale: ArrayLike = 1.0) -> Array:
        """Return the values under these loads over a power of a scale."""
        with np.errstate(divide="ignore"):
            ratio = self._ratio(np.clip(np.log(xi), MIN_LOG_LOAD, MAX_LOG_LOAD))
        return np.asarray(ratio * (np.minimum(xi, 1.0) / scale) ** self.exponent)


def exceedance(pressure: float, mean_pressure: ArrayLike, D: float, gamma: float, m: float) -> Array:
    """Return the fraction of the nominal area on which the local pressure exceeds a value.

    Parameters
    ----------
    pressure : float
        The value, at least 0, in p_0*. For 0 the fraction is the contact fraction. The density of pressures is minus
        the derivative with respect to it.
    mean_pressure : array_like
        Mean pressures p > 0, in p_0*.
    D, gamma, m : float
        Fractal dimension in (1, 2), ratio of wavelengths > 1, number of terms; for m = inf the fraction is 0.

    Returns
    -------
    ndarray
        Of the shape of `mean_pressure`.

    """
    p = np.atleast_1d(np.asarray(mean_pressure, float))
    found = np.zeros(p.shape)
    if math.isfinite(m):
        step = (D - 1) * math.log(gamma)
        finest = Finest(pressure * math.exp(-step * (m - 1)))
        # A wave far beyond full contact only shifts the pressure: the finer waves form a shorter series.
        flat = np.minimum(np.ceil(np.maximum(np.log(p) - MAX_LOG_LOAD, 0) / step), m)
        for skipped in np.unique(flat):
            here = flat == skipped
            load, waves = p[here] * np.exp(-step * skipped), int(m - skipped)
            found[here] = _fraction(finest, load, step, waves) if waves else p[here] > pressure
        with np.errstate(over="ignore"):
            total = np.expm1(step * m) / np.expm1(step)  # sum of all full-contact pressures, gamma^((D-1) n)
        found[p >= pressure + total] = 1
    return found.reshape(np.shape(mean_pressure))


def contact_fraction(mean_pressure: ArrayLike, D: float, gamma: float, m: float) -> Array:
    """Return the contact area over the nominal area, 0 for m = inf; the arguments are those of `exceedance`."""
    return exceedance(0.0, mean_pressure, D, gamma, m)


def _fraction(finest: Finest, xi: Array, step: float, waves: int) -> Array:
    """Return F_k for k waves under loads on the coarsest; `step` is (D - 1) ln(gamma)."""
    if waves == 1:
        return finest.scaled_at(xi)
    # Coarser waves inherit the kinks of finer ones, but each mean over a wave smooths them.
    kinks = finest.kinks | {load for kink in finest.kinks for load in _loads_with(kink * math.exp(step))}
    rows = _rows(kinks)
    finer: Finest | Table = finest
    ratios = np.zeros(rows.size)
    for _ in range(math.ceil(_tables(step, waves))):
        before, ratios = ratios, _cascaded(finer, np.exp(rows), step)
        finer = Table(rows, ratios, (1 + finer.exponent) / 2, kinks)
        if np.all(np.abs(ratios - before) <= CONVERGENCE_TOLERANCE * ratios):
            break  # The ratios of longer series are the same.
    covered = np.minimum(xi, 1.0)
    ratio = _cascaded(finer, xi, step) * math.exp(-step * (waves - 1))
    return np.asarray(np.minimum(ratio * covered ** ((1 + finer.exponent) / 2), 1.0))


def _cascaded(finer: Finest | Table, xi: Array, step: float) -> Array:
    """Return the ratio of the next coarser table under loads xi, by quadrature between the kinks of the finer one."""
    # The angle is counted from the edge, where sin(y) = sqrt(xi) cos(angle); in full contact from the trough.
    ends = [np.arcsin(np.sqrt(np.minimum(_limit(xi, kink * math.exp(step)), 1.0))) for kink in sorted(finer.kinks)]
    ends = [np.zeros(xi.shape), *ends, np.full(xi.shape, np.pi / 2)]
    covered, excess = np.minimum(xi, 1.0)[:, None], np.maximum(xi - 1, 0)[:, None]
    scale, total, (nodes, weights) = np.sqrt(covered), np.zeros(xi.shape), QUADRATURE
    for start, end in itertools.pairwise(ends):
        width = (end - start)[:, None]
        sine = np.sin(start[:, None] + width * nodes)
        cosine = np.sqrt(1 - covered + covered * sine**2)  # cos(y)
        load = math.exp(-step) * (2 * scale * cosine * sine + excess)
        slope = np.divide(sine, cosine, out=np.zeros(sine.shape), where=cosine > 0)  # dy over the angle and the scale
        total += (width * weights * slope * finer.scaled_at(load, scale)).sum(axis=1)
    return np.asarray(2 / np.pi * math.exp(step) * total)


def _limit(xi: Array, pressure: float) -> Array:
    """Return S = sin^2 of the angle from the edge at which the pressure (10) of one wave has a value."""
    covered, excess = np.minimum(xi, 1.0), np.maximum(xi - 1, 0)
    above = np.maximum(pressure - excess, 0)
    root = 1 - covered + np.hypot(1 - covered, above)
    with np.errstate(over="ignore"):  # far beyond the peak the quotient may overflow
        return np.asarray(np.divide(above**2, 2 * covered * root, out=np.zeros(above.shape), where=above > 0))


def _loads_with(pressure: float) -> tuple[float, float]:
    """Return the two loads of a wave at which its peak pressure and its trough pressure have this value."""
    return (pressure**2 / 4 if pressure <= 2 else pressure - 1), pressure + 1


def _rows(kinks: set[float]) -> Array:
    """Return ln xi of the rows of a table: dense where it is singular."""
    light, heavy = np.arange(math.asinh(-MIN_LOG_LOAD), 0, -SPACING), np.arange(0, MAX_LOG_LOAD + SPACING, SPACING)
    places = np.log([kink for kink in kinks if kink > 0])[:, None]
    around = places + np.concatenate([-KINK_OFFSETS, [0.0], KINK_OFFSETS])
    rows = np.unique(np.clip(np.concatenate([-np.sinh(light), heavy, around.ravel()]), MIN_LOG_LOAD, MAX_LOG_LOAD))
    return rows[np.append(True, np.diff(rows) > KINK_OFFSETS[0] / 2)]


def _tables(step: float, waves: float) -> float:
    """Return the largest number of tables that a series needs; an infinite series needs none."""
    return min(max(waves - 2, 0), MAX_LOG_LOAD / step + LIGHT_TABLES) if math.isfinite(waves) else 0


def curve(profile: Profile, mean_pressure: ArrayLike) -> Curve:
    """Return the contact fraction of a series, over loads in p_0*; compliance and resistance are NaN.

    The elastic energy of these pressures would give both, but less accurately than Persson's theory.
    """
    p = np.asarray(mean_pressure, float)
    none = np.full(p.shape, np.nan)
    return Curve(none, none, contact_fraction=contact_fraction(p, profile.D, float(profile.gamma), profile.m))


def _step(profile: Profile) -> float:
    """Return (D - 1) ln(gamma)."""
    return (profile.D - 1) * math.log(float(profile.gamma))


def _applies(profile: Profile) -> None:
    needed = _tables(_step(profile), profile.m)
    if needed > MAX_TABLES:
        raise NotApplicableError(
            f"gamma^(D-1) = {float(profile.gamma) ** (profile.D - 1):.8g} is so close to 1 that {profile.m:g} terms "
            f"take {needed:.3g} tables of pressures, more than {MAX_TABLES}: take fewer terms, a larger gamma, or "
            'method "persson"'
        )


METHOD = Method(
    name="cascade",
    label="theory of 2000",
    summary="contact fraction alone: each wave carries all pressures of the coarser one; any m, also inf (0)",
    solve=curve,
    returns=("contact_fraction",),
    applies=_applies,
    infinite=True,
    uses_phases=False,
    stiffness=False,
    style=Style("#882255", (2.5, 1), "h"),
    seconds=lambda profile, loads, **settings: CURVE_SECONDS + 0.008 * _tables(_step(profile), profile.m),
)
