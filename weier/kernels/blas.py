"""BLAS on one thread, for the dense matrices and the vectors of some thousand unknowns that a load takes.

A second thread makes them no faster. It spins while it waits, and on a busy machine the solver then has to wait for
it, so that a load takes ten times as long. Each case has one core; the other cores are for other cases.
"""

from contextlib import ContextDecorator
from threading import Lock

from threadpoolctl import OpenBLASController, get_cached_controller


class _OneThread(ContextDecorator):
    """A context or decorator for the whole process: BLAS has one setting, which the last thread to leave restores."""

    _lock, _inside = Lock(), 0

    def __enter__(self) -> None:
        import scipy.linalg  # noqa: F401 - which has a library beside that of numpy, and must be loaded for it

        with self._lock:
            if self._inside == 0:
                self._limits = get_cached_controller().limit(limits=1, user_api="blas")
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
