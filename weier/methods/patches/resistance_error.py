"""Error estimate of the resistance from edges, cracks and contacts that may be born.

It is the effect of height errors on the contacts (docs/patches.md, "The error of the resistance"; "Edges" has the
energy release of an edge). No error exceeded it in tests (docs/numerics.md, "How often stated errors hold").
"""

from __future__ import annotations

import numpy as np

from weier.kernels.arrays import Array
from weier.kernels.jit import kernel
from weier.methods.patches.certificate import gap_uncertainty
from weier.methods.patches.gaps import NEW_GAP_WIDTH
from weier.methods.patches.segments import (
    ContactState,
    Sides,
    at_contacts,
    contacts_of,
    distances_between,
    segment_strengths,
)
from weier.methods.patches.surface import TWIN_HEIGHT, CosineSeries, nearest_crests

# relative error of R by its conjugate gradients: the square of their reduction, and rounding
TANGENT_ERROR = 5e-11
# An edge of a narrow gap counts twice, since its estimate neglects the motion of the opposite edge.
EDGE_FACTOR = 2.0
NEIGHBOUR_FACTOR = 4.0
CRACK_FACTOR = 2.0  # since the width of a crack assumes parabolic tension
# If the move of an edge may exceed the half-width of its contact or gap, this many half-widths of the gap, or a chi
# of the contact, are used. For a contact, 2 a chi at both edges is four times the effect of its loss.
SMALL_EDGE_FACTOR = 2.0
EPS = float(np.finfo(float).eps)


def resistance_error(state: ContactState, series: CosineSeries) -> float:
    """Return an estimate of the error of the resistance in partial contact, in g_0/p_0*."""
    by_cracks = CRACK_FACTOR * _rise_by_cracks(state, series.period) + _error_of_cracks(state, series.period)
    by_iteration = TANGENT_ERROR * max(state.resistance, 1.0)
    # The next step would move the edges and change the resistance by the energy released.
    by_iteration += 2 * np.pi**2 / series.period * float(np.sum(state.tangent_strength**2 * np.abs(state.edge_move)))
    return by_iteration + _error_by_edges(state, series) + by_cracks + _drop_by_births(state, series)


def _rise_by_cracks(state: ContactState, period: float) -> float:
    """Return the increase of R by gaps in the intervals of tension, in g_0/p_0*.

    A gap in a parabola of tension is 2^(1/2) times as wide as the interval. One of half-width b adds pi^2 b^2 q^2/L,
    with the tangent pressure q there: B (2/r)^(1/2)/sqrt(1-t^2) for an isolated contact of edge strength B, and about
    1 if gaps are narrow.
    """
    if state.tensions.size == 0:
        return 0.0
    of, t, b = state.tensions.T
    contact = of.astype(np.int64)
    r = contacts_of(state.segments.extent, state.dual, period)[2][contact]
    B = at_contacts(state.tangent_strength, state.dual)[contact].mean(axis=1)
    q = np.maximum(B * np.sqrt(2 / (r * (1 - t**2))), 1.0)
    return float(np.pi**2 / period * np.sum((NEW_GAP_WIDTH * b * r * q) ** 2))


def _error_of_cracks(state: ContactState, period: float) -> float:
    """Return the error of the contribution of cracks to the resistance, in g_0/p_0*.

    The tension q_0 at the middle of a crack has the error k e/(2 pi r sqrt(1-t^2)), the pressure of a residual e T_k
    on its contact. With b^2 = 4 q_0/kappa, the error of the rise pi^2 b^2 q^2/L is 4 pi^2 q^2/(kappa L) times that.
    Here kappa = 2^(1/2) A/b^(3/2) and q^2 = 2 B^2/b. The nearest edge, at the distance l, changes the rise by a
    relative `NEIGHBOUR_FACTOR` (b/l)^2.
    """
    cracks, segments = state.cracks, state.segments
    if cracks.contact.size == 0:
        return 0.0
    radius = contacts_of(segments.extent, state.dual, period)[2][cracks.contact]
    modes = segments.node_count / segments.half_width
    if state.dual:
        modes = np.maximum(modes, np.roll(modes, -1))
    inside = (1 - cracks.middle) * (1 + cracks.middle)
    tension = state.height_error * modes[cracks.contact] / (2 * np.pi * np.sqrt(inside))
    b = cracks.half_width
    by_tension = 4 * np.pi**2 / period * np.sqrt(2 * b) * cracks.tangent_strength**2 / cracks.strength * tension
    by_neighbour = NEIGHBOUR_FACTOR * cracks.rise * (b / ((1 - np.abs(cracks.middle)) * radius)) ** 2
    return float(np.sum(by_tension + by_neighbour))


def _drop_by_births(state: ContactState, series: CosineSeries) -> float:
    """Return the decrease of R, in g_0/p_0*, by contacts that may be born in narrow gaps.

    A gap g with the error e may hide a contact with an overlap of at most e - g. With the half-width b of the
    overlap, the compliance of the contact per unit force is at least chi = -2 ln(pi b/L), less the relief by the
    nearest other contact, from which the force is taken. The gap closes at the rate tau = R - u' with the mean
    pressure, where the displacement u' is at least -2 L ln 2. So the contact takes the force tau/chi, which lowers
    the resistance by tau^2/(chi L).
    """
    gaps, period = state.narrow_gaps, series.period
    if gaps.size == 0:
        return 0.0
    depth = gap_uncertainty(state.height_error, series) - gaps["value"]
    half_width = np.sqrt(2 * depth / np.maximum(gaps["curvature"], depth / period**2))
    compliance = -2 * np.log(np.minimum(np.pi * half_width / period, np.exp(-0.5)))
    origin, centre, r = contacts_of(state.segments.extent, state.dual, period)
    distance = np.abs(np.sin(np.pi / period * (gaps["position"][:, None] - (origin + centre))))
    relief = -2 * np.log(np.pi * r / period) + 4 * np.log(2 * distance)
    compliance += np.minimum(relief.min(axis=1), 0.0)
    advance = state.resistance + 2 * np.log(2.0) * period
    return min(float(np.sum(advance**2 / (np.maximum(compliance, 1.0) * period))), state.resistance)


def _error_by_edges(state: ContactState, series: CosineSeries) -> float:
    """Return the error of the resistance due to its edges, in g_0/p_0*, for height errors e (`height_error`).

    An edge that advances by delta lowers the resistance by 2 pi^2 B^2 delta/L, with the tangent pressure B/s^(1/2) at
    the edge; for a narrow contact, this is the derivative of -2 L f^2 ln a. At an edge with the pressure A s^(1/2),
    height errors of e in the middle and -e at the edges add about e/(2^(1/2) pi l^(1/2) s^(1/2)), with l the smaller
    half-width of contact and gap: this is the effect of the curvature 4 e/a^2 on a Hertzian contact, and twice that
    of the tension e/(2 pi b) on a crack. The edge moves until this singularity vanishes.

    The gap between the crest of a light contact and the plane has the error 4 e, and hence the force F the error 4
    e/chi with chi = -2 ln(pi a/L), which moves both edges by 2 a e/(chi F), since a^2 is proportional to F. On crests
    other than the highest and its equals, rounding of the amplitudes adds to e. Rounding of the curvature kappa = 4
    F/a^2 moves the edges by half its relative error. The force follows from the strengths of the edges, for a Hertz
    contact: F = pi a^(3/2) k_1/sqrt(8).
    """
    L, A = series.period, np.maximum(np.abs(segment_strengths(state)), 1e-300)
    contacts = contacts_of(state.segments.extent, state.dual, L)
    crest, _ = nearest_crests(series, contacts[0] + contacts[1])
    is_lower = series.crest_offset[crest] < -TWIN_HEIGHT * series.total_amplitude
    height_error = np.where(is_lower, state.height_error + EPS * series.total_amplitude, state.height_error)
    curvature_error = EPS * float(np.abs(series.amplitude) @ series.wavenumber**2)
    A, B = at_contacts(A, state.dual), at_contacts(state.tangent_strength, state.dual)
    return 2 * np.pi**2 / L * _releases(*contacts, L, A, B, height_error, curvature_error)


@kernel
def _releases(
    origin: Array, centre: Array, r: Array, L: float, A: Sides, B: Sides, height_error: Array, curvature_error: float
) -> float:
    """Return the sum of B^2 delta over all edges, for these errors of heights and curvatures."""
    distance, total = distances_between(origin, centre, r, L), 0.0
    for j in range(r.size):
        force = np.pi / np.sqrt(8.0) * r[j] ** 1.5 * 0.5 * (A[j, 0] + A[j, 1])
        chi = max(-2 * np.log(np.pi * r[j] / L), 1.0)
        by_force = 2 * r[j] * height_error[j] / (chi * force) + curvature_error * r[j] ** 3 / (8 * force)
        for side in range(2):
            beside = 0.5 * distance[j - 1 + side]
            is_narrow, scale = beside < r[j], min(beside, r[j])
            move = np.sqrt(2.0) / np.pi * height_error[j] / (A[j, side] * np.sqrt(scale)) + by_force
            # If the move may reach this scale, the contact or gap may not exist: then the effect of its loss is
            # stated.
            if not move < scale:
                move = SMALL_EDGE_FACTOR * (beside if is_narrow else r[j] * chi)
            total += (EDGE_FACTOR if is_narrow else 1.0) * B[j, side] ** 2 * move
    return total
