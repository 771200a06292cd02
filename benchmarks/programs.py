"""The programs compared, each given the same heights and the same loads, from the heaviest down, on one thread.

`seconds` times a whole curve of a program, and `solve_loads` yields the pressure under each load, which is examined
outside the timed part. weier checks its residual itself; the others stop at a tolerance of their own. Before the
measurement, `calibrate` finds the loosest such tolerance that meets the target residual at each load, so that no
program spends time on more accuracy.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as installed_version
from time import process_time
from typing import NamedTuple, Protocol

import numpy as np

from benchmarks.problem import Problem, Step, examine, fourier, linear_elements
from benchmarks.solvers import contact_mechanics, dense, slippy, tamaas, weier_fft
from weier.kernels.arrays import Array

# smallest tolerance tried over target residual: a solver that still misses the residual never reaches it
MIN_TOLERANCE = 2.0**-10
MAX_DENSE_POINTS = 512  # Four times as many nodes take some fifty times as long.


class Solver(Protocol):
    """Solves one load after the other, each from the pressure of the one before it."""

    def solve(self, load: float, start: Array | None, tolerance: float) -> Step:
        """Return the pressure under this load; `tolerance` is in the solver's own measure."""


def installed_package(name: str) -> str:
    """Return name and version of a package; LookupError, with the command to install it, if it is missing."""
    try:
        return f"{name} {installed_version(name)}"
    except PackageNotFoundError:
        raise LookupError(f'{name} is left out, because it is not installed: pip install ".[bench]"') from None


class Program(NamedTuple):
    """A program that solves the problem.

    label : name for people
    package : the package to install
    begin : returns a solver for a problem; its time is measured
    eigenvalue : the operator of its discretisation, for (points, period)
    work : unit of its work
    counted : as `begin`, for a slower solver that counts its work
    curve : solves the whole curve in one call, without `begin`
    max_points : largest grid
    version : returns name and version of its package; raises LookupError if it is missing
    clock : returns the processor seconds used so far
    """

    label: str
    package: str
    begin: Callable[[Problem], Solver]
    eigenvalue: Callable[[int, float], Array]
    work: str
    counted: Callable[[Problem], Solver] | None = None
    curve: Callable[[Problem], object] | None = None
    max_points: float = np.inf
    version: Callable[[str], str] = installed_package
    clock: Callable[[], float] = process_time


PAIRS = "FFT pairs"


PROGRAMS = {
    "weier": Program(
        "weier, staircase kept",
        "numba",
        weier_fft.begin,
        linear_elements,
        PAIRS,
        curve=weier_fft.curve,
    ),
    "weier_default": Program(
        "weier, staircase removed",
        "numba",
        weier_fft.begin_default,
        linear_elements,
        PAIRS,
        curve=weier_fft.curve_default,
    ),
    "tamaas": Program("tamaas", "tamaas", tamaas.begin, fourier, PAIRS, tamaas.begin_counted),
    "contact_mechanics": Program("ContactMechanics", "ContactMechanics", contact_mechanics.begin, fourier, PAIRS),
    "slippy": Program(
        "slippy",
        "slippy",
        slippy.begin,
        linear_elements,
        PAIRS,
        version=slippy.version,
        clock=slippy.processor_seconds,
    ),
    "dense": Program(
        "dense inversion, NumPy",
        "numpy",
        dense.begin,
        linear_elements,
        "dense solutions",
        max_points=MAX_DENSE_POINTS,
    ),
}


def solve_loads(solver: Solver, loads: Array, tolerance: Array) -> Iterator[Step]:
    """Solve from the heaviest load down; each load starts from the previous pressure, scaled to its load."""
    start = None
    for row in range(loads.size - 1, -1, -1):
        step = solver.solve(loads[row], start, tolerance[row])
        yield step
        start = step.pressure * (loads[row - 1] / loads[row])


def calibrate(program: Program, problem: Problem) -> Array:
    """Return the loosest tolerance of the solver at which each load meets the target residual, shape (loads,).

    Programs that solve a whole curve in one call take the residual as their tolerance.
    """
    if program.curve:
        return np.full(problem.loads.size, problem.tolerance)
    height, eigenvalue = problem.height, program.eigenvalue(problem.points, problem.profile.period)
    solver = program.begin(problem)
    tolerance = np.full(problem.loads.size, problem.tolerance)
    start = None
    for row in range(problem.loads.size - 1, -1, -1):
        load = problem.loads[row]
        while True:
            step = solver.solve(load, start, tolerance[row])
            residual = examine(problem, height, eigenvalue, load, step.pressure).residual
            if residual <= problem.tolerance or tolerance[row] <= MIN_TOLERANCE * problem.tolerance:
                break
            tolerance[row] /= 2
        start = step.pressure * (problem.loads[row - 1] / load)
    return tolerance


def seconds(program: Program, problem: Problem, tolerance: Array) -> float:
    """Return processor seconds for the whole curve, from heights to pressures, including set-up."""
    begin = program.clock()
    if program.curve:
        program.curve(problem)
    else:
        deque(solve_loads(program.begin(problem), problem.loads, tolerance), maxlen=0)
    return program.clock() - begin
