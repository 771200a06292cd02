"""Segments with given edges: a symmetric positive definite problem (docs/patches.md, "Given edges").

`solve_forces_on_contacts` solves it directly for few unknowns, by preconditioned conjugate gradients with fast sums
for many: 10 to 30 steps to eight digits for 30 to 27 000 contacts. `contacts` and `gaps` define the two kinds;
`moved_expansion` is the end of "Moves of edges".
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy  # its modules are imported on first use, a tenth of a second each

from weier.kernels.arrays import Array, Indices
from weier.kernels.jit import kernel
from weier.methods.errors import ConvergenceError
from weier.methods.patches.kind import Kind, KindNumbers, numbers_of
from weier.methods.patches.pair_sums import MAX_DIRECT, PairMatrix, make_pair_matrix, pair_sums, potential
from weier.methods.patches.rule import (
    Table,
    add_self_influence,
    add_self_influence_blocks,
    expand_forces,
    forces_from_expansion,
    place_nodes,
    self_influence_tables,
)
from weier.methods.patches.segments import SegmentArrays, Segments
from weier.methods.punches import Inverse, solve_forces
from weier.theory.halfplane import replace_by_influence

MAX_STEPS = 300  # steps of conjugate gradients; 10 to 30 are usual


class Punches(NamedTuple):
    """Contacts or gaps with given edges, and the influence of forces at their nodes on each other.

    segments : in order round the period; only the number of their nodes is used
    gap : distance from the right edge of each segment to the next segment, in lambda_0, shape (segments,)
    nodes : result of `place_nodes`, shape (4, nodes)
    period : L, in lambda_0
    kind : `CONTACTS` or `GAPS`
    tables, matrix : tables of self-influences and of their inverses, and the kernel between all nodes, for conjugate
        gradients; None for a direct solution
    start : forces at the nodes from which conjugate gradients start; 0 if empty
    """

    segments: Segments
    gap: Array
    nodes: Table
    period: float
    kind: Kind
    tables: tuple[Array, Array] | None = None
    matrix: PairMatrix | None = None
    start: Array = np.empty(0)

    @property
    def offset(self) -> Array:
        """The distance of each node from the middle of its segment, in lambda_0, shape (nodes,)."""
        return self.nodes[0]

    @property
    def left(self) -> Array:
        """The factors of the nodes in the self-influences, shape (nodes,)."""
        return self.nodes[1]

    def at_nodes(self, at_segments: Array) -> Array:
        """Return a value of each segment at its nodes, shape (nodes,)."""
        return np.repeat(at_segments, self.segments.node_count)


class Forces(NamedTuple):
    """Forces that solve the equations on given edges.

    force : f at the nodes, in p_0* lambda_0 or, for gaps, g_0 lambda_0
    plane : the mean gap relative to the datum of the forcing, in g_0
    residual : residual of the equations, as a height, in g_0
    steps : number of steps of conjugate gradients
    tangent : derivatives of force and plane with respect to the mean pressure on fixed edges, if known
    """

    force: Array
    plane: float
    residual: float = 0.0
    steps: int = 0
    tangent: tuple[Array, float] | None = None


def make_punches(segments: Segments, period: float, kind: Kind, most: int | None = None) -> Punches:
    """Return the problem on segments, with fast sums for more than `most` unknowns.

    ConvergenceError is raised if two of them overlap.
    """
    gap, nodes, is_apart = place_nodes(segments.first_node, *segments.extent, period, kind.shift, kind.is_slope)
    _check_apart(is_apart)
    punches = Punches(segments, gap, nodes, period, kind)
    if nodes.shape[1] <= (MAX_DIRECT if most is None else most):
        return punches
    matrix = make_pair_matrix(nodes[3], punches.offset, period, kind.is_slope)
    own, inverse = (self_influence_tables(segments.first_node, kind, is_inverse) for is_inverse in (False, True))
    return punches._replace(tables=(own, inverse), matrix=matrix)


def _check_apart(is_apart: bool) -> None:
    """Raise ConvergenceError if segments overlap, or their equations have no digit."""
    if not is_apart:
        raise ConvergenceError(
            "two contacts or gaps overlap, or are closer to each other than floating point resolves"
        )


@kernel
def _equations(
    segments: SegmentArrays, nodes: Table, table: Array, forcing: Array, period: float, numbers: KindNumbers
) -> tuple[Table, Table]:
    """Return the upper triangle of the influence of all forces at all nodes, and two rows of right sides.

    table : result of `self_influence_tables`
    """
    (origin, centre, _, first), (offset, left, diagonal, _), n = segments, nodes, forcing.size
    is_slope, shift, _, hankel_sign, factor, more, _, _ = numbers
    matrix, right = np.empty((n, n)), np.empty((2, n))
    for i in range(centre.size):
        for a in range(first[i], first[i + 1]):
            row, right[0, a], right[1, a] = matrix[a], forcing[a], 1.0
            for j in range(i, centre.size):
                apart = origin[i] - origin[j] + (centre[i] - centre[j])
                for b in range(a if i == j else first[j], first[j + 1]):
                    row[b] = apart + (offset[a] - offset[b])
            replace_by_influence(row[a:], period, is_slope)
    add_self_influence_blocks(first, left, diagonal, table, shift, hankel_sign, matrix)
    for a in range(n):
        row = matrix[a]
        for b in range(a, n):
            row[b] = factor * row[b] + more
    return matrix, right


@kernel
def _close(force: Table, load: float, period: float, numbers: KindNumbers) -> tuple[float, float]:
    """Turn the solutions for the forcing and for 1 into forces and their increments; return both planes.

    A uniform displacement closes the balance of forces on contacts; gaps carry no load.
    """
    (is_slope, _, _, _, _, offset, _, _), total, of_even = numbers, 0.0, 0.0
    for i in range(force.shape[1]):
        total += force[0, i]
        of_even += force[1, i]
    if is_slope:
        return total / period, of_even / period
    shift, increment = (load * period - total) / of_even, period / of_even
    for i in range(force.shape[1]):
        force[0, i] += shift * force[1, i]
        force[1, i] *= increment
    return offset * load * period - shift, offset * period - increment


def displacement(punches: Punches, force: Array) -> Array:
    """Return the effect of the forces at the nodes: a displacement, in g_0, or a pressure, in p_0*."""
    assert punches.tables is not None
    assert punches.matrix is not None
    kind, total = punches.kind, pair_sums(punches.matrix, force)
    total += punches.nodes[2] * force
    rule = punches.segments.first_node, punches.tables[0], kind.shift, kind.hankel_sign
    add_self_influence(*rule, punches.left, force, total)
    return np.asarray(kind.factor(punches.period) * total)


def _precondition(punches: Punches, inverse: Inverse | None, residual: Array) -> Array:
    """Apply the preconditioner: segments interact as flat punches, or not at all."""
    assert punches.tables is not None
    segments, kind, force = punches.segments, punches.kind, np.zeros(residual.size)
    rule = segments.first_node, punches.tables[1], kind.shift, kind.hankel_sign
    add_self_influence(*rule, 1 / punches.left, residual, force)
    force /= -kind.factor(punches.period)
    if inverse is not None:
        mean = np.add.reduceat(residual, segments.first_node[:-1]) / segments.node_count
        force += punches.at_nodes(solve_forces(inverse, mean) / segments.node_count)
    return force


def solve_forces_on_contacts(
    punches: Punches, forcing: Array, load: float, residual: float, reduction: float = 0.0
) -> Forces:
    """Solve z - A f = d and sum f = p L for f and d; for gaps, C f = forcing.

    The forcing, at the nodes, is the height z, in g_0, or the tension of full contact, in p_0*. Conjugate gradients
    end at a residual, as a height, in g_0, or at `reduction` times the initial one.
    """
    if punches.matrix is not None:
        return _solve_iteratively(punches, forcing, load, residual, reduction)
    segments, kind, period = punches.segments, punches.kind, punches.period
    table, numbers = self_influence_tables(segments.first_node, kind, False), numbers_of(kind, period)
    matrix, right = _equations(segments.arrays, punches.nodes, table, forcing, period, numbers)
    _, found, failed = scipy.linalg.lapack.dposv(matrix.T, right.T, lower=1, overwrite_a=1, overwrite_b=1)
    _check_apart(not failed)
    force = found.T
    plane, increment = _close(force, load, period, numbers)
    return Forces(force[0], plane, tangent=(force[1], increment))


def solve_tangent(punches: Punches, forces: Forces, reduction: float) -> Forces:
    """Return the derivative of a solution with respect to the mean pressure, on fixed edges."""
    if forces.tangent is not None:
        return Forces(*forces.tangent)
    forcing = np.full(punches.offset.size, punches.kind.increment)
    return _solve_iteratively(punches._replace(start=np.empty(0)), forcing, 1.0, 0.0, reduction)


def _solve_iteratively(punches: Punches, forcing: Array, load: float, least: float, reduction: float) -> Forces:
    """Solve by conjugate gradients with fast sums, scaled by the load, since products would underflow."""
    kind, segments, unit = punches.kind, punches.segments, load * punches.period
    forcing, least, none = forcing / unit, least / unit, np.zeros(forcing.size)
    force = punches.start / unit if punches.start.size > 0 else none
    inverse = kind.invert_punches(segments.half_width, segments.middle, punches.period)
    radius = punches.at_nodes(segments.half_width)
    even, per_force = none, 0.0  # M^-1 1, and the displacement by a multiple of it with the sum 1
    if inverse is not None:
        even = _precondition(punches, inverse, np.ones(forcing.size))
        per_force = 1 / float(even.sum())
        force = force + even * ((1 - force.sum()) * per_force)
    residual = forcing - displacement(punches, force)
    plane, energy, direction, enough, size = 0.0, 1.0, none, -1.0, np.inf
    for step in range(MAX_STEPS + 1):
        change = _precondition(punches, inverse, residual)
        shift = float(change.sum()) * per_force
        change -= shift * even
        residual -= shift
        plane += shift
        size = float(np.abs(kind.as_height(residual, radius)).max())
        enough = max(least, reduction * size) if enough < 0 else enough
        if size <= enough or step == MAX_STEPS:
            break
        last_energy, energy = energy, float(residual @ change)
        direction = change + (energy / last_energy if step > 0 else 0.0) * direction
        product = displacement(punches, direction)
        length = energy / float(direction @ product)
        force = force + length * direction
        residual -= length * product
    return Forces(unit * force, unit * kind.plane_of(float(force.sum()), plane, punches.period), unit * size, step)


def force_field(punches: Punches, force: Array, x: Array) -> Array:
    """Return the effect of the forces at ascending positions: a displacement, in g_0, or a pressure, in p_0*."""
    middle, none = punches.nodes[3], np.zeros(x.size)
    total = potential(middle, punches.offset, force, none, x, punches.period, punches.kind.is_slope)
    total *= punches.kind.factor(punches.period)
    return total


def expansion(punches: Punches, force: Array) -> Array:
    """Return the coefficients of psi in T_k, segment by segment, shape (nodes,)."""
    segments, kind, period = punches.segments, punches.kind, punches.period
    nodes = segments.first_node, segments.half_width, punches.left
    return expand_forces(*nodes, force, period, kind.shift, kind.derivative)


@kernel
def regular_part(first_node: Indices, b: Array) -> Array:
    """Return coefficients in U_k of phi, where psi = (1-t^2) phi plus a linear function, contact by contact."""
    a = np.zeros(b.size)
    for j in range(first_node.size - 1):
        for k in range(first_node[j + 1] - 3, first_node[j] - 1, -1):
            a[k] = a[k + 2] - 2 * b[k + 2]
    return a


@kernel
def vanishing_at_edges(first_node: Indices, b: Array, power: int) -> tuple[Array, Array]:
    """Return coefficients of psi corrected so that psi, at rounding level at the edges, vanishes there.

    The corrections are proportional to the variance of rounding, k^power, and preserve b_0, and so the force. Return
    the coefficients of the regular part as well.
    """
    changed = b.copy()
    for j in range(first_node.size - 1):
        for parity in range(2):
            at_edge, total = 0.0, 0.0
            for k in range(parity, first_node[j + 1] - first_node[j], 2):
                at_edge, total = at_edge + b[first_node[j] + k], total + (k**power if k > 0 else 0)
            for k in range(2 - parity, first_node[j + 1] - first_node[j], 2):
                changed[first_node[j] + k] -= at_edge * k**power / total
    return changed, regular_part(first_node, changed)


@kernel
def moved_expansion(
    first_node: Indices, r: Array, b: Array, a: Array, centre_shift: Array, growth: Array
) -> tuple[Array, Array]:
    """Return the coefficients of psi when segments have moved, and of its regular part."""
    moved = b.copy()
    for j in range(r.size):
        first, last = first_node[j], first_node[j + 1]
        shift, slope = centre_shift[j] / r[j], growth[j] / r[j]
        for k in range(first + 1, last):
            motion = -(k - first) * a[k - 1]
            moved[k] += shift * motion
            moved[k - 1] += 0.5 * slope * motion
            if k + 1 < last:
                moved[k + 1] += 0.5 * slope * motion
    return moved, regular_part(first_node, moved)


def transfer_forces(segments: Segments, b: Array, origin: Indices, new: Punches) -> Array:
    """Return the forces on new segments from those on their old segments `origin`; 0 if that is -1."""
    nodes = new.segments.first_node, new.segments.half_width, new.left
    return forces_from_expansion(
        *nodes, b, segments.first_node, origin, new.period, new.kind.shift, new.kind.derivative
    )
