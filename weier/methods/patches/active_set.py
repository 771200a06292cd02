"""One load: Newton's method on a set of segments, and corrections of the set until every contact condition holds.

This is the active-set method of contact mechanics with whole segments in place of grid points: segments are added
where the complementary residual is negative, cut where their own pressure or gap is, removed where they vanish, and
merged where they meet.
"""

from __future__ import annotations

import numpy as np

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.jit import kernel
from weier.methods.errors import ConvergenceError
from weier.methods.patches.defect_correction import refine
from weier.methods.patches.fields import ContactState, complementary_residual, expand
from weier.methods.patches.inequalities import NegativeIntervals, find_missing_segments, find_negative_intervals
from weier.methods.patches.initial_guess import (
    COARSE_TOLERANCE,
    InitialGuess,
    Intervals,
    hertz_density,
    intervals_of,
    keep_segments,
    transfer_density,
)
from weier.methods.patches.newton import NewtonResult, NewtonStatus, newton_iteration
from weier.methods.patches.segments import (
    MAX_NODES,
    Segments,
    coefficient_tails,
    distances_to_next,
    estimate_node_count,
    increase_node_count,
)
from weier.methods.patches.surface import CosineSeries, Surface

MAX_ROUNDS = 16
MAX_TOPOLOGY_ROUNDS = 6  # in a row that only merge and remove segments: the initial guess was no good
MAX_UNKNOWNS = 8000  # on few nodes, a dense matrix of 0.5 GB, and 15 s for each step
MAX_NODE_ROUNDS = 6  # of adding nodes
MAX_RESIDUAL = 100  # that is accepted, in units of the tolerance
# Tension, over the pressure, that may remain where two contacts have nearly merged: it changes dh/dp by less than
# itself, and h by its square.
MAX_TENSION = 1e-9
CUT_WIDENING = 0.2  # at each end of a cut, so that the cut is sqrt(2) times the negative interval
MIN_PIECE = 1e-3  # of a segment's width: shorter pieces do not survive a cut


class TooLargeError(ConvergenceError):
    """There are more unknowns than a dense matrix should hold."""


def solve_active_set(
    surface: Surface, guess: InitialGuess, load: float, tolerance: float
) -> tuple[ContactState, int]:
    """The state under one load, from a guess on few nodes, and the Newton steps and corrections that it took.

    ConvergenceError is raised if Newton's method stalls, if corrections go on for too many rounds, or if the state
    does not meet the contact conditions in the end.
    """
    steps, topology_rounds, step_size = 0, 0, float("nan")
    for _ in range(MAX_ROUNDS):
        coarse = solve_on_few_nodes(surface, guess, load)
        steps, step_size = steps + coarse.steps, coarse.step_size
        topology_rounds = topology_rounds + 1 if coarse.status == NewtonStatus.topology else 0
        if coarse.status == NewtonStatus.stalled or topology_rounds > MAX_TOPOLOGY_ROUNDS:
            break
        if coarse.status == NewtonStatus.topology:
            guess = remove_or_merge(surface, _state_of(coarse, guess.dual, load), coarse.meeting, coarse.vanishing)
            continue
        state, more, step_size = solve_on_many_nodes(surface, coarse, guess.dual, load, tolerance)
        steps += more
        if state is None:
            guess = _without_shallow_segments(surface, coarse, guess.dual, load, tolerance) or _with_nodes(
                surface, coarse, guess.dual, load, 2 * np.diff(coarse.segments.first_node), step_size
            )
            continue
        corrected = _correct_inequalities(surface, state, tolerance)
        if corrected is None:
            return _with_residual(surface, state, tolerance), steps
        guess = corrected
    raise ConvergenceError(
        f"no set of contacts was found that meets all conditions under the mean pressure {load:.6g} p_0*", step_size
    )


def solve_on_few_nodes(surface: Surface, guess: InitialGuess, load: float) -> NewtonResult:
    """Newton's method on the segments of a guess and so few nodes that its matrix is cheap."""
    unknowns = guess.phi.size + 2 * guess.segments.centre.size + 1
    if unknowns > MAX_UNKNOWNS:
        raise TooLargeError(
            f"the contacts under the mean pressure {load:.6g} p_0* need {unknowns} unknowns, more than "
            f"{MAX_UNKNOWNS}; take boundary elements"
        )
    series = surface.series(guess.dual)
    try:
        return newton_iteration(guess.segments, guess.phi, guess.approach, series, load, guess.dual, COARSE_TOLERANCE)
    except np.linalg.LinAlgError:
        raise ConvergenceError(f"the equations are singular under the mean pressure {load:.6g} p_0*") from None


def solve_on_many_nodes(
    surface: Surface, coarse: NewtonResult, dual: bool, load: float, tolerance: float
) -> tuple[ContactState | None, int, float]:
    """The state with its density resolved to the tolerance, or None if that does not converge; steps and the last."""
    few, series = coarse.segments, surface.series(dual)
    expected = estimate_node_count(few.origin, few.centre, few.half_width, series, tolerance)
    count, steps = np.maximum(expected, np.diff(few.first_node)), 0
    for _ in range(MAX_NODE_ROUNDS):
        refined = refine(coarse, count, series, load, dual, tolerance)
        steps += refined.steps
        if refined.status != NewtonStatus.converged:
            break
        state = _state_of(refined, dual, load)
        more = increase_node_count(state.segments, state.coefficient, load, tolerance)
        if more is None:
            return state, steps, refined.step_size
        count = more
    return None, steps, refined.step_size


def _state_of(result: NewtonResult, dual: bool, load: float) -> ContactState:
    """The state, unchecked, that solves the equations."""
    coefficient = expand(result.segments, result.phi)
    unknowns = result.approach, result.segments, result.phi, coefficient, result.sensitivity
    return ContactState(dual, load, *unknowns, np.nan)


def _without_shallow_segments(
    surface: Surface, coarse: NewtonResult, dual: bool, load: float, tolerance: float
) -> InitialGuess | None:
    """A guess without segments so shallow that nobody would miss them; None if there are none, or no others.

    Close to the load at which it is born or closes, a segment may be so shallow that rounding hides its density.
    """
    state = _state_of(coarse, dual, load)
    shallow = _depths(state) < _max_depth(state, tolerance)
    return keep_segments(surface, state, ~shallow) if np.any(shallow) and not np.all(shallow) else None


def _depths(state: ContactState) -> Array:
    """How deep the plane would overlap where each contact is, or how large the tension would be where each gap is.

    The density is taken for Hertz's, and the logarithm that the overlap of a contact has as a factor for 1.
    """
    r, first = state.segments.half_width, state.segments.first_node[:-1]
    phi = np.maximum.reduceat(np.abs(state.phi), first)
    return phi / (4 * np.pi) if state.dual else 0.5 * np.pi * r * phi


def _max_depth(state: ContactState, tolerance: float) -> float:
    """The overlap, in g_0, or the tension, in p_0*, that is left where a segment is missing."""
    return max(tolerance, MAX_TENSION) * state.load if state.dual else tolerance * abs(state.approach)


def _with_nodes(
    surface: Surface, coarse: NewtonResult, dual: bool, load: float, node_count: Indices, step_size: float
) -> InitialGuess:
    """A guess with so many nodes on each segment."""
    if np.any(node_count > MAX_NODES):
        raise ConvergenceError(f"the density does not converge under the mean pressure {load:.6g} p_0*", step_size)
    state = _state_of(coarse, dual, load)
    return transfer_density(surface, state, intervals_of(coarse.segments), node_count=node_count)[0]


def _correct_inequalities(surface: Surface, state: ContactState, tolerance: float) -> InitialGuess | None:
    """A guess with segments added, cut or removed where an inequality is violated; None if all hold.

    While the nodes of a segment do not resolve its density, the inequalities are not known any better. And few nodes
    could not tell a corrected set from the one before: the guess has as many as the tolerance needs.
    """
    series, unresolved = surface.series(state.dual), coefficient_tails(state.segments, state.coefficient)
    scale, inside = (state.load, 0.0) if state.dual else (abs(state.approach), MAX_TENSION)
    missing = find_missing_segments(state, series, max(_max_depth(state, tolerance), float(unresolved.max()) * scale))
    negative = find_negative_intervals(state, np.maximum(unresolved, max(tolerance, inside)))
    if missing.y.size == 0 and negative.segment.size == 0:
        return None
    left = _cut_segments(state.segments, negative)
    old_count, new = left.crest.size, (missing.crest, missing.y, missing.half_width)
    both = Intervals(*(np.concatenate(parts) for parts in zip(left, new, strict=True)))
    guess, order = transfer_density(surface, state, both, tolerance)
    for j in np.flatnonzero(order >= old_count):
        here = slice(guess.segments.first_node[j], guess.segments.first_node[j + 1])
        curvature = missing.curvature[order[j] - old_count]
        guess.phi[here] = hertz_density(state.dual, curvature, guess.segments.half_width[j], here.stop - here.start)
    return guess


def _cut_segments(old: Segments, negative: NegativeIntervals) -> Intervals:
    """What is left of each segment without its negative intervals."""
    crest, centre, half_width = [], [], []
    for j in range(old.centre.size):
        here = negative.segment == j
        for a, b in _pieces(negative.start[here], negative.end[here]):
            if b - a > MIN_PIECE:
                crest.append(old.crest[j])
                centre.append(old.centre[j] + old.half_width[j] * 0.5 * (a + b))
                half_width.append(old.half_width[j] * 0.5 * (b - a))
    return Intervals(np.array(crest, np.int64), np.array(centre), np.array(half_width))


def _pieces(start: Array, end: Array) -> list[tuple[float, float]]:
    """What negative intervals, widened unless they reach an end, leave of [-1, 1]; pieces may be empty."""
    left, pieces = -1.0, []
    for a, b in zip(start, end, strict=True):
        widening = CUT_WIDENING * (b - a) if a > -1 and b < 1 else 0.0
        pieces.append((left, a - widening))
        left = b + widening
    return [*pieces, (left, 1.0)]


def remove_or_merge(surface: Surface, state: ContactState, meeting: Flags, vanishing: Flags) -> InitialGuess:
    """A guess without the segments that vanish or, if none does, with those merged that meet the next one."""
    if np.all(vanishing) or np.all(meeting):
        raise ConvergenceError(f"all contacts or all gaps vanish under the mean pressure {state.load:.6g} p_0*")
    if np.any(vanishing):
        return keep_segments(surface, state, ~vanishing)
    old = state.segments
    leftmost = np.flatnonzero(~np.roll(meeting, 1))
    half_width = _merged_half_widths(old, meeting, leftmost, surface.heights.period)
    centre = old.centre[leftmost] + (half_width - old.half_width[leftmost])
    return transfer_density(surface, state, Intervals(old.crest[leftmost], centre, half_width))[0]


def _merged_half_widths(old: Segments, meeting: Flags, leftmost: Indices, period: float) -> Array:
    """Half-widths of segments merged with all on their right that meet, from the leftmost of each group."""
    n, distance = old.centre.size, distances_to_next(old, period)
    half_width = np.empty(leftmost.size)
    for i, j in enumerate(leftmost):
        length = 2 * old.half_width[j]
        while meeting[j % n]:
            length += distance[j % n] + 2 * old.half_width[(j + 1) % n]
            j += 1
        half_width[i] = 0.5 * length
    return half_width


def contact_residual(surface: Surface, state: ContactState) -> float:
    """Largest violation of a contact condition on the segments, as a length in g_0.

    The potentials come from closed forms at the nodes, so that neither the matrix nor the collocation points are used
    again. The gap on a contact counts as it is; a pressure in a gap counts by its displacement over the gap's width.
    """
    return float(np.max(_segment_residuals(state, surface.series(state.dual))))


@kernel
def _segment_residuals(state: ContactState, series: CosineSeries) -> Array:
    """Of each segment, in g_0: the gap on a contact; in a gap, 2 r times the pressure, and the gap at its far end.

    Every second node is enough, since the residual varies like a polynomial with a degree of the number of nodes.
    """
    segments = state.segments
    worst = np.zeros(segments.centre.size)
    for j in range(worst.size):
        r = segments.half_width[j]
        for q in range(segments.first_node[j], segments.first_node[j + 1], 2):
            y = segments.centre[j] + r * segments.node[q]
            worst[j] = max(worst[j], abs(complementary_residual(state, series, segments.crest[j], y)))
        worst[j] *= 2 * r if state.dual else 1.0
        if state.dual:
            a = state.coefficient[segments.first_node[j]]
            worst[j] = max(worst[j], abs(0.5 * np.pi * r * a))
    return worst


def _with_residual(surface: Surface, state: ContactState, tolerance: float) -> ContactState:
    """The state with its residual, if that is small and the contacts carry the load, p L = (pi/2) sum r a_0."""
    period, residual = surface.heights.period, contact_residual(surface, state)
    scale = state.load * period if state.dual else state.approach
    relative = residual / scale if scale > 0 else np.inf  # no indentation: Newton's method lost all digits on its way
    if not state.dual:
        carried = 0.5 * np.pi * (state.segments.half_width @ state.coefficient[state.segments.first_node[:-1]])
        relative = max(relative, abs(float(carried) / (state.load * period) - 1))
    if not relative <= MAX_RESIDUAL * tolerance:
        raise ConvergenceError(
            f"the contacts under the mean pressure {state.load:.6g} p_0* violate their conditions by {relative:.1e}, "
            f"more than {MAX_RESIDUAL * tolerance:.1e}; take a larger tolerance or boundary elements",
            relative,
        )
    return state._replace(residual=residual)
