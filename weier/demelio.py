"""Demelio's approximation: every wave carries the same mean pressure, Eqs (23)-(26).

The N + 1 terms with p_n* < p are flattened; the others are self-affine to the complete series and sum to (26),
scaled by g_{N+1} and p_{N+1}*. Heights are in g_0, pressures in p_0*.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from weier.profile import amplitude, full_contact_pressure, leading_amplitude

Array = NDArray[np.float64]

ENDLESS = 1e300  # for m = inf: no sum of doubles can tell them apart, and ENDLESS exp(-ENDLESS) = 0


def compliance(mean_pressure: ArrayLike, D: ArrayLike, gamma: ArrayLike, m: ArrayLike) -> Array:
    """Compliance h = sum h_n (24)-(26), continued beyond p_0* and to a finite number of terms.

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
        before, xi = _flattened(p, D, gamma, m)
        scaled = amplitude(before, D, gamma) * _light_compliance(xi, D, gamma, m - before)
        h[heavy] = leading_amplitude(before, D, gamma) + scaled
    return h


def resistance(mean_pressure: ArrayLike, D: ArrayLike, gamma: ArrayLike, m: ArrayLike) -> Array:
    """Specific contact resistance dh/dp: flattened terms do not contribute (2), (26).

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
        before, xi = _flattened(p, D, gamma, m)
        R[heavy] = gamma**-before * _light_resistance(xi, D, gamma, m - before)  # g_n/p_n* = gamma^-n
    return R


def _arguments(mean_pressure: ArrayLike, D: ArrayLike, gamma: ArrayLike, m: ArrayLike) -> tuple[Array, ...]:
    p = np.asarray(mean_pressure, float)
    return np.where(p > 0, p, np.nan), np.asarray(D, float), np.asarray(gamma, float), np.minimum(m, ENDLESS)


def _flattened(p: Array, D: Array, gamma: Array, m: Array) -> tuple[Array, Array]:
    """Number of flattened terms, N + 1 or all m of them, and p/p_n* of the next, for p > 1."""
    number = np.minimum(np.ceil(np.log(p) / ((D - 1) * np.log(gamma))), m)
    return number, p * full_contact_pressure(-number, D, gamma)


def _light_compliance(xi: Array, D: Array, gamma: Array, m: Array) -> Array:
    """(26) for m terms."""
    zeroth, first = _moments(gamma, m)
    xi = np.minimum(xi, 1)
    return np.asarray(xi * ((1 - np.log(xi)) * zeroth + (D - 1) * np.log(gamma) * first))


def _light_resistance(xi: Array, D: Array, gamma: Array, m: Array) -> Array:
    """Its derivative with xi."""
    zeroth, first = _moments(gamma, m)
    return np.asarray((D - 1) * np.log(gamma) * first - np.minimum(np.log(xi), 0) * zeroth)


def _moments(gamma: Array, m: Array) -> tuple[Array, Array]:
    """Sums of gamma^-k and of k gamma^-k over m terms."""
    # sum k r^k = [sum of r^k over the m - 1 last but one - (m - 1) r^(m-1)] r/(1 - r), r = 1/gamma
    fewer = np.maximum(m - 1, 0)
    return _geometric(gamma, m), (_geometric(gamma, fewer) - fewer * gamma**-fewer) / (gamma - 1)


def _geometric(gamma: Array, m: Array) -> Array:
    """Sum of gamma^-k over m terms."""
    return -np.expm1(-np.log(gamma) * m) * gamma / (gamma - 1)
