"""Persson's theory in one dimension: the pressure diffuses as finer waves are added.

docs/persson.md derives the formulas. With s_n^2 = sum of p_k*^2 over k <= n,

    R = 1/(2 sqrt(pi) p) sum_n w_n exp(-p^2/s_n^2),    h = sum_n g_n - 1/(4 sqrt(pi)) sum_n w_n E_1(p^2/s_n^2),

where w_n = g_n p_n*/s_n, and the contact fraction is erf(p/s_{m-1}). Terms with p^2/s_n^2 > MAX_EXPONENT underflow.
From some term N on, gamma^(-2(D-1)N) and p^2/s_N^2 are below rounding and s_n is proportional to p_n*, so that the
rest are geometric sums. Heights are in g_0, pressures in p_0*.
"""

from __future__ import annotations

import math
import sys
from typing import NamedTuple

import numpy as np
import scipy  # Its submodules are loaded on first use.
from numpy.typing import ArrayLike

from weier.kernels.arrays import Array
from weier.methods.curve import Curve
from weier.methods.errors import NotApplicableError
from weier.methods.method import Method, Style
from weier.surface.profile import Profile
from weier.surface.series import MAX_EXPONENT, MAX_TERMS, leading_amplitude

NEGLIGIBLE = -math.log(sys.float_info.epsilon)  # exp of its negative is below rounding
MAX_VALUES = 2**20  # loads times terms in one array: 8 MB


class Rates(NamedTuple):
    """Rates of the series: p_n*^2 grows as exp(growth n), and g_n decays as exp(-decay n)."""

    growth: float
    decay: float

    @classmethod
    def from_series(cls, D: float, gamma: float) -> Rates:
        """Return the rates of a series."""
        return cls(2 * (D - 1) * math.log(gamma), (2 - D) * math.log(gamma))

    @property
    def terms(self) -> float:
        """Upper bound on the number of terms between underflow and the geometric sums."""
        saturation = math.log(MAX_EXPONENT) + NEGLIGIBLE - min(math.log(math.expm1(self.growth)), 0)
        return min(saturation / self.growth, (MAX_EXPONENT + NEGLIGIBLE) / self.decay) + 2

    def terms_of(self, m: float) -> float:
        """Return an upper bound on the number of terms summed one by one."""
        return min(self.terms + 1 / self.decay, m)


def compliance(mean_pressure: ArrayLike, D: float, gamma: float, m: float) -> Array:
    """Return the compliance h.

    Parameters
    ----------
    mean_pressure : array_like
        Mean pressures p > 0, in p_0*.
    D, gamma, m : float
        Fractal dimension in (1, 2), ratio of wavelengths > 1, number of terms (inf is the limit).

    Returns
    -------
    ndarray
        Compliance in g_0, of the shape of `mean_pressure`. It tends to minus infinity as ln p at light loads.
    """
    return _solve_series(mean_pressure, D, gamma, m)[0]


def resistance(mean_pressure: ArrayLike, D: float, gamma: float, m: float) -> Array:
    """Return the specific contact resistance dh/dp, in g_0/p_0*; the arguments are those of `compliance`."""
    return _solve_series(mean_pressure, D, gamma, m)[1]


def contact_fraction(mean_pressure: ArrayLike, D: float, gamma: float, m: float) -> Array:
    """Return the contact area over the nominal area, 0 for m = inf; the arguments are those of `compliance`."""
    p = np.asarray(mean_pressure, float)
    if math.isinf(m):
        return np.zeros(p.shape)
    log_x, _ = _exponents_and_weights(p, np.asarray(m - 1.0), Rates.from_series(D, gamma))
    return np.asarray(scipy.special.erf(np.exp(log_x / 2)))


def _solve_series(mean_pressure: ArrayLike, D: float, gamma: float, m: float) -> tuple[Array, Array]:
    """Return compliance and resistance."""
    p, rates = np.asarray(mean_pressure, float), Rates.from_series(D, gamma)
    pieces = np.array_split(p.ravel(), max(1, math.ceil(p.size * rates.terms_of(m) / MAX_VALUES)))
    heights, slopes = zip(*(_sums(piece, m, rates) for piece in pieces), strict=True)
    h = leading_amplitude(m, D, gamma) - np.concatenate(heights) / (4 * math.sqrt(math.pi))
    R = np.concatenate(slopes) / (2 * math.sqrt(math.pi) * p.ravel())
    return h.reshape(p.shape), R.reshape(p.shape)


def _sums(p: Array, m: float, rates: Rates) -> tuple[Array, Array]:
    """Return the sums of w_n E_1(x_n) and w_n exp(-x_n), x_n = p^2/s_n^2, for loads of shape (loads,)."""
    log_load = 2 * np.log(p)
    # s_n^2 = expm1(growth (n + 1))/expm1(growth) reaches p^2/MAX_EXPONENT at this term.
    reached = np.logaddexp(0, log_load - math.log(MAX_EXPONENT) + math.log(math.expm1(rates.growth)))
    first = np.minimum(np.maximum(np.floor(reached / rates.growth) - 1, 0), m)
    saturated = np.ceil((np.maximum(log_load, 0) + NEGLIGIBLE) / rates.growth)
    last = np.minimum(np.clip(saturated, first, first + math.ceil(rates.terms)), m)
    # The geometric sums of fewer terms than 1/decay would cancel.
    last = np.where(rates.decay * (m - last) < 1, m, last)
    terms = np.arange(int((last - first).max(initial=0)))
    n = first[:, None] + terms
    log_x, weight = _exponents_and_weights(p[:, None], n, rates)
    weight, log_x = np.where(n < last[:, None], weight, 0.0), np.minimum(log_x, math.log(MAX_EXPONENT))
    height, slope = (weight * _integral(log_x)).sum(axis=1), (weight * np.exp(-np.exp(log_x))).sum(axis=1)
    more_height, more_slope = _geometric_sums(p, last, m, rates)
    return height + more_height, slope + more_slope


def _exponents_and_weights(p: Array, n: Array, rates: Rates) -> tuple[Array, Array]:
    """Return ln x_n and w_n."""
    spread = np.expm1(-rates.growth * (n + 1)) / math.expm1(-rates.growth)  # (s_n/p_n*)^2
    return 2 * np.log(p) - rates.growth * n - np.log(spread), np.exp(-rates.decay * n) / np.sqrt(spread)


def _integral(log_x: Array) -> Array:
    """Return E_1(x), also where x underflows."""
    small = log_x < -NEGLIGIBLE  # there E_1(x) = -ln x - 0.577... to rounding
    return np.where(small, -log_x - np.euler_gamma, scipy.special.exp1(np.exp(np.where(small, 0.0, log_x))))


def _geometric_sums(p: Array, n: Array, m: float, rates: Rates) -> tuple[Array, Array]:
    """Return the sums of `_sums` over the terms from n to m, where exp(-x) = 1 and E_1(x) = -ln x - 0.577..."""
    n = np.where(n < m, n, 0)
    terms = np.where(n > 0, m - n, 0)
    log_x, weight = _exponents_and_weights(p, n, rates)
    fall, rest = math.exp(-rates.decay), -math.expm1(-rates.decay)
    zeroth = -np.expm1(-rates.decay * terms) / rest  # sum of fall^k
    finite = np.minimum(terms, MAX_TERMS)
    first = (fall * zeroth - finite * np.exp(-rates.decay * terms)) / rest  # sum of k fall^k
    return weight * ((-log_x - np.euler_gamma) * zeroth + rates.growth * first), weight * zeroth


def curve(profile: Profile, mean_pressure: ArrayLike) -> Curve:
    """Return both curves and the contact fraction of a series, over loads in p_0*."""
    series = profile.D, float(profile.gamma), profile.m
    h, R = _solve_series(mean_pressure, *series)
    return Curve(h, R, contact_fraction=contact_fraction(mean_pressure, *series))


def _applies(profile: Profile) -> None:
    terms = Rates.from_series(profile.D, float(profile.gamma)).terms
    if math.isinf(profile.m) and terms > MAX_TERMS:
        raise NotApplicableError(
            f"gamma = {float(profile.gamma):.8g} is so close to 1 that Persson's sums take {terms:.1e} terms, more "
            f"than {MAX_TERMS}: take a larger gamma, or a finite m"
        )


METHOD = Method(
    name="persson",
    label="Persson",
    summary="the pressure diffuses as finer waves are added; any m, also inf, not for light loads",
    solve=curve,
    returns=("contact_fraction",),
    applies=_applies,
    infinite=True,
    uses_phases=False,
    style=Style("#E69F00", (8, 1.5, 1, 1.5), "p"),
)
