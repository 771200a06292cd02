"""Heights and tensions of full contact, evaluated from their crests.

docs/patches.md, "Contacts and gaps", explains why positions are distances from crests and heights are relative to the
highest one: a new contact is so close to its crest that their height difference would be lost in rounding. Both are
Taylor polynomials (docs/numerics.md, "Heights of any number of waves").
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Indices
from weier.kernels.jit import kernel
from weier.methods.error_model import COMPLIANCE_ROUNDING
from weier.surface.crests import MAX_FOURTH, ORDER, Expansions, crest_heights, expand, find_crests
from weier.surface.waves import Waves, check_resolvable

# Positions on the line are counted from crests: of intervals the crest or its image, the middle from there, and the
# half-width, in lambda_0, each of shape (intervals,).
Extent = tuple[Array, Array, Array]
Sides = NDArray[np.float64]  # values at the left and the right edge of each interval, shape (intervals, 2)
Local = tuple[Expansions, Indices, Array, float]  # fields of a series that kernels evaluate it from

# relative to the sum of amplitudes: crests that differ by less are compared in extended precision, since their
# difference would have fewer than ten digits, and are equally high within `COMPLIANCE_ROUNDING`
TWIN_HEIGHT = 1e-6


class CosineSeries(NamedTuple):
    """S(x) = sum a_n cos(k_n x + phi_n) with its crests, in arrays for the kernels.

    S is a height, in g_0, or a tension, in p_0*.

    amplitude : a_n, in the unit of S, shape (terms,)
    wavenumber : k_n, in radians per lambda_0, increasing, shape (terms,)
    total_amplitude : sum |a_n|, in the unit of S
    period : L, in lambda_0
    step : distance between the nodes that S is expanded about, in lambda_0
    expansion : of S - max S in the distance over the step, about the crests and then about all nodes,
        shape (crests + nodes, ORDER + 1)
    crest_position : positions of the crests, in lambda_0, increasing, shape (crests,)
    crest_node, node_offset : the node nearest to each crest, and how far the crest is from it, in steps, at most 1/2,
        shape (crests,)
    crest_offset : S at each crest minus the maximum of S, <= 0, in the unit of S, shape (crests,)
    maximum : S at the highest crest
    largest_curvature : |S''| that the waves can have together
    fourth : bound of the fourth derivative of S up to half a step from each node, in the unit of S over lambda_0^4,
        shape (nodes,)
    """

    amplitude: Array
    wavenumber: Array
    total_amplitude: float
    period: float
    step: float
    expansion: Expansions
    crest_position: Array
    crest_node: Indices
    node_offset: Array
    crest_offset: Array
    maximum: float
    largest_curvature: float
    fourth: Array

    @property
    def local(self) -> Local:
        """The fields for `evaluate_series`: kernels take plain tuples at a fifth of the cost of named ones."""
        return self.expansion, self.crest_node, self.node_offset, self.step


class Surface(NamedTuple):
    """The two series that the solver needs: heights for contacts, and tensions for gaps.

    heights : z, in g_0: the first contact is on its highest crest
    tensions : minus the pressure of full contact, without its mean, in p_0*: the last gap is at its highest crest
    total_amplitude : sum g_n, in g_0
    """

    heights: CosineSeries
    tensions: CosineSeries
    total_amplitude: float

    @property
    def full_contact_load(self) -> float:
        """The mean pressure of full contact, equal to the largest tension, in p_0*."""
        return self.tensions.maximum

    @property
    def full_contact_energy(self) -> float:
        """The elastic energy <p u>/2 of full contact per area, in g_0 p_0*."""
        return float(self.heights.amplitude**2 @ self.heights.wavenumber) / (8 * np.pi)


def surface_of(profile: Waves) -> Surface:
    """Return the series of a profile with finitely many terms; ValueError if it has too many waves."""
    check_resolvable(profile)
    waves = profile.waves_per_period, profile.phase, profile.period
    return Surface(
        make_series(profile.amplitude, *waves),
        make_series(-profile.full_contact_pressure, *waves),
        profile.total_amplitude,
    )


def make_series(amplitude: Array, waves_per_period: Sequence[int], phase: Array, period: float) -> CosineSeries:
    """Return the series with its crests."""
    wavenumber = 2 * np.pi * np.array(waves_per_period, float) / period
    nodes = expand(amplitude, waves_per_period, phase)
    step, crests = period / len(nodes), find_crests(amplitude, waves_per_period, nodes)
    position = _round_positions((crests.node + crests.offset) * step, period)
    order = np.argsort(position, kind="stable")
    position, about = position[order], crests.expansion[order]
    maximum, most = float(about[:, 0].max()), float(np.abs(amplitude).sum())
    offset = about[:, 0] - maximum
    twins = offset > -TWIN_HEIGHT * most
    if np.any(twins & (offset < -0.5 * COMPLIANCE_ROUNDING * most)):  # otherwise all crests are equally high
        exact = crest_heights(amplitude, waves_per_period, phase, period, position[twins])
        offset[twins] = [float(height - max(exact)) for height in exact]
    offset[offset > -COMPLIANCE_ROUNDING * most] = 0.0
    about[:, 0], nodes[:, 0] = offset, nodes[:, 0] - maximum
    return CosineSeries(
        amplitude,
        wavenumber,
        most,
        float(period),
        step,
        np.concatenate([about, nodes]),
        position,
        crests.node[order],
        crests.offset[order],
        offset,
        maximum,
        float(np.abs(amplitude) @ wavenumber**2),
        np.abs(nodes) @ MAX_FOURTH / step**4,
    )


def _round_positions(x: Array, period: float) -> Array:
    """Return positions within [0, L), rounded so that adding or subtracting a period is exact.

    They become multiples of the spacing of floats just beyond 4 L.
    """
    x = (x % period + 4 * period) - 4 * period
    return np.asarray(np.where(x < period, x, 0.0))


@kernel
def evaluate_series(local: Local, crest: int, y: float) -> tuple[float, float, float]:
    """Return S - max S, S' and S'' at the distance y from a crest, without cancellation for small y.

    Within half a step the expansion about the crest is used, with slope 0: it is shifted from a node at most half a
    step away, whose expansion is valid up to one step. Beyond, that about the nearest node is used.
    """
    expansion, crest_node, node_offset, step = local
    t, row, crests = y / step, crest, crest_node.size
    if abs(t) > 0.5:
        t += node_offset[crest]
        steps = np.rint(t)
        t -= steps
        row = crests + (crest_node[crest] + np.int64(steps)) % (len(expansion) - crests)
    value, slope, half_curvature = expansion[row, ORDER], 0.0, 0.0
    for j in range(ORDER - 1, -1, -1):
        half_curvature = half_curvature * t + slope
        slope = slope * t + value
        value = value * t + expansion[row, j]
    return value, slope / step, 2 * half_curvature / step**2


@kernel
def evaluate_at(local: Local, crest: Indices, y: Array, derivative: int) -> Array:
    """Return S - max S, S' or S'' at the distances y from crests."""
    value = np.empty(y.size)
    for i in range(y.size):
        value[i] = evaluate_series(local, crest[i], y[i])[derivative]
    return value


@kernel
def evaluate_on(
    local: Local, crest: Indices, centre: Array, first_node: Indices, offset: Array, highest: float
) -> Array:
    """Return S at nodes of segments, from crests, centres, offsets from these, and its value at the maximum."""
    value = np.empty(offset.size)
    for j in range(crest.size):
        for i in range(first_node[j], first_node[j + 1]):
            value[i] = highest + evaluate_series(local, crest[j], centre[j] + offset[i])[0]
    return value


def nearest_crests(series: CosineSeries, x: Array) -> tuple[Indices, Array]:
    """Return the crests nearest to positions x on the periodic line, and the distances y from them."""
    return _nearest_crests(series.crest_position, series.period, x)


@kernel
def first_from(x: Array, value: float) -> int:
    """Return the first index from which ascending x is not below a value: np.searchsorted, cheaper to compile."""
    first, count = 0, x.size
    while count > 0:  # without branches, which processors would mispredict
        half = count // 2
        is_below = x[first + half] < value
        first += (half + 1) * is_below
        count = half - (1 - count % 2) * is_below
    return first


@kernel
def _nearest_crests(crest: Array, period: float, x: Array) -> tuple[Indices, Array]:
    nearest, y = np.empty(x.size, np.int64), np.empty(x.size)
    for i in range(x.size):
        nearest[i], y[i] = nearest_crest(crest, period, x[i])
    return nearest, y


@kernel
def nearest_crest(crest: Array, period: float, x: float) -> tuple[int, float]:
    """Return the crest nearest to one position, and the distance from it."""
    after, nearest, y = first_from(crest, x - period * np.floor(x / period)), 0, np.inf
    for neighbour in ((after - 1) % crest.size, after % crest.size):
        distance = x - crest[neighbour]
        distance -= period * np.rint(distance / period)
        if abs(distance) < abs(y):
            nearest, y = neighbour, distance
    return nearest, y


@kernel
def evaluate_near(local: Local, crest: Array, period: float, x: Array) -> Array:
    """Return S - max S at positions x on the periodic line, from the positions of the crests."""
    value = np.empty(x.size)
    for i in range(x.size):
        value[i] = evaluate_series(local, *nearest_crest(crest, period, x[i]))[0]
    return value


def from_crests(series: CosineSeries, middle: Array) -> tuple[Indices, Array, Array]:
    """Return the crests nearest to positions, with the places of their images and the distances."""
    crest, y = nearest_crests(series, middle)
    origin = series.crest_position[crest]
    return crest, origin + series.period * np.rint((middle - y - origin) / series.period), y


def in_order(middle: Array, period: float) -> tuple[Indices, Array]:
    """Return the order of positions in [0, L), and the shift of each into that interval."""
    turns = period * np.floor(middle / period)
    return np.argsort(middle - turns, kind="stable"), turns


def intervals_between(extent: Extent, period: float) -> Extent:
    """Return the interval on the right of each of these intervals, which are in order round the period."""
    origin, centre, half_width = extent
    half_gap = 0.5 * distances_between(origin, centre, half_width, period)
    return origin, centre + half_width + half_gap, half_gap


@kernel
def distances_between(origin: Array, centre: Array, half_width: Array, period: float) -> Array:
    """Return the distances between intervals in order, from right to next left end, in lambda_0."""
    distance = np.empty(centre.size)
    for k in range(distance.size):
        between_origins = origin[k] - origin[k - 1] + (period if k == 0 else 0.0)
        distance[k - 1] = between_origins + ((centre[k] - half_width[k]) - (centre[k - 1] + half_width[k - 1]))
    return distance
