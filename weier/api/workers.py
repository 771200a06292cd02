"""Solution of curves with equal numbers of loads, sequentially or in several processes.

A solver runs Python code between its kernels, so that threads would wait for the interpreter lock. Other processes
receive tasks and return arrays instead.
"""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import current_process, get_context, parent_process
from threading import Thread

from weier.api.progress import Loads, Progress
from weier.api.rows import Outcome
from weier.api.task import CurveTask
from weier.methods.errors import ConvergenceError, NotApplicableError
from weier.methods.load_progress import reporting_to

# The message when the process pool breaks.
LOST = (
    "a process that was to solve curves has ended too early: a script must be a file that calls weier.solve below "
    '`if __name__ == "__main__":`, since each process imports it anew; if yours is, take fewer workers, since memory '
    "may have been short"
)


class Solver:
    """Solves curves one after another, and counts their loads.

    Curves that do not depend on the phases are solved once for all profiles of an ensemble.
    """

    def __init__(self, loads: int, add: Callable[[int], object]) -> None:
        """Take the number of loads per curve, and `add`, which is called with the number of finished loads."""
        self.count, self.known = Loads(loads, add), dict[object, Outcome]()

    def __call__(self, curve: CurveTask) -> Outcome:
        """Return the solution of a curve, or the error."""
        outcome: Outcome | None = self.known.get(series := curve.series)
        try:
            with reporting_to(self.count):
                outcome = outcome or curve.solve()
        except (NotApplicableError, ConvergenceError) as error:
            outcome = error.with_traceback(None)  # the traceback would keep the solver's arrays alive
        self.count.end_curve()
        if series is not None:
            self.known[series] = outcome
        return outcome


def solve_curves(
    curves: Sequence[CurveTask], workers: int, pause: float, say: Callable[[str], None]
) -> Iterable[Outcome]:
    """Return the outcome of each curve, in the order of `curves`.

    Parameters
    ----------
    curves : sequence of CurveTask
        Curves of the same profile are adjacent, and all have the same number of loads.
    workers : int
        Number of processes; only this one for 1, or in a daemonic process (as of `multiprocessing.Pool`), which may
        not start others. The results are bitwise independent of it.
    pause : float
        Seconds between two messages of progress.
    say : callable
        Called with these messages.

    Raises
    ------
    ChildProcessError
        If a process ends unexpectedly.
    """
    loads = curves[0].loads.size if curves else 0
    progress = Progress(len(curves) * loads, pause, say)
    if (workers := min(workers, len(curves))) > 1 and not current_process().daemon:
        return _side_by_side(curves, loads, workers, progress)
    return map(Solver(loads, progress.add), curves)


def _side_by_side(curves: Sequence[CurveTask], loads: int, workers: int, progress: Progress) -> Iterator[Outcome]:
    """Yield the outcomes by other processes.

    They are spawned, since a forked process could deadlock on locks held by threads of this one.
    """
    try:
        with ProcessPoolExecutor(workers, get_context("spawn"), _begin, (loads,)) as pool:
            for outcome in pool.map(_solve, curves):
                progress.add(loads)
                yield outcome
    except BrokenProcessPool:
        raise ChildProcessError(LOST) from None
    except RuntimeError as error:
        if "bootstrapping" not in str(error):
            raise
        raise SystemExit(1) from None  # the script lacks the guard; the parent reports it


def _begin(loads: int) -> None:
    """Prepare a process that solves curves: it ends with its parent, and silently by Ctrl-C."""
    global _solver
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    Thread(target=_end_with_parent, daemon=True).start()
    _solver = Solver(loads, lambda number: None)


def _end_with_parent() -> None:
    """End this process, even within a kernel, when its parent has ended or was killed."""
    if parent := parent_process():
        parent.join()
        os._exit(1)


_solver: Solver  # set by `_begin` in each worker process


def _solve(curve: CurveTask) -> Outcome:
    return _solver(curve)
