"""The crests, or local maxima, of a cosine series sum a_n cos(2 pi k_n x/L + phi_n), k_n waves in a period L.

All of them are looked for among samples, and found by Newton's method on Taylor's polynomials. Of more than a
computer holds, the highest is found wave by wave, in bounded memory: the waves are taken from the largest to the
smallest, and a place is kept while the waves that have been looked at, with all others at their crests, could lift it
as high as the best place that is known. This holds for heights, whose waves shrink as they become finer, and for
pressures of full contact, whose waves grow.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Indices
from weier.theory.expansions import (
    NODES_PER_WAVE,
    ORDER,
    Expansions,
    derivatives,
    expand_at,
    move,
    phase_angle,
    values,
)

SAMPLES_PER_WAVE = 16  # resolves every crest: between neighbours of the finest wave lie 16 samples
SAMPLE_OFFSETS = np.arange(-0.5, 0.5, NODES_PER_WAVE / SAMPLES_PER_WAVE)  # of these from a node, in steps
MAX_SAMPLES = 2**17  # of a period, where its crests are looked for before anything is solved
MAX_NEWTON_STEPS = 40  # from 1/16 wave away; 6 reach rounding, and 25 where the curvature vanishes, too
PARTS = 31  # of the two samples about a top, where crests may stand side by side; odd, for these to be symmetric
MIN_PART = 1e-5  # of the finest wave: crests closer together than this are one to rounding
MAX_SAMPLED_WAVES = 10**6  # of the finest in a period, whose crests are looked for among samples: 128 MB
MAX_DIRECT_TERMS = 32  # of a sum that is taken term by term; a Fourier transform takes less time for more
MAX_TERMS = 64  # the search takes 0.3 s among 40 terms and minutes among 200, whose integers have 100 digits
CELLS = 32  # of a wave, whose middles are looked at in the search for the highest crest of very many
BEAM, MAX_PLACES = 256, 2**17  # places kept by a first search, for a height to beat, and at most: 50 MB for 12 terms
HEIGHT_ROUNDING = 1e-13  # of the sum of amplitudes
PLACE_STEPS = (
    16  # of Newton's from a 64th of the finest wave away: 6 reach rounding but for crests that are nearly flat
)


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
        total += a * np.cos(phase_angle(k, j, points) + phi)
    return total


class Crests(NamedTuple):
    """The crests of a series, in any order, among the nodes that it is expanded about.

    node, offset : the nearest node, and the distance from there, at most half a step, shape (crests,)
    expansion : of the series about each crest, shape (crests, ORDER + 1); the slope is 0
    """

    node: Indices
    offset: Array
    expansion: Expansions


def find_crests(amplitude: Array, waves_per_period: Sequence[int], expansion: Expansions) -> Crests:
    """All crests of a series that is expanded about all nodes, as by `expand`.

    The steps of Newton's method are counted from a node: the slope at a crest is 0 to rounding, however fine the
    waves.
    """
    nodes = len(expansion)
    z = (expansion @ np.vander(SAMPLE_OFFSETS, ORDER + 1, increasing=True).T).ravel()
    node, part = np.divmod(_sampled_tops(z), SAMPLE_OFFSETS.size)
    angle = 2 * np.pi / nodes * np.array(waves_per_period, float)
    width, slope_scale = 1 / SAMPLE_OFFSETS.size, float(np.abs(amplitude) @ angle)
    row, offset = _crests_nearby(expansion[node], SAMPLE_OFFSETS[part], width, slope_scale, angle[-1])
    steps = np.rint(offset)
    node, offset = (node[row] + steps.astype(np.int64)) % nodes, offset - steps
    about = move(expansion[node], offset)
    about[:, 1] = 0.0
    return Crests(node, offset, about)


def _sampled_tops(z: Array) -> Indices:
    """Indices of the samples of a period that are higher than both neighbours."""
    return np.flatnonzero((z >= np.roll(z, 1)) & (z > np.roll(z, -1)))


def _crests_nearby(
    expansion: Expansions, t: Array, width: float, slope_scale: float, finest: float
) -> tuple[Indices, Array]:
    """The crests by sampled tops, one or several within this width on either side: of which row each is, and where.

    t, width : in steps, shape (tops,)
    slope_scale, finest : sum |a_n| kappa_n and the largest kappa_n, in radians a step
    """
    row, t = _separated(expansion, t, width, finest)
    rounding, unsettled = 4 * np.finfo(float).eps * slope_scale, np.arange(t.size)
    for _ in range(MAX_NEWTON_STEPS):
        slope, curvature = derivatives(expansion[row[unsettled]], t[unsettled])
        off = np.abs(slope) > rounding
        if not off.any():
            break
        # Not beyond the next sample, where a sampled top stands on a slope that is not concave.
        step = np.clip(-slope / np.minimum(curvature, -1e-300), -width, width)
        unsettled = unsettled[off]
        t[unsettled] += step[off]
    return row, t


def _separated(expansion: Expansions, t: Array, width: float, finest: float) -> tuple[Indices, Array]:
    """Rows and positions next to each crest, of sampled tops with one or several within this width on either side.

    Where the series is not concave at a top and on both sides of it, crests may stand closer together than samples.
    Each is where the slope falls through 0 between points that are so close that the series is concave.
    """
    row, rows, near = np.arange(t.size), [np.empty(0, np.int64)], [t[:0]]
    while t.size > 0:
        curvature = derivatives(expansion[row], np.stack([t - width, t, t + width]))[1]
        clear = np.all(curvature < 0, axis=0) | (width * finest < 2 * np.pi * MIN_PART)
        rows.append(row[clear])
        near.append(t[clear])
        row, t = row[~clear], t[~clear]
        ends = np.linspace(-width, width, PARTS + 1)
        slope = derivatives(expansion[row], t + ends[:, None])[0]
        part, of = np.nonzero((slope[:-1] > 0) & (slope[1:] <= 0))
        width /= PARTS
        row, t = row[of], t[of] + width * (2 * part + 1 - PARTS)
    return np.concatenate(rows), np.concatenate(near)


def highest_crest(
    amplitude: Array, waves_per_period: Sequence[int], phase: Array, period: float
) -> tuple[float, float]:
    """Position and height of the highest point of a series; ValueError if too many places may hold it.

    Of more crests than can be looked at beforehand, it is found wave by wave, where a first search that keeps few
    places finds a height to beat.
    """
    terms = len(waves_per_period)
    if terms > MAX_TERMS or countable(waves_per_period[-1]):
        if waves_per_period[-1] > MAX_SAMPLED_WAVES:
            raise ValueError(f"the highest of so many crests is looked for in at most {MAX_TERMS} terms, got {terms}")
        return _highest_sampled(amplitude, waves_per_period, phase, period)
    search = _Search(amplitude, waves_per_period, phase)
    few, _ = search.places(-np.inf, BEAM)
    places, complete = search.places(search.polish(few)[1], MAX_PLACES)
    if not complete:
        raise ValueError(
            f"the highest crest of these {terms} waves is not found, since more than {MAX_PLACES} places may hold "
            "it: take fewer terms, or a gamma of smaller numbers"
        )
    position, top = search.polish(places)
    return position * period % period, top


def _highest_sampled(
    amplitude: Array, waves_per_period: Sequence[int], phase: Array, period: float
) -> tuple[float, float]:
    """The highest crest among samples, of those tops that may be it.

    Between samples, a crest is higher than they are by an eighth of the largest curvature at most.
    """
    points = SAMPLES_PER_WAVE * waves_per_period[-1]
    z = sample(amplitude, waves_per_period, phase, points)
    angle, top = 2 * np.pi / points * np.array(waves_per_period, float), _sampled_tops(z)
    top = top[z[top] >= z.max() - np.abs(amplitude) @ angle**2 / 8]
    expansion = expand_at(amplitude, waves_per_period, phase, top, points)
    row, t = _crests_nearby(expansion, np.zeros(top.size), 1.0, float(np.abs(amplitude) @ angle), angle[-1])
    height = values(expansion[row], t)
    highest = int(np.argmax(height))
    return float((top[row] + t)[highest] * (period / points)), float(height[highest])


def crest_heights(
    amplitude: Array, waves_per_period: Sequence[int], phase: Array, period: float, position: Array
) -> list[Any]:
    """Heights of crests in 40 digits, of those floats that the series is given as, near these positions.

    Twin crests may differ by so little that the heights of both, as floats, do not show it.
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


class _Places(NamedTuple):
    """Places on the period, in the middle of cells of equal width, as far as the waves looked at distinguish them.

    position : in periods, shape (places,)
    cycles : of each wave there, from its crest, shape (places, terms)
    """

    position: Array
    cycles: NDArray[np.float64]


class _Search:
    """The highest crest of a series, wave by wave from the largest.

    If the largest wave has K waves in a period, the waves up to i repeat after q_i of these. As integers these are
    exact, however many waves there are, and so is the phase of each wave at each place, to the rounding of a float.
    """

    def __init__(self, amplitude: Array, waves_per_period: Sequence[int], phase: Array) -> None:
        """The waves in order of their amplitude."""
        order = np.argsort(-np.abs(amplitude), kind="stable")
        self.amplitude = np.abs(amplitude)[order]
        self.waves = [int(waves_per_period[n]) for n in order]
        self.start = phase[order] / (2 * np.pi) + np.where(amplitude[order] < 0, 0.5, 0.0)
        self.repeat = [1]
        for k in self.waves[1:]:
            self.repeat.append(math.lcm(self.repeat[-1], self.waves[0] // math.gcd(self.waves[0], k)))
        self.tail = np.append(np.cumsum(self.amplitude[::-1])[::-1], 0.0)

    def places(self, least: float, most: int) -> tuple[_Places, bool]:
        """At most so many places that may be as high as `least` or any place met; and whether none was left out."""
        parts, complete = CELLS, True  # cells in a wave of the largest
        found = self._moved(_Places(np.zeros(1), self.start[None]), range(1, 2 * parts, 2), 2 * parts)
        for i in range(len(self.waves)):
            if i > 0 and self.repeat[i] > self.repeat[i - 1]:
                number = self.repeat[i] // self.repeat[i - 1]
                if number * found.position.size > MAX_PLACES * CELLS:
                    return found, False
                found = self._moved(found, range(0, self.repeat[i], self.repeat[i - 1]), 1)
            while True:
                kept, least = self._kept(found, least, i + 1, parts)
                complete = complete and kept.size <= most
                found = _Places(found.position[kept[:most]], found.cycles[kept[:most]])
                if self._is_fine_enough(i, parts):
                    break
                parts *= 2
                found = self._moved(found, (-1, 1), 2 * parts)
        return found, complete

    def _is_fine_enough(self, last: int, parts: int) -> bool:
        """Whether the waves as far as the last vary less within a cell than that one and the smaller ones may add."""
        cycles = [k / (parts * self.waves[0]) for k in self.waves[: last + 1]]
        return max(cycles) * CELLS <= 1 and np.pi * float(self.amplitude[: last + 1] @ cycles) <= self.tail[last]

    def _moved(self, places: _Places, shifts: Sequence[int], parts: int) -> _Places:
        """Each place moved by each of the shifts, in so many parts of a wave of the largest."""
        divisions = parts * self.waves[0]
        cycles = np.array([[k * shift % divisions / divisions for k in self.waves] for shift in shifts])
        moved = (places.cycles[:, None] + cycles).reshape(-1, len(self.waves))
        position = places.position[:, None] + np.array([shift / divisions for shift in shifts])
        return _Places(position.ravel(), moved - np.rint(moved))

    def _kept(self, places: _Places, least: float, known: int, parts: int) -> tuple[Indices, float]:
        """Which cells may reach the least height, the most promising first; and that height, raised."""
        least = max(least, float((np.cos(2 * np.pi * places.cycles) @ self.amplitude).max()))
        half = np.array([k / (2 * parts * self.waves[0]) for k in self.waves[:known]])
        nearest = np.maximum(np.abs(places.cycles[:, :known]) - half, 0.0)
        most = np.cos(2 * np.pi * nearest) @ self.amplitude[:known] + self.tail[known]
        order = np.argsort(-most, kind="stable")
        return order[most[order] >= least - HEIGHT_ROUNDING * self.tail[0]], least

    def polish(self, places: _Places) -> tuple[float, float]:
        """Position, in periods, and height of the highest of all crests near these places, by Newton's method."""
        k = np.array([each / max(self.waves) for each in self.waves])
        theta, moved = 2 * np.pi * places.cycles, np.zeros(places.position.size)
        for _ in range(PLACE_STEPS):
            slope, curvature = -np.sin(theta) @ (self.amplitude * k), -np.cos(theta) @ (self.amplitude * k**2)
            step = np.clip(-slope / np.minimum(curvature, -1e-300), -0.5, 0.5)
            theta, moved = theta + step[:, None] * k, moved + step
        height = np.cos(theta) @ self.amplitude
        position = places.position + moved / (2 * np.pi * max(self.waves))
        highest = int(np.argmax(height))
        return float(position[highest]), float(height[highest])
