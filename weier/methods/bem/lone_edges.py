"""Edges of contact that stand alone: where each is within the step that the grid makes of it, and what that adds.

A step of an edge from one node to the next lowers the resistance by D, and takes the load a + b (docs/subgrid.md).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array
from weier.kernels.jit import kernel
from weier.methods.bem.edges import Edges
from weier.methods.bem.grid_solution import GridSolution

CURVATURE = 1 / 24  # c of docs/subgrid.md, for piecewise-linear pressure
NEXT_CLOSING = 4.7253  # closing of the next node over the q of the last one, times N/L, at an edge far from others
MAX_CHANGE = 2.0  # of r and s: they say nothing where a run has a node or two
# The next order of an edge without a polynomial, measured on grids of one wave and on random series: the next step
# has a q that is larger by a share r, and a load that is longer by a share of about 2 s. With x = f - 1/2, these are
# the coefficients of 1, x, x^2 and x^3, times r and s.
STIFFER_COMPLIANCE = np.array([-0.023, -0.10, 0.0, 0.42])
LONGER_COMPLIANCE = np.array([0.021, 0.082, 0.0, -0.158])
STIFFER_RESISTANCE = np.array([-0.22, 0.0, 2.3, 0.0])
LONGER_RESISTANCE = np.array([0.08, 0.0, -0.51, 0.0])


class Steps(NamedTuple):
    """The steps of all edges, each of shape (edges,); 0 where one is not known.

    drop, load : D of the resistance, and a + b
    place : x, how far the edge is in its step, from -1/2 to 1/2
    stiffer, longer : r and s, by how much the next step differs
    """

    drop: Array
    load: Array
    place: Array
    stiffer: Array
    longer: Array


@kernel
def find_steps(solution: GridSolution, edge: Edges, period: float) -> Steps:
    """The steps of all edges; zeros where one is not known."""
    edges = edge.size - 2
    points = solution.pressure.size
    steps = Steps(np.zeros(edges), np.zeros(edges), np.zeros(edges), np.zeros(edges), np.zeros(edges))
    for at in range(edges):
        start = edge[at + 1] % points
        outwards = -1 if solution.contact[start] else 1
        inside = start if solution.contact[start] else (start - 1) % points
        further, outside = (inside - outwards) % points, (inside + outwards) % points
        beyond = (outside + outwards) % points
        closing = solution.rate - solution.displacement[outside]
        if not (solution.per_load[inside] > 0 and closing > 0):
            continue
        drop = solution.per_load[inside] * closing / points
        since = max(solution.pressure[inside], 0.0) / solution.per_load[inside]
        until = max(solution.plane - solution.deformed[outside], 0.0) / closing
        if not since + until > 0:
            continue
        # What the node further inside carried when this one was reached, and the gap beyond the next when that is.
        before = solution.pressure[further] - since * solution.per_load[further]
        after = solution.plane - solution.deformed[beyond] - until * (solution.rate - solution.displacement[beyond])
        growth = (after / closing - before / solution.per_load[inside]) / (2 * (since + until))
        stiffer = closing * points / (solution.per_load[inside] * period * NEXT_CLOSING) - 1
        steps.drop[at], steps.load[at] = drop, since + until
        steps.place[at] = since / (since + until) - 0.5
        steps.stiffer[at] = min(max(stiffer, -MAX_CHANGE), MAX_CHANGE)
        steps.longer[at] = min(max(growth, -MAX_CHANGE), MAX_CHANGE)
    return steps


@kernel
def correct_edge(steps: Steps, at: int, nodes: int, mean_pressure: float) -> tuple[float, float]:
    """What a lone edge adds to compliance and resistance, by its place in the step and by how the steps go on.

    `nodes` are those of the narrower one of contact and gap: of one node no further steps are known. No step is
    longer than the load.
    """
    drop, x = steps.drop[at], steps.place[at]
    compliance, resistance = drop * steps.load[at] * ((0.25 - x * x) / 2 - CURVATURE), -x * drop
    if nodes > 1:
        r, s = steps.stiffer[at], steps.longer[at]
        change = drop * min(steps.load[at], mean_pressure)
        compliance -= change * (r * _cubic(STIFFER_COMPLIANCE, x) + s * _cubic(LONGER_COMPLIANCE, x))
        resistance -= drop * (r * _cubic(STIFFER_RESISTANCE, x) + s * _cubic(LONGER_RESISTANCE, x))
    return compliance, resistance


@kernel
def _cubic(coefficients: Array, x: float) -> float:
    return float(coefficients[0] + x * (coefficients[1] + x * (coefficients[2] + x * coefficients[3])))
