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

from weier.jit import kernel

Array = NDArray[np.float64]

NEWTON_STEPS = 60  # a first guess takes 4-10, a neighbouring load 2 or 3
LONGEST_STEP = 2.0  # of a logarithm: further away the tangents of exponentials mislead;
STEEPEST = 50.0  # but ln p is so many times steeper than ln w where it matters through w alone
STRIDE = 1.0  # longest in ln xi from one load to the next
SHORTEST_STRIDE = 1e-3
GUESSED = -3.0  # ln xi of the heaviest load to start from: the layer is not yet pressed flat
GUESSES = 60  # halvings of the error of ln sin^2(pi a) in the first guess
POINTS_OUTSIDE = 8  # where the gap is checked


class Layer(NamedTuple):
    """ln w and d ln w/d ln p at increasing ln p, each of shape (rows,); power laws beyond both ends."""

    log_pressure: Array
    log_compression: Array
    slope: Array


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
def compression(layer: Layer, log_pressure: float) -> tuple[float, float]:
    """Compression w and dw/d ln p, from the cubic through values and slopes of ln w."""
    y = layer.log_pressure
    low, high = 0, y.size - 1
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if log_pressure > y[middle] else (low, middle)
    length, left, right = y[high] - y[low], layer.slope[low], layer.slope[high]
    start, end = layer.log_compression[low], layer.log_compression[high]
    t, secant = (log_pressure - y[low]) / length, (end - start) / length
    if t <= 0:
        value, slope = start + left * length * t, left
    elif t >= 1:
        value, slope = end + right * length * (t - 1), right
    else:
        bend, twist = 3 * secant - 2 * left - right, left + right - 2 * secant
        value = start + length * t * (left + t * (bend + t * twist))
        slope = left + t * (2 * bend + 3 * t * twist)
    w = math.exp(value)
    return w, w * slope


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
def balance(state: Array, log_load: float, layer: Layer, mesh: Mesh) -> Balance:
    """Equations: u + w + 2 sin^2(pi x) at every node as at the edge, and the mean pressure as given."""
    points = mesh.rise.size
    edge, load = state[points], math.exp(log_load)
    sine_squared, trough = math.exp(min(edge, 0.0)), max(edge, 0.0)
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
    return Balance(residual, jacobian, drift, trust, 2 * sine_squared + trough)


@kernel
def error(equations: Balance) -> float:
    """The largest residual: heights relative to the depth of the edge, the load relative to itself."""
    worst, last = 0.0, equations.residual.size - 1
    for i in range(last):
        worst = max(worst, abs(equations.residual[i]) / equations.depth)
    return worst + abs(equations.residual[last])


@kernel
def solve(matrix: Array, right: Array) -> Array:
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
def move(state: Array, direction: Array, stride: float, trust: Array) -> None:
    """Add stride times the direction, no component further than trusted; pressures above the mean rise slowly."""
    last = state.size - 1
    for i in range(state.size):
        rise = trust[i] if i == last else max(min(trust[i], -state[i]), LONGEST_STEP)
        state[i] += min(max(stride * direction[i], -trust[i]), rise)


@kernel
def settle(state: Array, log_load: float, layer: Layer, mesh: Mesh, tolerance: float) -> tuple[Balance, float, int]:
    """Newton's method in place: the equations where it stopped, their error, the steps taken."""
    equations = balance(state, log_load, layer, mesh)
    reached, steps = error(equations), 0
    while reached > tolerance and reached < math.inf and steps < NEWTON_STEPS:
        move(state, solve(equations.jacobian, equations.residual), -1.0, equations.trust)
        equations = balance(state, log_load, layer, mesh)
        reached, steps = error(equations), steps + 1
    return equations, reached, steps


@kernel
def compliance(state: Array, log_load: float, mesh: Mesh, tangent: Array) -> tuple[float, float]:
    """Compliance h and dh/dxi of a state whose derivative by ln xi is the tangent: both from the edge."""
    points = mesh.rise.size
    edge, load = state[points], math.exp(log_load)
    log_sine, trough = min(edge, 0.0), max(edge, 0.0)
    depth = 2 * math.exp(log_sine) + trough
    sinking, growth = -log_sine, -log_sine
    for j in range(points):
        excess = math.expm1(state[j])
        sinking += mesh.sinking_edge[j] * excess
        growth += mesh.sinking_edge[j] * (excess + (1 + excess) * tangent[j])
    deepening = tangent[points] * (1.0 if edge >= 0 else depth - load)
    return depth + load * sinking, max(growth + deepening / load, 0.0)


@kernel
def log_pressure_of(layer: Layer, log_w: float, log_p: float) -> float:
    """The ln p at which the layer is compressed to w, near a given ln p: Newton's method in logarithms."""
    for _ in range(NEWTON_STEPS):
        w, stiffness = compression(layer, log_p)
        step = (log_w - math.log(w)) * w / max(stiffness, w / STEEPEST)
        log_p += step
        if abs(step) < 1e-3:
            break
    return log_p


@kernel
def first_guess(log_load: float, layer: Layer, mesh: Mesh) -> Array:
    """A state near enough for Newton: depth of the edge 2 sin^2(pi a) = 2 xi + w, and p of what yields more alone."""
    points, load = mesh.rise.size, math.exp(log_load)
    sine_squared, w, crowding = min(1.0, load), 0.0, 0.0
    for _ in range(GUESSES):
        crowding = max(0.0, math.log(math.pi / (2 * math.sqrt(sine_squared))))
        w, _ = compression(layer, log_load + crowding)
        sine_squared = math.sqrt(sine_squared) * math.sqrt(min(1.0, load + w / 2))  # their product may underflow
    state = np.zeros(points + 1)
    if sine_squared > 0.9:
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
    state, tangent, trust = first_guess(here, layer, mesh), np.zeros(size), np.zeros(size)
    for i in range(n):
        longest, arrived = STRIDE, False
        while not arrived:
            stride = min(longest, log_load[i] - here)
            trial = state.copy()
            move(trial, tangent, stride, trust)
            equations, reached, steps = settle(trial, here + stride, layer, mesh, tolerance)
            answer.work[i] += steps
            answer.residual[i] = reached
            if reached <= tolerance:
                arrived = stride == log_load[i] - here
                state, here = trial, here + stride
                tangent, trust = solve(equations.jacobian, -equations.drift), equations.trust
            elif stride > SHORTEST_STRIDE:
                longest = stride / 2
            else:
                return answer
        here = log_load[i]
        for j in range(size):
            answer.state[i, j] = state[j]
        answer.compliance[i], answer.resistance[i] = compliance(state, here, mesh, tangent)
    return answer


@kernel
def cosines(points: int) -> Array:
    """cos(k phi) at the midpoints, shape (k, midpoints)."""
    table = np.empty((points, points))
    for k in range(points):
        for j in range(points):
            table[k, j] = math.cos(k * (j + 0.5) * (math.pi / points))
    return table


@kernel
def violation(state: Array, log_load: float, layer: Layer, h: float, cosine: Array) -> float:
    """Largest breach of a contact condition, on a freshly applied operator; relative as in `error`.

    The conditions: u + w = h - 2 sin^2(pi x) in contact and at its edge, no less beyond it, and the mean pressure.
    """
    points = state.size - 1
    edge, load = state[points], math.exp(log_load)
    log_sine, trough = min(edge, 0.0), max(edge, 0.0)
    sine_squared, (excess, mean) = math.exp(log_sine), excesses(state)
    series, displacement = np.zeros(points), np.full(points, -load * log_sine)
    for order in range(1, points):
        wave = cosine[order]
        for j in range(points):
            series[order] += 2 * load / (points * order) * wave[j] * excess[j]
        for j in range(points):
            displacement[j] += series[order] * wave[j]
    worst = 0.0
    for j in range(points):
        rise = math.sin((j + 0.5) * (math.pi / (2 * points))) ** 2
        factor, _ = log_pressure_factor(edge, rise)
        w, _ = compression(layer, log_load + state[j] + factor)
        worst = max(worst, abs(displacement[j] + w + 2 * sine_squared * (1 - rise) - h))
    farthest = 2 * math.acosh(math.exp(-log_sine / 2))  # phi = i eta outside: sin(pi x) = sin(pi a) cosh(eta/2)
    for i in range(POINTS_OUTSIDE + 1):
        eta = farthest * i / POINTS_OUTSIDE
        u, decay = 0.0, math.exp(-eta)
        for order in range(points - 1, -1, -1):
            u = u * decay + series[order]
        u -= load * (log_sine + eta)
        gap = u + trough + 2 * sine_squared * math.cosh(eta / 2) ** 2 - h
        worst = max(worst, -gap if i > 0 else abs(gap))
    return worst / (2 * sine_squared + trough) + abs(mean)


@kernel
def violations(traced: Trace, log_load: Array, layer: Layer) -> Array:
    """`violation` of every load, shape (loads,)."""
    worst, cosine = np.zeros(log_load.size), cosines(traced.state.shape[1] - 1)
    for i in range(log_load.size):
        worst[i] = violation(traced.state[i], log_load[i], layer, traced.compliance[i], cosine)
    return worst


def edge_depth(traced: Trace) -> Array:
    """2 sin^2(pi a), or 2 + w in closed troughs: what residuals are relative to, shape (loads,)."""
    edge = traced.state[:, -1]
    return np.asarray(2 * np.exp(np.minimum(edge, 0)) + np.maximum(edge, 0))


@kernel
def compressions(layer: Layer, log_pressure: Array) -> Array:
    """Logarithm of w at each ln p, shape (n,)."""
    log_w = np.zeros(log_pressure.size)
    for i in range(log_pressure.size):
        log_w[i] = math.log(compression(layer, log_pressure[i])[0])
    return log_w
