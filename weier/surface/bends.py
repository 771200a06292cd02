"""Bends of a spectrum: where it turns from a power law to another slope, by the likelihood of its waves.

docs/api/trace.rst derives the likelihood. Ground and honed surfaces roll off, which flattens the spectrum above a
wavelength; waviness makes it steeper there. Towards short waves, noise flattens it, and filters make it steeper.
"""

from __future__ import annotations

import math
from itertools import product
from statistics import NormalDist
from typing import Any, NamedTuple

import numpy as np
import scipy  # Its submodules are loaded on first use.

from weier.kernels.arrays import Array, Indices

# Twice the gain in log likelihood from which a roll-off is significant, and from which a given band is refused: the
# 0.95 and 0.999 quantiles of chi^2 with one degree of freedom, the square of a normal variable. Other bends are rarer
# and need a margin. `python -m benchmarks artefacts` counts wrong verdicts.
MIN_BEND_GAIN, CERTAIN_BEND_GAIN = (NormalDist().inv_cdf(0.5 + level / 2) ** 2 for level in (0.95, 0.999))
RARE_BEND_MARGIN = 3.0
MIN_LAW_EXPONENT, MAX_LAW_EXPONENT = 0.9, 4.0  # exponents of laws with bends; self-affine ones have 1 to 3, kinks 4
BISECTIONS = 30  # bisections for the exponent, which reach 1e-8
SHARPNESS = (2.0, 8.0)  # exponent s of a smooth and of an abrupt bend
FLAT, STEEP = 0.0, 3.0  # extreme ratios of the slope beyond a bend to the slope of the law
LONG, SHORT = -1, 1  # sides of a bend, beyond which the law does not hold
BENDS_PER_OCTAVE = 4  # places at which a bend is tried; results hardly change with eight
BINS_PER_OCTAVE = 16  # bins of waves; the likelihood varies little within one
TRANSITION_END = 1 / 16  # (k_b/k)^s or (k/k_b)^s below which the slope is nearly the slope of the law


class Spectrum(NamedTuple):
    """Variances of the waves of heights, in m^2, with k waves in a period, in m.

    `scatter` is the relative variance of such a variance on a random surface.
    """

    k: Indices
    variance: Array
    period: float
    scatter: float

    def between(self, longest: float, shortest: float, tolerance: float = 1 + 1e-9) -> Spectrum:
        """Return the part of the spectrum between two wavelengths, in m."""
        most, least = (self.period / wavelength for wavelength in (shortest, longest))
        part = (self.k >= least / tolerance) & (self.k <= most * tolerance)
        return self._replace(k=self.k[part], variance=self.variance[part])


class Bend(NamedTuple):
    """A spectrum k^-beta with another slope beyond a bend at ln k = `place`, by a factor on one side.

    `gain` is twice the log likelihood ratio of this spectrum to a power law without a bend.
    """

    side: int
    factor: float
    place: float
    sharpness: float
    beta: float = math.nan
    gain: float = -math.inf

    def bent(self, x: Array) -> Array:
        """Return q at x = ln k: the spectrum is exp(-beta q)."""
        s = self.side * self.sharpness
        return np.asarray(x + (self.factor - 1) * np.logaddexp(s * (x - self.place), 0) / s)

    @property
    def is_rolloff(self) -> bool:
        """Return whether the spectrum is flat above a wavelength."""
        return (self.side, self.factor) == (LONG, FLAT)

    @property
    def end(self) -> float:
        """Return ln k at which the law ends."""
        return self.place + self.side * math.log(TRANSITION_END) / self.sharpness


def likeliest_bend(band: Spectrum, least_ratio: float) -> Bend | None:
    """Return the likeliest bend that leaves a law on at least this ratio of wavelengths; None if there is none.

    ValueError is raised if a bend that leaves no room for a law is certainly likelier.
    """
    top, bottom = math.log(band.k[0]), math.log(band.k[-1])
    steps = np.arange(0, bottom - top - math.log(2), math.log(2) / BENDS_PER_OCTAVE).tolist()
    kinds = product((LONG, SHORT), (FLAT, STEEP), SHARPNESS, steps)
    bends = [Bend(side, f, top + x if side == LONG else bottom - x, s) for side, f, s, x in kinds]
    bends = sorted(_rated(band, bends), key=lambda bend: -bend.gain)
    length = math.log(least_ratio / (1 + 1e-9))
    other_end = {LONG: bottom, SHORT: top}
    best = next((bend for bend in bends if bend.side * (bend.end - other_end[bend.side]) >= length), None)
    if bends and bends[0].gain > CERTAIN_BEND_GAIN + max(0.0, best.gain if best else 0.0):
        raise ValueError(
            f"the spectrum must be a power law from one wavelength to {least_ratio:g} times of it at least, got a "
            f"bend at {band.period / math.exp(bends[0].place):.3g} m between {band.period / band.k[0]:.3g} and "
            f"{band.period / band.k[-1]:.3g} m: measure a longer line, or shorter waves"
        )
    return best


def log_relative_power(power: Any) -> Array:
    """Return the logarithm of a power over the greatest one."""
    return np.asarray(np.log(np.maximum(power / np.max(power), 1e-300)))


def _rated(band: Spectrum, bends: list[Bend]) -> list[Bend]:
    """Return the bends of laws that waves have, with exponents and gains.

    On a random surface, P_k/S_k is chi^2 distributed with 2/scatter degrees of freedom, over their number. With S_k =
    A exp(-beta q_k) the likelihood of N waves is greatest where L = ln sum P_k exp(beta (q_k - mean q)) is least, and
    its logarithm then is -N L/scatter. A power law has q = ln k. The waves of a bin share their q. If P_k/S_k
    scatters more than on a random surface, gains are divided by the ratio of the variances.
    """
    x = np.log(band.k)
    bins = np.unique(np.floor(BINS_PER_OCTAVE * np.log2(band.k / band.k[0])), return_inverse=True)[1]
    waves, log_power = np.bincount(bins), log_relative_power(np.bincount(bins, band.variance))
    mean_x = np.bincount(bins, x) / waves
    q = np.array([mean_x, *(bend.bent(mean_x) for bend in bends)])
    q -= (q @ waves / x.size)[:, np.newaxis]
    beta = _exponents(log_power, q)
    least = scipy.special.logsumexp(log_power + beta[:, np.newaxis] * q, axis=1)
    gain = 2 * x.size / band.scatter * (least[0] - least[1:])
    found = [
        bend._replace(beta=own, gain=more - (0 if bend.is_rolloff else RARE_BEND_MARGIN))
        for bend, own, more in zip(bends, beta[1:].tolist(), gain.tolist(), strict=True)
        if MIN_LAW_EXPONENT < own < MAX_LAW_EXPONENT
    ]
    if not found:
        return []
    best = max(found, key=lambda bend: bend.gain)
    over_law = scipy.special.softmax(log_relative_power(band.variance) + best.beta * best.bent(x))
    effective = 1 / float(over_law @ over_law) - 3  # degrees of freedom: waves minus parameters
    dispersion = max(1.0, (x.size / max(effective, 1e-9) - 1) / band.scatter)
    return [bend._replace(gain=bend.gain / dispersion) for bend in found]


def _exponents(log_power: Array, q: Array) -> Array:
    """Return the likeliest exponent of each row of q, by bisection within +-2 MAX_LAW_EXPONENT.

    The powers times exp(beta q) then have their centre at q = 0.
    """
    low, high = np.full(len(q), -2 * MAX_LAW_EXPONENT), np.full(len(q), 2 * MAX_LAW_EXPONENT)
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        right = np.sum(scipy.special.softmax(log_power + middle[:, np.newaxis] * q, axis=1) * q, axis=1) > 0
        low, high = np.where(right, low, middle), np.where(right, middle, high)
    return np.asarray((low + high) / 2)
