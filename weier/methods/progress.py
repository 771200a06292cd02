"""Who is told of each load that a solver has done."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

_TOLD: ContextVar[tuple[Callable[[], None], ...]] = ContextVar("told", default=())


def count_load() -> None:
    """One more load of a curve is done: for loops over the loads."""
    for told in _TOLD.get():
        told()


@contextmanager
def telling(*told: Callable[[], None]) -> Iterator[None]:
    """Call these, too, for each load that is done in a `with` statement; without any, its loads are told to nobody.

    So it is with loads that are part of another one. An error that one of them raises stops the solver between two
    loads.
    """
    token = _TOLD.set((*_TOLD.get(), *told) if told else ())
    try:
        yield
    finally:
        _TOLD.reset(token)
