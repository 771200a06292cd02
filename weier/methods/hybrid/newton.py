"""Newton's method for the nodes and the flat, its linear equations by GMRES."""

from __future__ import annotations

import numpy as np
import scipy  # its parts load when they are used: a tenth of a second each, that few jobs need
from numpy.typing import NDArray

from weier.methods.errors import ConvergenceError
from weier.methods.hybrid.closure import Law, Node, state_of_nodes
from weier.theory.halfplane import eigenvalues
from weier.theory.profile import Profile

Array = NDArray[np.float64]

NEWTON_STEPS = 60
STEP_ACCURACY, RATE_ACCURACY = 1e-6, 1e-9  # relative residuals of the linear equations of a step, of dh/dp
DIRECTIONS, RESTARTS = 80, 10  # of GMRES: some tens of directions reach these residuals
TOLERANCE = 1e-9  # of the residual, in g_0


def solve_loads(kept: Profile, loads: Array, points: int, law: Law) -> tuple[Array, Array, Array]:
    """Compliance, resistance and residual, from the heaviest load down, each started from the one before."""
    z, sinking = kept.sampled_height(points), eigenvalues(points, kept.period)
    h, R, miss = np.zeros((3, loads.size))
    state = _start(z, sinking, float(loads[-1]), law)
    for i in reversed(range(loads.size)):
        state, miss[i] = _newton(state, z, sinking, float(loads[i]), law)
        h[i] = kept.total_amplitude - state[-1]
        # By how much the flat sinks is the equations' answer to a unit of load.
        unit = np.append(np.zeros(points), 1.0)
        rate = _newton_step(state_of_nodes(state[:-1], law), sinking, unit, RATE_ACCURACY)[-1]
        R[i] = max(-rate, 0.0)  # close to full contact the rate is below its own accuracy, of either sign
    return h, R, miss


def _start(z: Array, sinking: Array, load: float, law: Law) -> Array:
    """A state from full contact under this load: s at every node, then the flat."""
    spectrum = np.fft.rfft(z)
    spectrum[1:] /= sinking[1:]
    spectrum[0] = load * z.size
    p = np.fft.irfft(spectrum, z.size)
    return np.append(law.stiffness * p, 0.0)


def _newton(state: Array, z: Array, sinking: Array, load: float, law: Law) -> tuple[Array, float]:
    """Newton's method from this state: the solution, and its residual in g_0."""
    for _ in range(NEWTON_STEPS):
        node = state_of_nodes(state[:-1], law)
        wrong = np.append(
            node.compression + _sunk(node.pressure, sinking) - z + state[-1], node.pressure.mean() - load
        )
        miss = float(np.max(np.abs(wrong)))
        if miss <= TOLERANCE:
            return state, miss
        state = state - _newton_step(node, sinking, wrong, STEP_ACCURACY)
    raise ConvergenceError(
        f"the resolved terms on the layer stopped at a residual of {miss:.1e} g_0 under the mean pressure {load:.6g} "
        f"p_0*, above {TOLERANCE:.0e}: resolve fewer terms",
        miss,
    )


def _sunk(pressure: Array, sinking: Array) -> Array:
    """A p by FFT."""
    return np.asarray(np.fft.irfft(np.fft.rfft(pressure) * sinking, pressure.size))


def _newton_step(node: Node, sinking: Array, right: Array, accuracy: float) -> Array:
    """The linear equations of a Newton step, by GMRES, preconditioned by those of a uniform layer.

    [diag(dw/ds) + A diag(dp/ds), 1; mean of dp/ds, 0] [ds; dflat] = right
    """
    n, yielding, bearing = right.size - 1, float(node.compression_slope.mean()), float(node.pressure_slope.mean())

    def equations(x: Array) -> Array:
        p = node.pressure_slope * x[:-1]
        return np.append(node.compression_slope * x[:-1] + _sunk(p, sinking) + x[-1], p.mean())

    def uniform(r: Array) -> Array:
        spectrum = np.fft.rfft(r[:-1])
        spectrum[1:] /= yielding + bearing * sinking[1:]
        flat = spectrum[0].real / n - yielding * r[-1] / bearing
        spectrum[0] = n * r[-1] / bearing
        return np.append(np.fft.irfft(spectrum, n), flat)

    size = (n + 1, n + 1)
    operator = scipy.sparse.linalg.LinearOperator
    found, _ = scipy.sparse.linalg.gmres(
        operator(size, equations), right, rtol=accuracy, atol=0.0, restart=DIRECTIONS, maxiter=RESTARTS,
        M=operator(size, uniform),
    )  # fmt: skip
    return np.asarray(found)
