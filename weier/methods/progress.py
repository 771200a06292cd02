"""Progress over the loads: functions that are called after each load that a solver has done."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

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
