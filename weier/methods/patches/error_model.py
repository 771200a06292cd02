"""How far contact patches are off, and what they cost, before they are run."""

from __future__ import annotations

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.error_model import RESISTANCE_ROUNDING

COMPLIANCE_FACTOR = 0.01  # error, times the tolerance
RESISTANCE_FACTOR = 50.0  # the same; 1 but for loads as near as 1e-5 of themselves below a merger
# At a looser tolerance symmetric contacts take hundreds of times as long, and no others less.
TOLERANCES = (1e-8, 1e-10, 1e-12)

MAX_CONTACTS = 256  # a dense matrix of more takes seconds a load
MAX_EXPECTED_CONTACTS = 64  # where there are over 256 waves: the forecast may be 4 times too low

SECONDS_START, SECONDS_LOAD = 5e-4, 3e-4
SECONDS_WAVE, SECONDS_CONTACT, CONTACT_POWER = 1.5e-5, 8e-5, 2.0  # of each load
SECONDS_WITHOUT_MATRIX = 3e-3  # of each load and contact: 42 673 took 140 s, 291 took 0.54 s
BYTES_WAVE = 1e5  # every crest, and the coarse grid to start from
NODES_CONTACT = 20  # of a contact, whose matrix is dense
MATRIX_COPIES = 7  # the matrix itself, its factors and what they are made from


def error(tolerance: float, quantity: str) -> float:
    """Error at this tolerance, in g_0 of a compliance, in the larger of itself and 1 of a resistance."""
    factor = COMPLIANCE_FACTOR if quantity == "compliance" else RESISTANCE_FACTOR
    return factor * tolerance + RESISTANCE_ROUNDING


def seconds(waves: int, contacts: Array) -> Array:
    """Seconds for each load, at so many of the finest waves in a period and contacts."""
    by_matrix = SECONDS_CONTACT * contacts**CONTACT_POWER
    return np.asarray(SECONDS_LOAD + SECONDS_WAVE * waves + np.minimum(by_matrix, SECONDS_WITHOUT_MATRIX * contacts))


def memory(waves: int, contacts: float) -> float:
    """Bytes of a few dense matrices, and of what there is for each of the finest waves."""
    return float(MATRIX_COPIES * 8 * (NODES_CONTACT * contacts) ** 2 + BYTES_WAVE * waves)
