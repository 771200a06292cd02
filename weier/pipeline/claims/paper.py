"""The claims of the paper: what it says in words, and how each is measured."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from weier.pipeline.claims import measures
from weier.pipeline.claims.measures import Cases, Measured


class Claim(NamedTuple):
    """A statement of the paper, the quantity measured for it, the paper's value of that (NaN for none), and how."""

    statement: str
    quantity: str
    paper_value: float
    measure: Callable[[Cases], Measured]


CLAIMS = {
    "twelve_elements": Claim(
        "Even with as few as 12 elements, the results agree closely with Eq. (12), except at very light loads where "
        "only one element is in contact (5.1).",
        "largest relative error of the compliance with more than one element in contact",
        np.nan,
        measures.few_elements,
    ),
    "phase_spread": Claim(
        "The curves for gamma = 2 lie fairly close to their average for all phases except those close to zero and "
        "pi; the effect of phase is extremely small at gamma = 5 (5.2).",
        "largest spread of the curves for the larger gamma, of the compliance at full contact",
        np.nan,
        measures.phase_spread,
    ),
    "archard_above": Claim(
        "The Archard approximation overestimates the compliance at all values of load (5.3).",
        "least excess of the compliance in partial contact, in g_0",
        np.nan,
        measures.archard_above,
    ),
    "demelio_below": Claim(
        "The Demelio approximation underestimates the compliance at low loads (5.3).",
        "largest excess of the compliance at low loads, in g_0",
        np.nan,
        measures.demelio_below,
    ),
    "layer_close": Claim(
        "The non-linear layer model gives good results at low loads, but tends to underestimate the compliance "
        "slightly at high loads (5.3).",
        "largest error of the compliance at low loads, of that at full contact",
        np.nan,
        measures.layer_close,
    ),
    "errors_grow_with_dimension": Claim(
        "The higher fractal dimension generally makes the approximations less accurate (5.3).",
        "least growth of the largest error of an estimate, as a ratio",
        np.nan,
        measures.errors_grow_with_dimension,
    ),
    "resistance_errors": Claim(
        "The Archard approximation tends to underestimate the resistance, particularly at high loads; the Demelio "
        "approximation consistently overestimates it, by as much as 30%; the non-linear layer is best, its largest "
        "error an overestimate of about 12% at intermediate loads (5.4).",
        "largest relative error of the resistance by the non-linear layer",
        measures.LAYER_ERROR,
        measures.resistance_errors,
    ),
    "boundary_elements": Claim(
        "The numerical resistance is rather sensitive to discretization errors (5.4).",
        "least ratio of the largest relative errors of resistance and compliance",
        np.nan,
        measures.boundary_elements,
    ),
    "fourth_term": Claim(
        "Additional fine scale features have a relatively small effect (5.5).",
        "largest change of the mean gap with the last term, of the compliance at full contact",
        np.nan,
        measures.last_term,
    ),
    "one_wave_bounds": Claim(
        "The bounds from Westergaard's solution for the first wave are so loose as to include the predictions of all "
        "three methods (5).",
        "largest distance of an estimate from the one-wave solution, of G_1",
        np.nan,
        measures.one_wave_bounds,
    ),
}
