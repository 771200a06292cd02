"""The state of contact under one load, and from it pressure and gap anywhere, exact up to the edges.

A point is given by an origin and the distance y from it, as in `surface`, so that points near a crest keep all their
digits.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.jit import kernel
from weier.methods.patches.chebyshev import (
    cauchy_integral,
    cauchy_slope,
    evaluate_expansion,
    log_integral,
    partial_integral,
)
from weier.methods.patches.pair_sums import make_tree, potential, take_logarithms
from weier.methods.patches.segments import Iterate, Segments
from weier.methods.patches.surface import CosineSeries, evaluate_series, nearest_crest, nearest_crests

# Fast sums take less time than each segment at each point from 50 to 90 points on, for 39, 254 and 1342 contacts, and
# from 250 on among 71 gaps: the time of their tree and that of one point both grow as the nodes do.
MIN_SUM_POINTS = 100
MIN_SUM_SEGMENTS = 40  # fewer cost little either way: 13 gaps at 1000 points 1.1 ms, and 0.8 ms by sums
POTENTIAL, CAUCHY, SLOPE = 0, 1, 2  # which integral over the density: of ln|2 sin|, of cot, and the latter's slope
MIN_ANGLE = 0.1  # between x and a segment, from the angles of both: 2e-15 of it is rounding
# Nearer to a pole, the kernels less that pole come from their power series in (angle/pi)^2: with z the zeta function,
# cot(a) - 1/a = -(2/pi) sum z(2k) (a/pi)^(2k-1), whose integral is ln(sin(a)/a). What is left out is below 1e-16.
MAX_POLE_ANGLE = 0.5
_ORDER = np.arange(1, 11)
_ZETA = np.array(
    [
        float(np.sum(np.arange(1.0, 1e3) ** (-2.0 * k))) if k > 2 else np.pi ** (2 * k) / (6.0, 90.0)[k - 1]
        for k in _ORDER
    ]
)
POLE_FREE_SERIES = np.stack([-_ZETA / _ORDER, -2 / np.pi * _ZETA, -2 / np.pi**2 * _ZETA * (2 * _ORDER - 1)])


class ContactState(NamedTuple):
    """The state under one mean pressure: contacts with their pressure, or gaps with their slope (dual).

    dual : whether the segments are the gaps
    load : mean pressure, in p_0*
    approach : indentation from first contact or, dual, the mean gap with its sign turned, in g_0
    segments : the contacts or, dual, the gaps
    phi : at the nodes, shape (nodes,); sqrt(1-t^2) phi is the pressure, in p_0*, or the slope of the gap, in
        g_0/lambda_0
    coefficient : of phi in U_k, segment by segment, shape (nodes,)
    sensitivity : derivatives of all unknowns in the mean pressure, in the order and the units of `collocation`,
        shape (nodes + 2 segments + 1,); the last is the resistance, in g_0/p_0*
    residual : largest violation of a contact condition, in g_0; NaN before it has been computed
    error : a bound on that of the approach by these violations, in g_0; NaN before it has been computed
    """

    dual: bool
    load: float
    approach: float
    segments: Segments
    phi: Array
    coefficient: Array
    sensitivity: Array
    residual: float
    error: float

    @property
    def iterate(self) -> Iterate:
        """What an iteration may start from."""
        return Iterate(self.dual, self.segments, self.phi, self.approach)


@kernel
def local_coordinate(segments: Segments, j: int, period: float, origin: float, y: float) -> float:
    """The coordinate t, within -1..1 on segment j, of that image of origin + y which is nearest to its centre."""
    d = origin - segments.origin[j] + (y - segments.centre[j])
    return (d - period * np.rint(d / period)) / segments.half_width[j]


@kernel
def density_integral(state: ContactState, period: float, origin: float, y: float, which: int) -> float:
    """At x = origin + y, any x: int rho ln|2 sin(pi (x-s)/L)| ds, int rho cot(pi (x-s)/L) ds, or its derivative.

    The derivative, of the cot integral, is in x. Far from a segment, that is quadrature. There sin(pi (x-s)/L)
    follows by the addition theorem: from the angle between x and the segment's centre where that is small, so that
    no digit of a short distance is lost, and else from the angles of both.
    """
    segments, total, factor = state.segments, 0.0, np.pi / period
    sine_of_x, cosine_of_x = np.sin(factor * (origin + y)), np.cos(factor * (origin + y))
    distance = np.ones(state.phi.size if which == POTENTIAL else 0)
    for j in range(segments.centre.size):
        t = local_coordinate(segments, j, period, origin, y)
        if abs(t) <= segments.far_field[j]:
            total += _near_field(state, j, t, period, which)
            continue
        angle = factor * segments.half_width[j] * t
        if abs(angle) < MIN_ANGLE:
            s, c = np.sin(angle), np.cos(angle)
        else:
            s = sine_of_x * segments.centre_cosine[j] - cosine_of_x * segments.centre_sine[j]
            c = cosine_of_x * segments.centre_cosine[j] + sine_of_x * segments.centre_sine[j]
        here, there = 0.0, slice(segments.first_node[j], segments.first_node[j + 1])
        sine, cosine = segments.sine[there], segments.cosine[there]
        weight, phi = segments.weight[there], state.phi[there]
        if which == POTENTIAL:
            away = distance[there]
            for q in range(away.size):
                away[q] = abs(2 * (s * cosine[q] - c * sine[q]))
        elif which == CAUCHY:
            for q in range(phi.size):
                cot = (c * cosine[q] + s * sine[q]) / (s * cosine[q] - c * sine[q])
                here += weight[q] * phi[q] * cot
        else:
            for q in range(phi.size):
                here -= factor * weight[q] * phi[q] / (s * cosine[q] - c * sine[q]) ** 2
        total += segments.half_width[j] * here
    if which == POTENTIAL:
        total += _weighted_logarithms(state, distance)
    return total


@kernel
def _weighted_logarithms(state: ContactState, distance: Array) -> float:
    """The sum over all nodes of the weight times the density times ln|2 sin|; a distance of 1 counts for nothing."""
    segments, total = state.segments, 0.0
    take_logarithms(distance)
    for j in range(segments.centre.size):
        for q in range(segments.first_node[j], segments.first_node[j + 1]):
            total += segments.half_width[j] * segments.weight[q] * state.phi[q] * distance[q]
    return total


@kernel
def _near_field(state: ContactState, j: int, t: float, period: float, which: int) -> float:
    """An integral over segment j at its own coordinate t, near to it or on it.

    The poles of the segment, and those of its images on both sides where these are near too, are integrated in
    closed form, (L/pi) int rho/(x-s) ds and int rho ln|x-s| ds. What remains of the kernel is smooth and left to
    quadrature.
    """
    segments = state.segments
    r = segments.half_width[j]
    here = slice(segments.first_node[j], segments.first_node[j + 1])
    a = state.coefficient[here]
    singular, smooth = 0.0, 0.0
    images = 0 if period / r - abs(t) > segments.far_field[j] else 1
    for image in range(-images, images + 1):
        if which == POTENTIAL:
            singular += r * (log_integral(a, t - image * period / r) + np.log(r) * 0.5 * np.pi * a[0])
        elif which == CAUCHY:
            singular += cauchy_integral(a, t - image * period / r) * period / np.pi
        else:
            singular += cauchy_slope(a, t - image * period / r) * period / (np.pi * r)
    weight, phi, node = segments.weight[here], state.phi[here], segments.node[here]
    if images == 0 and np.pi / period * r * (abs(t) + 1) < MAX_POLE_ANGLE:
        for q in range(phi.size):
            smooth += weight[q] * phi[q] * _pole_free_series(which, r / period * (t - node[q]))
        smooth *= np.pi / period if which == SLOPE else 1.0
        smooth += 0.5 * np.pi * a[0] * np.log(2 * np.pi / period) if which == POTENTIAL else 0.0
    else:
        for q in range(phi.size):
            smooth += weight[q] * phi[q] * _kernel_without_poles(r * (t - node[q]), period, images, which)
    return singular + r * smooth


@kernel
def _pole_free_series(which: int, u: float) -> float:
    """ln|sin(pi u)/(pi u)|, cot(pi u) - 1/(pi u) or its derivative over pi, by their power series."""
    c, q = POLE_FREE_SERIES[which], u * u
    high = (c[4] + q * c[5]) + q * q * ((c[6] + q * c[7]) + q * q * (c[8] + q * c[9]))
    even = (c[0] + q * c[1]) + q * q * ((c[2] + q * c[3]) + q * q * high)
    return even * (q if which == POTENTIAL else u if which == CAUCHY else 1.0)


@kernel
def _kernel_without_poles(d: float, period: float, images: int, which: int) -> float:
    """ln|2 sin(pi d/L)|, cot(pi d/L) or its derivative, less the poles at d = 0 and, if images is 1, at -L and L."""
    factor = np.pi / period
    nearest = min(max(np.rint(d / period), -images), images)
    angle = factor * (d - nearest * period)
    value = np.log(2 * factor) if which == POTENTIAL else 0.0
    if abs(angle) < MAX_POLE_ANGLE:
        value += _pole_free_series(which, angle / np.pi) * (factor if which == SLOPE else 1.0)
    elif which == POTENTIAL:
        value += np.log(abs(np.sin(angle) / angle))
    elif which == CAUCHY:
        value += np.cos(angle) / np.sin(angle) - 1 / angle
    else:
        sine = np.sin(angle)
        value += factor * (1 / (angle * angle) - 1 / (sine * sine))
    for image in range(-images, images + 1):
        if image != nearest:
            distance = d - image * period
            if which == POTENTIAL:
                value -= np.log(abs(distance))
            elif which == CAUCHY:
                value -= 1 / (factor * distance)
            else:
                value += 1 / (factor * distance * distance)
    return value


@kernel
def segment_at(segments: Segments, period: float, origin: float, y: float) -> tuple[int, float]:
    """Index of the segment that holds origin + y, and the coordinate there; -1 and 0 outside the segments."""
    n, first = segments.centre.size, segments.origin[0] + segments.centre[0]
    x = origin + y
    x -= period * np.floor((x - first) / period)
    low, high = 0, n
    while high - low > 1:  # the last centre that is not beyond x
        middle = (low + high) // 2
        if segments.origin[middle] + segments.centre[middle] <= x:
            low = middle
        else:
            high = middle
    for j in ((low - 1) % n, low, (low + 1) % n):  # centres are rounded
        t = local_coordinate(segments, j, period, origin, y)
        if abs(t) < 1:
            return j, t
    return -1, 0.0


@kernel
def density(state: ContactState, period: float, origin: float, y: float) -> float:
    """rho at origin + y: the pressure on a contact or the slope of a gap (dual); 0 outside the segments."""
    j, t = segment_at(state.segments, period, origin, y)
    if j < 0:
        return 0.0
    here = slice(state.segments.first_node[j], state.segments.first_node[j + 1])
    return np.sqrt((1 - t) * (1 + t)) * evaluate_expansion(state.coefficient[here], t)


@kernel
def gap_from_slope(state: ContactState, period: float, origin: float, y: float) -> float:
    """The gap at origin + y, of a dual state: the integral of its slope; 0 outside the segments."""
    j, t = segment_at(state.segments, period, origin, y)
    if j < 0:
        return 0.0
    here = slice(state.segments.first_node[j], state.segments.first_node[j + 1])
    return state.segments.half_width[j] * partial_integral(state.coefficient[here], t)


@kernel
def complementary_residual(state: ContactState, series: CosineSeries, crest: int, y: float) -> float:
    """What must vanish on the segments and be positive outside them: the gap (primal), or the pressure (dual)."""
    value, origin = evaluate_series(series, crest, y)[0], series.crest_position[crest]
    if state.dual:
        relief = density_integral(state, series.period, origin, y, CAUCHY) / (2 * np.pi * series.period)
        return state.load - series.maximum - value + relief
    return -2 * density_integral(state, series.period, origin, y, POTENTIAL) - state.approach - value


@kernel
def complementary_residual_slope(state: ContactState, series: CosineSeries, crest: int, y: float) -> float:
    """The derivative of `complementary_residual` in y."""
    integral = density_integral(
        state, series.period, series.crest_position[crest], y, SLOPE if state.dual else CAUCHY
    )
    change = integral / (2 * np.pi * series.period) if state.dual else -2 * np.pi / series.period * integral
    return change - evaluate_series(series, crest, y)[1]


def complementary_residuals(state: ContactState, series: CosineSeries, crest: Indices, y: Array) -> Array:
    """`complementary_residual` at points, each given by a crest and the distance from it."""
    if y.size < MIN_SUM_POINTS or state.segments.centre.size < MIN_SUM_SEGMENTS:
        return np.asarray(residuals_one_by_one(state, series, crest, y))
    origin = series.crest_position[crest]
    origin = origin - series.period * np.floor((origin + y) / series.period)
    return residuals_by_sums(state, series, crest, y, origin, y)


@kernel
def residuals_one_by_one(state: ContactState, series: CosineSeries, crest: Indices, y: Array) -> Array:
    """`complementary_residuals`, each from closed forms and quadrature over all segments."""
    value = np.empty(y.size)
    for i in range(y.size):
        value[i] = complementary_residual(state, series, crest[i], y[i])
    return value


def residuals_by_sums(
    state: ContactState, series: CosineSeries, crest: Indices, y: Array, origin: Array, offset: Array
) -> Array:
    """`complementary_residuals`, in the time O(points + nodes): by fast sums.

    Far from a segment, these replace int rho ln|2 sin(pi (x-s)/L)| ds by Gauss's quadrature or, dual, the Cauchy
    integral by that of -(pi/L) int w/sin^2(pi (x-s)/L) ds, where w is the gap. Near one, closed forms stay.

    The points are at origin + offset, too. Counted from a segment's centre, as its nodes are, they keep all digits of
    their distance from these.
    """
    segments, period = state.segments, series.period
    order = np.argsort(origin + offset, kind="stable")
    origin, offset, value = origin[order], offset[order], np.empty(y.size)
    count, force = np.diff(segments.first_node), _node_forces(state)
    middle = np.repeat(segments.origin + segments.centre, count)
    tree = make_tree(middle, np.repeat(segments.half_width, count) * segments.node)
    total = potential(tree, force, origin, offset, period, state.dual)
    value[order] = _correct_near_segments(state, force, origin, offset, period, total)
    forcing = _evaluate_at(series, crest, y)
    if state.dual:
        return state.load - series.maximum - forcing - 0.5 / period**2 * value
    return -2 * value - state.approach - forcing


@kernel
def _evaluate_at(series: CosineSeries, crest: Indices, y: Array) -> Array:
    """S - max S at points."""
    value = np.empty(y.size)
    for i in range(y.size):
        value[i] = evaluate_series(series, crest[i], y[i])[0]
    return value


@kernel
def _node_forces(state: ContactState) -> Array:
    """The weight in Gauss's quadrature times the density or, dual, the gap."""
    segments, force = state.segments, np.empty(state.phi.size)
    for j in range(segments.centre.size):
        here, r = slice(segments.first_node[j], segments.first_node[j + 1]), segments.half_width[j]
        for q in range(segments.first_node[j], segments.first_node[j + 1]):
            t = segments.node[q]
            if state.dual:
                gap = r * partial_integral(state.coefficient[here], t)
                force[q] = r * segments.weight[q] * gap / np.sqrt((1 - t) * (1 + t))
            else:
                force[q] = r * segments.weight[q] * state.phi[q]
    return force


@kernel
def _correct_near_segments(
    state: ContactState, force: Array, origin: Array, offset: Array, period: float, total: Array
) -> Array:
    """The sums over all nodes, with closed forms where a segment is near."""
    segments, x = state.segments, origin + offset
    for j in range(segments.centre.size):
        centre, r = segments.origin[j] + segments.centre[j], segments.half_width[j]
        reach = min(segments.far_field[j] * r, 0.5 * period)
        for image in range(-1, 2):
            middle = centre + image * period
            for i in range(np.searchsorted(x, middle - reach), np.searchsorted(x, middle + reach)):
                d = (origin[i] - centre) + offset[i]
                t = (d - period * np.rint(d / period)) / r
                near = _near_field(state, j, t, period, CAUCHY if state.dual else POTENTIAL)
                total[i] += -near * period / np.pi if state.dual else near
                total[i] -= _quadrature(state, force, j, t, period)
    return total


@kernel
def _quadrature(state: ContactState, force: Array, j: int, t: float, period: float) -> float:
    """What segment j adds to the sum over all nodes at its own coordinate t."""
    segments = state.segments
    angle, total = np.pi / period * segments.half_width[j] * t, 0.0
    s, c = np.sin(angle), np.cos(angle)
    for q in range(segments.first_node[j], segments.first_node[j + 1]):
        sine = s * segments.cosine[q] - c * segments.sine[q]
        total += force[q] / (sine * sine) if state.dual else force[q] * np.log(abs(2 * sine))
    return total


def pressures_or_gaps(state: ContactState, series: CosineSeries, x: Array, of_gaps: bool) -> Array:
    """The pressure at positions x, in p_0*, or the gap there, in g_0."""
    inside, value = _values_on_segments(state, series, x)
    if of_gaps != state.dual:
        value = np.zeros(x.size)
        value[~inside] = complementary_residuals(state, series, *nearest_crests(series, x[~inside]))
    return value


@kernel
def _values_on_segments(state: ContactState, series: CosineSeries, x: Array) -> tuple[Flags, Array]:
    """Whether a segment holds each position, and the pressure there or, dual, the gap; 0 outside."""
    inside, value = np.zeros(x.size, np.bool_), np.zeros(x.size)
    for i in range(x.size):
        crest, y = nearest_crest(series, x[i])
        origin = series.crest_position[crest]
        inside[i] = segment_at(state.segments, series.period, origin, y)[0] >= 0
        if state.dual:
            value[i] = gap_from_slope(state, series.period, origin, y)
        else:
            value[i] = density(state, series.period, origin, y)
    return inside, value


def series_values(series: CosineSeries, x: Array) -> Array:
    """S at positions x."""
    return series.maximum + _evaluate_at(series, *nearest_crests(series, x))
