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
MIN_SCALE_RATIO = 1.2  # ratio of wavelengths from which a wave is a scale of its own, unlike in traces
# residual of a coarse grid in g_n/(points per wave)^2: about ten times its error, 3.3 (docs/numerics.md, "One wave on
# 512 nodes"); its cost is in `python -m benchmarks tuning`
COARSE_ACCURACY = 30.0


class Harmonics(NamedTuple):
    """The waves of a profile, from coarse to fine; arrays of shape (m,).

    waves_per_period : number of waves of each term in one period
    cycle : phase, in wavelengths
    full_contact_pressure : mean pressure p_n* that flattens this wave alone, in p_0*
    """

    waves_per_period: Indices
    cycle: Array
    full_contact_pressure: Array


class Grid(NamedTuple):
    """A grid of N nodes.

    terms : number of waves that it carries, from the coarsest on
    height : profile of these waves, shape (N,), in g_0
    influence, inverse : eigenvalues of A and, but for the mean, of A^-1, shape (N//2 + 1,), in g_0/p_0* and p_0*/g_0
    max_residual : residual to reach, in g_0
    self_influence : A_ii, in g_0/p_0*
    is_coarse : whether it only starts the next one
    """

    terms: int
    height: Array
    influence: Array
    inverse: Array
    max_residual: float
    self_influence: float
    is_coarse: bool


def harmonics_of(profile: Waves) -> Harmonics:
    """Return the waves of a profile with a finite number of terms."""
    return Harmonics(np.array(profile.waves_per_period), profile.phase / (2 * np.pi), profile.full_contact_pressure)


def nested_grids(profile: Waves, points: int, max_residual: float) -> list[Grid]:
    """Return grids of ..., points/4, points/2 and points nodes, as long as they resolve the coarsest wave.

    An odd number is preceded by at least half as many nodes, a number with small prime factors.

    Parameters
    ----------
    profile : Profile or Trace
        With a finite number of terms.
    points : int
        Nodes of the finest grid, which carries all waves.
    max_residual : float
        Residual to reach on it, in g_0.

    """
    fewest = max(MIN_POINTS, MIN_POINTS_PER_CARRIED_WAVE * profile.waves_per_period[0])
    sizes = [points]
    while (coarser := _half(sizes[0])) >= fewest:
        sizes.insert(0, coarser)
    terms = [sum(MIN_POINTS_PER_CARRIED_WAVE * k <= size for k in profile.waves_per_period) for size in sizes[:-1]]
    residuals = [max(max_residual, _accuracy(profile, *at)) for at in zip(sizes, terms, strict=False)]
    coarse = [_make_grid(profile, *of, is_coarse=True) for of in zip(sizes[:-1], terms, residuals, strict=True)]
    return [*coarse, _make_grid(profile, points, profile.terms, max_residual, is_coarse=False)]


def _make_grid(profile: Waves, points: int, terms: int, max_residual: float, is_coarse: bool) -> Grid:
    influence = eigenvalues(points, profile.period).copy()  # a read-only array would be another type for kernels
    height, own = profile.sampled_height(points, terms), influence_coefficients(points, profile.period)[0]
    return Grid(terms, height, influence, inverse(influence), float(max_residual), own, is_coarse)


def _half(points: int) -> int:
    return points // 2 if points % 2 == 0 else int(scipy.fft.next_fast_len((points + 1) // 2, real=True))


def _accuracy(profile: Waves, points: int, terms: int) -> float:
    return float(COARSE_ACCURACY * profile.amplitude[terms - 1] * (profile.waves_per_period[terms - 1] / points) ** 2)


def inverse(eigenvalue: Array) -> Array:
    """Return the eigenvalues of A^-1, except for the mean, from the eigenvalues of A."""
    return np.concatenate([[0.0], 1 / eigenvalue[1:]])


def full_contact_pressure(height: Array, period: float) -> Array:
    """Return the pressures of mean 0 that flatten these heights at the nodes of a period."""
    return np.asarray(np.fft.irfft(inverse(eigenvalues(height.size, period)) * np.fft.rfft(height), height.size))


@kernel
def _squared_beyond(before: float, last: float) -> float:
    """Return square of the pressure at the first node outside contact, extrapolated linearly, and not above 0.

    Near an edge the pressure is A s^(1/2), so that its square is linear.
    """
    return min(0.0, 2 * last * last - before * before)


@kernel
def _between(before: float, here: float, after: float, later: float, fraction: float) -> float:
    """Interpolate the pressure at a fraction of the way from `here` to `after`, with linear p^2 as at edges."""
    one = here * here if here > 0 else _squared_beyond(later, after)
    other = after * after if after > 0 else _squared_beyond(before, here)
    return np.sqrt(max(0.0, (1 - fraction) * one + fraction * other))


@kernel
def copy_values(source: Array, target: Array) -> None:
    """Copy an array into one of its size; cheaper to compile than `target[:] = source`."""
    for i in range(source.size):
        target[i] = source[i]


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
def add_harmonic(wave: int, harmonics: Harmonics, p: Array, finer: Array) -> None:
    """Add a wave to the pressure p, with the previous p as its local mean, concentrated on its crests.

    `finer` is a working array. The pressure is unchanged where no crest is loaded, on contacts narrower than the
    wave, and for a wave hardly finer than the previous one.
    """
    count, cycle = harmonics.waves_per_period[wave], harmonics.cycle[wave]
    if wave > 0 and count < MIN_SCALE_RATIO * harmonics.waves_per_period[wave - 1]:
        return
    # xi is sin^2(pi a/lambda) for a contact of half-width a (8): with a below one node, it might lie between nodes.
    narrowest = np.sin(np.pi * count / p.size) ** 2
    highest = 0.0
    for i in range(p.size):
        sine = np.sin(np.pi * (count * i % p.size / p.size + cycle))
        xi = max(p[i] / harmonics.full_contact_pressure[wave], narrowest)
        finer[i] = p[i] * _westergaard(sine * sine, xi)
        highest = max(highest, finer[i])
    if highest > 0:
        copy_values(finer, p)
