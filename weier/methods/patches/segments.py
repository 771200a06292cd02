"""Segments of the period, which are contacts or gaps, with their Chebyshev nodes; and how many nodes they need."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.jit import kernel
from weier.methods.errors import ConvergenceError
from weier.methods.patches.chebyshev import gauss_rule, log_moments
from weier.methods.patches.surface import CosineSeries

# The error of Gauss's quadrature is rho^(-2 (K+1)), where rho belongs to the largest Bernstein ellipse that holds no
# pole: 1e-16 from ln(rho) = 18.5/(K+1) on.
FAR_FIELD_EXPONENT = 18.5
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


class Segments(NamedTuple):
    """Segments [c-r, c+r] in order round the period, with the nodes of all of them in a row.

    crest : index of the crest from which the segment's position is counted, shape (segments,)
    origin : position of that crest, or of its image next to the segment, in lambda_0, shape (segments,)
    centre, half_width : c from the origin, and r, in lambda_0, shape (segments,)
    first_node : index of each segment's first node and, last, the number of all nodes, shape (segments + 1,)
    node : Gauss nodes t in (-1, 1), ascending within a segment, shape (nodes,)
    weight : for int sqrt(1-t^2) phi dt over a segment, shape (nodes,)
    log_weight : for int sqrt(1-t^2) phi ln|t| dt, shape (nodes,)
    far_field : distance from c from which on the quadrature is exact to rounding, in half-widths, shape (segments,)
    centre_sine, centre_cosine : of pi x/L at the centres, shape (segments,)
    sine, cosine : of pi r t/L at the nodes, shape (nodes,). By the addition theorem, they give sin(pi (x-s)/L)
        without a further call; no digit is lost, for both angles are counted from the centre of one segment.
    """

    crest: Indices
    origin: Array
    centre: Array
    half_width: Array
    first_node: Indices
    node: Array
    weight: Array
    log_weight: Array
    far_field: Array
    centre_sine: Array
    centre_cosine: Array
    sine: Array
    cosine: Array


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
def _quadrature(count: int) -> tuple[Array, Array, Array]:
    """Nodes, weights and weights for ln|t| of so many nodes."""
    rule = gauss_rule(count, True)
    return rule.node, rule.weight, log_moments(count) @ rule.expansion


def make_segments(
    crest: Indices, origin: Array, centre: Array, half_width: Array, node_count: Indices, period: float
) -> Segments:
    """Segments, already in order, with so many nodes each."""
    first_node = np.append(0, np.cumsum(node_count))
    node, weight, log_weight = (
        np.concatenate(each) for each in zip(*map(_quadrature, node_count.tolist()), strict=True)
    )
    far_field = np.cosh(FAR_FIELD_EXPONENT / (node_count + 1))
    new = Segments(
        crest, origin, centre, half_width, first_node, node, weight, log_weight, far_field, centre, centre, node, node
    )
    return move_segments(new, centre, half_width, period)


def move_segments(segments: Segments, centre: Array, half_width: Array, period: float) -> Segments:
    """Segments of the same contacts and nodes, with other centres and half-widths."""
    centre_angle = np.pi / period * (segments.origin + centre)
    angle = np.pi / period * np.repeat(half_width, np.diff(segments.first_node)) * segments.node
    return segments._replace(
        centre=centre, half_width=half_width, centre_sine=np.sin(centre_angle), centre_cosine=np.cos(centre_angle),
        sine=np.sin(angle), cosine=np.cos(angle),
    )  # fmt: skip


def distances_to_next(segments: Segments, period: float) -> Array:
    """Distance from the right end of each segment to the left end of the next, round the period, in lambda_0."""
    return distances_between(segments.origin, segments.centre, segments.half_width, period)


def contacts_of(segments: Segments, dual: bool, period: float) -> tuple[Array, Array, Array]:
    """Origin, centre from there and half-width of each contact in order; those between gaps (dual) follow these."""
    if not dual:
        return segments.origin, segments.centre, segments.half_width
    half_width = 0.5 * distances_to_next(segments, period)
    return segments.origin, segments.centre + segments.half_width + half_width, half_width


def in_order(middle: Array, half_width: Array, period: float) -> tuple[Array, Array, Indices]:
    """Segments with their middles in [0, L) and ascending, and the order that sorted them."""
    middle = middle - period * np.floor(middle / period)
    order = np.argsort(middle, kind="stable")
    return middle[order], half_width[order], order


@kernel
def distances_between(origin: Array, centre: Array, half_width: Array, period: float) -> Array:
    """As `distances_to_next`, in lambda_0, shape (segments,), of segments that have no nodes yet."""
    n, distance = centre.size, np.empty(centre.size)
    for j in range(n):
        k = (j + 1) % n
        between_origins = origin[k] - origin[j] + (period if k == 0 else 0.0)
        distance[j] = between_origins + (centre[k] - half_width[k] - (centre[j] + half_width[j]))
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


def coefficient_tails(segments: Segments, coefficient: Array, skipped: int) -> Array:
    """Size of two Chebyshev coefficients before the last ones, which are 0, over that of the largest."""
    size, last = np.abs(coefficient), segments.first_node[1:] - 1 - skipped
    largest = np.maximum.reduceat(size, segments.first_node[:-1])
    return np.asarray(np.maximum(size[last], size[last - 1]) / np.maximum(largest, 1e-300))


def are_resolved(segments: Segments, coefficient: Array, tolerance: float) -> Flags:
    """Whether the coefficients of each segment have decayed to the tolerance, or to rounding."""
    tail, widest = coefficient_tails(segments, coefficient, 0), segments.half_width.max()
    rounding = np.minimum(TAIL_ROUNDING * (widest / segments.half_width) ** 2, MAX_TAIL_ROUNDING)
    return np.asarray(tail <= np.maximum(tolerance, rounding))


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
