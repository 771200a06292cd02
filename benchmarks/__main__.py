"""One thread for all programs, then the command line."""

import os

# These are set before NumPy is imported, because its BLAS reads them once.
for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[threads] = "1"

from benchmarks.command import main  # noqa: E402 - it imports NumPy

main()
