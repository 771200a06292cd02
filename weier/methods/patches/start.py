"""Where an iteration starts: the contacts that a load is likely to have, and the density on them.

The contacts come from crests where they are tiny, and from boundary elements on a coarse grid elsewhere.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import numpy as np

from weier.kernels.arrays import Array, Indices
from weier.methods.bem.subgrid_solver import GridSolver
from weier.methods.patches.segments import (
    COARSE_TOLERANCE,
    Iterate,
    distances_between,
    estimate_node_count,
    in_order,
    make_segments,
)
from weier.methods.patches.surface import CosineSeries, Surface, nearest_crests
from weier.theory.halfplane import displacement_at_distance, displacement_of_punch
from weier.theory.waves import Waves

MAX_RADIANS = 0.5  # of the finest wave in the half-width of a contact that is Hertz's, or of a gap like it
MAX_CROWDING = 0.1  # of the half-width over the distance of the next one, for the same
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
        for find, series in ((lone_contacts, self.surface.heights), (lone_gaps, self.surface.tensions)):
            if (lone := find(series, load)) is not None:
                yield lone
        for per_wave in POINTS_PER_WAVE:
            found = self._grid(per_wave).solve_alone(load).contacts
            found = found[found["right"] > found["left"]]
            if found.size:
                middle, half_width = 0.5 * (found["left"] + found["right"]), 0.5 * (found["right"] - found["left"])
                yield contacts_guess(self.surface, middle, half_width, found["force"], self.tolerance)


def _make_guess(series: CosineSeries, dual: bool, middle: Array, half_width: Array, force: Array | float) -> Iterate:
    """Segments in order of their middles in [0, L) on as few nodes as a guess has, with Hertz's largest pressure.

    force : that each contact carries, in p_0* lambda_0; 0 for gaps, whose slope Newton's method finds
    """
    crest, y = nearest_crests(series, middle)
    origin = series.crest_position[crest]
    origin = origin + series.period * np.rint((middle - y - origin) / series.period)
    count = estimate_node_count(origin, y, half_width, series, COARSE_TOLERANCE)
    segments = make_segments(crest, origin, y, half_width, count, series.period)
    return Iterate(dual, segments, np.repeat(2 / np.pi * force / half_width, count), 0.0)


def contacts_guess(surface: Surface, middle: Array, half_width: Array, force: Array, tolerance: float) -> Iterate:
    """A guess on contacts in any order, or on the gaps between them if these need clearly fewer nodes.

    middle, half_width : of the contacts, in lambda_0, shape (contacts,)
    force : that each carries, in p_0* lambda_0, shape (contacts,)
    """
    period = surface.heights.period
    middle, half_width, order = in_order(middle, half_width, period)
    none = np.zeros(middle.size)
    distance = distances_between(middle, none, half_width, period)
    if np.all(distance > 0):
        between, open_width, _ = in_order(middle + half_width + 0.5 * distance, 0.5 * distance, period)
        needed = estimate_node_count(middle, none, half_width, surface.heights, tolerance).sum()
        of_gaps = estimate_node_count(between, none, open_width, surface.tensions, tolerance).sum()
        if of_gaps < MAX_NODE_RATIO * needed:
            return _make_guess(surface.tensions, True, between, open_width, 0.0)
    return _make_guess(surface.heights, False, middle, half_width, force[order])


def lone_contacts(series: CosineSeries, load: float) -> Iterate | None:
    """Hertz's contacts on the highest crests, which share the load alike; None if they are wide, or others may touch.

    A contact of half-width a sinks in by F (1 - 2 ln(pi a/L)) under its force F, and by less under that of another.
    Nowhere does a force displace the surface by less than half a period away.
    """
    touching = np.flatnonzero(series.crest_offset == 0)
    total = load * series.period
    half_width = 2 * np.sqrt(total / touching.size / crest_curvatures(series)[touching])
    if not _are_lone(series, touching, half_width):
        return None
    approach = total * (1 + displacement_of_punch(float(half_width.min()), series.period))
    lowest = total * displacement_at_distance(0.5 * series.period, series.period)
    if np.any((series.crest_offset < 0) & (series.crest_offset + approach > lowest)):
        return None
    return _make_guess(series, False, series.crest_position[touching], half_width, total / touching.size)


def crest_curvatures(series: CosineSeries) -> Array:
    """-S'' at all crests, shape (crests,)."""
    return np.asarray(series.crest_cosine @ (series.amplitude * series.wavenumber**2))


def lone_gaps(series: CosineSeries, load: float) -> Iterate | None:
    """The gaps where full contact would be in tension, if they are so small that they do not bear on each other."""
    tension = series.maximum - load + series.crest_offset
    crest = np.flatnonzero(tension > 0)
    half_width = 2 * np.sqrt(tension[crest] / crest_curvatures(series)[crest])
    if crest.size == 0 or not _are_lone(series, crest, half_width):
        return None
    return _make_guess(series, True, series.crest_position[crest], half_width, 0.0)


def _are_lone(series: CosineSeries, crest: Indices, half_width: Array) -> bool:
    """Whether segments on crests, in order, are parabolic, and so small that they hardly feel each other."""
    if not np.all(half_width * series.wavenumber[-1] < MAX_RADIANS):
        return False
    position = series.crest_position[crest]
    distance = np.append(position[1:], position[0] + series.period) - position
    return bool(np.all(np.maximum(half_width, np.roll(half_width, -1)) < MAX_CROWDING * distance))
