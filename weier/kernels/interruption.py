"""Ctrl-C while a kernel returns: an exception that comes there crashes the process.

Python sees a signal between two of its own steps, and so between two kernels: no kernel takes longer than about half
a second. But numba makes the NamedTuples that a kernel returns by calling Python, within its own code, which knows
nothing of exceptions. Where a signal comes, as most do, while the kernel runs, Python would raise KeyboardInterrupt
right there. So it is noted, and raised once the kernel has returned. While kernels are compiled, LLVM calls Python,
too, and an exception that comes there is printed and lost: what was noted is then raised after the next kernel.
"""

from __future__ import annotations

import functools
import signal
import threading
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

Given = ParamSpec("Given")
Result = TypeVar("Result")


class _Kernel(threading.local):
    """Whether a thread runs one, and whether Ctrl-C came since its call of the library began."""

    runs = interrupted = False


_KERNEL = _Kernel()


def interruptible(solve: Callable[Given, Result]) -> Callable[Given, Result]:
    """A function that calls kernels, and that Ctrl-C ends by KeyboardInterrupt and in no other way."""

    @functools.wraps(solve)
    def run(*arguments: Given.args, **options: Given.kwargs) -> Result:
        in_main = threading.current_thread() is threading.main_thread()
        if not in_main or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
            return solve(*arguments, **options)  # which Ctrl-C does not reach, or which is within another one
        signal.signal(signal.SIGINT, _note_and_raise)
        try:
            result = solve(*arguments, **options)
            _raise_noted()
            return result
        finally:
            signal.signal(signal.SIGINT, signal.default_int_handler)
            _KERNEL.interrupted = False

    return run


def run_kernel(compiled: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    """Call compiled code, and raise afterwards what came meanwhile."""
    _KERNEL.runs = True
    try:
        return compiled(*arguments)
    finally:
        _KERNEL.runs = False
        _raise_noted()


def _note_and_raise(*_: object) -> None:
    _KERNEL.interrupted = True
    if not _KERNEL.runs:
        raise KeyboardInterrupt


def _raise_noted() -> None:
    if _KERNEL.interrupted:
        raise KeyboardInterrupt
