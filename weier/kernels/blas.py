"""BLAS on one thread, for the dense matrices and the vectors of some thousand unknowns that a load takes.

A second thread makes them no faster. It spins while it waits, and on a busy machine the solver then has to wait for
it, so that a load takes ten times as long. Each case has one core; the other cores are for other cases.
"""

from __future__ import annotations

from contextlib import ContextDecorator
from functools import cache
from threading import Lock
from typing import Any

from threadpoolctl import OpenBLASController, ThreadpoolController


class _OneThread(ContextDecorator):
    """A context or decorator for the whole process: BLAS has one setting, which the last thread to leave restores."""

    def __init__(self) -> None:
        self._lock, self._inside = Lock(), 0
        self._limits: Any = None

    def __enter__(self) -> None:
        with self._lock:
            if self._inside == 0:
                self._limits = _libraries().limit(limits=1, user_api="blas")
            self._inside += 1

    def __exit__(self, *failure: object) -> None:
        with self._lock:
            self._inside -= 1
            if self._inside == 0:
                # threadpoolctl heeds one thread alone, until it is released: that which set the limit, then this one.
                OpenBLASController.clear_controlling_thread(force=True)
                self._limits.restore_original_limits()
                OpenBLASController.clear_controlling_thread(force=True)


one_thread = _OneThread()


@cache
def _libraries() -> ThreadpoolController:
    # numpy has one, and scipy another that must be loaded to be found. Once, since the search takes 30 ms.
    import scipy.linalg  # noqa: F401

    return ThreadpoolController()
