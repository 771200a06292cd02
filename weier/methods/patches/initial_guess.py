"""Where Newton's method starts: the contacts that a load is likely to have, and the density on them.

The contacts come from crests where they are tiny, and from boundary elements elsewhere.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Indices
from weier.kernels.jit import kernel
from weier.methods.bem.subgrid_solver import GridSolver
from weier.methods.errors import ConvergenceError
from weier.methods.patches.chebyshev import nodes
from weier.methods.patches.defect_correction import own_density, residuals
from weier.methods.patches.fields import ContactState, density
from weier.methods.patches.segments import Segments, distances_between, estimate_node_count, make_segments
from weier.methods.patches.surface import CosineSeries, Surface, nearest_crests
from weier.theory.profile import Profile

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
COARSE_TOLERANCE = 1e-3  # of the density on the few nodes that Newton's method solves for


class InitialGuess(NamedTuple):
    """Segments, phi at their nodes and the approach, as in `ContactState`."""

    dual: bool
    segments: Segments
    phi: Array
    approach: float


class Intervals(NamedTuple):
    """Intervals by the index of a crest, centre from there and half-width, each of shape (intervals,)."""

    crest: Indices
    centre: Array
    half_width: Array


def sort_segments(
    series: CosineSeries,
    intervals: Intervals,
    tolerance: float = COARSE_TOLERANCE,
    node_count: Indices | None = None,
) -> tuple[Segments, Indices]:
    """Segments in order round the period, and the permutation that sorted them.

    They have so many nodes, or else as many as a density within the tolerance is expected to need.
    """
    if not np.all(intervals.half_width > 0):
        raise ConvergenceError("a contact or a gap has lost its width")
    crest, origin, centre, half_width, order = _lay_out(series, intervals)
    if node_count is None:
        count = estimate_node_count(origin, centre, half_width, series, tolerance)
    else:
        count = node_count[order]
    return make_segments(crest, origin, centre, half_width, count, series.period), order


@kernel
def _lay_out(series: CosineSeries, intervals: Intervals) -> tuple[Indices, Array, Array, Array, Indices]:
    """Crest, origin, centre and half-width, as of `Segments`, in order round the period; and the permutation."""
    crest, centre, half_width = intervals
    origin = series.crest_position[crest]
    origin = origin - series.period * np.floor((origin + centre) / series.period)
    order = np.argsort(origin + centre, kind="mergesort")
    return crest[order], origin[order], centre[order], half_width[order], order


@kernel
def contacts_guess(
    surface: Surface, middle: Array, half_width: Array, force: Array, tolerance: float
) -> InitialGuess:
    """A guess on contacts, or on the gaps between them if these need clearly fewer nodes; the density is rough.

    middle, half_width : of the contacts, in lambda_0, shape (contacts,)
    force : that each carries, in p_0* lambda_0, shape (contacts,)
    """
    heights, tensions, period = surface.heights, surface.tensions, surface.heights.period
    nearest, y = nearest_crests(heights, middle)
    crest, origin, centre, r, order = _lay_out(heights, Intervals(nearest, y, half_width))
    distance = distances_between(origin, centre, r, period)
    if np.all(distance > 0):
        nearest, y = nearest_crests(tensions, origin + (centre + r) + 0.5 * distance)
        gap, start, middle, width, _ = _lay_out(tensions, Intervals(nearest, y, 0.5 * distance))
        on_gaps = estimate_node_count(start, middle, width, tensions, tolerance)
        if on_gaps.sum() < MAX_NODE_RATIO * estimate_node_count(origin, centre, r, heights, tolerance).sum():
            segments = _make_coarse(tensions, gap, start, middle, width)
            return InitialGuess(True, segments, np.zeros(segments.node.size), 0.0)
    segments = _make_coarse(heights, crest, origin, centre, r)
    phi = np.repeat(2 / np.pi * force[order] / r, np.diff(segments.first_node))
    return InitialGuess(False, segments, phi, 0.0)


@kernel
def _make_coarse(series: CosineSeries, crest: Indices, origin: Array, centre: Array, half_width: Array) -> Segments:
    """Segments with as few nodes as a guess has."""
    count = estimate_node_count(origin, centre, half_width, series, COARSE_TOLERANCE)
    return make_segments(crest, origin, centre, half_width, count, series.period)


def refine_density(surface: Surface, guess: InitialGuess, load: float) -> InitialGuess:
    """The guess with the density that each segment takes under those of the others."""
    return guess._replace(phi=_own_densities(surface.series(guess.dual), guess, load))


@kernel
def _own_densities(series: CosineSeries, guess: InitialGuess, load: float) -> Array:
    row = residuals(guess.segments, guess.phi, guess.approach, series, load, guess.dual)
    return guess.phi - own_density(row, guess.segments, series.period)


def transfer_density(surface: Surface, state: ContactState, node_count: Indices | None = None) -> InitialGuess:
    """A guess on the segments of a state, with so many nodes each, or as few as a guess has."""
    series, old = surface.series(state.dual), state.segments
    intervals = Intervals(old.crest, old.centre, old.half_width)
    new, _ = sort_segments(series, intervals, COARSE_TOLERANCE, node_count)
    return InitialGuess(state.dual, new, sample_density(state, series, new), state.approach)


@kernel
def sample_density(state: ContactState, series: CosineSeries, new: Segments) -> Array:
    """phi at the nodes of other segments, from the density of a state."""
    phi = np.empty(new.node.size)
    for j in range(new.centre.size):
        for q in range(new.first_node[j], new.first_node[j + 1]):
            s = new.node[q]
            y = new.centre[j] + new.half_width[j] * s
            phi[q] = density(state, series.period, new.origin[j], y) / np.sqrt((1 - s) * (1 + s))
    return phi


@kernel
def hertz_density(dual: bool, curvature: float, half_width: float, node_count: int) -> Array:
    """phi of a segment so small that its neighbours do not matter.

    That is Hertz's contact, where `curvature` is -z''; or the gap where the pressure of full contact is a parabola in
    tension, and `curvature` its second derivative (dual).
    """
    if dual:
        return -np.pi * curvature * half_width**2 * nodes(node_count)
    return np.full(node_count, curvature * half_width / (2 * np.pi))


class Starts:
    """Initial guesses for the loads of one profile, each independent of the other loads."""

    def __init__(self, profile: Profile, surface: Surface, tolerance: float) -> None:
        """Nothing is computed before it is needed."""
        self.profile, self.surface, self.tolerance = profile, surface, tolerance
        self._grid = cache(self._make_grid)

    def _make_grid(self, per_wave: int) -> GridSolver:
        points = per_wave * self.profile.waves_per_period[-1]
        return GridSolver(self.profile, points, _grid_tolerance(self.profile), RATE_TOLERANCE)

    def guesses(self, load: float) -> Iterator[InitialGuess]:
        """What to start from under this load, the most likely first."""
        lone = lone_contacts(self.surface.heights, load)
        if lone is not None:
            yield lone
        lone = lone_gaps(self.surface.tensions, load)
        if lone is not None:
            yield lone
        for per_wave in POINTS_PER_WAVE:
            found = self._from_grid(per_wave, load)
            if found is not None:
                yield found

    def _from_grid(self, per_wave: int, load: float) -> InitialGuess | None:
        """The contacts on a grid, but for those that have no width there; None if all have none."""
        left, right, force, _ = self._grid(per_wave).solve_alone(load).contacts
        wide = right > left
        if not wide.any():
            return None
        middle, half_width = 0.5 * (left + right)[wide], 0.5 * (right - left)[wide]
        return contacts_guess(self.surface, middle, half_width, force[wide], self.tolerance)


def _grid_tolerance(profile: Profile) -> float:
    """The residual, in g_0, that Newton's method can start from."""
    return max(MIN_GRID_TOLERANCE, min(GRID_TOLERANCE, WAVE_SHARE * abs(float(profile.amplitude[-1]))))


def lone_contacts(series: CosineSeries, load: float) -> InitialGuess | None:
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
        matrix, off, max_own = np.zeros((n + 1, n + 1)), np.empty(n + 1), -np.inf
        matrix[:n, :n] = _influence(series, touching, touching)
        for i in range(n):
            own = -2 * np.log(np.pi * half_width[i] / series.period)
            max_own = max(max_own, own)
            off[i] = matrix[i, :n] @ force + force[i] * (1 + own) - series.crest_offset[touching[i]]
            matrix[i, i] += own
            matrix[i, n] = matrix[n, i] = 1.0
        off[n] = force.sum() - load * series.period
        step = np.linalg.solve(matrix, off)
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
                influence[i, j] = -2 * np.log(np.abs(2 * np.sin(np.pi / series.period * apart)))
    return influence


def lone_gaps(series: CosineSeries, load: float) -> InitialGuess | None:
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
def _lone_guess(series: CosineSeries, dual: bool, crest: Indices, half_width: Array, approach: float) -> InitialGuess:
    """Hertz's density on segments in the middle of crests."""
    intervals, curvature = Intervals(crest, np.zeros(crest.size), half_width), crest_curvatures(series)
    crest, origin, centre, half_width, _ = _lay_out(series, intervals)
    segments = _make_coarse(series, crest, origin, centre, half_width)
    phi = np.empty(segments.node.size)
    for j in range(crest.size):
        here = slice(segments.first_node[j], segments.first_node[j + 1])
        phi[here] = hertz_density(dual, curvature[crest[j]], half_width[j], phi[here].size)
    return InitialGuess(dual, segments, phi, approach)
