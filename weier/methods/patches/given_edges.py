"""Segments whose edges are given: a symmetric problem for any number of them, by conjugate gradients.

The formulas are those of docs/patches.md, "Given edges"; `moved_expansion` is the end of "Moves of edges".

On contacts with given edges, the pressure under which the surface z is flat is p = psi(t)/sqrt(1-t^2), with singular
edges like that of a punch. At the zeros t_i of T_K, psi is known by the forces f_i = (pi/K) r psi_i. Then

    (A f)_i = -2 sum_j f_j ln|2 sin(pi (x_i - x_j)/L)|,   z - A f = d on all contacts,   sum f = p L

with d the mean gap. Gauss's quadrature is exact where psi is resolved, but on the contact of i itself: there the sum
over its nodes is replaced by int T_k(s)/sqrt(1-s^2) ln|t-s| ds = -(pi/k) T_k(t), and -pi ln 2 for k = 0. So A is
symmetric, positive definite on forces of sum 0, and diagonal on each contact in the basis T_k, k > 0. This diagonal
and the forces between contacts taken as punches are the preconditioner. It leaves 10 to 30 steps of conjugate
gradients to eight digits, whether there are 30 contacts or 27 000.

Gaps with given edges (dual) are cracks: w = sqrt(1-t^2) omega(t) is the gap that frees them of the pressure of full
contact. At the zeros t_i of U_K, with the weights w_i of Gauss's quadrature, omega is known by f_i = r w_i omega_i,
and

    (C f)_i = -1/(2 L^2) sum_j f_j/sin^2(pi (x_i - x_j)/L),   C f = -(pressure of full contact),   d = sum f/L.

On the gap of i itself, the finite part of int sqrt(1-s^2) U_k(s)/(t-s)^2 ds = -pi (k+1) U_k(t) stands for the sum.
So C is symmetric, positive definite, and but for a smooth rest diagonal on each gap in the basis U_k. As gaps act on
each other as dipoles only, this diagonal is preconditioner enough. The slope of the gap, psi(t)/sqrt(1-t^2), has
the form of the pressure on a contact, so that the same expansions and the same moves of the edges serve both.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
import scipy  # its modules load when they are first used: a tenth of a second each, which few jobs need

from weier.kernels.arrays import Array, Indices
from weier.kernels.jit import kernel
from weier.methods.chebyshev import Table, gauss_rule
from weier.methods.errors import ConvergenceError
from weier.methods.patches.pair_sums import PairMatrix, make_pair_matrix, pair_sums
from weier.methods.patches.segments import Blocks, Segments, apply_blocks, degrees, distances_between, make_blocks
from weier.methods.punches import OFFSET, Inverse, invert_punches, solve_forces
from weier.theory.halfplane import displacement_of_punch, replace_by_influence

MAX_DIRECT = 200  # Unknowns of a direct solution at most: conjugate gradients with fast sums take less time beyond.
MAX_STEPS = 300  # Steps of conjugate gradients; 10 to 30 are usual.
# The pressure is carried along with moving edges, to first order in the move, up to so many half-widths: beyond, its
# derivative predicts nothing.
MAX_PREDICTED_MOVE = 0.3


class Punches(NamedTuple):
    """Contacts or, dual, gaps with given edges, and the influence of forces at their nodes on each other.

    The nodes are the zeros of T_K or, dual, of U_K. Of the nodes of the segments, only the number is used.

    segments : in order round the period
    gap : from the right edge of each to the next one, in lambda_0, shape (segments,)
    offset : of each node from the middle of its segment, in lambda_0, shape (nodes,)
    own, own_inverse : what the closed form of a segment adds to the sum over its own nodes, and the inverse of its
        influence on itself
    matrix : ln|2 sin(pi (x_i - x_j)/L)| or, dual, 1/sin^2(pi (x_i - x_j)/L) between all nodes; None if these are few
    period : L, in lambda_0
    dual : whether these are gaps
    """

    segments: Segments
    gap: Array
    offset: Array
    own: Blocks
    own_inverse: Blocks
    matrix: PairMatrix | None
    period: float
    dual: bool

    def at_nodes(self, of_segments: Array) -> Array:
        """A value of each segment at its nodes, shape (nodes,)."""
        return np.repeat(of_segments, self.segments.node_count)


class Forces(NamedTuple):
    """A solution.

    force : f at the nodes, in p_0* lambda_0 or, dual, g_0 lambda_0
    plane : the mean gap, in g_0, from where the forcing counts heights
    residual : largest deviation of z - A f from it or, dual, of the pressure from 0 times the gap's width, in g_0
    steps : of conjugate gradients
    """

    force: Array
    plane: float
    residual: float
    steps: int


class Bounds(NamedTuple):
    """How small the residual must become: `reduction` times that at the start, but in [least, most], in g_0.

    A step of the edges needs no more digits than it moves them by (`reduction`); `most` bounds what counts as solved,
    and below `least` a smaller residual is of no use.
    """

    reduction: float
    least: float
    most: float

    def over(self, unit: float) -> Bounds:
        """Return the same in a unit of height."""
        return Bounds(self.reduction, self.least / unit, self.most / unit)


@lru_cache(maxsize=256)
def _own_influence(count: int, dual: bool) -> Table:
    """What the closed form of a segment adds to sum_j f_j ln|t_i - t_j| or, dual, sum_j f_j/(t_i - t_j)^2, j != i.

    A unit f_j is the density sum_k T_k(t_j) T_k, k > 0 counting twice, over pi, whose integral with ln|t - t'| is
    -ln 2 - 2 sum T_k T_k/k. Dual, it is (2/pi) sum_k U_k(t_j) U_k, whose finite part is -2 sum (k + 1) U_k U_k.
    """
    node, _, polynomial, _ = gauss_rule(count, dual)
    distance = np.abs(node[:, None] - node)
    np.fill_diagonal(distance, np.inf if dual else 1.0)
    if dual:
        return -2 * (polynomial.T * np.arange(1, count + 1)) @ polynomial - distance**-2
    return -np.log(2) - 2 * (polynomial[1:].T / np.arange(1, count)) @ polynomial[1:] - np.log(distance)


@lru_cache(maxsize=256)
def _own_inverse(count: int, dual: bool) -> Table:
    """The forces on a contact for a residual of mean 0 or, dual, on a gap of width 1 for any residual.

    A residual T_k takes the forces k/(2 K) T_k, and its coefficient in a residual is 2/K times the sum of both.
    Dual, U_k takes 2 pi r^2 w_i U_k/(k + 1), with r = 1/2, and its coefficient is 2/pi times a weighted sum.
    """
    _, weight, polynomial, _ = gauss_rule(count, dual)
    if dual:
        return weight[:, None] * (polynomial.T / np.arange(1, count + 1)) @ polynomial * weight
    return np.asarray((polynomial.T * np.arange(count)) @ polynomial / count**2)


def make_punches(segments: Segments, period: float, dual: bool = False, most: int | None = None) -> Punches:
    """The punches on segments; ConvergenceError if these overlap."""
    counts = segments.node_count.tolist()
    origin = np.repeat(segments.middle, counts)
    offset = np.repeat(segments.half_width, counts) * np.concatenate(
        [gauss_rule(count, dual).node for count in counts]
    )
    gap = distances_between(*segments.extent, period)
    if not (np.all(segments.half_width > 0) and np.all(gap > 0)):
        raise ConvergenceError(
            "two contacts or gaps overlap, or are closer to each other than floating point resolves"
        )
    own = make_blocks(_own_influence(count, dual) for count in counts)
    own_inverse = make_blocks(_own_inverse(count, dual) for count in counts)
    matrix = (
        make_pair_matrix(origin, offset, period, dual)
        if offset.size > (MAX_DIRECT if most is None else most)
        else None
    )
    return Punches(segments, gap, offset, own, own_inverse, matrix, period, dual)


def _own_scales(punches: Punches) -> tuple[Array, Array, float]:
    """Return what scales the closed form of each segment, what is added at its nodes, and the factor of all sums."""
    # On a segment pi (x_i - x_j)/L is `angle` times t_i - t_j, so that the closed form of t is scaled, and what
    # ln|2 sin y| has beside ln|t_i - t_j| at y = 0 is ln(2 angle).
    angle = np.pi / punches.period * punches.segments.half_width
    if punches.dual:  # At y = 0, 1/sin^2(y) less its pole 1/y^2 is 1/3.
        return angle**-2, np.full(angle.size, 1 / 3), -0.5 / punches.period**2
    return np.ones(angle.size), np.log(2 * angle), -2.0


@kernel
def _influence_matrix(
    segments: Segments, offset: Array, own: Blocks, own_scales: tuple[Array, Array, float], period: float, dual: bool
) -> Table:
    """Return the matrix of `displacement`."""
    first, n = segments.first_node, offset.size
    scale, at_node, factor = own_scales
    distance = np.empty(n * n)
    for i in range(first.size - 1):
        for j in range(first.size - 1):
            apart = segments.origin[i] - segments.origin[j] + (segments.centre[i] - segments.centre[j])
            for a in range(first[i], first[i + 1]):
                for b in range(first[j], first[j + 1]):
                    distance[a * n + b] = apart + (offset[a] - offset[b])
    replace_by_influence(distance, period, dual)
    matrix = distance.reshape((n, n))
    for j in range(first.size - 1):
        entry = own.start[0, j]
        for b in range(first[j], first[j + 1]):
            for a in range(first[j], first[j + 1]):
                matrix[a, b] += scale[j] * own.table[entry]
                entry += 1
            matrix[b, b] += at_node[j]
    for a in range(n):
        for b in range(n):
            matrix[a, b] *= factor
    return matrix


def displacement(punches: Punches, force: Array) -> Array:
    """Return A f, in g_0, or C f, in p_0*, at the nodes."""
    scale, at_node, factor = _own_scales(punches)
    assert punches.matrix is not None
    own = apply_blocks(punches.own, punches.at_nodes(scale) * force)
    return factor * (pair_sums(punches.matrix, force) + own + punches.at_nodes(at_node) * force)


def _precondition(punches: Punches, inverse: Inverse | None, residual: Array) -> Array:
    """The preconditioner: forces for a residual, if contacts act on each other as punches, and gaps not at all."""
    segments = punches.segments
    scale = 1.0 if inverse is not None else punches.at_nodes(4 * segments.half_width**2)
    force = np.asarray(apply_blocks(punches.own_inverse, scale * residual))
    if inverse is not None:
        mean = np.add.reduceat(residual, segments.first_node[:-1]) / segments.node_count
        force += punches.at_nodes(solve_forces(inverse, mean) / segments.node_count)
    return force


def solve_forces_on_contacts(punches: Punches, forcing: Array, total: float, start: Array, bounds: Bounds) -> Forces:
    """Solve z - A f = d and sum f = total for f and d; dual, C f = forcing.

    The forcing, at the nodes, is the height z, in g_0, or, dual, the tension of full contact, in p_0*.
    """
    if punches.matrix is None:
        return _solve_directly(punches, forcing, total)
    return _solve_iteratively(punches, forcing, total, start, bounds)


def _solve_directly(punches: Punches, forcing: Array, total: float) -> Forces:
    """Solve by Cholesky's factors of the whole matrix, which is made positive definite by `OFFSET`."""
    dual = punches.dual
    matrix = _influence_matrix(
        punches.segments, punches.offset, punches.own, _own_scales(punches), punches.period, dual
    )
    right = np.stack([forcing, np.ones(forcing.size)])
    if not dual:
        matrix += OFFSET
    _, found, failed = scipy.linalg.lapack.dposv(matrix.T, right.T, overwrite_a=True, overwrite_b=True)
    if failed:
        raise ConvergenceError("two contacts or gaps are closer to each other than floating point resolves")
    force, even = found.T
    if dual:
        return Forces(force, float(force.sum()) / punches.period, 0.0, 0)
    shift = (total - float(force.sum())) / float(even.sum())
    return Forces(force + shift * even, OFFSET * total - shift, 0.0, 0)


def _solve_iteratively(punches: Punches, forcing: Array, total: float, start: Array, bounds: Bounds) -> Forces:
    """Solve by conjugate gradients with fast sums.

    The sum is kept by subtracting `shift` times M^-1 1 from each preconditioned residual M^-1 r, and d changes by
    `shift`.
    """
    # Forces and heights are counted in those of the load, as products of light ones would underflow.
    unit = total if not punches.dual else 1.0
    forcing, total, start, bounds = forcing / unit, total / unit, start / unit, bounds.over(unit)
    dual, force, inverse, even = punches.dual, start, None, np.zeros(start.size)  # `even` is M^-1 1
    half_width = punches.segments.half_width
    scale = punches.at_nodes(2 * half_width) if dual else np.ones(start.size)
    if not dual:
        compliance = displacement_of_punch(half_width, punches.period)
        inverse = invert_punches(np.arange(compliance.size), punches.segments.middle, compliance, punches.period)
        even = _precondition(punches, inverse, np.ones(start.size))  # forces that displace all contacts by about 1
        force = start + even * ((total - start.sum()) / even.sum())
    residual = forcing - displacement(punches, force)
    plane, energy, direction, enough, size = 0.0, 1.0, np.zeros(start.size), -1.0, np.inf
    for step in range(MAX_STEPS + 1):
        change = _precondition(punches, inverse, residual)
        if not dual:
            shift = float(change.sum() / even.sum())
            change -= shift * even
            residual -= shift
            plane += shift
        size = float(np.abs(scale * residual).max())
        enough = max(bounds.least, min(bounds.most, bounds.reduction * size)) if enough < 0 else enough
        if size <= enough or step == MAX_STEPS:
            break
        last_energy, energy = energy, float(residual @ change)
        direction = change + (energy / last_energy if step > 0 else 0.0) * direction
        product = displacement(punches, direction)
        length = energy / float(direction @ product)
        force = force + length * direction
        residual -= length * product
    return Forces(unit * force, float(force.sum()) / punches.period if dual else unit * plane, unit * size, step)


@lru_cache(maxsize=256)
def _psi_of_forces(count: int, dual: bool) -> Table:
    """Coefficients of psi in T_k, times r or, dual, r^2, from forces; those of gaps are cut off at T_(K-1).

    Of contacts f = (pi/K) r psi. Of gaps f = r w_i omega_i, so that w = sum c_k sin((k+1) theta) has the coefficients
    c_k = 2/(pi r) sum f U_k, and psi = -(1/r) sum (k+1) c_k T_(k+1).
    """
    rule = gauss_rule(count, dual)
    if not dual:
        return rule.expansion / rule.weight
    return np.concatenate([np.zeros((1, count)), -2 / np.pi * np.arange(1, count)[:, None] * rule.polynomial[:-1]])


@lru_cache(maxsize=256)
def _forces_of_psi(old: int, count: int, dual: bool) -> Table:
    """The inverse of `_psi_of_forces`: forces at `count` nodes, over r or, dual, r^2, from `old` coefficients of psi.

    Coefficients of higher degree than the nodes can carry are left out.
    """
    rule, matrix = gauss_rule(count, dual), np.zeros((count, old))
    kept = matrix[:, int(dual) : count + dual]
    kept[:] = (rule.polynomial * rule.weight)[: kept.shape[1]].T
    return matrix / np.append(1, -np.arange(1, old)) if dual else matrix


def expansion(punches: Punches, force: Array) -> Array:
    """Coefficients of psi in T_k, segment by segment, shape (nodes,)."""
    blocks = make_blocks(_psi_of_forces(count, punches.dual) for count in punches.segments.node_count.tolist())
    scale = punches.at_nodes(punches.segments.half_width) ** (1 + punches.dual)
    return np.asarray(apply_blocks(blocks, force) / scale)


@kernel
def regular_part(first_node: Indices, b: Array) -> Array:
    """Coefficients in U_k of phi, where psi = (1-t^2) phi but for a straight line, contact by contact.

    With (1-t^2) U_k = (T_k - T_(k+2))/2, a_k = a_(k+2) - 2 b_(k+2); the last two of each contact are 0.
    """
    a = np.zeros(b.size)
    for j in range(first_node.size - 1):
        for k in range(first_node[j + 1] - 3, first_node[j] - 1, -1):
            a[k] = a[k + 2] - 2 * b[k + 2]
    return a


@kernel
def vanishing_at_edges(first_node: Indices, b: Array, power: int) -> Array:
    """Return the coefficients of psi changed so that psi vanishes at all edges, where it is as small as rounding.

    Rounding of heights is of one size in all degrees, and the coefficient of T_k follows with the factor k. So those
    of contacts change in proportion to k^2, their variance, and the force stays. Rounding of pressures changes the
    coefficients of gaps alike.
    """
    changed = b.copy()
    for j in range(first_node.size - 1):
        for parity in range(2):
            at_edge, total = 0.0, 0.0
            for k in range(parity, first_node[j + 1] - first_node[j], 2):
                at_edge, total = at_edge + b[first_node[j] + k], total + (k**power if k > 0 else 0)
            for k in range(2 - parity, first_node[j + 1] - first_node[j], 2):
                changed[first_node[j] + k] -= at_edge * k**power / total
    return changed


@lru_cache(maxsize=256)
def _values_and_motion(count: int) -> tuple[Table, Table]:
    """From coefficients of psi to its values at the zeros of T_K, and from those of phi to (1-t^2) phi' - t phi.

    As sqrt(1-t^2) U_k = sin((k+1) theta), the latter is -(k+1) T_(k+1) for U_k.
    """
    polynomial = gauss_rule(count, False).polynomial.T
    return polynomial, np.roll(-np.arange(count) * polynomial, -1, axis=1)


def moved_expansion(segments: Segments, b: Array, centre: Array, half_width: Array) -> Array:
    """Coefficients of psi when the segments have moved: to second order the solution, if Newton's step moved them.

    A place that moved by w = (dc + t dr)/r in its coordinate t has psi + w [(1-t^2) phi' - t phi].
    """
    r, counts = segments.half_width, segments.node_count.tolist()
    rules = [gauss_rule(count, False) for count in counts]
    shift, growth = (np.repeat(change / r, counts) for change in (centre - segments.centre, half_width - r))
    moved = shift + growth * np.concatenate([rule.node for rule in rules])
    values, motion = map(make_blocks, zip(*map(_values_and_motion, counts), strict=True))
    psi = apply_blocks(values, b)
    psi += np.clip(moved, -MAX_PREDICTED_MOVE, MAX_PREDICTED_MOVE) * apply_blocks(
        motion, regular_part(segments.first_node, b)
    )
    return np.asarray(apply_blocks(make_blocks(rule.expansion for rule in rules), psi))


def transfer_forces(segments: Segments, b: Array, origin: Indices, new: Punches) -> Array:
    """The forces on other segments, each of which is the old one `origin`, or new where that is -1: then 0."""
    old = np.where(origin >= 0, segments.node_count[origin], 0)
    node = np.repeat(segments.first_node[origin], old) + degrees(np.append(0, np.cumsum(old)))
    counts = zip(old.tolist(), new.segments.node_count.tolist(), strict=True)
    blocks = make_blocks(_forces_of_psi(before, count, new.dual) for before, count in counts)
    return np.asarray(apply_blocks(blocks, b[node]) * new.at_nodes(new.segments.half_width) ** (1 + new.dual))
