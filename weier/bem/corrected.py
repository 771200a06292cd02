"""Loads on the grid, each with what the continuum adds to it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.bem import fft
from weier.bem.edges import find_edges
from weier.bem.grids import Hierarchy, part_of_hierarchy
from weier.bem.rate import solve_rate
from weier.bem.solution import Solution
from weier.bem.subgrid import Continuum, correct
from weier.jit import kernel

Array = NDArray[np.float64]


class Corrected(NamedTuple):
    """Over the loads, each of shape (loads,): `fft.Answer`, with edges of contact between the nodes.

    flat : mean gap d, in g_0
    resistance : dh/dp, in g_0/p_0*; inf if the rate was missed
    contact_fraction : length in contact per length
    patches : contacts in one period
    residual, work : of the solution on the grid
    compliance_error, resistance_error : expected, in the same units
    """

    flat: Array
    resistance: Array
    contact_fraction: Array
    patches: NDArray[np.int64]
    residual: Array
    work: Array
    compliance_error: Array
    resistance_error: Array


@kernel
def no_loads(loads: int) -> Corrected:
    """The same with nothing in it yet."""
    return Corrected(
        np.empty(loads), np.full(loads, np.nan), np.empty(loads), np.empty(loads, np.int64), np.empty(loads),
        np.zeros(loads), np.full(loads, np.nan), np.full(loads, np.nan),
    )  # fmt: skip


@kernel
def solve_loads(hierarchy: Hierarchy, pressure: Array, loads: Array, continuum: Continuum) -> Corrected:
    """Solve every load from the heaviest down, as `fft.solve_loads`, and correct it.

    Parameters
    ----------
    hierarchy : Hierarchy
        The grids; the last one carries the answer.
    pressure : array, shape (points of the coarsest grid,)
        Where it is positive the search for the contact begins; overwritten.
    loads : array, shape (loads,)
        Mean pressures, increasing, in p_0*.
    continuum : Continuum
        What the correction knows of the finest grid.

    Returns
    -------
    Corrected
        Arrays over the loads, in their order; work counts pairs of FFTs, those of coarser grids by their size.

    """
    answer = no_loads(loads.size)
    finest = part_of_hierarchy(hierarchy, hierarchy.points.size - 1)
    state = fft.make_state(finest.height.size)
    for load in range(loads.size - 1, -1, -1):
        flat, residual, pairs = fft.descend(loads[load], hierarchy, pressure, state)
        carried, deformed = state.pressure.copy(), state.deformed.copy()
        rate, more = solve_rate(hierarchy, state)
        answer.residual[load] = residual
        answer.work[load] = pairs + more
        if residual > finest.tolerance or rate == np.inf:  # to be refused
            answer.flat[load], answer.resistance[load], answer.contact_fraction[load] = flat, rate, np.nan
            answer.patches[load] = 0
            continue
        displacement = -state.deformed
        solution = Solution(flat, rate, carried, deformed, state.pressure, displacement, state.contact)
        added = correct(solution, finest, find_edges(state.contact, state.edge), continuum)
        answer.flat[load] = flat - added.compliance
        answer.resistance[load] = rate + added.resistance
        answer.contact_fraction[load] = added.contact_fraction
        answer.patches[load] = added.patches
        answer.compliance_error[load] = added.compliance_error
        answer.resistance_error[load] = added.resistance_error
    return answer
