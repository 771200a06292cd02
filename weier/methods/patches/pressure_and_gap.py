"""Pressure and gap anywhere from the state of contact, accurate up to the edges.

docs/patches.md: "Pressure and gap anywhere" and, for closed forms, "Chebyshev polynomials". Far from a segment,
integrals over it are sums over its nodes, near it closed forms (`_near_field`). A point is given by an origin and the
distance y from it, so that points near a crest lose no digits.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.jit import kernel
from weier.methods.chebyshev import cauchy_integral, evaluate_expansion, gap_expansion, log_integral
from weier.methods.patches.kind import EPS
from weier.methods.patches.pair_sums import potential
from weier.methods.patches.segments import ContactState, SegmentArrays
from weier.methods.patches.surface import CosineSeries, Local, evaluate_series, first_from, nearest_crests
from weier.theory.halfplane import replace_by_influence

LN_ROUNDING = -float(np.log(0.5 * EPS))  # 36.7


def _pole_free_series() -> NDArray[np.float64]:
    """Return the power series of both kernels without their pole at 0, and without those at 1 and -1.

    Their terms, with zeta(2 k) and zeta(2 k) - 1, decrease by a factor of at least 4 (docs/patches.md).
    """
    k = np.arange(1, 4 + int(LN_ROUNDING / np.log(4.0)))
    zeta_less_1 = np.array([np.sum(np.arange(2.0, 1e3) ** (-2.0 * order)) for order in k])
    zeta_less_1[:2] = np.pi**2 / 6 - 1, np.pi**4 / 90 - 1  # whose sums converge slowly
    return np.array([[-z / k, -2 / np.pi * z] for z in (zeta_less_1 + 1, zeta_less_1)])


POLE_FREE_SERIES = _pole_free_series()


@kernel
def _local_coordinate(segment: float, centre: float, r: float, period: float, origin: float, y: float) -> float:
    """Return the coordinate t (-1..1 on a segment) of the image of origin + y nearest to its centre."""
    d = origin - segment + (y - centre)
    return (d - period * np.rint(d / period)) / r


@kernel
def far_field_from(count: int) -> float:
    """Return the distance from a centre, in half-widths, from which quadrature on K nodes is exact to rounding.

    Its error is rho^(-2 (K+1)), where rho belongs to the largest Bernstein ellipse that holds no pole, and whose
    longer half-axis is cosh(ln(rho)).
    """
    return np.cosh(0.5 * LN_ROUNDING / (count + 1))


@kernel
def gauss_nodes(count: int) -> tuple[Array, Array]:
    """Return the zeros of U_K, ascending, and the weights there for int sqrt(1-t^2) phi dt."""
    node, weight, step = np.empty(count), np.empty(count), np.pi / (count + 1)
    for i in range(count):
        node[i], weight[i] = -np.cos((i + 1) * step), step * np.sin((i + 1) * step) ** 2
    return node, weight


@kernel
def _forces_at(a: Array, r: float, node: Array, weight: Array) -> Array:
    """Return the density sqrt(1-t^2) sum a_k U_k at the nodes times their weights in an integral over the segment."""
    force = np.empty(a.size)
    for q in range(a.size):
        force[q] = r * weight[q] * evaluate_expansion(a, node[q])
    return force


@kernel
def cotangent_integrals(segments: SegmentArrays, coefficient: Array, period: float, origin: Array, y: Array) -> Array:
    """Return int rho cot(pi (x-s)/L) ds at any x = origin + y: far from a segment, by quadrature.

    There the addition theorem gives the cotangent.
    """
    integral, factor, (start, centre, half_width, first_node) = np.zeros(y.size), np.pi / period, segments
    for j in range(centre.size):
        r, a = half_width[j], coefficient[first_node[j] : first_node[j + 1]]
        node, weight = gauss_nodes(a.size)
        force, reach = _forces_at(a, r, node, weight), far_field_from(a.size)
        sine, cosine = np.sin(factor * r * node), np.cos(factor * r * node)
        for i in range(y.size):
            t = _local_coordinate(start[j], centre[j], r, period, origin[i], y[i])
            if abs(t) <= reach:
                integral[i] += _near_field(a, node, force, r, reach, t, period, True)
                continue
            s, c = np.sin(factor * r * t), np.cos(factor * r * t)
            for q in range(a.size):
                u, v = cosine[q], sine[q]
                integral[i] += force[q] * (c * u + s * v) / (s * u - c * v)
    return integral


@kernel
def _near_field(
    a: Array, node: Array, force: Array, r: float, reach: float, t: float, period: float, is_slope: bool
) -> float:
    """Return an integral over a segment at its own coordinate t, near to it or on it.

    The poles of the segment, and of its images on both sides if these are near, are integrated in closed form,
    (L/pi) int rho/(x-s) ds and int rho ln|x-s| ds. The smooth rest of the kernel, the series in u, is integrated by
    quadrature. For the logarithm there is an additional constant: ln|2 sin(pi u)| is ln|x-s|, and with both images
    the sum of three such terms less 2 ln L, and ln(2 pi/L), and the series.
    """
    total, largest_u = 0.0, r / period * (abs(t) + 1)
    images = 0 if largest_u < 0.5 and period / r - abs(t) > reach else 1
    for image in range(-images, images + 1):
        if not is_slope:
            total += r * (log_integral(a, t - image * period / r) + np.log(r) * 0.5 * np.pi * a[0])
        else:
            total += cauchy_integral(a, t - image * period / r) * period / np.pi
    factor, square, series = POLE_FREE_SERIES[images, 1 if is_slope else 0], np.empty(a.size), np.zeros(a.size)
    for q in range(a.size):
        square[q] = (r / period * (t - node[q])) ** 2
    terms = min(3 + LN_ROUNDING / (-2 * np.log(largest_u / (1 + images))), 1.0 * factor.size)
    for k in range(np.int64(terms) - 1, -1, -1):
        term = factor[k]
        for q in range(a.size):
            series[q] = term + square[q] * series[q]
    for q in range(a.size):
        power = r / period * (t - node[q]) if is_slope else square[q]
        total += force[q] * power * series[q]
    if not is_slope:
        total += r * 0.5 * np.pi * a[0] * (np.log(2 * np.pi / period) - 2 * images * np.log(period))
    return total


@kernel
def smooth_part(a: Array, is_gap: bool) -> Array:
    """Return coefficients in U_k of phi or of gap/(r (1-t^2)^(3/2)).

    They have the sign of the density and of its integral, the gap, and are accurate up to the ends of the segment.
    """
    return gap_expansion(a) if is_gap else a


@kernel
def at_point(value: float, t: float, r: float, is_gap: bool) -> float:
    """Return the density or the gap from the value of its smooth part."""
    end_distance = (1 - t) * (1 + t)
    return value * np.sqrt(end_distance) * (r * end_distance if is_gap else 1.0)


@kernel
def values_on_segments(
    segments: SegmentArrays, coefficient: Array, period: float, origin: Array, y: Array, integrated: bool
) -> tuple[Flags, Array]:
    """Return whether each point origin + y lies on a segment, and the density there or its integral, or 0.

    rho is the pressure on a contact or the slope of a gap, whose integral is the gap.
    """
    inside, value, (start, centre, half_width, first_node) = np.zeros(y.size, np.bool_), np.zeros(y.size), segments
    middle = start + centre
    for i in range(y.size):
        x = origin[i] + y[i]
        after = first_from(middle, x - period * np.floor((x - middle[0]) / period))
        for k in range(after - 2, after + 2):  # midpoints are rounded, so that two more segments are tried
            j = k % middle.size
            r = half_width[j]
            t = _local_coordinate(start[j], centre[j], r, period, origin[i], y[i])
            if abs(t) < 1:
                a = smooth_part(coefficient[first_node[j] : first_node[j + 1]], integrated)
                inside[i], value[i] = True, at_point(evaluate_expansion(a, t), t, r, integrated)
                break
    return inside, value


def complementary_residuals(state: ContactState, series: CosineSeries, crest: Indices, y: Array) -> Array:
    """Return the gap, or the pressure between gaps, which must vanish on the segments and be positive outside them.

    Points are given by a crest and the distance from it. Far from a segment, int rho ln|2 sin(pi (x-s)/L)| ds is a
    sum over its nodes, by Gauss's quadrature. For gaps, so is int w/sin^2(pi (x-s)/L) ds, which with the gap w is
    -L/pi times the Cauchy integral. Near a segment, closed forms are used.
    """
    segments, period = state.segments, series.period
    start = 0.5 * (segments.right[-1] - period + segments.middle[0] - segments.half_width[0])  # not on a segment
    origin = series.crest_position[crest]
    origin = origin - period * np.floor((origin + y - start) / period)
    order, value = np.argsort(origin + y, kind="stable"), np.empty(y.size)
    value[order] = residuals_in_order(state, series, crest[order], origin[order], y[order])
    return value


def residuals_in_order(state: ContactState, series: CosineSeries, crest: Indices, origin: Array, y: Array) -> Array:
    """Return complementary residuals at ascending points origin + y; the origins are images of the crests."""
    segments, period, kind = state.segments, series.period, state.kind
    at_node, force = node_forces(segments.arrays, state.coefficient, kind.is_slope)
    crests = np.repeat(segments.origin, segments.node_count)
    value = potential(crests, at_node, force, origin, y, period, kind.is_slope)
    near = float((-period / np.pi) ** kind.derivative)  # the sum over dipoles, over the integral by parts
    highest = kind.uniform(-state.approach) - kind.largest_forcing(series.maximum, state.load)
    sums = segments.arrays, state.coefficient, kind.is_slope, near, at_node, force, origin, y, period, value
    _complete_residuals(*sums, series.local, crest, kind.factor(period), highest)
    return value


@kernel
def node_forces(segments: SegmentArrays, coefficient: Array, is_gap: bool) -> NDArray[np.float64]:
    """Return nodes from origins of segments, and the weights in Gauss's quadrature times the density or the gap."""
    found, (_, centre, half_width, first_node) = np.empty((2, coefficient.size)), segments
    for j in range(centre.size):
        start, end, r = first_node[j], first_node[j + 1], half_width[j]
        node, weight = gauss_nodes(end - start)
        a = smooth_part(coefficient[start:end], is_gap)
        for q in range(end - start):
            found[0, start + q] = centre[j] + r * node[q]
            root = np.sqrt((1 - node[q]) * (1 + node[q]))
            found[1, start + q] = r * weight[q] / root * at_point(evaluate_expansion(a, node[q]), node[q], r, is_gap)
    return found


@kernel
def _complete_residuals(
    segments: SegmentArrays,
    coefficient: Array,
    is_slope: bool,
    near: float,
    at_node: Array,
    force: Array,
    origin: Array,
    offset: Array,
    period: float,
    total: Array,
    local: Local,
    crest: Indices,
    factor: float,
    highest: float,
) -> None:
    """Turn sums over all nodes into residuals, with an integral in closed form where a segment is near."""
    x, (starts, centres, half_width, first_node) = np.empty(offset.size), segments
    for i in range(offset.size):
        x[i] = origin[i] + offset[i]
    for j in range(centres.size):
        first, last = first_node[j], first_node[j + 1]
        start, centre, r = starts[j], centres[j], half_width[j]
        a, (node, weight), at_nodes = coefficient[first:last], gauss_nodes(last - first), np.empty(last - first)
        density = _forces_at(a, r, node, weight)
        far = far_field_from(node.size)
        reach = min(far * r + 4 * EPS * period, 0.5 * period)  # x is rounded
        for image in range(-1, 2):
            middle = start + centre + image * period
            for i in range(first_from(x, middle - reach), first_from(x, middle + reach)):
                t = _local_coordinate(start, centre, r, period, origin[i], offset[i])
                for q in range(node.size):  # must equal the term of the sums to the last digit
                    at_nodes[q] = (origin[i] - start) + (offset[i] - at_node[first + q])
                replace_by_influence(at_nodes, period, is_slope)
                total[i] += near * _near_field(a, node, density, r, far, t, period, is_slope)
                for q in range(node.size):
                    total[i] -= force[first + q] * at_nodes[q]
    for i in range(offset.size):
        total[i] = highest - evaluate_series(local, crest[i], offset[i])[0] + factor * total[i]


def pressures_or_gaps(state: ContactState, series: CosineSeries, x: Array, is_gap: bool) -> Array:
    """Return the pressure at positions x, in p_0*, or the gap there, in g_0."""
    return values_at(state, series, *nearest_crests(series, x), is_gap)


def values_at(state: ContactState, series: CosineSeries, crest: Indices, y: Array, is_gap: bool) -> Array:
    """Return the pressure or the gap at the distances y from crests of the state's series."""
    density, origin = (state.segments.arrays, state.coefficient), series.crest_position[crest]
    inside, value = values_on_segments(*density, series.period, origin, y, state.kind.is_slope)
    if is_gap != state.kind.is_slope:
        value = np.zeros(y.size)
        value[~inside] = complementary_residuals(state, series, crest[~inside], y[~inside])
    return value
