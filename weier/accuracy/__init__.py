"""Measurements of weier itself: errors, computing time, and coverage of the stated errors.

`python -m weier.accuracy NAME` writes results/NAME/NAME.md; `snakemake --cores 2 NAME` also draws the figure of
tradeoff, extremes and convergence.

| name | what it measures |
|---|---|
| `artefacts` | lines that the checks of heights judge wrongly |
| `convergence` | the infinite series by the number of terms resolved |
| `coverage` | coverage of stated errors, on families of hard series |
| `direct_solution` | direct solutions against conjugate gradients |
| `estimates` | errors of the estimates on ensembles, and the exponent of the stiffness |
| `expected_seconds` | measured over expected seconds of each method, and their constants |
| `extremes` | stability at the limits of floats |
| `node_counts` | Chebyshev coefficients that contacts and gaps need, and the factors of their number |
| `tradeoff` | speed against accuracy of all variants of methods |
| `tuning` | cost with each tuned number halved and doubled |

`variants` lists what is compared, `runner` runs a variant, `reference` computes the reference, `families` draws hard
series, `metrics` computes errors, `comparison` fills a dataset, and `report` makes a command and its page of a
measurement. Imports the pipeline and all folders below it.
"""
