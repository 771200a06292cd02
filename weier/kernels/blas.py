"""Restrict BLAS to one thread, for matrices and vectors of some thousand unknowns.

A second thread is no faster here, and spins while it waits: on a loaded machine a load takes ten times as long. Cases
run in parallel instead, one per core.
"""

from contextlib import ContextDecorator
from typing import Any, ClassVar

from threadpoolctl import OpenBLASController, get_cached_controller


class _OneThread(ContextDecorator):
    """A context or decorator for the whole process: the last thread to leave restores what the first one found."""

    _limits: ClassVar[list[Any]] = []

    def __enter__(self) -> None:
        import scipy.linalg  # noqa: F401 - which has a library beside that of numpy, and must be loaded for it

        self._limits.append(get_cached_controller().limit(limits=1, user_api="blas"))

    def __exit__(self, *failure: object) -> None:
        # Until it is released, threadpoolctl heeds one thread: the one that set the limit, then this one.
        OpenBLASController.clear_controlling_thread(force=True)
        self._limits.pop().restore_original_limits()
        OpenBLASController.clear_controlling_thread(force=True)


one_thread = _OneThread()
