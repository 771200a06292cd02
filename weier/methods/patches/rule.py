"""Segments with given edges in arrays: their nodes, their influences on themselves, and expansions.

The density on a segment is psi(t)/sqrt(1-t^2) in its coordinate t, -1..1, with psi = sum b_n T_n. It is known by the
forces f at its K nodes t_i = -cos(theta_i), theta_i = pi (2 i + shift)/(2 N), where N = K + shift - 1 and the shift
is 1 for contacts and 2 for gaps. The formulas are derived in docs/patches.md, "Given edges"; `contacts` and `gaps`
have the numbers in which the two differ.

The self-influence of a segment, minus the sum over all nodes, is a sum over n of cos(n theta_i) cos(n theta_j) or
of sin(n theta_i) sin(n theta_j), and so a function of theta_i - theta_j and of theta_i + theta_j:

    own_ij = left_i left_j [X(i - j) +- X(i + j + shift)],   i != j,

a Toeplitz and a Hankel matrix of one table X for each number of nodes. Its inverse has the same form, with 1/left;
for contacts, it is that of all but the mean.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Indices
from weier.kernels.jit import kernel
from weier.methods.patches.kind import Kind
from weier.methods.patches.surface import distances_between

Table = NDArray[np.float64]


@kernel
def _degree(n: int, r: float, period: float, derivative: int) -> float:
    """Return b_n over the sum of cos(n theta) f, or of its derivative with respect to pi x/L."""
    return (1 if n == 0 else 2) / (np.pi * r) * (-np.pi / period * n) ** derivative


@kernel
def _wave_table(N: int, derivative: int) -> Array:
    """Return cosines of the angles pi i/(2 N) of a whole turn, or sines, which lag by a quarter of a turn."""
    wave = np.empty(4 * N)
    for i in range(4 * N):
        wave[i] = np.cos(np.pi / (2 * N) * (i - N * derivative))
    return wave


@kernel
def place_nodes(
    first_node: Indices, origin: Array, centre: Array, r: Array, period: float, shift: int, is_slope: bool
) -> tuple[Array, Table, bool]:
    """Return the gap on the right of each segment, the nodes, and whether no two segments overlap.

    The nodes have rows: offset from the middle of the segment, `left`, and the entry on the diagonal of the
    self-influence in addition to X: for gaps, the rest of 1/sin^2 without its pole, 1/3, less 1/(4 sin^2 theta); and
    that middle.
    """
    nodes = np.empty((4, first_node[-1]))
    offset, left, diagonal, middle = nodes
    gap, is_apart = distances_between(origin, centre, r, period), True
    for j in range(r.size):
        is_apart = is_apart and r[j] > 0 and gap[j] > 0
        first, K = first_node[j], first_node[j + 1] - first_node[j]
        for i in range(K):
            angle, q = np.pi * (2 * i + shift) / (2 * (K + shift - 1)), first + i
            offset[q], middle[q], sine = -r[j] * np.cos(angle), origin[j] + centre[j], np.sin(angle)
            if is_slope:
                left[q] = period / (np.pi * r[j] * sine)
                diagonal[q] = 1 / 3 - (0.5 * left[q] / sine) ** 2
            else:
                left[q], diagonal[q] = 1.0, np.log(2 * np.pi / period * r[j] * sine)
    return gap, nodes, is_apart


def _cosine_sums(N: int, power: int) -> Array:
    """Return sum_n n^power cos(pi n q/N), n = 1..N-1, for the power 1 or -1 and q = 0..N.

    The first is N (N-1)/2 at q = 0, else -N/2 for even q and N/2 - 1/[2 sin^2(pi q/2N)] for odd q: the derivative of
    the sum of sin(n x), which is [cos(x/2) - cos((N - 1/2) x)]/[2 sin(x/2)].
    """
    if power < 0:
        return np.fft.rfft(np.append(0.0, 1 / np.arange(1.0, N)), 2 * N).real
    total = np.full(N + 1, -0.5 * N)
    total[0] = 0.5 * N * (N - 1)
    total[1::2] = 0.5 * N - 0.5 / np.sin(0.5 * np.pi / N * np.arange(1, N + 1, 2)) ** 2
    return total


@lru_cache(maxsize=256)
def _self_influence_table(K: int, kind: Kind, inverse: bool) -> Array:
    """Return the table X(q) of a segment with K nodes, optionally for the inverse, for q = 1 - K..2 K, shape (3 K,).

    X(q) is minus the sum, minus the kernel contained in the sum over all nodes, of the angle pi q/2N. For the inverse
    it is the sum of the reciprocal powers over N^2.
    """
    N = K + kind.shift - 1
    if inverse:
        X = _cosine_sums(N, -kind.power) / N**2
    else:
        X, sine = -_cosine_sums(N, kind.power), np.sin(0.5 * np.pi / N * np.arange(1, N + 1))
        X[1:] -= kind.self_kernel(sine)
    return np.concatenate([X[K - 1 : 0 : -1], X, X[-2::-1]])[: 3 * K]  # X is even about 0 and N


def self_influence_tables(first_node: Indices, kind: Kind, inverse: bool) -> Array:
    """Return the tables X of all segments; the table of segment j begins at entry 3 first_node[j]."""
    return _joined_tables(tuple((first_node[1:] - first_node[:-1]).tolist()), kind, inverse)


@lru_cache(maxsize=256)
def _joined_tables(node_counts: tuple[int, ...], kind: Kind, inverse: bool) -> Array:
    return np.concatenate([_self_influence_table(K, kind, inverse) for K in node_counts])


@kernel
def add_self_influence(
    first_node: Indices, table: Array, shift: int, hankel_sign: float, left: Array, f: Array, result: Array
) -> None:
    """Add the self-influence of each segment, or its inverse, times f."""
    for j in range(first_node.size - 1):
        first, K = first_node[j], first_node[j + 1] - first_node[j]
        total, zero = np.zeros(K), 3 * first + K - 1  # the entry X(0)
        for k in range(K):  # the compiler vectorises the loop along rows of both matrices
            g, toeplitz = left[first + k] * f[first + k], table[zero - k : zero - k + K]
            hankel = table[zero + k + shift : zero + k + shift + K]
            for i in range(K):
                total[i] += g * (toeplitz[i] + hankel_sign * hankel[i])
        for i in range(K):
            result[first + i] += left[first + i] * total[i]


@kernel
def add_self_influence_blocks(
    first_node: Indices, left: Array, diagonal: Array, table: Array, shift: int, hankel_sign: float, matrix: Table
) -> None:
    """Add the self-influence of each segment, from its table, to the upper triangle of a matrix of all nodes."""
    for j in range(first_node.size - 1):
        first, last = first_node[j], first_node[j + 1]
        zero = 2 * first + last - 1
        for i in range(first, last):
            for k in range(i, last):
                both = table[zero + k - i] + hankel_sign * table[zero + i + k - 2 * first + shift]
                matrix[i, k] += left[i] * left[k] * both
            matrix[i, i] += diagonal[i]


@kernel
def expand_forces(
    first_node: Indices, r: Array, left: Array, force: Array, period: float, shift: int, derivative: int
) -> Array:
    """Return the coefficients of psi in T_n on segments of these half-widths, shape (nodes,).

    b_n is proportional to the sum of W(n, i) left_i f_i, where W is cos or, for gaps, sin of n (pi - theta_i), from a
    table over a whole turn that keeps all digits.
    """
    b, wave = np.zeros(force.size), np.empty(0)
    for j in range(r.size):
        first, last = first_node[j], first_node[j + 1]
        N = last - first + shift - 1
        if wave.size != 4 * N:  # Neighbours often have the same.
            wave = _wave_table(N, derivative)
        for i in range(first, last):
            f, index, step = left[i] * force[i], 0, 2 * N - 2 * (i - first) - shift
            for n in range(first, last):
                b[n] += f * wave[index]
                index += step
                if index >= 4 * N:
                    index -= 4 * N
        for n in range(last - first):
            b[first + n] *= _degree(n, r[j], period, derivative)
    return b


@kernel
def forces_from_expansion(
    first_node: Indices,
    r: Array,
    left: Array,
    b: Array,
    old_first_node: Indices,
    origin: Indices,
    period: float,
    shift: int,
    derivative: int,
) -> Array:
    """Return the forces from expansions, each of the old segment `origin`, or 0 if that is -1.

    Coefficients of a degree too high for the nodes are omitted.
    """
    force, wave = np.zeros(first_node[-1]), np.empty(0)
    for j in range(r.size):
        if origin[j] < 0:
            continue
        first, last, old = first_node[j], first_node[j + 1], old_first_node[origin[j]]
        N = last - first + shift - 1
        if wave.size != 4 * N:
            wave = _wave_table(N, derivative)
        count = old_first_node[origin[j] + 1] - old
        if count > last - first:
            count = last - first
        for i in range(first, last):
            total, index, step = 0.0, 0, 2 * N - 2 * (i - first) - shift
            for n in range(count):
                degree = _degree(n, r[j], period, derivative)
                if degree != 0:
                    total += (1 if n == 0 else 2) * b[old + n] / degree * wave[index]
                index += step
                if index >= 4 * N:
                    index -= 4 * N
            force[i] = total / (left[i] * N)
    return force
