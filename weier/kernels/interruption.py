"""Ctrl-C while a kernel returns: an exception that comes there crashes the process.

Python sees a signal between two of its own steps, and so between two kernels: no kernel takes longer than about half
a second. But numba makes the NamedTuples that a kernel returns by calling Python, within its own code, which knows
nothing of exceptions. Where a signal comes, as most do, while the kernel runs, Python would raise KeyboardInterrupt
right there. So it is noted, and raised once the kernel has returned.
"""

from __future__ import annotations

import functools
import signal
import threading
from collections.abc import Callable
from types import FrameType
from typing import Any, ParamSpec, TypeVar

Given = ParamSpec("Given")
Result = TypeVar("Result")

COMPILER = "weier.kernels.compiler"  # is all Python, and is interrupted like it
CALLBACK = "_raw_object_cache"  # of llvmlite, which LLVM calls when it has made code: there exceptions are lost
_NOTED: list[bool] = []


def interruptible(solve: Callable[Given, Result]) -> Callable[Given, Result]:
    """A function that calls kernels, and that Ctrl-C ends by KeyboardInterrupt and in no other way."""

    @functools.wraps(solve)
    def run(*arguments: Given.args, **options: Given.kwargs) -> Result:
        in_main = threading.current_thread() is threading.main_thread()
        if not in_main or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
            return solve(*arguments, **options)  # which Ctrl-C does not reach, or which is within another one
        signal.signal(signal.SIGINT, _raise_or_note)
        try:
            return solve(*arguments, **options)
        finally:
            signal.signal(signal.SIGINT, signal.default_int_handler)

    return run


def run_kernel(compiled: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    """Call compiled code, and raise afterwards what came meanwhile."""
    try:
        return compiled(*arguments)
    finally:
        if _NOTED and threading.current_thread() is threading.main_thread():
            _NOTED.clear()
            raise KeyboardInterrupt


def _raise_or_note(number: int, frame: FrameType | None) -> None:
    if frame is not None and frame.f_code.co_name.startswith(CALLBACK):
        _NOTED.append(True)
        return
    caller = frame.f_back if frame is not None else None  # in run_kernel itself, compiled code has returned
    while caller is not None and caller.f_globals.get("__name__") != COMPILER:
        if caller.f_code is run_kernel.__code__:
            _NOTED.append(True)
            return
        caller = caller.f_back
    raise KeyboardInterrupt
