"""Fast multipole method on a line: sums over pairs of points in O(points) (docs/patches.md, "Sums over all nodes").

The kernel is ln|2 sin(pi (x_a - x_b)/L)| or, for dipoles, 1/sin^2(pi (x_a - x_b)/L). Forces are
carried up a binary tree to the Chebyshev points of each interval (`_moments`), between well-separated intervals by
the kernel (`pair_sums`, `potential`), and down to the points (`_add_local_fields`); near pairs are summed directly
(Fong and Darve, J. Comput. Phys. 228, 2009, 8712). The matrices are kept for all steps of the conjugate gradients.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Indices
from weier.kernels.jit import in_any_order, kernel
from weier.methods.chebyshev import gauss_rule
from weier.theory.halfplane import replace_by_influence

Pairs = NDArray[np.int64]  # shape (pairs, 2)
Blocks = NDArray[np.float64]  # one small matrix each, shape (..., ORDER, ORDER)

# A singularity one width away from an interval is at t = 3 in its coordinate (-1..1), on the Bernstein ellipse of 3 +
# sqrt(8) = 5.83. The error relative to the smooth part of ln is at most 5.83^-17 = 1e-13. With 15 points (3e-12),
# residuals of 2e-12 g_0 remained on periods of 100 lambda_0.
ORDER = 17
POINT = gauss_rule(ORDER, second_kind=False).node  # the zeros of T_ORDER, -cos(theta_q)
BARYCENTRIC = (-1.0) ** np.arange(ORDER) * np.sqrt((1 - POINT) * (1 + POINT))  # (-1)^q sin(theta_q)
# largest number of points of a leaf, a compromise between near and far pairs (`python -m benchmarks tuning`)
LEAF_POINTS = 40
# largest number of sources without a tree, and of unknowns of a direct solution: with 400 it takes 0.5 (contacts) and
# 1.0 (gaps) times as long as conjugate gradients, with 640 1.2 and 2.4 times (`python -m benchmarks direct_solution`)
MAX_DIRECT = 400


class Tree(NamedTuple):
    """Points on a line in a binary tree, whose node i has the children 2 i + 1 and 2 i + 2.

    position : positions of the points, ascending, within one period, shape (points,)
    origin, offset : parts of the position; differences of points with the same origin lose no digits
    depth : common depth of all leaves
    low, high : first and last point of each node, shape (nodes,)
    to_parent : the interpolation from a parent's Chebyshev points to the node's, shape (nodes, ORDER, ORDER)
    at_points : the interpolation from a leaf's Chebyshev points to its points, shape (points, ORDER)
    """

    position: Array
    origin: Array
    offset: Array
    depth: int
    low: Array
    high: Array
    to_parent: Blocks
    at_points: NDArray[np.float64]


class PairMatrix(NamedTuple):
    """The matrix of the kernel between all points, with 0 on its diagonal, in parts.

    far, near : unordered pairs of nodes that are far from each other, and of leaves that are not
    far_block : the kernel between the Chebyshev points of far nodes, row by row, shape (pairs, ORDER^2)
    near_block, near_start : the kernel between the points of near leaves, row by row, and where each pair begins
    """

    tree: Tree
    far: Pairs
    near: Pairs
    far_block: NDArray[np.float64]
    near_block: Array
    near_start: Indices


@kernel
def _interpolate(t: float, weight: Array) -> None:
    """Compute the weights of values at the Chebyshev points in the polynomial at t: the barycentric formula."""
    total = 0.0
    for q in range(ORDER):
        weight[q] = BARYCENTRIC[q] / (t - POINT[q])
    for q in range(ORDER):
        total += weight[q]
        if t == POINT[q]:
            for s in range(ORDER):
                weight[s] = 0.0
            weight[q] = total = 1.0
            break
    for q in range(ORDER):
        weight[q] /= total


@kernel
def leaf_points(points: int, depth: int, node: int) -> tuple[int, int]:
    """Return the first point of a leaf, and the one after its last, in a tree of these points and this depth."""
    leaf = node - _first_leaf(depth)
    return (points * leaf) >> depth, (points * (leaf + 1)) >> depth


@kernel
def _first_leaf(depth: int) -> int:
    return (1 << depth) - 1


@kernel
def interval(low: float, high: float) -> tuple[float, float]:
    """Return middle and half-width of a node."""
    return 0.5 * (low + high), max(0.5 * (high - low), 1e-300)


def make_tree(origin: Array, offset: Array) -> Tree:
    """Return the tree of points at origin + offset, which are ascending."""
    position, depth = origin + offset, 0
    while (position.size >> depth) > LEAF_POINTS:
        depth += 1
    starts = [(position.size * np.arange((1 << level) + 1)) >> level for level in range(depth + 1)]
    low = position[np.concatenate([start[:-1] for start in starts])]
    high = position[np.concatenate([start[1:] - 1 for start in starts])]
    to_parent, at_points = np.empty((low.size, ORDER, ORDER)), np.empty((position.size, ORDER))
    tree = Tree(position, origin, offset, depth, low, high, to_parent, at_points)
    _fill_interpolations(tree)
    return tree


@kernel
def _fill_interpolations(tree: Tree) -> None:
    for node in range(tree.low.size):
        middle, half = interval(tree.low[node], tree.high[node])
        if node > 0:
            parent = (node - 1) >> 1
            parent_middle, parent_half = interval(tree.low[parent], tree.high[parent])
            for q in range(ORDER):
                t = ((middle - parent_middle) + half * POINT[q]) / parent_half
                _interpolate(t, tree.to_parent[node, q])
        if node >= _first_leaf(tree.depth):
            start, end = leaf_points(tree.position.size, tree.depth, node)
            for a in range(start, end):
                _interpolate((tree.position[a] - middle) / half, tree.at_points[a])


@kernel
def _far_apart(low: float, high: float, other_low: float, other_high: float, period: float) -> bool:
    """Return whether the distance of two nodes, in the period, is at least the width of the wider one."""
    between = max(other_low - high, low - other_high)
    around = min(low + period - other_high, other_low + period - high)
    distance, width = min(between, around), max(high - low, other_high - other_low)
    return distance > 0 and distance >= width


@kernel
def pair_nodes(one: Tree, other: Tree, period: float, same: bool) -> tuple[Pairs, Pairs]:
    """List far and near pairs that hold each pair of points once; unordered within a single tree.

    A first pass counts them, a second one writes them. The stack grows by at most two pairs per level of a tree.
    """
    stack, far_count, near_count = np.empty((2 * (one.depth + other.depth) + 3, 2), np.int64), 0, 0
    for is_written in range(2):
        far, near, last = np.empty((far_count, 2), np.int64), np.empty((near_count, 2), np.int64), 0
        stack[0, 0] = stack[0, 1] = far_count = near_count = 0
        while last >= 0:
            a, b = stack[last, 0], stack[last, 1]
            a_ends, b_ends, is_same = a >= _first_leaf(one.depth), b >= _first_leaf(other.depth), same and a == b
            low, high, other_low, other_high = one.low[a], one.high[a], other.low[b], other.high[b]
            last -= 1
            if not is_same and _far_apart(low, high, other_low, other_high, period):
                if is_written:
                    far[far_count, 0], far[far_count, 1] = a, b
                far_count += 1
            elif a_ends and b_ends:
                if is_written:
                    near[near_count, 0], near[near_count, 1] = a, b
                near_count += 1
            else:
                is_wider = not a_ends and high - low >= other_high - other_low
                divides_a = is_same or b_ends or is_wider
                for child in range(1, 3):
                    last += 1
                    stack[last, 0] = 2 * a + child if divides_a else a
                    stack[last, 1] = 2 * b + child if is_same or not divides_a else b
                if is_same:
                    last += 1
                    stack[last, 0], stack[last, 1] = 2 * a + 1, 2 * a + 2
    return far, near


@kernel
def _chebyshev_points(low: float, high: float) -> tuple[Array, Array]:
    """Return origins and offsets of the Chebyshev points of a node."""
    origin, offset, (middle, half) = np.empty(ORDER), np.empty(ORDER), interval(low, high)
    for q in range(ORDER):
        origin[q], offset[q] = middle, half * POINT[q]
    return origin, offset


@kernel
def _fill_block(
    origin: Array, offset: Array, origins: Array, offsets: Array, period: float, dipoles: bool, block: Array
) -> None:
    """Compute the kernel between two sets of points, row by row."""
    width = origins.size
    for i in range(origin.size):
        row = block[i * width : (i + 1) * width]
        for j in range(width):  # the compiler vectorises operations on whole arrays
            row[j] = (origin[i] - origins[j]) + (offset[i] - offsets[j])
    replace_by_influence(block, period, dipoles)


def make_pair_matrix(origin: Array, offset: Array, period: float, dipoles: bool) -> PairMatrix:
    """Return the matrix for points at origin + offset, ascending and within one period."""
    tree = make_tree(origin, offset)
    far, near = pair_nodes(tree, tree, period, True)
    return PairMatrix(tree, far, near, *_make_blocks(tree, far, near, period, dipoles))


@kernel
def _make_blocks(
    tree: Tree, far: Pairs, near: Pairs, period: float, dipoles: bool
) -> tuple[NDArray[np.float64], Array, Indices]:
    """Return the fields of `PairMatrix` behind its pairs."""
    far_block = np.empty((far.shape[0], ORDER**2))
    low, high, points, depth = tree.low, tree.high, tree.position.size, tree.depth
    for pair in range(far.shape[0]):
        a, b = far[pair, 0], far[pair, 1]
        one, other = _chebyshev_points(low[a], high[a]), _chebyshev_points(low[b], high[b])
        _fill_block(*one, *other, period, dipoles, far_block[pair])
    near_start = np.empty(near.shape[0] + 1, np.int64)
    near_start[0] = 0
    for pair in range(near.shape[0]):
        start, end = leaf_points(points, depth, near[pair, 0])
        first, last = leaf_points(points, depth, near[pair, 1])
        near_start[pair + 1] = near_start[pair] + (end - start) * (last - first)
    near_block = np.empty(near_start[-1])
    for pair in range(near.shape[0]):
        start, end = leaf_points(points, depth, near[pair, 0])
        first, last = leaf_points(points, depth, near[pair, 1])
        origin, offset = tree.origin[start:end], tree.offset[start:end]
        block = near_block[near_start[pair] : near_start[pair + 1]]
        _fill_block(origin, offset, tree.origin[first:last], tree.offset[first:last], period, dipoles, block)
    return far_block, near_block, near_start


@kernel
def _moments(tree: Tree, f: Array) -> NDArray[np.float64]:
    """Return equivalent forces at the Chebyshev points of each node, shape (nodes, ORDER)."""
    moment = np.zeros((tree.low.size, ORDER))
    # Within a level the nodes are passed forwards, since memory is read three times as slowly backwards.
    for level in range(tree.depth, -1, -1):
        for node in range((1 << level) - 1, (1 << (level + 1)) - 1):
            here = moment[node]
            if level == tree.depth:
                start, end = leaf_points(tree.position.size, tree.depth, node)
                for a in range(start, end):
                    for q in range(ORDER):
                        here[q] += tree.at_points[a, q] * f[a]
            if level > 0:
                parent = moment[(node - 1) >> 1]
                for q in range(ORDER):
                    for s in range(ORDER):
                        parent[s] += tree.to_parent[node, q, s] * here[q]
    return moment


@kernel
def _add_local_fields(tree: Tree, field: NDArray[np.float64], total: Array) -> None:
    """Carry the far field from the Chebyshev points of all nodes to the points."""
    for node in range(tree.low.size):
        here = field[node]
        if node > 0:
            parent = field[(node - 1) >> 1]
            for q in range(ORDER):
                for s in range(ORDER):
                    here[q] += tree.to_parent[node, q, s] * parent[s]
        if node >= _first_leaf(tree.depth):
            start, end = leaf_points(tree.position.size, tree.depth, node)
            for a in range(start, end):
                for q in range(ORDER):
                    total[a] += tree.at_points[a, q] * here[q]


@in_any_order
def _add_block(block: Array, f_of_rows: Array, f_of_columns: Array, to_rows: Array, to_columns: Array) -> None:
    """Add a block, given row by row, times f of its columns to the totals of its rows, and its transpose likewise."""
    columns = to_columns.size
    for i in range(to_rows.size):
        row, row_sum = block[i * columns : (i + 1) * columns], 0.0
        for j in range(columns):
            row_sum += row[j] * f_of_columns[j]
            to_columns[j] += row[j] * f_of_rows[i]
        to_rows[i] += row_sum


@kernel
def pair_sums(matrix: PairMatrix, f: Array) -> Array:
    """Return the sum over all other points b of f_b times the kernel between a and b, shape (points,)."""
    tree, total, none = matrix.tree, np.zeros(f.size), np.zeros(LEAF_POINTS + 1)
    moment = _moments(tree, f)
    field = np.zeros((tree.low.size, ORDER))
    for pair in range(matrix.far.shape[0]):
        a, b = matrix.far[pair, 0], matrix.far[pair, 1]
        _add_block(matrix.far_block[pair], moment[a], moment[b], field[a], field[b])
    for pair in range(matrix.near.shape[0]):
        start, end = leaf_points(f.size, tree.depth, matrix.near[pair, 0])
        first, last = leaf_points(f.size, tree.depth, matrix.near[pair, 1])
        block = matrix.near_block[matrix.near_start[pair] : matrix.near_start[pair + 1]]
        # The block of a leaf with itself contains each pair twice.
        row_forces = f[start:end] if start != first else none
        _add_block(block, row_forces, f[first:last], total[start:end], total[first:last])
    _add_local_fields(tree, field, total)
    return total


def potential(
    origin: Array, offset: Array, f: Array, at: Array, at_offset: Array, period: float, dipoles: bool
) -> Array:
    """Return the sum of f times the kernel over the points origin + offset, at points at + at_offset.

    Both are ascending and within one period.
    """
    if f.size <= MAX_DIRECT or at.size <= LEAF_POINTS:
        return _direct_sums(origin, offset, f, at, at_offset, period, dipoles)
    source, target = make_tree(origin, offset), make_tree(at, at_offset)
    total = _potential(source, f, target, *pair_nodes(target, source, period, False), period, dipoles)
    # Direct sums at some points show if fast sums are wrong alike in the solution and in its residual.
    some = np.linspace(0, at.size - 1, LEAF_POINTS).astype(np.int64)
    total[some] = _direct_sums(origin, offset, f, at[some], at_offset[some], period, dipoles)
    return total


@kernel
def _direct_sums(
    origin: Array, offset: Array, f: Array, at: Array, at_offset: Array, period: float, dipoles: bool
) -> Array:
    """Return the sums of `potential`, in the same order of differences as near pairs."""
    total, row = np.zeros(at.size), np.empty(at.size)
    for s in range(f.size):
        _fill_block(origin[s : s + 1], offset[s : s + 1], at, at_offset, period, dipoles, row)
        for i in range(at.size):
            total[i] += f[s] * row[i]
    return total


@kernel
def _potential(source: Tree, f: Array, target: Tree, far: Pairs, near: Pairs, period: float, dipoles: bool) -> Array:
    """Return the sums of `potential`, from the pairs of nodes of the target and of the source."""
    moment, field, total = _moments(source, f), np.zeros((target.low.size, ORDER)), np.zeros(target.position.size)
    block = np.empty(ORDER**2)
    for pair in range(far.shape[0]):
        to, of = far[pair, 0], far[pair, 1]
        one = _chebyshev_points(source.low[of], source.high[of])
        _fill_block(*one, *_chebyshev_points(target.low[to], target.high[to]), period, dipoles, block)
        for j in range(ORDER):
            for i in range(ORDER):
                field[to, i] += block[j * ORDER + i] * moment[of, j]
    near_block = np.empty((LEAF_POINTS + 1) ** 2)
    for pair in range(near.shape[0]):
        start, end = leaf_points(total.size, target.depth, near[pair, 0])
        first, last = leaf_points(f.size, source.depth, near[pair, 1])
        block = near_block[: (last - first) * (end - start)]
        origin, offset = source.origin[first:last], source.offset[first:last]
        _fill_block(origin, offset, target.origin[start:end], target.offset[start:end], period, dipoles, block)
        for s in range(first, last):
            for a in range(start, end):
                total[a] += block[(s - first) * (end - start) + a - start] * f[s]
    _add_local_fields(target, field, total)
    return total
