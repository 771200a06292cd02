"""How many loads the solves of this process have done: methods count, and what shows progress reads."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager

DONE = (ctypes.c_int64 * 1)()  # kernels know its address


def count_load() -> None:
    """One more load of a curve is done; kernels and Python code call it."""
    DONE[0] += 1


def loads_done() -> int:
    """The loads done so far."""
    return DONE[0]


@contextmanager
def counted_as(loads: int) -> Iterator[None]:
    """What a `with` statement has solved when it ends, whatever was counted within.

    It is 0 for what is part of one load, such as a start of its iteration, or belongs to none. The count means
    something where one curve is solved at a time.
    """
    before = loads_done()
    try:
        yield
    finally:
        DONE[0] = before + loads
