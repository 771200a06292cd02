"""One load on any number of contacts or gaps, without a dense matrix of all of them: in memory O(contacts).

Newton's method on the edges solves for the pressure, or for the gaps (dual), by conjugate gradients. The set of
segments is corrected in bulk where the inequalities of contact do not hold: roughly at first, as soon as most edges
have settled, then to the tolerance. The solution is checked at other nodes with a fresh operator, and on a few
segments by direct sums of closed forms that share nothing with the fast ones.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Indices
from weier.kernels.jit import kernel
from weier.methods.errors import ConvergenceError
from weier.methods.patches.edge_iteration import (
    MAX_UNSETTLED,
    Guess,
    Problem,
    Stage,
    Step,
    make_guess,
    next_guess,
    rearrange,
    take_step,
)
from weier.methods.patches.fields import ContactState, complementary_residual
from weier.methods.patches.inequalities import (
    NEW_CONTACT_WIDTH,
    NEW_GAP_WIDTH,
    NegativeIntervals,
    Violations,
    certify,
    error_bound,
    find_missing,
    find_negative_intervals,
    lowest_inside,
    negative_heights,
)
from weier.methods.patches.initial_guess import InitialGuess
from weier.methods.patches.punches import (
    MAX_NODES,
    Bounds,
    chebyshev_rule,
    displacement,
    expansion_of_regular_part,
    make_punches,
    solve_forces_on_contacts,
    transfer_forces,
)
from weier.methods.patches.segments import make_segments
from weier.methods.patches.surface import CosineSeries, Surface, nearest_crests

MIN_CONTACTS = 40  # or gaps: from here on this is faster than a dense matrix, whose unknowns are some ten for each
MAX_STEPS = 60  # 4 to 6 are usual, and 15 the most of 68 loads on up to 42 641 contacts
MIN_TOLERANCE = 1e-10  # of the residual: what comes out is mostly a hundredth, where rounding begins
TARGET = 0.01  # of the tolerance: for all parts of the residual while iterating
ROUGH_TARGET = 1e-3  # of the height that the load needs, before the set of contacts is right
ROUNDING = 1e-13  # of the displacement under the whole load, as a height
REDUCTION = 1e-3  # of the residual by the conjugate gradients of a step
ROUGH_TOLERANCE = 1e-6  # of the finest wave's amplitude, before the set of contacts is right
ROUGH_TENSION, MAX_TENSION = 1e-4, 1e-9  # over the pressure of a contact: before and in the end
RATE_REDUCTION = 1e-8  # of the residual of the resistance, an energy: its error is far smaller
MAX_TAIL = 0.3  # height of the last coefficients, over the target: with more, a contact needs nodes
MORE_NODES, AT_LEAST_MORE = 1.3, 2
OTHER_NODES = 7  # that a contact has more when the solution is checked
MAX_ROUNDING_MOVE = 1e-6  # of an edge, in half-widths: smaller moves that no longer shrink are rounding
MIN_ROUNDING_RATIO = 0.1  # of a move over the one before: free of rounding, moves shrink far more
DIRECT_SUMS = 40  # points at which the solution is checked without fast sums
UNRESOLVED = (3, 4)  # places from the end of the coefficients: the last two are 0
MIN_OPENING = 100.0  # over what the forces on contacts are solved to, of a gap or a contact that is cut in
MAX_INNER = 0.99  # of a segment's half-width: intervals of tension that end beyond reach as far as its edge
MIN_PIECE = 1e-3  # of a contact's width: shorter pieces do not survive a cut

Edges = tuple[Array, Array]  # left and right ones, each of shape (contacts,)


class _Limits(NamedTuple):
    """A gap below -outside, in g_0, is a violation, and a pressure below -inside times the largest of its contact.

    Or (dual) a pressure below -outside, in p_0*, and a gap below -inside times the largest of its interval.

    opening : height, in g_0, of gaps or, dual, contacts too small to be cut in, since no edges are found for them
    at_edges : whether the latter counts as far as an edge, too; an edge that has not settled yet takes care of it
    """

    outside: float
    inside: float
    opening: float
    at_edges: bool


def _stages(problem: Problem, target: float, scale: float) -> tuple[Stage, Stage]:
    """A rough one, before the set of contacts is right, and a fine one."""
    rough = ROUGH_TOLERANCE * abs(float(problem.series.amplitude[-1]))
    if problem.dual:  # a wave of this pressure has the height of its pressure over the waves in lambda_0
        rough *= 2 * np.pi / float(problem.series.wavenumber[-1])
    rough = max(min(rough, ROUGH_TARGET * scale), target)
    return (
        Stage(8.0, 5.0, Bounds(REDUCTION, target, rough)),
        Stage(12.0, 9.0, Bounds(REDUCTION, 0.1 * target, rough)),
    )


def _limits(problem: Problem, stage: Stage, fine: bool) -> _Limits:
    tension = MAX_TENSION if fine else ROUGH_TENSION
    least = stage.bounds.least if fine else 0.0
    if problem.dual:
        return _Limits(tension * problem.load, tension, MIN_OPENING * least, fine)
    return _Limits(least * 10 if fine else stage.bounds.most, tension, MIN_OPENING * least, fine)


def solve_many_contacts(
    surface: Surface, guess: InitialGuess, load: float, tolerance: float
) -> tuple[ContactState, int]:
    """The state under one load, in partial contact, from a guess, and the steps of Newton's method.

    ConvergenceError is raised if a contact needs more nodes than a matrix of its own should hold, if corrections do
    not end, or if the state fails a check.
    """
    problem = Problem(surface.series(guess.dual), load, guess.dual)
    try:
        return _solve_to(problem, guess, tolerance, _scale(problem))
    except ConvergenceError:
        # Rounding may keep edges of thin gaps from settling to a target that is relative to a light load. What meets
        # the absolute one is certified relative to the load all the same.
        return _solve_to(problem, guess, tolerance, 1.0)


def _solve_to(problem: Problem, guess: InitialGuess, tolerance: float, scale: float) -> tuple[ContactState, int]:
    """The state and the steps, with targets relative to this height, in g_0."""
    load = problem.load
    target, allowed = _target(problem, tolerance, scale), max(tolerance, MIN_TOLERANCE) * scale
    rough, fine = _stages(problem, target, scale)
    stage, last_move, moved = rough, np.inf, False  # whether edges have moved since the set was corrected
    now = _guess_from(problem, guess, stage)
    for steps in range(1, MAX_STEPS + 1):
        step = take_step(problem, now, stage)
        if stage is fine:
            is_enough = _converged(step, target, last_move)
        else:
            is_enough = step.settled or (moved and step.unsettled < MAX_UNSETTLED)
        last_move = step.moves.largest
        if not is_enough:
            moved = True
            now = next_guess(problem, step, stage, _node_counts(step, target) if stage is fine else None)
            continue
        state = contact_state(problem, step)
        added, keep, outside = _corrections(problem, step, state, _limits(problem, stage, stage is fine))
        if not np.all(keep) or len(added) > 0:
            moved = False
            counts = step.punches.node_count.astype(float) if stage is fine else None
            now = rearrange(problem, step, step.b, _edges(step), keep, added, stage, counts)
        elif stage is rough:
            stage = fine if step.settled else rough
            now = next_guess(problem, step, stage)
        else:
            residual = _residuals_at_other_nodes(problem, step)
            height = residual * _height_of_residual(step)
            if not np.any(short := (height > allowed) & (step.punches.node_count < MAX_NODES)):
                return _checked_state(problem, step, state, residual, outside, tolerance), steps
            counts = np.where(short, _increase(step.punches.node_count), step.punches.node_count)
            now = next_guess(problem, step, stage, counts)
    raise ConvergenceError(f"no set of contacts was found that meets all conditions under {load:.6g} p_0*")


def follow_contacts(surface: Surface, start: ContactState, load: float, tolerance: float) -> ContactState:
    """The contacts of a state under another load, as if none were born or merged in between; without resistance."""
    problem = Problem(surface.series(start.dual), load, start.dual)
    target, last_move = _target(problem, tolerance, _scale(problem)), np.inf
    _, stage = _stages(problem, target, _scale(problem))
    now = _guess_from(problem, start, stage)
    for _ in range(MAX_STEPS):
        step = take_step(problem, now, stage)
        if np.any(step.vanishing | step.merging):
            break
        if _converged(step, target, last_move):
            return contact_state(problem, step)
        last_move = step.moves.largest
        now = next_guess(problem, step, stage, _node_counts(step, target))
    raise ConvergenceError(f"the contacts under {start.load:.6g} p_0* cannot be followed to {load:.6g} p_0*")


def _scale(problem: Problem) -> float:
    """A height, in g_0, of the order of the displacement that the load needs; and no more than the first wave's."""
    return min(problem.load * problem.series.period, 1.0)


def _target(problem: Problem, tolerance: float, scale: float) -> float:
    return max(TARGET * max(tolerance, MIN_TOLERANCE) * scale, ROUNDING * problem.load * problem.series.period)


def _guess_from(problem: Problem, start: InitialGuess | ContactState, stage: Stage) -> Guess:
    """The edges of a guess or a state and, of contacts, the forces on them."""
    segments, r = start.segments, start.segments.half_width
    centre = segments.origin + segments.centre
    carried = np.add.reduceat(segments.weight * start.phi, segments.first_node[:-1]) * r
    return make_guess(problem, centre - r, centre + r, None if start.dual else carried, stage)


def _edges(step: Step) -> Edges:
    return step.punches.centre - step.punches.half_width, step.punches.centre + step.punches.half_width


def _converged(step: Step, target: float, last_move: float) -> bool:
    """Whether the residual is small, and no edge singular or the moves so small that only rounding keeps them up."""
    move = step.moves.largest
    is_rounding = MIN_ROUNDING_RATIO * last_move < move < MAX_ROUNDING_MOVE
    return step.forces.residual < target and (is_rounding or float(step.singular.max()) < target)


def _increase(count: Indices) -> NDArray[np.float64]:
    return np.asarray(MORE_NODES * count + AT_LEAST_MORE)


def _node_counts(step: Step, target: float) -> NDArray[np.float64]:
    """As many nodes as before, and more where the last coefficients have not decayed."""
    last, count = step.punches.first_node[1:], step.punches.node_count
    tail = np.maximum(np.abs(step.b[last - 1]), np.abs(step.b[last - 2]))
    height = 2 * np.pi * step.punches.half_width * tail / count
    short = step.settled & (height > MAX_TAIL * target)
    return np.where(short, _increase(count), count)


def _corrections(
    problem: Problem, step: Step, state: ContactState, limits: _Limits
) -> tuple[NDArray[np.float64], NDArray[np.bool_], float]:
    """Segments to add, shape (added, 2), which of those there stay, and the lowest that `find_missing` saw."""
    negative = find_negative_intervals(state, np.maximum(_tails(step), limits.inside))
    if not limits.at_edges:
        within = np.maximum(np.abs(negative.start), np.abs(negative.end)) < MAX_INNER
        negative = negative.select(within)
    negative = negative.select(negative_heights(state, negative) > limits.opening)
    keep = np.ones(step.punches.centre.size, bool)
    keep[negative.segment] = False
    missing, lowest = find_missing(problem, step, limits.outside)
    return np.concatenate([_cut_segments(step, negative), missing]), keep, lowest


def _tails(step: Step) -> Array:
    """Size of the last coefficients of each regular part over its largest: no density is known any better."""
    size, end = np.abs(step.a), step.punches.first_node[1:]
    last = np.max([size[end - k] for k in UNRESOLVED], axis=0)
    largest = np.maximum.reduceat(size, step.punches.first_node[:-1])
    return np.asarray(last / np.where(largest > 0, largest, 1.0))


def _cut_segments(step: Step, negative: NegativeIntervals) -> NDArray[np.float64]:
    """What is left of each contact without its intervals of tension or, dual, of each gap without its overlaps."""
    width = NEW_CONTACT_WIDTH if step.punches.dual else NEW_GAP_WIDTH
    pieces = []
    for j in np.unique(negative.segment):
        centre, r, here = step.punches.centre[j], step.punches.half_width[j], negative.segment == j
        left = -1.0
        for a, b in [*zip(negative.start[here], negative.end[here], strict=True), (1.0, 1.0)]:
            widening = 0.5 * (width - 1) * (b - a) if a > -1 and b < 1 else 0.0
            if a - widening - left > MIN_PIECE:
                pieces.append((centre + r * left, centre + r * (a - widening)))
            left = max(left, b + widening)
    return np.array(pieces).reshape(-1, 2)


def contact_state(problem: Problem, step: Step) -> ContactState:
    """A step as a state of contact, whose pressure vanishes at all edges; without resistance and residual."""
    punches, series = step.punches, problem.series
    crest, y = nearest_crests(series, punches.centre)
    segments = make_segments(crest, punches.centre - y, y, punches.half_width, punches.node_count, series.period)
    phi = np.empty(step.a.size)
    for rule, _, node in punches.groups:
        phi[node] = step.a[node] @ chebyshev_rule(rule.node.size, True).polynomial[:, ::-1]  # which ascend
    approach = (0.0 if problem.dual else series.maximum) - step.forces.plane
    return ContactState(problem.dual, problem.load, approach, segments, phi, step.a, np.zeros(1), np.nan, np.nan)


def _height_of_residual(step: Step) -> Array:
    """Of a residual of 1 on each segment: of a pressure in a gap (dual) its displacement over the width."""
    r = step.punches.half_width
    return 2 * r if step.punches.dual else np.ones(r.size)


def _residuals_at_other_nodes(problem: Problem, step: Step) -> Array:
    """The largest gap on each contact, without sign, in g_0, or pressure in each gap (dual), at other nodes."""
    punches, r = step.punches, step.punches.half_width
    count, everyone = punches.node_count + OTHER_NODES, np.arange(punches.centre.size)
    other = make_punches(punches.centre, r, count, punches.period, problem.dual)
    b = expansion_of_regular_part(punches, step.a)
    force = transfer_forces(punches, b, everyone, r, count)
    tree = other.matrix.tree
    off = displacement(other, force) - problem.forcing(tree.origin, tree.offset)
    off += 0.0 if problem.dual else step.forces.plane
    return np.asarray(np.maximum.reduceat(np.abs(off), other.first_node[:-1]))


def _largest_over_sampled(node_count: Indices, dual: bool) -> Array:
    """What the largest residual anywhere on each segment may be, over that at the other nodes.

    For contacts by Ehlich and Zeller, as where there are few. The zeros of U_m leave the ends of a gap out, where the
    residual times sin(theta) is 0: what bounds that bounds the residual after Schur, times its degree and 1.
    """
    degree, count = node_count + 2.0, node_count + OTHER_NODES
    if dual:
        return np.asarray((degree + 1) / np.cos(0.5 * np.pi * (degree + 1) / (count + 1)))
    return np.asarray(1 / np.cos(0.5 * np.pi * degree / count))


def _checked_state(
    problem: Problem, step: Step, state: ContactState, residual: Array, outside: float, tolerance: float
) -> ContactState:
    """The state with resistance, residual and error; ConvergenceError if it fails a check."""
    punches, period, dual = step.punches, step.punches.period, problem.dual
    height, sample = _height_of_residual(step), _sample_of(state)
    direct = np.abs(_residuals_by_direct_sums(state, problem.series, sample))
    largest = residual * _largest_over_sampled(punches.node_count, dual)
    worst = max(float(largest.max()), float(direct.max()))
    direct = direct * np.repeat(height, punches.node_count)[sample]
    closure = float(np.abs(0.5 * np.pi * punches.half_width * step.a[punches.first_node[:-1]]).sum()) if dual else 0.0
    state = certify(state, max(float((residual * height).max()), float(direct.max()), closure), period, tolerance)
    none = np.zeros(punches.position.size)
    bounds = Bounds(RATE_REDUCTION, 0.0, np.inf)
    rate = solve_forces_on_contacts(punches, none + float(dual), period, none, bounds)
    state = state._replace(sensitivity=np.array([rate.plane if dual else -rate.plane]))
    inside = lowest_inside(state)
    unmet = Violations(max(closure, -inside), max(worst, -outside))
    if not dual:
        unmet = Violations(max(worst, -outside), -inside)
    return state._replace(error=error_bound(state, unmet, period))


def _sample_of(state: ContactState) -> Indices:
    """Nodes of the state at which it is checked by direct sums: the same ones each time."""
    size = state.phi.size
    return np.random.default_rng(size).choice(size, min(size, DIRECT_SUMS), replace=False)


@kernel
def _residuals_by_direct_sums(state: ContactState, series: CosineSeries, which: Indices) -> Array:
    """The gap on contacts, in g_0, or the pressure in gaps (dual), in p_0*, at some nodes of the state."""
    off, segments = np.empty(which.size), state.segments
    for i in range(which.size):
        j = np.searchsorted(segments.first_node, which[i], side="right") - 1
        y = segments.centre[j] + segments.half_width[j] * segments.node[which[i]]
        off[i] = complementary_residual(state, series, segments.crest[j], y)
    return off
