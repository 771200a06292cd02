"""Ctrl-C in the midst of a solve: Python sees it between two of its own steps, and a kernel may take minutes.

What the main thread would solve, another one solves, while the main thread waits and can be interrupted. It then asks
all solves of the process to stop: kernels look at a flag, and Python code is interrupted where it stands.
"""

from __future__ import annotations

import ctypes
import functools
import threading
from collections.abc import Callable
from concurrent.futures import Future
from contextvars import copy_context
from functools import partial
from typing import Any, ParamSpec, TypeVar

import numpy as np

Given = ParamSpec("Given")
Result = TypeVar("Result")

ASKED = np.zeros(1, np.int64)  # 1 when solves are to stop; kernels know its address
PATIENCE = 1.0  # seconds until the main thread goes on without a solve that has not stopped, such as one in LAPACK


def stop_if_asked() -> None:
    """Raise InterruptedError where a solve is to stop: for loops whose steps take a millisecond or more."""
    if ASKED[0] != 0:
        raise InterruptedError


class _Solves:
    """How many are running: the flag falls when the last one has stopped, and nobody starts before."""

    def __init__(self) -> None:
        self.running = 0
        self.changed = threading.Condition()

    def __enter__(self) -> None:
        with self.changed:
            self.changed.wait_for(lambda: ASKED[0] == 0)
            self.running += 1

    def __exit__(self, *failure: object) -> None:
        with self.changed:
            self.running -= 1
            if self.running == 0:
                ASKED[0] = 0
                self.changed.notify_all()

    def ask_to_stop(self) -> None:
        with self.changed:
            ASKED[0] = int(self.running > 0)


_SOLVES = _Solves()
_WITHIN = threading.local()  # a solve, which may begin others
ask_to_stop = _SOLVES.ask_to_stop


def interruptible(solve: Callable[Given, Result]) -> Callable[Given, Result]:
    """A function that ends by KeyboardInterrupt within a second or two of Ctrl-C, wherever it is.

    In a thread other than the main one, which Ctrl-C does not reach, it ends by InterruptedError.
    """

    @functools.wraps(solve)
    def run(*arguments: Given.args, **options: Given.kwargs) -> Result:
        work = partial(_counted, solve, *arguments, **options)
        return work() if threading.current_thread() is not threading.main_thread() else _in_another_thread(work)

    return run


def _counted(solve: Callable[..., Result], *arguments: Any, **options: Any) -> Result:
    if getattr(_WITHIN, "solve", False):
        return solve(*arguments, **options)
    with _SOLVES:
        _WITHIN.solve = True
        try:
            return solve(*arguments, **options)
        finally:
            _WITHIN.solve = False


def _in_another_thread(work: Callable[[], Result]) -> Result:
    outcome: Future[Result] = Future()
    context = copy_context()  # such as numpy's handling of overflow

    def run() -> None:
        try:
            outcome.set_result(context.run(work))
        except BaseException as error:
            outcome.set_exception(error)

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    try:
        return outcome.result()
    except KeyboardInterrupt:
        ask_to_stop()
        interrupt = ctypes.py_object(KeyboardInterrupt)
        ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread.ident or 0), interrupt)
        thread.join(PATIENCE)
        raise
