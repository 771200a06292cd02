"""Newton's method for the nodal unknowns and the rigid plane, with linear equations by GMRES.

docs/hybrid.md derives the formulas: "The equations" and "Newton's method".
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy  # its modules are imported on first use, a tenth of a second each

from weier.kernels.arrays import Array
from weier.methods.errors import ConvergenceError
from weier.methods.hybrid.closure import NodalClosure, pressure_at, unknown_at
from weier.methods.progress import count_load
from weier.surface.profile import Profile
from weier.theory.halfplane import eigenvalues

MAX_STEPS = 60
# relative residuals of GMRES: for a step, which the next one corrects, and for the resistance
STEP_ACCURACY, RESISTANCE_ACCURACY = 1e-6, 1e-9
DIRECTIONS, RESTARTS = 80, 10  # some tens of directions reach these residuals
# largest residual, in g_0; no setting, since the stated error is that of the terms left out: take more terms
TOLERANCE = 1e-9


class ContactProblem(NamedTuple):
    """Resolved surface on its layer.

    height : z at the nodes, shape (N,), in g_0
    influence : eigenvalues of the off-diagonal part A' of the influence matrix
    closure : closure of the layer at a node
    """

    height: Array
    influence: Array
    closure: NodalClosure


def solve_loads(kept: Profile, loads: Array, points: int, closure: NodalClosure) -> tuple[Array, Array, Array]:
    """Return compliance, resistance and residual; each load starts from the next heavier one."""
    influence = eigenvalues(points, kept.period) - closure.self_influence
    problem = ContactProblem(kept.sampled_height(points), influence, closure)
    h, R, residual = np.zeros((3, loads.size))
    state = _full_contact(problem, float(loads[-1]))
    for i in reversed(range(loads.size)):
        state, residual[i] = _solve_load(problem, state, float(loads[i]))
        h[i] = kept.total_amplitude - state[-1]
        R[i] = _resistance(problem, state)
        count_load()
    return h, R, residual


def _full_contact(problem: ContactProblem, load: float) -> Array:
    """Return an initial state, Y at every node and the height H of the plane.

    The pressure is that of full contact on a linear layer with the stiffness at the mean pressure.
    """
    z, closure = problem.height, problem.closure
    mean = np.array([load])
    unknown = unknown_at(mean, closure)
    _, slope = pressure_at(unknown, closure)
    spectrum = np.fft.rfft(z)
    spectrum[1:] /= problem.influence[1:] + 1 / slope
    spectrum[0] = load * z.size
    return np.append(unknown_at(np.fft.irfft(spectrum, z.size), closure), -unknown[0])


def _solve_load(problem: ContactProblem, state: Array, load: float) -> tuple[Array, float]:
    """Solve by Newton's method from this state; return the solution and its residual, in g_0."""
    for _ in range(MAX_STEPS):
        p, slope = pressure_at(state[:-1], problem.closure)
        gap = state[:-1] + _displacement(p, problem.influence) - problem.height + state[-1]
        violation = np.append(gap, p.mean() - load)
        residual = float(np.max(np.abs(violation)))
        if residual <= TOLERANCE and abs(violation[-1]) <= 1e-7 * load:  # largest relative error of the load
            return state, residual
        state = state - _linear_solution(problem, slope, violation, STEP_ACCURACY)
    raise ConvergenceError(
        f"the resolved terms on the layer stopped at a residual of {residual:.1e} g_0 under the mean pressure "
        f"{load:.6g} p_0*, above {TOLERANCE:.0e}: resolve fewer terms",
        residual,
    )


def _resistance(problem: ContactProblem, state: Array) -> float:
    """Return the resistance, -dH/dp, in g_0/p_0*."""
    unit = np.append(np.zeros(problem.height.size), 1.0)
    _, slope = pressure_at(state[:-1], problem.closure)
    plane_per_load = float(_linear_solution(problem, slope, unit, RESISTANCE_ACCURACY)[-1])
    return max(-plane_per_load, 0.0)  # near full contact it is below its accuracy and may be negative


def _displacement(pressure: Array, influence: Array) -> Array:
    """Return A' p, by FFT."""
    return np.asarray(np.fft.irfft(np.fft.rfft(pressure) * influence, pressure.size))


def _linear_solution(problem: ContactProblem, slope: Array, right: Array, accuracy: float) -> Array:
    """Solve the linear equations of a Newton step by GMRES, preconditioned by those of a uniform layer.

    [1 + A' diag(dp/dY), 1; <dp/dY .>, 0] [dY; dH] = right
    """
    n, influence, dp = right.size - 1, problem.influence, float(slope.mean())

    def equations(x: Array) -> Array:
        p = slope * x[:-1]
        return np.append(x[:-1] + _displacement(p, influence) + x[-1], p.mean())

    def uniform(r: Array) -> Array:
        spectrum = np.fft.rfft(r[:-1])
        spectrum[1:] /= 1 + dp * influence[1:]
        plane = spectrum[0].real / n - (1 / dp + influence[0]) * r[-1]
        spectrum[0] = n * r[-1] / dp
        return np.append(np.fft.irfft(spectrum, n), plane)

    size = (n + 1, n + 1)
    operator = scipy.sparse.linalg.LinearOperator
    solution, _ = scipy.sparse.linalg.gmres(
        operator(size, equations),
        right,
        rtol=accuracy,
        atol=0.0,
        restart=DIRECTIONS,
        maxiter=RESTARTS,
        M=operator(size, uniform),
    )
    return np.asarray(solution)
