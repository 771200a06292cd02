"""Stated errors of boundary elements (docs/bem.md, "Bounds")."""

from __future__ import annotations

import math

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.bem.grids import MIN_POINTS_PER_CARRIED_WAVE
from weier.methods.error_model import COMPLIANCE_ROUNDING, RESIDUAL_FACTOR
from weier.surface.crests import SAMPLES_PER_WAVE, countable, sample
from weier.surface.waves import Waves
from weier.theory.bounds import first_contact, slope_bounds

# z'' dx^2/8 with dx = 2 pi over the points per wave: the error at first contact for a crest half a node off the grid
MISSED_CREST = (2 * math.pi) ** 2 / 8


def compliance_error(profile: Waves, points: int) -> float:
    """Return error of h on `points` nodes, in g_0: the largest curvature of the surface times dx^2/8."""
    return MISSED_CREST * curvature(profile) * (profile.waves_per_period[-1] / points) ** 2


def curvature(profile: Waves) -> float:
    """Return a bound on the largest |z''|, in g_0 per square radian of the finest wave.

    A sum of waves of at most n per period nowhere exceeds its maximum at M > 2 n samples times 1/cos(pi n/M) (Ehlich
    and Zeller 1964), nor the sum of its amplitudes.
    """
    waves = profile.waves_per_period
    amplitude = profile.amplitude * np.array([k / waves[-1] for k in waves]) ** 2  # k are integers of any size
    most = float(np.abs(amplitude).sum())
    if not countable(waves[-1]):
        return most
    largest = np.abs(sample(amplitude, waves, profile.phase, SAMPLES_PER_WAVE * waves[-1])).max()
    return min(most, float(largest) / math.cos(math.pi / SAMPLES_PER_WAVE))


def fewest_points(profile: Waves, error: float) -> int:
    """Return the least number of nodes per period within this `compliance_error`, divisible for nested grids."""
    needed = math.sqrt(MISSED_CREST * curvature(profile) / error)
    # Coarser grids than 12 points per finest wave were not measured, and 1e15 is beyond any computer.
    needed = min(max(needed, 12), 1e15)
    halvings = 2 ** int(math.log2(needed / MIN_POINTS_PER_CARRIED_WAVE))
    return math.ceil(needed / halvings) * halvings * profile.waves_per_period[-1]


def errors(
    profile: Waves, loads: Array, points: int, curve: tuple[Array, Array], residual: Array
) -> tuple[Array, Array]:
    """Return errors of compliance and resistance of a `curve` over increasing loads, with these residuals.

    Both are exact from full contact on, and the compliance at zero load. The chords of the concave curve to these two
    points and to its other loads bound the resistance.
    """
    (h, R), full = curve, profile.full_contact_load
    rounding = COMPLIANCE_ROUNDING * profile.total_amplitude
    h_error = np.where(loads < full, compliance_error(profile, points) + RESIDUAL_FACTOR * residual, rounding)
    other = np.concatenate([[0.0], loads, [full]])
    lower = np.concatenate([[first_contact(profile) - rounding], h - h_error, [profile.total_amplitude - rounding]])
    low, high = np.zeros((2, loads.size))
    for part in np.array_split(np.arange(loads.size), math.isqrt(loads.size)):  # in blocks, for memory
        low[part], high[part] = slope_bounds(loads[part], (h + h_error)[part], other, lower)
    return h_error, np.where(loads < full, np.maximum(high - R, R - low), 0.0)
