"""The fast solver: circulant products, active set and preconditioned conjugate gradients on nested grids.

The unknown is the nodal pressure p, the deformed surface is z - A p, and the flat rests on it at the height H:
z - A p = H and p >= 0 in contact, z - A p <= H and p = 0 outside, mean(p) = load. On a given set of contact
nodes this is a quadratic minimisation, solved by conjugate gradients; the preconditioner is A^-1 of the whole
surface, on residuals that run out into the gaps. The gap outside and the pressure inside are known after every step
for free, so the set is corrected as soon as its violations outweigh the error of the current solution on it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.bem.contact import Answer, count, count_patches, no_answer
from weier.bem.grids import Grid, Hierarchy, part_of_hierarchy, refine, superpose
from weier.bem.transform import Spectrum, circulant_product
from weier.jit import kernel

Array = NDArray[np.float64]

# How far a residual runs out of its contact, in widths of the contact, if the gap is as wide. Cut off at the edge it
# would be a jump, which A^-1 takes for a logarithmically large force: the condition number of the preconditioned
# matrix falls from 12 to 2.7 at N = 2048, and with it the steps by a third.
REACH = 2
RATE_TOLERANCE = 1e-6  # the rate is an energy: its error is the square of this
STEPS = 1000  # of conjugate gradients a load and grid; 10 are usual, hundreds for thousands of contacts at once


class State(NamedTuple):
    """Pressure p, deformed surface z - A p, contact and its edges, and the arrays of the conjugate gradients."""

    pressure: Array
    deformed: Array
    direction: Array
    product: Array
    scratch: Array
    spectrum: Spectrum
    contact: NDArray[np.bool_]
    edge: NDArray[np.int64]


@kernel
def make_state(points: int) -> State:
    """Working arrays for grids of up to `points` nodes."""
    return State(
        np.zeros(points), np.zeros(points), np.zeros(points), np.zeros(points), np.zeros(points),
        np.zeros(points // 2 + 1, np.complex128), np.zeros(points, np.bool_), np.zeros(points + 2, np.int64),
    )  # fmt: skip


@kernel
def part_of_state(state: State, points: int) -> State:
    """The leading part of every array, for a grid of `points` nodes."""
    return State(
        state.pressure[:points], state.deformed[:points], state.direction[:points], state.product[:points],
        state.scratch[:points], state.spectrum[: points // 2 + 1], state.contact[:points],
        state.edge[: points + 2],
    )  # fmt: skip


@kernel
def _dot(a: Array, b: Array) -> float:
    # Not np.dot: BLAS shares it among threads, which wait for each other on a busy machine, ten times as long.
    total = 0.0
    for i in range(a.size):
        total += a[i] * b[i]
    return total


@kernel
def _mean_in_contact(values: Array, contact: NDArray[np.bool_]) -> float:
    total = 0.0
    nodes = 0
    for i in range(values.size):
        if contact[i]:
            total += values[i]
            nodes += 1
    return total / nodes


@kernel
def _deform(height: Array, grid: Grid, state: State) -> None:
    """The deformed surface z - A p from scratch."""
    circulant_product(grid.sinking, state.pressure, state.spectrum, state.deformed)
    for i in range(height.size):
        state.deformed[i] = height[i] - state.deformed[i]


@kernel
def _balance(pressure: Array, load: float) -> None:
    """Pressure without tension, scaled to the load."""
    total = 0.0
    for i in range(pressure.size):
        pressure[i] = max(pressure[i], 0.0)
        total += pressure[i]
    for i in range(pressure.size):
        pressure[i] *= load * pressure.size / total


@kernel
def _violations(flat: float, grid: Grid, state: State) -> tuple[float, float]:
    """Largest |gap| in contact; largest penetration outside or tension inside, as lengths."""
    inside = 0.0
    wrong = 0.0
    for i in range(state.pressure.size):
        gap = flat - state.deformed[i]
        if not abs(gap) + abs(state.pressure[i]) < np.inf:  # max() would pass over what is not a number
            return np.inf, np.inf
        if state.contact[i]:
            inside = max(inside, abs(gap))
            wrong = max(wrong, -state.pressure[i] * grid.node_sinking)
        else:
            wrong = max(wrong, -gap)
    return inside, wrong


@kernel
def _correct_contact(flat: float, state: State) -> bool:
    """Release what pulls, add what penetrates; whether anything was released, so that the pressure must change."""
    released = False
    for i in range(state.pressure.size):
        if state.contact[i]:
            state.contact[i] = state.pressure[i] >= 0
            released |= not state.contact[i]
        else:
            state.contact[i] = state.deformed[i] > flat
    return released


@kernel
def _find_edges(state: State) -> int:
    """Nodes where contact begins or ends, in state.edge[1:]; how many. The outer two stand again a period on."""
    contact, edge = state.contact, state.edge
    edges = 0
    for i in range(contact.size):
        if contact[i] != contact[i - 1]:
            edges += 1
            edge[edges] = i
    if edges:
        edge[0] = edge[edges] - contact.size
        edge[edges + 1] = edge[1] + contact.size
    return edges


@kernel
def _way_out(which: int, state: State) -> tuple[int, int, int]:
    """From the last node in contact at this edge into the gap: the node, the direction, and how far to go."""
    before, here, after = state.edge[which - 1], state.edge[which], state.edge[which + 1]
    if state.contact[here]:
        return here, -1, min(here - before + 1, REACH * (after - here))
    # A negative index counts from the end, so that the way leads across the end of the period.
    node = here - 1 - state.contact.size if here > 0 else -1
    return node, 1, min(after - here + 1, REACH * (here - before))


@kernel
def _run_out(values: Array, edges: int, state: State) -> None:
    """From each edge into the gap, add the value there, falling to 0 in a straight line."""
    for which in range(1, edges + 1):
        node, side, reach = _way_out(which, state)
        fall = values[node] / reach
        for step in range(1, reach):
            values[node + side * step] += fall * (reach - step)


@kernel
def _run_in(values: Array, edges: int, state: State) -> None:
    """The transpose: to the value at each edge, add those in the gap, with weights that fall in a straight line."""
    for which in range(1, edges + 1):
        node, side, reach = _way_out(which, state)
        total = 0.0
        for step in range(1, reach):
            total += values[node + side * step] * (reach - step)
        values[node] += total / reach


@kernel
def _conjugate_step(flat: float, steepness: float, edges: int, grid: Grid, state: State) -> float:
    """One step of preconditioned conjugate gradients on the contact, keeping the load: two pairs of FFTs.

    `steepness` is what the last step returned, or 0 for a first step on this contact with so many `edges`.
    """
    p, deformed, direction, product, residual, contact = (
        state.pressure, state.deformed, state.direction, state.product, state.scratch, state.contact,
    )  # fmt: skip
    for i in range(p.size):
        residual[i] = deformed[i] - flat if contact[i] else 0.0
    _run_out(residual, edges, state)
    circulant_product(grid.inverse, residual, state.spectrum, product)
    _run_in(product, edges, state)
    shift = _mean_in_contact(product, contact)
    steepness_now = 0.0
    for i in range(p.size):
        if contact[i]:
            steepness_now += residual[i] * (product[i] - shift)
    turn = steepness_now / steepness if steepness > 0 else 0.0
    for i in range(p.size):
        direction[i] = product[i] - shift + turn * direction[i] if contact[i] else 0.0
    circulant_product(grid.sinking, direction, state.spectrum, product)
    length = steepness_now / _dot(direction, product) if steepness_now > 0 else 0.0  # 0 on a single node
    for i in range(p.size):
        p[i] += length * direction[i]
        deformed[i] -= length * product[i]
    return steepness_now


@kernel
def solve_load(load: float, grid: Grid, state: State) -> tuple[float, float, int]:
    """Contact under one load from the pressure and contact in `state`: flat H, residual, pairs of FFTs.

    Converged means so on a freshly applied operator, with the pressure free of tension and scaled to the load;
    otherwise the residual stays above the tolerance.
    """
    pairs = 0
    fresh = True
    steepness = 0.0
    edges = 0
    patience = 1
    for _ in range(STEPS):
        if fresh:
            _balance(state.pressure, load)
            _deform(grid.height, grid, state)
            pairs += 1
        if steepness == 0:
            edges = _find_edges(state)
        flat = _mean_in_contact(state.deformed, state.contact)
        inside, wrong = _violations(flat, grid, state)
        solved = max(inside, wrong) <= grid.tolerance
        if solved and fresh:
            break
        if not fresh and (solved or wrong > patience * inside):
            fresh = _correct_contact(flat, state) or solved
            patience += 1
            steepness = 0.0
        else:
            steepness = _conjugate_step(flat, steepness, edges, grid, state)
            pairs += 2
            fresh = False
    return flat, max(inside, wrong), pairs


@kernel
def solve_rate(tolerance: float, grid: Grid, state: State) -> tuple[float, int]:
    """Height that the flat loses per mean pressure on the contact as it stands, or inf if missed; pairs of FFTs.

    The pressure in `state` becomes the pressure per load, q, and the rate is the energy q.Aq.
    """
    edges = _find_edges(state)
    nodes = count(state.contact)
    for i in range(state.pressure.size):
        state.pressure[i] = state.pressure.size / nodes if state.contact[i] else 0.0
    _deform(np.zeros(state.pressure.size), grid, state)
    pairs = 1
    steepness = 0.0
    for _ in range(STEPS):
        flat = _mean_in_contact(state.deformed, state.contact)
        inside = 0.0
        for i in range(state.pressure.size):
            if state.contact[i]:
                inside = max(inside, abs(flat - state.deformed[i]))
        if inside <= tolerance:
            break
        steepness = _conjugate_step(flat, steepness, edges, grid, state)
        pairs += 2
    if not inside <= tolerance:
        return np.inf, pairs
    return -_dot(state.pressure, state.deformed) / state.pressure.size, pairs


@kernel
def _touch(state: State) -> None:
    """Contact where the pressure is positive."""
    for i in range(state.pressure.size):
        state.contact[i] = state.pressure[i] > 0


@kernel
def descend(load: float, hierarchy: Hierarchy, start: Array, whole: State) -> tuple[float, float, float]:
    """Solve one load on every grid, coarse to fine: flat H, residual, pairs of FFTs, each grid's by its size.

    `start` is the pressure to begin with on the coarsest grid, and becomes its solution; `whole` that of the finest.
    """
    pairs = 0.0
    finest = hierarchy.points.size - 1
    for level in range(finest + 1):
        points = hierarchy.points[level]
        state = part_of_state(whole, points)
        if level == 0:
            state.pressure[:] = start
        else:
            refine(points // 2, state.pressure)
            for wave in range(hierarchy.terms[level - 1], hierarchy.terms[level]):
                superpose(wave, hierarchy.waves, state.pressure, state.scratch)
        _touch(state)
        flat, residual, here = solve_load(load, part_of_hierarchy(hierarchy, level), state)
        pairs += here * points / hierarchy.points[finest]
        if level == 0:
            start[:] = state.pressure
    return flat, residual, pairs


@kernel
def solve_loads(hierarchy: Hierarchy, pressure: Array, loads: Array, with_resistance: bool) -> Answer:
    """Solve every load from the heaviest down; on the coarsest grid each starts from the one before.

    Parameters
    ----------
    hierarchy : Hierarchy
        The grids; the last one carries the answer.
    pressure : array, shape (points of the coarsest grid,)
        Where it is positive the search for the contact begins; overwritten.
    loads : array, shape (loads,)
        Mean pressures, increasing, in p_0*.
    with_resistance : bool
        Whether to solve for the rate too, at about the cost of another load.

    Returns
    -------
    Answer
        Arrays over the loads, in their order; work counts pairs of FFTs, those of coarser grids by their size.

    """
    answer = no_answer(loads.size)
    finest = hierarchy.points.size - 1
    state = make_state(hierarchy.points[finest])
    for load in range(loads.size - 1, -1, -1):
        flat, residual, pairs = descend(loads[load], hierarchy, pressure, state)
        answer.flat[load] = flat
        answer.residual[load] = residual
        answer.contact_nodes[load] = count(state.contact)
        answer.patches[load] = count_patches(state.contact)
        answer.work[load] = pairs
        if with_resistance:
            rate, pairs = solve_rate(RATE_TOLERANCE, part_of_hierarchy(hierarchy, finest), state)
            answer.resistance[load] = rate
            answer.work[load] += pairs
    return answer
