"""Fit of the Weierstrass series to the spectrum of a measured surface between two wavelengths.

From one term to the next the variance changes by the factor gamma^(2 (D - 2)). On a surface whose power spectral
density falls with the wavenumber k as k^-beta, beta = 5 - 2 D, the same holds for bands of wavelengths with the ratio
gamma.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import scipy  # Its submodules are loaded on first use.

from weier import units
from weier.checks import checked_number, shown
from weier.kernels.arrays import Array, Indices
from weier.surface.bends import (
    CERTAIN_BEND_GAIN,
    LONG,
    MIN_BEND_GAIN,
    SHORT,
    Spectrum,
    likeliest_bend,
    log_relative_power,
)
from weier.surface.measured.trace import DECIMAL_ROUNDING, PERIODIC, Trace
from weier.surface.profile import Profile, checked_ratio
from weier.surface.series import amplitude

PARTS = 20  # parts of a line, each omitted from the spectrum in turn
# standard errors of D or ln g_0 without a part from the median over the parts, from which that part dominates the
# fit: 5 of 1928 random lines of 200 to 4000 heights had one (`python -m benchmarks artefacts --rounds 150`)
DOMINANCE_DEVIATIONS = 2.0
# The next two were measured by the same command.
# default length of the trace over the longest wavelength: within one and two errors are 0.68 and 0.96 of the lines of
# five octaves; with a length of one wavelength 0.76 and 0.97
WAVES_IN_LENGTH = 4
MIN_RATIO = 4.0  # smallest ratio of the wavelengths: 0.68 of lines on two octaves have 1 < D < 2, 0.33 on one
# Variance of P_k over its square on a random surface: P_k is the sum of two squares of normal numbers in a periodic
# trace, and one square in a mirrored one.
PERIODIC_SCATTER, MIRRORED_SCATTER = 1.0, 2.0
EXPONENT_BRACKET = 40.0  # largest |exponent| in bisection; a series has 1 to 3


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
    rolloff : float or None
        Wavelength, in m, above which the spectrum is flatter than the power law, so that lambda_0 lies below it; None
        if the law holds up to the longest wavelength compared.
    """

    D: float
    D_error: float
    gamma: Fraction
    m: int
    lambda_0: float
    g_0: float
    g_0_error: float
    rolloff: float | None = None

    def profile(self, phases: Any = 0.0, *, m: float | None = None, seed: int | None = None) -> Profile:
        """Return the series with these phases, which a spectrum does not determine; `m` overrides its length."""
        return Profile(self.D, self.gamma, self.m if m is None else m, phases, seed=seed)


def fit(
    trace: Trace,
    longest: float | None = None,
    shortest: float | None = None,
    gamma: int | float | str | Fraction = 2,
) -> Fit:
    """Fit the Weierstrass series to the spectrum of a trace between two wavelengths.

    Parameters
    ----------
    trace : Trace
        The measured surface.
    longest, shortest : float, optional
        Band of wavelengths, in m; by default from a quarter of the length of the trace to its shortest wavelength, or
        the part of it without bends of the spectrum.
        Each term represents a band from gamma^(-1/2) to gamma^(1/2) times its wavelength, so that lambda_0 is
        `longest`/gamma^(1/2).
    gamma : int, Fraction, str or float
        Ratio of successive wavelengths, which a continuous spectrum does not determine.

    Returns
    -------
    Fit
        D and g_0 with standard errors, lambda_0 and m.

    Raises
    ------
    ValueError
        If the band is narrower than two octaves or gamma, or not in the trace, if the slope of its spectrum gives no
        D with 1 < D < 2, or if the spectrum bends within a given band or leaves no law on two octaves; the message
        names the wavelength to take.

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
    of D and ln g_0 with respect to ln P_k and their correlation, and larger where the spectrum may bend. The bias is
    removed to second order. docs/measured.rst has the part of true values within the errors. Weierstrass series are
    not random; on lengths of 20 `longest` and more the fit finds their D within 0.01.

    A likelihood-ratio test finds bends: a roll-off, as ground surfaces have, waviness, noise, or a filter. Without
    `longest`, the law below a roll-off is fitted, and `rolloff` is its wavelength.

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
    z = trace.g_0 * trace.sampled_height(trace.period * trace.samples)[: trace.samples]
    whole = _spectrum(trace, z)
    first, last = _band(trace, longest, shortest, ratio)
    law = whole_law = _law(whole, first, last, ratio)
    rolloff, doubt = None, np.zeros(2)
    artefact = _artefact(trace, z, law)
    if not artefact:  # The spectra of scratches have bends.
        given = {LONG: longest is not None, SHORT: shortest is not None}
        law, rolloff, doubt = _straight_law(whole, law, last, given)
        artefact = _artefact(trace, z, law) if law is not whole_law else ""
    if not 1 < law.D < 2:
        if artefact:  # A line without long waves, as a filter leaves it, is dominated by some part, too.
            try:
                _straight_law(whole, law, last, {LONG: True, SHORT: True})
            except ValueError as bend:
                artefact += f"; or {bend}".removesuffix(", or none")
        raise ValueError(
            f"the spectrum must fall as k^-beta with beta between 1 and 3, got {5 - 2 * law.D:.3g} from "
            f"{law.longest:g} to {law.shortest:g} m: {artefact or 'take other wavelengths'}"
        )
    if artefact:
        warnings.warn(f"trace {trace.source}: {artefact}" if trace.source else artefact, stacklevel=2)
    D_error, g_0_error = np.sqrt(law.errors**2 + doubt).tolist()
    lambda_0 = law.longest / math.sqrt(ratio)
    return Fit(law.D, D_error, ratio, law.m, lambda_0, law.g_0, law.g_0 * g_0_error, rolloff)


def _band(trace: Trace, longest: float | None, shortest: float | None, ratio: Fraction) -> tuple[float, float]:
    """Return the longest and the shortest wavelength that are compared, in m."""
    finest = trace.lambda_0 * trace.period / trace.finest
    least = min(finest, trace.shortest)  # The second was given by the user, and is within one wave of the first.
    last = checked_number(
        "shortest",
        finest if shortest is None else shortest,
        f"be at least that of the trace, {least:.6g} m",
        lambda x: least <= x * DECIMAL_ROUNDING,
        units.METRE,
    )
    fewest = _least_ratio(ratio) * last
    first = checked_number(
        "longest",
        trace.lambda_0 / WAVES_IN_LENGTH if longest is None else longest,
        f"lie between {fewest:.6g} m, {MIN_RATIO:g} and gamma times the shortest wavelength, and the length of the "
        f"trace, {trace.lambda_0:.6g} m",
        lambda x: fewest <= x * DECIMAL_ROUNDING and x <= trace.lambda_0 * DECIMAL_ROUNDING,
        units.METRE,
    )
    return first, last


def _least_ratio(ratio: Fraction) -> float:
    """Return the least ratio of the wavelengths at the ends of a band."""
    return max(MIN_RATIO, float(ratio))


def _extended(trace: Trace, z: Array) -> Array:
    """Return one period of these heights of a trace, which is mirrored unless it is periodic."""
    return z if trace.ends == PERIODIC else np.concatenate([z, z[::-1]])


def _spectrum(trace: Trace, z: Array) -> Spectrum:
    """Return the spectrum of heights on the length of a trace, in m."""
    whole = _extended(trace, z)
    variance = 2 * np.abs(np.fft.rfft(whole)[1 : (whole.size + 1) // 2] / whole.size) ** 2
    scatter = PERIODIC_SCATTER if trace.ends == PERIODIC else MIRRORED_SCATTER
    return Spectrum(np.arange(1, variance.size + 1), variance, trace.period * trace.lambda_0, scatter)


class Law(NamedTuple):
    """The series with the spectrum of the waves between two wavelengths, in m.

    The errors of D and ln g_0 hold for a random surface.
    """

    longest: float
    shortest: float
    ratio: Fraction
    m: int
    D: float
    g_0: float
    errors: Array


def _law(whole: Spectrum, first: float, last: float, ratio: Fraction) -> Law:
    """Return the law between two wavelengths, the second of which is raised to a whole number of terms."""
    m = math.floor(math.log(first / last * DECIMAL_ROUNDING) / math.log(ratio))
    last = first / float(ratio) ** m
    k, variance, _, scatter = whole.between(first, last)
    beta = _exponent(k, variance)
    D_influence, D_bias = _influence_on_D(k, beta, scatter)
    D = (5 - beta) / 2 - D_bias
    n = np.arange(m)
    variances = amplitude(n, D, float(ratio)) ** 2  # variance of the terms over the variance of the first
    part = variances / variances.sum()
    share = (k / k[0]) ** -beta / ((k / k[0]) ** -beta).sum()
    slope = math.log(ratio) * float(n @ part)  # minus the derivative of ln g_0 with respect to D at a given variance
    curvature = math.log(ratio) ** 2 * float(n**2 @ part - (n @ part) ** 2)
    influences = np.array([D_influence, share / 2 - slope * D_influence])
    errors = np.sqrt(scatter * (influences**2).sum(axis=1))
    bias = -scatter * share @ share / 4 - curvature * float(errors[0]) ** 2
    g_0 = math.sqrt(2 * variance.sum() / variances.sum()) * math.exp(-bias)
    return Law(first, last, ratio, m, D, g_0, errors)


def _straight_law(
    whole: Spectrum, law: Law, last: float, given: Mapping[int, bool]
) -> tuple[Law, float | None, Array]:
    """Return the law between all significant bends, the wavelength of the roll-off, in m, and the doubt about a bend.

    The doubt is a variance of D and ln g_0: the squared bias by the likeliest bend that is not significant, times the
    probability of this bend. Its odds are taken as exp(gain - MIN_BEND_GAIN), so that the errors cover power laws and
    spectra with bends alike (docs/measured.rst). ValueError is raised if a `given` end of the band certainly lies
    beyond a bend.
    """
    first, rolloff, doubt = law.longest, None, np.zeros(2)
    while bend := likeliest_bend(whole.between(first, last), _least_ratio(law.ratio)):
        at, end = (whole.period / math.exp(x) for x in (bend.place, bend.end))
        if given[bend.side] and bend.gain > CERTAIN_BEND_GAIN:
            what = "roll-off" if bend.is_rolloff else "bend"
            advice = "longest" if bend.side == LONG else "shortest"
            raise ValueError(
                f"the spectrum must be one power law from {first:.6g} to {last:.6g} m, got a {what} at {at:.3g} m: "
                f"take {advice}={end:.3g}, or none"
            )
        if given[bend.side] or bend.gain <= MIN_BEND_GAIN:
            x = np.log(whole.k)
            with_bend, without = (
                _law(whole._replace(variance=np.exp(-bend.beta * q)), first, last, law.ratio)
                for q in (bend.bent(x), x)
            )
            shift = with_bend.D - without.D, math.log(with_bend.g_0 / without.g_0)
            doubt = np.square(shift) * scipy.special.expit(bend.gain - MIN_BEND_GAIN)
            break
        first, last = (end, last) if bend.side == LONG else (first, end)
        rolloff = at if bend.is_rolloff else rolloff
        law = _law(whole, first, last, law.ratio)
    return law, rolloff, doubt


def _artefact(trace: Trace, z: Array, law: Law) -> str:
    """Return a sentence on the part of the line that dominates the fit, as a scratch does; empty if none does.

    Each part of the heights z is replaced by a straight line, which removes its fine waves from the spectrum.
    """
    parts = list(pairwise(np.linspace(0, z.size, PARTS + 1).astype(int).tolist()))
    around = _extended(trace, z)
    without = np.empty((2, PARTS))  # columns: D and ln g_0
    for part, (start, end) in enumerate(parts):
        flat = z.copy()
        flat[start:end] = np.interp(np.arange(start, end), [start - 1, end], around[[start - 1, end % around.size]])
        k, variance, *_ = _spectrum(trace, flat).between(law.longest, law.shortest)
        own = (5 - _exponent(k, variance)) / 2
        variances = amplitude(np.arange(law.m), own, float(law.ratio)) ** 2
        without[:, part] = own, math.log(variance.sum() / variances.sum()) / 2
    shift = without - np.median(without, axis=1, keepdims=True)
    over_error = np.abs(shift) / law.errors[:, np.newaxis]
    at = int(over_error.max(axis=0).argmax())
    if not over_error[:, at].max() > DOMINANCE_DEVIATIONS:
        return ""
    x = np.array(parts[at]) / trace.samples * trace.lambda_0
    (D_error, g_0_error), (D_shift, g_0_shift) = law.errors.tolist(), shift[:, at].tolist()
    return (
        f"the heights from x = {x[0]:.4g} to {x[1]:.4g} m, a {PARTS}th of the line, decide on the fit: D is "
        f"{law.D:.3g} +- {D_error:.1g} with them and {law.D + D_shift:.3g} without, g_0 {law.g_0:.3g} +- "
        f"{law.g_0 * g_0_error:.1g} m and {law.g_0 * math.exp(g_0_shift):.3g} m. Is there a scratch or dust? Cut the "
        f"line there, or write the heights as missing, nan, and say max_gap={parts[at][1] - parts[at][0]}"
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
    log_power = log_relative_power(weight * power)

    def centre(beta: float) -> float:
        return float(scipy.special.softmax(log_power + beta * x) @ x)  # w_k P_k k^beta itself may overflow

    if not centre(-EXPONENT_BRACKET) < 0 < centre(EXPONENT_BRACKET):  # the spectrum has hardly any waves
        return math.copysign(EXPONENT_BRACKET, -centre(0))
    return float(scipy.optimize.brentq(centre, -EXPONENT_BRACKET, EXPONENT_BRACKET))


def _influence_on_D(k: Indices, beta: float, scatter: float) -> tuple[Array, float]:
    """Return the derivatives of D with respect to ln P_k on a spectrum k^-beta, and the bias of D to second order.

    With P_k k^beta = 1 + e_k and the weights w of sum 1, the change b of beta solves sum w (1 + e) exp(b x) x = 0: to
    second order, b = -A/S_2 + A B/S_2^2 - A^2 S_3/(2 S_2^3), A = sum w e x, B = sum w e x^2, S_j = sum w x^j.
    """
    weight, x = _weights(k)
    second, third = weight @ x**2, weight @ x**3
    b = scatter * (weight**2 @ x**3 / second**2 - third * (weight**2 @ x**2) / (2 * second**3))
    return weight * x / second / 2, float(-b / 2)
