"""What was fitted and not derived: the factors of the stated errors, all in one place.

They cover the errors of some 700 random series like those of `benchmarks.subgrid`, on 16 to 400 points a wave, and
were checked on the families of `benchmarks.stated_errors`.
"""

from __future__ import annotations

import numpy as np

# Polynomials.
REST = 1.6  # times the next two terms of a polynomial, for all further ones
CANCELLED = 0.25  # of terms of opposite signs
EDGE_REST = 4.0  # in place of REST for a gap beside an edge of contact, near which the pressure is a root
# Of the depth of a gap, over its second derivative in finest wavenumbers and over (2 pi/points a wave)^5: what
# polynomial and aliases leave of it on one wave at 32 to 256 points.
OPEN_DEPTH = 0.01
# Steps, of compliance and resistance. Contacts and gaps that share an edge bear on each other by near = (narrower
# run/both)^2; wave is 2 pi/points a wave.
ALONE = np.array([0.08, 0.33])  # over the nodes of the narrower run, for edges without a polynomial
# In place of one over the nodes where it is more, times s^2 and at most 3: beside a shoulder of the surface, along
# which an edge runs fast, fewer nodes than those of the run belong to it.
UNEVEN, MAX_UNEVEN = 2.2, 3.0
NEAR_GAP = np.array([0.0025, 0.16])  # times near, for gaps with a polynomial
IMAGES = np.array([0.13, 0.08])  # times near^2 for one contact and its images, load times it of the compliance
GAP = np.array([0.012, 0.07])  # times wave^2, for the same, since polynomials stand for waves
# Contacts that bear on each other.
MOMENTS = 3.0  # times what second moments of contacts change
RECIPROCITY = np.array([0.1, 1.0])  # times change of force and change of share: of h, and over the load of R
# Births, by how far off the height of a crest may be.
HEIGHT_SHARE = 4.0  # errors of the compliance
# Of the resistance: times the drop that an uncertain birth makes, since other contacts give way, and times what a
# contact between two nodes takes off.
BIRTHS, BIRTH_SHARE = 1.2, 0.02
PRESSED = 0.05  # of what others press it down by more than on the grid
# Of the nodes' spacing squared times the force of a contact: how far the second moment of its pressure on the grid
# may be off. 1/4 is half a node at each edge; the most that was measured is 1/3. A contact with a polynomial has its
# first two moments taken off, and the other is left.
MOMENT = np.array([0.4, 0.05])
# Rounding, as measured.
ROUNDING = 1e-13  # of the heights
RATE_ROUNDING = 5e-13  # of the resistance, over wave^2: what rounding of heights does to curvatures
CURVATURE_ROUNDING = 1e-11  # of the heights, over the curvature of a contact's polynomial
