"""One thread for everybody, then the command line."""

import os

# Before NumPy, whose BLAS reads them once.
for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[threads] = "1"

from benchmarks.command import main  # noqa: E402 - it imports NumPy

main()
