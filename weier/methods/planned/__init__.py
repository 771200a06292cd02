"""Curves within a tolerance: the cheapest methods, load by load, that their error models allow.

May use all other methods.
"""
