"""Fit of the Weierstrass series to the spectrum of a measured surface between two wavelengths.

From one term to the next the variance changes by the factor gamma^(2 (D - 2)). On a surface whose power spectral
density falls with the wavenumber k as k^-beta, beta = 5 - 2 D, the same holds for bands of wavelengths with the ratio
gamma.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
import scipy  # Its submodules are loaded on first use.

from weier import units
from weier.checks import checked_number, shown
from weier.kernels.arrays import Array, Flags, Indices
from weier.surface.measured.trace import DECIMAL_ROUNDING, MIRRORED, PERIODIC, TAPER, TAPERED, Trace
from weier.surface.profile import Profile, checked_ratio
from weier.surface.series import amplitude

PARTS = 20  # parts of a line, each omitted from the spectrum in turn
# standard errors of D or ln g_0 without a part from the median over the parts, from which that part dominates the
# fit: 5 of 1928 random lines of 200 to 4000 heights had one (`python -m weier.accuracy artefacts --rounds 150`)
DOMINANT = 2.0
# The next three were measured by the same command.
# default length of the trace over the longest wavelength: within one and two errors are 0.68 and 0.96 of the lines of
# five octaves; with a length of one wavelength 0.76 and 0.97
WAVES_IN_LENGTH = 4
MIN_RATIO = 4.0  # of the wavelengths: on two octaves 0.68 of the lines have a D between 1 and 2, on one 0.33
# power over that of the neighbours below which a wave was removed by a filter or stylus: none of 360 whole spectra is
# refused, nor at three times as much; at ten times three are
EMPTY = 0.01
AROUND = math.sqrt(2)  # half an octave on either side
# fraction of the variance kept by the extension: sin^2 tapers of length a at both ends keep 1 - 5 a/4
KEPT_VARIANCE = {MIRRORED: 1.0, PERIODIC: 1.0, TAPERED: 1 - 5 * TAPER / 4}
# Variance of P_k over its square on a random surface: P_k is the sum of two squares of normal numbers in a
# periodic trace, and one square in a mirrored one. A taper correlates neighbours, which raises the variance of sums
# by the mean of the fourth power of the window, 1 - 93 a/64, over the square of the mean of its second power.
SCATTER = {MIRRORED: 2.0, PERIODIC: 1.0, TAPERED: (1 - 93 * TAPER / 64) / KEPT_VARIANCE[TAPERED] ** 2}
STEEPEST = 40.0  # bracket of the exponent; a series has 1 to 3


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
    source : str
        Name of the trace.
    """

    D: float
    D_error: float
    gamma: Fraction
    m: int
    lambda_0: float
    g_0: float
    g_0_error: float
    source: str = ""

    def profile(self, phases: Any = 0.0, *, m: float | None = None, seed: int | None = None) -> Profile:
        """Return the series with these phases, which a spectrum does not determine; `m` overrides its length."""
        return Profile(self.D, self.gamma, self.m if m is None else m, phases, seed=seed)


def fit(
    trace: Trace | Sequence[Trace],
    longest: float | None = None,
    shortest: float | None = None,
    gamma: int | float | str | Fraction = 2,
) -> Any:
    """Fit the Weierstrass series to the spectrum of a trace between two wavelengths.

    Parameters
    ----------
    trace : Trace or sequence of Trace
        The measured surface, or several lines of it.
    longest, shortest : float, optional
        Band of wavelengths, in m; by default from a quarter of the length of the trace to its shortest wavelength.
        Each term represents a band from gamma^(-1/2) to gamma^(1/2) times its wavelength, so that lambda_0 is
        `longest`/gamma^(1/2).
    gamma : int, Fraction, str or float
        Ratio of successive wavelengths, which a continuous spectrum does not determine.

    Returns
    -------
    Fit or tuple of Fit
        D and g_0 with standard errors, lambda_0 and m; for a list of traces, one for each.

    Raises
    ------
    ValueError
        If the band is narrower than two octaves or gamma, or not in the trace, if the trace has no waves at an end of
        the band, or if the slope of its spectrum gives no D with 1 < D < 2.

    Warns
    -----
    UserWarning
        If a twentieth of the line dominates D or g_0, for example a scratch.

    Notes
    -----
    Let P_k be the variance of wave k. D is such that the spectrum multiplied by k^beta, beta = 5 - 2 D, is centred in
    the band, with uniform weights over ln k: sum w_k P_k k^beta (ln k - c) = 0, with w_k = ln (k + 1/2)/(k - 1/2) and
    c = sum w_k ln k/sum w_k. No bins are needed. g_0 gives the series the variance of the band.

    Standard errors are those of a random surface with the fitted spectrum and independent waves, from the derivatives
    of D and ln g_0 with respect to ln P_k and their correlation. The bias is removed to second order. On the default
    band, errors cover the true values as those of a normal distribution (docs/measured.rst). Weierstrass series are
    not random; on lengths of 20 `longest` and more the fit finds their D within 0.01.

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
    if isinstance(trace, list | tuple) and trace:
        return tuple(_fit_of_many(one, longest, shortest, gamma) for one in trace)
    if not isinstance(trace, Trace):
        raise ValueError(f"trace must be a weier.Trace, or a list of some, got {shown(trace)}")
    ratio = checked_ratio(gamma)
    first, m = _band(trace, longest, shortest, ratio)
    last, period = first / float(ratio) ** m, trace.lambda_0 * trace.period
    finest = min(math.floor(period / last * DECIMAL_ROUNDING), trace.waves_per_period[-1])
    every = np.arange(1, trace.waves_per_period[-1] + 1)
    variance = (trace.g_0 * trace.amplitude) ** 2 / 2  # m^2
    variance_of_wave = np.asarray(
        np.bincount(trace.waves_per_period, variance)[every], float
    )  # 0 for waves not there
    band = slice(math.ceil(period / first / DECIMAL_ROUNDING) - 1, finest)
    k, power = every[band], variance_of_wave[band]
    _check_power(k, every[_has_power(every, variance_of_wave)], period)
    beta, scatter = _exponent(k, power), SCATTER[trace.ends]
    D_influence, bias = _influence_on_D(k, beta, scatter)
    D, D_error = (5 - beta) / 2 - bias, math.sqrt(scatter * D_influence @ D_influence)
    n = np.arange(m)
    variances = amplitude(n, D, float(ratio)) ** 2  # of the terms, over that of the first
    part = variances / variances.sum()
    P_share = (k / k[0]) ** -beta / ((k / k[0]) ** -beta).sum()
    slope = math.log(ratio) * float(n @ part)  # of ln g_0 by D, with the opposite sign, at a given variance
    curvature = math.log(ratio) ** 2 * float(n**2 @ part - (n @ part) ** 2)
    g_0_influence = P_share / 2 - slope * D_influence
    error = math.sqrt(scatter * g_0_influence @ g_0_influence)
    bias = -scatter * P_share @ P_share / 4 - curvature * D_error**2
    g_0 = math.sqrt(2 * power.sum() / (KEPT_VARIANCE[trace.ends] * variances.sum())) * math.exp(-bias)
    values = (ratio, m), (D, D_error), (g_0, error)
    artefact = _artefact(trace, k, *values)
    if not 1 < D < 2:
        artefact = artefact or _artefact(trace, k, *values, width=2)
        raise ValueError(
            f"the spectrum must fall as k^-beta with beta between 1 and 3, got {5 - 2 * D:.3g} from {first:g} to "
            f"{last:g} m: {artefact or 'take other wavelengths'}"
        )
    if artefact:
        warnings.warn(artefact, stacklevel=2)
    return Fit(D, D_error, ratio, m, first / math.sqrt(ratio), g_0, g_0 * error, trace.source)


def _fit_of_many(trace: Trace, *arguments: Any) -> Any:
    """Return the fit of one of several traces, which is named if it is refused."""
    try:
        return fit(trace, *arguments)
    except ValueError as error:
        raise ValueError(f"trace {trace.source}: {error}" if getattr(trace, "source", "") else str(error)) from None


def _band(trace: Trace, longest: float | None, shortest: float | None, ratio: Fraction) -> tuple[float, int]:
    """Return the longest wavelength that is compared, in m, and the waves down to the shortest one."""
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
    """Return whether each wave has the power suggested by its neighbours: not removed by a filter or stylus tip.

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


def _artefact(
    trace: Trace,
    k: Indices,
    series: tuple[Fraction, int],
    D: tuple[float, float],
    g_0: tuple[float, float],
    width: int = 1,
) -> str:
    """Return a sentence on the part of the line that dominates the fit, as a scratch does; empty if none does.

    Each window of `width` parts is replaced by a straight line, which removes its fine waves from the spectrum. D and
    g_0 are given with the standard errors of D and ln g_0, and `series` is the ratio and the number of waves.
    """
    z = trace.sampled_height(trace.period * trace.samples)
    ends = np.linspace(0, trace.samples, PARTS + 1).astype(int)
    windows = list(zip(ends[:-width].tolist(), ends[width:].tolist(), strict=True))
    without = np.empty((2, len(windows)))  # D and ln g_0
    for part, (start, end) in enumerate(windows):
        flat = z[: trace.samples].copy()
        flat[start:end] = np.interp(np.arange(start, end), [start - 1, end], z[[start - 1, end % z.size]])
        whole = flat if trace.period == 1 else np.concatenate([flat, flat[::-1]])
        power = np.abs(np.fft.rfft(whole)[k]) ** 2
        own = (5 - _exponent(k, power)) / 2
        variances = amplitude(np.arange(series[1]), own, float(series[0])) ** 2
        without[:, part] = own, math.log(power.sum() / variances.sum()) / 2
    shift = without - np.median(without, axis=1, keepdims=True)
    over_error = np.abs(shift) / [[D[1]], [g_0[1]]]
    quantity, at = np.unravel_index(int(over_error.argmax()), shift.shape)
    if not over_error[quantity, at] > DOMINANT:
        return ""
    x = np.array(windows[at]) / trace.samples * trace.lambda_0
    if quantity == 0:
        what = f"D: it is {D[0]:.3g} +- {D[1]:.1g} with them and {D[0] + shift[0, at]:.3g} without"
    else:
        gone = g_0[0] * math.exp(shift[1, at])
        what = f"g_0: it is {g_0[0]:.3g} +- {g_0[0] * g_0[1]:.1g} m with them and {gone:.3g} m without"
    return (
        f"the heights from x = {x[0]:.4g} to {x[1]:.4g} m, a {PARTS // width}th of the line, decide on {what}. Is "
        "there a scratch or dust? Cut the line there, or write the heights as missing, nan, and say "
        'missing="interpolate"'
    )


def _weights(k: Indices) -> tuple[Array, Array]:
    """Return weights of sum 1, uniform over ln k, and ln k minus its weighted mean."""
    weight = np.log((k + 0.5) / (k - 0.5))
    weight = weight / weight.sum()
    x = np.log(k)
    return weight, x - weight @ x


def _exponent(k: Indices, power: Array) -> float:
    """Return the exponent beta of a spectrum k^-beta."""
    weight, x = _weights(k)
    log_power = np.log(np.maximum(weight * power / power.max(), 1e-300))
    softmax = scipy.special.softmax  # w_k P_k k^beta over their sum, which may overflow
    return float(scipy.optimize.brentq(lambda beta: softmax(log_power + beta * x) @ x, -STEEPEST, STEEPEST))


def _influence_on_D(k: Indices, beta: float, scatter: float) -> tuple[Array, float]:
    """Return the derivatives of D with respect to ln P_k on a spectrum k^-beta, and the bias of D to second order.

    With P_k k^beta = 1 + e_k and the weights w of sum 1, the change b of beta solves sum w (1 + e) exp(b x) x = 0: to
    second order, b = -A/S_2 + A B/S_2^2 - A^2 S_3/(2 S_2^3), A = sum w e x, B = sum w e x^2, S_j = sum w x^j.
    """
    weight, x = _weights(k)
    second, third = weight @ x**2, weight @ x**3
    b = scatter * (weight**2 @ x**3 / second**2 - third * (weight**2 @ x**2) / (2 * second**3))
    return weight * x / second / 2, float(-b / 2)
