"""Segments whose edges are given: a symmetric problem for any number of them, by conjugate gradients.

On contacts with given edges, the pressure under which the surface z is flat is p = psi(t)/sqrt(1-t^2), with singular
edges like that of a punch. At the zeros t_i of T_K, psi is known by the forces f_i = (pi/K) r psi_i. Then

    (A f)_i = -2 sum_j f_j ln|2 sin(pi (x_i - x_j)/L)|,   z - A f = d on all contacts,   sum f = p L

with d the mean gap. Gauss's quadrature is exact where psi is resolved, but on the contact of i itself: there the sum
over its nodes is replaced by int T_k(s)/sqrt(1-s^2) ln|t-s| ds = -(pi/k) T_k(t), and -pi ln 2 for k = 0. So A is
symmetric, positive definite on forces of sum 0, and diagonal on each contact in the basis T_k, k > 0. This diagonal
and the forces between contacts taken as punches are the preconditioner. It leaves 10 to 30 steps of
conjugate gradients to eight digits, whether there are 30 contacts or 27 000.

Gaps with given edges (dual) are cracks: w = sqrt(1-t^2) W(t) is the gap that frees them of the pressure of full
contact. At the zeros t_i of U_K, with the weights w_i of Gauss's quadrature, W is known by f_i = r w_i W_i, and

    (C f)_i = -1/(2 L^2) sum_j f_j/sin^2(pi (x_i - x_j)/L),   C f = -(pressure of full contact),   d = sum f/L.

On the gap of i itself, the finite part of int sqrt(1-s^2) U_k(s)/(t-s)^2 ds = -pi (k+1) U_k(t) stands for the sum.
So C is symmetric, positive definite, and but for a smooth rest diagonal on each gap in the basis U_k. As gaps feel
each other only as dipoles do, this diagonal is preconditioner enough. The slope of the gap, psi(t)/sqrt(1-t^2), has
the form of the pressure on a contact, so that the same expansions and the same moves of the edges serve both.

The forces between n punches take the time O(n log^2 n). The unit force displaces a flat punch of half-width r by
-2 ln(pi r/L), and moves the surface at the centre of another by -2 ln|2 sin(pi d/L)|. Halve the row of punches again
and again: the influence of one half on the other is a matrix of low rank, since the logarithm is smooth but for few
neighbours. So the inverse follows from those of the two halves by Woodbury's formula. It need not be exact, because
it serves conjugate gradients as a part of their preconditioner.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
import scipy  # its modules load when they are first used: a tenth of a second each, which few jobs need
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Indices
from weier.kernels.jit import kernel
from weier.methods.errors import ConvergenceError
from weier.methods.patches.pair_sums import PairMatrix, make_pair_matrix, pair_sums
from weier.methods.patches.segments import Blocks, Rule, Table, apply_blocks, distances_between, gauss_rule
from weier.theory.halfplane import displacement_at_distance, displacement_of_punch

Matrix = NDArray[np.float64]
Factors = tuple[Matrix, NDArray[np.int32]]

MAX_DENSE = 128  # punches whose matrix is factorised as it is
RANK_TOLERANCE = 1e-6  # of the influence of one half on the other; looser ones take more steps of conjugate gradients
MAX_RANK = 60  # 20 to 30 reach that tolerance for 15 000 punches
MAX_STEPS = 300  # of conjugate gradients
MAX_PREDICTED_MOVE = 0.3  # in half-widths, up to which the pressure is carried along


class OwnMatrices(NamedTuple):
    """What nodes on one segment do to each other, and the forces that undo it, shape (K, K).

    direct : what the closed form adds to sum_j f_j ln|t_i - t_j| or, dual, sum_j f_j/(t_i - t_j)^2, i != j
    inverse : the forces on one contact that make up for a residual of mean 0 or, dual, on one gap of width 1 for any
        residual
    """

    direct: Table
    inverse: Table


class Group(NamedTuple):
    """The segments that have the same number of nodes.

    contact : their indices, shape (contacts,)
    node : the indices of their nodes, shape (contacts, K)
    """

    rule: Rule
    contact: Indices
    node: NDArray[np.int64]


class Punches(NamedTuple):
    """Contacts or, dual, gaps in order round the period, with the nodes of all of them in a row.

    centre, half_width : in lambda_0, shape (contacts,)
    node_count, first_node : nodes of each contact; index of its first and, last, the number of all
    groups : the contacts by their number of nodes
    own, own_inverse : what nodes do to others on the same contact, and the forces that undo it
    position : of the nodes, ascending, in lambda_0
    gap : from the right edge of each contact to the next one, in lambda_0, shape (contacts,)
    period : L, in lambda_0
    matrix : ln|2 sin(pi (x_i - x_j)/L)| or, dual, 1/sin^2(pi (x_i - x_j)/L) between all nodes
    dual : whether these are gaps
    """

    centre: Array
    half_width: Array
    node_count: Indices
    first_node: Indices
    groups: list[Group]
    own: Blocks
    own_inverse: Blocks
    position: Array
    gap: Array
    period: float
    matrix: PairMatrix
    dual: bool

    @property
    def right(self) -> Array:
        """Right edges, shape (contacts,)."""
        return self.centre + self.half_width


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
    """How small the residual must become: `reduction` times that of the start, but in [least, most], in g_0."""

    reduction: float
    least: float
    most: float


class Halves(NamedTuple):
    """The inverse by halves: [A, U V'; V U', B].

    split : punches of the first half
    first, second : the inverses of A and B
    low_rank : U and V, the influence of one half on the other
    solved : A^-1 U and B^-1 V
    factors : of [1, U' A^-1 U; V' B^-1 V, 1]
    """

    split: int
    first: Inverse
    second: Inverse
    low_rank: tuple[Matrix, Matrix]
    solved: tuple[Matrix, Matrix]
    factors: Factors


Inverse = Factors | Halves  # of a few punches and of many


def invert_punches(centre: Array, half_width: Array, period: float) -> Inverse:
    """The inverse of the influence of punches in order round the period."""
    if centre.size <= MAX_DENSE:
        return factorise(_influence(centre, half_width, period))
    split = centre.size // 2
    first = invert_punches(centre[:split], half_width[:split], period)
    second = invert_punches(centre[split:], half_width[split:], period)
    U, V = _low_rank(centre[:split], centre[split:], period)
    solved_U, solved_V, rank = solve_forces(first, U), solve_forces(second, V), U.shape[1]
    coupling = np.eye(2 * rank)
    coupling[:rank, rank:], coupling[rank:, :rank] = U.T @ solved_U, V.T @ solved_V
    return Halves(split, first, second, (U, V), (solved_U, solved_V), factorise(coupling))


def solve_forces(inverse: Inverse, displacement: NDArray[np.float64]) -> NDArray[np.float64]:
    """The forces that displace the punches by so much, shape (punches,) or (punches, columns)."""
    if not isinstance(inverse, Halves):
        return solve_factorised(inverse, displacement)
    first = solve_forces(inverse.first, displacement[: inverse.split])
    second = solve_forces(inverse.second, displacement[inverse.split :])
    (U, V), (solved_U, solved_V), rank = inverse.low_rank, inverse.solved, inverse.low_rank[0].shape[1]
    exchange = solve_factorised(inverse.factors, np.concatenate([U.T @ first, V.T @ second]))
    return np.concatenate([first - solved_U @ exchange[rank:], second - solved_V @ exchange[:rank]])


def factorise(matrix: Matrix) -> Factors:
    """LAPACK's factors of a matrix, which they may overwrite."""
    lu, pivot, _ = scipy.linalg.lapack.dgetrf(matrix, overwrite_a=True)
    return lu, pivot


def solve_factorised(factors: Factors, right: Matrix) -> Matrix:
    """The solution for one right side or several, shape (unknowns,) or (unknowns, columns)."""
    return np.asarray(scipy.linalg.lapack.dgetrs(*factors, right)[0])


@kernel
def _influence(centre: Array, half_width: Array, period: float) -> Matrix:
    matrix = np.empty((centre.size, centre.size))
    for i in range(centre.size):
        for j in range(i):
            matrix[i, j] = matrix[j, i] = displacement_at_distance(centre[i] - centre[j], period)
        matrix[i, i] = displacement_of_punch(half_width[i], period)
    return matrix


@kernel
def _low_rank(x: Array, y: Array, period: float) -> tuple[Matrix, Matrix]:
    """U and V with U V' = the influence of y on x, by adaptive cross approximation with partial pivoting."""
    most = min(MAX_RANK, x.size, y.size)
    U, V, used = np.zeros((most, x.size)), np.zeros((most, y.size)), np.zeros(x.size, np.bool_)
    row, rank, square = 0, 0, 0.0
    while rank < most:
        used[row] = True
        for j in range(y.size):
            V[rank, j] = displacement_at_distance(x[row] - y[j], period)
        for k in range(rank):
            V[rank] -= U[k, row] * V[k]
        column = int(np.argmax(np.abs(V[rank])))
        pivot = V[rank, column]
        if pivot == 0:
            break
        for i in range(x.size):
            U[rank, i] = displacement_at_distance(x[i] - y[column], period)
        for k in range(rank):
            U[rank] -= V[k, column] * U[k]
        U[rank] /= pivot
        added = np.sum(U[rank] ** 2) * np.sum(V[rank] ** 2)
        square += added
        rank += 1
        if added <= RANK_TOLERANCE**2 * square:
            break
        row = int(np.argmax(np.where(used, -1.0, np.abs(U[rank - 1]))))
    return U[:rank].T.copy(), V[:rank].T.copy()


@lru_cache(maxsize=256)
def _own_matrices(count: int, dual: bool) -> OwnMatrices:
    """The matrices of so many nodes."""
    node, weight, polynomial, _ = gauss_rule(count, dual)
    distance = np.abs(node[:, None] - node)
    np.fill_diagonal(distance, np.inf if dual else 1.0)
    degree = np.arange(count) + dual
    if dual:
        direct = -2 * (polynomial.T * degree) @ polynomial - distance**-2
        return OwnMatrices(direct, weight[:, None] * (polynomial.T / degree) @ polynomial * weight)
    direct = -np.log(2) - 2 * (polynomial[1:].T / degree[1:]) @ polynomial[1:] - np.log(distance)
    return OwnMatrices(direct, (polynomial.T * degree) @ polynomial / count**2)


def make_punches(centre: Array, half_width: Array, node_count: Indices, period: float, dual: bool = False) -> Punches:
    """Segments in order, which must not overlap, with so many nodes each."""
    first = np.concatenate([[0], np.cumsum(node_count)])
    offset, groups, own_start, start = np.empty(first[-1]), [], np.empty_like(node_count), 0
    for count in np.unique(node_count):
        rule, contact = gauss_rule(int(count), dual), np.flatnonzero(node_count == count)
        node = first[contact][:, None] + np.arange(count)
        offset[node] = half_width[contact][:, None] * rule.node
        own_start[contact], start = start, start + int(count) ** 2
        groups.append(Group(rule, contact, node))
    origin = np.repeat(centre, node_count)
    position, gap = origin + offset, distances_between(centre, np.zeros(centre.size), half_width, period)
    if not (np.all(np.diff(position) > 0) and np.all(gap > 0)):
        raise ConvergenceError("two contacts or gaps overlap, or lie closer to each other than a number tells")
    matrix = make_pair_matrix(origin, offset, period, dual)
    matrices = [_own_matrices(group.rule.node.size, dual) for group in groups]
    own, own_inverse = (
        Blocks(np.concatenate([each.ravel() for each in tables]), own_start, first, first)
        for tables in zip(*matrices, strict=True)
    )
    layout = centre, half_width, node_count, first, groups
    return Punches(*layout, own, own_inverse, position, gap, period, matrix, dual)


def displacement(punches: Punches, force: Array) -> Array:
    """A f, in g_0, or C f, in p_0*, at the nodes."""
    angle = np.pi / punches.period * punches.half_width
    if punches.dual:  # 1/sin^2(y) = 1/y^2 + 1/3 + ..., and the rest is 0 at y = 0
        scale, at_node, factor = angle**-2, np.full(angle.size, 1 / 3), -0.5 / punches.period**2
    else:
        scale, at_node, factor = np.ones(angle.size), np.log(2 * angle), -2.0
    own = apply_blocks(punches.own, np.repeat(scale, punches.node_count) * force)
    return factor * (pair_sums(punches.matrix, force) + own + np.repeat(at_node, punches.node_count) * force)


def _precondition(punches: Punches, inverse: Inverse | None, residual: Array) -> Array:
    """The forces that make up for a residual if contacts see each other as punches only, and gaps not at all."""
    scale = 1.0 if inverse is not None else np.repeat(4 * punches.half_width**2, punches.node_count)
    force = np.asarray(apply_blocks(punches.own_inverse, scale * residual))
    if inverse is not None:
        mean = np.add.reduceat(residual, punches.first_node[:-1]) / punches.node_count
        force += np.repeat(solve_forces(inverse, mean) / punches.node_count, punches.node_count)
    return force


def solve_forces_on_contacts(punches: Punches, forcing: Array, total: float, start: Array, bounds: Bounds) -> Forces:
    """z - A f = d and sum f = total, by conjugate gradients that keep the sum; dual, C f = forcing.

    The forcing, at the nodes, is the height z, in g_0, or, dual, the tension of full contact, in p_0*.
    """
    dual, force, inverse, even = punches.dual, start, None, np.zeros(start.size)
    scale = 2 * np.repeat(punches.half_width, punches.node_count) if dual else np.ones(start.size)
    if not dual:
        inverse = invert_punches(punches.centre, punches.half_width, punches.period)
        even = _precondition(punches, inverse, np.ones(start.size))  # the forces that raise all contacts alike
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
    return Forces(force, float(force.sum()) / punches.period if dual else plane, size, step)


def expansion(punches: Punches, force: Array) -> Array:
    """Coefficients of psi in T_k, segment by segment, shape (nodes,); gaps leave out the last that they have.

    With w = sum c_k sin((k+1) theta), psi = -(1/r) sum (k+1) c_k T_(k+1).
    """
    b = np.empty(force.size)
    for rule, contact, node in punches.groups:
        b[node] = force[node] @ rule.polynomial.T * (2 / np.pi / punches.half_width[contact])[:, None]
        if punches.dual:
            slope = b[node] * np.arange(1, rule.node.size + 1) / -punches.half_width[contact][:, None]
            b[node] = np.concatenate([np.zeros((contact.size, 1)), slope[:, :-1]], axis=1)
        else:
            b[node[:, 0]] *= 0.5
    return b


def forces_of_expansion(b: Table, half_width: Array, count: int, dual: bool) -> Table:
    """The forces at so many nodes of each of some segments, from as many coefficients of psi in T_k as there are."""
    rule, r = gauss_rule(count, dual), half_width[:, None]
    if dual:
        b = -r * b[:, 1:] / np.arange(1, b.shape[1])
    kept = min(count, b.shape[1])
    return np.asarray(b[:, :kept] @ rule.polynomial[:kept] * rule.weight * r)


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


def moved_expansion(punches: Punches, b: Array, centre: Array, half_width: Array) -> Array:
    """Coefficients of psi when the segments have moved: to second order the solution, if Newton's step moved them.

    With w = (dc + t dr)/r, psi + w [(1-t^2) phi' - t phi].
    """
    a, moved = regular_part(punches.first_node, b), np.empty(b.size)
    r = punches.half_width
    for group in punches.groups:
        contact, node, count = group.contact, group.node, group.rule.node.size
        rule = gauss_rule(count, False)
        t = rule.node
        k = np.arange(1, count)[:, None]
        bracket = -k * rule.polynomial[1:]  # (1-t^2) U_k' - t U_k = -(k+1) T_(k+1)
        shift, growth = (centre - punches.centre)[contact, None], (half_width - r)[contact, None]
        w = np.clip((shift + t * growth) / r[contact, None], -MAX_PREDICTED_MOVE, MAX_PREDICTED_MOVE)
        psi = b[node] @ rule.polynomial + w * (a[node[:, :-1]] @ bracket)
        moved[node] = psi @ rule.polynomial.T * (2 / count)
        moved[node[:, 0]] *= 0.5
    return moved


def transfer_forces(punches: Punches, b: Array, origin: Indices, half_width: Array, node_count: Indices) -> Array:
    """The forces on other segments, each of which is the old one `origin`, or new where that is -1: then 0."""
    first = np.concatenate([[0], np.cumsum(node_count)])
    force, kept = np.zeros(first[-1]), np.flatnonzero(origin >= 0)
    counts = np.stack([punches.node_count[origin[kept]], node_count[kept]], axis=1)
    for old, new in np.unique(counts, axis=0):
        here = kept[(counts[:, 0] == old) & (counts[:, 1] == new)]
        rows = b[punches.first_node[origin[here]][:, None] + np.arange(old)]
        force[first[here][:, None] + np.arange(new)] = forces_of_expansion(
            rows, half_width[here], int(new), punches.dual
        )
    return force
