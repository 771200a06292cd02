"""What every curve of compliance obeys.

A curve rises and is concave, its resistance falls and lies between the chords to either side, and it stays within
the bounds that the first wave alone, in closed form, sets to all longer series (Section 5.5). A method that states
the errors of its numbers stays within them.
"""

from __future__ import annotations

import math

import numpy as np

from weier.kernels.arrays import Array
from weier.methods import westergaard
from weier.methods.method import Noise
from weier.theory.bounds import compliance_bounds, resistance_bounds
from weier.theory.profile import Profile


def monotone(h: Array, noise: float) -> bool:
    """Whether h never falls by more than `noise`, a height."""
    return bool(np.all(np.diff(h) >= -noise))


def concave(p: Array, h: Array, R: Array, noise: Noise, amplitude: float) -> bool:
    """Whether the slope falls, and every chord lies between the slopes at its ends; noise is of this amplitude."""
    with np.errstate(over="ignore", invalid="ignore"):
        slack = noise.height * amplitude / np.diff(p)
        chord = np.diff(h) / np.diff(p)
        steepest, flattest = R[:-1] * (1 + noise.slope) + slack, R[1:] * (1 - noise.slope) - slack
        falls = np.diff(R) <= noise.slope * R[:-1] + slack
    if math.isinf(noise.slope):
        return bool(np.all(np.diff(chord) <= slack[1:] + slack[:-1]))
    return bool(np.all(falls & (chord <= steepest) & (chord >= flattest)))


def within_band(profile: Profile, p: Array, h: Array, R: Array, noise: Noise, solution_error: float) -> bool:
    """Whether compliance and resistance lie within the bounds of the first wave alone.

    What the solution is off, in g_0, and the noise widen the band of the waves left out.
    """
    total = profile.total_amplitude
    band = total - 1 + solution_error + noise.height * total
    one = westergaard.compliance(p)
    low, high = compliance_bounds(one, band)
    within = (low <= h - total + 1) & (h - total + 1 <= high)
    low, high = resistance_bounds(p, one, band, first_contact=0.0)
    if not math.isinf(noise.slope):
        within &= (low * (1 - noise.slope) <= R) & (R * (1 - noise.slope) <= high)
    return bool(np.all(within))


def within_stated_error(deviation: Array, stated: Array, uncertainty: Array) -> bool | None:
    """Whether no deviation from a reference exceeds the stated error and the uncertainty of the reference together.

    None where there is no number with both a reference and a stated error.
    """
    known = np.isfinite(deviation) & ~np.isnan(stated)
    return bool(np.all((deviation <= stated + uncertainty)[known])) if known.any() else None
