"""Who takes part, and how each is asked: same heights, same loads, from the heaviest down, one thread.

A contender says how long a whole curve takes (`seconds`) and yields the pressure under each load (`march`), to be
judged outside the clock. weier checks its residual itself. The others stop at a tolerance of their own, so each load
gets, before anything is timed, the loosest one that leaves the residual wanted: no one is timed for accuracy
that no one asked for.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as installed_version
from time import perf_counter
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from benchmarks.problem import Problem, Step, fourier, judge, linear_elements
from benchmarks.solvers import contact_mechanics, dense, slippy, tamaas, weier_fft

Array = NDArray[np.float64]

TIGHTEST = 2.0**-10  # of the residual wanted; what has not arrived by then never will
DENSE_LARGEST = 512  # four times the nodes take some fifty times as long


class Solver(Protocol):
    """One load after the other, each from the pressure of the one before."""

    def solve(self, load: float, start: Array | None, tolerance: float) -> Step:
        """The pressure under this load; `tolerance` in the solver's own measure."""


def of_package(name: str) -> str:
    """Name and version of an installed package.

    Raises
    ------
    LookupError
        If it is not installed, with what to do.

    """
    try:
        return f"{name} {installed_version(name)}"
    except PackageNotFoundError:
        raise LookupError(f'{name} is left out, for it is not installed: pip install ".[bench]"') from None


class Contender(NamedTuple):
    """A way to solve the problem.

    label : for people
    package : that it stands or falls with
    begin : a solver for a problem; its time counts
    eigenvalue : the operator of its discretisation, for (points, period)
    work : what its work counts
    counted : the same solver, counting its work where that takes time
    curve : whole curve in one call, where that is not a march of `begin`'s solver
    largest : most nodes it is asked for
    version : name and version of its package; LookupError where it is not installed
    """

    label: str
    package: str
    begin: Callable[[Problem], Solver]
    eigenvalue: Callable[[int, float], Array]
    work: str
    counted: Callable[[Problem], Solver] | None = None
    curve: Callable[[Problem], object] | None = None
    largest: float = np.inf
    version: Callable[[str], str] = of_package


PAIRS = "FFT pairs"


CONTENDERS = {
    "weier": Contender("weier", "numba", weier_fft.begin, linear_elements, PAIRS, curve=weier_fft.curve),
    "weier_resistance": Contender(
        "weier, with the resistance", "numba", weier_fft.begin_with_resistance, linear_elements, PAIRS,
        curve=weier_fft.curve_with_resistance,
    ),
    "tamaas": Contender("tamaas", "tamaas", tamaas.begin, fourier, PAIRS, tamaas.begin_counted),
    "contact_mechanics": Contender(
        "ContactMechanics", "ContactMechanics", contact_mechanics.begin, fourier, PAIRS
    ),
    "slippy": Contender("slippy", "slippy", slippy.begin, linear_elements, PAIRS, version=slippy.version),
    "dense": Contender(
        "dense inversion, NumPy", "numpy", dense.begin, linear_elements, "dense solutions", largest=DENSE_LARGEST
    ),
}  # fmt: skip


def march(solver: Solver, loads: Array, tolerance: Array) -> Iterator[Step]:
    """Steps from the heaviest load down, each from the one before, scaled to its load."""
    start = None
    for row in range(loads.size - 1, -1, -1):
        step = solver.solve(loads[row], start, tolerance[row])
        yield step
        start = step.pressure * (loads[row - 1] / loads[row])


def calibrate(contender: Contender, problem: Problem) -> Array:
    """The loosest own tolerance at which each load, on its march, leaves the residual wanted, shape (loads,)."""
    height, eigenvalue = problem.height, contender.eigenvalue(problem.points, problem.profile.period)
    solver = contender.begin(problem)
    tolerance = np.full(problem.loads.size, problem.tolerance)
    start = None
    for row in range(problem.loads.size - 1, -1, -1):
        load = problem.loads[row]
        while True:
            step = solver.solve(load, start, tolerance[row])
            residual = judge(problem, height, eigenvalue, load, step.pressure).residual
            if residual <= problem.tolerance or tolerance[row] <= TIGHTEST * problem.tolerance:
                break
            tolerance[row] /= 2
        start = step.pressure * (problem.loads[row - 1] / load)
    return tolerance


def seconds(contender: Contender, problem: Problem, tolerance: Array) -> float:
    """Time for the whole curve, from heights to pressures, set-up included."""
    begin = perf_counter()
    if contender.curve:
        contender.curve(problem)
    else:
        deque(march(contender.begin(problem), problem.loads, tolerance), maxlen=0)
    return perf_counter() - begin
