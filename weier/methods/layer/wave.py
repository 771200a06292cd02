"""One wave on a half-plane through a layer: a single level of the non-linear layer model (4.3).

Lengths along x are in the wavelength, heights in the amplitude, pressures in p* (7) of this wave. xi is the mean
pressure, w(p) the compression of the layer. In the contact, -a < x < a,

    u(x) + w(p(x)) = h - 2 sin^2(pi x),    u(x) = -2 int p(s) ln|2 sin(pi (x - s))| ds,

and either p = 0 at its edges or a = 1/2. With sin(pi x) = sin(pi a) cos(phi/2) the kernel becomes
ln(2 sin^2(pi a)) + ln|cos phi - cos phi'|, whose eigenfunctions are cosines whatever a is:

    p dx = -q dphi,  q = xi/(2 pi) + sum_k q_k cos(k phi),    u = -xi ln sin^2(pi a) + sum_k 2 pi/k q_k cos(k phi).

(Westergaard's q is xi (1 - cos phi)/(2 pi).) So the same M midpoints in phi serve every load, and gather at the
edges: phi = 0 at x = a, pi at the crest. The state of a wave is an array of M + 1 numbers,

    y_j = ln(2 pi q_j/xi),    edge = ln sin^2(pi a) < 0, or w(p) >= 0 in the trough where a = 1/2.

Logarithms keep the pressure positive over all decades of load, so that there is no set of active nodes to find.
Heights relative to the edge, phi = 0, need neither h nor a.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.kernels.jit import kernel
from weier.methods.layer.law import STEEPEST, Layer, compression, log_pressure_of

Array = NDArray[np.float64]

NEWTON_STEPS = 60  # a first guess takes 4-10, a neighbouring load 2 or 3
LONGEST_STEP = 2.0  # of a logarithm: further away the tangents of exponentials mislead
STRIDE = 1.0  # longest in ln xi from one load to the next
SHORTEST_STRIDE = 1e-3
GUESSED = -3.0  # ln xi of the heaviest load to start from: the layer is not yet pressed flat
GUESSES = 60  # halvings of the error of ln sin^2(pi a) in the first guess
NEARLY_CLOSED = 0.9  # sin^2(pi a) from which on a first guess takes the troughs for closed


class Mesh(NamedTuple):
    """The midpoints in phi.

    rise : sin^2(phi/2), shape (M,): height of the wave above its edge, in 2 sin^2(pi a)
    sinking : u - u(edge) at node i for exp(y_j) - 1 at node j, in xi, shape (M, M)
    sinking_edge : u(edge) + xi ln sin^2(pi a) likewise, shape (M,)
    """

    rise: Array
    sinking: Array
    sinking_edge: Array


class Balance(NamedTuple):
    """Equations of a state.

    residual, jacobian, drift : the residual, its derivatives by the state and by ln xi
    trust : how far from the state its tangents are trusted, shape (M + 1,)
    depth : 2 sin^2(pi a) and the compression in the trough: what heights are relative to
    """

    residual: Array
    jacobian: Array
    drift: Array
    trust: Array
    depth: float


class Place(NamedTuple):
    """A state, its derivative by ln xi, and how far that is trusted: each of shape (M + 1,)."""

    state: Array
    tangent: Array
    trust: Array


class Trace(NamedTuple):
    """Answers along the loads: h, dh/dxi, relative residual, Newton steps, shape (loads,), and the states."""

    compliance: Array
    resistance: Array
    residual: Array
    work: NDArray[np.int64]
    state: Array


def midpoints(points: int) -> Mesh:
    """The mesh of `points` midpoints on half a wave."""
    phi = (np.arange(points) + 0.5) * (np.pi / points)
    k = np.arange(1, points)
    transform = np.cos(np.outer(k, phi)) * (2 / (points * k))[:, None]
    below_one = -2 * np.sin(np.outer(phi, k) / 2) ** 2  # cos(k phi) - 1
    return Mesh(np.sin(phi / 2) ** 2, below_one @ transform, transform.sum(axis=0))


@kernel
def depth_of(edge: float) -> tuple[float, float, float]:
    """ln sin^2(pi a), w in the trough, and the depth 2 sin^2(pi a) + w that heights are relative to."""
    log_sine, trough = min(edge, 0.0), max(edge, 0.0)
    return log_sine, trough, 2 * math.exp(log_sine) + trough


def depths(traced: Trace) -> Array:
    """The depth of each load: what residuals are relative to, shape (loads,)."""
    return np.array([depth_of(edge)[2] for edge in traced.state[:, -1]])


@kernel
def log_pressure_factor(edge: float, rise: float) -> tuple[float, float]:
    """ln(p/xi) - y at a node, and its derivative by the edge."""
    if edge >= 0:
        return 0.0, 0.0
    cosine_squared = rise * math.exp(edge) - math.expm1(edge)  # cos^2(pi x)
    return 0.5 * math.log(cosine_squared / rise) - 0.5 * edge, -0.5 / cosine_squared


@kernel
def excesses(state: Array) -> tuple[Array, float]:
    """By how much 2 pi q exceeds xi at the nodes, in xi, shape (M,), and the mean, which ought to be 0."""
    excess, mean = np.empty(state.size - 1), 0.0
    for j in range(excess.size):
        excess[j] = math.expm1(state[j])
        mean += excess[j] / excess.size
    return excess, mean


@kernel
def _balance(state: Array, log_load: float, layer: Layer, mesh: Mesh) -> Balance:
    """Equations of a state, from those of the header less their values at the edge.

    Rows i < M: u(x_i) + w(p(x_i)) + 2 sin^2(pi x_i) as at the edge. Row M: the mean of q is xi/(2 pi).
    """
    points = mesh.rise.size
    edge, load = state[points], math.exp(log_load)
    log_sine, trough, depth = depth_of(edge)
    sine_squared = math.exp(log_sine)
    residual, drift, trust = np.zeros(points + 1), np.zeros(points + 1), np.zeros(points + 1)
    jacobian = np.zeros((points + 1, points + 1))
    excess, mean = excesses(state)
    for i in range(points):
        factor, slope = log_pressure_factor(edge, mesh.rise[i])
        w, stiffness = compression(layer, log_load + state[i] + factor)
        height, sinking = 2 * sine_squared * mesh.rise[i], 0.0
        for j in range(points):
            sinking += load * mesh.sinking[i, j] * excess[j]
            jacobian[i, j] = load * mesh.sinking[i, j] * (1 + excess[j])
        residual[i] = w + sinking - height - trough
        drift[i] = stiffness + sinking
        jacobian[i, i] += stiffness
        jacobian[i, points] = stiffness * slope - (height if edge < 0 else 1.0)
        jacobian[points, i] = (1 + excess[i]) / (points * (1 + mean))
        trust[i] = LONGEST_STEP * max(1.0, w / max(stiffness, w / STEEPEST))
    residual[points] = math.log1p(mean)
    trust[points] = LONGEST_STEP * max(1.0, edge)
    return Balance(residual, jacobian, drift, trust, depth)


@kernel
def _error(equations: Balance) -> float:
    """The largest residual: heights relative to the depth of the edge, the load relative to itself."""
    worst, last = 0.0, equations.residual.size - 1
    for i in range(last):
        worst = max(worst, abs(equations.residual[i]) / equations.depth)
    return worst + abs(equations.residual[last])


@kernel
def _eliminate(matrix: Array, right: Array) -> Array:
    """Gaussian elimination with row exchanges, in place; `right` becomes the solution.

    numpy.linalg.solve takes 3 s to compile and this 0.4 s; for 25 or 33 unknowns both are as fast.
    """
    n = right.size
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(matrix[i, k]) > abs(matrix[pivot, k]):
                pivot = i
        if pivot != k:
            for j in range(k, n):
                matrix[k, j], matrix[pivot, j] = matrix[pivot, j], matrix[k, j]
            right[k], right[pivot] = right[pivot], right[k]
        pivotal = matrix[k, k + 1 :]
        for i in range(k + 1, n):
            factor, row = matrix[i, k] / matrix[k, k], matrix[i, k + 1 :]
            for j in range(row.size):  # from 0, so that no index may be negative: this vectorises
                row[j] -= factor * pivotal[j]
            right[i] -= factor * right[k]
    for k in range(n - 1, -1, -1):
        right[k] /= matrix[k, k]
        for i in range(k):
            right[i] -= matrix[i, k] * right[k]
    return right


@kernel
def _move(state: Array, direction: Array, stride: float, trust: Array) -> None:
    """Add stride times the direction, no component further than trusted; pressures above the mean rise slowly."""
    last = state.size - 1
    for i in range(state.size):
        rise = trust[i] if i == last else max(min(trust[i], -state[i]), LONGEST_STEP)
        state[i] += min(max(stride * direction[i], -trust[i]), rise)


@kernel
def _settle(state: Array, log_load: float, layer: Layer, mesh: Mesh, tolerance: float) -> tuple[Balance, float, int]:
    """Newton's method in place: the equations where it stopped, their error, the steps taken."""
    equations = _balance(state, log_load, layer, mesh)
    reached, steps = _error(equations), 0
    while reached > tolerance and reached < math.inf and steps < NEWTON_STEPS:
        _move(state, _eliminate(equations.jacobian, equations.residual), -1.0, equations.trust)
        equations = _balance(state, log_load, layer, mesh)
        reached, steps = _error(equations), steps + 1
    return equations, reached, steps


@kernel
def _compliance(state: Array, log_load: float, mesh: Mesh, tangent: Array) -> tuple[float, float]:
    """Compliance h and dh/dxi of a state whose derivative by ln xi is the tangent: both from the edge."""
    points = mesh.rise.size
    edge, load = state[points], math.exp(log_load)
    log_sine, _, depth = depth_of(edge)
    sinking, growth = -log_sine, -log_sine
    for j in range(points):
        excess = math.expm1(state[j])
        sinking += mesh.sinking_edge[j] * excess
        growth += mesh.sinking_edge[j] * (excess + (1 + excess) * tangent[j])
    deepening = tangent[points] * (1.0 if edge >= 0 else depth - load)
    return depth + load * sinking, max(growth + deepening / load, 0.0)


@kernel
def _first_guess(log_load: float, layer: Layer, mesh: Mesh) -> Array:
    """A state near enough for Newton: depth of the edge 2 sin^2(pi a) = 2 xi + w, and p of what yields more alone."""
    points, load = mesh.rise.size, math.exp(log_load)
    sine_squared, w, crowding = min(1.0, load), 0.0, 0.0
    for _ in range(GUESSES):
        crowding = max(0.0, math.log(math.pi / (2 * math.sqrt(sine_squared))))
        w, _ = compression(layer, log_load + crowding)
        sine_squared = math.sqrt(sine_squared) * math.sqrt(min(1.0, load + w / 2))  # their product may underflow
    state = np.zeros(points + 1)
    if sine_squared > NEARLY_CLOSED:
        state[points] = w
        return state
    state[points] = math.log(sine_squared)
    log_p, total = log_load + crowding, 0.0
    for j in range(points - 1, -1, -1):
        state[j] = math.log(2 * mesh.rise[j])  # Westergaard's q
        if w > 2 * load:
            log_p = log_pressure_of(layer, math.log(w * mesh.rise[j]), log_p)
            state[j] = log_p - log_load - log_pressure_factor(state[points], mesh.rise[j])[0]
        total += math.exp(state[j])
    for j in range(points):
        state[j] -= math.log(total / points)
    return state


@kernel
def _onwards(
    start: Place, stride: float, log_load: float, layer: Layer, mesh: Mesh, tolerance: float
) -> tuple[Place, float, int]:
    """One stride along the tangent, to this load: the place reached, its error, Newton's steps."""
    state = start.state.copy()
    _move(state, start.tangent, stride, start.trust)
    equations, reached, steps = _settle(state, log_load, layer, mesh, tolerance)
    return Place(state, _eliminate(equations.jacobian, -equations.drift), equations.trust), reached, steps


@kernel
def trace(log_load: Array, layer: Layer, mesh: Mesh, tolerance: float) -> Trace:
    """Follow the wave from the lightest load up, each load from the tangent of the one before.

    Parameters
    ----------
    log_load : array, shape (loads,)
        ln xi, increasing.
    layer : Layer
        In the units of this wave.
    mesh : Mesh
        Of `midpoints`.
    tolerance : float
        Largest relative residual.

    Returns
    -------
    Trace
        Where a load does not converge, its residual is above the tolerance or NaN, and all beyond is NaN.

    """
    n, size = log_load.size, mesh.rise.size + 1
    answer = Trace(
        np.full(n, np.nan), np.full(n, np.nan), np.full(n, np.nan), np.zeros(n, np.int64), np.zeros((n, size))
    )
    here = min(log_load[0], GUESSED)
    at = Place(_first_guess(here, layer, mesh), np.zeros(size), np.zeros(size))
    for i in range(n):
        longest, arrived = STRIDE, False
        while not arrived:
            stride = min(longest, log_load[i] - here)
            there, reached, steps = _onwards(at, stride, here + stride, layer, mesh, tolerance)
            answer.work[i] += steps
            answer.residual[i] = reached
            if reached <= tolerance:
                arrived = stride == log_load[i] - here
                at, here = there, here + stride
            elif stride > SHORTEST_STRIDE:
                longest = stride / 2
            else:
                return answer
        here = log_load[i]
        for j in range(size):
            answer.state[i, j] = at.state[j]
        answer.compliance[i], answer.resistance[i] = _compliance(at.state, here, mesh, at.tangent)
    return answer
