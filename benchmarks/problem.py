"""The problem that all programs solve, and how a solution is examined: operators, residual and reference."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier import Profile, solve
from weier.kernels.arrays import Array
from weier.theory.halfplane import eigenvalues

REFERENCE_TOLERANCE = 1e-11  # g_0: all programs are compared with contact patches at this tolerance.


class Problem(NamedTuple):
    """A profile on equally spaced nodes under increasing mean pressures, and the residual allowed, in g_0."""

    profile: Profile
    loads: Array
    points: int
    tolerance: float

    @property
    def height(self) -> Array:
        """Profile at the nodes, shape (points,), in g_0."""
        return self.profile.sampled_height(self.points)


class Step(NamedTuple):
    """The solution for one load.

    pressure : at the nodes, shape (points,), in p_0*
    work : cost in the program's own unit
    converged : whether the solver says that it converged
    compliance : in g_0, if the program corrects the compliance of its nodal pressure
    """

    pressure: Array
    work: float
    converged: bool
    compliance: float | None = None


class Examination(NamedTuple):
    """Compliance and largest violation of a contact condition, in g_0, and relative load error."""

    compliance: float
    residual: float
    load_error: float


def linear_elements(points: int, period: float) -> Array:
    """Return displacement per pressure of each wave for piecewise-linear pressure: the paper's elements."""
    return eigenvalues(points, period)


def fourier(points: int, period: float) -> Array:
    """Return displacement per pressure of each wave for trigonometric pressure: the 1/|k| kernel of FFT codes."""
    waves = np.arange(1, points // 2 + 1)
    return np.concatenate([[0.0], period / waves])


def examine(problem: Problem, height: Array, eigenvalue: Array, load: float, pressure: Array) -> Examination:
    """Apply the operator afresh, and find the largest violation of a contact condition.

    Violations are |gap| under pressure, penetration elsewhere, and tension times A_ii. The rigid plane is at the mean
    deformed height of the nodes under pressure. Without positive pressure the compliance is NaN, the residual inf.
    """
    deformed = height - np.fft.irfft(eigenvalue * np.fft.rfft(pressure), problem.points)
    contact = pressure > 0
    if not contact.any():
        return Examination(np.nan, np.inf, 1.0)
    plane = deformed[contact].mean()
    gap = plane - deformed
    node = np.fft.irfft(eigenvalue, problem.points)[0]
    residual = max(np.abs(gap[contact]).max(), -gap.min(), -pressure.min() * node)
    return Examination(problem.profile.total_amplitude - plane, residual, abs(pressure.mean() / load - 1))


def find_reference(profile: Profile, loads: Array) -> Array:
    """Return the compliance by contact patches, which have more correct digits than any grid here."""
    return np.asarray(solve(profile, loads, method="patches", tolerance=REFERENCE_TOLERANCE)["compliance"])
