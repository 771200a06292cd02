"""Series whose coarsest waves are pressed flat: what Archard's and Demelio's approximations share.

Wave n carries xi_n, a mean pressure in its p_n*. Behind a flat wave, xi_n > 1, the next one carries

    xi_{n+1} - fixed = gamma^(1-D) (xi_n - fixed),

where `fixed` is 0 if waves hand on the mean pressure alone. So the number N of flat waves has a closed form, and
those that remain are self-affine to the complete series:

    h(p; m) = sum of g_n over n < N + g_N h(xi_N; m - N),    dh/dp = gamma^-N h'(xi_N; m - N).

Neighbouring loads of one series that flatten as many waves are a run. Powers and sums of powers belong to runs; what
is left to each load are its logarithm, sums and products. Heights are in g_0, pressures in p_0*.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from weier.kernels.arrays import Array, Indices
from weier.kernels.jit import kernel
from weier.theory.series import amplitude, full_contact_pressure, leading_amplitude

INFINITE_TERMS = 1e300  # for m = inf: no sum of doubles can tell them apart, and INFINITE_TERMS - INFINITE_TERMS = 0
MARGIN = 1e-12  # more than the rounding of a power: a load so close to the end of a run finds its own
BLOCK = 2**17  # loads at a time: their arrays, of 1 MB, stay in the cache


class Runs(NamedTuple):
    """Runs of loads of all series one after the other; arrays of shape (runs,).

    end : index behind the last load
    flat : number N of flat waves
    left : number m - N of waves that remain
    D, gamma, fixed : of the series
    """

    end: Indices
    flat: Array
    left: Array
    D: Array
    gamma: Array
    fixed: Array


Sums = Callable[[Array, Array, Runs], Array]  # of waves none of which is flat: loads, their logarithms, runs
FixedPoint = Callable[[Array, Array], Array]  # of the loads handed on, for D and gamma


def over_series(
    sums: Sums,
    fixed: FixedPoint,
    mean_pressure: ArrayLike,
    D: ArrayLike,
    gamma: ArrayLike,
    m: ArrayLike,
) -> Array:
    """Sums over all waves, of the shape to which loads and series broadcast; NaN where a load is not positive.

    Parameters
    ----------
    sums : callable
        From xi_N, ln xi_N and their runs, all loads of all series one after the other; may use both arrays up.
    fixed : callable
        From D and gamma.
    mean_pressure, D, gamma, m : array_like
        Loads in p_0*, and the series.
    """
    p, *given = _of_one_rank(mean_pressure, D, gamma, m)
    parameters = np.broadcast_arrays(*given)
    grid, shape = parameters[0].shape, np.broadcast_shapes(p.shape, *(each.shape for each in given))
    # Loads are the axes along which the series stays the same; they come last.
    across = [axis for axis in range(p.ndim) if grid[axis] != 1]
    order = across + [axis for axis in range(p.ndim) if grid[axis] == 1]
    series, loads = math.prod(grid), math.prod(shape[axis] for axis in order[len(across) :])
    own = any(p.shape[axis] != 1 for axis in across)  # each series has loads of its own
    p = np.broadcast_to(p, shape).transpose(order).reshape(series, loads) if own else p.reshape(1, loads)
    rising = None if own or np.all(p[0, :-1] <= p[0, 1:]) else p[0].argsort()  # a run is of neighbouring loads
    every = np.broadcast_to(p if rising is None else p[:, rising], (series, loads))
    values = _in_blocks(sums, fixed, every, *(each.ravel() for each in parameters))
    if rising is not None:
        values = values[:, rising.argsort()]
    return values.reshape([shape[axis] for axis in order]).transpose(np.argsort(order))


def _of_one_rank(*arguments: ArrayLike) -> list[Array]:
    arrays = [np.asarray(each, float) for each in arguments]
    rank = max(each.ndim for each in arrays)
    return [each.reshape((1,) * (rank - each.ndim) + each.shape) for each in arrays]


def _in_blocks(
    sums: Sums,
    fixed: FixedPoint,
    p: Array,
    D: Array,
    gamma: Array,
    m: Array,
) -> Array:
    """The sums for loads of shape (series, loads), computed in blocks that fit the cache."""
    values = np.empty(p.shape)
    series, loads = p.shape
    rows = max(BLOCK // max(loads, 1), 1)
    for first in range(0, series, rows):
        some = np.s_[first : first + rows]
        parameters = D[some], gamma[some], np.minimum(m[some], INFINITE_TERMS), fixed(D[some], gamma[some])
        for start in range(0, loads, BLOCK):
            block = np.s_[some, start : start + BLOCK]
            xi, runs = _carried(p[block].copy(), *parameters)
            values[block] = sums(xi, np.log(xi), runs).reshape(values[block].shape)
    return values


def add_flat_waves(h: Array, runs: Runs) -> Array:
    """Compliance of all waves from that of those that remain, in place."""
    _rescale(h, runs, leading_amplitude(runs.flat, runs.D, runs.gamma), amplitude(runs.flat, runs.D, runs.gamma))
    return h


def scale_behind_flat_waves(slope: Array, runs: Runs) -> Array:
    """Resistance of all waves from that of those that remain, in place: flat waves have none."""
    _rescale(slope, runs, np.zeros_like(runs.flat), runs.gamma**-runs.flat)  # g_n/p_n* = gamma^-n
    return slope


def _carried(p: Array, D: Array, gamma: Array, m: Array, fixed: Array) -> tuple[Array, Runs]:
    """What the first wave that is not flat carries, shape (series * loads,), and the runs of these loads."""
    end, flat, series = _find_runs(p, (D - 1) * np.log(gamma), m, fixed)
    runs = Runs(end, flat, m[series] - flat, D[series], gamma[series], fixed[series])
    shrink = full_contact_pressure(-np.where(runs.left > 0, flat, 0), runs.D, runs.gamma)
    xi = p.ravel()
    _rescale(xi, runs, runs.fixed * (1 - shrink), shrink)
    return xi, runs


@kernel
def _find_runs(p: Array, step: Array, m: Array, fixed: Array) -> tuple[Indices, Array, Indices]:
    """End, flat waves and series of each run of loads, shape (series, loads); what is no load becomes NaN."""
    series, loads = p.shape
    end, flat, owner = np.empty(p.size, np.int64), np.empty(p.size), np.empty(p.size, np.int64)
    runs = 0
    for s in range(series):
        start = 0
        while start < loads:
            left = p[s, start:]
            flat[runs], above, up_to = _flat_waves(left[0], step[s], m[s], fixed[s])
            if not left[0] > 0:
                left[0] = math.nan
            length = 1
            while length < left.size and above < left[length] <= up_to:
                length += 1
            start += length
            end[runs], owner[runs] = s * loads + start, s
            runs += 1
    return end[:runs], flat[:runs], owner[:runs]


@kernel
def _flat_waves(p: float, step: float, m: float, fixed: float) -> tuple[float, float, float]:
    """Number of flat waves, above which load and up to which it is the same; step is ln gamma^(D-1)."""
    if not p > 1:
        return 0.0, 0.0, 1.0
    if fixed >= 1:  # xi never falls to 1
        return m, 1.0, math.inf
    waves = (math.log(p - fixed) - math.log(1 - fixed)) / step
    number = np.ceil(waves)
    if number >= m:
        return m, p, math.inf
    last = (p - fixed) * math.exp(step * (number - waves))
    return number, fixed + last * math.exp(-step) * (1 + MARGIN), fixed + last * (1 - MARGIN)


@kernel
def _rescale(values: Array, runs: Runs, offset: Array, factor: Array) -> None:
    """Offset + factor * values, in place, in runs with flat waves."""
    start = 0
    for r in range(runs.end.size):
        if runs.flat[r] > 0:
            run = values[start : runs.end[r]]
            for i in range(run.size):
                run[i] = offset[r] + factor[r] * run[i]
        start = runs.end[r]
