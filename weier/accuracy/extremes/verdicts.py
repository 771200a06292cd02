"""What any curve of compliance obeys, and how many digits of it are right.

A curve rises and is concave, its resistance falls and lies between the chords to either side, and it stays within
the bounds that the first wave alone, in closed form, sets to all longer series (Section 5.5).
"""

from __future__ import annotations

import math
from typing import Any

import mpmath as mp
import numpy as np

from weier.kernels.arrays import Array
from weier.methods import westergaard
from weier.methods.method import Noise
from weier.methods.multiprecision import DIGITS
from weier.theory.bounds import compliance_bounds, resistance_bounds
from weier.theory.profile import Profile

MOST_DIGITS = 16.0  # an error of 0 counts as so many
TINY = float(np.finfo(float).tiny)  # what is less may be 0


def monotone(h: Array, noise: float) -> bool:
    """Whether h never falls by more than `noise`, a height."""
    return bool(np.all(np.diff(h) >= -noise))


def concave(p: Array, h: Array, R: Array, noise: Noise, amplitude: float) -> bool:
    """Whether the slope falls, and every chord lies between the slopes at its ends."""
    with np.errstate(over="ignore", invalid="ignore"):
        slack = noise.height * amplitude / np.diff(p)
        chord = np.diff(h) / np.diff(p)
        steepest, flattest = R[:-1] * (1 + noise.slope) + slack, R[1:] * (1 - noise.slope) - slack
        falls = np.diff(R) <= noise.slope * R[:-1] + slack
    if math.isinf(noise.slope):
        return bool(np.all(np.diff(chord) <= slack[1:] + slack[:-1]))
    return bool(np.all(falls & (chord <= steepest) & (chord >= flattest)))


def inside(profile: Profile, p: Array, h: Array, R: Array, noise: Noise, mesh: float) -> bool:
    """Whether compliance and resistance lie within the bounds of the first wave alone.

    What a mesh misses, `mesh` in g_0, and the noise are a band of heights like the waves left out.
    """
    total = profile.total_amplitude
    band = total - 1 + mesh + noise.height * total
    one = westergaard.compliance(p)
    low, high = compliance_bounds(one, band)
    within = (low <= h - total + 1) & (h - total + 1 <= high)
    low, high = resistance_bounds(p, one, band, first_contact=0.0)
    if not math.isinf(noise.slope):
        within &= (low * (1 - noise.slope) <= R) & (R * (1 - noise.slope) <= high)
    return bool(np.all(within))


def expected(off: Array, error: Array, blur: Array) -> bool | None:
    """Whether each number is as far from the truth as it expects at most; None where neither tells.

    `blur` is what the truth itself may be off.
    """
    known = np.isfinite(off) & ~np.isnan(error)
    return bool(np.all((off <= error + blur)[known])) if known.any() else None


def digits(found: Array, exact: list[Any]) -> Array:
    """Correct digits, -log10 of the relative error, from 0 to 16; NaN where either is unknown."""
    return np.array([_digits(float(value), true) for value, true in zip(found, exact, strict=True)])


def _digits(found: float, exact: Any) -> float:
    if not math.isfinite(found) or mp.isnan(exact):
        return math.nan
    with mp.workdps(DIGITS):
        if abs(exact) < TINY:
            return MOST_DIGITS if abs(found) <= TINY else 0.0
        error = abs(mp.mpf(found) / exact - 1)
        return min(max(float(-mp.log10(error)), 0.0), MOST_DIGITS) if error else MOST_DIGITS


def distance(found: Array, exact: list[Any]) -> Array:
    """Distance of each from the truth, NaN where either is unknown."""
    return np.array([float(abs(mp.mpf(float(value)) - true)) for value, true in zip(found, exact, strict=True)])
