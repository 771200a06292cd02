"""Common parts of the error and cost models of several methods.

The formulas are those of docs/planned.md, "Expected errors"; docs/closed_forms.md, "Bounds on the terms left out",
says what a residual does.

`python -m benchmarks.planned` holds these models against the errors and seconds of random profiles, by method, and
the constants of memory come from `python -m benchmarks.memory`. Heights are in g_0, pressures in p_0*, seconds those
of one core of a 2.5 GHz server, bytes those beyond the interpreter's own. The error of a resistance is relative to
the larger of itself and 1 g_0/p_0*.
"""

from __future__ import annotations

import numpy as np

from weier.kernels.arrays import Array

# A solution is exact for a surface that differs from the given one by its residual at most. By the bounds theorem, so
# does its compliance. The factor of 2 allows for larger residuals between the points at which it is known.
RESIDUAL_FACTOR = 2.0
COMPLIANCE_ROUNDING = 1e-14  # Rounding of a compliance, over the total amplitude.
RESISTANCE_ROUNDING = 1e-12  # Rounding of a resistance, relative to itself.

CREST_LOAD = 0.3  # p_0*; at heavier loads single crests of the coarsest wave matter no more, and errors fall.


def estimate_error(
    relative_error: float, mean_pressure: Array, D: float, first_contact: float, amplitude: float
) -> Array:
    """Error of h by an estimate that does not depend on the positions of the crests, in g_0, shape (loads,).

    At light loads an estimate tends to 0, and the compliance to that at first contact, which bounds the error from
    below.

    Parameters
    ----------
    relative_error : float
        Largest error that was measured, over the amplitude of the terms after the first.
    mean_pressure : array, shape (loads,)
        In p_0*.
    D : float
        Fractal dimension.
    first_contact : float
        Compliance at first contact, in g_0, or a bound above it.
    amplitude : float
        Sum of the amplitudes after the first, in g_0.
    """
    return max(first_contact, relative_error * amplitude) * partial_contact_factor(mean_pressure, CREST_LOAD, D)


def partial_contact_factor(mean_pressure: Array, full_contact_pressure: float, D: float) -> Array:
    """Fraction of the amplitudes that a load leaves in partial contact, where the first has this p*.

    It is g_n where p_n* = p (20), and p*/p at least.
    """
    ratio = full_contact_pressure / np.maximum(mean_pressure, full_contact_pressure)
    return np.asarray(ratio ** min((2 - D) / (D - 1), 1.0))
