"""Closed forms in 50 digits, summed term by term from the same doubles as the methods.

docs/closed_forms.md has the sums: "One wave", "Archard" and "Demelio". They share no code with the methods.
An infinite series is summed until the remainder is geometric or negligible. Each function returns compliance, in g_0,
and resistance, in g_0/p_0*.
"""

from __future__ import annotations

from typing import Any

import mpmath as mp

DIGITS = 50  # leaves far more than 16 digits after cancellation
Pair = tuple[Any, Any]


def westergaard(p: float, *series: float) -> Pair:
    """Return one wave (12)-(14)."""
    with mp.workdps(DIGITS):
        return _compliance(mp.mpf(p)), _resistance(mp.mpf(p))


def archard(p: float, D: float, gamma: float, m: float) -> Pair:
    """Sum the series with each wave under the peak pressure of the coarser one (15)-(21)."""
    with mp.workdps(DIGITS):
        down, falls = _ratios(D, gamma)
        xi, slope, g = mp.mpf(p), mp.mpf(1), mp.mpf(1)  # xi_n, its derivative with p, g_n
        h = R = mp.mpf(0)
        n, before = 0, mp.inf
        while n < m:
            if m == mp.inf and ((xi >= 1 and 2 * down >= 1) or abs(xi / before - 1) < mp.mpf(10) ** -DIGITS):
                return h + g * _compliance(xi) / (1 - falls), R  # The slope is below the last digit.
            h, R = h + g * _compliance(xi), R + g * slope * _resistance(xi)
            before, n, g = xi, n + 1, g * falls
            if xi >= 1:
                xi, slope = down * (1 + xi), down * slope
            else:
                xi, slope = 2 * down * mp.sqrt(xi), down * slope / mp.sqrt(xi)
        return h, R


def demelio(p: float, D: float, gamma: float, m: float) -> Pair:
    """Sum the series with each wave under the mean pressure (23)-(26)."""
    with mp.workdps(DIGITS):
        if m == mp.inf:
            return _infinite_demelio(mp.mpf(p), mp.mpf(D), mp.mpf(gamma))
        down, falls = _ratios(D, gamma)
        xi, g, weight = mp.mpf(p), mp.mpf(1), mp.mpf(1)
        h = R = mp.mpf(0)
        for _ in range(int(m)):
            h, R = h + g * _compliance(xi), R + weight * _resistance(xi)
            xi, g, weight = xi * down, g * falls, weight / mp.mpf(gamma)
        return h, R


def _infinite_demelio(p: Any, D: Any, gamma: Any) -> Pair:
    """Sum all flattened terms, then n r^n = r/(1 - r)^2 with r = 1/gamma over all others (26)."""
    flat = max(mp.ceil(mp.log(p) / ((D - 1) * mp.log(gamma))), 0)
    g, xi, r = gamma ** ((D - 2) * flat), p * gamma ** ((1 - D) * flat), 1 / gamma
    logarithms = -mp.log(xi) / (1 - r) + (D - 1) * mp.log(gamma) * r / (1 - r) ** 2  # tail of sum -r^n ln xi_n
    h = (1 - g) / (1 - gamma ** (D - 2)) + g * xi * (1 / (1 - r) + logarithms)
    return h, gamma**-flat * logarithms


def _ratios(D: float, gamma: float) -> Pair:
    """Return p_n*/p_{n+1}* and g_{n+1}/g_n."""
    return mp.mpf(gamma) ** (1 - mp.mpf(D)), mp.mpf(gamma) ** (mp.mpf(D) - 2)


def _compliance(xi: Any) -> Any:
    return xi * (1 - mp.log(xi)) if xi < 1 else mp.mpf(1)


def _resistance(xi: Any) -> Any:
    return -mp.log(xi) if xi < 1 else mp.mpf(0)
