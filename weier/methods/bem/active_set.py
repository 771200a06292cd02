"""Fast solver: active set and preconditioned conjugate gradients on nested grids, products by FFT.

docs/bem.md, "The discrete problem", has the equations; docs/numerics.md, "Fast boundary elements", the measured
choices. The deformed surface z - A p touches the rigid plane at height H: z - A p = H, p >= 0 in contact; z - A p <=
H, p = 0 outside; mean(p) = load. On each grid, `solve_load` alternates steps on the active set (`_conjugate_step`)
with its corrections (`_correct_contact`). A kernel returns after `PART` of the work, so that Ctrl-C works.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Flags, Indices, Records, Spectrum, record_type
from weier.kernels.jit import in_any_order, kernel
from weier.methods.bem.edges import extrapolate_into_gap, find_edges, restrict_from_gap
from weier.methods.bem.grids import Grid, Harmonics, add_harmonic, harmonics_of, nested_grids, refine
from weier.methods.bem.staircase import EDGE_OFFSET, NodalSolution
from weier.surface.waves import Waves

TANGENT_TOLERANCE = 1e-4  # variation of A q in contact over R; the relative error of R is its square
MIN_RESISTANCE = 1e-6  # g_0/p_0*: lower limit of R in that ratio; below, near full contact, rounding dominates
MAX_STEPS = 1000  # per load and grid, a safeguard
# ratio of violations to the gap in contact at which the active set is first corrected; it grows by 1 with each
# correction. Its cost is in `python -m weier.accuracy tuning`.
FIRST_PATIENCE = 3
PART = 2**22  # nodes in pairs of FFTs after which a call returns to Python, so that Ctrl-C works

# The progress of a load:
#
# steps, corrections : of conjugate gradients, and of the contact, on this grid
# work : nodes of all pairs of FFTs
# limit : of the work, at which a call returns
# energy : of the residual before the last step
# plane, residual, resistance : of the solution so far
# moved : whether the pressure has changed since the operator was applied afresh
# kept : whether the last direction is used in the next step, with unchanged contact
SEARCH = record_type(
    ("steps corrections work limit", np.int64, ()),
    ("energy plane residual resistance", np.float64, ()),
    ("moved kept", np.bool_, ()),
)


class GridState(NamedTuple):
    """The solution on a grid of N nodes, and the arrays of the conjugate gradients.

    pressure : p, shape (N,), in p_0*
    deformed : deformed surface z - A p, shape (N,), in g_0
    direction : of the search, shape (N,), in p_0*; 0 outside contact
    product : preconditioned residual, then A times the direction, shape (N,), in p_0*, then g_0
    residual : z - A p - H in contact, continued into the gaps, shape (N,), in g_0
    spectrum : work array for the FFT, shape (N//2 + 1,)
    contact : whether a node is in contact, shape (N,)
    edge : space for the edges of contact, shape (N + 2,)
    search : progress of the load, shape (1,)
    """

    pressure: Array
    deformed: Array
    direction: Array
    product: Array
    residual: Array
    spectrum: Spectrum
    contact: Flags
    edge: Indices
    search: Records


def make_grid_state(points: int) -> GridState:
    """Return working arrays for grids of up to `points` nodes."""
    return GridState(
        pressure=np.zeros(points),
        deformed=np.zeros(points),
        direction=np.zeros(points),
        product=np.zeros(points),
        residual=np.zeros(points),
        spectrum=np.zeros(points // 2 + 1, np.complex128),
        contact=np.zeros(points, np.bool_),
        edge=np.zeros(points + 2, np.int64),
        search=np.zeros(1, SEARCH),
    )


def leading_part(state: GridState, points: int) -> GridState:
    """Return the state on a grid of `points` nodes, in the leading part of each array."""
    return GridState(
        state.pressure[:points],
        state.deformed[:points],
        state.direction[:points],
        state.product[:points],
        state.residual[:points],
        state.spectrum[: points // 2 + 1],
        state.contact[:points],
        state.edge[: points + 2],
        state.search,
    )


@kernel
def circulant_product(eigenvalue: Array, x: Array, spectrum: Spectrum, product: Array) -> None:
    """Multiply x by the symmetric circulant matrix with these eigenvalues: one pair of FFTs."""
    np.fft.rfft(x, out=spectrum)
    for k in range(spectrum.size):
        spectrum[k] *= eigenvalue[k]
    np.fft.irfft(spectrum, product.size, out=product)


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
def _refresh(load: float, grid: Grid, state: GridState) -> None:
    """Clip tension, rescale the pressure to the load, and apply the operator afresh."""
    total, points = 0.0, state.pressure.size
    for i in range(points):
        state.pressure[i] = max(state.pressure[i], 0.0)
        total += state.pressure[i]
    for i in range(points):
        state.pressure[i] *= load * points / total
    circulant_product(grid.influence, state.pressure, state.spectrum, state.deformed)
    for i in range(points):
        state.deformed[i] = grid.height[i] - state.deformed[i]


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
def _conjugate_step(plane: float, edge: Indices, grid: Grid, state: GridState) -> None:
    """Take one step of preconditioned conjugate gradients at constant load on the active set: two pairs of FFTs.

    The energy is r.M^-1 r of the residual r before the step, M the preconditioner. The load is preserved by
    subtracting the mean in contact from M^-1 r. The array `product` contains M^-1 r, then A times the direction.
    """
    search, points = state.search[0], state.pressure.size
    for i in range(points):
        state.residual[i] = state.deformed[i] - plane if state.contact[i] else 0.0
    extrapolate_into_gap(state.residual, edge, state.contact)
    circulant_product(grid.inverse, state.residual, state.spectrum, state.product)
    restrict_from_gap(state.product, edge, state.contact)
    shift = mean_in_contact(state.product, state.contact)
    energy = 0.0
    for i in range(points):
        if state.contact[i]:
            energy += state.residual[i] * (state.product[i] - shift)
    beta = energy / search.energy if search.kept and search.energy > 0 else 0.0
    for i in range(points):
        state.direction[i] = state.product[i] - shift + beta * state.direction[i] if state.contact[i] else 0.0
    circulant_product(grid.influence, state.direction, state.spectrum, state.product)
    step = energy / dot(state.direction, state.product) if energy > 0 else 0.0  # A single node carries the load.
    for i in range(points):
        state.pressure[i] += step * state.direction[i]
        state.deformed[i] -= step * state.product[i]
    search.energy, search.moved, search.kept = energy, True, True
    search.work += 2 * points


@kernel
def _start_from_coarser(coarse: int, carried: int, terms: int, harmonics: Harmonics, state: GridState) -> None:
    """Carry the pressure from `coarse` nodes to all, add the waves behind those carried, and set the contact."""
    refine(coarse, state.pressure, state.residual)
    for wave in range(carried, terms):
        add_harmonic(wave, harmonics, state.pressure, state.residual)
    for i in range(state.pressure.size):
        state.contact[i] = state.pressure[i] > 0
    state.search[0].corrections = 0
    state.search[0].moved = state.search[0].kept = False


@kernel
def solve_load(load: float, coarse: int, carried: int, harmonics: Harmonics, grid: Grid, state: GridState) -> bool:
    """Continue with the contact under one load on a grid, and return whether it is done.

    It begins with the pressure of a grid of `coarse` nodes, the first of `state`, and so many waves. It has converged
    if the residual is small on a freshly applied operator, with the pressure free of tension and scaled to the load.
    After `MAX_STEPS` it is done with a larger residual.
    """
    search = state.search[0]
    if search.steps == 0:
        _start_from_coarser(coarse, carried, grid.terms, harmonics, state)
    edge = find_edges(state.contact, state.edge)
    while search.work < search.limit and search.steps < MAX_STEPS:
        search.steps += 1
        if not search.moved:
            _refresh(load, grid, state)
            search.work += state.pressure.size
        plane = mean_in_contact(state.deformed, state.contact)
        contact_gap, violation = violations(plane, grid, state)
        search.plane, search.residual = plane, max(contact_gap, violation)
        solved = search.residual <= grid.max_residual
        if solved and not search.moved:
            return True
        # The contact is corrected when its violations exceed the error on it by a factor that grows with each
        # correction.
        if search.moved and (solved or violation > (FIRST_PATIENCE + search.corrections) * contact_gap):
            search.moved = not (_correct_contact(plane, state) or solved)
            edge = find_edges(state.contact, state.edge)
            search.corrections += 1
            search.kept = False
        else:
            _conjugate_step(plane, edge, grid, state)
    return search.steps == MAX_STEPS


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
def solve_tangent(flatness: float, grid: Grid, state: GridState) -> bool:
    """Continue with the tangent pressure on the contact as it stands; return whether it is done.

    It overwrites the pressure in `state`. A q is constant in contact within `flatness` times the resistance, the
    energy q.A q/N; otherwise the resistance is inf. The initial guess, flat punches on the contact of this load,
    makes the result independent of other loads.
    """
    search, points = state.search[0], state.pressure.size
    edge = find_edges(state.contact, state.edge)
    if search.steps == 0:
        punch_shape(edge, state.contact, state.pressure)
        total = 0.0
        for i in range(points):
            total += state.pressure[i]
        for i in range(points):
            state.pressure[i] *= points / total
        circulant_product(grid.influence, state.pressure, state.spectrum, state.deformed)
        for i in range(points):
            state.deformed[i] = -state.deformed[i]
        search.work += points
        search.steps, search.kept = 1, False
    while search.work < search.limit and search.steps < MAX_STEPS:
        search.steps += 1
        plane = mean_in_contact(state.deformed, state.contact)
        search.resistance = -dot(state.pressure, state.deformed) / points
        if violations(plane, grid, state)[0] <= flatness * max(search.resistance, MIN_RESISTANCE):
            return True
        _conjugate_step(plane, edge, grid, state)
    if search.steps == MAX_STEPS:
        search.resistance = np.inf
    return search.steps == MAX_STEPS


class NestedSolver:
    """One profile on nested grids; the solution under a load depends on no other load."""

    def __init__(self, profile: Waves, points: int, max_residual: float) -> None:
        """Make the grids, and the arrays for a solution on the finest."""
        self.grids, self.harmonics = nested_grids(profile, points, max_residual), harmonics_of(profile)
        self.grid, self.state = self.grids[-1], make_grid_state(points)
        self.states = [leading_part(self.state, grid.height.size) for grid in self.grids]

    def solve(self, load: float) -> float:
        """Return the plane under a load, from the mean on the coarsest grid."""
        self.state.search["work"], coarse, carried = 0, self.grids[0].height.size, 0
        self.states[0].pressure[:] = load
        for grid, state in zip(self.grids, self.states, strict=True):
            self._in_parts(solve_load, load, coarse, carried, self.harmonics, grid, state)
            coarse, carried = grid.height.size, grid.terms
        return float(self.state.search["plane"][0])

    def solve_tangent(self, flatness: float = TANGENT_TOLERANCE) -> float:
        """Return the resistance on the last contact of `solve`, or inf."""
        self._in_parts(solve_tangent, flatness, self.grid, self.state)
        return float(self.state.search["resistance"][0])

    def _in_parts(self, search: Callable[..., bool], *arguments: Any) -> None:
        """Call a kernel on a grid until it is done, for `PART` of the work at a time."""
        done, progress = False, self.state.search
        progress["steps"] = 0
        while not done:
            progress["limit"] = progress["work"] + PART
            done = search(*arguments)

    @property
    def residual(self) -> float:
        """The residual of the load, in g_0."""
        return float(self.state.search["residual"][0])

    @property
    def work(self) -> float:
        """Pairs of FFTs of the load, those of coarser grids by their size."""
        return float(self.state.search["work"][0] / self.grid.height.size)

    def solve_discrete(self, load: float, with_tangent: bool, flatness: float = TANGENT_TOLERANCE) -> NodalSolution:
        """Return the solution under a load; `with_tangent`, also its derivative, at about twice the cost."""
        plane, state = self.solve(load), self.state
        pressure, gap = state.pressure.copy(), plane - state.deformed
        R = np.nan
        if with_tangent and self.residual <= self.grid.max_residual:
            R = self.solve_tangent(flatness)
        return NodalSolution(
            plane, R, pressure, gap, state.pressure, -state.deformed, state.contact, self.residual, self.work
        )
