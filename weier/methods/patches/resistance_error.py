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
# An edge beside a narrow gap counts twice: the edge at the other end of the gap moves as well, which the estimate of
# its own move leaves out.
EDGE_FACTOR = 2.0
NEIGHBOUR_FACTOR = 4.0
CRACK_FACTOR = 2.0  # since the width of a crack assumes a parabola of tension
# An edge that may move by as much as its contact or gap is wide counts as if it moved so many times the half-width of
# the gap, or a chi of the contact. For a contact, 2 a chi at both edges is four times what its loss changes.
SMALL_EDGE_FACTOR = 2.0
EPS = float(np.finfo(float).eps)


def resistance_error(state: ContactState, series: CosineSeries) -> float:
    """Return an estimate of the error of the resistance in partial contact, in g_0/p_0*."""
    by_cracks = CRACK_FACTOR * _rise_by_cracks(state, series.period) + _error_of_cracks(state, series.period)
    by_iteration = TANGENT_ERROR * max(state.resistance, 1.0)
    # One more step would have moved the edges, which changes the resistance by the energy that these release.
    by_iteration += 2 * np.pi**2 / series.period * float(np.sum(state.tangent_strength**2 * np.abs(state.edge_move)))
    return by_iteration + _error_by_edges(state, series) + by_cracks + _drop_by_births(state, series)


def _rise_by_cracks(state: ContactState, period: float) -> float:
    """Return the increase of R by gaps in the intervals of tension, in g_0/p_0*.

    A gap in a parabola of tension is 2^(1/2) times as wide as the interval. One of half-width b adds pi^2 b^2 q^2/L,
    where q is the tangent pressure there. That of an isolated contact is B (2/r)^(1/2)/sqrt(1-t^2), with the strength
    B at its edges, and where gaps are narrow it is about 1.
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
    """Return the error of what cracks add to the resistance, in g_0/p_0*.

    The tension q_0 at the middle of a crack is known to k e/(2 pi r sqrt(1-t^2)), which is the pressure of a residual
    e T_k on its contact. With b^2 = 4 q_0/kappa, its rise pi^2 b^2 q^2/L is off by 4 pi^2 q^2/(kappa L) of that. Here
    kappa = 2^(1/2) A/b^(3/2) and q^2 = 2 B^2/b. The nearest edge, at the distance l, changes the rise by some
    `NEIGHBOUR_FACTOR` (b/l)^2 of itself.
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

    A gap g that is known to e leaves space for a contact that penetrates by e - g at most. Where the plane cuts the
    crest at the half-width b, the contact gives way by chi = -2 ln(pi b/L) or more for each unit of force, less the
    relief by the nearest other contact, from which the force is taken. The plane nears the crest by tau = R - u' for
    each unit of mean pressure, where the displacement u' of the crest is nowhere below -2 L ln 2. So the contact
    takes the force tau/chi, which lowers the resistance by tau^2/(chi L).
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
    """Return the error of the resistance by its edges, in g_0/p_0*, where heights are off by e, the `height_error`.

    An edge that moves out by delta lowers the resistance by 2 pi^2 B^2 delta/L, where the tangent pressure is
    B/s^(1/2) beside it: for a narrow contact, this is the derivative of -2 L f^2 ln a. Beside an edge where the
    pressure is A s^(1/2), heights that are off by e in the middle and by -e at the edges add about
    e/(2^(1/2) pi l^(1/2) s^(1/2)), with l the half-width of the contact or of the gap, whichever is less: so much
    does the curvature 4 e/a^2 add to Hertz's contact, and half as much does the tension e/(2 pi b) to a crack. The
    edge moves until that is gone.

    The gap between the crest of a light contact and the plane is known to 4 e, and so the force F to 4 e/chi with
    chi = -2 ln(pi a/L), which moves both edges by 2 a e/(chi F), since a^2 is in proportion to F. Crests other than
    the highest and its twins are known as gaps are, to rounding of the amplitudes, which adds to e. Curvatures
    kappa = 4 F/a^2 are known to rounding of the waves' curvatures, which moves the edges by half as much, relative to
    a. The force follows from the strengths of the edges, for a Hertz contact: F = pi a^(3/2) k_1/sqrt(8).
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
    """Return the sum of B^2 delta over all edges, where heights and curvatures are off by these."""
    distance, total = distances_between(origin, centre, r, L), 0.0
    for j in range(r.size):
        force = np.pi / np.sqrt(8.0) * r[j] ** 1.5 * 0.5 * (A[j, 0] + A[j, 1])
        chi = max(-2 * np.log(np.pi * r[j] / L), 1.0)
        by_force = 2 * r[j] * height_error[j] / (chi * force) + curvature_error * r[j] ** 3 / (8 * force)
        for side in range(2):
            beside = 0.5 * distance[j - 1 + side]
            is_narrow, scale = beside < r[j], min(beside, r[j])
            move = np.sqrt(2.0) / np.pi * height_error[j] / (A[j, side] * np.sqrt(scale)) + by_force
            # An edge that may move by its scale may be that of no contact or of no gap: then the whole is stated.
            if not move < scale:
                move = SMALL_EDGE_FACTOR * (beside if is_narrow else r[j] * chi)
            total += (EDGE_FACTOR if is_narrow else 1.0) * B[j, side] ** 2 * move
    return total
