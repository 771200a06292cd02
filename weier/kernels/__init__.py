"""What numerical code is compiled and run with: numba with its cache, arrays, BLAS on one thread.

Imports nothing else of weier but the digests, and every other folder may use it.
"""
