"""The discrete problem on segments with given edges: what contacts and gaps share, and in which numbers they differ.

The density on a segment is psi(t)/sqrt(1-t^2) in its coordinate t, -1..1, with psi = sum b_n T_n. It is known by the
forces f at its K nodes t_i = -cos(theta_i). `contacts` and `gaps` each have a kernel that fills in a `Rule`, and a
`Kind` with the rest: forcing, closure, and signs. The formulas are derived in docs/patches.md, "Given edges".

The influence of a segment on itself is a sum over n of cos(n theta_i) cos(n theta_j) or of sin(n theta_i)
sin(n theta_j), and so a function of theta_i - theta_j and of theta_i + theta_j, multiples of pi/N:

    own_ij = scale left_i left_j [X(i - j) + sign X(i + j + shift)],   i != j,

a Toeplitz and a Hankel matrix of one table X for each number of nodes. Its inverse has the same form.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.arrays import Array, Indices
from weier.kernels.jit import kernel
from weier.methods.patches.surface import CosineSeries

Table = NDArray[np.float64]


class Rule(NamedTuple):
    """The discrete problem on segments with given edges, in arrays for the kernels.

    The tables of segment j begin at the entries 2 first_node[j] + j of X and 4 first_node[j] of `wave`.

    offset : of each node from the middle of its segment, in lambda_0, shape (nodes,)
    left : factor of each node in the own influence and in the expansion, shape (nodes,)
    own : X of each segment
    own_scale : factor of the own influence, shape (segments,)
    at_node : what each node has on the diagonal beside X, shape (nodes,)
    inverse : the table of the inverse of the own influence on what it can invert: all of a gap, and all but the mean
        of a contact
    inverse_left, inverse_scale : the factors that go with it, the diagonal being that of the table
    wave : W(q), a cosine or a sine, of which W(n, i) = W(n step_i) is the value of degree n at node i
    step : of each node in `wave`, shape (nodes,)
    turn : period of each segment's `wave`, shape (segments,)
    degree_scale : b_n = degree_scale_n sum_i W(n, i) left_i f_i, shape (nodes,)
    angles : N of each segment, of which theta_i is a multiple of pi/N or of pi/(2N), shape (segments,)
    sign, shift : of the Hankel part
    factor : of all sums
    dipoles : whether the kernel is 1/sin^2 and not the logarithm
    """

    offset: Array
    left: Array
    own: Array
    own_scale: Array
    at_node: Array
    inverse: Array
    inverse_left: Array
    inverse_scale: Array
    wave: Array
    step: Indices
    turn: Indices
    degree_scale: Array
    angles: Indices
    sign: float
    shift: int
    factor: float
    dipoles: bool


class Kind(NamedTuple):
    """Contacts or gaps: the formulas in which they differ.

    dual : whether these are gaps
    right_sign : sign of psi at the right edge where it is positive at the left one
    k_0_of_curvature : at an edge, b k_1 plus this times k_0 is in proportion to the curvature of what lies between
        two segments, of half-width b
    strength_factor : strength of the pressure at an edge over that of the density
    tangent_forcing : derivative of the forcing by the load
    sign_of_plane : sign of the resistance over the change of the plane with the load
    rounding_power : rounding changes b_n by n to half this power
    close : from the forces for the forcing and for 1 everywhere, and the load, to the forces and the plane
    factor : of sums over all forces, from the period
    forcing_of_maximum : from series and load, the forcing where the series has its maximum
    height_of_residual : from half-widths, the height of a residual of 1
    finest_height : of the finest wave of a series, in g_0
    """

    dual: bool
    right_sign: float
    k_0_of_curvature: float
    strength_factor: float
    tangent_forcing: float
    sign_of_plane: float
    rounding_power: int
    close: Callable[[Array, Array, float, float], tuple[Array, float]]
    factor: Callable[[float], float]
    forcing_of_maximum: Callable[[CosineSeries, float], float]
    height_of_residual: Callable[[Array], Array]
    finest_height: Callable[[CosineSeries], float]


@kernel
def cosine_sums(angles: int, terms: int, power: int, table: Array) -> None:
    """Fill a table with sum_n n^power cos(pi n q/angles), n = 1..terms, for all q that it has."""
    turn = 2 * angles
    cosine, factor = np.empty(turn), np.empty(terms + 1)
    for q in range(turn):
        cosine[q] = np.cos(np.pi / angles * q)
    for n in range(1, terms + 1):
        factor[n] = float(n) if power > 0 else 1.0 / n
    for q in range(table.size):
        total, index = 0.0, 0
        for n in range(1, terms + 1):
            index += q
            if index >= turn:
                index -= turn
            total += factor[n] * cosine[index]
        table[q] = total


@kernel
def times_own(
    first_node: Indices, table: Array, left: Array, scale: Array, sign: float, shift: int, f: Array, result: Array
) -> None:
    """Add the own influence of each segment, or its inverse, times f; the diagonal is that of the table."""
    for j in range(first_node.size - 1):
        first, last, start = first_node[j], first_node[j + 1], 2 * first_node[j] + j
        for i in range(first, last):
            total = 0.0
            for k in range(first, last):
                of_difference = table[start + abs(i - k)]
                total += (of_difference + sign * table[start + i + k - 2 * first + shift]) * left[k] * f[k]
            result[i] += scale[j] * left[i] * total


@kernel
def add_own_blocks(rule: Rule, first_node: Indices, matrix: Table) -> None:
    """Add the own influence of each segment to a matrix of all nodes."""
    for j in range(first_node.size - 1):
        first, last, start = first_node[j], first_node[j + 1], 2 * first_node[j] + j
        for i in range(first, last):
            for k in range(first, last):
                both = rule.own[start + abs(i - k)] + rule.sign * rule.own[start + i + k - 2 * first + rule.shift]
                matrix[i, k] += rule.own_scale[j] * rule.left[i] * rule.left[k] * both
            matrix[i, i] += rule.at_node[i]


@kernel
def expansion(rule: Rule, first_node: Indices, force: Array) -> Array:
    """Return the coefficients of psi in T_n, segment by segment, shape (nodes,)."""
    b = np.zeros(force.size)
    for j in range(first_node.size - 1):
        first, last, turn = first_node[j], first_node[j + 1], rule.turn[j]
        wave = rule.wave[4 * first : 4 * first + turn]
        for i in range(first, last):
            f, index = rule.left[i] * force[i], 0
            for n in range(first, last):
                b[n] += f * wave[index]
                index += rule.step[i]
                if index >= turn:
                    index -= turn
    for n in range(b.size):
        b[n] *= rule.degree_scale[n]
    return b


@kernel
def forces_of(rule: Rule, first_node: Indices, b: Array, old_first_node: Indices, origin: Indices) -> Array:
    """Return the forces of expansions, each that of the old segment `origin`, or 0 where this is -1.

    Coefficients of higher degree than the nodes carry are left out.
    """
    force = np.zeros(first_node[-1])
    for j in range(first_node.size - 1):
        if origin[j] < 0:
            continue
        first, last, turn, old = first_node[j], first_node[j + 1], rule.turn[j], old_first_node[origin[j]]
        wave = rule.wave[4 * first : 4 * first + turn]
        count = min(last - first, old_first_node[origin[j] + 1] - old)
        for i in range(first, last):
            total, index = 0.0, 0
            for n in range(count):
                if rule.degree_scale[first + n] != 0:
                    total += (1 if n == 0 else 2) * b[old + n] / rule.degree_scale[first + n] * wave[index]
                index += rule.step[i]
                if index >= turn:
                    index -= turn
            force[i] = total / (rule.left[i] * rule.angles[j])
    return force
