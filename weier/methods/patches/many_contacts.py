"""One load on any number of contacts or gaps, without a dense matrix of all of them: in memory O(contacts).

Newton's method on the edges solves for the pressure, or for the gaps (dual), by conjugate gradients. The set of
segments is corrected in bulk where the inequalities of contact do not hold: roughly at first, as soon as most edges
have settled, then to the tolerance. The solution is checked at other nodes with a fresh operator, and on a few
segments by direct sums of closed forms that share nothing with the fast ones.
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

MIN_CONTACTS = 40  # or gaps: from here on this is faster than a dense matrix, whose unknowns are some ten for each
MAX_STEPS = 60  # 4 to 6 are usual, and 15 the most of 68 loads on up to 42 641 contacts
LEAST_TOLERANCE = 1e-12  # of the residual; rounding begins at a tenth of it
FOLLOWED_TOLERANCE = 1e-10  # of states between events, whose loads are sought to ten digits
LOOSER = 100.0  # over the tolerance: what is tried where that one fails
TARGET = 0.01  # of the tolerance: for all parts of the residual while iterating
MAX_OVER_TARGET = 10.0  # of what is left in the end: with more, where rounding is not all of it, nodes are too few
ROUGH_TARGET = 1e-3  # of the height that the load needs, before the set of contacts is right
ROUNDING = 1e-13  # of the displacement under the whole load, as a height
REDUCTION = 1e-3  # of the residual by the conjugate gradients of a step
ROUGH_TOLERANCE = 1e-6  # of the finest wave's amplitude, before the set of contacts is right
ROUGH_TENSION, MAX_TENSION = 1e-4, 1e-9  # over the pressure of a contact: before and in the end
LEAST_RATE_REDUCTION = 1e-8  # of the residual of the resistance, an energy: its error is far smaller
MAX_TAIL = 0.3  # height of the last coefficients, over the target: with more, a contact needs nodes
MAX_ROUNDING_MOVE = 1e-6  # of an edge, in half-widths: smaller moves that no longer shrink are rounding
MIN_ROUNDING_RATIO = 0.1  # of a move over the one before: free of rounding, moves shrink far more
MIN_OPENING = 100.0  # over what the forces on contacts are solved to, of a gap or a contact that is cut in
MIN_PIECE = 1e-3  # of a contact's width: shorter pieces do not survive a cut


def _stages(problem: Problem, tolerance: float, target: float, scale: float) -> tuple[Stage, Stage]:
    """A rough one, before the set of contacts is right, and a fine one."""
    rough = ROUGH_TOLERANCE * abs(float(problem.series.amplitude[-1]))
    if problem.dual:  # a wave of this pressure has the height of its pressure over the waves in lambda_0
        rough *= 2 * np.pi / float(problem.series.wavenumber[-1])
    rough, least = max(min(rough, ROUGH_TARGET * scale), target), 0.1 * target
    overlap, at_last = (ROUGH_TENSION * problem.load, MAX_TENSION * problem.load) if problem.dual else (rough, target)
    return (
        Stage(False, COARSE_TOLERANCE, Bounds(REDUCTION, target, rough), overlap, ROUGH_TENSION, 0.0),
        # With a residual above the target, what is left beside a thin gap that was just cut in looks like its end.
        Stage(
            True,
            tolerance,
            Bounds(REDUCTION, least, target),
            at_last,
            MAX_TENSION,
            MIN_OPENING * least,
        ),
    )


def solve_many_contacts(surface: Surface, guess: ContactState, tolerance: float) -> tuple[ContactState, int]:
    """The state in partial contact from a guess under its load, and the steps of Newton's method.

    tolerance : of the residual, over the height that the load needs; at least `LEAST_TOLERANCE` is taken

    ConvergenceError is raised if a contact needs more nodes than a matrix of its own should hold, if corrections do
    not end, or if the state fails a check.
    """
    problem, failure = Problem(surface.series(guess.dual), guess.load, guess.dual), ConvergenceError("")
    scale = _scale(problem)
    # Rounding may keep edges of thin gaps from settling to a target that is relative to a light load. What meets a
    # looser one is certified relative to the load all the same.
    first = max(tolerance, LEAST_TOLERANCE)
    for wanted, looser in product((first, LOOSER * first), dict.fromkeys((scale, scale**0.5, 1.0))):
        try:
            return _solve_to(problem, guess, wanted, looser)
        except ConvergenceError as error:
            failure = error
    raise failure


def _solve_to(
    problem: Problem, guess: ContactState, tolerance: float, scale: float, follows: bool = False
) -> tuple[ContactState, int]:
    """The state and the steps, with targets relative to this height, in g_0; on the same segments if it `follows`."""
    load, wanted = problem.load, tolerance * scale
    target = max(TARGET * wanted, ROUNDING * load * problem.series.period)
    allowed = max(wanted, MAX_OVER_TARGET * target)
    rough, fine = _stages(problem, tolerance, target, scale)
    stage, last_move = fine if follows else rough, np.inf
    moved = False  # whether edges have moved since the set was corrected
    now = make_guess(problem, guess.segments, stage)
    for steps in range(1, MAX_STEPS + 1):
        step = take_step(problem, now, stage)
        is_enough = step.unsettled == 0 or (moved and step.unsettled < MAX_UNSETTLED)
        if stage.fine:
            is_enough = _converged(step, target, last_move)
        last_move = float(step.moves.relative.max())
        if follows and np.any(step.vanishing | step.merging):
            break
        if not is_enough:
            moved = True
            now = next_guess(problem, step, stage, _node_counts(step, target) if stage.fine else None)
            continue
        state = contact_state(problem, step)
        if follows:
            return state, steps
        negative = find_negative_intervals(state)
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
        else:
            residual = contact_residual(state, problem.series)
            height = 2 * state.segments.half_width * residual if problem.dual else residual
            count = state.segments.node_count
            if not np.any(short := (height > allowed) & (count < MAX_NODES)):
                resistance, rate = _resistance(problem, step.punches, tolerance)
                cracks = _cracks(state, wrong[~is_open])
                state = state._replace(resistance=resistance, singular_rate=rate, cracks=cracks)
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
    """Whether the residual is small, and no edge singular or the moves so small that only rounding keeps them up."""
    move = float(step.moves.relative.max())
    is_rounding = MIN_ROUNDING_RATIO * last_move < move < MAX_ROUNDING_MOVE
    return step.forces.residual < target and (is_rounding or float(step.singular.max()) < target)


def _node_counts(step: Step, target: float) -> NDArray[np.float64]:
    """Nodes of each segment: those that it has, and more where the last coefficients have not decayed."""
    segments = step.punches.segments
    last, count = segments.first_node[1:], segments.node_count
    tail = np.maximum(np.abs(step.b[last - 1]), np.abs(step.b[last - 2]))
    height = 2 * np.pi * segments.half_width * tail / count
    short = (step.unsettled == 0) & (height > MAX_TAIL * target)
    return np.where(short, more_nodes(count), count)


def _beyond_rounding(state: ContactState, negative: Records, stage: Stage) -> Records:
    """The intervals of tension or, dual, of overlap that the nodes tell."""
    unresolved = coefficient_tails(state.segments, state.coefficient, UNRESOLVED)
    negative = negative[negative["share"] < -np.maximum(unresolved, stage.inside)[negative["segment"]]]
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
    """What is left of each contact without its intervals of tension or, dual, of each gap without its overlaps."""
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
    beside it the pressure is 2 q |x| sqrt(x^2-b^2)/b^2.
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
    """What the mean gap changes by when the load does, and no edge moves: to first order, none does.

    And the strength of the singularity of the pressure that an increment of the load adds at each edge.
    """
    none, bounds = np.zeros(punches.segments.node.size), Bounds(max(LEAST_RATE_REDUCTION, tolerance), 0.0, np.inf)
    rate = solve_forces_on_contacts(punches, none + float(problem.dual), punches.period, none, bounds)
    segments = punches.segments
    psi = end_sums(segments.first_node, expansion(punches, rate.force))
    strength = np.abs(psi) * np.sqrt(0.5 * segments.half_width)[:, None]
    if problem.dual:  # of the slope of the gap
        strength /= 2 * np.pi
    return (rate.plane if problem.dual else -rate.plane), strength
