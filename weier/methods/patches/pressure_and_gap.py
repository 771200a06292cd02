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
from weier.methods.patches.surface import CosineSeries, Local, evaluate_series, first_from
from weier.theory.halfplane import take_logarithms


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
    return np.cosh(-0.5 * np.log(0.5 * EPS) / (count + 1))


@kernel
def gauss_nodes(count: int) -> tuple[Array, Array]:
    """Return the zeros of U_K, ascending, and the weights there for int sqrt(1-t^2) phi dt."""
    node, weight, step = np.empty(count), np.empty(count), np.pi / (count + 1)
    for i in range(count):
        node[i], weight[i] = -np.cos((i + 1) * step), step * np.sin((i + 1) * step) ** 2
    return node, weight


@kernel
def _near_field(
    a: Array, apart: Array, force: Array, r: float, t: float, reach: float, period: float, power: int
) -> float:
    """Return by how much an integral over a segment exceeds the sum over its nodes, at its own coordinate t.

    The kernel is ln|2 sin(pi (x-s)/L)| for the power 0, and 1/sin^2 of the same angle for 2. The poles of the
    segment, and of its images on both sides if these are near, are integrated in closed form, and summed over the
    distances `apart` from the nodes. The rest of the kernel is smooth, so that the sum is exact, and from `reach` on
    (`far_field_from`) the whole.
    """
    total, distance = 0.0, np.empty(a.size)
    if abs(t) > reach:
        return 0.0
    images = 0 if period / r - abs(t) > reach else 1
    for image in range(-images, images + 1):
        for q in range(a.size):
            distance[q] = apart[q] - image * period
        at = t - image * period / r
        if power == 0:
            for q in range(a.size):
                distance[q] = abs(distance[q])
            take_logarithms(distance)
            total += r * (log_integral(a, at) + np.log(r) * 0.5 * np.pi * a[0])
        else:
            for q in range(a.size):
                distance[q] = (period / (np.pi * distance[q])) ** power
            total -= (-period / np.pi) ** power * cauchy_integral(a, at)
        for q in range(a.size):
            total -= force[q] * distance[q]
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

    Points are given by a crest and the distance from it; none may be a node. Far from a segment, int rho
    ln|2 sin(pi (x-s)/L)| ds is a sum over its nodes, by Gauss's quadrature. For gaps, so is
    int w/sin^2(pi (x-s)/L) ds, which with the gap w is -L/pi times the Cauchy integral. Near a segment, closed forms
    correct the sums.
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
    crests, at_node, force = node_forces(segments.arrays, state.coefficient, kind.is_slope)
    value = potential(crests, at_node, force, origin, y, period, kind.is_slope)
    highest = kind.uniform(-state.approach) - kind.largest_forcing(series.maximum, state.load)
    sums = segments.arrays, state.coefficient, kind.is_slope, at_node, force, origin, y, period, value
    _complete_residuals(*sums, series.local, crest, kind.factor(period), highest)
    return value


@kernel
def node_forces(segments: SegmentArrays, coefficient: Array, is_gap: bool) -> NDArray[np.float64]:
    """Return origins of segments, nodes from there, and Gauss's weights times the density or the gap, as rows."""
    found, (origin, centre, half_width, first_node) = np.empty((3, coefficient.size)), segments
    for j in range(centre.size):
        start, end, r = first_node[j], first_node[j + 1], half_width[j]
        node, weight = gauss_nodes(end - start)
        a = smooth_part(coefficient[start:end], is_gap)
        for q in range(end - start):
            found[0, start + q], found[1, start + q] = origin[j], centre[j] + r * node[q]
            root = np.sqrt((1 - node[q]) * (1 + node[q]))
            found[2, start + q] = r * weight[q] / root * at_point(evaluate_expansion(a, node[q]), node[q], r, is_gap)
    return found


@kernel
def work_of_forces(
    segments: SegmentArrays, crest: Indices, coefficient: Array, is_gap: bool, local: Local, top: float
) -> float:
    """Return the sum over all nodes of their forces, or gaps times weights, times the series, of this maximum."""
    (_, node, force), first_node, work = node_forces(segments, coefficient, is_gap), segments[3], 0.0
    for j in range(crest.size):
        for q in range(first_node[j], first_node[j + 1]):
            work += force[q] * (top + evaluate_series(local, crest[j], node[q])[0])
    return work


@kernel
def _complete_residuals(
    segments: SegmentArrays,
    coefficient: Array,
    is_slope: bool,
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
        a, apart, far = coefficient[first:last], np.empty(last - first), far_field_from(last - first)
        reach = min(far * r + 4 * EPS * period, 0.5 * period)  # x is rounded
        for image in range(-1, 2):
            middle = start + centre + image * period
            for i in range(first_from(x, middle - reach), first_from(x, middle + reach)):
                t = _local_coordinate(start, centre, r, period, origin[i], offset[i])
                for q in range(a.size):  # as in the sums, to the last digit
                    apart[q] = (origin[i] - start) + (offset[i] - at_node[first + q])
                turns = period * np.rint(apart[0] / period - t * r / period)
                for q in range(a.size):
                    apart[q] -= turns
                total[i] += _near_field(a, apart, force[first:last], r, t, far, period, 2 if is_slope else 0)
    for i in range(offset.size):
        total[i] = highest - evaluate_series(local, crest[i], offset[i])[0] + factor * total[i]


def values_at(state: ContactState, series: CosineSeries, crest: Indices, y: Array, is_gap: bool) -> Array:
    """Return the pressure or the gap at the distances y from crests of the state's series."""
    density, origin = (state.segments.arrays, state.coefficient), series.crest_position[crest]
    inside, value = values_on_segments(*density, series.period, origin, y, state.kind.is_slope)
    if is_gap != state.kind.is_slope:
        value = np.zeros(y.size)
        value[~inside] = complementary_residuals(state, series, crest[~inside], y[~inside])
    return value
