"""Measurements of weier itself: errors, computing time, and coverage of the stated errors.

`python -m weier.accuracy NAME` writes results/NAME/NAME.md, and tradeoff draws a figure beside it.

| name | what it measures |
|---|---|
| `convergence` | the infinite series by the number of terms resolved |
| `coverage` | coverage of stated errors, on families of hard series |
| `extremes` | stability at the limits of floats |
| `tradeoff` | speed against accuracy of all variants of methods |

`runner` runs a variant, `reference` computes the reference and errors, `families` draws hard series, and
`measurement` makes a command and its page. Imports all folders but the command line.
"""
