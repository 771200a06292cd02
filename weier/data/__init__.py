"""The data: the table of variables, datasets in memory, netCDF files, and the commit and scene that they come from.

May use theory and kernels, and calls no method of solution.
"""
