"""Fast solver: active set and preconditioned conjugate gradients on nested grids, products by FFT.

docs/bem.md, "The discrete problem", has the equations; docs/numerics.md, "Fast boundary elements", the measured
choices. The deformed surface z - A p touches the rigid plane at height H: z - A p = H, p >= 0 in contact; z - A p <=
H, p = 0 outside; mean(p) = load.

Several loads are solved together, each in a row of the arrays, since FFTs of four rows take little longer than those
of one. `advance` repeats two steps: `_multiply` applies A or the preconditioner to one vector of each load, and each
load then uses its product and sets its next vector. No load depends on the others, bitwise.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Flags, Indices, Records, Spectrum, record_type
from weier.kernels.jit import in_any_order, kernel
from weier.methods.bem.edges import extrapolate_into_gap, find_edges, restrict_from_gap
from weier.methods.bem.grids import Grid, Harmonics, add_harmonic, copy_values, harmonics_of, nested_grids, refine
from weier.methods.bem.staircase import EDGE_OFFSET, NodalSolution
from weier.surface.waves import Waves

TANGENT_TOLERANCE = 1e-4  # variation of A q in contact over R; the relative error of R is its square
MIN_RESISTANCE = 1e-6  # g_0/p_0*: lower limit of R in that ratio; below, near full contact, rounding dominates
MAX_STEPS = 1000  # per load and grid, a safeguard
# ratio of violations to the gap in contact at which the active set is first corrected; it grows by 1 with each
# correction. Its cost is in `python -m benchmarks tuning`.
FIRST_PATIENCE = 3
PART = 2**22  # nodes in pairs of FFTs after which a call returns to Python, so that Ctrl-C works
# The vector of a load, which is multiplied next: a pressure or a search direction by A, a residual by A^-1.
NOTHING, PRESSURE, RESIDUAL, DIRECTION = range(4)

# The progress of a load:
#
# vector : what is multiplied next; `NOTHING` if the load is done
# steps, corrections : of conjugate gradients, and of the contact, on this grid
# edges : of contact, in the array `edge`
# work : nodes of all pairs of FFTs
# load : mean pressure
# energy : of the residual before the last step
# plane, residual, resistance : of the solution so far
# moved : whether the pressure has changed since the operator was applied afresh
# kept : whether the last direction is used in the next step, with unchanged contact
SEARCH = record_type(
    ("vector steps corrections edges work", np.int64, ()),
    ("load energy plane residual resistance", np.float64, ()),
    ("moved kept", np.bool_, ()),
)


class GridState(NamedTuple):
    """The solutions on a grid of N nodes, and the arrays of the conjugate gradients; a row for each load.

    pressure : p, shape (loads, N), in p_0*
    deformed : deformed surface z - A p, shape (loads, N), in g_0
    direction : of the search, shape (loads, N), in p_0*; 0 outside contact
    vector : what is multiplied next, then its product, shape (loads, N); a residual is continued into the gaps
    spectrum : work array for the FFT, shape (loads, N//2 + 1)
    contact : whether a node is in contact, shape (loads, N)
    edge : space for the edges of contact, shape (loads, N + 2)
    search : progress of the loads, shape (loads,)
    """

    pressure: Array
    deformed: Array
    direction: Array
    vector: Array
    spectrum: Spectrum
    contact: Flags
    edge: Indices
    search: Records


def make_grid_state(points: int, search: Records) -> GridState:
    """Return working arrays for the loads of a search on a grid."""
    shape = search.size, points
    return GridState(
        pressure=np.zeros(shape),
        deformed=np.zeros(shape),
        direction=np.zeros(shape),
        vector=np.zeros(shape),
        spectrum=np.zeros((search.size, points // 2 + 1), np.complex128),
        contact=np.zeros(shape, np.bool_),
        edge=np.zeros((search.size, points + 2), np.int64),
        search=search,
    )


@kernel
def row_of(state: GridState, number: int) -> GridState:
    """Return the state of one load."""
    return GridState(
        state.pressure[number],
        state.deformed[number],
        state.direction[number],
        state.vector[number],
        state.spectrum[number],
        state.contact[number],
        state.edge[number],
        state.search[number : number + 1],
    )


@kernel
def _multiply(in_rows: bool, grid: Grid, state: GridState) -> bool:
    """Multiply the vector of each load by a circulant matrix, all by one pair of FFTs; False if no load is left.

    A single load `in_rows` has the digits that it has beside others; otherwise it takes three quarters of the time.
    """
    left, points = False, grid.height.size
    for number in range(state.search.size):
        left |= state.search[number].vector != NOTHING
    if not left:
        return False
    if in_rows:
        np.fft.rfft(state.vector, out=state.spectrum)
    else:
        np.fft.rfft(state.vector[0], out=state.spectrum[0])
    for number in range(state.search.size):
        search, spectrum = state.search[number], state.spectrum[number]
        if search.vector != NOTHING:
            eigenvalue = grid.inverse if search.vector == RESIDUAL else grid.influence
            for k in range(spectrum.size):
                spectrum[k] *= eigenvalue[k]
            search.work += points
    if in_rows:
        np.fft.irfft(state.spectrum, points, out=state.vector)
    else:
        np.fft.irfft(state.spectrum[0], points, out=state.vector[0])
    return True


@in_any_order
@kernel
def dot(a: Array, b: Array) -> float:
    """Return the sum of the products of two arrays."""
    # not np.dot: BLAS would run it on several threads, ten times as slow on a loaded machine
    total = 0.0
    for i in range(a.size):
        total += a[i] * b[i]
    return total


@in_any_order
@kernel
def mean_in_contact(values: Array, contact: Flags) -> float:
    """Return the mean of the values at the nodes in contact."""
    total = 0.0
    nodes = 0
    for i in range(values.size):
        if contact[i]:
            total += values[i]
            nodes += 1
    return total / nodes


@kernel
def _set_pressure(state: GridState) -> None:
    """Clip tension, rescale the pressure to the load, and let the operator be applied to it afresh."""
    search, total, points = state.search[0], 0.0, state.pressure.size
    for i in range(points):
        state.pressure[i] = max(state.pressure[i], 0.0)
        total += state.pressure[i]
    for i in range(points):
        state.pressure[i] *= search.load * points / total
    copy_values(state.pressure, state.vector)
    search.vector, search.moved, search.kept = PRESSURE, False, False


@kernel
def _set_residual(state: GridState) -> None:
    """Let the preconditioner be applied to the residual z - A p - H in contact, continued into the gaps."""
    search = state.search[0]
    for i in range(state.vector.size):
        state.vector[i] = state.deformed[i] - search.plane if state.contact[i] else 0.0
    extrapolate_into_gap(state.vector, state.edge[: search.edges], state.contact)
    search.vector = RESIDUAL


@kernel
def violations(plane: float, grid: Grid, state: GridState) -> tuple[float, float]:
    """Return largest |gap| in contact; largest penetration outside or tension inside, as lengths in g_0.

    A tension counts as the displacement at its own node.
    """
    contact_gap = 0.0
    violation = 0.0
    for i in range(state.pressure.size):
        gap = plane - state.deformed[i]
        if not abs(gap) + abs(state.pressure[i]) < np.inf:  # max() would ignore a NaN.
            return np.inf, np.inf
        if state.contact[i]:
            contact_gap = max(contact_gap, abs(gap))
            violation = max(violation, -state.pressure[i] * grid.self_influence)
        else:
            violation = max(violation, -gap)
    return contact_gap, violation


@kernel
def _correct_contact(plane: float, state: GridState) -> bool:
    """Release nodes in tension, add those that penetrate; return whether any was released, which changes p."""
    released = False
    for i in range(state.pressure.size):
        if state.contact[i]:
            state.contact[i] = state.pressure[i] >= 0
            released |= not state.contact[i]
        else:
            state.contact[i] = state.deformed[i] > plane
    return released


@in_any_order
@kernel
def _set_direction(state: GridState) -> None:
    """Set the next direction of preconditioned conjugate gradients at constant load on the active set.

    The energy is r.M^-1 r of the residual r, M the preconditioner. The load is preserved by subtracting the mean in
    contact from M^-1 r, the vector.
    """
    search = state.search[0]
    restrict_from_gap(state.vector, state.edge[: search.edges], state.contact)
    shift = mean_in_contact(state.vector, state.contact)
    energy = 0.0
    for i in range(state.vector.size):
        if state.contact[i]:
            energy += (state.deformed[i] - search.plane) * (state.vector[i] - shift)
    beta = energy / search.energy if search.kept and search.energy > 0 else 0.0
    for i in range(state.vector.size):
        state.direction[i] = state.vector[i] - shift + beta * state.direction[i] if state.contact[i] else 0.0
    copy_values(state.direction, state.vector)
    search.energy, search.vector = energy, DIRECTION


@in_any_order
@kernel
def _take_step(state: GridState) -> None:
    """Take a step of conjugate gradients; the vector is A times the direction."""
    search = state.search[0]
    # A single node carries the load.
    step = search.energy / dot(state.direction, state.vector) if search.energy > 0 else 0.0
    for i in range(state.pressure.size):
        state.pressure[i] += step * state.direction[i]
        state.deformed[i] -= step * state.vector[i]
    search.moved = search.kept = True


@kernel
def _begin_load(coarse: Array, carried: int, harmonics: Harmonics, grid: Grid, state: GridState) -> None:
    """Carry the pressure of a coarser grid to this one, add the waves behind those carried, and set the contact."""
    search = state.search[0]
    refine(coarse, state.pressure)
    for wave in range(carried, grid.terms):
        add_harmonic(wave, harmonics, state.pressure, state.vector)
    for i in range(state.pressure.size):
        state.contact[i] = state.pressure[i] > 0
    search.edges = find_edges(state.contact, state.edge).size
    search.steps = search.corrections = 0
    _set_pressure(state)


@kernel
def _judge(flatness: float, grid: Grid, state: GridState) -> None:
    """Set the next vector of a load, after corrections of its contact.

    A load is done if the residual is small on a freshly applied operator, with the pressure free of tension and
    scaled to the load. The contact is corrected when its violations exceed the error on it by a factor that grows
    with each correction. A tangent pressure q, of resistance q.A q/N, is done if A q is constant in contact. Both end
    after `MAX_STEPS`.
    """
    search, of_tangent = state.search[0], flatness > 0
    while search.steps < MAX_STEPS:
        search.steps += 1
        search.plane = mean_in_contact(state.deformed, state.contact)
        contact_gap, violation = violations(search.plane, grid, state)
        if of_tangent:
            search.resistance = -dot(state.pressure, state.deformed) / state.pressure.size
            solved = contact_gap <= flatness * max(search.resistance, MIN_RESISTANCE)
        else:
            search.residual = max(contact_gap, violation)
            solved = search.residual <= grid.max_residual
        if solved and (of_tangent or not search.moved):
            break
        is_wrong = solved or violation > (FIRST_PATIENCE + search.corrections) * contact_gap
        if of_tangent or not (search.moved and is_wrong):
            _set_residual(state)
            return
        released = _correct_contact(search.plane, state)
        search.edges = find_edges(state.contact, state.edge).size
        search.corrections += 1
        search.kept = False
        if released or solved:
            _set_pressure(state)
            return
    search.vector = NOTHING


@kernel
def punch_shape(edge: Indices, contact: Flags, shape: Array) -> None:
    """Set q to the pressure of flat punches on all contacts, N/sqrt(distances to both edges in nodes).

    The edges are `EDGE_OFFSET` beyond the last nodes, as in the continuum. The sum is scaled by the caller.
    """
    points = contact.size
    for i in range(points):
        shape[i] = 1.0 if edge.size == 2 else 0.0
    for run in range(1, edge.size - 1):
        start, nodes = edge[run], edge[run + 1] - edge[run]
        if contact[start]:
            for i in range(nodes):
                shape[(start + i) % points] = points / np.sqrt((i + EDGE_OFFSET) * (nodes - 1 - i + EDGE_OFFSET))


@kernel
def _begin_tangent(max_residual: float, state: GridState) -> None:
    """Set the pressure to that of flat punches on the contact, of mean 1, if the load has been solved.

    This guess makes the tangent pressure independent of other loads.
    """
    search = state.search[0]
    if search.residual <= max_residual:
        punch_shape(state.edge[: search.edges], state.contact, state.pressure)
        search.load, search.steps = 1.0, 0
        _set_pressure(state)


@kernel
def advance(
    begins: bool,
    pairs: int,
    flatness: float,
    in_rows: bool,
    coarse: Array,
    carried: int,
    harmonics: Harmonics,
    grid: Grid,
    state: GridState,
) -> bool:
    """Begin or continue with all loads on a grid, for a number of pairs of FFTs; return whether they are done.

    flatness : for tangent pressures, on a flat surface, the accepted variation of A q in contact over R; otherwise 0
    coarse, carried : pressures of the coarser grid, shape (loads, nodes), and its number of waves
    """
    for number in range(state.search.size if begins else 0):
        if flatness > 0:
            _begin_tangent(grid.max_residual, row_of(state, number))
        else:
            _begin_load(coarse[number], carried, harmonics, grid, row_of(state, number))
    for _ in range(pairs):
        if not _multiply(in_rows, grid, state):
            return True
        for number in range(state.search.size):
            own = row_of(state, number)
            given = own.search[0].vector
            if given == RESIDUAL:
                _set_direction(own)
            elif given != NOTHING:
                if given == DIRECTION:
                    _take_step(own)
                else:
                    for i in range(own.deformed.size):
                        own.deformed[i] = grid.height[i] - own.vector[i]
                _judge(flatness, grid, own)
    return False


class NestedSolver:
    """One profile on nested grids; the solution under a load depends on no other load."""

    def __init__(self, profile: Waves, points: int, max_residual: float, together: int = 1) -> None:
        """Make the grids, and the arrays for loads that are solved together."""
        self.grids, self.harmonics = nested_grids(profile, points, max_residual), harmonics_of(profile)
        self.grid, self.together, search = self.grids[-1], together, np.zeros(together, SEARCH)
        self._states = [make_grid_state(grid.height.size, search) for grid in self.grids]
        self._flat = self.grid._replace(height=np.zeros(points))  # the surface of the tangent problem

    def solve_each(
        self, loads: Array, with_tangent: bool, flatness: float = TANGENT_TOLERANCE
    ) -> Iterator[NodalSolution]:
        """Yield the solution under each load; `with_tangent`, also its derivative, at about twice the cost.

        The tangent pressures of a solution are overwritten by later ones.
        """
        for first in range(0, loads.size, self.together):
            yield from self._solve_together(loads[first : first + self.together], with_tangent, flatness)

    def solve_discrete(self, load: float, with_tangent: bool, flatness: float = TANGENT_TOLERANCE) -> NodalSolution:
        """Return the solution under one load, as `solve_each`."""
        return next(self.solve_each(np.array([load]), with_tangent, flatness))

    def _solve_together(self, loads: Array, with_tangent: bool, flatness: float) -> Iterator[NodalSolution]:
        states = self._states
        if loads.size < self.together:
            states = [GridState._make(array[: loads.size] for array in state) for state in states]
        search, coarse, carried = states[0].search, states[0].pressure, 0
        search["work"], search["load"], coarse[:] = 0, loads, loads[:, None]
        for grid, state in zip(self.grids, states, strict=True):
            self._run(0.0, coarse, carried, grid, state)
            coarse, carried = state.pressure, grid.terms
        plane, pressure, search["resistance"] = search["plane"].copy(), state.pressure.copy(), np.nan
        gap = plane[:, None] - state.deformed
        if with_tangent:
            self._run(flatness, coarse, carried, self._flat, state)
        R = np.where(search["steps"] == MAX_STEPS, np.inf, search["resistance"])
        work = search["work"] / self.grid.height.size  # those of coarser grids count by their size
        scalars = plane.tolist(), R.tolist(), search["residual"].tolist(), work.tolist()
        fields = pressure, gap, state.pressure, -state.deformed, state.contact
        for of_load in zip(*scalars, *fields, strict=True):
            yield NodalSolution(*of_load)

    def _run(self, flatness: float, coarse: Array, carried: int, grid: Grid, state: GridState) -> None:
        """Advance until all loads are done, `PART` of the work at a time."""
        pairs, waves = max(PART // state.vector.size, 1), (coarse, carried, self.harmonics)
        problem = pairs, flatness, self.together > 1, *waves, grid, state
        is_done = advance(True, *problem)
        while not is_done:
            is_done = advance(False, *problem)
