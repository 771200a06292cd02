"""Terms of the Weierstrass series in closed form: amplitudes, full-contact pressures and their sums.

docs/closed_forms.md: "Flat waves", and "Bounds on the terms left out" for the tail. Heights are in g_0, pressures in
p_0* = 2 pi M g_0/lambda_0.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from weier.checks import checked_number
from weier.kernels.arrays import Array

INFINITE = ("inf", ".inf", "infinity")  # spellings of Python and YAML
MAX_TERMS = 10**6  # terms of a finite series, whose amplitudes are stored in an array
MAX_EXPONENT = 750.0  # above -ln of any double, so that exp(-750) underflows


def amplitude(n: ArrayLike, D: ArrayLike, gamma: ArrayLike) -> Array:
    """Return amplitude g_n = gamma^((D-2) n) of term n, in g_0 (20). Broadcasts."""
    return _power(gamma, np.asarray(D, float) - 2, n)


def full_contact_pressure(n: ArrayLike, D: ArrayLike, gamma: ArrayLike) -> Array:
    """Return mean pressure p_n* = gamma^((D-1) n) that flattens term n alone, in p_0* (16). Broadcasts."""
    return _power(gamma, np.asarray(D, float) - 1, n)


def leading_amplitude(m: ArrayLike, D: ArrayLike, gamma: ArrayLike) -> Array:
    """Sum of the amplitudes of the first m terms, in g_0 (22). Broadcasts; m = inf has its limit."""
    exponent = (np.asarray(D, float) - 2) * np.log(np.asarray(gamma, float))
    return np.asarray(np.expm1(exponent * np.asarray(m, float)) / np.expm1(exponent))


def tail_amplitude(m: ArrayLike, D: ArrayLike, gamma: ArrayLike) -> Array:
    """Sum G_m of the amplitudes of all terms n >= m, in g_0 (22), (27). Broadcasts; 0 for m = inf."""
    exponent = (np.asarray(D, float) - 2) * np.log(np.asarray(gamma, float))
    return np.exp(exponent * np.asarray(m, float)) / -np.expm1(exponent)


def checked_dimension(D: float) -> float:
    """Return D as a float; ValueError unless it is a fractal dimension of a profile."""
    return checked_number("D", D, "lie in (1, 2)", lambda D: 1 < D < 2)


def checked_terms(m: float | str) -> float:
    """Return the number of terms m; ValueError unless it is a positive integer or inf, also as a word."""
    condition = f"be a whole number of terms, from 1 to {MAX_TERMS}, or inf"
    if isinstance(m, str) and m.strip().casefold() in INFINITE:
        return math.inf
    terms = checked_number("m", m, condition, lambda m: m == math.inf or (1 <= m <= MAX_TERMS and m == m // 1))
    return terms if math.isinf(terms) else int(terms)


def _power(gamma: ArrayLike, exponent: Array, n: ArrayLike) -> Array:
    """Return gamma^(exponent n) to the last digits."""
    # rounding of exponent * n would cost up to 700 ulp; the leading 29 bits of the exponent times n < 2^24 are exact
    n, gamma, leading = np.asarray(n, float), np.asarray(gamma, float), np.trunc(exponent * 2.0**29) / 2.0**29
    return np.asarray(np.power(gamma, leading * n, dtype=float) * np.exp((exponent - leading) * n * np.log(gamma)))
