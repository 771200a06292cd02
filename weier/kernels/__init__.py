"""What numerical code is compiled and run with: numba with its cache, arrays, BLAS on one thread.

Imports only the digests of weier, and every other folder may use it.
"""
