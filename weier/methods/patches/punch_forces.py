"""The forces between punches: the inverse of their matrix of influence, in the time O(n log^2 n) for n punches.

The unit force displaces a flat punch of half-width r by -2 ln(pi r/L), and moves the surface at the centre of
another by -2 ln|2 sin(pi d/L)|. Halve the row of punches again and again: the influence of one half on the other is a
matrix of low rank, since the logarithm is smooth but for few neighbours. So the inverse follows from those of the two
halves by Woodbury's formula. It need not be exact, because it serves conjugate gradients as a part of their
preconditioner.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy  # its modules load when they are first used: a tenth of a second each, which few jobs need
from numpy.typing import NDArray

from weier.kernels.arrays import Array
from weier.kernels.jit import kernel

Matrix = NDArray[np.float64]
Factors = tuple[Matrix, NDArray[np.int32]]

MAX_DENSE = 128  # punches whose matrix is factorised as it is
RANK_TOLERANCE = 1e-6  # of the influence of one half on the other; looser ones take more steps of conjugate gradients
MAX_RANK = 60  # 20 to 30 reach that tolerance for 15 000 punches


class Dense(NamedTuple):
    """The factors of the matrix of a few punches."""

    factors: Factors


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


Inverse = Dense | Halves


def invert_punches(centre: Array, half_width: Array, period: float) -> Inverse:
    """The inverse of the influence of punches in order round the period."""
    if centre.size <= MAX_DENSE:
        return Dense(_factorise(_influence(centre, half_width, period)))
    split = centre.size // 2
    first = invert_punches(centre[:split], half_width[:split], period)
    second = invert_punches(centre[split:], half_width[split:], period)
    U, V = _low_rank(centre[:split], centre[split:], period)
    solved_U, solved_V, rank = solve_forces(first, U), solve_forces(second, V), U.shape[1]
    coupling = np.eye(2 * rank)
    coupling[:rank, rank:], coupling[rank:, :rank] = U.T @ solved_U, V.T @ solved_V
    return Halves(split, first, second, (U, V), (solved_U, solved_V), _factorise(coupling))


def solve_forces(inverse: Inverse, displacement: NDArray[np.float64]) -> NDArray[np.float64]:
    """The forces that displace the punches by so much, shape (punches,) or (punches, columns)."""
    if isinstance(inverse, Dense):
        return np.asarray(scipy.linalg.lapack.dgetrs(*inverse.factors, displacement)[0])
    first = solve_forces(inverse.first, displacement[: inverse.split])
    second = solve_forces(inverse.second, displacement[inverse.split :])
    (U, V), (solved_U, solved_V), rank = inverse.low_rank, inverse.solved, inverse.low_rank[0].shape[1]
    exchange = scipy.linalg.lapack.dgetrs(*inverse.factors, np.concatenate([U.T @ first, V.T @ second]))[0]
    return np.concatenate([first - solved_U @ exchange[rank:], second - solved_V @ exchange[:rank]])


def _factorise(matrix: Matrix) -> Factors:
    lu, pivot, _ = scipy.linalg.lapack.dgetrf(matrix)
    return lu, pivot


def _influence(centre: Array, half_width: Array, period: float) -> Matrix:
    chord = np.abs(2 * np.sin(np.pi / period * (centre[:, None] - centre)))
    np.fill_diagonal(chord, np.pi / period * half_width)
    return -2 * np.log(chord)


@kernel
def _pair_influence(x: float, y: float, period: float) -> float:
    return -2 * np.log(abs(2 * np.sin(np.pi / period * (x - y))))


@kernel
def _low_rank(x: Array, y: Array, period: float) -> tuple[Matrix, Matrix]:
    """U and V with U V' = the influence of y on x, by adaptive cross approximation with partial pivoting."""
    most = min(MAX_RANK, x.size, y.size)
    U, V, used = np.zeros((most, x.size)), np.zeros((most, y.size)), np.zeros(x.size, np.bool_)
    row, rank, square = 0, 0, 0.0
    while rank < most:
        used[row] = True
        for j in range(y.size):
            V[rank, j] = _pair_influence(x[row], y[j], period)
        for k in range(rank):
            V[rank] -= U[k, row] * V[k]
        column = int(np.argmax(np.abs(V[rank])))
        pivot = V[rank, column]
        if pivot == 0:
            break
        for i in range(x.size):
            U[rank, i] = _pair_influence(x[i], y[column], period)
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
