"""Progress over the loads: functions called after each load that a solver has done, and the curve so far.

Ctrl-C, or a listener with a time limit, stops a solver between two loads or within one. The exception carries the
curve of the loads that were solved before, as `curve`: the loops over the loads set it, and callers convert it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from contextvars import ContextVar
from typing import Any

INTERRUPTIONS = (KeyboardInterrupt, TimeoutError)  # exceptions that end a solution from outside
_LISTENERS: ContextVar[tuple[Callable[[], None], ...]] = ContextVar("listeners", default=())


def count_load() -> None:
    """Call all listeners: the loops over the loads of a curve do so after each load."""
    for listener in _LISTENERS.get():
        listener()


@contextmanager
def reporting_to(*listeners: Callable[[], None]) -> Iterator[None]:
    """Within the `with` block, also call these functions after each load; without arguments, call no listener.

    `reporting_to()` wraps loads solved as part of another. An error that a listener raises stops the solver
    between two loads.
    """
    token = _LISTENERS.set((*_LISTENERS.get(), *listeners) if listeners else ())
    try:
        yield
    finally:
        _LISTENERS.reset(token)


@contextmanager
def keeping(so_far: Callable[[Any], Any]) -> Iterator[None]:
    """Attach the curve so far to an exception that stops the solver within the `with` block.

    `so_far` computes this curve, or None, from the curve attached by an inner block (None without one).
    """
    try:
        yield
    except INTERRUPTIONS as stop:
        vars(stop)["curve"] = so_far(getattr(stop, "curve", None))
        raise


def converting(convert: Callable[[Any], Any]) -> AbstractContextManager[None]:
    """Convert the curve, if any, of an exception that stops the solver within the `with` block."""
    return keeping(lambda found: None if found is None else convert(found))
