"""The fraction of the period on which pressure or gap exceed a value (docs/patches.md, "Densities")."""

from __future__ import annotations

import numpy as np
from scipy.optimize import elementwise

from weier.kernels.arrays import Array, Indices
from weier.methods.patches.pressure_and_gap import values_at
from weier.methods.patches.segments import contact_extent
from weier.methods.patches.solver import Solution
from weier.methods.patches.surface import evaluate_at, intervals_between, nearest_crests

BINS = 100  # default number of bins
# cells of a piece for each radian of the finest wave in its half-width, to which 4 are added: twice as many change no
# fraction by 1e-8, and half as many miss extrema, which leaves up to 3e-4
CELLS = 8


def fraction_above(solution: Solution, of_gap: bool, limits: Array | None = None) -> tuple[Array, Array]:
    """Return limits of pressure, in p_0*, or of the gap, in g_0, and the fraction of the period above each.

    By default the limits are `BINS` + 1 from 0 to the largest value.
    """
    state, surface = solution.state, solution.surface
    series = surface.tensions if state is None else state.kind.series(surface)
    extent = 3 * (np.zeros(0 if of_gap else 1),)
    if state is None:
        extent = *extent[:2], extent[2] + 0.5 * series.period
    else:
        extent = contact_extent(state, series.period)
        extent = intervals_between(extent, series.period) if of_gap else extent
    crest, centre, r = nearest_crests(series, extent[0])[0], extent[1], extent[2]
    cells = np.ceil(CELLS * (4 + series.wavenumber[-1] * r)).astype(np.int64)
    piece = np.repeat(np.arange(r.size), cells + 1)
    step = np.pi / cells[piece]
    theta = step * (np.arange(piece.size) - np.searchsorted(piece, piece))

    def at(node: Indices, angle: Array) -> Array:
        j = piece[node]
        y = centre[j] + r[j] * np.cos(angle)
        if state is None:
            return solution.mean_pressure - series.maximum - evaluate_at(series.local, crest[j], y, 0)
        return np.maximum(values_at(state, series, crest[j], y, of_gap), 0.0)

    def width(node: Indices, start: Array, end: Array) -> Array:
        return np.abs(2 * r[piece[node]] * np.sin(0.5 * (start + end)) * np.sin(0.5 * (end - start)))

    value = at(np.arange(piece.size), theta)
    rise = np.sign(np.diff(value))
    turn = 1 + np.flatnonzero((piece[2:] == piece[:-2]) & (rise[:-1] != 0) & (rise[:-1] != rise[1:]))
    bracket, upward = (theta[turn - 1], theta[turn], theta[turn + 1]), rise[turn - 1]
    theta[turn] = elementwise.find_minimum(lambda x, j, sign: -sign * at(j, x), bracket, args=(turn, upward)).x
    value[turn] = at(turn, theta[turn])
    limits = np.linspace(0.0, value.max(initial=0.0), BINS + 1) if limits is None else limits
    left = np.flatnonzero(piece[1:] == piece[:-1])
    lower, size = np.minimum(value[left], value[left + 1]), width(left, theta[left], theta[left + 1])
    whole = np.array([size[lower > limit].sum() for limit in limits])
    crossed = [left[(value[left] > limit) != (value[left + 1] > limit)] for limit in limits]
    cell, index = np.concatenate(crossed), np.repeat(np.arange(limits.size), [cells.size for cells in crossed])
    ends, high = (theta[cell], theta[cell + 1]), cell + (value[cell] <= limits[index])
    root = elementwise.find_root(lambda x, j, limit: at(j, x) - limit, ends, args=(cell, limits[index])).x
    # At the limits 0 and largest value, rounding may hide the root, which is at an end then.
    nearer = cell + (np.abs(value[cell + 1] - limits[index]) < np.abs(value[cell] - limits[index]))
    root = np.where(np.isnan(root), theta[nearer], root)
    part = width(cell, root, theta[high])
    return limits, (whole + np.bincount(index, part, limits.size)) / series.period
