"""Newton's method on the edges of contacts, which may vanish and merge (docs/patches.md, "Moves of edges").

`take_step` solves on given edges and computes their moves (`edge_moves`); `next_guess` moves the edges and transfers
the density. Near an edge p = (k_0 + k_1 s)/sqrt(s); a move by 2 k_0/k_1 removes the singularity. Narrow contacts and
narrow gaps have closed forms instead. The slope of a gap has the same form, with the opposite sign at right edges.
"The stages of a load" defines when edges have settled.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.jit import kernel
from weier.methods.errors import ConvergenceError
from weier.methods.patches.given_edges import (
    Forces,
    Punches,
    make_punches,
    moved_expansion,
    regular_part,
    solve_forces_on_contacts,
    transfer_forces,
)
from weier.methods.patches.kind import Kind, KindNumbers, numbers_of
from weier.methods.patches.rule import Table, expand_forces
from weier.methods.patches.segments import (
    MAX_NODES,
    Segments,
    estimate_node_count,
    make_segments,
)
from weier.methods.patches.surface import (
    CosineSeries,
    evaluate_on,
    from_crests,
    in_order,
)

# largest factor by which the square of a width grows or shrinks in a step, a safeguard far from the solution: of 61
# perturbed guesses 60 are solved, with 6 58 (docs/numerics.md, "Contact patches in numbers")
MAX_SQUARE = 4.0
MAX_STEPS = 60  # Newton steps per load; 2.6 on average, at most 9 for 4 000 hard loads
# move, in half-widths, below which Newton's method converges quadratically, and so ratio of the next move to this one
SETTLED_MOVE = 0.1


@kernel
def edge_moves(
    first_node: Indices, r: Array, gap: Array, force: Array, b: Array, right_sign: float, curvature_k_0: float
) -> tuple[Array, Table, Flags, float, float, bool, bool]:
    """Return the fields of `NewtonStep` from `a` on, from forces and their expansion b; `vanishing, merging` as rows.

    All values at the ends have the sign of the left end, where a gap opens. A contact narrower than the adjacent gaps
    is Hertzian. At an edge of a narrow gap, the value for the gap replaces the Hertzian one, and the opposite edge
    determines both Hertzian values. A gap narrower than both contacts grows by the mean of its ends.
    """
    n, a = r.size, regular_part(first_node, b)
    psi, phi, slope, moves = np.empty((n, 2)), np.empty((n, 2)), np.empty((n, 2)), np.empty((6, n))
    left_move, right_move, singular, narrowest, shifts, growths = moves
    closed, move, largest = np.empty(n, np.bool_), 0.0, 0.0
    for j in range(n):
        for side in range(2):
            at_end, regular, inward, sign = 0.0, 0.0, 0.0, 1.0 if side == 0 else right_sign
            for q in range(first_node[j], first_node[j + 1]):
                k = q - first_node[j]
                at_end += sign * b[q]
                regular += sign * (k + 1) * a[q]
                inward -= sign * k * k * b[q]
                sign = -sign if side == 0 else sign
            psi[j, side], phi[j, side], slope[j, side] = at_end, regular, inward
        singular[j] = 2 * np.pi * r[j] * max(abs(psi[j, 0]), abs(psi[j, 1]))
        largest = np.maximum(largest, singular[j])  # NaN stays the largest: the iteration does not end then
    for j in range(n):  # contacts in wide gaps are Hertzian
        first, last = (0 if gap[j - 1] >= 2 * r[j] else 1), (1 if gap[j] >= 2 * r[j] else 0)
        # Overlap moves an edge outward even if phi differs from Hertz's.
        left = psi[j, first] / max(abs(phi[j, first]), 1e-300)
        right = psi[j, last] / max(abs(phi[j, last]), 1e-300)
        growth, shift = _width_growth(0.5 * (left + right)), min(max(0.5 * (right - left), -1.0), 1.0)
        left_move[j], right_move[j] = (growth - shift) * r[j], (growth + shift) * r[j]
    for j in range(n):  # narrow gaps move their own edges
        k, half = (j + 1) % n, 0.5 * gap[j]
        left = _gap_growth(psi[j, 1], slope[j, 1], r[j], half, curvature_k_0)
        right = _gap_growth(psi[k, 0], slope[k, 0], r[k], half, curvature_k_0)
        narrower_left, narrower_right = half < r[j], half < r[k]
        linear = 0.5 * (left + right) if narrower_left and narrower_right else (left if narrower_left else right)
        shift = min(max(0.5 * (right - left), -1.0), 1.0) if narrower_left and narrower_right else 0.0
        closed[j], widening = (narrower_left or narrower_right) and 1 + 2 * linear < 0, _width_growth(linear)
        if narrower_left:
            right_move[j] = -half * (widening - shift)
        if narrower_right:
            left_move[k] = -half * (widening + shift)
    for j in range(n):
        narrowest[j] = min(r[j], 0.5 * min(gap[j], gap[j - 1]))
        move = max(move, max(abs(left_move[j]), abs(right_move[j])) / narrowest[j])
        shifts[j], growths[j] = 0.5 * (right_move[j] - left_move[j]), 0.5 * (right_move[j] + left_move[j])
    changes, is_changed = _changes(first_node, gap, force, moves, closed)
    return a, moves, changes, move, largest, is_changed, move < SETTLED_MOVE and not is_changed


@kernel
def _width_growth(linear: float) -> float:
    """Return the relative growth of a width whose square grows by twice the linear growth."""
    return np.sqrt(min(max(1 + 2 * linear, 1 / MAX_SQUARE), MAX_SQUARE)) - 1


@kernel
def _gap_growth(psi: float, inward_slope: float, r: float, b: float, curvature_k_0: float) -> float:
    """Return the first-order growth of an interval of half-width b between two segments, from one edge.

    If the curvature is not positive, the interval shrinks at an edge with overlap beyond it and grows at one in
    tension.
    """
    k_0, k_1 = psi * np.sqrt(r / 2), (inward_slope + psi / 4) * np.sqrt(0.5 / r)
    curvature = b * k_1 + curvature_k_0 * k_0
    return -2 * k_0 / curvature if curvature > 0 else (-1.0 if k_0 > 0 else 1.0)


class ContactProblem(NamedTuple):
    """Problem to solve: contacts under a mean pressure, or gaps in the tension of full contact.

    series : the heights, in g_0, or the tensions, in p_0*
    load : mean pressure, in p_0*
    kind : `CONTACTS` or `GAPS`
    """

    series: CosineSeries
    load: float
    kind: Kind

    @property
    def highest(self) -> float:
        """The forcing where the series has its maximum."""
        return self.kind.largest_forcing(self.series.maximum, self.load)


class NewtonStep(NamedTuple):
    """Solution on the contacts of a guess, and changes of the set of contacts.

    b, a : coefficients of psi in T_k, of its regular part in U_k
    moves : as rows, each of shape (contacts,): how far the left and the right edge move out of the contact, in
        lambda_0; height of the singular part of the pressure, 2 pi r |psi(+-1)|, in g_0; half-width of the contact or
        an adjacent gap, if that is smaller, in lambda_0; shift of the centre, and growth of the half-width
    vanishing : contacts without force
    merging : contacts whose gap on the right vanishes, or has a negative squared width
    move : the largest move of an edge over `narrowest`
    largest : the largest of `singular`
    changed : whether any contact vanishes or merges
    settled : whether the iteration has begun to converge for all contacts; none vanishes or merges
    """

    punches: Punches
    forces: Forces
    b: Array
    a: Array
    moves: Table
    vanishing: Flags
    merging: Flags
    move: float
    largest: float
    changed: bool
    settled: bool


def make_guess(problem: ContactProblem, segments: Segments, tolerance: float) -> Punches:
    """Return a guess on segments, with nodes for a relative tolerance, and without forces to start from.

    Estimates of the forces hardly save a step of the conjugate gradients.
    """
    count = estimate_node_count(segments.extent, problem.series, tolerance)
    segments = make_segments(segments.crest, *segments.extent, count)
    return make_punches(segments, problem.series.period, problem.kind)


def take_step(problem: ContactProblem, punches: Punches, residual: float) -> NewtonStep:
    """Solve for the pressure on given contacts to a residual, in g_0, and compute the moves of their edges."""
    segments, period = punches.segments, problem.series.period
    nodes = segments.crest, segments.centre, segments.first_node, punches.offset
    forcing = evaluate_on(problem.series.local, *nodes, problem.highest)
    forces = solve_forces_on_contacts(punches, forcing, problem.load, residual)
    known = segments.first_node, segments.half_width, punches.gap, punches.left, forces.force
    b, a, moves, changes, *sizes = _moves(*known, period, numbers_of(problem.kind, period))
    return NewtonStep(punches, forces, b, a, moves, *changes, *sizes)


@kernel
def _moves(
    first_node: Indices, r: Array, gap: Array, left: Array, force: Array, period: float, numbers: KindNumbers
) -> tuple[Array, Array, Table, Flags, float, float, bool, bool]:
    """Return the fields of `NewtonStep` from b on, from forces."""
    _, shift, derivative, _, _, _, right_sign, curvature_k_0 = numbers
    b = expand_forces(first_node, r, left, force, period, shift, derivative)
    return b, *edge_moves(first_node, r, gap, force, b, right_sign, curvature_k_0)


@kernel
def _changes(first_node: Indices, gap: Array, force: Array, moves: Table, closed: Flags) -> tuple[Flags, bool]:
    """Return which contacts vanish without force, which merge over the gap on their right, and whether any do."""
    n, strongest, most, is_changed = gap.size, 0, -np.inf, False
    changes = np.empty((2, n), np.bool_)
    vanishing, merging = changes
    for j in range(n):
        carried = 0.0
        for i in range(first_node[j], first_node[j + 1]):
            carried += force[i]
        vanishing[j] = carried <= 0
        if carried > most:
            strongest, most = j, carried
    vanishing[strongest] = False  # At least one contact remains.
    for j in range(n):
        k = (j + 1) % n
        is_closed = closed[j] or gap[j] <= moves[1, j] + moves[0, k]
        merging[j] = is_closed and not (vanishing[j] or vanishing[k])
        is_changed = is_changed or vanishing[j] or merging[j]
    return changes, is_changed


def next_guess(problem: ContactProblem, step: NewtonStep, tolerance: float, node_count: Indices) -> Punches:
    """Return the guess after a step, with new node counts: edges moved, contacts removed and merged."""
    old, series, (shift, growth) = step.punches.segments, problem.series, step.moves[4:]
    moved, b = make_segments(old.crest, old.origin, old.centre + shift, old.half_width + growth, node_count), step.b
    if step.punches.matrix is not None:  # A direct solution needs no forces to start from.
        b, _ = moved_expansion(old.first_node, old.half_width, step.b, step.a, shift, growth)
    if step.changed:
        remaining = ~(step.vanishing | step.merging | np.roll(step.merging, 1))
        merged = np.array(merged_intervals(problem, moved, step.merging)).reshape(-1, 2)
        return rearrange(problem, step._replace(b=b), moved, remaining, merged, tolerance, node_count)
    punches = make_punches(moved, series.period, problem.kind)
    return start_from(old, b, np.arange(shift.size), punches)


def carried_along(step: NewtonStep, rounding: float) -> NewtonStep:
    """Return a step with moved edges and transferred density: the next step to first order.

    Its moves are bounds on the moves of the next step: the contribution of rounding of the singularity, in g_0, and
    twice the square of the present ones, since the strength B changes with the edges as well. Shifts and growths are
    0, since they have been made.
    """
    punches, (shift, growth) = step.punches, step.moves[4:]
    old = punches.segments
    b, a, left = _carry(old.first_node, old.half_width, step.b, step.a, step.moves, step.move, rounding)
    segments = old._replace(centre=old.centre + shift, half_width=old.half_width + growth)
    moved = make_punches(segments, punches.period, punches.kind, MAX_NODES * shift.size)
    forces = step.forces._replace(force=transfer_forces(old, b, np.arange(shift.size), moved))
    return step._replace(punches=moved, forces=forces, b=b, a=a, moves=left)


@kernel
def _carry(
    first_node: Indices, r: Array, b: Array, a: Array, moves: Table, move: float, rounding: float
) -> tuple[Array, Array, Table]:
    """Return the expansions and the moves of `carried_along`."""
    left, singular, narrowest = np.zeros(moves.shape), moves[2], moves[3]
    for j in range(r.size):
        rounded, left[2, j], left[3, j] = min(1.0, rounding / max(singular[j], 1e-300)), singular[j], narrowest[j]
        for side in range(2):
            left[side, j] = 2 * move**2 * narrowest[j] + rounded * abs(moves[side, j])
    b, a = moved_expansion(first_node, r, b, a, moves[4], moves[5])
    return b, a, left


def start_from(old: Segments, b: Array, origin: Indices, punches: Punches) -> Punches:
    """Return a problem that starts from expansions on old segments; a direct solution starts from nothing."""
    return punches if punches.matrix is None else punches._replace(start=transfer_forces(old, b, origin, punches))


def merged_intervals(problem: ContactProblem, segments: Segments, merging: Flags) -> list[tuple[float, float]]:
    """Return the first and last of each run of merging contacts."""
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
    problem: ContactProblem,
    step: NewtonStep,
    segments: Segments,
    remaining: Flags,
    added: NDArray[np.float64],
    tolerance: float,
    node_count: Indices,
) -> Punches:
    """Return a guess from the remaining segments, with the expansions of the step, and added intervals (added, 2).

    The remaining segments have the node counts given.
    """
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
    count = estimate_node_count(extent, series, tolerance)
    count = np.where(origin_of >= 0, node_count[origin_of], count)
    punches = make_punches(make_segments(crest[order], *extent, count), series.period, problem.kind)
    return start_from(step.punches.segments, step.b, origin_of, punches)
