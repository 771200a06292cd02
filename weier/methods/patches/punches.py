"""Segments whose edges are given: a symmetric problem for any number of them, by conjugate gradients.

On contacts with given edges, the pressure under which the surface z is flat is p = psi(t)/sqrt(1-t^2), with singular
edges like that of a punch. At the zeros t_i of T_K, psi is known by the forces f_i = (pi/K) r psi_i. Then

    (A f)_i = -2 sum_j f_j ln|2 sin(pi (x_i - x_j)/L)|,   z - A f = d on all contacts,   sum f = p L

with d the mean gap. Gauss's quadrature is exact where psi is resolved, but on the contact of i itself: there the sum
over its nodes is replaced by int T_k(s)/sqrt(1-s^2) ln|t-s| ds = -(pi/k) T_k(t), and -pi ln 2 for k = 0. So A is
symmetric, positive definite on forces of sum 0, and diagonal on each contact in the basis T_k, k > 0. This diagonal
and the forces between contacts taken as punches (`punch_forces`) are the preconditioner. It leaves 10 to 30 steps of
conjugate gradients to eight digits, whether there are 30 contacts or 27 000.

Gaps with given edges (dual) are cracks: w = sqrt(1-t^2) W(t) is the gap that frees them of the pressure of full
contact. At the zeros t_i of U_K, with the weights w_i of Gauss's quadrature, W is known by f_i = r w_i W_i, and

    (C f)_i = -1/(2 L^2) sum_j f_j/sin^2(pi (x_i - x_j)/L),   C f = -(pressure of full contact),   d = sum f/L.

On the gap of i itself, the finite part of int sqrt(1-s^2) U_k(s)/(t-s)^2 ds = -pi (k+1) U_k(t) stands for the sum.
So C is symmetric, positive definite, and but for a smooth rest diagonal on each gap in the basis U_k. As gaps feel
each other only as dipoles do, this diagonal is preconditioner enough. The slope of the gap, psi(t)/sqrt(1-t^2), has
the form of the pressure on a contact, so that the same expansions and the same moves of the edges serve both.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Indices
from weier.kernels.jit import kernel
from weier.methods.errors import ConvergenceError
from weier.methods.patches.pair_sums import PairMatrix, make_pair_matrix, pair_sums
from weier.methods.patches.punch_forces import Inverse, invert_punches, solve_forces

Table = NDArray[np.float64]  # shape (contacts, nodes of each) or (nodes, nodes)

MAX_NODES = 2000  # of one contact, whose own matrix is dense
MAX_STEPS = 300  # of conjugate gradients
MAX_PREDICTED_MOVE = 0.3  # in half-widths, up to which the pressure is carried along


class Rule(NamedTuple):
    """The zeros of T_K or, dual, of U_K, and what is known at them.

    node : t, ascending, shape (K,)
    weight : pi/K or, dual, that for int sqrt(1-t^2) W dt, shape (K,)
    polynomial : T_k or, dual, U_k at the nodes, one k a row, shape (K, K)
    own : what the closed form adds to sum_j f_j ln|t_i - t_j| or, dual, sum_j f_j/(t_i - t_j)^2, i != j, shape (K, K)
    own_inverse : the forces on one contact that make up for a residual of mean 0 or, dual, on one gap of width 1 for
        any residual, shape (K, K)
    """

    node: Array
    weight: Array
    polynomial: Table
    own: Table
    own_inverse: Table


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
    degree : of the polynomial whose coefficient is kept at each node's place, from 0 on each contact
    groups : the contacts by their number of nodes
    own, own_inverse, own_start : both tables of all rules in a row, and where those of each contact begin
    position : of the nodes, ascending, in lambda_0
    period : L, in lambda_0
    matrix : ln|2 sin(pi (x_i - x_j)/L)| or, dual, 1/sin^2(pi (x_i - x_j)/L) between all nodes
    dual : whether these are gaps
    """

    centre: Array
    half_width: Array
    node_count: Indices
    first_node: Indices
    degree: Indices
    groups: list[Group]
    own: Array
    own_inverse: Array
    own_start: Indices
    position: Array
    period: float
    matrix: PairMatrix
    dual: bool


class Forces(NamedTuple):
    """A solution.

    force : f at the nodes, in p_0* lambda_0 or, dual, g_0 lambda_0
    plane : the mean gap, in g_0
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


@lru_cache(maxsize=256)
def chebyshev_rule(count: int, dual: bool) -> Rule:
    """The rule of so many nodes."""
    if dual:
        angle = np.pi - np.arange(1, count + 1) * (np.pi / (count + 1))
        degree = np.arange(1, count + 1)
        polynomial = np.sin(degree[:, None] * angle) / np.sin(angle)
        weight = np.pi / (count + 1) * np.sin(angle) ** 2
        closed_form = -2 * (polynomial.T * degree) @ polynomial
        own_inverse = weight[:, None] * (polynomial.T / degree) @ polynomial * weight
    else:
        angle = np.pi - (np.arange(count) + 0.5) * (np.pi / count)
        degree = np.arange(count)
        polynomial, weight = np.cos(degree[:, None] * angle), np.full(count, np.pi / count)
        closed_form = -np.log(2) - 2 * (polynomial[1:].T / degree[1:]) @ polynomial[1:]
        own_inverse = (polynomial.T * degree) @ polynomial / count**2
    node = np.cos(angle)
    distance = np.abs(node[:, None] - node)
    np.fill_diagonal(distance, np.inf if dual else 1.0)
    kernel = distance**-2 if dual else np.log(distance)
    return Rule(node, weight, polynomial, closed_form - kernel, own_inverse)


def make_punches(centre: Array, half_width: Array, node_count: Indices, period: float, dual: bool = False) -> Punches:
    """Segments in order, which must not overlap, with so many nodes each."""
    first = np.concatenate([[0], np.cumsum(node_count)])
    offset, groups, own_start, start = np.empty(first[-1]), [], np.empty_like(node_count), 0
    for count in np.unique(node_count):
        rule, contact = chebyshev_rule(int(count), dual), np.flatnonzero(node_count == count)
        node = first[contact][:, None] + np.arange(count)
        offset[node] = half_width[contact][:, None] * rule.node
        own_start[contact], start = start, start + rule.own.size
        groups.append(Group(rule, contact, node))
    origin = np.repeat(centre, node_count)
    position, left, right = origin + offset, centre - half_width, centre + half_width
    if not (np.all(np.diff(position) > 0) and np.all(np.append(left[1:], left[0] + period) > right)):
        raise ConvergenceError("two contacts or gaps overlap, or lie closer to each other than a number tells")
    matrix = make_pair_matrix(origin, offset, period, dual)
    own = np.concatenate([group.rule.own.ravel() for group in groups])
    own_inverse = np.concatenate([group.rule.own_inverse.ravel() for group in groups])
    layout = centre, half_width, node_count, first, np.arange(first[-1]) - np.repeat(first[:-1], node_count), groups
    return Punches(*layout, own, own_inverse, own_start, position, period, matrix, dual)


@kernel
def _apply_to_each(table: Array, start: Indices, first_node: Indices, scale: Array, f: Array) -> Array:
    """The symmetric matrix of each contact, times its scale, times f at its nodes."""
    result = np.zeros(f.size)
    for j in range(scale.size):
        first, end, row = first_node[j], first_node[j + 1], start[j]
        here = result[first:end]
        for q in range(first, end):
            factor, column = scale[j] * f[q], table[row : row + here.size]
            for i in range(here.size):
                here[i] += factor * column[i]
            row += here.size
    return result


def displacement(punches: Punches, force: Array) -> Array:
    """A f, in g_0, or C f, in p_0*, at the nodes."""
    angle = np.pi / punches.period * punches.half_width
    if punches.dual:  # 1/sin^2(y) = 1/y^2 + 1/3 + ..., and the rest is 0 at y = 0
        scale, at_node, factor = angle**-2, np.full(angle.size, 1 / 3), -0.5 / punches.period**2
    else:
        scale, at_node, factor = np.ones(angle.size), np.log(2 * angle), -2.0
    own = _apply_to_each(punches.own, punches.own_start, punches.first_node, scale, force)
    return factor * (pair_sums(punches.matrix, force) + own + np.repeat(at_node, punches.node_count) * force)


def _precondition(punches: Punches, inverse: Inverse | None, residual: Array) -> Array:
    """The forces that make up for a residual if contacts see each other as punches only, and gaps not at all."""
    scale = np.ones(punches.centre.size) if inverse is not None else 4 * punches.half_width**2
    force = np.asarray(_apply_to_each(punches.own_inverse, punches.own_start, punches.first_node, scale, residual))
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
    rule, r = chebyshev_rule(count, dual), half_width[:, None]
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


def expansion_of_regular_part(punches: Punches, a: Array) -> Array:
    """Coefficients in T_k of (1-t^2) phi, the density that is bounded at all edges."""
    b = 0.5 * a
    for _, _, node in punches.groups:
        b[node[:, 2:]] -= 0.5 * a[node[:, :-2]]
    return b


def moved_expansion(punches: Punches, b: Array, centre: Array, half_width: Array) -> Array:
    """Coefficients of psi when the segments have moved: to second order the solution, if Newton's step moved them.

    With w = (dc + t dr)/r, psi + w [(1-t^2) phi' - t phi].
    """
    a, moved = regular_part(punches.first_node, b), np.empty(b.size)
    r = punches.half_width
    for group in punches.groups:
        contact, node, count = group.contact, group.node, group.rule.node.size
        rule = chebyshev_rule(count, False)
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


@kernel
def sample_forces(
    centre: Array, half_width: Array, first_node: Indices, b: Array, period: float,
    new_centre: Array, new_half_width: Array, new_first_node: Indices, which: Indices, force: Array,
) -> None:  # fmt: skip
    """Fill in the forces on the contacts `which` from the pressure, less its tension, of the old contacts."""
    left = centre - half_width
    for j in which:
        count = new_first_node[j + 1] - new_first_node[j]
        for q in range(count):
            t = -np.cos((q + 0.5) * np.pi / count)
            x = new_centre[j] + new_half_width[j] * t
            x -= period * np.floor((x - left[0]) / period)
            i = np.searchsorted(left, x, side="right") - 1
            s = (x - centre[i]) / half_width[i]
            pressure = 0.0
            if abs(s) < 1:
                after, here = 0.0, 0.0
                for k in range(first_node[i + 1] - 1, first_node[i], -1):
                    here, after = b[k] + 2 * s * here - after, here
                pressure = max(b[first_node[i]] + s * here - after, 0.0) / np.sqrt((1 - s) * (1 + s))
            weight = np.pi / count * new_half_width[j] * np.sqrt((1 - t) * (1 + t))
            force[new_first_node[j] + q] = weight * pressure
