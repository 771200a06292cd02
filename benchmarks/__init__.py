"""Comparisons with other programs, and measurements behind constants and claims of the documentation.

`python -m benchmarks NAME` prints a page of Markdown; the comparisons write to results/benchmark.

| name | what it measures |
|---|---|
| `artefacts` | lines that the checks of heights judge wrongly |
| `direct_solution` | direct solutions against conjugate gradients |
| `estimates` | errors of the estimates on ensembles, and the exponent of the stiffness |
| `expected_seconds` | measured over expected seconds of each method, and their constants |
| `grid_resistance` | errors of the resistance of boundary elements, by the active set and by differences |
| `node_counts` | Chebyshev coefficients that contacts and gaps need, and the factors of their number |
| `same_grid` | speed of weier and other programs on the same grids |
| `to_error` | processor time of weier and other programs to a given error |
| `truncated_resistance` | error over stated error of the resistance of infinite series |
| `tuning` | cost with each tuned number halved and doubled |
"""
