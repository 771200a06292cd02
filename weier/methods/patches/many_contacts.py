"""One load on any number of contacts or gaps, without a dense matrix of all of them: in memory O(contacts).

The stages are those of docs/patches.md, "The stages of many contacts"; "Given edges" and "Moves of edges" derive what
one step does, and "Inequalities" how wide new segments are. `_solve_to` goes through the stages:

1. rough set: `take_step` solves on given edges, by conjugate gradients and on nodes for three digits, and
   `next_guess` moves the edges, until most of them have settled.
2. Where the inequalities do not hold, `_corrections` cuts segments and adds others, and 1 begins anew.
3. fine set: with nodes for the tolerance, the same steps go on until the residual and all singularities are below the
   target (`_converged`).
4. The inequalities are judged again, more strictly: back to 3 if they do not hold.
5. The residual is evaluated at points between the nodes (`contact_residual`). Segments on which it is too large get
   more nodes: back to 3.
6. `_resistance` solves for the tangent pressure, `_cracks` keeps the gaps that are too small for a segment of their
   own, and `certify` bounds the error.

All targets are heights, in g_0: dual, a pressure counts as the displacement that it makes over the width of its gap.
"""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Records
from weier.methods.chebyshev import gauss_rule
from weier.methods.errors import ConvergenceError
from weier.methods.patches.edge_iteration import (
    MAX_UNSETTLED,
    UNRESOLVED,
    Problem,
    Stage,
    Step,
    make_guess,
    next_guess,
    rearrange,
    take_step,
)
from weier.methods.patches.given_edges import Bounds, Punches, expansion, solve_forces_on_contacts
from weier.methods.patches.inequalities import (
    MAX_INNER,
    NEW_CONTACT_WIDTH,
    NEW_GAP_WIDTH,
    certify,
    contact_residual,
    find_missing,
    find_negative_intervals,
    gap_uncertainty,
)
from weier.methods.patches.segments import (
    COARSE_TOLERANCE,
    MAX_NODES,
    ContactState,
    apply_blocks,
    coefficient_tails,
    end_sums,
    make_blocks,
    more_nodes,
)
from weier.methods.patches.surface import Surface

# From so many contacts or gaps on this takes less time than a dense matrix, which has some ten unknowns for each.
MIN_CONTACTS = 40
MAX_STEPS = 60  # Steps of a load; 3 to 7 are usual, and 20 were the most of 213 random loads.
LEAST_TOLERANCE = 1e-12  # The least relative tolerance of the residual; rounding begins at a tenth of it.
FOLLOWED_TOLERANCE = 1e-10  # The tolerance of states between events, whose loads are sought to ten digits.
# Looser targets may cut in a gap whose edges they are too loose to find, which then vanishes again.
LARGEST_TOLERANCE = 1e-6
LOOSER = 100.0  # Where a tolerance cannot be met, one so many times larger is tried.
TARGET = 0.01  # The target of the iteration, over the tolerance: it is for each part of the residual by itself.
# What may be left in the end, over the target, where the tolerance is no more than rounding.
MAX_OVER_TARGET = 10.0
ROUGH_TARGET = 1e-3  # The largest residual of the rough set, over the height that the load needs,
ROUGH_TOLERANCE = 1e-6  # and over the amplitude of the finest wave: contacts are missed by no more.
ROUNDING = 1e-13  # Rounding of a residual, over the displacement under the whole load.
REDUCTION = 1e-3  # The conjugate gradients of a step reduce the residual by so much: edges then move by three digits.
# Tension over the largest pressure of a contact that shows that it must be cut: in the rough set and in the fine one.
ROUGH_TENSION, MAX_TENSION = 1e-4, 1e-9
# Reduction of the residual for the resistance, which is an energy: its relative error is the square of this.
LEAST_TANGENT_REDUCTION = 1e-8
MAX_TAIL = 0.3  # A segment needs more nodes where the height of its last coefficients is more than so many targets.
MAX_ROUNDING_MOVE = 1e-6  # Moves of edges below this, in half-widths, that no longer shrink are rounding.
MIN_ROUNDING_RATIO = 0.1  # They no longer shrink where one is more than this part of the one before.
# A gap or a contact is cut in only where it opens or overlaps by so many times what the forces are solved to.
MIN_OPENING = 100.0
MIN_PIECE = 1e-3  # Pieces shorter than this part of a contact's half-width do not survive a cut.


def _stages(problem: Problem, tolerance: float, target: float, scale: float) -> tuple[Stage, Stage]:
    """The rough stage, in which the set of contacts is still to be found, and the fine one.

    The rough limit is a part of the finest wave and of the scale, whichever is less. It bounds both the residual and
    the overlap that is left; in the fine stage the target does.
    """
    rough = ROUGH_TOLERANCE * abs(float(problem.series.amplitude[-1]))
    if problem.dual:  # The height of a wave of pressure is its amplitude over the number of waves in lambda_0.
        rough *= 2 * np.pi / float(problem.series.wavenumber[-1])
    rough, least = max(min(rough, ROUGH_TARGET * scale), target), 0.1 * target
    rough_outside, fine_outside = rough, target
    if problem.dual:
        rough_outside, fine_outside = ROUGH_TENSION * problem.load, MAX_TENSION * problem.load
    return (
        Stage(False, COARSE_TOLERANCE, Bounds(REDUCTION, target, rough), rough_outside, ROUGH_TENSION, 0.0),
        # The forces must be solved to less than the target: a larger residual beside a thin gap that was just cut in
        # would look like tension at its end.
        Stage(True, tolerance, Bounds(REDUCTION, least, target), fine_outside, MAX_TENSION, MIN_OPENING * least),
    )


def solve_many_contacts(surface: Surface, guess: ContactState, tolerance: float) -> tuple[ContactState, int]:
    """The state in partial contact from a guess under its load, and the steps of Newton's method.

    tolerance : of the residual, over the height that the load needs, kept between `LEAST_TOLERANCE` and
        `LARGEST_TOLERANCE`

    ConvergenceError is raised if a contact needs more than `MAX_NODES`, if corrections do not end, or if the state
    fails a check.
    """
    problem, failure = Problem(surface.series(guess.dual), guess.load, guess.dual), ConvergenceError("")
    scale = _scale(problem)
    # Rounding may keep the edges of thin gaps from settling to a target that is relative to a light load. A state
    # that meets a looser target is refused all the same if its residual is not small relative to the load.
    first = min(max(tolerance, LEAST_TOLERANCE), LARGEST_TOLERANCE)
    for wanted, looser in product((first, LOOSER * first), dict.fromkeys((scale, scale**0.5, 1.0))):
        try:
            return _solve_to(problem, guess, wanted, looser)
        except ConvergenceError as error:
            failure = error
    raise failure


def _solve_to(
    problem: Problem, guess: ContactState, tolerance: float, scale: float, follows: bool = False
) -> tuple[ContactState, int]:
    """The state and the steps, with targets relative to this height, in g_0, through the stages of the module.

    With `follows`, the segments stay those of the guess and only edges move, in the fine stage, to the residual's
    target; the inequalities are not looked at.
    """
    load, wanted = problem.load, tolerance * scale
    target = max(TARGET * wanted, ROUNDING * load * problem.series.period)
    allowed = max(wanted, MAX_OVER_TARGET * target)
    rough, fine = _stages(problem, tolerance, target, scale)
    stage, last_move = fine if follows else rough, np.inf
    moved = False  # Whether edges have moved since the set was corrected: each correction waits for that.
    now = make_guess(problem, guess.segments, stage)
    for steps in range(1, MAX_STEPS + 1):
        step = take_step(problem, now, stage)
        is_enough = step.unsettled == 0 or (moved and step.unsettled < MAX_UNSETTLED)
        if stage.fine:
            is_enough = _converged(step, target, last_move)
        last_move = float(step.moves.relative.max())
        if follows and np.any(step.vanishing | step.merging):
            break
        if not is_enough:  # stages 1 and 3
            moved = True
            now = next_guess(problem, step, stage, _node_counts(step, target) if stage.fine else None)
            continue
        state = contact_state(problem, step)
        if follows:
            return state, steps
        negative = find_negative_intervals(state)  # stages 2 and 4
        wrong = _beyond_rounding(state, negative, stage)
        is_open = wrong["height"] > stage.opening
        margin = (
            gap_uncertainty(allowed + MAX_TENSION * scale, problem.series) if stage.fine and not state.dual else 0.0
        )
        added, remaining, minima = _corrections(problem, step, state, stage, wrong[is_open], margin)
        if not np.all(remaining) or len(added) > 0:
            moved = False
            counts = state.segments.node_count.astype(float) if stage.fine else None
            now = rearrange(problem, step, state.segments, remaining, added, stage, counts)
        elif not stage.fine:
            stage = fine
            now = next_guess(problem, step, stage)
        else:  # stages 5 and 6
            residual = contact_residual(state, problem.series)
            height = 2 * state.segments.half_width * residual if problem.dual else residual
            count = state.segments.node_count
            if not np.any(short := (height > allowed) & (count < MAX_NODES)):
                resistance, strength = _resistance(problem, step.punches, tolerance)
                cracks = _cracks(state, wrong[~is_open])
                state = state._replace(resistance=resistance, tangent_strength=strength, cracks=cracks)
                return certify(state, residual, minima, negative, problem.series, tolerance, margin), steps
            counts = np.where(short, more_nodes(count), count)
            now = next_guess(problem, step, stage, counts)
    raise ConvergenceError(f"no set of contacts was found that meets all conditions under {load:.6g} p_0*")


def follow_contacts(surface: Surface, start: ContactState, load: float) -> ContactState:
    """The contacts of a state under another load, as if none were born or merged in between; without resistance.

    They are followed tightly, whatever the tolerance of the states.
    """
    problem = Problem(surface.series(start.dual), load, start.dual)
    return _solve_to(problem, start, FOLLOWED_TOLERANCE, _scale(problem), follows=True)[0]


def _scale(problem: Problem) -> float:
    """A height, in g_0, of the order of the displacement that the load needs; and no more than the first wave's."""
    return min(problem.load * problem.series.period, 1.0)


def _converged(step: Step, target: float, last_move: float) -> bool:
    """Whether the residual is below the target, and so are the singularities at all edges.

    The latter may be above it if moves are so small, and shrink so little, that rounding is what is left of them.
    """
    move = float(step.moves.relative.max())
    is_rounding = MIN_ROUNDING_RATIO * last_move < move < MAX_ROUNDING_MOVE
    return step.forces.residual < target and (is_rounding or float(step.singular.max()) < target)


def _node_counts(step: Step, target: float) -> NDArray[np.float64]:
    """Nodes of each segment: those that it has, and more where the last coefficients have not decayed.

    T_k/sqrt(1-t^2) with the coefficient b_k has the height 2 pi r b_k/k. Segments that still move wait.
    """
    segments = step.punches.segments
    last, count = segments.first_node[1:], segments.node_count
    tail = np.maximum(np.abs(step.b[last - 1]), np.abs(step.b[last - 2]))
    height = 2 * np.pi * segments.half_width * tail / count
    short = (step.unsettled == 0) & (height > MAX_TAIL * target)
    return np.where(short, more_nodes(count), count)


def _beyond_rounding(state: ContactState, negative: Records, stage: Stage) -> Records:
    """The intervals of tension or, dual, of overlap that exceed what the nodes resolve and what the stage allows.

    In the rough set, those that end at an edge are left out: the edge has not settled yet, and its move may end them.
    """
    unresolved = coefficient_tails(state.segments, state.coefficient, UNRESOLVED)
    negative = negative[negative["relative"] < -np.maximum(unresolved, stage.inside)[negative["segment"]]]
    return negative if stage.fine else negative[np.maximum(-negative["start"], negative["end"]) < MAX_INNER]


def _corrections(
    problem: Problem, step: Step, state: ContactState, stage: Stage, negative: Records, margin: float
) -> tuple[NDArray[np.float64], NDArray[np.bool_], Records]:
    """Segments to add, shape (added, 2), which of those there remain, and minima off them that are below a margin."""
    remaining = np.ones(state.segments.centre.size, bool)
    remaining[negative["segment"]] = False
    missing, minima = find_missing(problem, step, stage.outside, margin)
    return np.concatenate([_cut_segments(state, negative), missing]), remaining, minima


def _cut_segments(state: ContactState, negative: Records) -> NDArray[np.float64]:
    """The pieces of each contact between its intervals of tension or, dual, of each gap between its overlaps.

    Each interval is widened to the width of the new gap or contact, except at the ends of the segment.
    """
    width = NEW_CONTACT_WIDTH if state.dual else NEW_GAP_WIDTH
    pieces, middle = [], state.segments.middle
    for j in np.unique(negative["segment"]):
        centre, r, here = middle[j], state.segments.half_width[j], negative["segment"] == j
        left = -1.0
        for a, b in [*zip(negative["start"][here], negative["end"][here], strict=True), (1.0, 1.0)]:
            widening = 0.5 * (width - 1) * (b - a) if a > -1 and b < 1 else 0.0
            if a - widening - left > MIN_PIECE:
                pieces.append((centre + r * left, centre + r * (a - widening)))
            left = max(left, b + widening)
    return np.array(pieces).reshape(-1, 2)


def _cracks(state: ContactState, negative: Records) -> NDArray[np.float64]:
    """The gaps in place of intervals of tension, as `ContactState.cracks`; none within gaps (dual).

    Where a parabola of pressure falls to -q, the crack has the half-width b = sqrt(2) times that of the interval, and
    beside it the pressure is 2 q |x| sqrt(x^2-b^2)/b^2, whose strength at the edge is q (8/b)^(1/2).
    """
    t, b = 0.5 * (negative["start"] + negative["end"]), 0.5 * NEW_GAP_WIDTH * (negative["end"] - negative["start"])
    inner = (np.abs(t) + b < MAX_INNER) & (not state.dual)
    at, t, b, lowest = negative["segment"][inner], t[inner], b[inner], negative["lowest"][inner]
    return np.stack([at, t, b, -lowest * np.sqrt(8 / (b * state.segments.half_width[at]))], axis=1)


def contact_state(problem: Problem, step: Step) -> ContactState:
    """A step as a state of contact, whose pressure vanishes at all edges; without resistance and residual."""
    segments = step.punches.segments
    values = make_blocks(gauss_rule(count, True).polynomial.T for count in segments.node_count.tolist())
    phi = apply_blocks(values, step.a)
    return ContactState(problem.dual, problem.load, -step.forces.plane, segments, phi, step.a)


def _resistance(problem: Problem, punches: Punches, tolerance: float) -> tuple[float, NDArray[np.float64]]:
    """The resistance, and the strength B of the tangent pressure B/s^(1/2) at the edges of each segment.

    The tangent pressure has the mean 1 and makes a flat surface sink by R everywhere on the contacts: to first order
    no edge moves. On gaps, a pressure of full contact that rises by 1 closes the mean gap by R.
    """
    none, bounds = np.zeros(punches.segments.node.size), Bounds(max(LEAST_TANGENT_REDUCTION, tolerance), 0.0, np.inf)
    tangent = solve_forces_on_contacts(punches, none + float(problem.dual), punches.period, none, bounds)
    segments = punches.segments
    psi = end_sums(segments.first_node, expansion(punches, tangent.force))
    strength = np.abs(psi) * np.sqrt(0.5 * segments.half_width)[:, None]
    if problem.dual:  # The slope of a gap is 2 pi times as strong at an edge as the pressure on its other side.
        strength /= 2 * np.pi
    return (tangent.plane if problem.dual else -tangent.plane), strength
