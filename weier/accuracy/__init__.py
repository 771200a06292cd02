"""Measurements of weier itself: errors, computing time, and coverage of the stated errors.

`python -m weier.accuracy NAME` prints a page of Markdown.

| name | what it measures |
|---|---|
| `convergence` | the infinite series by the number of terms resolved |
| `coverage` | coverage of stated errors, on families of hard series |
| `extremes` | stability at the limits of floats |
| `tradeoff` | speed against accuracy of all variants of methods |

Imports all folders but the command line.
"""
