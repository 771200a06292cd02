"""Series whose coarsest waves are pressed flat: the part that Archard's and Demelio's approximations have in common.

The formulas are those of docs/closed_forms.md, "Flat waves".

Wave n carries xi_n, a mean pressure in its p_n*. Behind a flat wave, xi_n > 1, the next one carries

    xi_{n+1} - fixed = gamma^(1-D) (xi_n - fixed),

where `fixed`, the xi_inf of that page, is 0 if waves hand on the mean pressure alone. So the number N of flat waves
has a closed form, and those that remain are self-affine to the complete series:

    h(p; m) = sum of g_n over n < N + g_N h(xi_N; m - N),    dh/dp = gamma^-N h'(xi_N; m - N).

A load that rounding takes for one more or one fewer flat wave has the same numbers, since these join smoothly.
Heights are in g_0, pressures in p_0*.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from weier.kernels.arrays import Array
from weier.surface.series import amplitude, full_contact_pressure, leading_amplitude

# Terms in the place of m = inf: no sum in double precision differs between the two, and their difference is 0.
INFINITE_TERMS = 1e300


class Remaining(NamedTuple):
    """The waves that each load does not press flat; arrays of the shape to which loads and series broadcast.

    load : xi_N, what the first of them carries, in its p*; NaN where a load is not positive
    waves : how many they are
    flat : number N of the others
    D, gamma : of the series, of their own shape
    """

    load: Array
    waves: Array
    flat: Array
    D: Array
    gamma: Array

    def with_flat_waves(self, h: Array) -> Array:
        """Return compliance of all waves from that of those that remain."""
        flat = self.flat, self.D, self.gamma
        return np.asarray(leading_amplitude(*flat) + amplitude(*flat) * h)

    def behind_flat_waves(self, slope: Array) -> Array:
        """Return resistance of all waves from that of those that remain: flat waves have none."""
        return np.asarray(self.gamma**-self.flat * slope)  # g_n/p_n* = gamma^-n


def remaining(
    mean_pressure: ArrayLike,
    D: ArrayLike,
    gamma: ArrayLike,
    m: ArrayLike,
    fixed_point: Callable[[Array, Array], Array] = lambda D, gamma: np.zeros_like(D),
) -> Remaining:
    """Return the waves that are not flat under loads in p_0*; `fixed_point` is that of the loads handed on."""
    p, D, gamma, m = (np.asarray(value, float) for value in (mean_pressure, D, gamma, m))
    m, fixed = np.asarray(np.minimum(m, INFINITE_TERMS)), fixed_point(D, gamma)
    with np.errstate(invalid="ignore", divide="ignore"):  # Loads below the fixed point and invalid ones have no log.
        p = np.where(p > 0, p, np.nan)
        number = np.ceil((np.log(p - fixed) - np.log(1 - fixed)) / ((D - 1) * np.log(gamma)))
        # Loads that tend to more than 1 are handed on to all waves.
        flat = np.where(p > 1, np.where(fixed >= 1, m, np.minimum(number, m)), 0.0)
        shrink = full_contact_pressure(-np.where(flat < m, flat, 0), D, gamma)
        load = np.where(flat > 0, fixed + shrink * (p - fixed), p)
    return Remaining(np.asarray(load), m - flat, flat, D, gamma)
