"""How far contact patches are off, and what they cost, before they are run."""

from __future__ import annotations

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.error_model import RESISTANCE_ROUNDING

COMPLIANCE_FACTOR = 0.01  # error, times the tolerance
RESISTANCE_FACTOR = 50.0  # the same; 1 but for loads as near as 1e-5 of themselves below a merger
# At a looser tolerance symmetric contacts take hundreds of times as long, and no others less.
TOLERANCES = (1e-8, 1e-10, 1e-12)

MAX_CONTACTS = 50_000  # more were not measured: 42 673 took 140 s a load and 3.3 GB

SECONDS_START, SECONDS_LOAD = 5e-4, 1.2e-3
SECONDS_WAVE = 2.8e-5  # of each load, for boundary elements to start from
# Of each load by a dense matrix: of each contact, and of its square.
SECONDS_CONTACT, SECONDS_PAIR = 3e-4, 4e-6
# Of each load without a matrix: times the contacts to this power, as far as the depth of a tree grows with them.
SECONDS_WITHOUT_MATRIX, CONTACT_POWER = 7e-4, 1.12
BYTES_WAVE, BYTES_CONTACT = 1e4, 7.5e4  # every crest; the sums over each contact and its nodes, without a matrix
NODES_CONTACT = 20  # of a contact, whose matrix is dense
MATRIX_COPIES = 7  # the matrix itself, its factors and what they are made from


def error(tolerance: float, quantity: str) -> float:
    """Error at this tolerance, in g_0 of a compliance, in the larger of itself and 1 of a resistance."""
    factor = COMPLIANCE_FACTOR if quantity == "compliance" else RESISTANCE_FACTOR
    return factor * tolerance + RESISTANCE_ROUNDING


def seconds(waves: int, contacts: Array) -> Array:
    """Seconds for each load, at so many of the finest waves in a period and contacts."""
    by_matrix = SECONDS_CONTACT * contacts + SECONDS_PAIR * contacts**2
    without = SECONDS_WITHOUT_MATRIX * contacts**CONTACT_POWER
    return np.asarray(SECONDS_LOAD + SECONDS_WAVE * waves + np.minimum(by_matrix, without))


def memory(waves: int, contacts: float) -> float:
    """Bytes of a few dense matrices, or of what replaces them where contacts are many, and of the finest waves."""
    by_matrix = MATRIX_COPIES * 8 * (NODES_CONTACT * contacts) ** 2
    return float(min(by_matrix, BYTES_CONTACT * contacts) + BYTES_WAVE * waves)
