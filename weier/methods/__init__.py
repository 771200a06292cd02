"""The methods of solution: closed forms, the non-linear layer, boundary elements, contact patches, and the choice.

Imports kernels, surface and theory only. Methods take and return arrays; the pipeline makes datasets of them.
"""
