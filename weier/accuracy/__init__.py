"""Measurements of speed against accuracy, of stability at the extremes, and of convergence of the infinite series.

The first two run variants of methods on cases and compare the results with a reference: `runner` runs a variant,
`reference` finds the reference, `metrics` computes errors, `comparison` fills a dataset, and `report` writes tables.
Imports the pipeline and all folders below it.
"""
