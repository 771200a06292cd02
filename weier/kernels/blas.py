"""Restrict BLAS to one thread, for matrices and vectors of some thousand unknowns.

A second thread is no faster here, and spins while it waits: on a loaded machine a load takes ten times as long. Cases
run in parallel instead, one per core.
"""

from contextlib import ContextDecorator
from typing import Any, ClassVar

from threadpoolctl import get_cached_controller


class _OneThread(ContextDecorator):
    """A context or decorator for the whole process, which may be nested."""

    _limits: ClassVar[list[Any]] = []

    def __enter__(self) -> None:
        import scipy.linalg  # noqa: F401 - which has a library beside that of numpy, and must be loaded for it

        self._limits.append(get_cached_controller().limit(limits=1, user_api="blas"))

    def __exit__(self, *failure: object) -> None:
        self._limits.pop().restore_original_limits()


one_thread = _OneThread()
