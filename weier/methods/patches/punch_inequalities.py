"""Contacts that are missing between those of a solution, by the gap at many points at once; gaps, by the pressure."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Indices
from weier.methods.patches.edge_iteration import Problem, Step
from weier.methods.patches.pair_sums import potential
from weier.methods.patches.punch_edges import distances

PROBES_PER_WAVE, MIN_PROBES = 6, 7  # in each gap
MAX_RISE = 0.1  # curvature times the square of the distance of probes: a minimum may lie so far below the lowest one
FIRST_STENCIL, STENCIL_RATIO, REFINEMENTS = 0.1, 1 / 3, 4  # of the distance of probes
NEW_CONTACT_WIDTH = 0.5  # of a new contact, over the overlap that it replaces
NEW_GAP_WIDTH = np.sqrt(2.0)  # of a new gap, over the interval of tension: exact for a small one
MAX_NEW_WIDTH = 0.4  # half-width over the distance of the nearest neighbour: two born side by side must not touch
MAX_FALL = 3  # from a point to the minimum, over what a parabola tells of it


class _Brackets(NamedTuple):
    """Points low < middle < high with a minimum between them, and the index of the contact on their left."""

    low: Array
    middle: Array
    high: Array
    interval: Indices


def gap_or_pressure(problem: Problem, step: Step, x: Array) -> Array:
    """The gap or, dual, the pressure at ascending points off the segments; negative where a segment is missing."""
    punches, forces, dual = step.punches, step.forces, problem.dual
    total = potential(punches.matrix.tree, forces.force, x, punches.period, dual)
    if dual:
        return np.asarray(-0.5 / punches.period**2 * total - problem.forcing(x))
    return np.asarray(forces.plane - 2 * total - problem.forcing(x))


def find_missing(problem: Problem, step: Step, tolerance: float) -> NDArray[np.float64]:
    """Edges of new segments where the gap or pressure has a minimum below -tolerance, shape (missing, 2)."""
    x, gap_before = _probes(problem, step)
    value = gap_or_pressure(problem, step, x)
    lowest = 1 + np.flatnonzero(
        (value[1:-1] <= value[:-2]) & (value[1:-1] <= value[2:]) & (gap_before[:-2] == gap_before[2:])
    )
    low, middle, high = x[lowest - 1], x[lowest], x[lowest + 1]
    rise = (value[lowest + 1] - value[lowest]) / (high - middle) - (value[lowest] - value[lowest - 1]) / (
        middle - low
    )
    some = value[lowest] < 2 * MAX_RISE * np.maximum(rise, 0) * (high - low) + tolerance
    if not np.any(some):
        return np.empty((0, 2))
    brackets = _Brackets(low[some], middle[some], high[some], gap_before[lowest[some]])
    centre, depth, curvature, interval = _minima(problem, step, brackets, tolerance)
    if centre.size == 0:
        return np.empty((0, 2))
    room = _room(step, centre, interval)
    widening = NEW_GAP_WIDTH if problem.dual else NEW_CONTACT_WIDTH
    half_width = widening * np.sqrt(-2 * depth / np.maximum(curvature, -depth / room**2))
    half_width = np.minimum(half_width, MAX_NEW_WIDTH * room)
    return np.stack([centre - half_width, centre + half_width], axis=1)


def _probes(problem: Problem, step: Step) -> tuple[Array, Indices]:
    """Points in each gap, closer at its ends, and the index of the contact on the left of each."""
    punches = step.punches
    right = punches.centre + punches.half_width
    gap = distances(punches.centre - punches.half_width, right, punches.period)
    per_length = PROBES_PER_WAVE * problem.series.wavenumber[-1] / (2 * np.pi)
    count = MIN_PROBES + np.ceil(per_length * gap).astype(np.int64)
    before = np.repeat(np.arange(gap.size), count)
    number = np.arange(before.size) - np.repeat(np.cumsum(count) - count, count)
    angle = (number + 0.5) * (np.pi / count[before])
    return right[before] + gap[before] * 0.5 * (1 - np.cos(angle)), before


def _minima(
    problem: Problem, step: Step, brackets: _Brackets, tolerance: float
) -> tuple[Array, Array, Array, Indices]:
    """Position, value, curvature and gap of minima below -tolerance, by Newton's method on differences.

    Brackets whose minimum is above for certain are left out as soon as that is known.
    """
    stencil = FIRST_STENCIL * (brackets.high - brackets.low)
    for refinement in range(1, REFINEMENTS + 1):
        low, middle, high, interval = brackets
        points = np.stack([middle - stencil, middle, middle + stencil], axis=1)
        order, value = np.argsort(points, axis=None), np.empty(points.size)
        value[order] = gap_or_pressure(problem, step, points.ravel()[order])
        below, here, above = value.reshape(-1, 3).T
        slope, curvature = (above - below) / (2 * stencil), (below - 2 * here + above) / stencil**2
        shift = -slope / np.where(curvature > 0, curvature, np.inf)
        shift = np.clip(middle + shift, low + 1.01 * stencil, high - 1.01 * stencil) - middle
        fall = -0.5 * np.minimum(shift * slope, 0)
        margin = MAX_FALL * fall if refinement < REFINEMENTS else fall
        some = (here - margin < -tolerance) | ((curvature <= 0) & (refinement < REFINEMENTS))
        brackets = _Brackets(low[some], (middle + shift)[some], high[some], interval[some])
        stencil = STENCIL_RATIO * stencil[some]
        if not np.any(some):
            break
    return brackets.middle, (here - fall)[some], curvature[some], brackets.interval


def _room(step: Step, centre: Array, interval: Indices) -> Array:
    """From each new contact to the ends of its gap, or halfway to another new one."""
    right = step.punches.centre + step.punches.half_width
    gap = distances(step.punches.centre - step.punches.half_width, right, step.punches.period)
    halfway = 0.5 * np.diff(centre)
    to_left = np.minimum(centre - right[interval], np.append(np.inf, halfway))
    to_right = np.minimum(right[interval] + gap[interval] - centre, np.append(halfway, np.inf))
    return np.minimum(to_left, to_right)
