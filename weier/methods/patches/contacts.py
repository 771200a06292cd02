"""Contacts as segments: punches with given edges and a common load (docs/patches.md, "Given edges").

At the zeros of T_K, f_i = (pi/K) r psi_i. With A the sum over all nodes of -2 ln|2 sin(pi (x_i - x_j)/L)|,

    z - A f = d on all contacts,   sum f = p L,

with the mean gap d. A is positive definite on forces of sum 0; `OFFSET` makes it so on all forces.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Flags, Records
from weier.methods.patches.given_edges import Forces, Punches, expansion
from weier.methods.patches.inequalities import minima_between
from weier.methods.patches.kind import (
    FIELD_ROUNDING,
    MAX_TENSION,
    MAX_THINNESS,
    NEW_CONTACT_WIDTH,
    OnContacts,
)
from weier.methods.patches.pressure_and_gap import work_of_forces
from weier.methods.patches.segments import ContactState
from weier.methods.patches.surface import CosineSeries, Extent, Sides, Surface
from weier.methods.patches.thin_gaps import densities_on_contacts
from weier.methods.punches import OFFSET, Inverse, invert_punches
from weier.theory.halfplane import punch_displacement


class Contacts:
    """Contacts: the density is the pressure, the residual the gap.

    is_slope : whether the density is the slope of a gap, which acts on pressures as dipoles 1/sin^2 do; otherwise it
        is a pressure, which acts on heights by ln|2 sin|
    derivative : order of the derivative that the density is of what acts, 0 or 1
    shift : the nodes lie at theta_i = pi (2 i + shift)/(2 N) with N = K + shift - 1
    hankel_sign, power : sign of X(i + j + shift) in the self-influence, and power of n in its sum over degrees n
    right_sign : sign of psi at the right edge where it is positive at the left one
    curvature_k_0 : b k_1 plus this times k_0 is proportional to the curvature in an interval of half-width b
        between two segments
    rounding_power : rounding changes the square of b_n in proportion to n to this power
    offset : constant added to the influence, which makes it positive definite
    increment : forcing under which the solution without load is the increment of the load
    strength_factor : ratio of the strength of the pressure at an edge to the strength of the density
    certain_strength : largest strength over b_0/a^(1/2) where b_0 is the force, F = pi a b_0/2, which contacts know
        better than their strengths, at most 8^(1/2) F/(pi a^(3/2))
    new_outside, new_within : width of a new contact or gap over the interval of overlap or tension, between segments
        and on one; the width of a gap is exact for a parabola of tension
    """

    is_slope = False
    derivative = 0
    shift = 1
    hankel_sign = 1.0
    power = -1
    right_sign = 1.0
    curvature_k_0 = -0.75  # factor for a gap in a parabola of tension
    rounding_power = 2
    offset = OFFSET
    increment = 0.0
    strength_factor = 1.0
    certain_strength = float(np.sqrt(2.0))
    new_outside = NEW_CONTACT_WIDTH
    new_within = float(np.sqrt(2.0))

    def series(self, surface: Surface) -> CosineSeries:
        """Return the heights."""
        return surface.heights

    def largest_forcing(self, maximum: float, load: float) -> float:
        """Return 0: heights are counted from the highest crest."""
        return 0.0

    def self_kernel(self, sine: Array) -> Array:
        """Return ln(2 sin theta)."""
        return np.asarray(np.log(2 * sine))

    def factor(self, period: float) -> float:
        """Return -2, the factor of ln|2 sin| in the displacement by a line force."""
        return -2.0

    def invert_punches(self, half_width: Array, middle: Array, period: float) -> Inverse:
        """Return the inverse of the influence of contacts as flat punches."""
        return invert_punches(middle, punch_displacement(half_width, period), period)

    def plane_of(self, total: float, multiplier: float, period: float) -> float:
        """Return the Lagrange multiplier."""
        return multiplier

    def as_height(self, residual: Array, half_width: Array) -> Array:
        """Return the residual, which is a height."""
        return residual

    def rounded_width(self, period: float, half_width: Array) -> float:
        """Return the period: the whole load displaces each contact."""
        return period

    def share(self, count: int) -> float:
        """Return 1: the bound takes the largest residual."""
        return 1.0

    def uniform(self, height: float) -> float:
        """Return the height: displacing the plane changes all gaps by it."""
        return height

    def contacts_of(self, extent: Extent, period: float) -> Extent:
        """Return the segments."""
        return extent

    def at_contacts(self, values: Sides) -> Sides:
        """Return values at the edges of the segments."""
        return values

    def limit_outside(self, load: float, height: float, tension: float) -> float:
        """Return the height that an overlap must exceed, in g_0."""
        return height

    @property
    def limits_within(self) -> tuple[float, float]:
        """The largest allowed tension, relative, and the largest thinness of a gap in it."""
        return MAX_TENSION, MAX_THINNESS

    def deserve_segments(self, minima: Records, room: Array, finest: float, opening: float) -> Flags:
        """Return True for each overlap."""
        return np.ones(minima.size, bool)

    def violation_height(self, width: Array) -> Array:
        """Return the opening, 2 pi b p, of a crack of half-width b under the tension p."""
        return np.pi * width

    def overlaps_and_tensions(self, minima: Records, negative: Records) -> tuple[Records, Records]:
        """Return the minima of the gap outside the segments, and the intervals of tension on them."""
        return minima, negative

    def tensions(self, contacts: Extent, found: Records, period: float) -> NDArray[np.float64]:
        """Return the intervals, which are given in the coordinate t."""
        middle, reach = 0.5 * (found["start"] + found["end"]), 0.5 * (found["end"] - found["start"])
        return np.stack([found["segment"], middle, reach], axis=1)

    def are_certain(self, tensions: Records, tail: Array, residual: float, load: float) -> Flags:
        """Return whether each tension, over the largest pressure of its contact, exceeds the last coefficients."""
        return np.asarray(tensions["relative"] < -np.maximum(tail, FIELD_ROUNDING)[tensions["segment"]])

    def pressures(
        self, state: ContactState, series: CosineSeries, punches: Punches, tangent: Forces
    ) -> tuple[OnContacts, OnContacts]:
        """Return pressure and increment from their expansions."""
        first, psi = state.segments.first_node, expansion(punches, tangent.force)
        return (
            lambda contact, t: densities_on_contacts(first, state.coefficient, contact, t, False),
            lambda contact, t: densities_on_contacts(first, psi, contact, t, True),
        )

    def singularities(self, c: NDArray[np.float64], force: Array, most: float) -> tuple[Sides, Sides]:
        """Return k_0 and k_1/2, up to a factor, at the edges of contacts with these forces on heights sum c_n T_n.

        With p sqrt(1-t^2) = sum b_n T_n, the height has the coefficients c_n = 2 pi r b_n/n.
        """
        n = np.arange(c.shape[1])
        sign = np.stack([(-1.0) ** n, np.ones(n.size)], axis=1)
        return 2 * force[:, None] + c * n @ sign, -0.5 * c * n**3 @ sign

    def elastic_energy(self, state: ContactState, surface: Surface) -> float:
        """Return <p (z - d)>/2, with heights from the maximum: on contacts z is u plus the mean gap d."""
        state_arrays = state.segments.arrays, state.segments.crest, state.coefficient
        work = work_of_forces(*state_arrays, False, surface.heights.local, 0.0)
        return 0.5 * (work / surface.heights.period + state.load * state.approach)

    def residual_scale(self, load: float, approach: float, period: float) -> float:
        """Return the indentation."""
        return approach

    def imbalance(self, state: ContactState, period: float) -> tuple[float, float]:
        """Return the deviation of the mean pressure, in p_0*, and the closure error of gaps, 0."""
        force = 0.5 * np.pi * float(state.segments.half_width @ state.coefficient[state.segments.first_node[:-1]])
        return abs(force / period - state.load), 0.0

    def violations(self, largest: float, residual: Array, roughness: Array) -> tuple[float, Array, Array]:
        """Return the largest gap, and no pressures."""
        return largest, np.empty(0), roughness

    def narrow_gaps(
        self, state: ContactState, series: CosineSeries, overlaps: Records, margin: float, uncertainty: float
    ) -> Records:
        """Return the overlaps, or search again if the gap turns out less certain than the margin."""
        return overlaps if uncertainty <= margin else minima_between(state, series, 0.0, uncertainty)


CONTACTS = Contacts()
