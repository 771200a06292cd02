"""What the problems of contacts and of gaps have in common: the interface of `contacts.CONTACTS` and `gaps.GAPS`."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from weier.kernels.arrays import Array
from weier.methods.patches.surface import CosineSeries


class Kind(NamedTuple):
    """Contacts or gaps: the formulas that differ.

    dual : whether these are gaps
    right_sign : sign of psi at the right edge where it is positive at the left one
    k_0_of_curvature : at an edge, b k_1 plus this times k_0 is in proportion to the curvature of what lies between
        two segments, of half-width b
    strength_factor : strength of the pressure at an edge over that of the density
    tangent_forcing : derivative of the forcing by the load
    sign_of_plane : sign of the resistance over the change of the plane with the load
    rounding_power : rounding changes b_n by n to half this power
    on_diagonal : what is added to all influences, so that they are positive definite
    close : from the forces for the forcing and for 1 everywhere, and the load, to the forces and the plane
    factor : of sums over all forces, from the period
    forcing_of_maximum : from series and load, the forcing where the series has its maximum
    height_of_residual : from half-widths, the height of a residual of 1
    finest_height : of the finest wave of a series, in g_0
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
