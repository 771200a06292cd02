"""Edges of contact that stand alone: where each is within the step that the grid makes of it, and what that adds.

A step of an edge from one node to the next lowers the resistance by D, and takes the load a + b (docs/subgrid.md).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array
from weier.kernels.jit import kernel
from weier.methods.bem.grid_solution import GridSolution

CURVATURE = 1 / 24  # c of docs/subgrid.md, for piecewise-linear pressure


class Steps(NamedTuple):
    """The steps of all edges, each of shape (edges,); 0 where one is not known.

    drop, load : D of the resistance, and a + b
    place : how far the edge is in its step, from -1/2 to 1/2
    """

    drop: Array
    load: Array
    place: Array


@kernel
def find_steps(solution: GridSolution) -> Steps:
    """The steps of all edges; zeros where one is not known."""
    edges = solution.edge.size - 2
    points = solution.pressure.size
    steps = Steps(np.zeros(edges), np.zeros(edges), np.zeros(edges))
    for at in range(edges):
        start = solution.edge[at + 1] % points
        outwards = -1 if solution.contact[start] else 1
        inside = start if solution.contact[start] else (start - 1) % points
        outside = (inside + outwards) % points
        closing = solution.rate - solution.displacement[outside]
        if not (solution.per_load[inside] > 0 and closing > 0):
            continue
        drop = solution.per_load[inside] * closing / points
        since = max(solution.pressure[inside], 0.0) / solution.per_load[inside]
        until = max(solution.plane - solution.deformed[outside], 0.0) / closing
        if not since + until > 0:
            continue
        steps.drop[at], steps.load[at] = drop, since + until
        steps.place[at] = since / (since + until) - 0.5
    return steps


@kernel
def correct_edge(steps: Steps, at: int) -> tuple[float, float]:
    """What a lone edge adds to compliance and resistance, by its place in the step."""
    drop, x = steps.drop[at], steps.place[at]
    return drop * steps.load[at] * ((0.25 - x * x) / 2 - CURVATURE), -x * drop
