"""Gaps as segments: cracks with given edges in the tension of full contact (docs/patches.md, "Given edges").

At the zeros of U_K, f_i = r w_i omega_i with the gap sqrt(1-t^2) omega and the weights w_i of Gauss quadrature. With
C the sum over all nodes of -1/(2 L^2 sin^2(pi (x_i - x_j)/L)), positive definite,

    C f = the tension of full contact in all gaps,   d = sum f/L.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Flags, Indices, Records
from weier.methods.patches.given_edges import Forces, Punches, force_field
from weier.methods.patches.inequalities import gap_minima
from weier.methods.patches.kind import (
    FIELD_ROUNDING,
    MAX_THINNESS,
    NEW_CONTACT_WIDTH,
    OnContacts,
)
from weier.methods.patches.pressure_and_gap import complementary_residuals, work_of_forces
from weier.methods.patches.segments import ContactState
from weier.methods.patches.surface import CosineSeries, Extent, Sides, Surface, intervals_between, nearest_crests
from weier.methods.patches.thin_gaps import gap_singularities


class Gaps:
    """Gaps: the density is the slope of the gap, the residual the pressure; `Contacts` explains the fields."""

    is_slope = True
    derivative = 1
    shift = 2
    hankel_sign = -1.0
    power = 1
    right_sign = -1.0  # the slope is negative where a gap closes
    curvature_k_0 = 0.25  # factor for a contact between gaps
    rounding_power = 0
    offset = 0.0
    increment = 1.0
    strength_factor = 0.5 / np.pi  # strength ratio at an edge: pressure outside, slope of the gap inside
    certain_strength = np.inf
    new_outside = float(np.sqrt(2.0))
    new_within = NEW_CONTACT_WIDTH
    limits_within = 0.0, 0.0  # overlap is never allowed, and gaps contain no thin gaps

    def series(self, surface: Surface) -> CosineSeries:
        """Return the tensions of full contact."""
        return surface.tensions

    def largest_forcing(self, maximum: float, load: float) -> float:
        """Return the largest tension under the load."""
        return maximum - load

    def self_kernel(self, sine: Array) -> Array:
        """Return 1/(4 sin^2 theta)."""
        return np.asarray(0.25 / sine**2)

    def factor(self, period: float) -> float:
        """Return the factor of 1/sin^2 in the finite-part kernel -1/(2 L^2 sin^2)."""
        return -0.5 / period**2

    def invert_punches(self, half_width: Array, middle: Array, period: float) -> None:
        """Return None: gaps carry no load."""

    def plane_of(self, total: float, multiplier: float, period: float) -> float:
        """Return the mean gap."""
        return total / period

    def as_height(self, residual: Array, half_width: Array) -> Array:
        """Return pressure times width, a displacement."""
        return 2 * half_width * residual

    def rounded_width(self, period: float, half_width: Array) -> float:
        """Return the width of the widest gap."""
        return 2 * float(half_width.max())

    def share(self, count: int) -> float:
        """Return one over the count: the bound is a sum over all gaps."""
        return 1 / count

    def uniform(self, height: float) -> float:
        """Return 0: displacing the plane changes no pressure."""
        return 0.0

    def contacts_of(self, extent: Extent, period: float) -> Extent:
        """Return the intervals on the right of gaps."""
        return intervals_between(extent, period)

    def at_contacts(self, values: Sides) -> Sides:
        """Return values at the edges of contacts; contact j follows gap j."""
        in_order = values.ravel()
        return np.concatenate([in_order[1:], in_order[:1]]).reshape(-1, 2)

    def limit_outside(self, load: float, height: float, tension: float) -> float:
        """Return the pressure that a tension must exceed, in p_0*."""
        return tension * load

    def deserve_segments(self, minima: Records, room: Array, finest: float, opening: float) -> Flags:
        """Return whether each gap opens enough and is not thin relative to its distances and the finest wave."""
        b = np.sqrt(-4 * minima["value"] / np.maximum(minima["curvature"], 1e-300))
        is_wide = b > MAX_THINNESS * np.minimum(room, 1 / finest)
        return np.asarray(is_wide & (-2 * np.pi * b * minima["value"] > opening))

    def violation_height(self, width: Array) -> Array:
        """Return 1: a gap is a height."""
        return np.ones(width.size)

    def overlaps_and_tensions(self, minima: Records, negative: Records) -> tuple[Records, Records]:
        """Return the intervals of overlap on the segments, and the minima of the pressure outside them."""
        return negative, minima

    def tensions(self, contacts: Extent, found: Records, period: float) -> NDArray[np.float64]:
        """Return the intervals around minima of the pressure, each approximated by a parabola."""
        origin, centre, r = (values[found["interval"]] for values in contacts)
        middle = (found["position"] - (origin + centre)) / r
        # Between adjacent crests the curvature by differences may vanish: the floor keeps the width finite.
        reach = np.sqrt(-2 * found["value"] / np.maximum(found["curvature"], -found["value"] / period**2)) / r
        return np.stack([found["interval"], middle, reach], axis=1)

    def are_certain(self, tensions: Records, tail: Array, residual: float, load: float) -> Flags:
        """Return which minima of the pressure are below minus the residual, a pressure as well."""
        return np.asarray((tensions["value"] < -max(residual, FIELD_ROUNDING * load)) & (tensions["curvature"] > 0))

    def pressures(
        self, state: ContactState, series: CosineSeries, punches: Punches, tangent: Forces
    ) -> tuple[OnContacts, OnContacts]:
        """Return pressure and increment from the field of the gaps."""
        origin, middle, radius = self.contacts_of(state.segments.extent, series.period)

        def positions(contact: Indices, t: NDArray[np.float64]) -> Array:
            return np.asarray(((origin + middle)[contact][:, None] + radius[contact][:, None] * t).ravel())

        def pressure(contact: Indices, t: NDArray[np.float64]) -> NDArray[np.float64]:
            x = positions(contact, t)
            return complementary_residuals(state, series, *nearest_crests(series, x)).reshape(t.shape)

        def increment(contact: Indices, t: NDArray[np.float64]) -> NDArray[np.float64]:
            x = positions(contact, t)
            order, q = np.argsort(x), np.empty(x.size)
            q[order] = 1 - force_field(punches, tangent.force, x[order])
            return q.reshape(t.shape)

        return pressure, increment

    def singularities(self, c: NDArray[np.float64], tension: Array, most: float) -> tuple[Sides, Sides]:
        """Return k_0 and k_1/2, up to a factor, at the edges of gaps in tensions sum c_n T_n below the largest."""
        pressure = -c
        pressure[:, 0] -= most
        return gap_singularities(pressure)

    def elastic_energy(self, state: ContactState, surface: Surface) -> float:
        """Return the energy of full contact minus <g (p + S)>/2, with the mean pressure p and the tension S."""
        state_arrays, series = (state.segments.arrays, state.segments.crest, state.coefficient), surface.tensions
        work = work_of_forces(*state_arrays, True, series.local, state.load + series.maximum)
        return surface.full_contact_energy - 0.5 * work / series.period

    def residual_scale(self, load: float, approach: float, period: float) -> float:
        """Return the order of the displacement by the load."""
        return load * period

    def imbalance(self, state: ContactState, period: float) -> tuple[float, float]:
        """Return the deviation of the mean pressure, 0, and the closure error of all gaps, in g_0."""
        mean = np.abs(state.coefficient[state.segments.first_node[:-1]])
        return 0.0, 0.5 * np.pi * float(state.segments.half_width @ mean)

    def violations(self, largest: float, residual: Array, roughness: Array) -> tuple[float, Array, Array]:
        """Return the pressures; their edges respond to the lowest two coefficients only (docs/patches.md)."""
        return 0.0, residual, np.zeros(residual.size)

    def narrow_gaps(
        self, state: ContactState, series: CosineSeries, overlaps: Records, margin: float, uncertainty: float
    ) -> Records:
        """Return the minima of the gap on segments."""
        return gap_minima(state)


GAPS = Gaps()
