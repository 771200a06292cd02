"""The programs compared, each given the same heights and the same loads, from the heaviest down, on one thread.

`seconds` times a whole curve of a program, and `solve_loads` yields the pressure under each load, which is examined
outside the timed part. weier checks its residual itself. The others stop at a tolerance of their own. Before anything
is timed, each load therefore gets the loosest such tolerance that leaves the residual wanted, so that no program
spends time on more accuracy than that.
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

# The smallest tolerance tried, over the wanted residual: a solver that misses the residual then never reaches it.
MIN_TOLERANCE = 2.0**-10
MAX_DENSE_POINTS = 512  # Four times as many nodes take some fifty times as long.


class Solver(Protocol):
    """Solves one load after the other, each from the pressure of the one before it."""

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
        raise LookupError(f'{name} is left out, because it is not installed: pip install ".[bench]"') from None


class Program(NamedTuple):
    """A program that solves the problem.

    label : name for people
    package : that must be installed for it
    begin : a solver for a problem; its time counts
    eigenvalue : the operator of its discretisation, for (points, period)
    work : what its work counts
    counted : the same solver, counting its work where that takes time
    curve : whole curve in one call, where the program has one that does not go through `begin`'s solver
    max_points : largest number of nodes that it is run on
    version : name and version of its package; raises LookupError where it is not installed
    clock : processor seconds that the program has taken so far
    """

    label: str
    package: str
    begin: Callable[[Problem], Solver]
    eigenvalue: Callable[[int, float], Array]
    work: str
    counted: Callable[[Problem], Solver] | None = None
    curve: Callable[[Problem], object] | None = None
    max_points: float = np.inf
    version: Callable[[str], str] = of_package
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
    """Steps from the heaviest load down, each from the one before, scaled to its load."""
    start = None
    for row in range(loads.size - 1, -1, -1):
        step = solver.solve(loads[row], start, tolerance[row])
        yield step
        start = step.pressure * (loads[row - 1] / loads[row])


def calibrate(program: Program, problem: Problem) -> Array:
    """The loosest own tolerance at which each load leaves the residual wanted, shape (loads,).

    It is the residual itself for programs that are called for a whole curve: they check it themselves.
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
    """Processor seconds for the whole curve, from heights to pressures, set-up included."""
    begin = program.clock()
    if program.curve:
        program.curve(problem)
    else:
        deque(solve_loads(program.begin(problem), problem.loads, tolerance), maxlen=0)
    return program.clock() - begin
