"""slippy: the conjugate gradients of Polonsky and Keer, run in a process of its own.

slippy 0.5.2 needs an older NumPy than weier, hence an environment of its own: SLIPPY_PYTHON names its interpreter.
Transfer of arrays takes well below a millisecond per load.
"""

from __future__ import annotations

import os
import pickle
import subprocess
from array import array
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.problem import Problem, Step, linear_elements
from weier.kernels.arrays import Array

ITERATIONS = 20_000  # More than any load needs, so that only the tolerance ends the iteration.
HINT = "slippy is left out: set SLIPPY_PYTHON to its interpreter, see benchmarks/slippy-requirements.txt"


class Worker:
    """The process in which slippy runs."""

    def __init__(self, python: str) -> None:
        script = Path(__file__).with_name("slippy_worker.py")
        # -I isolates the interpreter, which would otherwise import this file as slippy.
        self.process = subprocess.Popen([python, "-I", script], stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def request(self, name: str, *arguments: object) -> Any:
        """Return the answer to one request; RuntimeError if the process has ended."""
        assert self.process.stdin
        assert self.process.stdout
        try:
            pickle.dump((name, arguments), self.process.stdin, protocol=4)
            self.process.stdin.flush()
            return pickle.load(self.process.stdout)
        except (EOFError, BrokenPipeError):
            raise RuntimeError("the process that ran slippy has ended: see its message above") from None


@cache
def worker() -> Worker:
    """Return the process of all runs; LookupError, with the remedy, if SLIPPY_PYTHON is not set."""
    python = os.environ.get("SLIPPY_PYTHON")
    if not python:
        raise LookupError(HINT)
    return Worker(python)


def version(package: str) -> str:
    """Return name and version in the environment of slippy."""
    return f"{package} {worker().request('version')}"


def processor_seconds() -> float:
    """Return the processor seconds of slippy's process so far."""
    return float(worker().request("processor_seconds"))


class PolonskyKeer:
    """A planned convolution and the solver."""

    def __init__(self, problem: Problem) -> None:
        eigenvalue = linear_elements(problem.points, problem.profile.period)
        worker().request("begin", _plain(problem.height), _plain(eigenvalue))

    def solve(self, load: float, start: Array | None, tolerance: float) -> Step:
        """Solve from a given pressure; `tolerance` is the relative change of the pressure in a step."""
        begin = None if start is None or not np.isfinite(start).all() else _plain(start)
        pressure, pairs, converged = worker().request("solve", float(load), begin, float(tolerance), ITERATIONS)
        return Step(np.array(pressure), pairs, converged)


def _plain(values: Array) -> array[float]:
    """Return numbers in a form that pickles across versions of NumPy."""
    return array("d", values.tobytes())


def begin(problem: Problem) -> PolonskyKeer:
    """Return a solver with its FFT plans."""
    return PolonskyKeer(problem)
