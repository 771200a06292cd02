"""The methods of solution: closed forms, the non-linear layer, boundary elements, contact patches, plans of them.

May use theory, kernels and data; arrays go in and come out, only `solve` and `fields` make datasets,
and `curves` picks from those that are solved.
"""
