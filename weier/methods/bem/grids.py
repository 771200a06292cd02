"""Nested grids: the waves that each carries, and the interpolation of a solution to the next finer one.

docs/bem.md, "The discrete problem", has the eigenvalues; docs/numerics.md, "Fast boundary elements", the savings. A
wave joins on the first grid that resolves it; each of its crests starts from Westergaard's pressure (10) under the
local mean.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy  # its modules are imported on first use, a tenth of a second each

from weier.kernels.arrays import Array, Indices
from weier.kernels.jit import kernel
from weier.surface.waves import Waves
from weier.theory.halfplane import eigenvalues, influence_coefficients

# nodes of the coarsest wave on a grid, and of a grid; their cost is in `python -m benchmarks tuning`
MIN_POINTS_PER_CARRIED_WAVE, MIN_POINTS = 8, 128
MIN_SCALE_RATIO = 1.2  # ratio of successive wavelengths from which waves are separate scales; closer in traces
# residual of a coarse grid in g_n/(points per wave)^2: about ten times its error, 3.3 (docs/numerics.md, "One wave on
# 512 nodes"); its cost is in `python -m benchmarks tuning`
COARSE_ACCURACY = 30.0


class Grid(NamedTuple):
    """A grid of N nodes.

    height : profile of the waves that it carries, shape (N,), in g_0
    waves_per_period, cycle, full_contact_pressure : of the waves that join on it, from coarse to fine: number in one
        period, phase in wavelengths, and the mean pressure that flattens one of them alone, in p_0*
    influence, inverse : eigenvalues of A and, but for the mean, of A^-1, shape (N//2 + 1,), in g_0/p_0* and p_0*/g_0
    max_residual : residual to reach, in g_0
    self_influence : A_ii, in g_0/p_0*
    is_coarse : whether it only starts the next one
    """

    height: Array
    waves_per_period: Indices
    cycle: Array
    full_contact_pressure: Array
    influence: Array
    inverse: Array
    max_residual: float
    self_influence: float
    is_coarse: bool


def nested_grids(profile: Waves, points: int, max_residual: float) -> list[Grid]:
    """Return grids of ..., points/4, points/2 and points nodes, as long as they resolve the coarsest wave.

    An odd number is preceded by at least half as many nodes, a number with small prime factors. The finest grid
    carries all waves, and reaches `max_residual`, in g_0.
    """
    waves, sizes, grids, terms = np.array(profile.waves_per_period), [points], list[Grid](), 0
    fewest = max(MIN_POINTS, MIN_POINTS_PER_CARRIED_WAVE * waves[0])
    while (coarser := _half(sizes[0])) >= fewest:
        sizes.insert(0, coarser)
    is_scale = np.append(True, waves[1:] >= MIN_SCALE_RATIO * waves[:-1])
    for size in sizes:
        carried, is_coarse = terms, size < points
        terms = int(np.sum(MIN_POINTS_PER_CARRIED_WAVE * waves <= size)) if is_coarse else profile.terms
        joining = carried + np.flatnonzero(is_scale[carried:terms])
        error = COARSE_ACCURACY * profile.amplitude[terms - 1] * (waves[terms - 1] / size) ** 2
        influence = eigenvalues(size, profile.period).copy()  # a read-only array would be another type for kernels
        grid = Grid(
            profile.sampled_height(size, terms),
            waves[joining],
            profile.phase[joining] / (2 * np.pi),
            profile.full_contact_pressure[joining],
            influence,
            inverse(influence),
            float(max(max_residual, error) if is_coarse else max_residual),
            influence_coefficients(size, profile.period)[0],
            is_coarse,
        )
        grids.append(grid)
    return grids


def _half(points: int) -> int:
    return points // 2 if points % 2 == 0 else int(scipy.fft.next_fast_len((points + 1) // 2, real=True))


def inverse(eigenvalue: Array) -> Array:
    """Return the eigenvalues of A^-1, except for the mean, from the eigenvalues of A."""
    return np.concatenate([[0.0], 1 / eigenvalue[1:]])


def full_contact_pressure(height: Array, period: float) -> Array:
    """Return the pressures of mean 0 that flatten these heights at the nodes of a period."""
    return np.asarray(np.fft.irfft(inverse(eigenvalues(height.size, period)) * np.fft.rfft(height), height.size))


@kernel
def _between(before: float, here: float, after: float, later: float, fraction: float) -> float:
    """Interpolate the pressure at a fraction of the way from `here` to `after`.

    p^2 is interpolated linearly, since p = A s^(1/2) near an edge, and extrapolated to nodes outside contact.
    """
    one = here * here if here > 0 else min(0.0, 2 * after * after - later * later)
    other = after * after if after > 0 else min(0.0, 2 * here * here - before * before)
    return np.sqrt(max(0.0, (1 - fraction) * one + fraction * other))


@kernel
def refine(coarse: Array, p: Array) -> None:
    """Interpolate the pressure p on a grid from a coarser grid or the same one."""
    points, i, rest = coarse.size, 0, 0  # i + rest/N nodes of the coarser grid lie before the node
    for node in range(p.size):
        before, here, after, later = coarse[i - 1], coarse[i], coarse[(i + 1) % points], coarse[(i + 2) % points]
        p[node] = _between(before, here, after, later, rest / p.size) if rest else here
        rest += points
        if rest >= p.size:
            i, rest = i + 1, rest - p.size


@kernel
def _westergaard(sine_squared: float, xi: float) -> float:
    """Return pressure over its mean under one wave, where sin^2(pi x) is `sine_squared` (10)."""
    if xi < 1:
        return 2 * np.sqrt((1 - sine_squared) * max(xi - sine_squared, 0.0)) / xi
    return 1 + (1 - 2 * sine_squared) / xi


@kernel
def add_wave(wave: int, grid: Grid, p: Array, finer: Array) -> None:
    """Add a wave that joins on this grid to the pressure p, the local mean, concentrated on its crests.

    `finer` is a working array. Where no crest is loaded, on contacts narrower than the wave, p is unchanged.
    """
    count = grid.waves_per_period[wave]
    # xi is sin^2(pi a/lambda) for a contact of half-width a (8): with a below one node, it might lie between nodes.
    narrowest = np.sin(np.pi * count / p.size) ** 2
    highest = 0.0
    for i in range(p.size):
        finer[i] = 0.0
        if p[i] > 0:  # most nodes are outside contact, and the sine is most of the work
            sine = np.sin(np.pi * (count * i % p.size / p.size + grid.cycle[wave]))
            xi = max(p[i] / grid.full_contact_pressure[wave], narrowest)
            finer[i] = p[i] * _westergaard(sine * sine, xi)
            highest = max(highest, finer[i])
    if highest > 0:
        for i in range(p.size):
            p[i] = finer[i]
