"""The equations of `collocation` without their matrix: residuals, and derivatives along one direction.

Rows and unknowns are in the same order and units. The sums over the nodes of one segment run, for each node, over all
points of another: then nothing is added up across a register, and the compiler works on several points at a time.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array
from weier.kernels.jit import kernel
from weier.methods.patches.collocation import (
    angle_between_centres,
    collocation_points,
    log_potential_at_other_centre,
    log_potential_at_own_centre,
)
from weier.methods.patches.segments import Segments
from weier.methods.patches.surface import CosineSeries, evaluate_series


class Change(NamedTuple):
    """A direction in the space of unknowns.

    phi : shape (nodes,)
    centre, half_width : in half-widths, shape (segments,)
    approach : in g_0
    """

    phi: Array
    centre: Array
    half_width: Array
    approach: float


def change_of(unknowns: Array, segments: int) -> Change:
    """The parts of a vector of unknowns."""
    nodes = unknowns.size - 2 * segments - 1
    return Change(unknowns[:nodes], unknowns[nodes : nodes + segments], unknowns[nodes + segments : -1], unknowns[-1])


@kernel
def residuals(
    segments: Segments, phi: Array, approach: float, series: CosineSeries, load: float, dual: bool
) -> Array:
    """What the equations are off, shape (unknowns,)."""
    n, period = segments.centre.size, series.period
    heights = phi.size + n
    row = np.zeros(heights + n + 1)
    density = np.empty(phi.size)
    for j in range(n):
        for q in range(segments.first_node[j], segments.first_node[j + 1]):
            density[q] = segments.half_width[j] * segments.weight[q] * phi[q]
    for i in range(n):
        points = collocation_points(segments, i, period)
        first = segments.first_node[i] + i
        for a in range(points.shape[0]):
            value, slope, _ = evaluate_series(
                series, segments.crest[i], segments.centre[i] + segments.half_width[i] * points[a, 0]
            )
            row[first + a] = (
                2 * np.pi * period * (load - series.maximum - value) if dual else slope * period / (2 * np.pi)
            )
        for j in range(n):
            _add_cauchy_sums(row[first : first + points.shape[0]], segments, density, period, points, i, j)
        if not dual:
            value = evaluate_series(series, segments.crest[i], segments.centre[i])[0]
            potential = _potential(segments, phi, period, i)
            row[heights + i] = (approach + value + 2 * potential) / segments.half_width[i]
    if dual:
        row[-1] = -approach
        for j in range(n):
            for q in range(segments.first_node[j], segments.first_node[j + 1]):
                row[heights + j] += segments.weight[q] * phi[q]
                row[-1] += segments.half_width[j] * density[q] * segments.node[q] / period
    else:
        row[-1] = (density.sum() - load * period) / segments.half_width.max()
    return row


@kernel
def _add_cauchy_sums(
    row: Array, segments: Segments, density: Array, period: float, points: Array, i: int, j: int
) -> None:
    """Add int rho cot(pi (x-s)/L) ds over segment j at the points of segment i."""
    sine, cosine = _angles(segments, period, points, i, j)
    for q in range(segments.first_node[j], segments.first_node[j + 1]):
        node_sine, node_cosine, here = segments.sine[q], segments.cosine[q], density[q]
        for a in range(row.size):
            row[a] += (
                here
                * (cosine[a] * node_cosine + sine[a] * node_sine)
                / (sine[a] * node_cosine - cosine[a] * node_sine)
            )


@kernel
def _angles(segments: Segments, period: float, points: Array, i: int, j: int) -> tuple[Array, Array]:
    """Sine and cosine of pi (x - c_j)/L at the points x of segment i."""
    s, c = angle_between_centres(segments, i, j, np.pi / period)
    sine, cosine = np.empty(points.shape[0]), np.empty(points.shape[0])
    for a in range(sine.size):
        sine[a] = s * points[a, 2] + c * points[a, 1]
        cosine[a] = c * points[a, 2] - s * points[a, 1]
    return sine, cosine


@kernel
def _potential(segments: Segments, phi: Array, period: float, i: int) -> float:
    """int rho ln|2 sin(pi (x-s)/L)| ds at the centre of segment i."""
    total, factor = 0.0, np.pi / period
    for j in range(segments.centre.size):
        r = segments.half_width[j]
        if i == j:
            for q in range(segments.first_node[j], segments.first_node[j + 1]):
                total += log_potential_at_own_centre(segments, q, r, factor)[0] * phi[q]
        else:
            s, c = angle_between_centres(segments, i, j, factor)
            for q in range(segments.first_node[j], segments.first_node[j + 1]):
                total += log_potential_at_other_centre(segments, q, r, factor, s, c)[0] * phi[q]
    return total


@kernel
def products(segments: Segments, phi: Array, series: CosineSeries, dual: bool, change: Change) -> Array:
    """The Jacobian of the equations times a change of the unknowns, shape (unknowns,)."""
    n, period = segments.centre.size, series.period
    heights = phi.size + n
    row = np.zeros(heights + n + 1)
    density, more, moment = np.empty(phi.size), np.empty(phi.size), np.empty(phi.size)
    for j in range(n):
        r = segments.half_width[j]
        for q in range(segments.first_node[j], segments.first_node[j + 1]):
            density[q] = r * segments.weight[q] * phi[q]
            more[q] = r * segments.weight[q] * change.phi[q] + density[q] * change.half_width[j]
            moment[q] = r * (change.centre[j] + segments.node[q] * change.half_width[j])
    for i in range(n):
        points = collocation_points(segments, i, period)
        first, r = segments.first_node[i] + i, segments.half_width[i]
        shift = r * (change.centre[i] + points[:, 0] * change.half_width[i])
        for a in range(points.shape[0]):
            _, slope, curvature = evaluate_series(series, segments.crest[i], segments.centre[i] + r * points[a, 0])
            row[first + a] = shift[a] * (-2 * np.pi * period * slope if dual else curvature * period / (2 * np.pi))
        for j in range(n):
            _add_cauchy_changes(
                row[first : first + points.shape[0]], segments, density, more, moment, shift, period, points, i, j
            )
        if not dual:
            slope = evaluate_series(series, segments.crest[i], segments.centre[i])[1]
            potential = _potential_change(segments, phi, change, period, i)
            row[heights + i] = (change.approach + slope * r * change.centre[i] + 2 * potential) / r
    if dual:
        row[-1] = -change.approach
        for j in range(n):
            r = segments.half_width[j]
            for q in range(segments.first_node[j], segments.first_node[j + 1]):
                row[heights + j] += segments.weight[q] * change.phi[q]
                row[-1] += r * (more[q] + density[q] * change.half_width[j]) * segments.node[q] / period
    else:
        row[-1] = more.sum() / segments.half_width.max()
    return row


@kernel
def _add_cauchy_changes(
    row: Array, segments: Segments, density: Array, more: Array, moment: Array, shift: Array, period: float,
    points: Array, i: int, j: int,
) -> None:  # fmt: skip
    """Add the change of `_add_cauchy_sums`: by the density, and by nodes and points that move, d cot/ds (ds - dx)."""
    sine, cosine = _angles(segments, period, points, i, j)
    for q in range(segments.first_node[j], segments.first_node[j + 1]):
        node_sine, node_cosine, there = segments.sine[q], segments.cosine[q], moment[q]
        here, moved = more[q], density[q] * np.pi / period
        for a in range(row.size):
            cot = (cosine[a] * node_cosine + sine[a] * node_sine) / (sine[a] * node_cosine - cosine[a] * node_sine)
            row[a] += here * cot + moved * (1 + cot * cot) * (there - shift[a])


@kernel
def _potential_change(segments: Segments, phi: Array, change: Change, period: float, i: int) -> float:
    """The change of `_potential`, where segment i moves along with its centre."""
    total, factor = 0.0, np.pi / period
    own = segments.half_width[i] * change.centre[i]
    for j in range(segments.centre.size):
        r, wider = segments.half_width[j], change.half_width[j]
        if i == j:
            for q in range(segments.first_node[j], segments.first_node[j + 1]):
                potential, _, dln_dr = log_potential_at_own_centre(segments, q, r, factor)
                total += potential * (change.phi[q] + phi[q] * wider)
                total += r * segments.weight[q] * phi[q] * dln_dr * wider
        else:
            s, c = angle_between_centres(segments, i, j, factor)
            for q in range(segments.first_node[j], segments.first_node[j + 1]):
                potential, dln_dx, dln_dr = log_potential_at_other_centre(segments, q, r, factor, s, c)
                total += potential * (change.phi[q] + phi[q] * wider)
                moved = dln_dx * (own - r * change.centre[j]) + dln_dr * wider
                total += r * segments.weight[q] * phi[q] * moved
    return total
