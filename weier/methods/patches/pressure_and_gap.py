"""Pressure and gap anywhere from the state of contact, accurate up to the edges.

docs/patches.md: "Pressure and gap anywhere" and, for closed forms, "Chebyshev polynomials". `residuals_one_by_one`
sums over the segments, by quadrature far from a segment (`_far_field`), in closed form near it (`_near_field`);
`residuals_by_sums` uses fast sums with `_correct_near_segments`. A point is given by an origin and the distance y
from it, so that points near a crest lose no digits.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.jit import kernel
from weier.methods.chebyshev import cauchy_integral, evaluate_expansion, gap_expansion, log_integral
from weier.methods.patches.kind import EPS
from weier.methods.patches.pair_sums import make_tree, potential
from weier.methods.patches.segments import ContactState, Segments
from weier.methods.patches.surface import CosineSeries, evaluate_at, first_from, nearest_crests
from weier.theory.halfplane import replace_by_influence, take_logarithms

# least number of points and of segments for fast sums; its cost is in `python -m benchmarks tuning`
MIN_SUM = 64
LN_ROUNDING = -float(np.log(0.5 * EPS))  # 36.7
BLOCK = 64  # far points summed at once: 20 kB with 40 nodes, within the cache
# angle between x and the centre of a segment above which it is computed from the angles of both, with a rounding
# error of 2e-15 of it
MIN_ANGLE = 0.1


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


def density_integrals(state: ContactState, period: float, origin: Array, y: Array, is_slope: bool) -> Array:
    """Return int rho ln|2 sin(pi (x-s)/L)| ds or, for its slope, int rho cot(pi (x-s)/L) ds at any x = origin + y."""
    return _integrals(state.segments, state.coefficient, period, origin, y, is_slope)


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
def _integrals(
    segments: Segments, coefficient: Array, period: float, origin: Array, y: Array, is_slope: bool
) -> Array:
    """Return int rho ln|2 sin(pi (x-s)/L)| ds or int rho cot(pi (x-s)/L) ds at any x = origin + y.

    Far from a segment, quadrature is used, with sin(pi (x-s)/L) by the addition theorem: from the angle between x and
    the segment's centre if it is small, so that short distances lose no digits, otherwise from the angles of both.
    """
    integral, factor = np.zeros(y.size), np.pi / period
    sine_of_x, cosine_of_x = np.empty(y.size), np.empty(y.size)
    for i in range(y.size):
        sine_of_x[i], cosine_of_x[i] = np.sin(factor * (origin[i] + y[i])), np.cos(factor * (origin[i] + y[i]))
    s, c, far = np.empty(BLOCK), np.empty(BLOCK), np.empty(BLOCK, np.int64)
    for j in range(segments.centre.size):
        r, a, count = segments.half_width[j], coefficient[segments.first_node[j] : segments.first_node[j + 1]], 0
        angle_of_c = factor * (segments.origin[j] + segments.centre[j])
        sine_of_c, cosine_of_c = np.sin(angle_of_c), np.cos(angle_of_c)
        node, weight = gauss_nodes(a.size)
        force = _forces_at(a, r, node, weight)
        sine, cosine = np.empty(node.size), np.empty(node.size)
        for q in range(node.size):
            sine[q], cosine[q] = np.sin(factor * r * node[q]), np.cos(factor * r * node[q])
        reach = far_field_from(node.size)
        for i in range(y.size):
            t = _local_coordinate(segments.origin[j], segments.centre[j], r, period, origin[i], y[i])
            if abs(t) <= reach:
                integral[i] += _near_field(a, node, force, r, reach, t, period, is_slope)
            else:
                angle = factor * r * t
                if abs(angle) < MIN_ANGLE:
                    s[count], c[count] = np.sin(angle), np.cos(angle)
                else:
                    s[count] = sine_of_x[i] * cosine_of_c - cosine_of_x[i] * sine_of_c
                    c[count] = cosine_of_x[i] * cosine_of_c + sine_of_x[i] * sine_of_c
                far[count] = i
                count += 1
            if count == BLOCK or (i == y.size - 1 and count > 0):
                value = _far_field(force, sine, cosine, s[:count], c[:count], is_slope)
                for k in range(count):
                    integral[far[k]] += value[k]
                count = 0
    return integral


@kernel
def _far_field(force: Array, sine: Array, cosine: Array, s: Array, c: Array, is_slope: bool) -> Array:
    """Integrate over a segment by quadrature, at points with these sines and cosines of the angle from its centre.

    The loops over the points have no branches, so that the compiler vectorises them.
    """
    n, value = s.size, np.zeros(s.size)
    if not is_slope:
        distance = np.empty(force.size * n)
        for q in range(force.size):
            row, u, v = distance[q * n : (q + 1) * n], 2 * cosine[q], 2 * sine[q]
            for i in range(n):
                row[i] = abs(s[i] * u - c[i] * v)
        take_logarithms(distance)
        for q in range(force.size):
            row, here = distance[q * n : (q + 1) * n], force[q]
            for i in range(n):
                value[i] += here * row[i]
        return value
    for q in range(force.size):
        here, u, v = force[q], cosine[q], sine[q]
        for i in range(n):
            value[i] += here * (c[i] * u + s[i] * v) / (s[i] * u - c[i] * v)
    return value


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


def values_on_segments(
    state: ContactState, period: float, origin: Array, y: Array, integrated: bool
) -> tuple[Flags, Array]:
    """Return whether each point origin + y lies on a segment, and the density there or its integral, or 0.

    rho is the pressure on a contact or the slope of a gap, whose integral is the gap.
    """
    inside, value = _values_on_segments(state.segments, state.coefficient, period, origin, y, integrated)
    return inside, value


@kernel
def _values_on_segments(
    segments: Segments, coefficient: Array, period: float, origin: Array, y: Array, integrated: bool
) -> tuple[Flags, Array]:
    """Return the values of `values_on_segments`."""
    inside, value = np.zeros(y.size, np.bool_), np.zeros(y.size)
    middle = segments.origin + segments.centre
    for i in range(y.size):
        x = origin[i] + y[i]
        after = first_from(middle, x - period * np.floor((x - middle[0]) / period))
        for k in range(after - 2, after + 2):  # midpoints are rounded, so that two more segments are tried
            j = k % middle.size
            r = segments.half_width[j]
            t = _local_coordinate(segments.origin[j], segments.centre[j], r, period, origin[i], y[i])
            if abs(t) < 1:
                a = smooth_part(coefficient[segments.first_node[j] : segments.first_node[j + 1]], integrated)
                inside[i], value[i] = True, at_point(evaluate_expansion(a, t), t, r, integrated)
                break
    return inside, value


def complementary_residuals(state: ContactState, series: CosineSeries, crest: Indices, y: Array) -> Array:
    """Return the gap, or the pressure between gaps, which must vanish on the segments and be positive outside them.

    Points are given by a crest and the distance from it.
    """
    if min(y.size, state.segments.centre.size) < MIN_SUM:
        return residuals_one_by_one(state, series, crest, y)
    origin = series.crest_position[crest]
    origin = origin - series.period * np.floor((origin + y) / series.period)
    return residuals_by_sums(state, series, crest, y, origin, y)


def residuals_one_by_one(state: ContactState, series: CosineSeries, crest: Indices, y: Array) -> Array:
    """Return `complementary_residuals`, each from closed forms and quadrature over all segments."""
    kind, origin = state.kind, series.crest_position[crest]
    integral = density_integrals(state, series.period, origin, y, kind.is_slope)
    integral *= kind.factor(series.period) * _force_factor(state, series.period)
    return np.asarray(_constant(state, series) - evaluate_at(series, crest, y, 0) + integral)


def _force_factor(state: ContactState, period: float) -> float:
    """Return the sum over dipoles on a gap, over the integral of its slope by parts; 1 for contacts."""
    return float((-period / np.pi) ** state.kind.derivative)


def _constant(state: ContactState, series: CosineSeries) -> float:
    """Return the residual on the highest crest of the series without the integral."""
    return state.kind.uniform(-state.approach) - state.kind.largest_forcing(series.maximum, state.load)


def residuals_by_sums(
    state: ContactState, series: CosineSeries, crest: Indices, y: Array, origin: Array, offset: Array
) -> Array:
    """Return `complementary_residuals`, in the time O(points + nodes): by fast sums.

    Far from a segment, these replace int rho ln|2 sin(pi (x-s)/L)| ds by Gauss's quadrature or, for gaps, the Cauchy
    integral by the quadrature of -(pi/L) int w/sin^2(pi (x-s)/L) ds, where w is the gap. Near a segment, closed forms
    are used. Points are given by origin + offset as well: relative to the centre of a segment, distances from its
    nodes lose no digits.
    """
    segments, period = state.segments, series.period
    order = np.argsort(origin + offset, kind="stable")
    origin, offset, value = origin[order], offset[order], np.empty(y.size)
    kind, density = state.kind, (segments, state.coefficient)
    at_node, force = node_forces(*density, kind.is_slope)
    tree = make_tree(np.repeat(segments.middle, segments.node_count), at_node)
    total, factor = potential(tree, force, make_tree(origin, offset), period, kind.is_slope), kind.factor(period)
    near = _force_factor(state, period)
    value[order] = _correct_near_segments(*density, kind.is_slope, near, force, origin, offset, period, total)
    return np.asarray(_constant(state, series) - evaluate_at(series, crest, y, 0) + factor * value)


@kernel
def node_forces(segments: Segments, coefficient: Array, is_gap: bool) -> tuple[Array, Array]:
    """Return the offsets of nodes from centres, and the weight in Gauss's quadrature times the density or the gap."""
    offset, force = np.empty(coefficient.size), np.empty(coefficient.size)
    for j in range(segments.centre.size):
        start, end, r = segments.first_node[j], segments.first_node[j + 1], segments.half_width[j]
        node, weight = gauss_nodes(end - start)
        a = smooth_part(coefficient[start:end], is_gap)
        for q in range(end - start):
            offset[start + q] = r * node[q]
            root = np.sqrt((1 - node[q]) * (1 + node[q]))
            force[start + q] = r * weight[q] / root * at_point(evaluate_expansion(a, node[q]), node[q], r, is_gap)
    return offset, force


@kernel
def _correct_near_segments(
    segments: Segments,
    coefficient: Array,
    is_slope: bool,
    factor: float,
    force: Array,
    origin: Array,
    offset: Array,
    period: float,
    total: Array,
) -> Array:
    """Return the sums over all nodes, with a factor times an integral in closed form where a segment is near."""
    x = np.empty(offset.size)
    for i in range(offset.size):
        x[i] = origin[i] + offset[i]
    for j in range(segments.centre.size):
        first, last = segments.first_node[j], segments.first_node[j + 1]
        centre, r = segments.origin[j] + segments.centre[j], segments.half_width[j]
        a, (node, weight), at_nodes = coefficient[first:last], gauss_nodes(last - first), np.empty(last - first)
        density = _forces_at(a, r, node, weight)
        far = far_field_from(node.size)
        reach = min(far * r, 0.5 * period)
        for image in range(-1, 2):
            middle = centre + image * period
            for i in range(first_from(x, middle - reach), first_from(x, middle + reach)):
                t = _local_coordinate(centre, 0.0, r, period, origin[i], offset[i])
                for q in range(node.size):  # must equal the term of the sums to the last digit
                    at_nodes[q] = (origin[i] - centre) + (offset[i] - r * node[q])
                replace_by_influence(at_nodes, period, is_slope)
                total[i] += factor * _near_field(a, node, density, r, far, t, period, is_slope)
                for q in range(node.size):
                    total[i] -= force[first + q] * at_nodes[q]
    return total


def pressures_or_gaps(state: ContactState, series: CosineSeries, x: Array, is_gap: bool) -> Array:
    """Return the pressure at positions x, in p_0*, or the gap there, in g_0."""
    return values_at(state, series, *nearest_crests(series, x), is_gap)


def values_at(state: ContactState, series: CosineSeries, crest: Indices, y: Array, is_gap: bool) -> Array:
    """Return the pressure or the gap at the distances y from crests of the state's series."""
    inside, value = values_on_segments(state, series.period, series.crest_position[crest], y, state.kind.is_slope)
    if is_gap != state.kind.is_slope:
        value = np.zeros(y.size)
        value[~inside] = complementary_residuals(state, series, crest[~inside], y[~inside])
    return value
