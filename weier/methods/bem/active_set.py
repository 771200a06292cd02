"""Fast solver: active set and preconditioned conjugate gradients on nested grids, products by FFT.

docs/bem.md has the equations ("The discrete problem") and the rules of the iteration ("The iteration");
docs/numerics.md, "Fast boundary elements", measured choices. The deformed surface z - A p touches the rigid plane at
height H: z - A p = H, p >= 0 in contact; z - A p <= H, p = 0 outside; mean(p) = load.

On each grid `_iterate` takes steps of conjugate gradients and corrects the contact until the residual is small.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Flags, Indices, Records, Spectrum, record_type
from weier.kernels.jit import in_any_order, kernel
from weier.methods.bem.edges import extrapolate_into_gap, find_edges, punch_shape, restrict_from_gap
from weier.methods.bem.grids import Grid, add_wave, nested_grids, refine
from weier.methods.bem.staircase import NodalSolution
from weier.surface.waves import Waves

TANGENT_TOLERANCE = 1e-4  # variation of A q in contact over R; the relative error of R is its square
MIN_RESISTANCE = 1e-6  # g_0/p_0*: smallest R in that ratio; rounding dominates a smaller R, near full contact
MAX_STEPS = 1000  # steps of conjugate gradients per grid, a safeguard
FIRST_PATIENCE = 3  # violation over the gap in contact at the first correction: `python -m benchmarks tuning`
WORK_PER_CALL = 2**22  # nodes in steps after which `_iterate` returns to Python, so that Ctrl-C works

# Progress: steps and corrections of the contact on this grid; edges in `GridState.edge`; nodes of all pairs of FFTs;
# load, in p_0*; energy before the last step, 0 if the next step does not use the last direction; residual, plane and
# resistance so far; whether the pressure has changed since the operator was applied afresh
PROGRESS = record_type(
    ("steps corrections edges work", np.int64, ()),
    ("load energy residual plane resistance", np.float64, ()),
    ("moved", np.bool_, ()),
)


class GridState(NamedTuple):
    """The solution on a grid of N nodes, and the arrays of the conjugate gradients.

    pressure : p, shape (N,), in p_0*
    deformed : deformed surface z - A p, shape (N,), in g_0
    direction : search direction, shape (N,), in p_0*; 0 outside contact
    vector : residual, continued into the gaps, or a product, shape (N,)
    spectrum : work array for the FFT, shape (N//2 + 1,)
    contact : whether a node is in contact, shape (N,)
    edge : space for the edges of contact, shape (N + 2,)
    progress : `PROGRESS` on this grid, shape (1,)
    """

    pressure: Array
    deformed: Array
    direction: Array
    vector: Array
    spectrum: Spectrum
    contact: Flags
    edge: Indices
    progress: Records


@kernel
def _multiply(values: Array, eigenvalue: Array, state: GridState) -> None:
    """Set the vector to the product of a circulant matrix and these values, by a pair of FFTs."""
    np.fft.rfft(values, out=state.spectrum)
    for k in range(eigenvalue.size):
        value = state.spectrum[k]
        state.spectrum[k] = complex(value.real * eigenvalue[k], value.imag * eigenvalue[k])
    np.fft.irfft(state.spectrum, values.size, out=state.vector)
    state.progress[0].work += values.size


@in_any_order
def mean_in_contact(values: Array, contact: Flags) -> float:
    """Return the mean of the values at the nodes in contact."""
    total, nodes = 0.0, 0
    for i in range(values.size):
        if contact[i]:
            total += values[i]
            nodes += 1
    return total / nodes


@in_any_order
def dot(a: Array, b: Array) -> float:
    """Return the sum of the products of two arrays."""
    # not np.dot: BLAS would run it on several threads, ten times as slow on a loaded machine
    total = 0.0
    for i in range(a.size):
        total += a[i] * b[i]
    return total


@kernel
def _apply_afresh(grid: Grid, state: GridState) -> None:
    """Clip tension, rescale the pressure to the load, and apply the operator to it."""
    own, pressure, total = state.progress[0], state.pressure, 0.0
    for i in range(pressure.size):
        pressure[i] = max(pressure[i], 0.0)
        total += pressure[i]
    scale = own.load * pressure.size / total
    for i in range(pressure.size):
        pressure[i] *= scale
    _multiply(pressure, grid.influence, state)
    for i in range(pressure.size):
        state.deformed[i], state.direction[i] = grid.height[i] - state.vector[i], 0.0
    own.moved, own.energy = False, 0.0


@kernel
def violations(grid: Grid, state: GridState) -> tuple[float, float]:
    """Set the vector to z - A p - H in contact, 0 elsewhere; return its largest size and the largest violation.

    Violations are penetration outside, and tension inside as the displacement at its own node, in g_0.
    """
    plane, contact_gap, violation, total = state.progress[0].plane, 0.0, 0.0, 0.0
    for i in range(state.pressure.size):
        above = state.deformed[i] - plane
        total += above + state.pressure[i]
        if state.contact[i]:
            contact_gap = max(contact_gap, abs(above))
            violation = max(violation, -state.pressure[i] * grid.self_influence)
            state.vector[i] = above
        else:
            violation = max(violation, above)
            state.vector[i] = 0.0
    return (contact_gap, violation) if abs(total) < np.inf else (np.inf, np.inf)  # max() ignores a NaN


@kernel
def _correct_contact(state: GridState) -> bool:
    """Release nodes in tension, add those that penetrate; return whether any was released, which changes p."""
    own, contact, released = state.progress[0], state.contact, False
    for i in range(contact.size):
        is_in_tension = contact[i] and state.pressure[i] < 0
        contact[i] = not is_in_tension and (contact[i] or state.deformed[i] > own.plane)
        released |= is_in_tension
    own.edges, own.energy = find_edges(contact, state.edge).size, 0.0
    own.corrections += 1
    return released


@in_any_order
def _take_step(grid: Grid, state: GridState) -> None:
    """Take a step of conjugate gradients, preconditioned at constant load: docs/bem.md, "The iteration"."""
    own, contact, vector, direction = state.progress[0], state.contact, state.vector, state.direction
    edge, plane, energy = state.edge[: own.edges], own.plane, 0.0
    extrapolate_into_gap(vector, edge, contact)
    _multiply(vector, grid.inverse, state)
    restrict_from_gap(vector, edge, contact)
    shift = mean_in_contact(vector, contact)
    for i in range(vector.size):
        if contact[i]:
            energy += (state.deformed[i] - plane) * (vector[i] - shift)
    beta = energy / own.energy if own.energy > 0 else 0.0
    for i in range(vector.size):
        direction[i] = vector[i] - shift + beta * direction[i] if contact[i] else 0.0
    _multiply(direction, grid.influence, state)
    length = energy / dot(direction, vector) if energy > 0 else 0.0  # 0 if a single node carries the load
    for i in range(vector.size):
        state.pressure[i] += length * direction[i]
        state.deformed[i] -= length * vector[i]
    own.energy, own.moved = energy, True


@kernel
def _begin(is_tangent: bool, coarse: Array, grid: Grid, state: GridState) -> None:
    """Start from the pressure of flat punches, or of the coarser grid and the waves that join on this one."""
    own = state.progress[0]
    if is_tangent:
        own.load = 1.0
        punch_shape(state.edge[: own.edges], state.contact, state.pressure)
    else:
        refine(coarse, state.pressure)
        for wave in range(grid.cycle.size):
            add_wave(wave, grid, state.pressure, state.vector)
        for i in range(state.contact.size):
            state.contact[i] = state.pressure[i] > 0
        own.edges = find_edges(state.contact, state.edge).size
    own.corrections = 0
    _apply_afresh(grid, state)


@kernel
def _iterate(max_steps: int, flatness: float, coarse: Array, grid: Grid, state: GridState) -> bool:
    """Iterate for a number of steps; return whether the solution is found or `MAX_STEPS` are used up.

    It is found if the residual is small, on the finest grid on a freshly applied operator, with the pressure free of
    tension and scaled to the load. A tangent pressure q, on a flat surface, of resistance q.A q/N, is found if A q is
    constant in contact.

    flatness : for tangent pressures, the accepted variation of A q in contact over R; otherwise 0
    coarse : pressure of the coarser grid
    """
    own, is_tangent = state.progress[0], flatness > 0
    if own.steps == 0:
        _begin(is_tangent, coarse, grid, state)
    for _ in range(min(max_steps, MAX_STEPS - own.steps)):
        own.steps += 1
        own.plane = mean_in_contact(state.deformed, state.contact)
        contact_gap, violation = violations(grid, state)
        if is_tangent:
            own.resistance = -dot(state.pressure, state.deformed) / state.pressure.size
            solved = contact_gap <= flatness * max(own.resistance, MIN_RESISTANCE)
        else:
            own.residual = max(contact_gap, violation)
            solved = own.residual <= grid.max_residual
        if solved and (is_tangent or grid.is_coarse or not own.moved):
            return True
        if is_tangent or (not solved and violation <= (FIRST_PATIENCE + own.corrections) * contact_gap):
            _take_step(grid, state)
        elif _correct_contact(state) or solved:
            _apply_afresh(grid, state)
    return own.steps == MAX_STEPS


class NestedSolver:
    """One profile on nested grids; the solution under a load depends on no other load."""

    def __init__(self, profile: Waves, points: int, max_residual: float) -> None:
        """Make the grids and their arrays."""
        self._grids, self._progress = nested_grids(profile, points, max_residual), np.zeros(1, PROGRESS)
        self.grid, self._states = self._grids[-1], list[GridState]()
        for n in (grid.height.size for grid in self._grids):
            others = np.zeros(n // 2 + 1, complex), np.zeros(n, np.bool_), np.zeros(n + 2, np.int64), self._progress
            self._states.append(GridState._make([*np.zeros((4, n)), *others]))
        self._flat = self.grid._replace(height=np.zeros(points))  # has the flat surface of the tangent problem

    def solve_discrete(self, load: float, with_tangent: bool, flatness: float = TANGENT_TOLERANCE) -> NodalSolution:
        """Return the solution under a load; the next one overwrites its arrays, except pressure and gap."""
        progress, coarse = self._progress, np.full(1, load)
        progress["load"], progress["work"], progress["resistance"] = load, 0, np.nan
        for grid, state in zip(self._grids, self._states, strict=True):
            self._run(0.0, coarse, grid, state)
            coarse = state.pressure
        plane, residual, pressure = progress["plane"].item(), progress["residual"].item(), state.pressure.copy()
        gap = plane - state.deformed
        if with_tangent and residual <= self.grid.max_residual:
            self._run(flatness, coarse, self._flat, state)
        R = np.inf if progress["steps"].item() == MAX_STEPS else progress["resistance"].item()
        work = progress["work"].item() / self.grid.height.size  # FFTs of coarser grids count by their size
        return NodalSolution(plane, R, residual, work, pressure, gap, state.pressure, -state.deformed, state.contact)

    def _run(self, flatness: float, coarse: Array, grid: Grid, state: GridState) -> None:
        self._progress["steps"], steps = 0, max(WORK_PER_CALL // state.vector.size, 1)
        while not _iterate(steps, flatness, coarse, grid, state):
            pass
