"""The data: the table of variables, datasets in memory, SI units, netCDF files, and where they come from.

Knows the methods by their names and results, and solves nothing.
"""
