"""Ctrl-C in the midst of a solve: Python sees it between two of its own steps, and a kernel may take minutes.

What the main thread would solve, another one solves, while the main thread waits and can be interrupted. It then asks
all solves of the process to stop: kernels look at a flag, and Python code is interrupted where it stands. A kernel is
not interrupted so: numba makes Python objects of what it returns, and an exception that comes from there crashes the
process.
"""

from __future__ import annotations

import ctypes
import functools
import threading
import time
from collections.abc import Callable
from contextvars import copy_context
from functools import partial
from typing import Any, ParamSpec, TypeVar

Given = ParamSpec("Given")
Result = TypeVar("Result")

ASKED = (ctypes.c_int64 * 1)()  # 1 when solves are to stop; kernels know its address, and jobs have no NumPy yet
PAUSE = 0.01  # seconds between looks at whether others have stopped
PATIENCE = 1.0  # seconds until the main thread goes on without a solve that has not stopped, such as one in LAPACK


def stop_if_asked() -> None:
    """Raise InterruptedError where a solve is to stop: for loops whose steps take a millisecond or more."""
    if ASKED[0] != 0:
        raise InterruptedError


class _Solves:
    """The threads that are solving: the flag falls when the last one has stopped, and nobody starts before.

    One that Ctrl-C interrupted as it was leaving has not said so, and is known by having ended.
    """

    def __init__(self) -> None:
        self.threads: set[threading.Thread] = set()
        self.lock = threading.Lock()

    def __enter__(self) -> None:
        while not self._begin():
            time.sleep(PAUSE)

    def _begin(self) -> bool:
        with self.lock:
            self._keep({thread for thread in self.threads if thread.is_alive()})
            if ASKED[0] == 0:
                self.threads.add(threading.current_thread())
            return ASKED[0] == 0

    def __exit__(self, *failure: object) -> None:
        with self.lock:
            self._keep(self.threads - {threading.current_thread()})

    def _keep(self, threads: set[threading.Thread]) -> None:
        self.threads = threads
        if not threads:
            ASKED[0] = 0

    def ask_to_stop(self) -> None:
        with self.lock:
            ASKED[0] = int(len(self.threads) > 0)


_SOLVES = _Solves()
_WITHIN = threading.local()  # a solve, which may begin others, and what is locked while it runs a kernel
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


def run_kernel(compiled: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    """Call compiled code, where no KeyboardInterrupt may come; it is looked for before and after."""
    lock = getattr(_WITHIN, "kernel", None)
    if lock is None:  # nobody interrupts this thread
        return compiled(*arguments)
    with lock:
        stop_if_asked()
        result = compiled(*arguments)
    stop_if_asked()
    return result


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
    from concurrent.futures import Future  # which takes longer than all that is imported above

    outcome: Future[Result] = Future()
    context = copy_context()  # such as numpy's handling of overflow
    kernel = threading.Lock()

    def run() -> None:
        _WITHIN.kernel = kernel
        if outcome.set_running_or_notify_cancel():
            try:
                outcome.set_result(context.run(work))
            except BaseException as error:
                outcome.set_exception(error)

    thread = threading.Thread(target=run, daemon=True)
    try:
        thread.start()
        return outcome.result()
    except KeyboardInterrupt:
        if not outcome.cancel() and thread.ident is not None:  # it has begun
            _interrupt(thread.ident, kernel)
            thread.join(PATIENCE)
        raise


def _interrupt(thread: int, kernel: threading.Lock) -> None:
    """Ask all solves to stop, and raise KeyboardInterrupt in this thread as soon as it is back in Python.

    Where its kernel, or the compiler, takes longer than PATIENCE, it stops at the end of that.
    """
    ask_to_stop()
    if kernel.acquire(timeout=PATIENCE):
        try:
            ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), ctypes.py_object(KeyboardInterrupt))
        finally:
            kernel.release()
