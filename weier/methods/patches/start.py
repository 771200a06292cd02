"""Where an iteration starts: the contacts that a load is likely to have, and the density on them.

The contacts come from crests where they are tiny, and from boundary elements on a coarse grid elsewhere.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import numpy as np

from weier.kernels.arrays import Array, Indices
from weier.kernels.jit import kernel
from weier.methods.bem.subgrid_solver import GridSolver
from weier.methods.patches.segments import (
    COARSE_TOLERANCE,
    Iterate,
    Segments,
    distances_to_next,
    estimate_node_count,
    make_segments,
)
from weier.methods.patches.surface import CosineSeries, Surface, nearest_crests
from weier.theory.halfplane import displacement_at_distance, displacement_of_punch
from weier.theory.waves import Waves

MAX_RADIANS = 0.5  # of the finest wave in the half-width of a contact that is Hertz's, or of a gap like it
MAX_CROWDING = 0.1  # of the half-width over the distance of the next one, for the same
MAX_LONE_CONTACTS = 64  # of those whose forces are found from Hertz's theory
MAX_FORCE_STEPS = 60  # of finding these forces; 4 to 10 are usual
FORCE_TOLERANCE = 1e-10
POINTS_PER_WAVE = (10, 32)  # of the grids that are tried in this order: 16 lead to no fewer steps than 10
MIN_GRID_TOLERANCE = 1e-10  # the waves of a smooth measured surface fall to rounding
GRID_TOLERANCE, WAVE_SHARE = 1e-5, 0.01  # of boundary elements: in g_0, and of the finest wave, whichever is less
RATE_TOLERANCE = 1e-2  # of the rate there: what its corrections on so few points are off themselves
MAX_NODE_RATIO = 0.7  # of the gaps over the contacts, at which the gaps are solved for


class Starts:
    """Initial guesses for the loads of one surface, each independent of the other loads."""

    def __init__(self, profile: Waves, surface: Surface, tolerance: float) -> None:
        """Nothing is computed before it is needed."""
        self.profile, self.surface, self.tolerance = profile, surface, tolerance
        self._grid = cache(self._make_grid)

    def _make_grid(self, per_wave: int) -> GridSolver:
        points = per_wave * self.profile.waves_per_period[-1]
        # The residual, in g_0, that Newton's method can start from.
        tolerance = min(GRID_TOLERANCE, WAVE_SHARE * abs(float(self.profile.amplitude[-1])))
        return GridSolver(self.profile, points, max(MIN_GRID_TOLERANCE, tolerance), RATE_TOLERANCE)

    def guesses(self, load: float) -> Iterator[Iterate]:
        """What to start from under this load, the most likely first."""
        lone = lone_contacts(self.surface.heights, load)
        if lone is not None:
            yield lone
        lone = lone_gaps(self.surface.tensions, load)
        if lone is not None:
            yield lone
        for per_wave in POINTS_PER_WAVE:
            left, right, force, _ = self._grid(per_wave).solve_alone(load).contacts
            wide = right > left
            if wide.any():
                middle, half_width = 0.5 * (left + right)[wide], 0.5 * (right - left)[wide]
                yield contacts_guess(self.surface, middle, half_width, force[wide], self.tolerance)


@kernel
def segments_about(series: CosineSeries, middle: Array, half_width: Array) -> Segments:
    """Segments with as few nodes as a guess has, in order of their middles in [0, L)."""
    crest, y = nearest_crests(series, middle)
    origin = series.crest_position[crest]
    origin = origin + series.period * np.rint((middle - y - origin) / series.period)
    count = estimate_node_count(origin, y, half_width, series, COARSE_TOLERANCE)
    return make_segments(crest, origin, y, half_width, count, series.period)


@kernel
def _expected_nodes(segments: Segments, series: CosineSeries, tolerance: float) -> int:
    count = estimate_node_count(segments.origin, segments.centre, segments.half_width, series, tolerance)
    return int(count.sum())


@kernel
def contacts_guess(surface: Surface, middle: Array, half_width: Array, force: Array, tolerance: float) -> Iterate:
    """A guess on contacts, or on the gaps between them if these need clearly fewer nodes; the density is rough.

    middle, half_width : of the contacts, in lambda_0, shape (contacts,)
    force : that each carries, in p_0* lambda_0, shape (contacts,)
    """
    period = surface.heights.period
    middle = middle - period * np.floor(middle / period)
    order = np.argsort(middle, kind="mergesort")
    contacts = segments_about(surface.heights, middle[order], half_width[order])
    distance = distances_to_next(contacts, period)
    if np.all(distance > 0):
        between = middle[order] + half_width[order] + 0.5 * distance
        between -= period * np.floor(between / period)
        by_position = np.argsort(between, kind="mergesort")
        gaps = segments_about(surface.tensions, between[by_position], 0.5 * distance[by_position])
        needed = _expected_nodes(contacts, surface.heights, tolerance)
        if _expected_nodes(gaps, surface.tensions, tolerance) < MAX_NODE_RATIO * needed:
            return Iterate(True, gaps, np.zeros(gaps.node.size), 0.0)
    pressure = 2 / np.pi * force[order] / contacts.half_width  # of Hertz's contact, at its centre
    return Iterate(False, contacts, np.repeat(pressure, np.diff(contacts.first_node)), 0.0)


def lone_contacts(series: CosineSeries, load: float) -> Iterate | None:
    """Hertz's contacts on the crests that touch, as they sink in under each other's forces; None if they are wide.

    A contact of half-width a sinks in by F (1 - 2 ln(pi a/L)) under its force F, and by -2 F ln|2 sin(pi d/L)| under
    one at the distance d.
    """
    touching, half_width, approach = _find_lone_contacts(series, load)
    return _lone_guess(series, False, touching, half_width, approach) if touching.size > 0 else None


@kernel
def _find_lone_contacts(series: CosineSeries, load: float) -> tuple[Indices, Array, float]:
    """The crests that touch, none if contacts are wide, the half-widths there, and the approach."""
    curvature, everywhere = crest_curvatures(series), np.arange(series.crest_offset.size)
    touching = np.flatnonzero(series.crest_offset == 0)
    force = np.full(touching.size, load * series.period / touching.size)
    for _ in range(MAX_FORCE_STEPS):
        n = touching.size
        half_width = 2 * np.sqrt(force / curvature[touching])
        if n > MAX_LONE_CONTACTS or not _are_lone(series, touching, half_width):
            break
        matrix, residual, max_own = np.zeros((n + 1, n + 1)), np.empty(n + 1), -np.inf
        matrix[:n, :n] = _influence(series, touching, touching)
        for i in range(n):
            own = displacement_of_punch(half_width[i], series.period)
            max_own = max(max_own, own)
            residual[i] = matrix[i, :n] @ force + force[i] * (1 + own) - series.crest_offset[touching[i]]
            matrix[i, i] += own
            matrix[i, n] = matrix[n, i] = 1.0
        residual[n] = force.sum() - load * series.period
        step = np.linalg.solve(matrix, residual)
        approach = step[n]
        force = np.maximum(force - step[:n], 0.1 * force)
        if np.abs(step[:n]).max() > FORCE_TOLERANCE * force.sum():
            continue
        above = approach + series.crest_offset - _influence(series, everywhere, touching) @ force
        above[touching] = 0.0
        new = np.flatnonzero(above > 0)
        if new.size == 0:
            return touching, half_width, approach
        touching, force = np.append(touching, new), np.append(force, above[new] / (1 + max_own))
    return everywhere[:0], force[:0], 0.0


@kernel
def crest_curvatures(series: CosineSeries) -> Array:
    """-S'' at all crests, shape (crests,)."""
    return series.crest_cosine @ (series.amplitude * series.wavenumber**2)


@kernel
def _influence(series: CosineSeries, at: Indices, of: Indices) -> Array:
    """Displacement of crests under unit forces on others, shape (at, of), in g_0/p_0*; 0 under their own."""
    influence = np.zeros((at.size, of.size))
    for i in range(at.size):
        for j in range(of.size):
            if at[i] != of[j]:
                apart = series.crest_position[at[i]] - series.crest_position[of[j]]
                influence[i, j] = displacement_at_distance(apart, series.period)
    return influence


def lone_gaps(series: CosineSeries, load: float) -> Iterate | None:
    """The gaps where full contact would be in tension, if they are so small that they do not bear on each other."""
    crest, half_width = _find_lone_gaps(series, load)
    return _lone_guess(series, True, crest, half_width, 0.0) if crest.size > 0 else None


@kernel
def _find_lone_gaps(series: CosineSeries, load: float) -> tuple[Indices, Array]:
    """The crests of tension, none if the gaps there are wide, and the half-widths."""
    tension = series.maximum - load + series.crest_offset
    crest = np.flatnonzero(tension > 0)
    half_width = 2 * np.sqrt(tension[crest] / crest_curvatures(series)[crest])
    lone = crest.size > 0 and _are_lone(series, crest, half_width)
    return (crest, half_width) if lone else (crest[:0], half_width[:0])


@kernel
def _are_lone(series: CosineSeries, crest: Indices, half_width: Array) -> bool:
    """Whether segments on crests, in any order, are parabolic, and so small that they hardly feel each other."""
    if not np.all(half_width * series.wavenumber[-1] < MAX_RADIANS):
        return False
    position, n = series.crest_position[crest], crest.size
    order = np.argsort(position)
    for i in range(n):
        j, k = order[i], order[(i + 1) % n]
        distance = position[k] - position[j] + (series.period if i == n - 1 else 0.0)
        if not max(half_width[j], half_width[k]) < MAX_CROWDING * distance:
            return False
    return True


@kernel
def _lone_guess(series: CosineSeries, dual: bool, crest: Indices, half_width: Array, approach: float) -> Iterate:
    """Hertz's density on segments in the middle of crests, or that of gaps in a parabola of tension (dual)."""
    order = np.argsort(series.crest_position[crest])
    crest, half_width = crest[order], half_width[order]
    segments = segments_about(series, series.crest_position[crest], half_width)
    curvature = crest_curvatures(series)[crest]
    phi = np.empty(segments.node.size)
    for j in range(crest.size):
        for q in range(segments.first_node[j], segments.first_node[j + 1]):
            phi[q] = curvature[j] * half_width[j] / (2 * np.pi)
            if dual:
                phi[q] = -np.pi * curvature[j] * half_width[j] ** 2 * segments.node[q]
    return Iterate(dual, segments, phi, approach)
