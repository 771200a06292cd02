"""The error and the cost of contact patches that plans expect before they are run.

The formulas are those of docs/planned.md, "Expected errors" and "Expected seconds"; all factors were fitted to
measured runs. What the stated errors of a solution rest on is in `inequalities` and `resistance_error`.
"""

from __future__ import annotations

import numpy as np

from weier.kernels.arrays import Array
from weier.methods.error_model import RESISTANCE_ROUNDING
from weier.methods.patches.many_contacts import LARGEST_TOLERANCE, MIN_CONTACTS
from weier.methods.patches.solver import MAX_RELATIVE_TOLERANCE
from weier.methods.plan_part import COMPLIANCE

# Error of the resistance to expect, over the tolerance. It is about 1 but for loads as near as 1e-5 of themselves
# below a merger, where it was as large as this. What a solution states of itself is in `resistance_error`.
RESISTANCE_FACTOR = 50.0

ROUNDING = 1e-15  # Of a tolerance: without it, rounding puts the error to expect above what is wanted.

MAX_CONTACTS = 50_000  # More were not measured: 42 641 took 85 s a load and 3.1 GB.

SECONDS_START, SECONDS_LOAD = 5e-4, 6e-4  # Seconds of a curve, and of each load.
# Of each load and wave, times the root of the contacts: boundary elements to start from, whose steps grow with the
# contacts.
SECONDS_WAVE = 3.2e-6
# Of each load by a dense matrix: of each contact, to assemble, and of its square, to factorise.
SECONDS_CONTACT, SECONDS_PAIR = 1e-4, 4.5e-6
# Of each load without a matrix: times the contacts to this power, since the depth of a tree grows with them.
SECONDS_WITHOUT_MATRIX, CONTACT_POWER = 1.6e-4, 1.2
# Both are for a tolerance of 1e-10. Looser ones take fewer nodes and steps: the seconds go with this power of the
# tolerance, up to the largest that each solver works to.
TIMED_TOLERANCE, TOLERANCE_POWER = 1e-10, -0.03
# Bytes of each of the finest waves, for its crests, and of each contact, for the sums over its nodes.
BYTES_WAVE, BYTES_CONTACT = 1e4, 7.5e4
NODES_CONTACT = 20  # Nodes of a contact in a dense matrix.
MATRIX_COPIES = 7  # Arrays of the size of the matrix: itself, its factors and what they are made from.


def error(tolerance: float, quantity: str) -> float:
    """Error to expect at this tolerance: of a compliance in g_0, of a resistance over the larger of itself and 1."""
    return tolerance if quantity == COMPLIANCE else RESISTANCE_FACTOR * tolerance + RESISTANCE_ROUNDING


def loosest_tolerance(wanted: float, quantity: str) -> float:
    """The loosest tolerance at which this `error` is expected; it is not positive where there is none."""
    if quantity == COMPLIANCE:
        return wanted
    return (1 - ROUNDING) * (wanted - RESISTANCE_ROUNDING) / RESISTANCE_FACTOR


def seconds(waves: int, contacts: Array, tolerance: float = TIMED_TOLERANCE) -> Array:
    """Expected seconds of each load to a tolerance in g_0, with so many contacts and so many of the finest waves."""
    by_matrix = (SECONDS_CONTACT * contacts + SECONDS_PAIR * contacts**2) * _saved(tolerance, MAX_RELATIVE_TOLERANCE)
    without = SECONDS_WITHOUT_MATRIX * contacts**CONTACT_POWER * _saved(tolerance, LARGEST_TOLERANCE)
    by_contacts = np.where(contacts < MIN_CONTACTS, by_matrix, without)
    return np.asarray(SECONDS_LOAD + SECONDS_WAVE * waves * np.sqrt(contacts) + by_contacts)


def _saved(tolerance: float, largest: float) -> float:
    """Seconds at a tolerance over those at `TIMED_TOLERANCE`, by a solver that works to `largest` at most."""
    return float((min(tolerance, largest) / TIMED_TOLERANCE) ** TOLERANCE_POWER)


def memory(waves: int, contacts: float) -> float:
    """Bytes of dense matrices or, for many contacts, of the sums in their place, and of the finest waves."""
    by_matrix = MATRIX_COPIES * 8 * (NODES_CONTACT * contacts) ** 2
    return float(min(by_matrix, BYTES_CONTACT * contacts) + BYTES_WAVE * waves)
