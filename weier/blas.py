"""BLAS on one thread, for the dense matrices of a few hundred unknowns that a load takes.

A second thread gains them nothing: it spins while it waits, and on a busy machine the solver then waits for it in
turn, ten times as long. A case has one core; other cores are for other cases.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

from threadpoolctl import ThreadpoolController


@contextmanager
def one_thread() -> Iterator[None]:
    """A context, or a decorator, in which NumPy's and SciPy's BLAS take one thread, as many as before after it."""
    with _libraries().limit(limits=1, user_api="blas"):
        yield


@cache
def _libraries() -> ThreadpoolController:
    # Those that are loaded by now, found once: the search takes 30 ms.
    return ThreadpoolController()
