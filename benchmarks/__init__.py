"""Comparisons with other programs, one command each; `python -m benchmarks` sets weier beside them.

to_error : processor time to a given error
"""
