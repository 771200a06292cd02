"""The crests, or local maxima, of a cosine series sum a_n cos(2 pi k_n x/L + phi_n), k_n waves in a period L."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array
from weier.theory.highest_crest import MAX_TERMS, find_highest

SAMPLES_PER_WAVE = 16  # resolves every crest: between neighbours of the finest wave lie 16 samples
MAX_SAMPLES = 2**17  # of a period, where its crests are looked for before anything is solved
NEWTON_STEPS = 8  # from 1/16 wave away Newton's error squares each step: 6 reach rounding
MAX_SAMPLED_WAVES = 10**6  # of the finest in a period, whose crests are looked for among samples: 128 MB
MAX_DIRECT_TERMS = 32  # of a sum that is taken term by term; a Fourier transform takes less time for more


def countable(waves: int) -> bool:
    """Whether every crest of a series with so many of the finest waves in a period can be looked at beforehand."""
    return waves * SAMPLES_PER_WAVE <= MAX_SAMPLES


def sample(amplitude: Array, waves_per_period: Sequence[int], phase: Array, points: int) -> Array:
    """The series at equal steps over one period, shape (points,).

    The argument of each cosine is reduced in integers, so that no digit is lost to fine waves.
    """
    if len(amplitude) > MAX_DIRECT_TERMS:
        coefficient = np.zeros(points, complex)
        np.add.at(coefficient, [k % points for k in waves_per_period], amplitude * np.exp(1j * phase))
        return np.asarray(np.fft.ifft(coefficient).real * points)
    j, total = np.arange(points), np.zeros(points)
    for a, k, phi in zip(amplitude, waves_per_period, phase, strict=True):
        total += a * np.cos(_angle(k, j, points) + phi)
    return total


def find_crests(
    amplitude: Array, waves_per_period: Sequence[int], phase: Array, period: float
) -> tuple[Array, Array]:
    """Positions, shape (crests,), and at each the phases 2 pi k_n x/L + phi_n, shape (crests, terms).

    The phases themselves take Newton's steps: the slope at a crest is 0 to rounding, however fine the waves.
    """
    points = SAMPLES_PER_WAVE * waves_per_period[-1]
    z = sample(amplitude, waves_per_period, phase, points)
    top = np.flatnonzero((z >= np.roll(z, 1)) & (z > np.roll(z, -1)))
    return _refine(amplitude, waves_per_period, phase, period, top, points)


def highest_crest(
    amplitude: Array, waves_per_period: Sequence[int], phase: Array, period: float
) -> tuple[float, float]:
    """Position and height of the highest point of a series.

    Of more crests than can be looked at beforehand, it is found wave by wave. Between samples, a crest is higher than
    they are by an eighth of the largest curvature at most: only samples that are not lower by more than that are
    looked at.
    """
    if len(amplitude) <= MAX_TERMS and not countable(waves_per_period[-1]):
        return find_highest(amplitude, waves_per_period, phase, period)
    if waves_per_period[-1] > MAX_SAMPLED_WAVES:
        raise ValueError(
            f"the highest of so many crests is looked for in at most {MAX_TERMS} terms, got {len(amplitude)}"
        )
    points = SAMPLES_PER_WAVE * waves_per_period[-1]
    z = sample(amplitude, waves_per_period, phase, points)
    angle = 2 * np.pi * np.array(waves_per_period, float) / points
    high = z >= z.max() - np.abs(amplitude) @ angle**2 / 8
    top = np.flatnonzero((z >= np.roll(z, 1)) & (z >= np.roll(z, -1)) & high)
    x, theta = _refine(amplitude, waves_per_period, phase, period, top, points)
    height = np.cos(theta) @ amplitude
    highest = int(np.argmax(height))
    return float(x[highest]), float(height[highest])


def _refine(
    amplitude: Array,
    waves_per_period: Sequence[int],
    phase: Array,
    period: float,
    top: NDArray[np.int64],
    points: int,
) -> tuple[Array, Array]:
    """What `find_crests` returns, from the highest of the samples around each crest."""
    wavenumber = 2 * np.pi * np.array(waves_per_period, float) / period
    x = np.asarray(top * (period / points), float)
    theta = np.stack([_angle(k, top, points) for k in waves_per_period], axis=-1) + phase
    for _ in range(NEWTON_STEPS):
        slope = -np.sin(theta) @ (amplitude * wavenumber)
        curvature = -np.cos(theta) @ (amplitude * wavenumber**2)
        # Not beyond the next sample, where a sampled top stands on a slope that is not concave.
        step = np.clip(-slope / np.minimum(curvature, -1e-300), -period / points, period / points)
        x += step
        theta += step[:, None] * wavenumber
    return x, theta


def crest_heights(
    amplitude: Array, waves_per_period: Sequence[int], phase: Array, period: float, position: Array
) -> list[Any]:
    """Heights of crests in 40 digits, of those floats that the series is given as, near these positions.

    Twin crests may differ by so little that the heights of both, as floats, tell nothing of it.
    """
    import mpmath as mp  # which takes a tenth of a second, and few profiles need

    with mp.workdps(40):
        k = [2 * mp.pi * mp.mpf(int(n)) / mp.mpf(period) for n in waves_per_period]
        phi, a = [mp.mpf(float(p)) for p in phase], [mp.mpf(float(each)) for each in amplitude]
        heights = []
        for x in position:
            theta = [k_n * mp.mpf(float(x)) + phi_n for k_n, phi_n in zip(k, phi, strict=True)]
            slope = -mp.fsum(a_n * k_n * mp.sin(t) for a_n, k_n, t in zip(a, k, theta, strict=True))
            curvature = -mp.fsum(a_n * k_n**2 * mp.cos(t) for a_n, k_n, t in zip(a, k, theta, strict=True))
            heights.append(mp.fdot(a, map(mp.cos, theta)) - slope**2 / (2 * curvature))
        return heights


def _angle(waves_per_period: int, sample: NDArray[np.int64], points: int) -> Array:
    return np.asarray((waves_per_period * sample % points) * (2 * np.pi / points))
