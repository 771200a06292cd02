"""What was fitted or measured and not derived, all in one place: the factors of the stated errors.

They were fitted on 4 000 to 10 000 loads of the families of `benchmarks.stated_errors`, to leave all but a few errors
of h and R within what is stated.
"""

from __future__ import annotations

import numpy as np

# Polynomials, of contacts and gaps.
REST = 2.0  # times the sizes of the next two terms of a polynomial, for all further ones
# Of the depth of a gap, over its second derivative in finest wavenumbers and over (2 pi/points a wave)^5: what
# polynomial and aliases leave of it on one wave at 32 to 256 points.
OPEN_DEPTH = 0.01
# Steps, of compliance and resistance: an edge that moves by a node changes them by D (a + b) and D.
# Over the nodes of the narrower run, or of half of a finest wave where these are fewer: edges without a polynomial.
ALONE = np.array([0.2, 0.9])
UNEVEN = 2.0  # times the load that the steps beside an edge take if it moves evenly: no step says where it is then
GAP = np.array([0.006, 0.035])  # times (2 pi/points a wave)^2, for gaps with a polynomial, which stands for waves
NEAR_GAP = np.array([0.0025, 0.1])  # times (narrower run/both)^2, for the same
MOMENTS_LEFT = 1.7  # times what second moments of contacts change
# Births, by how far off the height of a crest may be.
HEIGHT_SHARE = 5.0  # errors of the compliance, beside those of its polynomial and of what displaces it
# Times the error of its height: a crest may be so much higher or lower, since the resistance drops most steeply as it
# touches.
HIGHER, LOWER = 1.5, 2.0
# Rounding.
ROUNDING = 1e-14  # of the heights: 45 units in the last place; no step below it says anything
RATE_ROUNDING = 5e-13  # of the resistance, over (2 pi/points a wave)^2: what rounding of heights does to curvatures
