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

import numpy as np
from numpy.typing import ArrayLike, NDArray

from weier.profile import amplitude, full_contact_pressure, leading_amplitude

Array = NDArray[np.float64]

LN2 = np.log(2)
ENDLESS = 1e300  # for m = inf: no sum of doubles can tell them apart, and ENDLESS - ENDLESS = 0
UNSEEN = 1e-20  # less than the rounding of the differences that it keeps positive
DIRECT_TERMS = 12  # bring ln zeta from -700 to within 0.2 of its fixed point,
TAYLOR_TERMS = 12  # where the series in the distance ends: 12 * 0.2^12/12! < 1e-16


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
    p, D, gamma, m = _arguments(mean_pressure, D, gamma, m)
    h = np.asarray(_light_compliance(p, D, gamma, m))
    heavy = np.broadcast_to(p > 1, h.shape)
    if np.any(heavy):
        p, D, gamma, m = (each[heavy] for each in np.broadcast_arrays(p, D, gamma, m))
        before, zeta = _flattened(p, D, gamma, m)
        scaled = amplitude(before, D, gamma) * _light_compliance(zeta, D, gamma, m - before)
        h[heavy] = leading_amplitude(before, D, gamma) + scaled
    return h


def resistance(mean_pressure: ArrayLike, D: ArrayLike, gamma: ArrayLike, m: ArrayLike) -> Array:
    """Specific contact resistance dh/dp by the chain rule through the recursion (2), (17).

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
        Resistance in g_0/p_0*, of the broadcast shape; exactly 0 where all terms are flattened.
    """
    p, D, gamma, m = _arguments(mean_pressure, D, gamma, m)
    R = np.asarray(_light_resistance(p, D, gamma, m))
    heavy = np.broadcast_to(p > 1, R.shape)
    if np.any(heavy):
        p, D, gamma, m = (each[heavy] for each in np.broadcast_arrays(p, D, gamma, m))
        before, zeta = _flattened(p, D, gamma, m)
        R[heavy] = gamma**-before * _light_resistance(zeta, D, gamma, m - before)  # g_n/p_n* = gamma^-n
    return R


def _arguments(mean_pressure: ArrayLike, D: ArrayLike, gamma: ArrayLike, m: ArrayLike) -> tuple[Array, ...]:
    p = np.asarray(mean_pressure, float)
    return np.where(p > 0, p, np.nan), np.asarray(D, float), np.asarray(gamma, float), np.minimum(m, ENDLESS)


def _flattened(p: Array, D: Array, gamma: Array, m: Array) -> tuple[Array, Array]:
    """Number of flattened terms from the first on, for p > 1, and zeta of the next (18)."""
    # zeta - fixed falls by gamma^(1-D) at each term; it never reaches 1 where fixed >= 1.
    c = (D - 1) * np.log(gamma)
    fixed = 1 / np.expm1(c)
    ratio = np.log(np.maximum(p - fixed, UNSEEN)) - np.log(np.maximum(1 - fixed, UNSEEN))
    number = np.minimum(np.where(c > LN2, np.ceil(ratio / c), ENDLESS), m)
    inside = np.where(number < m, number, 0)
    return number, fixed + (p - fixed) * full_contact_pressure(-inside, D, gamma)


def _light_compliance(zeta: Array, D: Array, gamma: Array, m: Array) -> Array:
    """Sum of h_n (19), (21) for zeta_{-1} <= 1."""
    return _series(zeta, D, gamma, m, (D - 2) * np.log(gamma), 1)


def _light_resistance(zeta: Array, D: Array, gamma: Array, m: Array) -> Array:
    """Its derivative with zeta: that of ln zeta halves from term to term (18)."""
    return _series(zeta, D, gamma, m, (D - 2) * np.log(gamma) - LN2, 0) / np.minimum(zeta, 1) + 0.0


def _series(zeta: Array, D: Array, gamma: Array, m: Array, log_ratio: Array, constant: int) -> Array:
    """Sum over m terms of ratio^k zeta_k (constant - ln zeta_k); a flattened term counts as zeta = 1."""
    shrink, log_shrink = 2 * full_contact_pressure(-1, D, gamma), LN2 - (D - 1) * np.log(gamma)
    ratio = np.exp(log_ratio)
    weight = np.where(m > 0, np.ones_like(ratio), 0)
    zeta, log_zeta = np.minimum(zeta, 1), np.minimum(np.log(zeta), 0)
    total = np.asarray(weight * (zeta * (constant - log_zeta)))
    for k in range(1, DIRECT_TERMS):
        if not np.any(k < m):
            return total
        zeta = np.minimum(shrink * np.sqrt(zeta), 1)
        log_zeta = np.minimum(log_shrink + log_zeta / 2, 0)
        weight = np.where(k < m, weight * ratio, 0)
        total = total + weight * (zeta * (constant - log_zeta))
    log_zeta, weight = np.minimum(log_shrink + log_zeta / 2, 0), weight * ratio
    return np.asarray(total + weight * _rest(log_zeta, log_shrink, m - DIRECT_TERMS, log_ratio, constant))


def _rest(log_zeta: Array, log_shrink: Array, m: Array, log_ratio: Array, constant: int) -> Array:
    """The same sum from here on: partial contact near the fixed point of ln zeta, then flattened terms."""
    partial = m = np.maximum(m, 0)
    fixed = 2 * log_shrink
    if np.any(fixed > 0):
        rising = np.ceil(np.log2(1 - log_zeta / np.maximum(fixed, UNSEEN)))
        partial = np.where(fixed > 0, np.minimum(rising, m), m)
    flat = np.exp(log_ratio * partial) * np.expm1(log_ratio * (m - partial)) / np.expm1(log_ratio)
    return _settled(log_zeta - fixed, fixed, partial, log_ratio, constant) + constant * flat


def _settled(distance: Array, fixed: Array, terms: Array, log_ratio: Array, constant: int) -> Array:
    """The same sum as a Taylor series in the distance of ln zeta from its fixed point."""
    # Order j of exp(x) (constant - x) has the coefficient exp(fixed) (constant - fixed - j)/j!, and the
    # powers of distance/2^k sum to geometric series.
    order, ratio = np.exp(fixed), np.exp(log_ratio)
    power, halved = np.exp(log_ratio * terms), np.exp2(-terms)
    total = order * (constant - fixed) * np.expm1(log_ratio * terms) / np.expm1(log_ratio)
    for j in range(1, TAYLOR_TERMS):
        order, power, ratio = order * distance / j, power * halved, ratio / 2
        total = total + order * (constant - fixed - j) * (1 - power) / (1 - ratio)
    return np.asarray(total)
