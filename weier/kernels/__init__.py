"""What numerical code is compiled and run with: numba with its cache, FFTs, BLAS on one thread, digests.

Imports nothing else of weier, and every other folder may use it.
"""
