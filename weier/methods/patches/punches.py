"""Contacts whose edges are given: a symmetric problem for any number of them, by conjugate gradients.

On contacts with given edges, the pressure under which the surface z is flat is p = psi(t)/sqrt(1-t^2), with singular
edges like that of a punch. At the zeros t_i of T_K, psi is known by the forces f_i = (pi/K) r psi_i. Then

    (A f)_i = -2 sum_j f_j ln|2 sin(pi (x_i - x_j)/L)|,   z - A f = d on all contacts,   sum f = p L

with d the mean gap. Gauss's quadrature is exact where psi is resolved, but on the contact of i itself: there the sum
over its nodes is replaced by int T_k(s)/sqrt(1-s^2) ln|t-s| ds = -(pi/k) T_k(t), and -pi ln 2 for k = 0. So A is
symmetric, positive definite on forces of sum 0, and diagonal on each contact in the basis T_k, k > 0. This diagonal
and the forces between contacts taken as punches (`punch_forces`) are the preconditioner. It leaves 10 to 30 steps of
conjugate gradients to eight digits, whether there are 30 contacts or 27 000.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Indices
from weier.methods.errors import ConvergenceError
from weier.methods.patches.log_sums import LogMatrix, log_sums, make_log_matrix
from weier.methods.patches.punch_forces import Inverse, invert_punches, solve_forces

Table = NDArray[np.float64]  # shape (contacts, nodes of each) or (nodes, nodes)

MAX_NODES = 2000  # of one contact, whose own matrix is dense
MAX_STEPS = 300  # of conjugate gradients


class Rule(NamedTuple):
    """The zeros of T_K and what is known at them.

    node : t, ascending, shape (K,)
    polynomial : T_k at the nodes, one k a row, shape (K, K)
    own_log : what the closed form adds to sum_j f_j ln|t_i - t_j|, i != j, shape (K, K)
    """

    node: Array
    polynomial: Table
    own_log: Table


class Group(NamedTuple):
    """The contacts that have the same number of nodes.

    contact : their indices, shape (contacts,)
    node : the indices of their nodes, shape (contacts, K)
    """

    rule: Rule
    contact: Indices
    node: NDArray[np.int64]


class Punches(NamedTuple):
    """Contacts in order round the period, with the nodes of all of them in a row.

    centre, half_width : in lambda_0, shape (contacts,)
    node_count, first_node : nodes of each contact; index of its first and, last, the number of all
    groups : the contacts by their number of nodes
    position : of the nodes, ascending, in lambda_0
    period : L, in lambda_0
    matrix : ln|2 sin(pi (x_i - x_j)/L)| between all nodes
    """

    centre: Array
    half_width: Array
    node_count: Indices
    first_node: Indices
    groups: list[Group]
    position: Array
    period: float
    matrix: LogMatrix


class Forces(NamedTuple):
    """A solution.

    force : f at the nodes, in p_0* lambda_0
    plane : z - A f on the contacts, which is the mean gap, in g_0
    residual : largest deviation from that, in g_0
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
def chebyshev_rule(count: int) -> Rule:
    """The rule of so many nodes."""
    angle = np.pi - (np.arange(count) + 0.5) * (np.pi / count)
    node, k = np.cos(angle), np.arange(1, count)
    polynomial = np.cos(np.arange(count)[:, None] * angle)
    distance = np.abs(node[:, None] - node)
    np.fill_diagonal(distance, 1.0)
    closed_form = -np.log(2) - 2 * (polynomial[1:].T / k) @ polynomial[1:]
    return Rule(node, polynomial, closed_form - np.log(distance))


def make_punches(centre: Array, half_width: Array, node_count: Indices, period: float) -> Punches:
    """Contacts in order, which must not overlap, with so many nodes each."""
    first = np.concatenate([[0], np.cumsum(node_count)])
    position, groups = np.empty(first[-1]), []
    for count in np.unique(node_count):
        rule, contact = chebyshev_rule(int(count)), np.flatnonzero(node_count == count)
        node = first[contact][:, None] + np.arange(count)
        position[node] = centre[contact][:, None] + half_width[contact][:, None] * rule.node
        groups.append(Group(rule, contact, node))
    left, right = centre - half_width, centre + half_width
    if not (np.all(np.diff(position) > 0) and np.all(np.append(left[1:], left[0] + period) > right)):
        raise ConvergenceError("two contacts overlap, or lie closer to each other than a number tells")
    return Punches(centre, half_width, node_count, first, groups, position, period, make_log_matrix(position, period))


def displacement(punches: Punches, force: Array) -> Array:
    """A f at the nodes, in g_0."""
    total = log_sums(punches.matrix, force)
    log_width = np.log(2 * np.pi / punches.period * punches.half_width)
    for rule, contact, node in punches.groups:
        own = force[node]
        total[node] += own @ rule.own_log + log_width[contact][:, None] * own
    return -2 * total


def _precondition(punches: Punches, inverse: Inverse, height: Array) -> Array:
    """The forces that the heights ask for if contacts see each other as punches only."""
    mean = np.add.reduceat(height, punches.first_node[:-1]) / punches.node_count
    force = np.repeat(solve_forces(inverse, mean) / punches.node_count, punches.node_count)
    for rule, _, node in punches.groups:
        count = rule.node.size
        higher = height[node] @ rule.polynomial[1:].T * (np.arange(1, count) / count**2)
        force[node] += higher @ rule.polynomial[1:]
    return force


def solve_forces_on_contacts(punches: Punches, height: Array, total: float, start: Array, bounds: Bounds) -> Forces:
    """z - A f = d and sum f = total, by conjugate gradients that keep the sum.

    The heights and forces are at the nodes, in g_0 and p_0* lambda_0.
    """
    inverse = invert_punches(punches.centre, punches.half_width, punches.period)
    even = _precondition(punches, inverse, np.ones(start.size))  # the forces that raise all contacts alike
    force = start + even * ((total - start.sum()) / even.sum())
    residual = height - displacement(punches, force)
    plane, energy, direction, enough = 0.0, 1.0, np.zeros(start.size), -1.0
    for step in range(MAX_STEPS):
        change = _precondition(punches, inverse, residual)
        shift = float(change.sum() / even.sum())
        change -= shift * even
        residual -= shift
        plane += shift
        size = float(np.abs(residual).max())
        enough = max(bounds.least, min(bounds.most, bounds.reduction * size)) if enough < 0 else enough
        if size <= enough:
            return Forces(force, plane, size, step)
        last_energy, energy = energy, float(residual @ change)
        direction = change + (energy / last_energy if step > 0 else 0.0) * direction
        product = displacement(punches, direction)
        length = energy / float(direction @ product)
        force = force + length * direction
        residual -= length * product
    return Forces(force, plane, size, MAX_STEPS)


def expansion(punches: Punches, force: Array) -> Array:
    """Coefficients of psi in T_k, contact by contact, shape (nodes,)."""
    b = np.empty(force.size)
    for rule, contact, node in punches.groups:
        b[node] = force[node] @ rule.polynomial.T * (2 / np.pi / punches.half_width[contact])[:, None]
        b[node[:, 0]] *= 0.5
    return b


def forces_of_expansion(b: Table, half_width: Array, count: int) -> Table:
    """The forces at so many nodes of each of some contacts, from coefficients in T_k, as many a row as there are."""
    rule = chebyshev_rule(count)
    kept = min(count, b.shape[1])
    return np.asarray(b[:, :kept] @ rule.polynomial[:kept] * (np.pi / count * half_width)[:, None])


def regular_part(punches: Punches, b: Array) -> Array:
    """Coefficients in U_k of phi, where psi = (1-t^2) phi but for a straight line, contact by contact.

    With (1-t^2) U_k = (T_k - T_(k+2))/2, a_k = -2 (b_(k+2) + b_(k+4) + ...); the last two of each contact are 0.
    """
    a = np.zeros(b.size)
    for rule, _, node in punches.groups:
        for k in range(rule.node.size - 3, -1, -1):
            a[node[:, k]] = a[node[:, k + 2]] - 2 * b[node[:, k + 2]]
    return a


def expansion_of_regular_part(punches: Punches, a: Array) -> Array:
    """Coefficients in T_k of (1-t^2) phi, the density that is bounded at all edges."""
    b = 0.5 * a
    for _, _, node in punches.groups:
        b[node[:, 2:]] -= 0.5 * a[node[:, :-2]]
    return b
