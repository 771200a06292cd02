"""Measurements of weier itself: errors, computing time, and coverage of the stated errors.

`python -m weier.accuracy NAME` writes results/NAME/NAME.md; `snakemake --cores 2 NAME` also draws the figure of
tradeoff, extremes and convergence.

| name | what it measures |
|---|---|
| `convergence` | the infinite series by the number of terms resolved |
| `coverage` | coverage of stated errors, on families of hard series |
| `extremes` | stability at the limits of floats |
| `tradeoff` | speed against accuracy of all variants of methods |

`variants` lists what is compared, `runner` runs a variant, `reference` computes the reference, `families` draws hard
series, `metrics` computes errors, `runs` fills a dataset, and `page` makes a command and its page of a
measurement. Imports the pipeline and all folders below it.
"""
