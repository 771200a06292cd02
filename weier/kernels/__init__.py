"""Compiled code: numba with its cache, arrays, BLAS on one thread.

Imports only the digests of weier; every other folder may use it.
"""
