"""Loads on the grid, each with what the continuum adds to it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array
from weier.kernels.jit import kernel
from weier.kernels.loads_done import count_load
from weier.methods.bem import fft
from weier.methods.bem.contact_list import ContactTable, append_contacts, blank_table
from weier.methods.bem.continuum import Continuum
from weier.methods.bem.edges import find_edges
from weier.methods.bem.grid_solution import GridSolution
from weier.methods.bem.grids import Hierarchy, grid_of
from weier.methods.bem.rate import solve_rate
from weier.methods.bem.subgrid import correct

MIN_NEAR = 0.5  # of the load before: a lighter one is not near, and begins on the coarsest grid
MAX_PER_WAVE = 64  # nodes for each of the finest waves, beyond which the edges move by many from load to load


class Corrected(NamedTuple):
    """Over the loads, each of shape (loads,): `DiscreteSolution`, with edges of contact between the nodes.

    plane : mean gap d, in g_0
    resistance : dh/dp, in g_0/p_0*; inf if the rate was missed
    contacts : in the continuum
    residual, work : of the solution on the grid
    compliance_error, resistance_error : expected, in the same units
    """

    plane: Array
    resistance: Array
    contacts: ContactTable
    residual: Array
    work: Array
    compliance_error: Array
    resistance_error: Array


@kernel
def blank_correction(loads: int) -> Corrected:
    """The same with nothing in it yet."""
    return Corrected(
        np.empty(loads), np.full(loads, np.nan), blank_table(loads), np.empty(loads), np.zeros(loads),
        np.full(loads, np.nan), np.full(loads, np.nan),
    )  # fmt: skip


@kernel
def solve_loads(hierarchy: Hierarchy, pressure: Array, loads: Array, continuum: Continuum) -> Corrected:
    """Solve every load from the heaviest down, as `fft.solve_loads`, which see, and correct it on the finest grid."""
    corrected = blank_correction(loads.size)
    finest = grid_of(hierarchy, hierarchy.points.size - 1)
    state = fft.make_grid_state(finest.height.size)
    table, end = corrected.contacts, 0
    carried = np.zeros(finest.height.size)
    few = finest.height.size <= MAX_PER_WAVE * hierarchy.harmonics.waves_per_period[-1]
    least = MIN_NEAR if few else np.inf
    for load in range(loads.size - 1, -1, -1):
        plane, residual, pairs = 0.0, np.inf, 0.0
        if load + 1 < loads.size and loads[load] > least * loads[load + 1]:
            relieve(carried, state.pressure, loads[load + 1] - loads[load])
            plane, residual, pairs = fft.resume(loads[load], hierarchy, state)
        if not residual <= finest.tolerance:
            plane, residual, more = fft.cascade(loads[load], hierarchy, pressure, state)
            pairs += more
        carried, deformed = state.pressure.copy(), state.deformed.copy()
        rate, more = solve_rate(hierarchy, state)
        corrected.residual[load] = residual
        corrected.work[load] = pairs + more
        if residual > finest.tolerance or rate == np.inf:  # to be refused
            corrected.plane[load], corrected.resistance[load] = plane, rate
            continue
        displacement = -state.deformed
        solution = GridSolution(plane, rate, carried, deformed, state.pressure, displacement, state.contact)
        added = correct(solution, finest, find_edges(state.contact, state.edge), continuum)
        corrected.plane[load] = _positive(plane - added.compliance)
        corrected.resistance[load] = _positive(rate + added.resistance)
        table, end = append_contacts(table, end, load, added.contacts)
        corrected.compliance_error[load] = added.compliance_error
        corrected.resistance_error[load] = added.resistance_error
        count_load()
    return Corrected(
        corrected.plane, corrected.resistance, table, corrected.residual, corrected.work, corrected.compliance_error,
        corrected.resistance_error,
    )  # fmt: skip


@kernel
def relieve(pressure: Array, per_load: Array, load: float) -> None:
    """Make of the pressure per load the pressure after so much of the load is gone: its square falls by 2 p q.

    That is exact for one contact on a parabola. Where it leaves nothing, the pressure stays.
    """
    left = 0.0
    for i in range(pressure.size):
        per_load[i] = np.sqrt(max(pressure[i] * (pressure[i] - 2 * per_load[i] * load), 0.0))
        left += per_load[i]
    if not 0 < left < np.inf:
        per_load[:] = pressure


@kernel
def _positive(value: float) -> float:
    """A mean gap or resistance: not below 0, where both are smaller than their errors; NaN stays."""
    return 0.0 if value < 0 else value
