"""Curves under the same loads, solved one after another, or side by side in several processes.

Python computes between the kernels of a solver, and all threads of a process share one Python, so that threads would
wait for each other. What a curve needs goes to another process, and its arrays come back.
"""

from __future__ import annotations

import json
import os
import signal
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from multiprocessing import current_process, get_context
from threading import Thread
from typing import TYPE_CHECKING, Any, NamedTuple

from weier.kernels import jit
from weier.kernels.arrays import Array
from weier.methods.errors import ConvergenceError, NotApplicableError
from weier.methods.progress import telling
from weier.methods.registry import find_method
from weier.methods.solve import solve_checked
from weier.pipeline.progress import Loads, Progress
from weier.theory.profile import PARAMETERS
from weier.theory.waves import Waves

if TYPE_CHECKING:
    from multiprocessing.connection import Connection
    from multiprocessing.sharedctypes import Synchronized

FIRST = "MainProcess"  # of Python, which names processes that others start by a number
LOST = (
    "a process that was to solve curves has ended too early: a script must be a file that calls weier.solve below "
    '`if __name__ == "__main__":`, since each process imports it anew; if yours is, take fewer workers, since memory '
    "may have been short"
)


class Curve(NamedTuple):
    """One curve to be solved: of a surface, by the method of this name, with settings that were checked."""

    profile: Waves
    method: str
    settings: Mapping[str, Any]


# What a method says of a curve and the seconds that it took, or why there is none.
Outcome = tuple[Any, float] | NotApplicableError | ConvergenceError
Futures = set[Future[list[tuple[int, Outcome]]]]


class Solver:
    """Solves curves one after another under increasing loads of shape (loads,), and counts the loads.

    Curves that do not depend on the phases are known once one profile of an ensemble is solved.
    """

    def __init__(self, loads: Array, add: Callable[[int], object]) -> None:
        """Under `loads`; `add` takes numbers of loads that are done."""
        self.loads, self.count, self.known = loads, Loads(loads.size, add), dict[object, tuple[Any, float]]()

    def __call__(self, curve: Curve) -> Outcome:
        """What a method says of a curve, or why it says nothing."""
        outcome: Outcome
        try:
            with telling(self.count):
                outcome = self._solve(*curve)
        except (NotApplicableError, ConvergenceError) as error:
            outcome = error.with_traceback(None)  # which would keep the arrays of the solver
        self.count.end_curve()
        return outcome

    def _solve(self, profile: Any, name: str, settings: Mapping[str, Any]) -> tuple[Any, float]:
        method = find_method(name)
        if method.uses_phases:
            return solve_checked(profile, self.loads, method, settings)
        method.check_applies(profile)  # a trace has no D
        same = name, *(getattr(profile, parameter) for parameter in PARAMETERS), json.dumps(settings, sort_keys=True)
        if same not in self.known:
            self.known[same] = solve_checked(profile, self.loads, method, settings)
        return self.known[same]


def solve_curves(
    curves: Sequence[Curve], loads: Array, workers: int, pause: float, say: Callable[[str], None]
) -> Iterable[Outcome]:
    """What is to be had of each curve, in their order.

    Parameters
    ----------
    curves : sequence of Curve
        Those of one profile beside each other.
    loads : ndarray, shape (loads,)
        Increasing, in p_0*.
    workers : int
        Processes, this one among them. The bits do not depend on how many there are.
    pause : float
        Seconds between two words of how far all curves are.
    say : callable
        Takes them.

    Raises
    ------
    ChildProcessError
        If a process ends that should not.
    """
    progress = Progress(len(curves) * loads.size, pause, say)
    if (workers := min(workers, len(curves))) > 1:
        return _side_by_side(curves, loads, workers, progress)
    return map(Solver(loads, progress.add), curves)


def _side_by_side(curves: Sequence[Curve], loads: Array, workers: int, progress: Progress) -> list[Outcome]:
    """The same by this process and others: each takes the next curve when it has solved one.

    Another process takes about a second to import what it needs, in which this one has solved some curves.
    """
    context = get_context("spawn")  # a copy of this process would wait for ever for locks that its threads hold
    taken, done, (there, here) = context.Value("q"), context.Value("q"), context.Pipe(duplex=False)
    pool = ProcessPoolExecutor(workers - 1, context, _begin, (there, taken, done))
    try:
        others = _submit(pool, workers - 1, curves, loads)
        solved = {}
        for number, outcome in _solve_next(curves, loads, taken, lambda more: progress.tell(_add(done, more))):
            solved[number] = outcome
            _check(others)
        while len(solved) < len(curves):
            finished, others = wait(others, timeout=progress.pause, return_when=FIRST_COMPLETED)
            solved |= {number: outcome for future in finished for number, outcome in future.result()}
            progress.tell(done.value)
        return [solved[number] for number in range(len(curves))]
    except BrokenProcessPool:
        raise ChildProcessError(LOST) from None
    finally:
        here.close()
        there.close()
        pool.shutdown()


def _solve_next(
    curves: Sequence[Curve], loads: Array, taken: Synchronized[int], add: Callable[[int], object]
) -> Iterator[tuple[int, Outcome]]:
    """Curves that no other process has taken, with their numbers."""
    solve = Solver(loads, add)
    while (number := _add(taken, 1) - 1) < len(curves):
        yield number, solve(curves[number])


def _add(value: Synchronized[int], number: int) -> int:
    """Add to a value that processes share; the sum."""
    with value.get_lock():
        value.value += number
        return value.value


def _submit(pool: ProcessPoolExecutor, workers: int, *problem: Any) -> Futures:
    """Start all processes of a pool.

    Ctrl-C in a terminal goes to all processes. It is kept from these, which would each print where they were: they
    end with the one that started them.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        return {pool.submit(_solve, *problem) for _ in range(workers)}
    except RuntimeError:
        if current_process().name == FIRST:
            raise
        sys.exit(1)  # of a process that imports a script which would start others from it: see LOST
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _check(others: Futures) -> None:
    """Raise what has ended another process."""
    for future in others:
        if future.done():
            future.result()


# The numbers of another process, which it shares with this one.
_taken: Synchronized[int]
_done: Synchronized[int]


def _begin(first: Connection, taken: Synchronized[int], done: Synchronized[int]) -> None:
    """What another process begins with."""
    global _taken, _done
    _taken, _done = taken, done
    Thread(target=_end_with, args=(first,), daemon=True).start()
    jit.LISTENERS.clear()  # the first process compiles, too, and announces it


def _end_with(first: Connection) -> None:
    """End this process at once, in the midst of a kernel, when the first one closes a pipe or ends."""
    first.poll(None)
    os._exit(0)


def _solve(curves: Sequence[Curve], loads: Array) -> list[tuple[int, Outcome]]:
    """What another process solves."""
    return list(_solve_next(curves, loads, _taken, partial(_add, _done)))
