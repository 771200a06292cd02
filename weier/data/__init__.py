"""The data: the table of variables, datasets in memory, netCDF files and where they come from.

May use theory and kernels, and knows no method of solution.
"""
