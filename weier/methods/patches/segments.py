"""Segments of the period, which are contacts or gaps: their Chebyshev nodes, and the densities on them.

A density is sqrt(1-t^2) phi(t) in the coordinate t of its segment, -1..1. With phi = sum a_k U_k(t), and with rho^-n
in place of T_n(t) outside the segment, where rho = t + sign(t) sqrt(t^2-1), its integrals have closed forms:

    int sqrt(1-s^2) U_k(s)/(t-s) ds      = pi T_(k+1)(t)
    int sqrt(1-s^2) U_k(s) ln|t-s| ds    = (L_k - L_(k+2))/2,  L_0 = pi (ln|rho| - ln 2),  L_n = -(pi/n) T_n(t)

Both hold at the edges and beyond them, where quadrature would lose all digits.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.jit import kernel
from weier.methods.errors import ConvergenceError
from weier.methods.patches.surface import CosineSeries

MAX_NODES = 2000
# Nodes of a segment, by the digits asked for: a + b k r + c/ln(rho), fitted to the coefficients of 558 segments; and
# e/ln(rho)^2 more where two segments are so close that slow modes of one are fast ones of the other.
DIGITS = np.array([3.0, 4.0, 6.0, 8.0, 10.0, 12.0])
NODES_AT_LEAST = np.array([4.0, 5.0, 6.0, 6.5, 7.0, 7.5])
NODES_PER_RADIAN = np.array([1.4, 1.4, 1.45, 1.2, 1.0, 1.0])
NODES_PER_NEIGHBOUR = np.array([0.7, 1.2, 3.0, 6.8, 10.8, 14.8])
NODES_PER_TWIN = np.array([0.1, 0.1, 0.0, 0.0, 0.0, 0.0])
# Limits for the distance of neighbours over the half-width; a solution shows by itself if it needs more nodes.
MIN_DISTANCE, MAX_DISTANCE = 1e-3, 1e6
MORE_NODES, AT_LEAST_MORE = 1.3, 2  # over those so far, where the coefficients have not decayed
# Rounding of a tail, for the widest segment: a density falls with the width squared, and its rounding does not.
TAIL_ROUNDING, MAX_TAIL_ROUNDING = 1e-14, 1e-3
COARSE_TOLERANCE = 1e-3  # of the density on the few nodes that Newton's method solves for

Table = NDArray[np.float64]  # shape (degrees, nodes)


class Rule(NamedTuple):
    """Gauss's quadrature at the zeros of T_K, for int phi/sqrt(1-t^2) dt, or of U_K, for int sqrt(1-t^2) phi dt.

    node : t, ascending, shape (K,)
    weight : of the values at the nodes, shape (K,)
    polynomial : T_k or U_k at the nodes, one k a row, shape (K, K)
    expansion : what makes coefficients in T_k or U_k of values at the nodes, shape (K, K)
    """

    node: Array
    weight: Array
    polynomial: Table
    expansion: Table


@lru_cache(maxsize=256)
def gauss_rule(count: int, of_second_kind: bool) -> Rule:
    """The rule of so many nodes. Angles are reduced in integers, so that the highest degrees lose no digit."""
    if of_second_kind:
        degree, angle = np.arange(1, count + 1), np.arange(count, 0, -1)
        sine = np.sin(np.pi / (count + 1) * angle)
        weight, scale = np.pi / (count + 1) * sine**2, np.pi / (count + 1)
        polynomial = np.sin(scale * (degree[:, None] * angle % (2 * count + 2))) / sine
    else:
        degree, angle = np.arange(count), np.arange(2 * count - 1, 0, -2)
        weight, scale = np.full(count, np.pi / count), np.pi / (2 * count)
        polynomial = np.cos(scale * (degree[:, None] * angle % (4 * count)))
    expansion = 2 / np.pi * polynomial * weight
    if not of_second_kind:
        expansion[0] *= 0.5
    return Rule(np.cos(scale * angle), weight, polynomial, expansion)


@lru_cache(maxsize=256)
def log_moments(count: int) -> Array:
    """int sqrt(1-s^2) U_k ln|s| ds, k = 0..count - 1, from L_k - L_(k+2) at t = 0."""
    moment, k = np.zeros(count), np.arange(0, count, 2)
    T = np.where(k % 4 == 0, 1.0, -1.0)  # T_k(0); that of k + 2 has the other sign
    own = np.append(np.log(2.0), T[1:] / k[1:])
    moment[::2] = -0.5 * np.pi * (own + T / (k + 2))
    return moment


class Blocks(NamedTuple):
    """A matrix for each segment, from values of its own in a row with those of the others to new values in a row.

    table : the entries of all matrices, column by column
    start : where each begins in the table, shape (segments,); several may be the same
    first_row, first_column : the first new and old values of each and, last, the number of all, shape (segments + 1,)
    """

    table: Array
    start: Indices
    first_row: Indices
    first_column: Indices


def make_blocks(matrices: Iterable[Table]) -> Blocks:
    """The matrices of all segments in order; one that several segments share stands in the table once."""
    matrices = list(matrices)
    distinct = {id(each): each for each in matrices}
    place = {name: number for number, name in enumerate(distinct)}
    which = [place[id(each)] for each in matrices]
    shapes = np.array([each.shape for each in distinct.values()])
    table, end = np.concatenate([each.ravel("F") for each in distinct.values()]), np.cumsum(shapes.prod(axis=1))
    start, (rows, columns) = (end - shapes.prod(axis=1))[which], shapes[which].T
    return Blocks(table, start, np.append(0, np.cumsum(rows)), np.append(0, np.cumsum(columns)))


@kernel
def apply_blocks(blocks: Blocks, f: Array) -> Array:
    """The matrix of each segment times its part of f."""
    result = np.zeros(blocks.first_row[-1])
    for j in range(blocks.first_row.size - 1):
        here, entry = result[blocks.first_row[j] : blocks.first_row[j + 1]], blocks.start[j]
        for q in range(blocks.first_column[j], blocks.first_column[j + 1]):
            factor, column = f[q], blocks.table[entry : entry + here.size]
            for i in range(here.size):
                here[i] += factor * column[i]
            entry += here.size
    return result


@lru_cache(maxsize=256)
def _modes(less: int, count: int, period: float, dual: bool) -> tuple[Table, Table, Table, Table]:
    """Matrices of one segment on fewer nodes and on more: restriction, interpolation, fast modes, and their lift.

    The residual at the points, a sum of T_m, is cut off where the fewer points end. The fast modes of phi take off
    what is left. Each also lifts the centre of its own contact, by 2 int sqrt(1-t^2) U_k ln|t| dt.
    """
    few, many = gauss_rule(less, True), gauss_rule(count, True)
    to_T, kept = gauss_rule(count + 1, False).expansion, min(less, count)
    restriction = gauss_rule(less + 1, False).polynomial[: kept + 1].T @ to_T[: kept + 1]
    interpolation = many.polynomial[:kept].T @ few.expansion[:kept]
    to_U = to_T[less + 1 :] / period
    lift = 2 * (not dual) * log_moments(count)[None, less:] @ to_U
    return restriction, interpolation, many.polynomial[less:].T @ to_U, lift


@lru_cache(maxsize=64)
def mode_blocks(few: tuple[int, ...], many: tuple[int, ...], period: float, dual: bool) -> tuple[Blocks, ...]:
    """What `newton.TwoGrids` is made of, from so many nodes of each segment to so many, which loads often have."""
    modes = (_modes(less, count, period, dual) for less, count in zip(few, many, strict=True))
    expansions = (gauss_rule(count, True).expansion for count in many)
    return *map(make_blocks, zip(*modes, strict=True)), make_blocks(expansions)


@kernel
def evaluate_expansion(a: Array, t: float) -> float:
    """phi(t) = sum a_k U_k(t), -1 <= t <= 1, by Clenshaw's recurrence."""
    b_after, b = 0.0, 0.0
    for k in range(a.size - 1, -1, -1):
        b, b_after = a[k] + 2 * t * b - b_after, b
    return b


@kernel
def _outer_radius(t: float) -> float:
    """rho, of a point outside [-1, 1]."""
    return t + np.copysign(np.sqrt((t - 1) * (t + 1)), t)


@kernel
def cauchy_integral(a: Array, t: float) -> float:
    """int sqrt(1-s^2) phi(s)/(t-s) ds = pi sum a_k T_(k+1)(t) at any real t."""
    if abs(t) > 1:
        total, w = 0.0, 1 / _outer_radius(t)
        for k in range(a.size - 1, -1, -1):
            total = (total + a[k]) * w
        return np.pi * total
    b_after, b = 0.0, 0.0
    for k in range(a.size - 1, -1, -1):
        b, b_after = a[k] + 2 * t * b - b_after, b
    return np.pi * (t * b - b_after)


@kernel
def log_integral(a: Array, t: float) -> float:
    """int sqrt(1-s^2) phi(s) ln|t-s| ds at any real t: a sum of T_n/n with the factors (a_(n-2) - a_n)/2."""
    outside = abs(t) > 1
    w = 1 / _outer_radius(t) if outside else 0.0
    double, back = (w, 0.0) if outside else (2 * t, 1.0)
    b_after, b = 0.0, 0.0
    for n in range(a.size + 1, 0, -1):
        factor = (a[n - 2] if n > 1 else 0.0) - (a[n] if n < a.size else 0.0)
        b, b_after = factor / (2 * n) + double * b - back * b_after, b
    total = w * b if outside else t * b - b_after
    return np.pi * (total - 0.5 * a[0] * (np.log(2.0) + (np.log(abs(w)) if outside else 0.0)))


@kernel
def gap_expansion(a: Array) -> Array:
    """Coefficients in U_k of int_-1^t sqrt(1-s^2) phi(s) ds/(1-t^2)^(3/2), for a gap: as it closes at 1, a_0 = 0.

    The integral of sqrt(1-s^2) U_k is -(1-t^2)^(3/2) U_k'/(k (k+2)).
    """
    k = np.maximum(np.arange(a.size), 1)
    return -derivative_expansion(a / (k * (k + 2)))


@kernel
def derivative_expansion(a: Array) -> Array:
    """Coefficients in U_k of phi', from U_k' = 2 (k U_(k-1) + (k-2) U_(k-3) + ...)."""
    b, total, total_of_next = np.zeros(a.size), 0.0, 0.0
    for k in range(a.size - 1, 0, -1):
        total, total_of_next = total_of_next + a[k], total
        b[k - 1] = 2 * k * total
    return b


def degrees(first_node: Indices) -> Indices:
    """The degree of the polynomial whose coefficient is kept at each node's place, from 0 on each segment."""
    return np.arange(first_node[-1]) - np.repeat(first_node[:-1], np.diff(first_node))


def end_sums(first_node: Indices, coefficient: Array) -> NDArray[np.float64]:
    """The sums of the coefficients of each segment, shape (segments, 2): at -1, with the sign (-1)^k, and at 1."""
    signed = np.where(degrees(first_node) % 2 == 0, coefficient, -coefficient)
    return np.stack([np.add.reduceat(each, first_node[:-1]) for each in (signed, coefficient)], axis=1)


class Segments(NamedTuple):
    """Segments [c-r, c+r] in order round the period, with the nodes of all of them in a row.

    crest : index of the crest from which the segment's position is counted, shape (segments,)
    origin : position of that crest, or of its image next to the segment, in lambda_0, shape (segments,)
    centre, half_width : c from the origin, and r, in lambda_0, shape (segments,)
    first_node : index of each segment's first node and, last, the number of all nodes, shape (segments + 1,)
    node : Gauss nodes t in (-1, 1), ascending within a segment, shape (nodes,)
    point : where the quadrature of the Cauchy integral is exact, one more on each segment, shape (nodes + segments,)
    weight : for int sqrt(1-t^2) phi dt over a segment, shape (nodes,)
    log_weight : for int sqrt(1-t^2) phi ln|t| dt, shape (nodes,)
    """

    crest: Indices
    origin: Array
    centre: Array
    half_width: Array
    first_node: Indices
    node: Array
    point: Array
    weight: Array
    log_weight: Array

    @property
    def node_count(self) -> Indices:
        """Of each segment, shape (segments,)."""
        return self.first_node[1:] - self.first_node[:-1]


class Iterate(NamedTuple):
    """Contacts with their pressure, or gaps with their slope (dual), as an initial guess or on the way to a solution.

    dual : whether the segments are the gaps
    segments : the contacts or, dual, the gaps
    phi : at the nodes, shape (nodes,); sqrt(1-t^2) phi is the pressure, in p_0*, or the slope of the gap, in
        g_0/lambda_0
    approach : indentation from first contact or, dual, the mean gap with its sign turned, in g_0
    """

    dual: bool
    segments: Segments
    phi: Array
    approach: float


@lru_cache(maxsize=256)
def _quadrature(count: int) -> tuple[Array, Array, Array, Array]:
    """Nodes, points between them and beyond, weights and weights for ln|t| of so many nodes."""
    rule = gauss_rule(count, True)
    return rule.node, gauss_rule(count + 1, False).node, rule.weight, log_moments(count) @ rule.expansion


def make_segments(
    crest: Indices, origin: Array, centre: Array, half_width: Array, node_count: Indices, period: float
) -> Segments:
    """Segments, already in order, with so many nodes each."""
    first_node = np.append(0, np.cumsum(node_count))
    of_nodes = zip(*map(_quadrature, node_count.tolist()), strict=True)
    node, point, weight, log_weight = map(np.concatenate, of_nodes)
    return Segments(crest, origin, centre, half_width, first_node, node, point, weight, log_weight)


@kernel
def contacts_of(segments: Segments, dual: bool, period: float) -> tuple[Array, Array, Array]:
    """Origin, centre from there and half-width of each contact in order; those between gaps (dual) follow these."""
    origin, centre, half_width = segments.origin, segments.centre, segments.half_width
    if not dual:
        return origin, centre, half_width
    between = 0.5 * distances_between(origin, centre, half_width, period)
    return origin, centre + half_width + between, between


def in_order(middle: Array, half_width: Array, period: float) -> tuple[Array, Array, Indices]:
    """Segments with their middles in [0, L) and ascending, and the order that sorted them."""
    middle = middle - period * np.floor(middle / period)
    order = np.argsort(middle, kind="stable")
    return middle[order], half_width[order], order


@kernel
def distances_between(origin: Array, centre: Array, half_width: Array, period: float) -> Array:
    """From the right end of each segment to the left end of the next, round the period, in lambda_0."""
    distance = np.empty(centre.size)
    for k in range(distance.size):
        between_origins = origin[k] - origin[k - 1] + (period if k == 0 else 0.0)
        distance[k - 1] = between_origins + ((centre[k] - half_width[k]) - (centre[k - 1] + half_width[k - 1]))
    return distance


def estimate_node_count(
    origin: Array, centre: Array, half_width: Array, series: CosineSeries, tolerance: float
) -> Indices:
    """Nodes for the waves within each segment and for the singularities at the edges of its neighbours.

    The coefficients decay like rho^-k, where rho belongs to Bernstein's ellipse through the nearest such edge.
    """
    finest = float(series.wavenumber[-1])
    return np.asarray(_count_nodes(origin, centre, half_width, series.period, finest, _needs(tolerance)))


@kernel
def _count_nodes(
    origin: Array, centre: Array, half_width: Array, period: float, finest: float, needs: tuple[float, ...]
) -> Indices:
    least, per_radian, per_neighbour, per_twin = needs
    distance, count = distances_between(origin, centre, half_width, period), np.empty(centre.size, np.int64)
    for j in range(centre.size):
        r = half_width[j]
        nearest = min(max(min(distance[j], distance[j - 1]) / r, MIN_DISTANCE), MAX_DISTANCE)
        ln_rho = np.log1p(nearest + np.sqrt(nearest * (nearest + 2)))
        needed = least + per_radian * finest * r + (per_neighbour + per_twin / ln_rho) / ln_rho
        count[j] = np.int64(min(np.ceil(needed), MAX_NODES))
    return count


@lru_cache(maxsize=64)
def _needs(tolerance: float) -> tuple[float, ...]:
    """The parameters of the number of nodes for this tolerance."""
    tables = NODES_AT_LEAST, NODES_PER_RADIAN, NODES_PER_NEIGHBOUR, NODES_PER_TWIN
    return tuple(float(np.interp(-np.log10(tolerance), DIGITS, each)) for each in tables)


@kernel
def coefficient_tails(segments: Segments, coefficient: Array, skipped: int) -> Array:
    """Size of two Chebyshev coefficients before the last ones, which are 0, over that of the largest."""
    tail = np.empty(segments.centre.size)
    for j in range(tail.size):
        size = np.abs(coefficient[segments.first_node[j] : segments.first_node[j + 1]])
        tail[j] = size[size.size - skipped - 2 : size.size - skipped].max() / max(size.max(), 1e-300)
    return tail


@kernel
def are_resolved(segments: Segments, coefficient: Array, tolerance: float) -> Flags:
    """Whether the coefficients of each segment have decayed to the tolerance, or to rounding."""
    tail, widest = coefficient_tails(segments, coefficient, 0), segments.half_width.max()
    rounding = np.minimum(TAIL_ROUNDING * (widest / segments.half_width) ** 2, MAX_TAIL_ROUNDING)
    return tail <= np.maximum(tolerance, rounding)


def more_nodes(node_count: NDArray[np.int64]) -> Indices:
    """The next larger number of nodes for segments on which the coefficients have not decayed."""
    return np.minimum(np.ceil(MORE_NODES * node_count) + AT_LEAST_MORE, MAX_NODES).astype(np.int64)


def increase_node_count(count: Indices, resolved: Flags, load: float) -> Indices:
    """More nodes for the segments whose density they do not resolve yet."""
    if np.any(count[~resolved] >= MAX_NODES):
        raise ConvergenceError(
            f"under the mean pressure {load:.6g} p_0*, two contacts or two gaps are so close to each other that "
            f"{MAX_NODES} nodes on one of them do not resolve the density"
        )
    return np.where(resolved, count, more_nodes(count))
