"""What numerical code is compiled and run with: numba with its cache, BLAS on one thread, the sources of a module.

Imports nothing else of weier, and every other folder may use it.
"""
