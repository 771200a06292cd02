"""The equations of a set of segments with free ends, their Jacobian, and Newton's method.

One kernel serves two problems, for both are int rho(s) cot(pi (x-s)/L) ds = f(x) on segments whose ends are
sought, with rho = sqrt(1-t^2) phi(t):

contacts (primal)
    rho is the pressure, f = -L z'/(2 pi); one equation of height a patch,
    2 int rho ln|2 sin(pi (x-s)/L)| ds + indentation + z - max z = 0, and the load, int rho dx = p L.
gaps (dual)
    rho is the slope of the gap, f = -2 pi L p_full; each gap closes at its far end, int rho dx = 0, and its
    moment is the mean gap d = -(1/L) int (x - c) rho dx.

Unknowns, in this order: phi at all nodes; centres and half-widths, in units of the half-width; and the
approach: indentation (primal) or -d (dual), so that its derivative in p is the resistance in both.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.jit import kernel
from weier.patches.chebyshev import central_logarithm, collocation_point, nodes, weights
from weier.patches.waves import Waves, excess

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

CONVERGED, STALLED, TOPOLOGY = 0, 1, 2
MOST_STEPS = 25
SMALLEST_SHRINKAGE = -0.6  # of ln(half-width) in one step
LARGEST_GROWTH = 1.2
LARGEST_CLOSING = 0.7  # of the space between two segments in one step
MOST_CRAMPED = 2  # steps that would join or remove segments, before that is done
CLOSED = 0.1  # of a space at the start: still closing, it will not stay open
ROUNDING_STEP = 1e-7  # steps below this that no longer shrink have met rounding


class Segments(NamedTuple):
    """Segments [c-r, c+r], each `centre` counted from a summit, with the nodes of all of them in a row.

    `sine` and `cosine` are those of pi r s/L at the nodes s: with them sin(pi (x-s)/L) needs no call, and loses
    no digit either, for the two angles that it combines are counted from the segment's own centre.
    """

    summit: Indices
    origin: Array
    centre: Array
    half_width: Array
    first: Indices
    node: Array
    weight: Array
    central: Array
    sine: Array
    cosine: Array


class Iterate(NamedTuple):
    """Newton's result: `status`, steps taken, size of the last step, and the state."""

    status: int
    steps: int
    size: float
    centre: Array
    half_width: Array
    phi: Array
    approach: float
    sensitivity: Array
    closing: NDArray[np.bool_]
    vanishing: NDArray[np.bool_]


@kernel
def segments(
    summit: Indices, origin: Array, centre: Array, half_width: Array, count: Indices, period: float
) -> Segments:
    """Segments with `count` nodes each."""
    first = np.zeros(count.size + 1, np.int64)
    for j in range(count.size):
        first[j + 1] = first[j] + count[j]
    node, weight, central = np.empty(first[-1]), np.empty(first[-1]), np.empty(first[-1])
    for j in range(count.size):
        if j == 0 or count[j] != count[j - 1]:
            s, w, c = nodes(count[j]), weights(count[j]), central_logarithm(count[j])
        for q in range(count[j]):
            node[first[j] + q], weight[first[j] + q], central[first[j] + q] = s[q], w[q], c[q]
    sine, cosine = _turns(half_width, first, node, period)
    return Segments(summit, origin, centre, half_width, first, node, weight, central, sine, cosine)


@kernel
def _turns(half_width: Array, first: Indices, node: Array, period: float) -> tuple[Array, Array]:
    sine, cosine = np.empty(node.size), np.empty(node.size)
    for j in range(half_width.size):
        for q in range(first[j], first[j + 1]):
            angle = np.pi / period * half_width[j] * node[q]
            sine[q], cosine[q] = np.sin(angle), np.cos(angle)
    return sine, cosine


@kernel
def moved(segments: Segments, centre: Array, half_width: Array, period: float) -> Segments:
    """The same segments elsewhere."""
    sine, cosine = _turns(half_width, segments.first, segments.node, period)
    return Segments(
        segments.summit,
        segments.origin,
        centre,
        half_width,
        segments.first,
        segments.node,
        segments.weight,
        segments.central,
        sine,
        cosine,
    )


@kernel
def spaces(segments: Segments, period: float) -> Array:
    """Distance from each segment's right end to the next one's left end, round the period."""
    n = segments.centre.size
    space = np.empty(n)
    for j in range(n):
        k = (j + 1) % n
        apart = segments.origin[k] - segments.origin[j] + (period if k <= j else 0.0)
        left = segments.centre[k] - segments.half_width[k]
        space[j] = apart + (left - (segments.centre[j] + segments.half_width[j]))
    return space


@kernel
def assemble(
    segments: Segments, phi: Array, approach: float, waves: Waves, load: float, dual: bool
) -> tuple[Array, Array]:
    """The Jacobian and, as columns, the residual and its derivative in the mean pressure."""
    n, size = segments.centre.size, phi.size + 2 * segments.centre.size + 1
    jacobian, right = np.zeros((size, size)), np.zeros((size, 2))
    for i in range(n):
        count = segments.first[i + 1] - segments.first[i]
        for a in range(count + 1):
            row, t = segments.first[i] + i + a, collocation_point(a, count)
            _collocate(jacobian, right, segments, phi, waves, load, dual, i, t, row)
    for i in range(n):
        row = phi.size + n + i
        if dual:
            _close(jacobian, right, segments, phi, i, row)
        else:
            _match_height(jacobian, right, segments, phi, approach, waves, i, row)
    if dual:
        _measure_gap(jacobian, right, segments, phi, approach, waves.period)
    else:
        _balance_load(jacobian, right, segments, phi, load * waves.period, waves.period)
    return jacobian, right


@kernel
def _collocate(
    jacobian: Array,
    right: Array,
    segments: Segments,
    phi: Array,
    waves: Waves,
    load: float,
    dual: bool,
    i: int,
    t: float,
    row: int,
) -> None:
    # int rho cot ds - f = 0 at the point t of segment i.
    n, N = segments.centre.size, phi.size
    factor = np.pi / waves.period
    y = segments.centre[i] + segments.half_width[i] * t
    value, slope, curvature = excess(waves, segments.summit[i], y)
    if dual:
        force = 2 * np.pi * waves.period * (load - waves.top - value)
        stretch = -2 * np.pi * waves.period * slope
        right[row, 1] = 2 * np.pi * waves.period
    else:
        force = slope / (2 * factor)
        stretch = curvature / (2 * factor)
    total = force
    for j in range(n):
        r = segments.half_width[j]
        apart = segments.origin[i] - segments.origin[j] + (y - segments.centre[j])
        along, about = 0.0, 0.0
        if i == j:
            apart = r * t
        sine, cosine = np.sin(factor * apart), np.cos(factor * apart)
        if i == j:
            for q in range(segments.first[j], segments.first[j + 1]):
                d = factor * r * (t - segments.node[q])
                cot = _cotangent(sine, cosine, segments.sine[q], segments.cosine[q])
                share = r * segments.weight[q]
                jacobian[row, q] = share * cot
                total += share * phi[q] * cot
                about += share * phi[q] * (cot - d * (1 + cot * cot))
        else:
            for q in range(segments.first[j], segments.first[j + 1]):
                cot = _cotangent(sine, cosine, segments.sine[q], segments.cosine[q])
                share = r * segments.weight[q]
                jacobian[row, q] = share * cot
                push = share * phi[q] * cot
                pull = share * phi[q] * factor * (1 + cot * cot)
                total += push
                along += pull
                about += push + r * segments.node[q] * pull
            stretch -= along
        jacobian[row, N + j] += along * r
        jacobian[row, N + n + j] += about
    jacobian[row, N + i] += stretch * segments.half_width[i]
    jacobian[row, N + n + i] += stretch * segments.half_width[i] * t
    right[row, 0] = total


@kernel
def _cotangent(sine: float, cosine: float, other_sine: float, other_cosine: float) -> float:
    return (cosine * other_cosine + sine * other_sine) / (sine * other_cosine - cosine * other_sine)


@kernel
def _match_height(
    jacobian: Array,
    right: Array,
    segments: Segments,
    phi: Array,
    approach: float,
    waves: Waves,
    i: int,
    row: int,
) -> None:
    # The gap is 0 at the centre of patch i; divided by r_i, so that all rows are of one size.
    n, N = segments.centre.size, phi.size
    factor = np.pi / waves.period
    value, slope, _ = excess(waves, segments.summit[i], segments.centre[i])
    scale = 1 / segments.half_width[i]
    total = (approach + value) * scale
    tilt = slope
    for j in range(n):
        r = segments.half_width[j]
        apart = segments.origin[i] - segments.origin[j] + (segments.centre[i] - segments.centre[j])
        along, about = 0.0, 0.0
        for q in range(segments.first[j], segments.first[j + 1]):
            s = segments.node[q]
            if i == j:
                d = factor * r * s
                small = abs(d) < 1e-8
                log = np.log(2 * factor) if small else np.log(abs(2 * np.sin(d) / (r * s)))
                potential = r * (segments.weight[q] * (np.log(r) + log) + segments.central[q])
                pull = 0.0
                turn = 1.0 if small else d / np.tan(d)
            else:
                d = factor * (apart - r * s)
                potential = r * segments.weight[q] * np.log(abs(2 * np.sin(d)))
                pull = factor / np.tan(d)
                turn = -r * s * pull
            jacobian[row, q] = 2 * potential * scale
            total += 2 * potential * phi[q] * scale
            along -= 2 * r * segments.weight[q] * phi[q] * pull
            about += 2 * (potential + r * segments.weight[q] * turn) * phi[q]
        tilt -= along
        jacobian[row, N + j] += along * r * scale
        jacobian[row, N + n + j] += about * scale
    jacobian[row, N + i] += tilt
    jacobian[row, N + 2 * n] = scale
    right[row, 0] = total


@kernel
def _balance_load(jacobian: Array, right: Array, segments: Segments, phi: Array, force: float, period: float) -> None:
    n, N = segments.centre.size, phi.size
    widest = 0.0
    for r in segments.half_width:
        widest = max(widest, r)
    scale = 1 / widest
    total = 0.0
    for j in range(n):
        share = 0.0
        for q in range(segments.first[j], segments.first[j + 1]):
            weight = segments.half_width[j] * segments.weight[q] * scale
            jacobian[N + 2 * n, q] = weight
            share += weight * phi[q]
        jacobian[N + 2 * n, N + n + j] = share
        total += share
    right[N + 2 * n, 0] = total - force * scale
    right[N + 2 * n, 1] = -period * scale


@kernel
def _close(jacobian: Array, right: Array, segments: Segments, phi: Array, i: int, row: int) -> None:
    # The gap that opens at one end of gap i has closed at the other.
    for q in range(segments.first[i], segments.first[i + 1]):
        jacobian[row, q] = segments.weight[q]
        right[row, 0] += segments.weight[q] * phi[q]


@kernel
def _measure_gap(
    jacobian: Array, right: Array, segments: Segments, phi: Array, approach: float, period: float
) -> None:
    n, N = segments.centre.size, phi.size
    total = -approach
    for j in range(n):
        share = 0.0
        for q in range(segments.first[j], segments.first[j + 1]):
            weight = segments.half_width[j] ** 2 * segments.weight[q] * segments.node[q] / period
            jacobian[N + 2 * n, q] = weight
            share += weight * phi[q]
        jacobian[N + 2 * n, N + n + j] = 2 * share
        total += share
    jacobian[N + 2 * n, N + 2 * n] = -1.0
    right[N + 2 * n, 0] = total


@kernel
def newton(
    segments: Segments, phi: Array, approach: float, waves: Waves, load: float, dual: bool, tolerance: float
) -> Iterate:
    """Solve for phi, centres, half-widths and approach.

    The status is TOPOLOGY where a segment insists on vanishing or two on meeting: `vanishing` and `closing`
    (by the segment on the left) name them.
    """
    here = moved(segments, segments.centre.copy(), segments.half_width.copy(), waves.period)
    phi = phi.copy()
    start = spaces(here, waves.period)
    closing, vanishing = np.zeros(start.size, np.bool_), np.zeros(start.size, np.bool_)
    size, cramped, status, steps = np.inf, 0, STALLED, 0
    change = np.zeros((phi.size + 2 * start.size + 1, 2))
    while status == STALLED and steps < MOST_STEPS:
        jacobian, right = assemble(here, phi, approach, waves, load, dual)
        change[:] = np.linalg.solve(jacobian, right)
        steps += 1
        before, size = size, _size(here, phi, change)
        if not size < np.inf:
            break
        damping = _damping(here, change, waves.period, start, closing, vanishing)
        here = _stepped(here, phi, change, damping, waves.period)
        approach -= damping * change[-1, 0]
        if damping < 1:
            cramped += 1 if np.any(closing) or np.any(vanishing) else 0
            if cramped == MOST_CRAMPED:
                status = TOPOLOGY
        elif size < tolerance or (size < ROUNDING_STEP and size > 0.3 * before):
            status = CONVERGED
    sensitivity = np.empty(change.shape[0])
    for i in range(sensitivity.size):
        sensitivity[i] = -change[i, 1]
    return Iterate(status, steps, size, here.centre, here.half_width, phi, approach, sensitivity, closing, vanishing)


@kernel
def _stepped(segments: Segments, phi: Array, change: Array, damping: float, period: float) -> Segments:
    # phi changes in place; the unknowns of place and width are in units of the half-width.
    n, N = segments.centre.size, phi.size
    centre, half_width = np.empty(n), np.empty(n)
    for q in range(N):
        phi[q] -= damping * change[q, 0]
    for j in range(n):
        r = segments.half_width[j]
        centre[j] = segments.centre[j] - damping * change[N + j, 0] * r
        half_width[j] = r * (1 - damping * change[N + n + j, 0])
    return moved(segments, centre, half_width, period)


@kernel
def _damping(
    segments: Segments,
    change: Array,
    period: float,
    start: Array,
    closing: NDArray[np.bool_],
    vanishing: NDArray[np.bool_],
) -> float:
    # The share of a step that keeps all segments apart and of their order of width; flags what it works against.
    n = start.size
    N = change.shape[0] - 2 * n - 1
    damping = 1.0
    space = spaces(segments, period)
    for j in range(n):
        k, r = (j + 1) % n, segments.half_width
        growth = -change[N + n + j, 0]
        loss = r[j] * (growth - change[N + j, 0]) - r[k] * (change[N + n + k, 0] - change[N + k, 0])
        closing[j] = loss > LARGEST_CLOSING * space[j] and (loss > space[j] or space[j] < CLOSED * start[j])
        vanishing[j] = growth < -1
        if loss > LARGEST_CLOSING * space[j]:
            damping = min(damping, LARGEST_CLOSING * space[j] / loss)
        if growth < SMALLEST_SHRINKAGE:
            damping = min(damping, SMALLEST_SHRINKAGE / growth)
        if growth > LARGEST_GROWTH:
            damping = min(damping, LARGEST_GROWTH / growth)
    return damping


@kernel
def _size(segments: Segments, phi: Array, change: Array) -> float:
    # The largest relative change of any segment's density, place or width; not a number if any is none.
    n, N, size = segments.centre.size, phi.size, 0.0
    for j in range(n):
        largest, most = 0.0, 0.0
        for q in range(segments.first[j], segments.first[j + 1]):
            largest = max(largest, abs(phi[q]))
            most = max(most, abs(change[q, 0]))
        size = max(size, most / largest, abs(change[N + j, 0]), abs(change[N + n + j, 0]))
    for i in range(change.shape[0]):
        if not np.isfinite(change[i, 0]):
            return np.nan
    return size
