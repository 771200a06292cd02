"""Newton's method on the edges of any number of contacts, which may vanish and merge in bulk on its way.

All that is said of contacts holds for gaps (dual), with the gap in place of the pressure.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Flags, Indices
from weier.methods.errors import ConvergenceError
from weier.methods.patches.punch_edges import (
    EdgeMoves,
    distances,
    edge_moves,
    moved_expansion,
    sample_forces,
    singular_parts,
    transfer_forces,
)
from weier.methods.patches.punches import (
    MAX_NODES,
    Bounds,
    Forces,
    Punches,
    expansion,
    forces_of_expansion,
    make_punches,
    regular_part,
    solve_forces_on_contacts,
)
from weier.methods.patches.surface import CosineSeries, nearest_crests

MIN_GAP_LEFT = 0.1  # of a gap, in one step: one that would lose more in two steps running is merged
MAX_GAP_LOSS = 0.8  # of such a gap, in the first of the two
MIN_GROWTH = -0.85  # of a half-width in one step: with less of it left, the contact vanishes
SETTLED_MOVE = 0.1  # in half-widths: from here on Newton's steps square their error
NODES_PER_RADIAN = 0.8  # of the finest wave on a half-width
MIN_DISTANCE, MAX_DISTANCE = 1e-4, 1e6  # of a neighbour over the half-width, for the estimate of the nodes
NODE_STEPS = 8  # node counts are rounded up to as many values between powers of 2, so that few rules are needed


class Problem(NamedTuple):
    """What is solved: contacts that carry a mean pressure, or gaps in the tension of full contact (dual).

    series : the heights, in g_0, or the tensions (dual), in p_0*
    load : mean pressure, in p_0*
    dual : whether gaps are solved for
    """

    series: CosineSeries
    load: float
    dual: bool

    def forcing(self, origin: Array, offset: Array | float = 0.0) -> Array:
        """The height or, dual, the tension of full contact at origin + offset, with all digits of the offset."""
        series = self.series
        crest, y = nearest_crests(series, origin)
        angle = (y + offset)[:, None] * series.wavenumber
        waves = series.crest_cosine[crest] * np.cos(angle) - series.crest_sine[crest] * np.sin(angle)
        return np.asarray(waves @ series.amplitude - (self.load if self.dual else 0.0))


class Stage(NamedTuple):
    """How accurately the iteration solves.

    base_nodes, nodes_per_neighbour : of a contact, besides those for the waves; the latter over ln(rho), where rho
        belongs to the Bernstein ellipse through its nearest neighbour
    bounds : of the residual on contacts with given edges
    """

    base_nodes: float
    nodes_per_neighbour: float
    bounds: Bounds


class Guess(NamedTuple):
    """Contacts and forces to start a step from.

    centre, half_width, node_count : of the contacts in order, the first of which begins in [0, L)
    force : at the nodes
    tight : whether the gap on the right of each contact has nearly closed in the last step
    """

    centre: Array
    half_width: Array
    node_count: Indices
    force: Array
    tight: Flags


class Step(NamedTuple):
    """What is known of a guess.

    b, a : coefficients of psi in T_k, of its regular part in U_k
    moves : of the edges
    vanishing : contacts that carry no force or have no width left
    merging : contacts whose gap on the right vanishes
    tight : contacts whose gap on the right would nearly close
    singular : height that the singular part of the pressure accounts for, in g_0, shape (contacts,)
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
    def settled(self) -> bool:
        """Whether the contacts are as many as before and Newton's method has begun to converge."""
        return self.moves.largest < SETTLED_MOVE and not np.any(self.vanishing | self.merging | self.tight)


def make_guess(problem: Problem, left: Array, right: Array, carried: Array | None, stage: Stage) -> Guess:
    """A guess from edges, and from the force that each contact carries if that is known, shape (contacts,)."""
    period = problem.series.period
    turn = period * np.floor(left / period)
    order = np.argsort(left - turn)
    left, right = (left - turn)[order], (right - turn)[order]
    half_width, count = 0.5 * (right - left), estimate_nodes(problem, left, right, stage)
    force = np.zeros(count.sum())
    if carried is not None:
        b = (carried[order] / half_width)[:, None] * np.array([1.0, 0.0, -1.0]) / np.pi  # of Hertz's pressure
        for each in np.unique(count):
            here = np.flatnonzero(count == each)
            nodes = (np.cumsum(count) - count)[here][:, None] + np.arange(each)
            force[nodes] = forces_of_expansion(b[here], half_width[here], int(each), problem.dual)
    return Guess(0.5 * (left + right), half_width, count, force, np.zeros(left.size, bool))


def estimate_nodes(problem: Problem, left: Array, right: Array, stage: Stage) -> Indices:
    """Nodes for the waves within each contact and for the singularities at the edges of its neighbours."""
    half_width, gap = 0.5 * (right - left), distances(left, right, problem.series.period)
    nearest = np.clip(np.minimum(gap, np.roll(gap, 1)) / half_width, MIN_DISTANCE, MAX_DISTANCE)
    ln_rho = np.log1p(nearest + np.sqrt(nearest * (nearest + 2)))
    return round_up_nodes(
        stage.base_nodes
        + NODES_PER_RADIAN * problem.series.wavenumber[-1] * half_width
        + stage.nodes_per_neighbour / ln_rho
    )


def round_up_nodes(count: NDArray[np.float64]) -> Indices:
    """The next even number of nodes that is a multiple of a share of its power of 2."""
    step = 2.0 ** np.maximum(1, np.floor(np.log2(count)) - np.log2(NODE_STEPS))
    return np.minimum(np.ceil(count / step) * step, MAX_NODES).astype(np.int64)


def take_step(problem: Problem, guess: Guess, stage: Stage) -> Step:
    """Solve for the pressure on the contacts of a guess, and see how their edges must move."""
    period = problem.series.period
    punches = make_punches(guess.centre, guess.half_width, guess.node_count, period, problem.dual)
    forcing = problem.forcing(punches.matrix.tree.origin, punches.matrix.tree.offset)
    forces = solve_forces_on_contacts(punches, forcing, problem.load * period, guess.force, stage.bounds)
    b = expansion(punches, forces.force)
    a = regular_part(punches.first_node, b)
    moves = edge_moves(punches, b, a)
    r, gap = guess.half_width, distances(guess.centre - guess.half_width, guess.centre + guess.half_width, period)
    carried = np.add.reduceat(forces.force, punches.first_node[:-1])
    vanishing = (carried <= 0) | (moves.outward.mean(axis=1) < MIN_GROWTH * r)
    vanishing[np.argmax(carried)] = False
    next_outward = np.roll(moves.outward[:, 0], -1)
    tight = gap - moves.outward[:, 1] - next_outward < MIN_GAP_LEFT * gap
    merging = (moves.closing | (tight & guess.tight)) & ~vanishing & ~np.roll(vanishing, -1)
    singular = 2 * np.pi * r * np.abs(singular_parts(punches, b)).max(axis=1)
    return Step(punches, forces, b, a, moves, vanishing, merging, tight, singular)


def next_guess(problem: Problem, step: Step, stage: Stage, more_nodes: Array | None = None) -> Guess:
    """The guess after a step: edges moved, contacts removed and merged; and, if given, each with so many nodes."""
    left, right = _moved_edges(step)
    moved = moved_expansion(step.punches, step.b, 0.5 * (left + right), 0.5 * (right - left))
    keep = ~(step.vanishing | step.merging | np.roll(step.merging, 1))
    merged = np.array(_merged_intervals(problem, left, right, step)).reshape(-1, 2)
    return rearrange(problem, step, moved, (left, right), keep, merged, stage, more_nodes)


def _moved_edges(step: Step) -> tuple[Array, Array]:
    """The edges after their moves, but no gap loses more than a share of itself."""
    r, centre, outward = step.punches.half_width, step.punches.centre, step.moves.outward.copy()
    gap = distances(centre - r, centre + r, step.punches.period)
    j = np.flatnonzero(step.tight)
    after = (j + 1) % r.size
    loss = np.maximum(outward[j, 1], 0) + np.maximum(outward[after, 0], 0)
    share = np.minimum(MAX_GAP_LOSS * gap[j] / loss, 1)
    outward[j, 1] = np.where(outward[j, 1] > 0, share * outward[j, 1], outward[j, 1])
    outward[after, 0] = np.where(outward[after, 0] > 0, share * outward[after, 0], outward[after, 0])
    return centre - r - outward[:, 0], centre + r + outward[:, 1]


def _merged_intervals(problem: Problem, left: Array, right: Array, step: Step) -> list[tuple[float, float]]:
    """From the first to the last of each run of contacts that merge."""
    merging, n, period = step.merging, left.size, step.punches.period
    if np.all(merging):
        raise ConvergenceError(f"all gaps or all contacts have closed under {problem.load:.6g} p_0*")
    intervals = []
    for start in np.flatnonzero(merging & ~np.roll(merging, 1)):
        end = start
        while merging[end % n]:
            end += 1
        intervals.append((float(left[start]), float(right[end % n] + period * (end // n))))
    return intervals


def rearrange(
    problem: Problem, step: Step, b: Array, edges: tuple[Array, Array], keep: Flags, added: NDArray[np.float64],
    stage: Stage, more_nodes: Array | None = None,
) -> Guess:  # fmt: skip
    """A guess of the contacts that are kept, with the expansions b, and of added intervals, shape (added, 2)."""
    period, none = step.punches.period, np.full(len(added), -1)
    left, right = np.concatenate([edges[0][keep], added[:, 0]]), np.concatenate([edges[1][keep], added[:, 1]])
    origin = np.concatenate([np.flatnonzero(keep), none])
    tight = np.concatenate([step.tight[keep], np.zeros(len(added), bool)])
    if left.size == 0:
        raise ConvergenceError("no contact is left")
    turn = period * np.floor(left / period)
    order = np.argsort(left - turn)
    left, right, origin, tight = (left - turn)[order], (right - turn)[order], origin[order], tight[order]
    centre, half_width = 0.5 * (left + right), 0.5 * (right - left)
    count = estimate_nodes(problem, left, right, stage)
    if more_nodes is not None:
        count = np.where(origin >= 0, round_up_nodes(more_nodes[origin]), count)
    force = transfer_forces(step.punches, b, origin, half_width, count)
    first, old = np.concatenate([[0], np.cumsum(count)]), step.punches
    if not problem.dual:  # a new gap lies in contact, where it starts from nothing
        sample_forces(
            old.centre, old.half_width, old.first_node, step.b, period,
            centre, half_width, first, np.flatnonzero(origin < 0), force,
        )  # fmt: skip
    return Guess(centre, half_width, count, force, tight)
