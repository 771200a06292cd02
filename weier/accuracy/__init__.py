"""Measurements of weier itself: errors, seconds, and whether errors are what is stated of them.

| command | what it measures |
|---|---|
| `snakemake tradeoff` | speed against accuracy of all variants of methods |
| `snakemake extremes` | stability at the limits of floats |
| `snakemake convergence` | the infinite series by the number of terms resolved |
| `python -m weier.accuracy.coverage` | whether errors are within what is stated, on families of hard series |
| `python -m weier.accuracy.estimates` | errors of the estimates on ensembles, and the exponent of the stiffness |
| `python -m weier.accuracy.expected_seconds` | seconds of each method over those expected |

`variants` says what is compared, `runner` runs a variant, `reference` finds the reference, `families` draws hard
series, `metrics` computes errors, and `comparison` fills a dataset; all tables are written by `weier.data.markdown`.
Imports the pipeline and all folders below it.
"""
