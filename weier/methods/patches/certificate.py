"""Certificate of a state: residual at other points, bound on the compliance, error estimate of the resistance.

docs/patches.md, "The bound on the compliance" and "The error of the resistance", derives the formulas.
`contact_residual` samples the residual, `certify` rejects large violations, `error_bound` bounds the error of h, and
`stated_errors` are the effects of height errors on R and the contact fraction, which no error exceeded in tests
(docs/numerics.md, "How often stated errors hold").
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Indices, Records
from weier.kernels.jit import in_any_order, kernel
from weier.methods.error_model import COMPLIANCE_ROUNDING
from weier.methods.errors import ConvergenceError
from weier.methods.patches.edge_iteration import SETTLED_MOVE
from weier.methods.patches.kind import EPS, FIELD_ROUNDING, MAX_TOLERANCE
from weier.methods.patches.pressure_and_gap import residuals_in_order
from weier.methods.patches.segments import ContactState, SegmentArrays, edge_strengths
from weier.methods.patches.surface import (
    TWIN_HEIGHT,
    CosineSeries,
    Extent,
    Sides,
    distances_between,
    nearest_crest,
)
from weier.theory.halfplane import Number

MAX_RESIDUAL = 100  # largest accepted residual over the relative tolerance, for loose targets too
# Between N samples a residual, of the degree n = K + 2 on K nodes, is at most 1/cos(pi n/2N) times as large
# (docs/patches.md): twice, with N = 3 n/2 or more.
SAMPLED_FACTOR = 2.0
TANGENT_ERROR = MAX_TOLERANCE**2 / 2  # of R over R, an energy: half the square of the largest reduction of residuals
# Estimates of first order count twice: the next move of an edge that has not settled; an edge of a narrow gap, which
# neglects the motion of the opposite edge; a missing gap, which assumes parabolic tension, and the loss of one; and
# the interaction of a crack with its neighbours. No error exceeded them (docs/numerics.md, "How often stated errors
# hold"): estimated, not derived.
SAFETY_FACTOR = 2.0


def error_bound(
    indentation: float, load: float, missing: float, gap: float, pressure: Array, width: Array, period: float
) -> float:
    """Return a bound on the error of the compliance, in g_0, from the violations of the contact conditions.

    indentation : of the state from first contact, or an upper bound on it, in g_0
    load : required mean pressure, in p_0*
    missing : deviation of the state's mean pressure from it, plus further pressures at unknown positions, in p_0*
    gap : the largest gap on a contact or overlap anywhere, plus displacements by removed pressures, in g_0
    pressure, width : bounds on pressures in gaps or tensions, in p_0*, each on a separate interval of a width, in
        lambda_0, shape (violations,); the number of the largest that are removed minimises the bound
    """
    if pressure.size > 1:
        order = np.argsort(-pressure)
        pressure, width = pressure[order], width[order]
    return _least_bound(indentation, load, missing, gap, pressure, width, period)


@kernel
def _least_bound(
    indentation: float, load: float, missing: float, gap: float, pressure: Array, width: Array, period: float
) -> float:
    """Return the bound of `error_bound` with decreasing pressures."""
    bound, force = np.inf, 0.0
    for removed in range(pressure.size + 1):
        left = pressure[removed] if removed < pressure.size else 0.0
        eps = gap + _displacement(pressure[0], force, period) if removed > 0 else gap
        sigma = missing + left + force / period
        if sigma < load:
            bound = min(bound, eps + sigma * (indentation + eps) / (load - sigma))
        if removed < pressure.size:
            force += left * width[removed]
    return bound


def largest_displacement(pressure: Number, force: Number, period: float) -> Number:
    """Return a bound on the displacement, of mean 0, by pressures of at most `pressure` with a total force."""
    half_period_of_width = 0.5 * period * pressure / np.maximum(force, 1e-280)  # which may be 0
    return 2 * force * (1 + np.log(np.maximum(half_period_of_width, 2.0)))


_displacement = kernel(largest_displacement)


def contact_residual(state: ContactState, series: CosineSeries) -> NDArray[np.float64]:
    """Return the maximum of the residual on each segment, the width over which this has its force, and its roughness.

    The residual is the gap on a contact, or the pressure in a gap; the roughness is sum n |c_n| of its
    coefficients in T_n, in its unit. At some points, the sums are direct (`potential`).
    """
    segments = state.segments
    samples = residuals_in_order(state, series, *sample_points(segments.arrays, segments.crest))
    return _sizes(segments.first_node, segments.half_width, samples)


@kernel
def _sizes(first_node: Indices, half_width: Array, samples: Array) -> NDArray[np.float64]:
    """Return the largest sample on each segment, the width for `SAMPLED_FACTOR` times it, and the roughness."""
    sizes, start = np.empty((3, half_width.size)), 0
    for j in range(half_width.size):
        nodes = first_node[j + 1] - first_node[j]
        count, largest, force = 2 * (nodes + 1), 0.0, 0.0
        for i in range(count):
            size = abs(samples[start + i])
            largest, force = max(largest, size), force + size * np.sin((i + 0.5) * np.pi / count)
        mean = np.pi / (count - nodes - 3) * force
        sizes[0, j] = largest if force < np.inf else np.nan
        sizes[1, j] = half_width[j] * min(mean / max(SAMPLED_FACTOR * largest, 1e-300), 2.0)
        sizes[2, j], start = _roughness(samples[start : start + count]), start + count
    return sizes


@in_any_order
def _roughness(samples: Array) -> float:
    """Return sum n |c_n| of sum c_n T_n through samples at the zeros of a Chebyshev polynomial.

    The compiler vectorises the recurrence of the polynomials at all samples.
    """
    count, total = samples.size, 0.0
    t, before, value = np.empty((3, count))
    for i in range(count):
        t[i] = value[i] = np.cos((i + 0.5) * np.pi / count)
        before[i] = 1.0
    for n in range(1, count):
        coefficient = 0.0
        for i in range(count):
            coefficient += samples[i] * value[i]
            before[i], value[i] = value[i], 2 * t[i] * value[i] - before[i]
        total += n * abs(coefficient)
    return 2 / count * total


@kernel
def sample_points(segments: SegmentArrays, crest: Indices) -> tuple[Indices, Array, Array]:
    """Return crests and origins of the segments of all samples, and the samples, counted from the origins.

    They are the 2 K + 2 zeros of a Chebyshev polynomial on each segment, as far from its K nodes as possible, and
    enough for `SAMPLED_FACTOR` to hold.
    """
    origin, centre, half_width, first_node = segments
    y, last = np.empty(2 * (first_node[-1] + centre.size)), 0
    start, of = np.empty(y.size), np.empty(y.size, np.int64)
    for j in range(centre.size):
        count = 2 * (first_node[j + 1] - first_node[j] + 1)
        for i in range(count):
            y[last] = centre[j] - half_width[j] * np.cos((i + 0.5) * np.pi / count)
            start[last], of[last] = origin[j], crest[j]
            last += 1
    return of, start, y


def certify(
    state: ContactState,
    residual: Array,
    residual_width: Array,
    roughness: Array,
    overlaps: Records,
    tensions: Records,
    series: CosineSeries,
    total_amplitude: float,
    tolerance: float,
    margin: float,
) -> ContactState:
    """Return the state with its largest violation, in g_0, the bound on its error, and its narrow gaps.

    residual, residual_width, roughness : arrays over the segments, as `contact_residual` returns them
    overlaps, tensions : negative minima or intervals of gap and pressure, without those that are thin gaps; minima of
        the gap between contacts are those below the margin
    tolerance : relative tolerance; the residual may be `MAX_RESIDUAL` times as large
    margin : limit below which minima are given; they are searched again if the error of the gaps turns out larger

    ConvergenceError is raised if a violation is larger, or if the contacts do not carry the load.
    """
    kind, period = state.kind, series.period
    missing, closure = kind.imbalance(state, period)
    largest = float(kind.as_height(residual, state.segments.half_width).max())
    worst = max(largest, closure)
    check_violation(state, worst, missing, period, tolerance)
    gap, pressure, roughness = kind.violations(SAMPLED_FACTOR * largest, SAMPLED_FACTOR * residual, roughness)
    width = residual_width[: pressure.size]
    # A residual pressure sigma on a width W displaces the surface by about 2 sigma W (`error_bound`).
    displacement = 2 * SAMPLED_FACTOR * largest if kind.is_slope else 0.0
    gap = max(gap, closure, *(-overlaps["value"]).tolist())
    if tensions.size > 0:
        contacts = kind.contacts_of(state.segments.extent, period)
        intervals = kind.tensions(contacts, tensions, period)
        contact, middle, reach = intervals.T
        pressure = np.append(pressure, -tensions["value"])
        width = np.append(width, 2 * reach * contacts[2][contact.astype(np.int64)])
        # The move of an edge may remove an interval that reaches it, up to rounding of its ends.
        state = state._replace(tensions=intervals[np.abs(middle) + reach < 1 - 4 * EPS])
    moved, beyond, unsure = crack_effect(state, period)
    error = unsure + error_bound(
        state.indentation(total_amplitude), state.load, missing + beyond, gap + moved, pressure, width, period
    )
    height_error = error + displacement
    uncertainty = gap_uncertainty(height_error, total_amplitude)
    minima = kind.narrow_gaps(state, series, overlaps, margin, uncertainty)
    narrow = minima[minima["value"] < uncertainty] if minima.size > 0 else minima
    return state._replace(
        residual=worst, error=error, height_error=height_error, roughness=roughness, narrow_gaps=narrow
    )


def crack_effect(state: ContactState, period: float) -> tuple[float, float, float]:
    """Return displacement and mean pressure of the tension outside thin gaps, and the uncertainty of the mean gap."""
    cracks = state.cracks
    if cracks.contact.size == 0:
        return 0.0, 0.0, 0.0
    origin, centre, r = state.kind.contacts_of(state.segments.extent, period)
    of, middle = cracks.contact, origin + centre
    position = (middle[of] + cracks.middle * r[of])[:, None]
    # The distance from each crack to the right end of each contact, and to the left end of the next one.
    start = np.mod(middle + r - position, period)
    end = start + distances_between(origin, centre, r, period)
    scale = cracks.volume / period**2
    nearest = np.minimum(np.minimum(start.min(axis=1), period - end.max(axis=1)), 0.5 * period)
    tension = 0.5 * scale / np.sin(np.pi / period * nearest) ** 2
    cot = 1 / np.tan(np.pi / period * start) - 1 / np.tan(np.pi / period * end)
    force = 0.5 * period / np.pi * scale * cot.sum(axis=1)
    b, apart = cracks.half_width, np.abs(position - position.T)
    apart = np.minimum(apart, period - apart) - b[:, None] - b
    np.fill_diagonal(apart, 0.5 * period)
    inside = 0.5 * scale[:, None] / np.sin(np.pi / period * apart) ** 2
    np.fill_diagonal(inside, 0.0)
    tension, force = np.maximum(tension, inside.max(axis=1)), force + 2 * inside @ b
    moved = float(largest_displacement(tension, force, period).sum())
    return moved, float(force.sum()) / period, float(np.abs(cracks.lift - cracks.volume / period).sum())


def gap_uncertainty(error: float, height: float) -> float:
    """Return the uncertainty of gaps for a height error, both in g_0, and the total amplitude, which is rounded."""
    return 4 * error + FIELD_ROUNDING * height


def check_violation(state: ContactState, residual: float, missing: float, period: float, tolerance: float) -> None:
    """Raise ConvergenceError if the residual is too large, or a pressure is missing from the load."""
    scale = state.kind.residual_scale(state.load, state.approach, period)
    relative = residual / scale if scale > 0 else np.inf  # rounding has left no digit of the indentation
    relative = max(relative, missing / state.load)
    if not relative <= MAX_RESIDUAL * tolerance:
        raise ConvergenceError(
            f"the contacts under the mean pressure {state.load:.6g} p_0* violate their conditions by {relative:.1e}, "
            f"more than {MAX_RESIDUAL * tolerance:.1e}; take a larger tolerance or boundary elements",
            relative,
        )


Effect = tuple[float, float]  # effects on the resistance, in g_0/p_0*, and on the length in contact, in lambda_0


def stated_errors(state: ContactState, series: CosineSeries) -> Effect:
    """Return estimates of the errors of the resistance, in g_0/p_0*, and the contact fraction, in partial contact."""
    effects = (
        (TANGENT_ERROR * max(state.resistance, 1.0), 0.0),
        _next_moves(state.segments.half_width, state.edge_move.T, state.tangent_strength, series.period),
        _error_by_edges(state, series),
        _crack_error(state, series.period),
        _missing_cracks(state, series.period),
        _missing_contacts(state, series),
    )
    resistance, length = map(sum, zip(*effects, strict=True))
    return resistance, length / series.period


@kernel
def _next_moves(half_width: Array, edge_move: NDArray[np.float64], B: Sides, period: float) -> Effect:
    """Return the effect of the next step, which moves the edges; while these have not settled, others follow it."""
    release, length = 0.0, 0.0
    for j in range(half_width.size):
        for side in range(2):
            move = abs(edge_move[side, j])
            move *= SAFETY_FACTOR if move > SETTLED_MOVE * half_width[j] else 1.0
            release, length = release + B[j, side] ** 2 * move, length + move
    return 2 * np.pi**2 / period * release, length


def _missing_cracks(state: ContactState, period: float) -> Effect:
    """Return the effect of gaps in the intervals of tension ("Missing gaps"), times `SAFETY_FACTOR`."""
    if state.tensions.size == 0:
        return 0.0, 0.0
    of, t, b = state.tensions.T
    contact = of.astype(np.int64)
    r = state.kind.contacts_of(state.segments.extent, period)[2][contact]
    B = state.kind.at_contacts(state.tangent_strength)[contact].mean(axis=1)
    q = np.maximum(B * np.sqrt(2 / (r * (1 - t**2))), 1.0)
    width = np.sqrt(2.0) * b * r
    return SAFETY_FACTOR * float(np.pi**2 / period * np.sum((width * q) ** 2)), SAFETY_FACTOR * float(2 * width.sum())


def _crack_error(state: ContactState, period: float) -> Effect:
    """Return the error of the effect of cracks ("Thin gaps"); `near` is that of the nearest edge, 4 (b/l)^2."""
    cracks, segments = state.cracks, state.segments
    if cracks.contact.size == 0:
        return 0.0, 0.0
    radius = state.kind.contacts_of(segments.extent, period)[2][cracks.contact]
    modes = segments.node_count / segments.half_width
    modes = state.kind.at_contacts(np.stack([modes, modes], axis=1)).max(axis=1)
    inside = (1 - cracks.middle) * (1 + cracks.middle)
    tension = state.height_error * modes[cracks.contact] / (2 * np.pi * np.sqrt(inside))
    b = cracks.half_width
    by_tension = 4 * np.pi**2 / period * np.sqrt(2 * b) * cracks.tangent_strength**2 / cracks.strength * tension
    near = 2 * SAFETY_FACTOR * (b / ((1 - np.abs(cracks.middle)) * radius)) ** 2  # relative change of the rise
    width = 2 * np.sqrt(2 * b) / cracks.strength * tension + b * near
    return float(np.sum(by_tension + cracks.rise * near)), float(width.sum())


def _missing_contacts(state: ContactState, series: CosineSeries) -> Effect:
    """Return the effect of contacts that may be born in narrow gaps ("Births")."""
    gaps, period = state.narrow_gaps, series.period
    if gaps.size == 0:
        return 0.0, 0.0
    depth = gap_uncertainty(state.height_error, series.total_amplitude) - gaps["value"]
    half_width = np.sqrt(2 * depth / np.maximum(gaps["curvature"], depth / period**2))
    compliance = -2 * np.log(np.pi * half_width / period)
    origin, centre, r = state.kind.contacts_of(state.segments.extent, period)
    distance = np.abs(np.sin(np.pi / period * (gaps["position"][:, None] - (origin + centre))))
    relief = -2 * np.log(np.pi * r / period) + 4 * np.log(2 * distance)
    compliance += np.minimum(relief.min(axis=1), 0.0)
    advance = state.resistance + 2 * np.log(2.0) * period
    drop = float(np.sum(advance**2 / (np.maximum(compliance, 1.0) * period)))
    return min(drop, state.resistance), 2 * float(half_width.sum())


def _error_by_edges(state: ContactState, series: CosineSeries) -> Effect:
    """Return the effect of errors of the edges by height errors (`height_error`).

    On crests other than the highest and its equals, rounding of amplitudes and displacements adds to them.
    """
    segments, kind, period = state.segments, state.kind, series.period
    rounding = EPS * series.total_amplitude + COMPLIANCE_ROUNDING * state.load * period
    strengths = kind.shift - 1, kind.strength_factor, kind.certain_strength, state.tangent_strength
    crests = series.crest_position, series.crest_offset, -TWIN_HEIGHT * series.total_amplitude
    errors = state.height_error, rounding, state.roughness, EPS * series.largest_curvature
    contacts = kind.contacts_of(segments.extent, period)
    return _effect_of_edges(segments.arrays, state.coefficient, contacts, period, strengths, crests, errors)


@kernel
def _effect_of_edges(
    segments: SegmentArrays,
    coefficient: Array,
    contacts: Extent,
    L: float,
    strengths: tuple[int, float, float, Sides],
    crests: tuple[Array, Array, float],
    errors: tuple[float, float, Array, float],
) -> Effect:
    """Return the effect of all edges by errors of heights and curvatures; lower crests have rounding in addition."""
    (_, _, half_width, first_node), (origin, centre, r) = segments, contacts
    (after, factor, certain, tangent), (position, offset, twin) = strengths, crests
    height_error, rounding, roughness, curvature_error = errors
    distance, inside = (
        distances_between(origin, centre, r, L),
        edge_strengths(first_node, half_width, coefficient, 1.0),
    )
    A, B, release, length = np.empty(2), np.empty(2), 0.0, 0.0
    for j in range(r.size):
        for side in range(2):
            at = 2 * j + side + after  # contact j follows gap j
            k, end = at // 2 % r.size, at % 2
            most = certain * max(coefficient[first_node[j]], 1e-300) / np.sqrt(r[j])  # by the force
            A[side], B[side] = min(max(factor * abs(inside[k, end]), 1e-300), most), tangent[k, end]
        crest, _ = nearest_crest(position, L, origin[j] + centre[j])
        error = height_error + (rounding if offset[crest] < twin else 0.0)
        force = np.pi / np.sqrt(8.0) * r[j] ** 1.5 * 0.5 * (A[0] + A[1])
        chi = max(-2 * np.log(np.pi * r[j] / L), 1.0)
        by_force = 2 * r[j] * error / (chi * force) + curvature_error * r[j] ** 3 / (8 * force)
        for side in range(2):
            beside = 0.5 * distance[j - 1 + side]
            is_narrow, scale = beside < r[j], min(beside, r[j])
            height = error / np.sqrt(scale) + 0.5 * roughness[j] / np.sqrt(r[j])
            move = np.sqrt(2.0) / np.pi * height / A[side] + by_force
            # If the move may reach this scale, the contact or gap may not exist. The loss of a gap changes
            # R by less than a move of 2 b. The contact lowers R by f^2 chi L, and by chi/chi' times
            # as much with the largest force.
            if not move < scale:
                more = max(chi - np.log(1 + 4 * error / (chi * force)), 1.0)  # chi' of the largest contact
                move = SAFETY_FACTOR * beside if is_narrow else 0.5 * r[j] * chi * max(1.0, chi / more - 1)
            move *= SAFETY_FACTOR if is_narrow else 1.0
            release += B[side] ** 2 * move
            length += move
    return 2 * np.pi**2 / L * release, length
