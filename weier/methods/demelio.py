"""Demelio's approximation: every wave carries the mean pressure, Eqs (23)-(26).

docs/closed_forms.md derives the formulas: "Demelio", and "Flat waves" for the part shared with Archard. Heights are
in g_0, pressures in p_0*.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from weier.kernels.arrays import Array
from weier.methods.curve import Curve
from weier.methods.flattened import remaining
from weier.methods.method import Method, Style
from weier.surface.profile import Profile


def compliance(mean_pressure: ArrayLike, D: ArrayLike, gamma: ArrayLike, m: ArrayLike) -> Array:
    """Return compliance h = sum h_n (24)-(26), continued beyond p_0* and to a finite number of terms.

    Arguments and shape are as in `weier.methods.archard.compliance`. Compliances are in g_0.
    """
    waves = remaining(mean_pressure, D, gamma, m)
    zeroth, first = _moments(waves.gamma, waves.waves)
    xi, step = np.minimum(waves.load, 1.0), (waves.D - 1) * np.log(waves.gamma)
    return waves.with_flat_waves(xi * (zeroth * (1 - np.log(xi)) + step * first))


def resistance(mean_pressure: ArrayLike, D: ArrayLike, gamma: ArrayLike, m: ArrayLike) -> Array:
    """Return specific contact resistance dh/dp: flattened terms do not contribute (2), (26).

    The arguments are those of `compliance`. Resistances are in g_0/p_0*, exactly 0 where all terms are flattened.
    """
    waves = remaining(mean_pressure, D, gamma, m)
    zeroth, first = _moments(waves.gamma, waves.waves)
    step = (waves.D - 1) * np.log(waves.gamma)
    return waves.behind_flat_waves(step * first - zeroth * np.log(np.minimum(waves.load, 1.0)))


def _moments(gamma: Array, m: Array) -> tuple[Array, Array]:
    """Return the sums S_0 and S_1 over m terms, of gamma^-n and of n gamma^-n."""
    # sum n r^n = [sum of r^n over m - 1 terms - (m - 1) r^(m-1)] r/(1 - r), r = 1/gamma
    fewer = np.maximum(m - 1, 0)
    last = fewer * np.exp(-np.log(gamma) * fewer)  # powers that underflow take ten times as long
    return _geometric(gamma, m), (_geometric(gamma, fewer) - last) / (gamma - 1)


def _geometric(gamma: Array, m: Array) -> Array:
    """Return the sum of gamma^-n over m terms."""
    return -np.expm1(-np.log(gamma) * m) * gamma / (gamma - 1)


def curve(profile: Profile, mean_pressure: ArrayLike) -> Curve:
    """Return both curves of a series, over loads in p_0*."""
    series = profile.D, float(profile.gamma), profile.m
    return Curve(compliance(mean_pressure, *series), resistance(mean_pressure, *series))


METHOD = Method(
    name="demelio",
    label="Demelio",
    summary="each wave carries the mean pressure (23)-(26); any m, also inf",
    solve=curve,
    infinite=True,
    uses_phases=False,
    in_paper=True,
    style=Style("#0072B2", (6, 1.5, 1, 1.5), "^"),
)
