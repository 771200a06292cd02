"""Solution of curves, sequentially or in several processes.

A solver runs Python code between its kernels, so that threads would wait for the interpreter lock. Other processes
receive tasks and return arrays instead.
"""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import current_process, get_context, parent_process
from threading import Thread

from weier.api.progress import Progress
from weier.api.task import CurveTask, Outcome
from weier.methods.load_progress import reporting_to

# The message when the process pool breaks.
LOST = (
    "a process that was to solve curves has ended too early: a script must be a file that calls weier.solve below "
    '`if __name__ == "__main__":`, since each process imports it anew; if yours is, take fewer workers, since memory '
    "may have been short"
)


def solve_curves(curves: Sequence[CurveTask], workers: int, progress: Progress) -> Iterator[Outcome]:
    """Yield the outcome of each curve, in the order of `curves`; `progress` counts their loads.

    Other processes are spawned, since a forked process could deadlock on locks held by threads of this one. The
    results are bitwise independent of their number. A daemonic process (as of `multiprocessing.Pool`), which may not
    start others, solves alone.

    Raises
    ------
    ChildProcessError
        If a process ends unexpectedly.
    """
    if (workers := min(workers, len(curves))) > 1 and not current_process().daemon:
        try:
            with ProcessPoolExecutor(workers, get_context("spawn"), _begin) as pool:
                for curve, outcome in zip(curves, pool.map(CurveTask.outcome, curves), strict=True):
                    yield outcome
                    progress.reach(progress.done + curve.loads.size)
        except BrokenProcessPool:
            raise ChildProcessError(LOST) from None
        except RuntimeError as error:
            if "bootstrapping" not in str(error):
                raise
            raise SystemExit(1) from None  # the script lacks the guard; the parent reports it
        return
    done = 0
    for curve in curves:
        with reporting_to(progress):
            outcome = curve.outcome()
        done += curve.loads.size  # closed forms do not count their loads, and other methods solve some twice
        yield outcome
        progress.reach(done)


def _begin() -> None:
    """Prepare a process that solves curves: it ends with its parent, and silently by Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    """End this process, even within a kernel, when its parent has ended or was killed."""
    if parent := parent_process():
        parent.join()
        os._exit(1)
