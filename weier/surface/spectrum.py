"""The Weierstrass series that stands for a measured surface: the one with its spectrum between two wavelengths.

From one wave of the series to the next the variance changes by the factor gamma^(2 (D - 2)). On a surface whose
power spectral density falls with the wavenumber k as k^-beta, beta = 5 - 2 D, it does so from one band of wavelengths
to the next, where each band is gamma times as fine as the one before.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
import scipy  # Its submodules are loaded on first use.

from weier import units
from weier.checks import checked_number, shown
from weier.kernels.arrays import Array, Flags, Indices
from weier.surface.measured.trace import DECIMAL_ROUNDING, Trace
from weier.surface.profile import Profile, checked_ratio
from weier.surface.series import amplitude
from weier.tables import html_table

WAVES_IN_LENGTH = 4  # By default, the longest waves compared fit so many times into the trace: fewer are no sample.
MIN_RATIO = 4.0  # The slope of a spectrum over less than two octaves is too uncertain.
EMPTY = 0.01  # Waves with less than this part of the power of their neighbours were removed by a filter or stylus.
AROUND = math.sqrt(2)  # This factor on either side of a wavelength gives an octave.
STEEPEST = 40.0  # The exponent is sought between -40 and 40; a series has 1 to 3.


@dataclass(frozen=True)
class Fit:
    """A Weierstrass series with the spectrum of a trace.

    Attributes
    ----------
    D, D_error : float
        Fractal dimension, and its standard error.
    gamma : Fraction
        Ratio of successive wavelengths, as given to `fit`.
    m : int
        Number of waves from lambda_0 to the shortest wavelength compared.
    lambda_0 : float
        Wavelength of the coarsest wave, in m.
    g_0, g_0_error : float
        Its amplitude, and the standard error of it, in m.
    """

    D: float
    D_error: float
    gamma: Fraction
    m: int
    lambda_0: float
    g_0: float
    g_0_error: float

    def _repr_html_(self) -> str:
        """A table with the standard errors, for notebooks."""
        rows = [
            ["fractal dimension D", f"{self.D:.6g}", f"{self.D_error:.1g}"],
            ["ratio of wavelengths gamma", str(self.gamma), "as given"],
            ["number of waves m", str(self.m), ""],
            ["wavelength lambda_0, m", f"{self.lambda_0:.6g}", ""],
            ["amplitude g_0, m", f"{self.g_0:.6g}", f"{self.g_0_error:.1g}"],
        ]
        return html_table("Weierstrass series with the spectrum of a trace", ["", "value", "standard error"], rows)

    def profile(self, phases: Any = 0.0, *, m: float | None = None, seed: int | None = None) -> Profile:
        """The series with these phases, which a spectrum does not determine; `m` gives it another number of terms."""
        return Profile(self.D, self.gamma, self.m if m is None else m, phases, seed=seed)


def fit(
    trace: Trace, longest: float | None = None, shortest: float | None = None, gamma: int | float | str | Fraction = 2
) -> Fit:
    """The Weierstrass series with the spectrum of a trace between two wavelengths.

    Parameters
    ----------
    trace : Trace
        The measured surface.
    longest, shortest : float, optional
        The wavelengths between which the spectra are compared, in m; by default a fourth of the length of the trace,
        and the shortest that the trace has. Each wave of the series stands for those within the root of gamma around
        its own, so that lambda_0 is shorter than `longest` by this root.
    gamma : int, Fraction, str or float
        Ratio of successive wavelengths. It cannot be determined from a spectrum without gaps.

    Returns
    -------
    Fit
        D and g_0 with their standard errors, lambda_0 and m.

    Raises
    ------
    ValueError
        If the wavelengths are less than two octaves or gamma apart or not in the trace, if the trace has no waves at
        an end of the band, or if its spectrum falls as that of no series, with 1 < D < 2.

    Notes
    -----
    Let P_k be the variance of wave k. Multiplied by k^beta, beta = 5 - 2 D, the spectrum is to have its centre in the
    middle of the band, where equal ratios of k count alike: sum w_k P_k k^beta (ln k - c) = 0, with the weights
    w_k = ln (k + 1/2)/(k - 1/2) and c = sum w_k ln k/sum w_k. This needs no bins, and waves at equal ratios weigh as
    much as a spectrum without gaps. g_0 gives the waves of the series the variance of the band.

    The standard errors are those of these sums for a random surface, whose waves are independent. On 20 wavelengths
    `longest` and more, D was off by at most 0.006 in the mean of 200 such surfaces, and by less than 0.01 on
    Weierstrass series, for which the standard error is far too large, since they are not random.

    Examples
    --------
    >>> import weier
    >>> series = weier.Profile(D=1.4, gamma=1.5, m=11, seed=1)
    >>> heights = 1e-6 * series.height([i / 200 for i in range(8000)])
    >>> trace = weier.Trace(heights, length=40e-3, unit="m")
    >>> found = weier.fit(trace, longest=1e-3 * 1.5**0.5, shortest=1e-3 / 1.5**10.5, gamma=1.5)
    >>> print(f"D = {found.D:.2f}, m = {found.m}, g_0 = {found.g_0:.2e} m")
    D = 1.40, m = 11, g_0 = 1.00e-06 m
    """
    if not isinstance(trace, Trace):
        raise ValueError(f"trace must be a weier.Trace, got {shown(trace)}")
    ratio = checked_ratio(gamma)
    first, m = _band(trace, longest, shortest, ratio)
    last, period = first / float(ratio) ** m, trace.lambda_0 * trace.period
    finest = min(math.floor(period / last * DECIMAL_ROUNDING), trace.waves_per_period[-1])
    every = np.arange(1, trace.waves_per_period[-1] + 1)
    variance = (trace.g_0 * trace.amplitude) ** 2 / 2  # m^2
    of_every = np.asarray(np.bincount(trace.waves_per_period, variance)[every], float)  # 0 for waves not there
    band = slice(math.ceil(period / first / DECIMAL_ROUNDING) - 1, finest)
    k, power = every[band], of_every[band]
    _check_power(k, every[_has_power(every, of_every)], period)
    beta, beta_error = _exponent(k, power)
    D, D_error = (5 - beta) / 2, beta_error / 2
    if not 1 < D < 2:
        raise ValueError(
            f"the spectrum must fall as k^-beta with beta between 1 and 3, got {beta:.3g} from {first:g} to "
            f"{last:g} m: take other wavelengths"
        )
    n = np.arange(m)
    variances = amplitude(n, D, float(ratio)) ** 2  # of the terms, over that of the first
    g_0 = math.sqrt(2 * power.sum() / variances.sum())
    by_slope = math.log(ratio) * float(n @ variances) / variances.sum() * D_error  # d(ln g_0)/dD times its error
    by_variance = math.sqrt(power @ power) / power.sum() / 2
    return Fit(D, D_error, ratio, m, first / math.sqrt(ratio), g_0, g_0 * math.hypot(by_slope, by_variance))


def _band(trace: Trace, longest: float | None, shortest: float | None, ratio: Fraction) -> tuple[float, int]:
    """The longest wavelength that is compared, in m, and the waves down to the shortest one."""
    finest = trace.lambda_0 * trace.period / trace.finest
    least = min(finest, trace.shortest)  # The second was given by the user, and is within one wave of the first.
    last = checked_number(
        "shortest",
        finest if shortest is None else shortest,
        f"be at least that of the trace, {least:.6g} m",
        lambda x: least <= x * DECIMAL_ROUNDING,
        units.METRE,
    )
    fewest = max(MIN_RATIO, float(ratio)) * last
    first = checked_number(
        "longest",
        trace.lambda_0 / WAVES_IN_LENGTH if longest is None else longest,
        f"lie between {fewest:.6g} m, {MIN_RATIO:g} and gamma times the shortest wavelength, and the length of the "
        f"trace, {trace.lambda_0:.6g} m",
        lambda x: fewest <= x * DECIMAL_ROUNDING and x <= trace.lambda_0 * DECIMAL_ROUNDING,
        units.METRE,
    )
    return first, math.floor(math.log(first / last * DECIMAL_ROUNDING) / math.log(ratio))


def _has_power(k: Indices, power: Array) -> Flags:
    """Whether each wave has the power that its neighbours suggest, and was not removed by a filter or a stylus tip.

    The mean power of an octave around a wave may fall as k^-3 from that of longer waves, and be as low as that of
    shorter ones, but not a hundredth of these.
    """
    sums = np.append(0, np.cumsum(power))
    low, high = np.searchsorted(k, k / AROUND, "left"), np.searchsorted(k, k * AROUND, "right")
    mean = (sums[high] - sums[low]) / (high - low)
    falling, rising = mean * k**3.0, mean[::-1]
    known = falling > EMPTY * np.maximum.accumulate(falling)
    return np.asarray(known & (rising > EMPTY * np.maximum.accumulate(rising))[::-1])


def _check_power(k: Indices, known: Indices, period: float) -> None:
    """Refuse a band without power at one of its ends; `known` are the waves with power, also outside the band.

    A series has gaps between its waves, so that only a gap at an end wider than all others is refused.
    """
    problem = "the spectrum must have power in the whole band, got none of waves"
    within = known[(known >= k[0]) & (known <= k[-1])]
    widest = np.diff(np.log(within)).max(initial=math.log(1 + 1 / k[0]))
    if not within.size or math.log(k[-1] / within[-1]) > widest:
        last = period / (within if within.size else known)[-1] * AROUND
        raise ValueError(f"{problem} shorter than {last:.3g} m: take shortest={last:.3g}")
    if math.log(within[0] / k[0]) > widest:
        first = period / within[0] / AROUND
        raise ValueError(f"{problem} longer than {first:.3g} m: take longest={first:.3g}")


def _exponent(k: Indices, power: Array) -> tuple[float, float]:
    """The exponent beta of a spectrum k^-beta, and its standard error."""
    weight = np.log((k + 0.5) / (k - 0.5))
    x = np.log(k)
    x = x - weight @ x / weight.sum()
    log_power = np.log(np.maximum(weight * power / power.max(), 1e-300))
    softmax = scipy.special.softmax  # w_k P_k k^beta over their sum, which may overflow
    beta = scipy.optimize.brentq(lambda beta: float(softmax(log_power + beta * x) @ x), -STEEPEST, STEEPEST)
    fraction = softmax(log_power + beta * x)
    scatter = x * (fraction - weight / weight.sum())
    return beta, math.sqrt(scatter @ scatter) / float(fraction @ x**2)
