"""The data: the table of variables, datasets in memory, netCDF files, and the commit and scene that they come from.

Imports theory and kernels only, and calls no method of solution.
"""
