"""The methods of solution: closed forms, the non-linear layer, boundary elements, contact patches, plans of them.

Imports theory, kernels and data only. Methods take and return arrays; `fields` makes datasets, and `curves` selects
curves from datasets.
"""
