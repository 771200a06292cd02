"""One wave on a half-plane through a layer: a single scale of the non-linear layer model (4.3).

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

from weier.kernels.arrays import Array, Indices
from weier.kernels.jit import kernel
from weier.methods.layer.closure import MAX_PRESSURE_STEP, Closure, compression, log_pressure_of

MAX_NEWTON_STEPS = 60  # from a neighbouring load; 2 or 3 are usual
MAX_DIRECT_STEPS = 20  # from a first guess; 4-10 are usual
MAX_STEP = 2.0  # of a logarithm: further away the tangents of exponentials mislead
MAX_STRIDE, MIN_STRIDE = 1.0, 1e-3  # of ln xi, from one load to the next
MAX_GUESSED_LOAD = -3.0  # ln xi of the heaviest load to start from: the layer is not yet pressed flat
GUESS_HALVINGS = 16  # of the error of ln sin^2(pi a) in the first guess, which is 700 at most
LOG_ROUNDING = 1e-15  # of ln p, relative to itself: a few units in the last place
MIN_CLOSED_SINE = 0.9  # sin^2(pi a) from which on a first guess takes the troughs for closed


class Mesh(NamedTuple):
    """The midpoints in phi.

    rise : sin^2(phi/2), shape (M,): height of the wave above its edge, in 2 sin^2(pi a)
    influence : u - u(edge) at node i for exp(y_j) - 1 at node j, in xi, shape (M, M)
    edge_influence : u(edge) + xi ln sin^2(pi a) likewise, shape (M,)
    """

    rise: Array
    influence: Array
    edge_influence: Array


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


class Point(NamedTuple):
    """A solution, its derivative by ln xi, and how far that is trusted: each of shape (M + 1,)."""

    state: Array
    tangent: Array
    trust: Array


class Solutions(NamedTuple):
    """Solutions at the loads: h, dh/d ln xi, relative residual and Newton steps, of shape (loads,), and the states.

    The states and their derivatives by ln xi have the shape (loads, M + 1).
    """

    compliance: Array
    rate: Array
    residual: Array
    work: Indices
    state: Array
    tangent: Array


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


def depths(solutions: Solutions) -> Array:
    """The depth of each load: what residuals are relative to, shape (loads,)."""
    return np.array([depth_of(edge)[2] for edge in solutions.state[:, -1]])


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
def _balance(state: Array, log_load: float, closure: Closure, mesh: Mesh) -> Balance:
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
        w, rate = compression(closure, log_load + state[i] + factor)
        height, displacement = 2 * sine_squared * mesh.rise[i], 0.0
        for j in range(points):
            displacement += load * mesh.influence[i, j] * excess[j]
            jacobian[i, j] = load * mesh.influence[i, j] * (1 + excess[j])
        residual[i] = w + displacement - height - trough
        drift[i] = rate + displacement
        jacobian[i, i] += rate
        jacobian[i, points] = rate * slope - (height if edge < 0 else 1.0)
        jacobian[points, i] = (1 + excess[i]) / (points * (1 + mean))
        trust[i] = MAX_STEP * max(1.0, w / max(rate, w / MAX_PRESSURE_STEP))
    residual[points] = math.log1p(mean)
    trust[points] = MAX_STEP * max(1.0, edge)
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
        rise = trust[i] if i == last else max(min(trust[i], -state[i]), MAX_STEP)
        state[i] += min(max(stride * direction[i], -trust[i]), rise)


@kernel
def _newton(
    state: Array, log_load: float, closure: Closure, mesh: Mesh, tolerance: float, max_steps: int
) -> tuple[Balance, float, int]:
    """Newton's method in place: the equations where it stopped, their error, the steps taken."""
    equations = _balance(state, log_load, closure, mesh)
    reached, steps = _error(equations), 0
    while reached > tolerance and reached < math.inf and steps < max_steps:
        _move(state, _eliminate(equations.jacobian, equations.residual), -1.0, equations.trust)
        equations = _balance(state, log_load, closure, mesh)
        reached, steps = _error(equations), steps + 1
    return equations, reached, steps


@kernel
def _compliance(state: Array, log_load: float, mesh: Mesh, tangent: Array) -> tuple[float, float]:
    """Compliance h and dh/d ln xi of a state whose derivative by ln xi is the tangent: both from the edge."""
    edge, load = state[-1], math.exp(log_load)
    log_sine, _, depth = depth_of(edge)
    displacement, growth = -log_sine, -log_sine
    for j in range(mesh.rise.size):
        excess = math.expm1(state[j])
        displacement += mesh.edge_influence[j] * excess
        growth += mesh.edge_influence[j] * (excess + (1 + excess) * tangent[j])
    deepening = tangent[-1] * _deepening(edge, load, depth)
    return depth + load * displacement, max(load * growth + deepening, 0.0)


@kernel
def _deepening(edge: float, load: float, depth: float) -> float:
    """Derivative of h by the edge, at fixed q."""
    return 1.0 if edge >= 0 else depth - load


@kernel
def shares(state: Array, log_load: float, closure: Closure, mesh: Mesh, h: float) -> tuple[Array, Array]:
    """How much a relative error of w at each node changes h, relative to h, shape (M,); and ln p there.

    The residuals of the nodes rise with w, so that h changes by the solution of the transposed equations.
    """
    points, edge, load = mesh.rise.size, state[-1], math.exp(log_load)
    gradient, share, log_pressure = np.empty(points + 1), np.empty(points), np.empty(points)
    for j in range(points):
        gradient[j] = load * mesh.edge_influence[j] * math.exp(state[j])
    gradient[points] = _deepening(edge, load, depth_of(edge)[2])
    transposed = _balance(state, log_load, closure, mesh).jacobian.T.copy()
    weight = _eliminate(transposed, gradient)
    for j in range(points):
        factor, _ = log_pressure_factor(edge, mesh.rise[j])
        log_pressure[j] = log_load + state[j] + factor
        share[j] = -weight[j] * compression(closure, log_pressure[j])[0] / h
    return share, log_pressure


@kernel
def _first_guess(log_load: float, closure: Closure, mesh: Mesh) -> Array:
    """A state near enough for Newton: depth of the edge 2 sin^2(pi a) = 2 xi + w, and p of what yields more alone."""
    points, load = mesh.rise.size, math.exp(log_load)
    sine_squared, w, crowding = min(1.0, load), 0.0, 0.0
    for _ in range(GUESS_HALVINGS):
        crowding = max(0.0, math.log(math.pi / (2 * math.sqrt(sine_squared))))
        w, _ = compression(closure, log_load + crowding)
        sine_squared = math.sqrt(sine_squared) * math.sqrt(min(1.0, load + w / 2))  # their product may underflow
    state = np.zeros(points + 1)
    if sine_squared > MIN_CLOSED_SINE:
        state[points] = w
        return state
    state[points] = math.log(sine_squared)
    log_p, total = log_load + crowding, 0.0
    for j in range(points - 1, -1, -1):
        state[j] = math.log(2 * mesh.rise[j])  # Westergaard's q
        if w > 2 * load:
            log_p = log_pressure_of(closure, math.log(w * mesh.rise[j]), log_p)
            state[j] = log_p - log_load - log_pressure_factor(state[points], mesh.rise[j])[0]
        total += math.exp(state[j])
    for j in range(points):
        state[j] -= math.log(total / points)
    return state


@kernel
def _point(equations: Balance, state: Array) -> Point:
    """A solution with its tangent, from the equations there; the jacobian is overwritten."""
    return Point(state, _eliminate(equations.jacobian, -equations.drift), equations.trust)


@kernel
def _approach(log_load: float, closure: Closure, mesh: Mesh, tolerance: float) -> tuple[Point, float, int]:
    """The solution at a load whose first guess fails: from a lighter one upwards, in strides along the tangent."""
    here, stride = min(log_load, MAX_GUESSED_LOAD) - MAX_STRIDE, MAX_STRIDE
    state = _first_guess(here, closure, mesh)
    equations, reached, work = _newton(state, here, closure, mesh, tolerance, MAX_NEWTON_STEPS)
    at = _point(equations, state)
    while here < log_load and reached <= tolerance:
        stride = min(stride, log_load - here)
        ahead = at.state.copy()
        _move(ahead, at.tangent, stride, at.trust)
        equations, missed, steps = _newton(ahead, here + stride, closure, mesh, tolerance, MAX_NEWTON_STEPS)
        work += steps
        if missed <= tolerance:
            at, here = _point(equations, ahead), log_load if stride == log_load - here else here + stride
            reached, stride = missed, MAX_STRIDE
        elif stride > MIN_STRIDE:
            stride /= 2
        else:
            reached = missed if missed > tolerance else math.inf
    return at, reached, work


@kernel
def attainable(log_load: float, tolerance: float) -> float:
    """The tolerance, or what the rounding of ln p leaves of a residual, if that is more."""
    return max(tolerance, LOG_ROUNDING * abs(log_load))


@kernel
def solve_waves(log_load: Array, guess: Array, closure: Closure, mesh: Mesh, tolerance: float) -> Solutions:
    """Solve the wave under each load, independently of the other loads.

    Parameters
    ----------
    log_load : array, shape (loads,)
        ln xi.
    guess : array, shape (loads, M + 1)
        States to start from; where the first number is NaN the wave makes its own guess.
    closure : Closure
        Of the layer, in the units of this wave.
    mesh : Mesh
        Of `midpoints`.
    tolerance : float
        Largest relative residual.

    Returns
    -------
    Solutions
        Where a load does not converge its residual is above the tolerance or NaN.

    """
    n, size = log_load.size, mesh.rise.size + 1
    solutions = Solutions(
        np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n, np.int64), np.zeros((n, size)), np.zeros((n, size))
    )
    for i in range(n):
        y, limit = log_load[i], attainable(log_load[i], tolerance)
        state = guess[i].copy() if math.isfinite(guess[i, 0]) else _first_guess(y, closure, mesh)
        equations, reached, steps = _newton(state, y, closure, mesh, limit, MAX_DIRECT_STEPS)
        if reached <= limit:
            at = _point(equations, state)
        else:
            at, reached, further = _approach(y, closure, mesh, limit)
            steps += further
        solutions.residual[i], solutions.work[i] = reached, steps
        for j in range(size):
            solutions.state[i, j], solutions.tangent[i, j] = at.state[j], at.tangent[j]
        solutions.compliance[i], solutions.rate[i] = _compliance(at.state, y, mesh, at.tangent)
    return solutions
