"""Flattened waves at the coarse end of a series, common to Archard's and Demelio's approximations.

docs/closed_forms.md, "Flat waves", derives the formulas. Wave n carries xi_n in units of p_n*; after a flat wave

    xi_{n+1} - xi_inf = gamma^(1-D) (xi_n - xi_inf),

with xi_inf = 0 if waves carry the mean pressure. The number k of flat waves has a closed form, and the others are
self-affine to the complete series: h(p; m) = sum_{n<k} g_n + g_k h(xi_k; m - k). Heights are in g_0, pressures in
p_0*.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from weier.kernels.arrays import Array
from weier.surface.series import MAX_EXPONENT, amplitude, full_contact_pressure, leading_amplitude

# finite substitute for m = inf: sums are equal in double precision, differences and products with a logarithm finite
INFINITE_TERMS = sys.float_info.max / MAX_EXPONENT


class Remaining(NamedTuple):
    """Waves that are not flat; arrays have the broadcast shape of loads and series.

    load : xi_k on the first of them; NaN for loads that are not positive
    waves : their number, m - k
    flat : number k of flat waves
    D, gamma : parameters of the series, in their given shape
    """

    load: Array
    waves: Array
    flat: Array
    D: Array
    gamma: Array

    def with_flat_waves(self, h: Array) -> Array:
        """Return the compliance of all waves from the compliance of the waves that are not flat."""
        flat = self.flat, self.D, self.gamma
        return np.asarray(leading_amplitude(*flat) + amplitude(*flat) * h)

    def behind_flat_waves(self, slope: Array) -> Array:
        """Return the resistance of all waves from the resistance of the waves that are not flat."""
        return np.asarray(self.gamma**-self.flat * slope)  # g_n/p_n* = gamma^-n


def remaining(
    mean_pressure: ArrayLike,
    D: ArrayLike,
    gamma: ArrayLike,
    m: ArrayLike,
    fixed_point: Callable[[Array, Array], Array] = lambda D, gamma: np.zeros_like(D),
) -> Remaining:
    """Return the waves that are not flat under loads in p_0*; `fixed_point` gives xi_inf."""
    p, D, gamma, m = (np.asarray(value, float) for value in (mean_pressure, D, gamma, m))
    m, fixed = np.asarray(np.minimum(m, INFINITE_TERMS)), fixed_point(D, gamma)
    with np.errstate(invalid="ignore", divide="ignore"):  # loads below the fixed point have no logarithm
        p = np.where(p > 0, p, np.nan)
        number = np.ceil((np.log(p - fixed) - np.log(1 - fixed)) / ((D - 1) * np.log(gamma)))
        # a fixed point of 1 or more flattens all waves
        flat = np.where(p > 1, np.where(fixed >= 1, m, np.minimum(number, m)), 0.0)
        shrink = full_contact_pressure(-np.where(flat < m, flat, 0), D, gamma)
        load = np.where(flat > 0, fixed + shrink * (p - fixed), p)
    return Remaining(np.asarray(load), m - flat, flat, D, gamma)
