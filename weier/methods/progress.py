"""Progress over the loads: functions called after each load that a solver has done, and the curve so far.

Ctrl-C, or a listener with a time limit, stops a solver between two loads or within one. The exception carries the
curve of the loads that were solved before, as `curve`: the loops over the loads set it, and callers convert it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

from weier.kernels.arrays import Array

STOPS = (KeyboardInterrupt, TimeoutError)  # that end a solution from outside
_LISTENERS: ContextVar[tuple[Callable[[], None], ...]] = ContextVar("listeners", default=())


def count_load() -> None:
    """Call all listeners: the loops over the loads of a curve do so after each load."""
    for listener in _LISTENERS.get():
        listener()


@contextmanager
def reporting_to(*listeners: Callable[[], None]) -> Iterator[None]:
    """In a `with` statement, call these functions, too, after each load; without any, call none.

    The latter is for loads that are solved as part of another one. An error that a listener raises stops the solver
    between two loads.
    """
    token = _LISTENERS.set((*_LISTENERS.get(), *listeners) if listeners else ())
    try:
        yield
    finally:
        _LISTENERS.reset(token)


@contextmanager
def keeping(solved: Callable[[], tuple[Array, Any] | None]) -> Iterator[None]:
    """In a `with` statement, give an exception that stops the solver the loads and curve that `solved` returns."""
    try:
        yield
    except STOPS as stop:
        if (found := solved()) is not None:
            vars(stop)["curve"] = found
        raise


@contextmanager
def converting(convert: Callable[[Any], Any]) -> Iterator[None]:
    """In a `with` statement, convert the curve of an exception that stops the solver, if it has one."""
    try:
        yield
    except STOPS as stop:
        if (found := getattr(stop, "curve", None)) is not None:
            vars(stop)["curve"] = convert(found)
        raise
