"""Common interface of the problems of contacts and of gaps, `contacts.CONTACTS` and `gaps.GAPS`."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from weier.kernels.arrays import Array
from weier.methods.patches.surface import CosineSeries

POTENTIAL, CAUCHY = 0, 1  # integrals of the density with ln|2 sin| and with cot


class Kind(NamedTuple):
    """Contacts or gaps: the formulas that differ.

    dual : whether these are gaps
    right_sign : sign of psi at the right edge where it is positive at the left one
    k_0_of_curvature : b k_1 plus this times k_0 is proportional to the curvature in an interval of half-width b
        between two segments
    strength_factor : strength of the pressure at an edge over that of the density
    tangent_forcing : derivative of the forcing with respect to the load
    sign_of_plane : sign of the resistance over the change of the plane with the load
    rounding_power : rounding changes b_n by n to half this power
    on_diagonal : constant added to all influences to make them positive definite
    close : from the forces for the forcing and for 1 everywhere, and the load, to the forces and the plane
    factor : of sums over all forces, from the period
    forcing_of_maximum : from series and load, the forcing where the series has its maximum
    height_of_residual : from half-widths, the height of a residual of 1
    finest_height : of the finest wave of a series, in g_0
    plane_outside : factor of the plane between segments: 1 for the gap, 0 for the pressure
    integral : of the density, for the values between segments, `POTENTIAL` or `CAUCHY`
    integral_factor : its factor there, from the period
    constant : the constant there, from load, approach and maximum of the series
    new_width : width of a new segment over the interval that it replaces, where a parabola is negative
    limit_outside : from load, limit of overlap and limit of tension over the load, the limit between segments
    rounded_width : from period and half-widths, the width over which residuals are rounded
    share : from the number of segments, the fraction of the tolerance for each
    scale_of_residual : from load, approach and period, the scale of relative residuals
    """

    dual: bool
    right_sign: float
    k_0_of_curvature: float
    strength_factor: float
    tangent_forcing: float
    sign_of_plane: float
    rounding_power: int
    on_diagonal: float
    close: Callable[[Array, Array, float, float], tuple[Array, float]]
    factor: Callable[[float], float]
    forcing_of_maximum: Callable[[CosineSeries, float], float]
    height_of_residual: Callable[[Array], Array]
    finest_height: Callable[[CosineSeries], float]
    plane_outside: float
    integral: int
    integral_factor: Callable[[float], float]
    constant: Callable[[float, float, float], float]
    new_width: float
    limit_outside: Callable[[float, float, float], float]
    rounded_width: Callable[[float, Array], float]
    share: Callable[[int], float]
    scale_of_residual: Callable[[float, float, float], float]
