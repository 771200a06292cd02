"""One wave on a half-plane through a layer: a single scale of the non-linear layer model (4.3).

docs/layer.md, "One wave on a layer", derives the formulas. Lengths are in the wavelength, heights in the amplitude,
pressures in p* (7) of this wave; xi is the mean pressure, w(p) the compression of the layer, and theta the angle with
sin(pi x) = sin(pi a) cos(theta/2). The state of a wave is an array of K + 1 numbers,

    y_j = ln(2 pi psi_j/xi) at the midpoints of theta, and edge = ln sin^2(pi a) < 0, or w_t >= 0 where a = 1/2.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Flags
from weier.methods.layer.scaling_tables import Closure, log_compression

MAX_STEPS = 60  # Newton steps; 2 or 3 are usual from a neighbouring load, 4 to 10 from the initial guess
MAX_STEP = 2.0  # largest change of a logarithm in a step: tangents of exponentials mislead farther away
GUESS_HALVINGS = 16  # halvings of the error of ln sin^2(pi a), at most 700


class Mesh(NamedTuple):
    """Midpoints in theta.

    rise : sin^2(theta/2), shape (K,): height of the wave above its edge, in 2 sin^2(pi a)
    influence : u - u(edge) at node i for exp(y_j) - 1 at node j, in xi, shape (K, K)
    edge_influence : u(edge) + xi ln sin^2(pi a) for exp(y_j) - 1 at node j, in xi, shape (K,)
    """

    rise: Array
    influence: Array
    edge_influence: Array


class Depth(NamedTuple):
    """ln sin^2(pi a), w_t in the trough and the depth 2 sin^2(pi a) + w_t, each of the shape of the edges."""

    log_sine: Array
    trough: Array
    total: Array


class Balance(NamedTuple):
    """Residuals of states and their derivatives; arrays over the loads.

    residual, jacobian, drift : residual, its derivatives with respect to the state and to ln xi
    trust : largest step, shape (loads, K + 1)
    log_pressure, compression : ln p, and w over the depth, at the nodes, shape (loads, K)
    error : largest residual of heights plus the relative one of the load
    """

    residual: Array
    jacobian: Array
    drift: Array
    trust: Array
    log_pressure: Array
    compression: Array
    error: Array


class Solutions(NamedTuple):
    """Solutions at the loads: h, dh/d ln xi and relative residual, of shape (loads,), and states (loads, M + 1)."""

    compliance: Array
    rate: Array
    residual: Array
    state: Array


def midpoints(points: int) -> Mesh:
    """Return the mesh of `points` midpoints on half a wave."""
    phi = (np.arange(points) + 0.5) * (np.pi / points)
    k = np.arange(1, points)
    transform = np.cos(np.outer(k, phi)) * (2 / (points * k))[:, None]
    below_one = -2 * np.sin(np.outer(phi, k) / 2) ** 2  # cos(k phi) - 1
    return Mesh(np.sin(phi / 2) ** 2, below_one @ transform, transform.sum(axis=0))


def reference_heights(edge: Array) -> Depth:
    """Return the reference heights of the edges."""
    log_sine, trough = np.minimum(edge, 0.0), np.maximum(edge, 0.0)
    return Depth(log_sine, trough, 2 * np.exp(log_sine) + trough)


def log_pressure_factor(edge: Array, rise: Array) -> tuple[Array, Array]:
    """Return ln(p/xi) - y at the nodes, shape (loads, M), and its derivative with respect to the edge."""
    sine = np.minimum(edge, 0.0)[:, None]
    cosine_squared = rise * np.exp(sine) - np.expm1(sine)  # cos^2(pi x)
    return 0.5 * (np.log(cosine_squared / rise) - sine), np.where(sine < 0, -0.5 / cosine_squared, 0.0)


@np.errstate(divide="ignore")  # Where w does not depend on p, steps have no limit.
def _balance(state: Array, log_load: Array, closure: Closure, mesh: Mesh) -> Balance:
    """Return residuals of the contact conditions minus their values at the edge.

    Rows i < M: the difference of u + w(p) + 2 sin^2(pi x) between x_i and the edge, over the depth of the edge, so
    that all rows have the same scale. Row M: the mean of q is xi/(2 pi).
    """
    n, edge = mesh.rise.size, state[:, -1]
    depth, growing = reference_heights(edge), np.exp(state[:, :-1])
    load = (np.exp(log_load) / depth.total)[:, None]
    excess = np.expm1(state[:, :-1])
    mean = excess.mean(axis=1)
    factor, by_edge = log_pressure_factor(edge, mesh.rise)
    log_pressure = log_load[:, None] + state[:, :-1] + factor
    log_w, power = log_compression(closure, log_pressure)
    w = np.exp(log_w) / depth.total[:, None]
    rate, height = w * power, (2 * np.exp(depth.log_sine) / depth.total)[:, None] * mesh.rise
    # With BLAS the order of summation, and thus the last bits, would depend on the number of loads.
    displacement = load * np.einsum("ij,kj->ki", mesh.influence, excess)
    residual, drift, trust = np.zeros((3, *state.shape))
    residual[:, :n], residual[:, n] = (
        w + displacement - height - (depth.trough / depth.total)[:, None],
        np.log1p(mean),
    )
    drift[:, :n] = rate + displacement
    trust[:, :n], trust[:, n] = 1 / power, edge
    jacobian = np.zeros((*state.shape, n + 1))
    jacobian[:, :n, :n] = mesh.influence * (load * growing)[:, None]
    jacobian[:, range(n), range(n)] += rate
    jacobian[:, :n, n] = rate * by_edge - np.where(edge < 0, height.T, 1 / depth.total).T
    jacobian[:, n, :n] = growing / (n * (1 + mean[:, None]))
    error = np.abs(residual[:, :n]).max(axis=1) + np.abs(residual[:, n])
    return Balance(residual, jacobian, drift, MAX_STEP * np.maximum(trust, 1.0), log_pressure, w, error)


def _solve(matrix: Array, right: Array) -> Array:
    """Solve the linear equations of every load; NaN for a singular matrix."""
    try:
        return np.asarray(np.linalg.solve(matrix, right[..., None])[..., 0])
    except np.linalg.LinAlgError:
        if len(matrix) == 1:
            return np.full(right.shape, np.nan)
        return np.concatenate([_solve(matrix[i : i + 1], right[i : i + 1]) for i in range(len(matrix))])


def _moved(state: Array, step: Array, trust: Array) -> Array:
    """Return the states after a step, limited by `trust`, and by `MAX_STEP` for pressures above the mean.

    Pressures below the mean may rise up to it.
    """
    rise = np.maximum(np.minimum(trust, -state), MAX_STEP)
    rise[:, -1] = trust[:, -1]
    return state + np.clip(step, -trust, rise)


def _newton(state: Array, log_load: Array, closure: Closure, mesh: Mesh, limit: Array) -> tuple[Array, Array]:
    """Solve for every load independently by Newton's method; return the final states and errors."""
    state, error = state.copy(), np.full(log_load.size, np.inf)
    active = np.arange(log_load.size)
    for step in range(MAX_STEPS + 1):
        equations = _balance(state[active], log_load[active], closure, mesh)
        error[active] = equations.error
        wrong: Flags = (equations.error > limit[active]) & (equations.error < np.inf)
        active = active[wrong]
        if step == MAX_STEPS or not active.size:
            break
        direction = _solve(equations.jacobian[wrong], equations.residual[wrong])
        state[active] = _moved(state[active], -direction, equations.trust[wrong])
    return state, error


def _finish(state: Array, log_load: Array, closure: Closure, mesh: Mesh) -> tuple[Array, Array]:
    """Return h and dh/d ln xi."""
    equations = _balance(state, log_load, closure, mesh)
    tangent, excess = _solve(equations.jacobian, -equations.drift), np.expm1(state[:, :-1])
    depth, load = reference_heights(state[:, -1]), np.exp(log_load)
    displacement = (mesh.edge_influence * excess).sum(axis=1) - depth.log_sine
    growth = (mesh.edge_influence * (excess + (1 + excess) * tangent[:, :-1])).sum(axis=1) - depth.log_sine
    rate = load * growth + tangent[:, -1] * _deepening(state[:, -1], load)
    return depth.total + load * displacement, rate


def _deepening(edge: Array, load: Array) -> Array:
    """Return the derivative of h with respect to the edge at fixed density."""
    return np.where(edge >= 0, 1.0, reference_heights(edge).total - load)


def closure_sensitivity(state: Array, log_load: Array, closure: Closure, mesh: Mesh, h: Array) -> tuple[Array, Array]:
    """Return d ln h/d ln w at each node, shape (loads, K), by the adjoint equations; and ln p there."""
    load, equations = np.exp(log_load), _balance(state, log_load, closure, mesh)
    by_pressure = load[:, None] * mesh.edge_influence * np.exp(state[:, :-1])
    gradient = np.column_stack([by_pressure, _deepening(state[:, -1], load)])
    weight = _solve(equations.jacobian.transpose(0, 2, 1), gradient / h[:, None])[:, :-1]
    return -weight * equations.compression, equations.log_pressure


def _first_guess(log_load: Array, closure: Closure, mesh: Mesh) -> Array:
    """Return initial guesses: Westergaard's density, with edges from 2 sin^2(pi a) = 2 xi + w."""
    load = np.exp(log_load)
    sine_squared, w = np.minimum(1.0, load), np.zeros(load.size)
    for _ in range(GUESS_HALVINGS):
        crowding = np.maximum(0.0, np.log(np.pi / (2 * np.sqrt(sine_squared))))
        w = np.exp(log_compression(closure, log_load + crowding)[0])
        sine_squared = np.sqrt(sine_squared) * np.sqrt(np.minimum(1.0, load + w / 2))  # the product may underflow
    closed = load + w / 2 >= 1
    y = np.where(closed[:, None], 0.0, np.log(2 * mesh.rise))
    return np.column_stack([y, np.where(closed, w, np.log(sine_squared))])


def attainable(log_load: Array, tolerance: float) -> Array:
    """Return the tolerance, or the residual due to rounding of ln p if that is larger."""
    return np.maximum(tolerance, 1e-15 * np.abs(log_load))  # relative rounding of ln p: a few units in the last place


@np.errstate(all="ignore")  # overflow in a failed solution
def solve_waves(
    log_load: Array, closure: Closure, mesh: Mesh, tolerance: float, guess: Array | None = None
) -> Solutions:
    """Solve the wave under each load ln xi, from guessed states or others.

    The residual of a load that does not converge exceeds the tolerance or is NaN.
    """
    start = _first_guess(log_load, closure, mesh) if guess is None else guess
    state, residual = _newton(start, log_load, closure, mesh, attainable(log_load, tolerance))
    h, rate = _finish(state, log_load, closure, mesh)
    residual[~np.isfinite(rate)] = np.inf  # LAPACK may not detect a singular matrix
    return Solutions(h, np.maximum(rate, 0.0), residual, state)
