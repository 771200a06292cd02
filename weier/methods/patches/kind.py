"""Common interface of the problems of contacts and of gaps, `contacts.CONTACTS` and `gaps.GAPS`."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Flags, Records
from weier.methods.patches.surface import CosineSeries, Extent, Sides
from weier.methods.punches import Inverse

EPS = float(np.finfo(float).eps)
# largest half-width b of a thin gap over its distance l to the nearest edge: their interaction changes the rise of R
# by the crack by a relative 4 (b/l)^2 = 1.6e-7; contacts next to wider gaps need 15/(4 b/r)^(1/2) nodes for twelve
# digits, at most 750 at the half of it from which existing contacts are merged
MAX_THINNESS = 2e-4
# rounding of tensions over the largest pressure of their contact or the load; of gaps over the sum of the amplitudes:
# above the differences between shifted profiles (tests/methods/patches/test_patches_fields.py); and of singularities
# over min(w, 1), with w the displacement under the whole load: at edges near births and mergers they do not fall
# below it
FIELD_ROUNDING = 1e-13
# Half-width a of a new contact over that of the overlap, c, which it replaces: Hertz's contact alone in a period has
# a = c (2/(1 + 2 ln(L/(pi a))))^(1/2), which is c/2 for L = 104 a, and c/4 to c for L = 5 a to 2e7 a. With
# a = sqrt(2) c it would carry no force.
NEW_CONTACT_WIDTH = 0.5


class Kind(NamedTuple):
    """Contacts or gaps: what differs.

    The density on contacts is the pressure, and the residual, which vanishes on them, is the gap; the density on gaps
    (dual) is their slope, whose integral is the gap, and the residual is the pressure.

    Where a formula for both kinds has a term or factor for one of them, that is multiplied by `dual`, 0 or 1.

    Solution on given edges
    dual : whether these are gaps; selects the kernel between nodes and the factors of a segment's self-influence
    right_sign : sign of psi at the right edge where it is positive at the left one
    k_0_of_curvature : b k_1 plus this times k_0 is proportional to the curvature in an interval of half-width b
        between two segments
    strength_factor : strength of the pressure at an edge over that of the density
    residual_power, residual_strength : near an edge the residual is s to this power, times this and the strength of
        the density
    rounding_grows : rounding changes b_n in proportion to n, else all alike
    close : from the forces for the forcing and for 1 everywhere, and the load, to the forces and the plane
    factor : of sums over all forces, from the period
    invert_punches : from half-widths, middles and period, the inverse of the influence of flat punches, by which
        contacts interact in the preconditioner; None for gaps, which carry no load
    plane_of : from the sum of the forces, the Lagrange multiplier of the load and the period, the plane
    height_of_residual : from half-widths, the height of a residual of 1
    rounded_width : from period and half-widths, the width over which residuals are rounded
    share : from the number of segments, the fraction of the tolerance for each

    Fields and inequalities
    new_outside, new_within : width of a new contact or gap over the interval of overlap or tension, between segments
        and on one; a gap is exact for a parabola of tension
    integral_factor : factor of the integral over the density in the residual, from the period
    constant : the residual at the maximum of the series without the integral, from load, approach and that maximum
    contacts_of : from the extent of segments and the period, that of contacts
    at_contacts : from values at the edges of segments, those at the edges of contacts
    limit_outside : from load, limit of overlap and limit of tension over the load, the limit between segments
    height_of_negative : from the width of an interval on a segment, the height of a pressure or gap of -1 on it
    overlaps_and_tensions : from minima of the residual, as `MINIMUM`, and negative intervals on segments, as
        `NEGATIVE`, those of the gap and those of the pressure
    tensions : from the extent of contacts, intervals of tension and the period, the index of each interval's contact,
        middle and half-width in its coordinate t, shape (intervals, 3)
    are_certain : from tensions, the last over the largest coefficients of each segment, the residual and the load,
        whether the tension exceeds these and rounding
    scale_of_residual : from load, approach and period, the scale of relative residuals
    imbalance : from the integrals of the density over segments, the load and the period, the deviation of the mean
        pressure, in p_0*, and the closure error of gaps, in g_0
    largest_indentation : from approach and series, the indentation from first contact or a larger height
    """

    dual: bool
    right_sign: float
    k_0_of_curvature: float
    strength_factor: float
    residual_power: float
    residual_strength: float
    rounding_grows: bool
    close: Callable[[Array, Array, float, float], tuple[Array, float]]
    factor: Callable[[float], float]
    invert_punches: Callable[[Array, Array, float], Inverse | None]
    plane_of: Callable[[float, float, float], float]
    height_of_residual: Callable[[Array], Array]
    rounded_width: Callable[[float, Array], float]
    share: Callable[[int], float]
    new_outside: float
    new_within: float
    integral_factor: Callable[[float], float]
    constant: Callable[[float, float, float], float]
    contacts_of: Callable[[Extent, float], Extent]
    at_contacts: Callable[[Sides], Sides]
    limit_outside: Callable[[float, float, float], float]
    height_of_negative: Callable[[Array], Array]
    overlaps_and_tensions: Callable[[Records, Records], tuple[Records, Records]]
    tensions: Callable[[Extent, Records, float], NDArray[np.float64]]
    are_certain: Callable[[Records, Array, float, float], Flags]
    scale_of_residual: Callable[[float, float, float], float]
    imbalance: Callable[[Array, float, float], tuple[float, float]]
    largest_indentation: Callable[[float, CosineSeries], float]
