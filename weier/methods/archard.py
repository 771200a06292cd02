"""Archard's approximation: each wave carries the peak pressure of the next coarser one, Eqs (15)-(21).

Term n is loaded to zeta_{n-1} = mean pressure of term n / p_n*, with zeta_{-1} = p/p_0* and
zeta_n = gamma^(1-D) f(zeta_{n-1}). Three runs of terms follow one another, and two of them are sums of
amplitudes only:

- flattened terms, zeta > 1: f is affine, so their number has a closed form, and what follows is self-affine to
  the complete series;
- terms in partial contact, zeta < 1: ln zeta approaches its fixed point, the distance halving at each term;
- flattened terms again, if that fixed point lies above 0, gamma^(D-1) < 2.

f, h_n and dh_n/dzeta join smoothly at zeta = 1: a term that rounding puts into the neighbouring run costs nothing.
Heights are in g_0, pressures in p_0*.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from weier.kernels.arrays import Array, Indices
from weier.kernels.jit import kernel
from weier.methods.estimate import multiprecision_sums, solve_by
from weier.methods.flattened import Runs, add_flat_waves, over_series, scale_behind_flat_waves
from weier.methods.method import Method, Style
from weier.theory.series import full_contact_pressure

LN2 = np.log(2)
NEGLIGIBLE = 1e-20  # less than the rounding of the differences that it keeps positive
DIRECT_TERMS = 12  # bring ln zeta from -700 to within 0.2 of its fixed point
TAYLOR_TERMS = 12  # of a sum in the distance from the fixed point, 0.2 at most: 12 * 0.2^12/12! < 1e-16
MAX_MINUS_LOG = 750.0  # more than -ln of any double
CHUNK = 512  # loads at a time: five arrays of 4 kB stay next to the processor


def compliance(mean_pressure: ArrayLike, D: ArrayLike, gamma: ArrayLike, m: ArrayLike) -> Array:
    """Compliance h = sum h_n (19), (21).

    Parameters
    ----------
    mean_pressure : array_like
        Mean pressures p > 0, in p_0*. What is not a positive number gives NaN.
    D, gamma, m : array_like
        Fractal dimension in (1, 2), ratio of wavelengths > 1, number of terms (inf is the limit).
        All four broadcast.

    Returns
    -------
    ndarray
        Compliance in g_0, of the broadcast shape.
    """
    return over_series(_compliance, _fixed, mean_pressure, D, gamma, m)


def resistance(mean_pressure: ArrayLike, D: ArrayLike, gamma: ArrayLike, m: ArrayLike) -> Array:
    """Specific contact resistance dh/dp by the chain rule through the recursion (2), (17).

    The arguments are those of `compliance`. Resistances are in g_0/p_0*, exactly 0 where all terms are flattened.
    """
    return over_series(_resistance, _fixed, mean_pressure, D, gamma, m)


def _fixed(D: Array, gamma: Array) -> Array:
    """The fixed point of zeta = gamma^(1-D) (1 + zeta) (18)."""
    return 1 / np.expm1((D - 1) * np.log(gamma))


def _compliance(zeta: Array, log_zeta: Array, runs: Runs) -> Array:
    """Sum of h_n (19), (21)."""
    _sums_at_light_loads(zeta, log_zeta, _unflattened_sums(runs, (runs.D - 2) * np.log(runs.gamma), 1.0))
    return add_flat_waves(log_zeta, runs)


def _resistance(zeta: Array, log_zeta: Array, runs: Runs) -> Array:
    """Derivative of the sum of h_n with zeta: the derivative of ln zeta halves from term to term (18)."""
    _sums_at_light_loads(zeta, log_zeta, _unflattened_sums(runs, (runs.D - 2) * np.log(runs.gamma) - LN2, 0.0))
    return scale_behind_flat_waves(np.divide(log_zeta, zeta, out=log_zeta), runs)


class UnflattenedSums(NamedTuple):
    """Sums of ratio^k zeta_k (constant - ln zeta_k) over the waves that are not flat; arrays of shape (runs,).

    end : index behind the last load of the run
    shrink, log_shrink : 2 gamma^(1-D), as zeta_{k+1} = shrink sqrt(zeta_k), and its logarithm
    ratio : of successive weights
    direct : number of waves to sum directly
    rest : Taylor coefficients of the sum over all later waves, shape (runs, TAYLOR_TERMS); (runs, 0) without any
    """

    end: Indices
    shrink: Array
    log_shrink: Array
    ratio: Array
    direct: Array
    rest: Array
    constant: float


def _unflattened_sums(runs: Runs, log_ratio: Array, constant: float) -> UnflattenedSums:
    shrink, log_shrink = 2 * full_contact_pressure(-1, runs.D, runs.gamma), LN2 - (runs.D - 1) * np.log(runs.gamma)
    # Where ln zeta approaches a point above 0, all waves are flat again after so many.
    rising = np.log2(MAX_MINUS_LOG / np.maximum(log_shrink, NEGLIGIBLE))
    direct = np.minimum(np.where(log_shrink > 0, np.ceil(rising), DIRECT_TERMS), runs.left)
    later, rest = runs.left - direct, np.empty((direct.size, 0))
    if np.any(later > 0):
        rest = _taylor_coefficients(np.minimum(2 * log_shrink, 0), later, log_ratio, constant)
    return UnflattenedSums(runs.end, shrink, log_shrink, np.exp(log_ratio), direct, rest, constant)


def _taylor_coefficients(fixed: Array, terms: Array, log_ratio: Array, constant: float) -> Array:
    """Taylor coefficients of such a sum, in the distance of ln zeta from its fixed point."""
    # Order j of exp(x) (constant - x) has the coefficient exp(fixed) (constant - fixed - j)/j!, and the
    # powers of distance/2^k sum to geometric series.
    rest = np.empty((fixed.size, TAYLOR_TERMS))
    order, ratio, power, halved = np.exp(fixed), np.exp(log_ratio), np.exp(log_ratio * terms), np.exp2(-terms)
    rest[:, 0] = order * (constant - fixed) * np.expm1(log_ratio * terms) / np.expm1(log_ratio)
    for j in range(1, TAYLOR_TERMS):
        order, power, ratio = order / j, power * halved, ratio / 2
        rest[:, j] = order * (constant - fixed - j) * (1 - power) / (1 - ratio)
    return rest


@kernel
def _sums_at_light_loads(zeta: Array, log_zeta: Array, sums: UnflattenedSums) -> None:
    """The sums, in place of ln zeta, a few loads at a time."""
    start, total, z, later = 0, np.empty(CHUNK), np.empty(CHUNK), sums.rest.shape[1] > 0
    for r in range(sums.end.size):
        waves, shrink, log_shrink, ratio = int(sums.direct[r]), sums.shrink[r], sums.log_shrink[r], sums.ratio[r]
        while start < sums.end[r]:
            stop = min(start + CHUNK, sums.end[r])
            y = log_zeta[start:stop]
            _start(zeta[start:stop], y, total, z)
            weight = 1.0
            for wave in range(waves):
                _add_wave(total, z, y, weight, sums.constant)
                weight *= ratio
                if later or wave < waves - 1:
                    _hand_on(z, y, shrink, log_shrink)
            if later:
                _add_rest(total, y, z, weight, sums.rest[r], min(2 * log_shrink, 0.0))
            for i in range(y.size):
                y[i] = total[i]
            start = stop


@kernel
def _start(zeta: Array, y: Array, total: Array, z: Array) -> None:
    """What the first wave carries, and its logarithm; nothing is summed."""
    for i in range(y.size):
        total[i], z[i], y[i] = 0.0, _at_most(1.0, zeta[i]), _at_most(0.0, y[i])


@kernel
def _add_wave(total: Array, z: Array, y: Array, weight: float, constant: float) -> None:
    """Add the term of one wave."""
    for i in range(y.size):
        total[i] += weight * z[i] * (constant - y[i])


@kernel
def _at_most(limit: float, value: float) -> float:
    """The smaller of both, or NaN for NaN."""
    return limit if value > limit else value


@kernel
def _hand_on(z: Array, y: Array, shrink: float, log_shrink: float) -> None:
    """What the next wave carries, and its logarithm, in place."""
    for i in range(y.size):
        z[i], y[i] = _at_most(1.0, shrink * math.sqrt(z[i])), _at_most(0.0, log_shrink + y[i] / 2)


@kernel
def _add_rest(total: Array, y: Array, series: Array, weight: float, rest: Array, fixed: float) -> None:
    """Add the Taylor series of all later waves, at the distance of y from its fixed point."""
    for i in range(y.size):
        series[i] = rest[-1]
    for j in range(rest.size - 2, -1, -1):
        for i in range(y.size):
            series[i] = series[i] * (y[i] - fixed) + rest[j]
    for i in range(y.size):
        total[i] += weight * series[i]


METHOD = Method(
    name="archard",
    label="Archard",
    summary="each wave carries the peak pressure of the coarser one (15)-(21); any m, also inf",
    solve=solve_by(compliance, resistance),
    uses_phases=False,
    style=Style("#D55E00", (5, 1.5), "v"),
    reference=multiprecision_sums("archard"),
)
