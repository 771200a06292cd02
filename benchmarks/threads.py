"""One thread for all programs."""

import os


def use_one_thread() -> None:
    """Tell the libraries that are loaded from now on, which read it once: NumPy's BLAS, OpenMP and numba."""
    for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
        os.environ[threads] = "1"
