"""Archard's approximation: each wave carries the peak pressure of the next coarser one, Eqs (15)-(21).

docs/closed_forms.md derives the formulas: "Archard", and "Flat waves" for the part shared with Demelio. Term n
carries xi_n in units of p_n*, xi_{n+1} = gamma^(1-D) f(xi_n) with f the peak pressure of (10); the paper calls it
zeta_{n-1}. Flat terms, terms in partial contact and flat terms again follow one another. Heights are in g_0,
pressures in p_0*.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from weier.kernels.arrays import Array
from weier.methods.curve import Curve
from weier.methods.flattened import Remaining, remaining
from weier.methods.method import Method, Style
from weier.surface.profile import Profile
from weier.surface.series import MAX_EXPONENT, full_contact_pressure

# terms that bring ln xi from -700 to within 0.2 of its fixed point, and of the expansion: 12 * 0.2^12/12! < 1e-16
TERMS = 12


def compliance(mean_pressure: ArrayLike, D: ArrayLike, gamma: ArrayLike, m: ArrayLike) -> Array:
    """Return compliance h = sum h_n (19), (21).

    Parameters
    ----------
    mean_pressure : array_like
        Mean pressures p > 0, in p_0*. Values that are not positive give NaN.
    D, gamma, m : array_like
        Fractal dimension in (1, 2), ratio of wavelengths > 1, number of terms (inf is the limit).
        All four broadcast.

    Returns
    -------
    ndarray
        Compliance in g_0, of the broadcast shape.
    """
    waves = remaining(mean_pressure, D, gamma, m, _fixed_point)
    return waves.with_flat_waves(_sums(waves, (waves.D - 2) * np.log(waves.gamma), 1.0))  # (19), (21)


def resistance(mean_pressure: ArrayLike, D: ArrayLike, gamma: ArrayLike, m: ArrayLike) -> Array:
    """Return specific contact resistance dh/dp by the chain rule through the recursion (2), (17).

    The arguments are those of `compliance`. Resistances are in g_0/p_0*, exactly 0 where all terms are flattened.
    """
    waves = remaining(mean_pressure, D, gamma, m, _fixed_point)
    # the derivative of ln xi halves at each term (18)
    slope = _sums(waves, (waves.D - 2) * np.log(waves.gamma) - np.log(2), 0.0) / waves.load
    return waves.behind_flat_waves(slope)


def _fixed_point(D: Array, gamma: Array) -> Array:
    """Return the fixed point of xi = gamma^(1-D) (1 + xi) (18)."""
    return 1 / np.expm1((D - 1) * np.log(gamma))


def _sums(waves: Remaining, log_ratio: Array, constant: float) -> Array:
    """Return the sums of ratio^n xi_n (constant - ln xi_n) over the waves that are not flat.

    The first terms are summed one by one, until ln xi is close to its fixed point or all waves are flat again.
    """
    shrink = 2 * full_contact_pressure(-1, waves.D, waves.gamma)
    log_shrink, ratio = np.log(2) - (waves.D - 1) * np.log(waves.gamma), np.exp(log_ratio)
    # terms until all waves are flat again, if the fixed point of ln xi is above 0
    rising = np.ceil(np.log2(MAX_EXPONENT / np.where(log_shrink > 0, log_shrink, 1.0)))
    direct = np.minimum(np.where(log_shrink > 0, rising, TERMS), waves.waves)
    xi, log_xi = np.minimum(waves.load, 1.0), np.minimum(np.log(waves.load), 0.0)
    total, weight = np.zeros(direct.shape), np.ones(direct.shape)
    for wave in range(int(direct.max(initial=0))):
        here = wave < direct
        total = np.where(here, total + weight * xi * (constant - log_xi), total)
        weight = np.where(here, weight * ratio, weight)
        xi = np.where(here, np.minimum(shrink * np.sqrt(xi), 1.0), xi)
        log_xi = np.where(here, np.minimum(log_shrink + log_xi / 2, 0.0), log_xi)
    fixed = np.minimum(2 * log_shrink, 0)
    return total + weight * _taylor_series(log_xi - fixed, fixed, waves.waves - direct, log_ratio, constant)


def _taylor_series(distance: Array, fixed: Array, terms: Array, log_ratio: Array, constant: float) -> Array:
    """Return the same sum over `terms` more terms, expanded about the fixed point of ln xi.

    docs/closed_forms.md, "Archard": `distance` is Delta y, `fixed` y_inf <= 0, `terms` k, `constant` iota.
    """
    # Order j of exp(x) (constant - x) has the coefficient exp(fixed) (constant - fixed - j)/j!, and the
    # powers of distance/2^k sum to geometric series.
    order, ratio, power, halved = np.exp(fixed), np.exp(log_ratio), np.exp(log_ratio * terms), np.exp2(-terms)
    total = order * (constant - fixed) * np.expm1(log_ratio * terms) / np.expm1(log_ratio)
    for j in range(1, TERMS):
        order, power, ratio = order * distance / j, power * halved, ratio / 2
        total = total + order * (constant - fixed - j) * (1 - power) / (1 - ratio)
    return total


def curve(profile: Profile, mean_pressure: ArrayLike) -> Curve:
    """Return both curves of a series, over loads in p_0*."""
    series = profile.D, float(profile.gamma), profile.m
    return Curve(compliance(mean_pressure, *series), resistance(mean_pressure, *series))


METHOD = Method(
    name="archard",
    label="Archard",
    summary="each wave carries the peak pressure of the coarser one (15)-(21); any m, also inf; false full contact, "
    "R = 0, above p_0* if gamma^(D-1) < 2",
    solve=curve,
    infinite=True,
    uses_phases=False,
    in_paper=True,
    style=Style("#D55E00", (5, 1.5), "v"),
)
