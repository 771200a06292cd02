"""Approximate forces on flat punches from their displacements, in the time O(punches).

Part of a preconditioner (docs/patches.md, "Given edges"), so that they need not be exact.

A unit force displaces a flat punch of half-width r by -2 ln(pi r/L), and moves the surface at the centre of another
by -2 ln|2 sin(pi d/L)|. This matrix is interpreted as the covariance of random displacements. Every second
displacement is predicted from its nearest neighbours among the others, with a nearly independent error, and so on
recursively for the others, until few remain (Vecchia's approximation of the inverse: Schaefer, Katzfuss and Owhadi,
SIAM J. Sci. Comput. 43, 2021, A2019).
"""

from __future__ import annotations

import numpy as np

from weier.kernels.arrays import Array, Indices
from weier.kernels.jit import kernel
from weier.theory.halfplane import displacement_at_distance

Inverse = tuple[Indices, Indices, Array]  # start of each row of W, its punches, and their entries

NEIGHBOURS = 8  # neighbours on either side of a punch; `python -m benchmarks tuning` measures their cost
# limit on the number of coarsest punches, each conditioned on all previous ones; more than half of this number
# remain, so that the neighbours of a finer punch are distinct, and their equations fit into the same matrix
MAX_COARSEST = 4 * NEIGHBOURS
# added to all displacements to make the matrix positive definite: above 2 ln 2, the largest lift by a unit force;
# forces of sum 0 do not depend on it
OFFSET = 2.0


@kernel
def invert_punches(centre: Array, compliance: Array, period: float) -> Inverse:
    """Return the approximate inverse W' W of the mutual influence of punches in increasing order.

    The rows of W are the punches from coarse to fine. With the influence as a covariance, a row is the deviation of
    one displacement from its mean for given displacements of its neighbours among the coarser, over its standard
    deviation. If the matrix is not positive definite, W is NaN.
    """
    n, stride, row = centre.size, 1, 0
    while n > stride * MAX_COARSEST:
        stride *= 2
    start, most = np.empty(n + 1, np.int64), MAX_COARSEST**2 + (2 * NEIGHBOURS + 1) * n
    start[0] = 0
    member, entry = np.empty(most, np.int64), np.empty(most)
    for last in range(0, n, stride):
        start[row + 1] = start[row] + last // stride + 1
        for i in range(last // stride + 1):
            member[start[row] + i] = i * stride
        row += 1
    while stride > 1:
        coarser = (n - 1) // stride + 1
        for new in range(stride // 2, n, stride):
            start[row + 1] = start[row] + 2 * NEIGHBOURS + 1
            for i in range(2 * NEIGHBOURS):
                member[start[row] + i] = (new // stride + 1 - NEIGHBOURS + i) % coarser * stride
            member[start[row + 1] - 1] = new
            row += 1
        stride //= 2
    factor = np.empty((MAX_COARSEST, MAX_COARSEST))
    for row in range(n):
        here, entries = member[start[row] : start[row + 1]], entry[start[row] : start[row + 1]]
        known = row if here.size == row + 1 else 0  # The factor grows by one row per coarsest punch.
        _fill_row(centre, compliance, here, period, known, factor, entries)
    return start, member[: start[n]], entry[: start[n]]


@kernel
def _fill_row(
    x: Array, compliance: Array, which: Indices, period: float, known: int, factor: Array, entry: Array
) -> None:
    """Compute the last row of the inverse Cholesky factor of the mutual influence of punches.

    The first `known` rows of the factor are given; the others are written.
    """
    n = which.size
    for i in range(known, n):
        for j in range(i + 1):
            a, b = which[i], which[j]
            rest = OFFSET + (compliance[a] if i == j else displacement_at_distance(x[a] - x[b], period))
            for k in range(j):
                rest -= factor[i, k] * factor[j, k]
            factor[i, j] = rest / factor[j, j] if j < i else np.sqrt(rest)
    for j in range(n - 1, -1, -1):
        rest = 1.0 if j == n - 1 else 0.0
        for i in range(j + 1, n):
            rest -= entry[i] * factor[i, j]
        entry[j] = rest / factor[j, j]


@kernel
def solve_forces(inverse: Inverse, displacement: Array) -> Array:
    """Return the approximate forces on the punches from their displacements, shape (punches,)."""
    start, member, entry = inverse
    force = np.zeros(displacement.size)
    for row in range(start.size - 1):
        deviation = 0.0
        for i in range(start[row], start[row + 1]):
            deviation += entry[i] * displacement[member[i]]
        for i in range(start[row], start[row + 1]):
            force[member[i]] += entry[i] * deviation
    return force
