"""Who is told of each load that a solver has done."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

_TOLD: ContextVar[Callable[[], None] | None] = ContextVar("told", default=None)


def count_load() -> None:
    """One more load of a curve is done: for loops over the loads."""
    told = _TOLD.get()
    if told is not None:
        told()


@contextmanager
def telling(told: Callable[[], None] | None) -> Iterator[None]:
    """Call this for each load that is done in a `with` statement; None for loads that are part of another one."""
    token = _TOLD.set(told)
    try:
        yield
    finally:
        _TOLD.reset(token)


@contextmanager
def also_telling(told: Callable[[], None]) -> Iterator[None]:
    """Call this, too, after what is told already; an error that it raises stops the solver between two loads."""
    before = _TOLD.get()

    def both() -> None:
        if before is not None:
            before()
        told()

    with telling(both):
        yield
