"""The stages of one load on any number of contacts or gaps, in memory O(contacts).

docs/patches.md, "The stages of a load", has the four stages and their limits; "Given edges", "Moves of edges" and
"Inequalities" derive their parts. `converge` is stage 1, `segment_corrections` stage 2, `contact_residual` stage 3
and `certify` stage 4. Limits are heights, in g_0; a pressure in a gap is multiplied by its width.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Flags, Indices, Records
from weier.kernels.jit import kernel
from weier.methods.error_model import COMPLIANCE_ROUNDING
from weier.methods.errors import ConvergenceError
from weier.methods.patches.certificate import certify, contact_residual, gap_uncertainty
from weier.methods.patches.edge_iteration import (
    MAX_STEPS,
    SETTLED_MOVE,
    ContactProblem,
    NewtonStep,
    carried_along,
    make_guess,
    merged_intervals,
    next_guess,
    rearrange,
    start_from,
    take_step,
)
from weier.methods.patches.given_edges import (
    Forces,
    Punches,
    solve_tangent,
    vanishing_at_edges,
)
from weier.methods.patches.inequalities import (
    find_missing,
    find_negative_intervals,
)
from weier.methods.patches.kind import EPS, FIELD_ROUNDING, MAX_TENSION, MAX_TOLERANCE, KindNumbers, numbers_of
from weier.methods.patches.pair_sums import MAX_DIRECT
from weier.methods.patches.rule import Table, expand_forces
from weier.methods.patches.segments import (
    ContactState,
    coefficient_tails,
    edge_strengths,
    estimate_node_count,
    more_nodes,
)
from weier.methods.patches.start import with_fewer_nodes
from weier.methods.patches.surface import Sides, Surface
from weier.methods.patches.thin_gaps import are_thin, with_cracks

# Largest allowed ratio of the stage-3 residual to the target of the iteration. It is also the ratio of the target to
# the residual of the equations, and a second attempt (`solve_state`) divides its tolerance by it.
MAX_OVER_TARGET = 10.0
MIN_TOLERANCE = MAX_OVER_TARGET * FIELD_ROUNDING  # smallest relative tolerance of the residual
TARGET = MAX_OVER_TARGET**-2  # ratio of the iteration's target to the tolerance, which limits the sum of all parts


class Limits(NamedTuple):
    """Accuracy of a load; heights, in g_0.

    tolerance : relative tolerance, which sets the number of nodes
    target : target of residual, singularities and overlap
    residual : largest residual of the equations on given edges: next to a new thin gap, a larger one would look like
        tension at its end
    opening : least height of a new gap or contact; the residual would hide the singularities that determine its edges
    allowed : largest residual between the nodes
    rounding : rounding of a residual
    margin : error of the gap after certification (docs/patches.md, "The bound on the compliance"); minima below it
        may be births
    """

    tolerance: float
    target: float
    residual: float
    opening: float
    allowed: float
    rounding: float
    margin: float


def solve_in_stages(
    surface: Surface, guess: ContactState, tolerance: float, accepted: float | None = None
) -> tuple[ContactState, int]:
    """Return the state in partial contact from a guess under its load, and the steps of Newton's method.

    tolerance : tolerance of the residual, relative to the scale of the load
    accepted : the tolerance by which the state is judged, if larger

    ConvergenceError is raised if steps or corrections do not end, or if the state fails a check. Segments have at
    most `MAX_NODES` nodes.
    """
    problem = ContactProblem(guess.kind.series(surface), guess.load, guess.kind)
    kind, series, steps, corrections = problem.kind, problem.series, guess.steps, guess.corrections
    # The set of many segments is found at the loosest tolerance, which costs fewer steps of conjugate gradients. A
    # second attempt takes no part of the route of the first.
    is_large = guess.segments.half_width.size > MAX_DIRECT and guess.attempts == 1
    first = max(tolerance, MAX_TOLERANCE) if is_large else tolerance
    limits = load_limits(problem, guess.segments.half_width, first)
    step = take_step(problem, make_guess(problem, guess.segments, MAX_TOLERANCE), limits.residual)
    steps, enough = steps + 1, estimate_node_count(guess.segments.extent, series, first)
    now = next_guess(problem, step, first, np.maximum(step.punches.segments.node_count, enough))
    coarser = np.inf  # height of the residual before nodes were added
    while True:
        solved, step, more = converge(problem, now, limits, MAX_STEPS - steps)  # stage 1
        steps, state = steps + more, contact_state(problem, step)
        # Stage 2: a segment is cut where it violates its own inequality, and one is added where the other is violated
        # between segments.
        negative = find_negative_intervals(state)
        wrong = to_be_cut(state, negative, limits.opening)
        added, remaining, minima = segment_corrections(problem, step, state, limits, wrong)
        count = state.segments.node_count
        if len(added) > 0 or not remaining.all():
            corrections, coarser = corrections + 1, np.inf
            now = rearrange(problem, step, state.segments, remaining, added, limits.tolerance, count)
            other = with_fewer_nodes(surface, state._replace(segments=now.segments))
            if other.kind is not state.kind:
                other = other._replace(steps=steps, corrections=corrections, attempts=guess.attempts)
                return solve_in_stages(surface, other, tolerance, accepted)
            continue
        if limits.tolerance > tolerance:
            limits = load_limits(problem, state.segments.half_width, tolerance)
            enough = estimate_node_count(state.segments.extent, series, tolerance)
            now = next_guess(problem, step, tolerance, np.maximum(count, enough))
            continue
        residual, width, roughness = contact_residual(state, series)  # stage 3
        height = kind.as_height(residual, state.segments.half_width)
        more_of_each, is_short = more_nodes(count, height, limits.allowed)
        # More nodes do not reduce rounding, and in gaps they increase it.
        if is_short and height.max() < coarser:
            coarser, now = float(height.max()), next_guess(problem, step, tolerance, more_of_each)
            continue
        # Stage 4. The resistance is an energy, with the square of the reduction as relative error.
        tangent = solve_tangent(solved.punches, solved.forces, max(np.sqrt(EPS), tolerance))
        overlaps, tensions = kind.overlaps_and_tensions(minima, negative)
        resistance, strength = _resistance(solved, step, tangent)
        state = state._replace(steps=steps, corrections=corrections, attempts=guess.attempts)
        state = state._replace(resistance=resistance, tangent_strength=strength, edge_move=step.moves[:2].T)
        state, tensions = with_cracks(state, series, step.punches, tangent, tensions, residual)
        violations = residual, width, roughness, overlaps, tensions
        checks = surface.total_amplitude, accepted or tolerance, limits.margin
        return certify(state, *violations, series, *checks), steps


def converge(
    problem: ContactProblem, now: Punches, limits: Limits, most: int, is_fixed: bool = False
) -> tuple[NewtonStep, NewtonStep, int]:
    """Move the edges until they have converged; return the last solution, the step after it, and the steps.

    The edges move at least once: the edge errors of a guess with small contacts or gaps may be below the target in h,
    but not in R. ConvergenceError is raised after `most` steps, or if segments vanish or merge though their set
    `is_fixed`.
    """
    last_move = settled_move = np.inf
    for steps in range(1, most + 1):
        step = take_step(problem, now, limits.residual)
        if is_fixed and step.changed:
            break
        # Moves that have settled and no longer fall are rounding, which the stated errors contain.
        is_rounding = step.settled and settled_move <= step.move and step.forces.residual < limits.target
        if is_rounding or _converged(step, limits, last_move):
            return step, step, steps
        # Segments that have not settled keep their nodes.
        segments, enough = step.punches.segments, limits.target if step.settled else np.inf
        counts, is_short = node_counts(segments.first_node, segments.half_width, step.b, enough)
        if _ends(step, limits, last_move) and not is_short:
            return step, carried_along(step, limits.rounding), steps
        last_move, settled_move = step.move, np.inf if is_short or step.changed else step.move
        now = next_guess(problem, step, limits.tolerance, counts)
    load = f"{problem.load:.6g} p_0*"
    raise ConvergenceError(f"no set of contacts was found that meets all conditions under {load}")


def follow_contacts(surface: Surface, start: ContactState, load: float) -> ContactState:
    """Follow the contacts of a state to another load, without births and mergers, at the smallest tolerance."""
    old, problem = start.segments, ContactProblem(start.kind.series(surface), load, start.kind)
    limits = load_limits(problem, old.half_width, MIN_TOLERANCE)
    # No stage 3 adds nodes, so that they are enough for the target of a tolerance of rounding: the least pressure of
    # merged contacts needs more than the compliance. With 1e-10, loads of events of traces were up to 1e-7 off.
    guess = make_guess(problem, old, TARGET * EPS)
    # psi = (1-t^2) phi from phi, whose last two coefficients are 0
    b = 0.5 * (start.coefficient - np.append([0.0, 0.0], start.coefficient[:-2]))
    guess = start_from(old, b, np.arange(old.centre.size), guess)
    _, step, _ = converge(problem, guess, limits, MAX_STEPS, is_fixed=True)
    return contact_state(problem, step)


def load_limits(problem: ContactProblem, half_width: Array, tolerance: float) -> Limits:
    """Return the limits of a load for a relative tolerance of its residual."""
    scale = min(problem.load * problem.series.period, 1.0)  # A line load displaces by p L times a logarithm.
    wanted = tolerance * scale * problem.kind.share(half_width.size)
    displacement = problem.load * problem.kind.rounded_width(problem.series.period, half_width)
    rounding = max(COMPLIANCE_ROUNDING * displacement, FIELD_ROUNDING * min(displacement, 1.0))
    target = max(TARGET * wanted, rounding)
    most = MAX_OVER_TARGET * target
    allowed = max(wanted, most)
    uncertainty = gap_uncertainty(allowed + MAX_TENSION * scale, problem.series.total_amplitude)
    margin = problem.kind.uniform(uncertainty)
    return Limits(tolerance, target, target / MAX_OVER_TARGET, most, allowed, rounding, margin)


def _converged(step: NewtonStep, limits: Limits, last_move: float) -> bool:
    """Return whether the residual is below the target, and the edges have moved and are converged.

    Two of three conditions are enough: the singularities at all edges are below the target, the moves no longer
    decrease, or they are small. A contact whose force is below the target may take a large part of a load increment,
    and singularities may be rounding.
    """
    if last_move == np.inf or step.forces.residual >= limits.target:
        return False
    is_settled = step.move > SETTLED_MOVE * last_move  # each error is the square of the previous one
    return sum((step.largest < limits.target, is_settled, _is_small(step, limits))) > 1


def _is_small(step: NewtonStep, limits: Limits) -> bool:
    """Return whether the moves of the next step, the squares of these, are below the target."""
    return step.move**2 < TARGET * limits.tolerance


def _ends(step: NewtonStep, limits: Limits, last_move: float) -> bool:
    """Return whether the next step would change the solution by less than the target."""
    move = step.move
    if not (step.settled and _is_small(step, limits) and move < SETTLED_MOVE * last_move):
        return False
    return max(step.forces.residual, step.largest * move) < limits.target


@kernel
def node_counts(first_node: Indices, half_width: Array, b: Array, target: float) -> tuple[Indices, bool]:
    """Return the nodes of each segment, more where the last coefficients exceed the target, and whether any do.

    T_k/sqrt(1-t^2) with the coefficient b_k has the height 2 pi r b_k/k; the gap of such a slope is smaller.
    The last two coefficients are used, since one of them vanishes for an even or odd density.
    """
    count, height = np.empty(half_width.size, np.int64), np.empty(half_width.size)
    for j in range(half_width.size):
        last = first_node[j + 1]
        count[j] = last - first_node[j]
        tail = max(abs(b[last - 1]), abs(b[last - 2]))
        height[j] = 2 * np.pi * half_width[j] * tail / count[j]
    return more_nodes(count, height, target)


def to_be_cut(state: ContactState, negative: Records, opening: float) -> Records:
    """Return the intervals of tension, or of overlap in gaps, that the nodes resolve and that are not thin gaps.

    opening : least height of a new gap or contact, in g_0
    """
    if negative.size == 0:
        return negative
    unresolved = coefficient_tails(state.segments, state.coefficient)
    least, thinness = state.kind.limits_within
    wrong = negative[negative["relative"] < -np.maximum(unresolved, least)[negative["segment"]]]
    return wrong[(wrong["height"] > opening) & ~are_thin(wrong, thinness)]


def segment_corrections(
    problem: ContactProblem,
    step: NewtonStep,
    state: ContactState,
    limits: Limits,
    negative: Records,
) -> tuple[NDArray[np.float64], NDArray[np.bool_], Records]:
    """Return segments to add, shape (added, 2), the ones that remain, and minima outside below a margin.

    Segments are missing where the overlap, in g_0, exceeds the target. A segment with a negative interval is replaced
    by its remaining pieces. Contacts on both sides of a thin gap are merged.
    """
    outside = problem.kind.limit_outside(problem.load, limits.target, MAX_TENSION)
    missing, minima = find_missing(problem, step, state, outside, limits.margin, limits.opening)
    remaining = np.ones(state.segments.centre.size, bool)
    remaining[negative["segment"]] = False
    _, thinness = state.kind.limits_within
    merging, any_merge = _thin_gaps(step.punches.gap, state.segments.half_width, thinness)
    if not any_merge and negative.size == 0:
        return missing, remaining, minima
    merged = np.empty((0, 2))
    merging &= remaining & np.roll(remaining, -1)
    if not merging.all():
        merged = np.array(merged_intervals(problem, state.segments, merging)).reshape(-1, 2)
        remaining &= ~(merging | np.roll(merging, 1))
    return np.concatenate([_cut_segments(state, negative), missing, merged]), remaining, minima


@kernel
def _thin_gaps(gap: Array, r: Array, thinness: float) -> tuple[Flags, bool]:
    """Return whether the gap on the right of each contact is less than half as wide as the narrowest to be added."""
    is_thin, any_is = np.empty(r.size, np.bool_), False
    for j in range(r.size):
        is_thin[j] = gap[j] < 2 * thinness * min(r[j], r[(j + 1) % r.size])
        any_is = any_is or is_thin[j]
    return is_thin, any_is


def _cut_segments(state: ContactState, negative: Records) -> NDArray[np.float64]:
    """Return the pieces of each contact between its intervals of tension, or of each gap between its overlaps.

    Each interval is widened to the width of the new gap or contact, except at the ends of the segment.
    """
    pieces, middle = [], state.segments.middle
    for j in np.unique(negative["segment"]):
        centre, r, here = middle[j], state.segments.half_width[j], negative["segment"] == j
        left = -1.0
        for a, b in [*zip(negative["start"][here], negative["end"][here], strict=True), (1.0, 1.0)]:
            widening = 0.5 * (state.kind.new_within - 1) * (b - a) if a > -1 and b < 1 else 0.0
            if a - widening > left:
                pieces.append((centre + r * left, centre + r * (a - widening)))
            left = max(left, b + widening)
    return np.array(pieces).reshape(-1, 2)


def contact_state(problem: ContactProblem, step: NewtonStep) -> ContactState:
    """Return a step as a state of contact, whose pressure vanishes at all edges; without resistance and residual.

    Singular parts at edges are distributed over the coefficients as rounding.
    """
    segments = step.punches.segments
    _, a = vanishing_at_edges(segments.first_node, step.b, problem.kind.rounding_power)
    return ContactState(problem.kind, problem.load, -step.forces.plane, segments, a)


def _resistance(solved: NewtonStep, step: NewtonStep, tangent: Forces) -> tuple[float, Sides]:
    """Return the resistance, and the strengths B of the tangent pressure at the edges of the segments.

    Edges that have moved since the last solution have released energy, which is included.
    """
    punches, kind, period = solved.punches, solved.punches.kind, solved.punches.period
    moves = solved.moves if step is not solved else np.zeros_like(step.moves)
    segments = punches.segments.first_node, punches.segments.half_width, moves
    numbers = numbers_of(kind, period)
    strength, released = _strengths(*segments, punches.left, tangent.force, period, kind.strength_factor, numbers)
    # The increment of gaps is the increment of the tension, which opens them.
    return -kind.right_sign * (tangent.plane + released), strength


@kernel
def _strengths(
    first_node: Indices,
    r: Array,
    moves: Table,
    left: Array,
    force: Array,
    period: float,
    factor: float,
    numbers: KindNumbers,
) -> tuple[Sides, float]:
    """Return the strengths B by forces, and the increase of the resistance when edges move outward."""
    _, shift, derivative, _, _, _, _, _ = numbers
    strength = edge_strengths(
        first_node, r, expand_forces(first_node, r, left, force, period, shift, derivative), 0.0
    )
    released = 0.0
    for j in range(r.size):
        for side in range(2):
            strength[j, side] = factor * abs(strength[j, side])
            released += strength[j, side] ** 2 * moves[side, j]
    return strength, 2 * np.pi**2 / period * released
