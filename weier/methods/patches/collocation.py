"""The equations of a set of segments with free ends, and their Jacobian.

One kernel serves two problems, for both are int rho(s) cot(pi (x-s)/L) ds = f(x) on segments whose ends are
sought, with rho = sqrt(1-t^2) phi(t):

contacts (primal)
    rho is the pressure, f = -L z'/(2 pi); one equation of height a patch,
    2 int rho ln|2 sin(pi (x-s)/L)| ds + indentation + z - max z = 0, and the load, int rho dx = p L.
gaps (dual)
    rho is the slope of the gap, f = -2 pi L p_full; each gap closes at its far end, int rho dx = 0, and its
    moment is the mean gap d = -(1/L) int (x - c) rho dx.

Unknowns, in this order: phi at all nodes; centres and half-widths, in units of the half-width; and the
approach: indentation (primal) or -d (dual), so that its derivative in p is the resistance in both.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.jit import kernel
from weier.methods.patches.chebyshev import collocation_point
from weier.methods.patches.segments import Segments
from weier.methods.patches.waves import Waves, excess

Array = NDArray[np.float64]

SMALL_ANGLE = 1e-8  # below it sin(y) = y and y cot(y) = 1 to rounding


class System(NamedTuple):
    """The equations of a Newton step: a matrix, and where the columns of centres and of half-widths begin in it.

    jacobian : shape (unknowns, unknowns)
    right : residual and its derivative in the mean pressure, as columns, shape (unknowns, 2)
    centre, width : number of the first column of each; phi stands before, the approach behind
    """

    jacobian: Array
    right: Array
    centre: int
    width: int


def assemble(
    segments: Segments, phi: Array, approach: float, waves: Waves, load: float, dual: bool
) -> tuple[Array, Array]:
    """The Jacobian and, as columns, the residual and its derivative in the mean pressure."""
    N, n = phi.size, segments.centre.size
    size = N + 2 * n + 1
    system = System(np.zeros((size, size)), np.zeros((size, 2)), N, N + n)
    _on_segments(system, segments, phi, approach, waves, load, dual)
    if dual:
        _close(system, segments, phi)
        _measure_gap(system, segments, phi, approach, waves.period)
    else:
        _balance_load(system, segments, phi, load * waves.period, waves.period)
    return system.jacobian, system.right


@kernel
def _on_segments(
    system: System, segments: Segments, phi: Array, approach: float, waves: Waves, load: float, dual: bool
) -> None:
    """The integral equation and, of contacts, the heights: all rows that cost as much as the matrix has elements."""
    n = segments.centre.size
    for i in range(n):
        points = _points(segments, i, waves.period)
        _force(system, segments, waves, load, dual, points, i)
        for j in range(n):
            _collocate(system, segments, phi, waves.period, points, i, j)
        if not dual:
            _match_height(system, segments, phi, approach, waves, i)


@kernel
def _points(segments: Segments, i: int, period: float) -> Array:
    """Collocation points t of segment i, and sine and cosine of pi r t/L, as columns."""
    count = segments.first[i + 1] - segments.first[i]
    point = np.empty((count + 1, 3))
    for a in range(count + 1):
        point[a, 0] = collocation_point(a, count)
        angle = np.pi / period * segments.half_width[i] * point[a, 0]
        point[a, 1], point[a, 2] = np.sin(angle), np.cos(angle)
    return point


@kernel
def _force(system: System, segments: Segments, waves: Waves, load: float, dual: bool, points: Array, i: int) -> None:
    """-f at the collocation points x = c + r t of segment i; -r f' and -r t f' in its columns of place and width."""
    r, right = segments.half_width[i], system.right
    for a in range(points.shape[0]):
        row, t = segments.first[i] + i + a, points[a, 0]
        value, slope, curvature = excess(waves, segments.summit[i], segments.centre[i] + r * t)
        if dual:
            right[row, 0] = 2 * np.pi * waves.period * (load - waves.top - value)
            right[row, 1] = 2 * np.pi * waves.period
            stretch = -2 * np.pi * waves.period * slope
        else:
            right[row, 0] = slope * waves.period / (2 * np.pi)
            stretch = curvature * waves.period / (2 * np.pi)
        system.jacobian[row, system.centre + i] = stretch * r
        system.jacobian[row, system.width + i] = stretch * r * t


@kernel
def _turn(segments: Segments, i: int, j: int, factor: float) -> tuple[float, float]:
    """Sine and cosine of pi (c_i - c_j)/L, from the centre of segment j to that of segment i."""
    angle = factor * (segments.origin[i] - segments.origin[j] + (segments.centre[i] - segments.centre[j]))
    return np.sin(angle), np.cos(angle)


@kernel
def _collocate(system: System, segments: Segments, phi: Array, period: float, points: Array, i: int, j: int) -> None:
    """I = int rho cot(pi (x-s)/L) ds over segment j at the collocation points x = c_i + r_i t of segment i.

    With K = cot, dK/ds = (pi/L)(1 + K^2): along = dI/dc_j = -dI/dx = sum w r phi dK/ds, and
    about = r_j dI/dr_j = sum w r phi (K + r_j t_q dK/ds), less r_j t along where x, too, moves with r_j (i = j).
    """
    jacobian, factor = system.jacobian, np.pi / period
    own, r = segments.half_width[i], segments.half_width[j]
    here = slice(segments.first[j], segments.first[j + 1])  # numba knows no index into these to be negative
    node, share = segments.node[here], r * segments.weight[here]
    force, turn_sine, turn_cosine = share * phi[here], segments.sine[here], segments.cosine[here]
    s, c = _turn(segments, i, j, factor)
    for a in range(points.shape[0]):
        row, t, u, v = segments.first[i] + i + a, points[a, 0], points[a, 1], points[a, 2]
        sine, cosine, cot = s * v + c * u, c * v - s * u, jacobian[row, here]
        for q in range(cot.size):  # by itself: four at a time
            cot[q] = (cosine * turn_cosine[q] + sine * turn_sine[q]) / (sine * turn_cosine[q] - cosine * turn_sine[q])
        total, along, about = 0.0, 0.0, 0.0
        for q in range(cot.size):
            push, pull = force[q] * cot[q], force[q] * factor * (1 + cot[q] * cot[q])
            cot[q] *= share[q]
            total += push
            along += pull
            about += push + r * node[q] * pull
        if i == j:
            about, along = about - r * t * along, 0.0
        system.right[row, 0] += total
        jacobian[row, system.centre + i] -= along * own
        jacobian[row, system.width + i] -= along * own * t
        jacobian[row, system.centre + j] += along * r
        jacobian[row, system.width + j] += about


@kernel
def _match_height(system: System, segments: Segments, phi: Array, approach: float, waves: Waves, i: int) -> None:
    """The gap is 0 at the centre x = c_i of patch i: the height equation over r_i, so that all rows are of one size.

    Of V = 2 int rho ln|2 sin(pi (x-s)/L)| ds over patch j: along = dV/dc_j = -dV/dx, about = r_j dV/dr_j;
    tilt = z' - sum along is the derivative of the whole in c_i.
    """
    jacobian, row, factor = system.jacobian, system.width + i, np.pi / waves.period
    value, slope, _ = excess(waves, segments.summit[i], segments.centre[i])
    scale = 1 / segments.half_width[i]
    total = (approach + value) * scale
    tilt = slope
    for j in range(segments.centre.size):
        r = segments.half_width[j]
        s, c = _turn(segments, i, j, factor)
        along, about = 0.0, 0.0
        for q in range(segments.first[j], segments.first[j + 1]):
            share = r * segments.weight[q]
            if i == j:
                potential, pull, turn = _raise_own_centre(segments, q, r, factor)
            else:
                potential, pull, turn = _raise_centre(segments, q, r, factor, s, c)
            jacobian[row, q] = 2 * potential * scale
            total += 2 * potential * phi[q] * scale
            along -= 2 * share * phi[q] * pull
            about += 2 * (potential + share * turn) * phi[q]
        tilt -= along
        jacobian[row, system.centre + j] += along * r * scale
        jacobian[row, system.width + j] += about * scale
    jacobian[row, system.centre + i] += tilt
    jacobian[row, -1] = scale
    system.right[row, 0] = total


@kernel
def _raise_own_centre(segments: Segments, q: int, r: float, factor: float) -> tuple[float, float, float]:
    """Node q of patch i at its own centre, s = r t away: w r ln|2 sin(pi s/L)|, and of the logarithm pull and turn.

    pull = d/dx is 0, for the patch moves with its centre; turn = r d/dr = (pi s/L) cot(pi s/L). The singular part
    ln|t| is integrated in closed form, by `Segments.central`.
    """
    share, x = r * segments.weight[q], r * segments.node[q]
    small = factor * abs(x) < SMALL_ANGLE
    log = np.log(2 * factor) if small else np.log(abs(2 * segments.sine[q] / x))
    turn = 1.0 if small else factor * x * segments.cosine[q] / segments.sine[q]
    return share * (np.log(r) + log) + r * segments.central[q], 0.0, turn


@kernel
def _raise_centre(
    segments: Segments, q: int, r: float, factor: float, s: float, c: float
) -> tuple[float, float, float]:
    """The same of node q of another patch, whose centre is the angle of sine s and cosine c away.

    pull = d/dx ln|2 sin(pi (x-s)/L)| = (pi/L) cot(pi (x-s)/L), turn = r d/dr = -r t pull.
    """
    sine = s * segments.cosine[q] - c * segments.sine[q]
    pull = factor * (c * segments.cosine[q] + s * segments.sine[q]) / sine
    return r * segments.weight[q] * np.log(abs(2 * sine)), pull, -r * segments.node[q] * pull


def _balance_load(system: System, segments: Segments, phi: Array, force: float, period: float) -> None:
    """int rho dx = p L, over the largest half-width."""
    scale = 1 / segments.half_width.max()
    weight = scale * _each(segments, segments.half_width) * segments.weight
    share = _sums(segments, weight * phi)
    system.jacobian[-1, : phi.size], system.jacobian[-1, system.width : -1] = weight, share
    system.right[-1] = share.sum() - scale * force, -scale * period


def _close(system: System, segments: Segments, phi: Array) -> None:
    """int rho dx = 0: the gap that opens at one end of each segment has closed at the other."""
    row = system.width + _each(segments, np.arange(segments.centre.size))
    system.jacobian[row, np.arange(phi.size)] = segments.weight
    system.right[system.width : -1, 0] = _sums(segments, segments.weight * phi)


def _measure_gap(system: System, segments: Segments, phi: Array, approach: float, period: float) -> None:
    """approach = -d = (1/L) int (x - c) rho dx."""
    jacobian = system.jacobian
    weight = _each(segments, segments.half_width**2) * segments.weight * segments.node / period
    share = _sums(segments, weight * phi)
    jacobian[-1, : phi.size], jacobian[-1, system.width : -1], jacobian[-1, -1] = weight, 2 * share, -1.0
    system.right[-1, 0] = share.sum() - approach


def _each(segments: Segments, value: NDArray[Any]) -> NDArray[Any]:
    """A value of each segment at all of its nodes."""
    return np.repeat(value, np.diff(segments.first))


def _sums(segments: Segments, value: Array) -> Array:
    """Sums over the nodes of each segment."""
    return np.add.reduceat(value, segments.first[:-1])
