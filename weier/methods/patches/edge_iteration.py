"""Newton's method on the edges of any number of contacts, which may vanish and merge in bulk on its way.

The rules are derived in docs/patches.md, "Moves of edges"; "The stages of many contacts" has what makes a segment
settled. `take_step` solves on given edges and finds their moves (`edge_moves`), and `next_guess` moves them, with the
density on them.

Near an edge p = (k_0 + k_1 s)/sqrt(s) at the distance s within. An edge that moves out by 2 k_0/k_1 is free of the
singularity, to first order and whatever the others do: the Jacobian of k_0 in the edges is diagonal at the solution.
Far from it, two closed forms are better. A contact narrower than the gaps beside it is Hertz's, whose width squared
follows from psi exactly. A gap narrower than the contacts beside it, where the pressure would be a parabola of
tension, has p = |x| (C + kappa (x^2-b^2)/2)/sqrt(x^2-b^2), so that k_0 and k_1 at one edge give the square of the
width which it should have; no gap is left where that is negative.

The slope of a gap with given edges (dual) has the same form, and so have the rules: a narrow gap in a parabola of
tension is like Hertz's contact, and beside a narrow contact dw/dx = (C + kappa (x^2-b^2))/sqrt(x^2-b^2). Only the
signs differ, for the slope is negative where a gap closes on its right.

All that is said of contacts holds for gaps (dual), with the gap in place of the pressure.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Flags, Indices
from weier.methods.errors import ConvergenceError
from weier.methods.patches.given_edges import (
    Bounds,
    Forces,
    Punches,
    expansion,
    make_punches,
    moved_expansion,
    regular_part,
    solve_forces_on_contacts,
    transfer_forces,
)
from weier.methods.patches.segments import (
    MAX_NODES,
    Extent,
    Segments,
    Sides,
    degrees,
    end_sums,
    estimate_node_count,
    from_crests,
    in_order,
    make_segments,
)
from weier.methods.patches.surface import CosineSeries, evaluate_at

# The limits of a step are safeguards far from the solution. Loads from spoilt guesses take within 9 % of the same
# number of steps with each of them halved or doubled (docs/numerics.md, "Contact patches in numbers").
#
# The square of a width changes by these factors at most in one step, since the formulas hold near the solution. A
# contact that would shrink so far vanishes (`MIN_GROWTH`), so that the first is for gaps.
MIN_SQUARE, MAX_SQUARE = 0.02, 6.0
MAX_CONTACT_SHIFT, MAX_GAP_SHIFT = 1.4, 0.7  # A centre moves by so many half-widths at most in one step.
# What stands for psi/phi, with the sign of psi, where phi is not positive, as it is on Hertz's contact: an edge with
# overlap beyond it moves outward, and one in tension inward.
RATIO_WITHOUT_CURVATURE = 0.5
# A gap of which a step would leave less than this part is tight. One that is so in two steps running is merged, since
# one step alone may overshoot.
MIN_GAP_LEFT = 0.1
MAX_GAP_LOSS = 0.8  # In the first of these two steps it loses this part of itself at most.
MIN_GROWTH = -0.85  # A contact vanishes if a step would shrink its half-width by more than this part.
# Moves below this, in half-widths, are near the solution, where Newton's steps square their error.
SETTLED_MOVE = 0.1
# The set of contacts is corrected when no more than this part of them moves: those beside a missing one may never
# settle.
MAX_UNSETTLED = 0.3
# The last coefficients of the regular part on each contact, so many of them, are 0: those of psi two degrees higher
# are unknown.
UNRESOLVED = 2
NODE_STEPS = 8  # Node counts are rounded up to as many values between powers of 2, so that few rules are needed.


class EdgeMoves(NamedTuple):
    """One step of Newton's method.

    outward : how far each edge moves out of its contact, in lambda_0, shape (contacts, 2)
    closed : whether the gap on the right of each contact closes, as the square of its width is negative, shape
        (contacts,)
    relative : larger move of both edges over the half-width of the contact or of its gaps, the narrowest,
        shape (contacts,)
    """

    outward: Sides
    closed: Flags
    relative: Array


def edge_moves(punches: Punches, b: Array, a: Array) -> EdgeMoves:
    """The moves from the coefficients of psi in T_k and of its regular part in U_k.

    The values at the ends are psi = sum (+-1)^k b_k and phi = sum (+-1)^k (k+1) a_k. The slope of psi inward is
    -sum (+-1)^k k^2 b_k: psi' at -1, and psi' with its sign turned at 1. Of gaps (dual) all are taken with
    the sign that they have at the left end, where the gap opens.
    """
    r, first_node = punches.segments.half_width, punches.segments.first_node
    sign = np.array([1.0, -1.0 if punches.dual else 1.0])
    psi = sign * end_sums(first_node, b)
    gap, degree = punches.gap, degrees(first_node)
    phi = sign * end_sums(first_node, a * (degree + 1))
    inward_slope = -sign * end_sums(first_node, b * degree**2)
    by_gap, closed, gap_is_narrow = _moves_by_gap(r, gap, psi, inward_slope, 0.25 if punches.dual else -0.75)
    by_contact = _moves_by_contact(r, psi, phi, gap_is_narrow)
    outward = np.where(gap_is_narrow, by_gap, by_contact)
    narrowest = np.minimum(r, 0.5 * np.minimum(gap, np.roll(gap, 1)))
    return EdgeMoves(outward, closed, np.abs(outward).max(axis=1) / narrowest)


def _moves_by_contact(r: Array, psi: Sides, phi: Sides, gap_is_narrow: NDArray[np.bool_]) -> Sides:
    """Outward moves by Hertz's contact, of which psi/phi is (a^2 - r^2)/(2 r^2) -+ (c - x_c)/r at its ends.

    The mean of both is half the growth of the squared half-width, and half their difference is the shift of the
    centre. The value at an edge beside a narrow gap is that of the gap, not of Hertz's contact. Then the value at the
    opposite edge stands for both.
    """
    ratio = np.where(phi > 0, psi / np.where(phi > 0, phi, 1.0), RATIO_WITHOUT_CURVATURE * np.sign(psi))
    ratio = np.where(gap_is_narrow, ratio[:, ::-1], ratio)
    growth = _growth_of_square(0.5 * (ratio[:, 0] + ratio[:, 1]))
    shift = np.clip(0.5 * (ratio[:, 1] - ratio[:, 0]), -MAX_CONTACT_SHIFT, MAX_CONTACT_SHIFT)
    return np.stack([growth - shift, growth + shift], axis=1) * r[:, None]


def _growth_of_square(linear: Array) -> Array:
    """The growth of a width, over itself, whose square grows by twice the linear growth."""
    return np.asarray(np.sqrt(np.clip(1 + 2 * linear, MIN_SQUARE, MAX_SQUARE)) - 1)


def _moves_by_gap(
    r: Array, gap: Array, psi: Sides, inward_slope: Sides, factor_of_k_0: float
) -> tuple[Sides, Flags, NDArray[np.bool_]]:
    """Outward moves by the gaps beside; which right gaps close; and at which edges the gap is the narrower.

    For gaps between contacts kappa b^2 is in proportion to b k_1 - 3 k_0/4, and for contacts between gaps (dual) to
    b k_1 + k_0/4, with b the half-width of what lies between. Its square grows by the factor 1 - 4 k_0 over that, and
    its half-width, to first order, by the part -2 k_0 over that. If that is not positive, it shrinks at an edge with
    overlap beyond it, and grows at one in tension. Both ends of a gap that is narrower than both contacts each give
    its growth: it grows by their mean, and half their difference shifts its centre.
    """
    half_width = np.stack([np.roll(gap, 1), gap], axis=1) / 2
    k_0, k_1 = psi * np.sqrt(r / 2)[:, None], (inward_slope + psi / 4) * np.sqrt(0.5 / r)[:, None]
    curvature = half_width * k_1 + factor_of_k_0 * k_0
    divisor = np.where(curvature > 0, curvature, 1.0)
    growth = np.where(curvature > 0, -2 * k_0 / divisor, np.where(k_0 > 0, -1.0, 1.0))
    # From here on of the gap on the right of each contact: its growth from both ends, and where it is narrower than
    # the contact at either end.
    left, right = growth[:, 1], np.roll(growth[:, 0], -1)
    narrow = np.stack([gap < 2 * r, gap < 2 * np.roll(r, -1)], axis=1)
    both = narrow.all(axis=1)
    linear = np.where(both, 0.5 * (left + right), np.where(narrow[:, 0], left, right))
    closed = narrow.any(axis=1) & (1 + 2 * linear < 0)
    shift = np.where(both, np.clip(0.5 * (right - left), -MAX_GAP_SHIFT, MAX_GAP_SHIFT), 0.0)
    widening = _growth_of_square(linear)
    outward_right, outward_left_of_next = -0.5 * gap * (widening - shift), -0.5 * gap * (widening + shift)
    at_edges = np.stack([np.roll(narrow[:, 1], 1), narrow[:, 0]], axis=1)
    return np.stack([np.roll(outward_left_of_next, 1), outward_right], axis=1), closed, at_edges


class Problem(NamedTuple):
    """What is solved: contacts that carry a mean pressure, or gaps in the tension of full contact (dual).

    series : the heights, in g_0, or the tensions (dual), in p_0*
    load : mean pressure, in p_0*
    dual : whether gaps are solved for
    """

    series: CosineSeries
    load: float
    dual: bool

    def forcing(self, crest: Indices, y: Array) -> Array:
        """The height less the largest or, dual, the tension of full contact, at distances from crests."""
        value = evaluate_at(self.series, crest, y, 0)
        return np.asarray(value + (self.series.maximum - self.load) if self.dual else value)


class Stage(NamedTuple):
    """How accurately the iteration solves, and what counts as a violation of the inequalities.

    fine : whether all edges are to settle; else the set of contacts is still to be corrected
    tolerance : each contact has as many nodes as its density needs for this relative tolerance
    bounds : of the residual on contacts with given edges
    outside : a segment is missing where the overlap, in g_0, or (dual) the tension, in p_0*, is larger
    inside : a segment is cut where tension over the largest pressure of the contact, or (dual) overlap over the
        largest gap, is larger
    opening : gaps or (dual) contacts of less height, in g_0, are not cut in, since no edges could be found for them
    """

    fine: bool
    tolerance: float
    bounds: Bounds
    outside: float
    inside: float
    opening: float


class Guess(NamedTuple):
    """Contacts, with middles in [0, L), and forces to start a step from.

    force : at the nodes
    tight : whether the last step would nearly have closed the gap on the right of each contact
    """

    punches: Punches
    force: Array
    tight: Flags


class Step(NamedTuple):
    """The solution on the contacts of a guess, and how these must change.

    b, a : coefficients of psi in T_k, of its regular part in U_k
    moves : of the edges
    vanishing : contacts that carry no force or have no width left
    merging : contacts whose gap on the right vanishes
    tight : contacts whose gap on the right would nearly close
    singular : height of the singular part of the pressure, 2 pi r |psi(+-1)|, in g_0, shape (contacts,)
    """

    punches: Punches
    forces: Forces
    b: Array
    a: Array
    moves: EdgeMoves
    vanishing: Flags
    merging: Flags
    tight: Flags
    singular: Array

    @property
    def unsettled(self) -> float:
        """Fraction of the contacts that vanish or merge, or for which Newton's method has not begun to converge."""
        moving = self.moves.relative >= SETTLED_MOVE
        return float(np.mean(moving | self.vanishing | self.merging | self.tight))


def make_guess(problem: Problem, segments: Segments, stage: Stage) -> Guess:
    """A guess on segments, with no forces: an estimate of these saves conjugate gradients hardly a step."""
    count = _estimate_nodes(problem, segments.extent, stage)
    segments = make_segments(segments.crest, *segments.extent, count)
    punches = make_punches(segments, problem.series.period, problem.dual)
    return Guess(punches, np.zeros(count.sum()), np.zeros(count.size, bool))


def _estimate_nodes(problem: Problem, extent: Extent, stage: Stage) -> Indices:
    """Nodes of contacts in order."""
    count = estimate_node_count(extent, problem.series, stage.tolerance)
    return round_up_nodes(np.asarray(count + UNRESOLVED, float))


def round_up_nodes(count: NDArray[np.float64]) -> Indices:
    """The next even number of nodes that is a multiple of its power of 2 over `NODE_STEPS`."""
    step = 2.0 ** np.maximum(1, np.floor(np.log2(count)) - np.log2(NODE_STEPS))
    return np.minimum(np.ceil(count / step) * step, MAX_NODES).astype(np.int64)


def take_step(problem: Problem, guess: Guess, stage: Stage) -> Step:
    """Solve for the pressure on the contacts of a guess, and find how their edges must move."""
    punches, segments = guess.punches, guess.punches.segments
    y = punches.at_nodes(segments.centre) + punches.offset
    forcing = problem.forcing(np.repeat(segments.crest, segments.node_count), y)
    forces = solve_forces_on_contacts(punches, forcing, problem.load * punches.period, guess.force, stage.bounds)
    b = expansion(punches, forces.force)
    a = regular_part(segments.first_node, b)
    moves = edge_moves(punches, b, a)
    r, gap = segments.half_width, punches.gap
    carried = np.add.reduceat(forces.force, segments.first_node[:-1])
    vanishing = (carried <= 0) | (moves.outward.mean(axis=1) < MIN_GROWTH * r)
    vanishing[np.argmax(carried)] = False  # One contact is left in any case.
    next_outward = np.roll(moves.outward[:, 0], -1)
    tight = gap - moves.outward[:, 1] - next_outward < MIN_GAP_LEFT * gap
    merging = (moves.closed | (tight & guess.tight)) & ~vanishing & ~np.roll(vanishing, -1)
    singular = 2 * np.pi * r * np.abs(end_sums(segments.first_node, b)).max(axis=1)
    return Step(punches, forces, b, a, moves, vanishing, merging, tight, singular)


def next_guess(problem: Problem, step: Step, stage: Stage, node_count: Array | None = None) -> Guess:
    """The guess after a step: edges moved, contacts removed and merged; and, if given, each with so many nodes."""
    moved = _move_edges(step)
    b = moved_expansion(step.punches.segments, step.b, moved.centre, moved.half_width)
    remaining = ~(step.vanishing | step.merging | np.roll(step.merging, 1))
    merged = np.array(_merged_intervals(problem, moved, step.merging)).reshape(-1, 2)
    return rearrange(problem, step._replace(b=b), moved, remaining, merged, stage, node_count)


def _move_edges(step: Step) -> Segments:
    """The segments after their moves, in which no tight gap loses more than `MAX_GAP_LOSS` of itself."""
    segments, gap, outward = step.punches.segments, step.punches.gap, step.moves.outward.copy()
    j = np.flatnonzero(step.tight)
    after = (j + 1) % gap.size
    loss = np.maximum(outward[j, 1], 0) + np.maximum(outward[after, 0], 0)
    factor = np.minimum(MAX_GAP_LOSS * gap[j] / loss, 1)
    outward[j, 1] = np.where(outward[j, 1] > 0, factor * outward[j, 1], outward[j, 1])
    outward[after, 0] = np.where(outward[after, 0] > 0, factor * outward[after, 0], outward[after, 0])
    centre = segments.centre + 0.5 * (outward[:, 1] - outward[:, 0])
    return segments._replace(centre=centre, half_width=segments.half_width + 0.5 * outward.sum(axis=1))


def _merged_intervals(problem: Problem, segments: Segments, merging: Flags) -> list[tuple[float, float]]:
    """From the first to the last of each run of contacts that merge."""
    n, period = merging.size, problem.series.period
    if np.all(merging):
        raise ConvergenceError(f"all gaps or all contacts have closed under {problem.load:.6g} p_0*")
    left, right = segments.middle - segments.half_width, segments.middle + segments.half_width
    intervals = []
    for start in np.flatnonzero(merging & ~np.roll(merging, 1)):
        end = start
        while merging[end % n]:
            end += 1
        intervals.append((float(left[start]), float(right[end % n] + period * (end // n))))
    return intervals


def rearrange(
    problem: Problem,
    step: Step,
    segments: Segments,
    remaining: Flags,
    added: NDArray[np.float64],
    stage: Stage,
    node_count: Array | None = None,
) -> Guess:
    """A guess of the remaining segments, with the step's expansions, and of added intervals, shape (added, 2)."""
    series = problem.series
    crest, origin, centre = (
        np.concatenate([old[remaining], new])
        for old, new in zip(segments[:3], from_crests(series, added.mean(axis=1)), strict=True)
    )
    half_width = np.append(segments.half_width[remaining], 0.5 * (added[:, 1] - added[:, 0]))
    if crest.size == 0:
        raise ConvergenceError("no contact is left")
    order, turns = in_order(origin + centre, series.period)
    extent = (origin - turns)[order], centre[order], half_width[order]
    origin_of = np.concatenate([np.flatnonzero(remaining), np.full(len(added), -1)])[order]
    tight = np.concatenate([step.tight[remaining], np.zeros(len(added), bool)])[order]
    count = _estimate_nodes(problem, extent, stage)
    if node_count is not None:
        count = np.where(origin_of >= 0, round_up_nodes(node_count[origin_of]), count)
    punches = make_punches(make_segments(crest[order], *extent, count), series.period, problem.dual)
    return Guess(punches, transfer_forces(step.punches.segments, step.b, origin_of, punches), tight)
