"""Segments (contacts or gaps) of a period with their nodes and densities.

docs/patches.md: "Contacts and gaps" and "Edges" for the content of a state, "Chebyshev polynomials" for nodes,
strengths and the number of nodes. A `ContactState` contains the segments at one load and sqrt(1-t^2) phi(t) on each,
-1 <= t <= 1 (`weier.methods.chebyshev`).
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Indices, Records, record_type
from weier.kernels.jit import kernel
from weier.methods.patches.kind import MAX_THINNESS, Kind
from weier.methods.patches.surface import CosineSeries, Extent, Sides, distances_between

# Nodes of one segment. Twelve digits need more where two segments are closer than 3e-5 of their half-width.
MAX_NODES = 2000
# K_0, K_1 and K_2, each with its slope over the digits: `python -m benchmarks node_counts` fits them
NODE_FACTORS = (4.5, 0.25), (2.2, -0.125), (-8.7, 1.95)


@kernel
def edge_strengths(first_node: Indices, r: Array, coefficient: Array, power: float) -> NDArray[np.float64]:
    """Return k_0 from coefficients in T_k (power 0) or k_1 from those in U_k (power 1), shape (segments, 2).

    T_k(+-1) = (+-1)^k, U_k(+-1) = (+-1)^k (k + 1). numba would compile the kernel for each integer.
    """
    found = np.empty((r.size, 2))
    for j in range(r.size):
        left, right, sign = 0.0, 0.0, 1.0
        for q in range(first_node[j], first_node[j + 1]):
            value = coefficient[q] * (1 + power * (q - first_node[j]))
            left += sign * value
            right += value
            sign = -sign
        factor = np.sqrt(2 / r[j] if power == 1 else 0.5 * r[j])
        found[j, 0], found[j, 1] = factor * left, factor * right
    return found


SegmentArrays = tuple[Array, Array, Array, Indices]


class Segments(NamedTuple):
    """Segments [c-r, c+r] in order round the period, with their nodes numbered consecutively.

    crest : index of the crest from which the segment's position is counted, shape (segments,)
    origin : position of that crest, or of its image next to the segment, in lambda_0, shape (segments,)
    centre, half_width : c from the origin, and r, in lambda_0, shape (segments,)
    first_node : index of each segment's first node and, last, the number of all nodes, shape (segments + 1,);
        none of a guess
    """

    crest: Indices
    origin: Array
    centre: Array
    half_width: Array
    first_node: Indices = np.empty(0, np.int64)

    @property
    def node_count(self) -> Indices:
        """The number of nodes of each segment, shape (segments,)."""
        return self.first_node[1:] - self.first_node[:-1]

    @property
    def extent(self) -> Extent:
        """Origin, centre from there and half-width of each, in lambda_0."""
        return self.origin, self.centre, self.half_width

    @property
    def arrays(self) -> SegmentArrays:
        """Origin, centre, half-width and first node, in a plain tuple for kernels."""
        return self.origin, self.centre, self.half_width, self.first_node

    @property
    def middle(self) -> Array:
        """The middle of each segment, in lambda_0, shape (segments,)."""
        return self.origin + self.centre

    @property
    def right(self) -> Array:
        """The right end of each segment, in lambda_0, shape (segments,)."""
        return self.origin + (self.centre + self.half_width)


# Minima of the gap between contacts, or of the pressure between gaps, each with its position, in lambda_0, and the
# index of the segment on the left; also minima of the gap on a segment, with its index.
MINIMUM = record_type(("interval", np.int64, ()), ("position value curvature", np.float64, ()))


class Cracks(NamedTuple):
    """Thin gaps within contacts in order, each field of shape (cracks,).

    contact : index of the contact, from left to right
    middle, reach : middle and half-width in its coordinate t, from -1 to 1
    half_width : b, in lambda_0
    strength : A of the pressure A s^(1/2) at the distance s from both edges, in p_0*/lambda_0^(1/2)
    tangent_strength : B of the increment B/s^(1/2) there, in lambda_0^(1/2)
    volume : int w dx, in g_0 lambda_0
    lift : increase of the mean gap at given load, in g_0
    rise : increase of the resistance, in g_0/p_0*
    """

    contact: Indices = np.empty(0, np.int64)
    middle: Array = np.empty(0)
    reach: Array = np.empty(0)
    half_width: Array = np.empty(0)
    strength: Array = np.empty(0)
    tangent_strength: Array = np.empty(0)
    volume: Array = np.empty(0)
    lift: Array = np.empty(0)
    rise: Array = np.empty(0)


class ContactState(NamedTuple):
    """The state under one load, or a guess at it: contacts with their pressure, or gaps with their slope.

    kind : `CONTACTS` or `GAPS`
    load : mean pressure, in p_0*
    approach : indentation from first contact or, with gaps, minus the mean gap, in g_0
    segments : the contacts or the gaps
    coefficient : coefficients of phi in U_k, segment by segment, shape (nodes,); sqrt(1-t^2) phi is the pressure, in
        p_0*, or the slope of the gap, in g_0/lambda_0
    resistance : dh/dp, in g_0/p_0*
    tangent_strength : B at the left and right edges of each segment, shape (segments, 2), in lambda_0^(1/2): the
        derivative of the pressure with respect to the mean pressure is B/s^(1/2) at the distance s inside a contact
    edge_move : move of each edge in the next step, shape (segments, 2), in lambda_0
    residual : largest violation of a contact condition, in g_0
    error : bound on the error of the approach due to violations, in g_0
    height_error : largest difference between z and heights for which the state is exact, in g_0
    roughness : sum n |c_n| of the coefficients in T_n of the residual on each segment, in its unit
    cracks : gaps within contacts that are too thin for segments of their own, whose effect is in `approach` and
        `resistance`
    tensions : remaining intervals of tension on contacts, where a gap is missing or too narrow to be resolved: the
        index of the contact, middle and half-width in its coordinate t, shape (intervals, 3)
    narrow_gaps : minima of the gap below its uncertainty, where a contact may be born
    steps, corrections : number of solutions on given edges, and of corrections of the set of segments, before it
    attempts : 1, or 2 if the first one failed

    The fields from `resistance` to `narrow_gaps` are NaN or empty until they are computed.
    """

    kind: Kind
    load: float
    approach: float
    segments: Segments
    coefficient: Array = np.empty(0)
    resistance: float = np.nan
    tangent_strength: NDArray[np.float64] = np.empty((0, 2))
    edge_move: NDArray[np.float64] = np.empty((0, 2))
    residual: float = np.nan
    error: float = np.nan
    height_error: float = np.nan
    roughness: Array = np.empty(0)
    cracks: Cracks = Cracks()
    tensions: NDArray[np.float64] = np.empty((0, 3))
    narrow_gaps: Records = np.empty(0, MINIMUM)
    steps: int = 0
    corrections: int = 0
    attempts: int = 1

    def indentation(self, top: float) -> float:
        """Return the distance of the plane below a height `top`, from which the approach of contacts is counted."""
        return top - self.kind.uniform(top) + self.approach


def segment_strengths(state: ContactState) -> Sides:
    """Return k_1 of the pressure k_1 s^(1/2) at left and right edges, shape (segments, 2), from U_k(1).

    In p_0*/lambda_0^(1/2). At the edges of a gap it is the slope over 2 pi, negative at the right edge.
    """
    segments = state.segments
    strength = edge_strengths(segments.first_node, segments.half_width, state.coefficient, 1.0)
    return np.asarray(state.kind.strength_factor * strength)


def contact_extent(state: ContactState, period: float) -> Extent:
    """Return the contacts between all gaps, thin ones included."""
    if state.cracks.contact.size > 0:
        return contact_pieces(state, period)[0]
    return state.kind.contacts_of(state.segments.extent, period)


def contact_pieces(state: ContactState, period: float) -> tuple[Extent, Sides, Sides]:
    """Return the contacts of `contact_extent`, and the strengths A and B at their edges.

    A of the pressure is in p_0*/lambda_0^(1/2), B of its increment in lambda_0^(1/2), shape (contacts, 2).
    """
    extent, cracks = state.kind.contacts_of(state.segments.extent, period), state.cracks
    strength = state.kind.at_contacts(np.abs(segment_strengths(state)))
    tangent = state.kind.at_contacts(state.tangent_strength)
    if cracks.contact.size == 0:
        return extent, strength, tangent
    count = extent[0].size
    of = np.repeat(np.arange(count), 1 + np.bincount(cracks.contact, minlength=count))
    before_crack = cracks.contact + np.arange(cracks.contact.size)
    start, end, strength, tangent = np.full(of.size, -1.0), np.ones(of.size), strength[of], tangent[of]
    end[before_crack] = cracks.middle - cracks.reach
    start[before_crack + 1] = cracks.middle + cracks.reach
    strength[before_crack, 1] = strength[before_crack + 1, 0] = cracks.strength
    tangent[before_crack, 1] = tangent[before_crack + 1, 0] = cracks.tangent_strength
    origin, centre, r = (values[of] for values in extent)
    return (origin, centre + 0.5 * r * (start + end), 0.5 * r * (end - start)), strength, tangent


def make_segments(crest: Indices, origin: Array, centre: Array, half_width: Array, node_count: Indices) -> Segments:
    """Return segments, already sorted, with these numbers of nodes."""
    first_node = np.zeros(node_count.size + 1, np.int64)
    node_count.cumsum(out=first_node[1:])
    return Segments(crest, origin, centre, half_width, first_node)


def estimate_node_count(extent: Extent, series: CosineSeries, tolerance: float) -> Indices:
    """Return the number of nodes for the waves on each segment and for the edges of its neighbours."""
    finest = float(series.wavenumber[-1])
    return np.asarray(count_nodes(*extent, series.period, finest, node_factors(tolerance)))


@kernel
def count_nodes(
    origin: Array, centre: Array, half_width: Array, period: float, finest: float, factors: tuple[float, ...]
) -> Indices:
    """Return the nodes of `estimate_node_count`, from the factors of the formula."""
    least, per_radian, per_neighbour = factors
    distance, count = distances_between(origin, centre, half_width, period), np.empty(centre.size, np.int64)
    for j in range(centre.size):
        r = half_width[j]
        nearest = max(min(distance[j], distance[j - 1]) / r, 2 * MAX_THINNESS)  # Narrower gaps are cracks.
        ln_rho = np.log1p(nearest + np.sqrt(nearest) * np.sqrt(nearest + 2))
        needed = least + per_radian * finest * r + per_neighbour / ln_rho
        count[j] = _round_up(np.ceil(needed) + 2)  # The last two coefficients are 0.
    return count


@kernel
def _round_up(count: float) -> float:
    """Return the next even multiple of an eighth of the power of 2 below the count, so that rules are few.

    The result is a number of nodes for any float: `place_nodes` refuses segments whose widths are not positive.
    """
    if not 4 < count < MAX_NODES:
        return 1.0 * MAX_NODES if count >= MAX_NODES else 4.0
    step = 2.0 ** max(1.0, np.floor(np.log2(count)) - 3)
    return min(np.ceil(count / step) * step, 1.0 * MAX_NODES)


@lru_cache
def node_factors(
    tolerance: float, factors: tuple[tuple[float, float], ...] = NODE_FACTORS
) -> tuple[float, float, float]:
    """Return K_0, K_1 and K_2 of K_0 + K_1 k_f r + K_2/ln(rho), each linear in the digits of the tolerance."""
    digits = -float(np.log10(tolerance))
    least, per_radian, per_neighbour = (constant + slope * digits for constant, slope in factors)
    return least, max(1.0, per_radian), per_neighbour


def coefficient_tails(segments: Segments, coefficient: Array) -> Array:
    """Return the larger of the last two non-zero coefficients of the regular part over the largest coefficient.

    Its last two are 0, since psi is unknown two degrees higher.
    """
    size, last = np.abs(coefficient), segments.first_node[1:] - 2
    largest = np.maximum.reduceat(size, segments.first_node[:-1])
    return np.asarray(np.maximum(size[last - 1], size[last - 2]) / np.maximum(largest, 1e-300))


@kernel
def more_nodes(count: Indices, height: Array, most: float) -> tuple[Indices, bool]:
    """Return the numbers of nodes, the next larger ones for segments of too large a height, and whether any is."""
    more, is_more = count.copy(), False
    for j in range(count.size):
        if height[j] > most:
            more[j] = _round_up(1.3 * count[j])
            is_more = is_more or more[j] > count[j]
    return more, is_more
