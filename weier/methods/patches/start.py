"""Initial contacts or gaps of each load (docs/patches.md, "Where a load starts").

`Starts.guess` returns Hertzian contacts on crests (`isolated_contacts`), the last gaps on crests of the tension
(`isolated_gaps`), or the contacts or gaps of a coarse grid (`contacts_guess`; edges by docs/bem.md, "The staircase").
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Indices
from weier.kernels.jit import kernel
from weier.methods.bem.active_set import NestedSolver
from weier.methods.bem.staircase import in_continuum
from weier.methods.chebyshev import gauss_rule
from weier.methods.errors import ConvergenceError
from weier.methods.method import TOLERANCES
from weier.methods.patches.contacts import CONTACTS
from weier.methods.patches.gaps import GAPS
from weier.methods.patches.kind import MAX_TOLERANCE, Kind
from weier.methods.patches.segments import (
    ContactState,
    Segments,
    estimate_node_count,
)
from weier.methods.patches.surface import (
    CosineSeries,
    Sides,
    Surface,
    distances_between,
    evaluate_at,
    from_crests,
    in_order,
    intervals_between,
    surface_of,
)
from weier.methods.patches.thin_gaps import NODES, settle_edges
from weier.methods.punches import OFFSET
from weier.surface.crests import Expansions
from weier.surface.waves import Waves
from weier.theory.halfplane import displacement_at_distance, punch_displacement

# relative accuracy of a guess: of the forces of isolated contacts and of the tangent pressure on grids, of the
# residual of boundary elements over the finest wave, of an expansion for a wave, and of a line force for a contact
GUESS_TOLERANCE = 0.02
# contacts whose forces are found as line forces, by dense equations, in as many steps; 3 or 4 are usual
MAX_ISOLATED = 32
POINTS_PER_WAVE = 16  # points per finest wave of the grid
# default tolerance of the compliance, in g_0, for which the numbers of nodes are compared: for 1e-4, contacts were
# chosen at loads at which gaps are up to three times as fast
TOLERANCE = 1e-10

_displacement_of_punch = kernel(punch_displacement)

# Middle and half-width of contacts or gaps, in lambda_0, shape (2, segments)
Intervals = NDArray[np.float64]


class Starts:
    """Initial guesses for the loads of one surface, each independent of the other loads."""

    def __init__(self, profile: Waves, tolerance: float) -> None:
        """Prepare starts for a tolerance of the compliance, in g_0; ValueError if it is out of range."""
        if tolerance not in TOLERANCES:
            raise ValueError(f"tolerance must lie in {TOLERANCES} for contact patches, got {tolerance}")
        self.profile, self.surface, self.tolerance = profile, surface_of(profile), tolerance

    @cached_property
    def _grid(self) -> NestedSolver:
        points = POINTS_PER_WAVE * self.profile.waves_per_period[-1]
        tolerance = min(MAX_TOLERANCE, GUESS_TOLERANCE * abs(float(self.profile.amplitude[-1])))
        # The finest waves of a smooth measured surface are rounding.
        return NestedSolver(self.profile, points, max(TOLERANCE, tolerance))

    def guess(self, load: float) -> ContactState:
        """Return the contacts, or the gaps, that are likely under this load.

        ConvergenceError is raised if the grid shows no contact or no gap.
        """
        heights, tensions = self.surface.heights, self.surface.tensions
        if isolated := isolated_contacts(heights, load) or isolated_gaps(tensions, load):
            return isolated
        solution, found = self._grid.solve_discrete(load, True, GUESS_TOLERANCE), np.empty((2, 0))
        if np.isfinite(solution.resistance):
            edge = self.surface.heights.period / solution.contact.size * in_continuum(solution)[-1]
            left, right = edge.reshape(-1, 2).T
            found = 0.5 * np.stack([left + right, right - left])[:, right > left]
        if found.size == 0:
            raise ConvergenceError(f"a grid shows no contacts to start from under the mean pressure {load:.6g} p_0*")
        return contacts_guess(self.surface, load, found)


def _make_guess(series: CosineSeries, load: float, kind: Kind, places: Intervals) -> ContactState:
    """Return segments, given in any order, without nodes."""
    order, turns = in_order(places[0], series.period)
    placed = *from_crests(series, (places[0] - turns)[order]), places[1, order]
    return ContactState(kind, load, 0.0, Segments(*placed))


def merge_overlaps(places: Intervals, period: float) -> Intervals:
    """Return intervals in order, with overlapping ones merged, since the edges of a grid are not exact."""
    middle, half_width = places
    left = (middle - half_width) % period
    order = left.argsort()
    left, half_width = left[order], half_width[order]
    right = np.maximum.accumulate(left + 2 * half_width)
    is_first, is_last = np.ones((2, left.size), bool)
    is_first[1:] = is_last[:-1] = left[1:] > right[:-1]
    left, right = left[is_first], right[is_last]
    if left.size > 1 and right[-1] >= left[0] + period:
        right[-1] = max(right[-1], right[0] + period)
        left, right = left[1:], right[1:]
    return 0.5 * np.array([left + right, right - left])


def contacts_guess(surface: Surface, load: float, contacts: Intervals) -> ContactState:
    """Return a guess on contacts in any order, or on the gaps between them if these need fewer nodes."""
    places = merge_overlaps(contacts, surface.heights.period)
    return with_fewer_nodes(surface, _make_guess(surface.heights, load, CONTACTS, places))


def with_fewer_nodes(surface: Surface, guess: ContactState) -> ContactState:
    """Return a guess on contacts or on the gaps between them, whichever needs fewer nodes."""
    extent, period = guess.segments.extent, surface.heights.period
    origin, centre, half_width = between = intervals_between(extent, period)
    other = CONTACTS if guess.kind is GAPS else GAPS
    here, there = guess.kind.series(surface), other.series(surface)
    needed = estimate_node_count(extent, here, TOLERANCE).sum()
    if half_width.min() <= 0 or estimate_node_count(between, there, TOLERANCE).sum() >= needed:
        return guess
    return _make_guess(there, guess.load, other, np.stack([origin + centre, half_width]))


def _widest(series: CosineSeries) -> float:
    """Return the largest half-width of a guess from the expansion of a crest."""
    return 0.5 * np.pi / float(series.wavenumber[-1])


def isolated_contacts(series: CosineSeries, load: float) -> ContactState | None:
    """Return Hertzian contacts on crests if they are small enough to interact as line forces; otherwise None."""
    total = load * series.period
    # A lower bound on the widest contact: all crests are as sharp as can be and share the load equally.
    if 2 * np.sqrt(total / series.crest_offset.size / series.largest_curvature) > _widest(series):
        return None
    crests = series.crest_position, series.crest_offset, series.expansion
    forces = _forces_on_crests(*crests, series.step, series.period, total, _widest(series))
    return _isolated(series, load, CONTACTS, forces, False)


def isolated_gaps(series: CosineSeries, load: float) -> ContactState | None:
    """Return the gaps where full contact would be in tension, if they are narrow."""
    most = series.maximum - load
    # A lower bound on the widest gap: the largest tension on a crest as sharp as can be.
    if most <= 0 or 2 * np.sqrt(most / series.largest_curvature) > _widest(series):
        return None
    return _isolated(series, load, GAPS, np.maximum(most + series.crest_offset, 0.0), True)


def _isolated(series: CosineSeries, load: float, kind: Kind, amount: Array, merges: bool) -> ContactState | None:
    """Return segments on crests under these forces or tensions, without nodes; None if they are not isolated.

    On crests too flat for four terms, edges are moved until the series itself has no singularity there, and segments
    that then overlap are merged if that is allowed.
    """
    place = amount, series.expansion, series.step, 0.5 if kind.is_slope else 1.0, _widest(series)
    crest, y, half_width, is_accurate = _places_on_crests(*place)
    origin, period = series.crest_position[crest], series.period
    if crest.size == 0:
        return None
    if not is_accurate and (merges or _are_apart(origin, y, half_width, period)):
        rule = gauss_rule(NODES, False)

        def singularities(y: Array, r: Array) -> tuple[Sides, Sides]:
            at = y[:, None] + r[:, None] * rule.node
            c = evaluate_at(series.local, np.repeat(crest, NODES), at.ravel(), 0).reshape(at.shape) @ rule.expansion.T
            return kind.singularities(c, amount[crest], amount.max())

        is_new = True
        while is_new:
            y, half_width, found = settle_edges(singularities, y, half_width, 2 * _widest(series), GUESS_TOLERANCE)
            places = merge_overlaps(np.stack([origin + y, half_width]), period)
            is_new = places.shape[1] < crest.size
            if not found.all() or (is_new and not merges):
                return None
            if is_new:
                half_width = places[1]
                crest, origin, y = from_crests(series, places[0])
    if not _are_apart(origin, y, half_width, period):
        return None
    return ContactState(kind, load, 0.0, Segments(crest, origin, y, half_width))


@kernel
def _are_apart(origin: Array, y: Array, half_width: Array, period: float) -> bool:
    """Return whether segments act on each other as line forces; the relative error is (half-width/distance)^2."""
    distance, nearest, are_narrow = distances_between(origin, y, np.zeros(y.size), period), np.inf, True
    for j in range(y.size):
        nearest = min(nearest, distance[j])
    for j in range(y.size):
        are_narrow = are_narrow and half_width[j] < np.sqrt(GUESS_TOLERANCE) * nearest
    return are_narrow


@kernel
def _half_width(e: Array, amount: float, weight: float, most: float) -> float:
    """Return the half-width of a segment on a crest with the expansion e, in its unit of length, up to a limit."""
    bend, quartic = 0.5 * max(-e[2], 0.0), -0.75 * weight * e[4]
    return min(np.sqrt(2 * amount / (bend + np.sqrt(max(bend * bend + 4 * quartic * amount, 1e-300)))), most)


@kernel
def _places_on_crests(
    amount: Array, expansion: Expansions, step: float, weight: float, widest: float
) -> tuple[Indices, Array, Array, bool]:
    """Return crests with a force or tension, shifts and half-widths of their segments, and whether all are accurate.

    They follow from the series up to x^4; x^5 and x^6 are the error. Cubic and quartic terms have the weight 1 for
    contacts and 1/2 for gaps.
    """
    crest, place, count, is_accurate = np.empty(amount.size, np.int64), np.empty((2, amount.size)), 0, True
    for k in range(amount.size):
        if amount[k] > 0:
            e, a = expansion[k], _half_width(expansion[k], amount[k], weight, widest / step)
            rigidity = -2 * e[2] - 6 * weight * e[4] * a * a
            y, rest = 1.5 * weight * e[3] * a * a / max(rigidity, 1e-300), abs(e[5]) * a**3 + abs(e[6]) * a**4
            # A shift of y changes the curvature by a relative (2 y/a)^2 and the half-width by half of that.
            is_small = 2 * y * y < GUESS_TOLERANCE * a * a
            is_accurate = is_accurate and is_small and 4 * rest < GUESS_TOLERANCE * rigidity and a < widest / step
            crest[count], place[0, count], place[1, count] = k, step * y if is_small else 0.0, step * a
            count += 1
    return crest[:count], place[0, :count], place[1, :count], is_accurate


@kernel
def _solve(matrix: NDArray[np.float64], right: Array) -> Array:
    """Solve linear equations in place, by elimination without pivoting: cheaper to compile than LAPACK's."""
    n = right.size
    for i in range(n):
        for j in range(i + 1, n):
            factor = matrix[j, i] / matrix[i, i]
            right[j] -= factor * right[i]
            for k in range(i + 1, n):
                matrix[j, k] -= factor * matrix[i, k]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            right[i] -= matrix[i, k] * right[k]
        right[i] /= matrix[i, i]
    return right


@kernel
def _forces_on_crests(
    position: Array, offset: Array, expansion: Expansions, step: float, period: float, total: float, widest: float
) -> Array:
    """Return the forces of Hertzian contacts on crests, shape (crests,); all 0 if they are not found.

    On the crest -kappa x^2/2 - q x^4 the force is F = kappa a^2/4 + 3 q a^4/4. `OFFSET` shifts all displacements and
    the plane alike, since the sum of the forces is given. Forces lift no point by more than 2 ln 2 times their sum:
    crests farther below the plane need not be tried.
    """
    n, lowest, most = offset.size, -2 * np.log(2.0) * total, MAX_ISOLATED
    force, none, crest = np.empty(n), np.zeros(n), np.empty(most, np.int64)
    for k in range(n):
        force[k] = total if offset[k] == 0 else 0.0
    for _ in range(most):
        count = 0
        for k in range(n):
            if force[k] > 0:
                if count == most:
                    return none
                crest[count] = k
                count += 1
        matrix, height = np.empty((count + 1, count + 1)), np.empty(count + 1)
        # The displacements by the forces on all crests and the plane add up to the height of each crest.
        for i in range(count):
            k = crest[i]
            own = 1 + _displacement_of_punch(step * _half_width(expansion[k], force[k], 1.0, widest / step), period)
            for j in range(count):
                x = position[k] - position[crest[j]]
                matrix[i, j] = OFFSET + (own if i == j else displacement_at_distance(x, period))
            matrix[i, count] = matrix[count, i] = 1.0
            height[i] = offset[k]
        matrix[count, count], height[count] = 0.0, total  # The sum of the forces is the load.
        found = _solve(matrix, height)
        approach, is_settled = -found[count] - OFFSET * total, True
        for i in range(count):
            before, force[crest[i]] = force[crest[i]], max(found[i], 0.0)
            is_settled = is_settled and abs(found[i] - before) < GUESS_TOLERANCE * before
        for j in range(n):
            if force[j] == 0 and offset[j] + approach > lowest:
                gap = -approach - offset[j]
                for i in range(count):
                    if crest[i] != j:
                        gap += found[i] * displacement_at_distance(position[crest[i]] - position[j], period)
                if gap < 0:
                    force[j], is_settled = total / n, False
        if is_settled:
            return force
    return none
