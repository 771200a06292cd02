"""Measurements of weier itself: errors, computing time, and coverage of the stated errors.

| command | what it measures |
|---|---|
| `snakemake tradeoff` | speed against accuracy of all variants of methods |
| `snakemake extremes` | stability at the limits of floats |
| `snakemake convergence` | the infinite series by the number of terms resolved |
| `python -m weier.accuracy.coverage` | coverage of stated errors, on families of hard series |
| `python -m weier.accuracy.estimates` | errors of the estimates on ensembles, and the exponent of the stiffness |
| `python -m weier.accuracy.expected_seconds` | measured over expected seconds of each method, and their constants |
| `python -m weier.accuracy.tuning` | cost with each tuned number halved and doubled |
| `python -m weier.accuracy.node_counts` | Chebyshev coefficients that contacts and gaps need |
| `python -m weier.accuracy.direct_solution` | direct solutions against conjugate gradients |
| `python -m weier.accuracy.artefacts` | lines that the checks of heights judge wrongly |

`variants` lists what is compared, `runner` runs a variant, `reference` computes the reference, `families` draws hard
series, `metrics` computes errors, and `comparison` fills a dataset; all tables are written by `weier.data.markdown`.
Imports the pipeline and all folders below it.
"""
