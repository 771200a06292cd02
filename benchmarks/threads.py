"""Setting of one thread for all programs."""

import os


def use_one_thread() -> None:
    """Set one thread for the BLAS of NumPy, OpenMP and numba, which read the setting when they are loaded."""
    for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
        os.environ[threads] = "1"
