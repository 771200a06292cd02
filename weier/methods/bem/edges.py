"""The edges of contact: residuals continued across them, for the preconditioner, and where each is within its step.

A step of an edge from one node to the next lowers the resistance by D, and takes the load a + b (docs/subgrid.md).
"""

from __future__ import annotations

import numpy as np

from weier.kernels.arrays import Array, Flags, Indices, Record, Records, record_type
from weier.kernels.jit import kernel
from weier.methods.bem.factors import UNEVEN
from weier.methods.bem.grid_solution import GridSolution

# Beyond an edge the residual is continued into the gap, falling linearly to 0 over REACH contact widths (less if the
# gap is narrower). Cut off at the edge, it would be a jump, which A^-1 takes for a logarithmically large force: the
# condition number of the preconditioned matrix falls from 12 to 2.7 at N = 2048, and with it the steps by a third.
REACH = 2
CURVATURE = 1 / 24  # c of docs/subgrid.md, for piecewise-linear pressure
# Behind an edge that moves evenly, p/q grows with the distance by twice the load of a step a node, and beyond it g/t
# by two thirds, since p goes as the root of the distance and g as its power 3/2. So measured beside the edge itself:
BEHIND, BEYOND = 2.7, 0.6

# The step of an edge: `drop` is D of the resistance, `load` is a + b, and `position`, from -1/2 to 1/2, tells how
# far the edge is in it. It is `uneven` if the steps beside it take far more load than this one.
STEP = record_type(("drop load position", np.float64, ()), ("uneven", np.bool_, ()))


@kernel
def find_edges(contact: Flags, space: Indices) -> Indices:
    """Nodes where contact begins or ends, between two more.

    The first and the last number are the last and the first edge, shifted by one period. `space`, shape (N + 2,), is
    where they are written; without an edge they mean nothing.
    """
    edges = 0
    for i in range(contact.size):
        if contact[i] != contact[i - 1]:
            edges += 1
            space[edges] = i
    if edges:
        space[0] = space[edges] - contact.size
        space[edges + 1] = space[1] + contact.size
    return space[: edges + 2]


@kernel
def _path_into_gap(which: int, edge: Indices, contact: Flags) -> tuple[int, int, int]:
    """From the last node in contact at this edge into the gap: the node, the direction, and how far to go."""
    before, here, after = edge[which - 1], edge[which], edge[which + 1]
    if contact[here]:
        return here, -1, min(here - before + 1, REACH * (after - here))
    # A negative index counts from the end, so that the path leads across the end of the period.
    node = here - 1 - contact.size if here > 0 else -1
    return node, 1, min(after - here + 1, REACH * (here - before))


@kernel
def extrapolate_into_gap(values: Array, edge: Indices, contact: Flags) -> None:
    """From each edge into the gap, add the value there, falling to 0 in a straight line."""
    for which in range(1, edge.size - 1):
        node, side, reach = _path_into_gap(which, edge, contact)
        fall = values[node] / reach
        for step in range(1, reach):
            values[node + side * step] += fall * (reach - step)


@kernel
def restrict_from_gap(values: Array, edge: Indices, contact: Flags) -> None:
    """The transpose: to the value at each edge, add those in the gap, with weights that fall in a straight line."""
    for which in range(1, edge.size - 1):
        node, side, reach = _path_into_gap(which, edge, contact)
        total = 0.0
        for step in range(1, reach):
            total += values[node + side * step] * (reach - step)
        values[node] += total / reach


@kernel
def find_steps(solution: GridSolution) -> Records:
    """The steps of all edges, of shape (edges,); zeros where one is not known."""
    points, steps = solution.pressure.size, np.zeros(solution.edge.size - 2, STEP)
    for at in range(steps.size):
        start = solution.edge[at + 1] % points
        outwards = -1 if solution.contact[start] else 1
        inside = start if solution.contact[start] else (start - 1) % points
        outside = (inside + outwards) % points
        since, until, closing = _since(inside, solution), _until(outside, solution), _closing(outside, solution)
        load = since + until
        if solution.per_load[inside] > 0 and closing > 0 and load > 0:
            step, behind, beyond = steps[at], (inside - outwards) % points, (outside + outwards) % points
            step.drop = solution.per_load[inside] * closing / points
            step.load, step.position = load, since / load - 0.5
            step.uneven = solution.contact[behind] and _since(behind, solution) - since > UNEVEN * BEHIND * load
            step.uneven |= not solution.contact[beyond] and _until(beyond, solution) - until > UNEVEN * BEYOND * load
    return steps


@kernel
def _closing(node: int, solution: GridSolution) -> float:
    """By how much the gap at a node falls per mean pressure."""
    return solution.rate - solution.displacement[node]


@kernel
def _since(node: int, solution: GridSolution) -> float:
    """The load since a node has touched; 0 where that means nothing."""
    share = solution.per_load[node]
    return max(solution.pressure[node], 0.0) / share if share > 0 else 0.0


@kernel
def _until(node: int, solution: GridSolution) -> float:
    """The load until a node touches; 0 where that means nothing."""
    closing = _closing(node, solution)
    return max(solution.plane - solution.deformed[node], 0.0) / closing if closing > 0 else 0.0


@kernel
def correct_edge(step: Record) -> tuple[float, float]:
    """What a lone edge adds to compliance and resistance, by its position in the step."""
    return step.drop * step.load * ((0.25 - step.position**2) / 2 - CURVATURE), -step.position * step.drop
