"""The next order of edges of contact, and how far their steps may be misjudged, told by how these differ.

A step of an edge from one node to the next changes the compliance by D (a + b) and the resistance by D
(docs/subgrid.md). Contacts and gaps that share an edge bear on each other by near = (narrower run/both)^2.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Flags
from weier.kernels.jit import kernel
from weier.methods.bem.edges import Edges
from weier.methods.bem.grid_solution import GridSolution

# Of a step's change of the compliance, and of the resistance, fitted to cover measured errors (docs/subgrid.md);
# wave is 2 pi/points a wave.
NEAR_IMAGES = np.array([0.13, 0.08])  # times near^2, of the resistance, for one contact and its images; load times it
NEAR_LET_GO = np.array([0.35, 0.4])  # times near wave^2, and near, where a contact of the grid has let go
NEAR_GAP = np.array([0.0025, 0.16])  # times near, for gaps with a polynomial
GAP = np.array([0.012, 0.07])  # times wave^2, for the same, since polynomials stand for waves
ALONE = np.array([0.08, 0.33])  # over the nodes of the narrower run, for edges without a polynomial
# In place of one over the nodes where it is more, times s^2: beside a shoulder of the surface, along which an edge
# runs fast, fewer nodes than those of the run belong to it.
UNEVEN, MAX_UNEVEN = 2.2, 3.0
NEXT = 0.25  # times what these are off by to the next order, which is taken off
SHARE = 0.2  # times how far A q is from flat and the share of the load of the last node, of the resistance
# The next order of an edge without a polynomial, measured on grids of one wave and on random series: the next step
# has a q that is larger by a share r, and a load that is longer by a share of about 2 s. With x = f - 1/2, these are
# the coefficients of 1, x, x^2 and x^3, times r and s.
STIFFER_COMPLIANCE = np.array([-0.023, -0.10, 0.0, 0.42])
LONGER_COMPLIANCE = np.array([0.021, 0.082, 0.0, -0.158])
STIFFER_RESISTANCE = np.array([-0.22, 0.0, 2.3, 0.0])
LONGER_RESISTANCE = np.array([0.08, 0.0, -0.51, 0.0])
CROSS = 0.5  # times x x' D/nodes, of the resistance, for two edges of one run
NEXT_CLOSING = 4.7253  # closing of the next node over the q of the last one, times N/L, at an edge far from others
MAX_CHANGE = 2.0  # of r and s: they say nothing where a run has a node or two


class Steps(NamedTuple):
    """The steps of all edges, of shape (edges,).

    change : of compliance, so far at most, and resistance, shape (edges, 2)
    share : of one more load that the last node takes
    place : x, how far the edge is in its step, from -1/2 to 1/2
    stiffer, longer : r and s, by how much the next step differs
    """

    change: Array
    share: Array
    place: Array
    stiffer: Array
    longer: Array


@kernel
def find_steps(solution: GridSolution, edge: Edges, mean_pressure: float, period: float) -> Steps:
    """The steps of all edges; zeros where one is not known."""
    edges = edge.size - 2
    points = solution.pressure.size
    steps = Steps(np.zeros((edges, 2)), np.zeros(edges), np.zeros(edges), np.zeros(edges), np.zeros(edges))
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
        load = min(since + until, mean_pressure)  # a contact is no older than the load
        steps.change[at, 0], steps.change[at, 1] = drop * load, drop
        steps.share[at] = solution.per_load[inside] / points
        steps.place[at] = since / (since + until) - 0.5
        steps.stiffer[at] = min(max(stiffer, -MAX_CHANGE), MAX_CHANGE)
        steps.longer[at] = min(max(growth, -MAX_CHANGE), MAX_CHANGE)
    return steps


@kernel
def errors_of_edges(
    solution: GridSolution, edge: Edges, steps: Steps, polynomial: Flags, angle: float, flatness: float,
    let_go: bool, mean_pressure: float,
) -> tuple[float, float]:  # fmt: skip
    """What steps that are misjudged change of compliance and resistance at most; `let_go` is of any contact."""
    if is_lone_with_polynomial(solution, edge, polynomial):
        return _errors_of_images(solution, edge, steps, mean_pressure)
    runs = edge.size - 2
    errors = np.zeros(2)
    for run in range(runs):
        here, before = edge[run + 2] - edge[run + 1], edge[run + 1] - edge[run]
        narrower = min(here, before)
        near = (narrower / (here + before)) ** 2
        of_contact, of_gap = polynomial[run], polynomial[run - 1]
        if not solution.contact[edge[run + 1] % solution.pressure.size]:
            of_contact, of_gap = of_gap, of_contact
        for quantity in range(2):
            if of_gap:
                share = NEAR_GAP[quantity] * near + GAP[quantity] * angle**2
            elif of_contact:
                share = NEAR_LET_GO[quantity] * near * (angle**2 if quantity == 0 else 1.0) if let_go else 0.0
            else:
                share = ALONE[quantity] * max(1 / narrower, min(UNEVEN * steps.longer[run] ** 2, MAX_UNEVEN))
            errors[quantity] += share * steps.change[run, quantity]
        errors[1] += SHARE * flatness * solution.rate * steps.share[run]
    higher, faster = next_order(edge, steps, polynomial)
    return errors[0] + NEXT * abs(higher), errors[1] + NEXT * abs(faster)


@kernel
def is_lone_with_polynomial(solution: GridSolution, edge: Edges, polynomial: Flags) -> bool:
    """Whether one contact has the whole load, whatever the rate, and has had it from first touch on."""
    if edge.size != 4:
        return False
    return bool(polynomial[0] if solution.contact[edge[1] % solution.pressure.size] else polynomial[1])


@kernel
def _errors_of_images(solution: GridSolution, edge: Edges, steps: Steps, mean_pressure: float) -> tuple[float, float]:
    """What the images of a single contact may change."""
    nodes = min(edge[2] - edge[1], edge[3] - edge[2])
    change = (nodes / solution.pressure.size) ** 4 * steps.change[:, 1].sum()
    return NEAR_IMAGES[0] * change * mean_pressure, NEAR_IMAGES[1] * change


@kernel
def next_order(edge: Edges, steps: Steps, polynomial: Flags) -> tuple[float, float]:
    """By how much the next order of the edges that stand alone makes compliance and resistance too large."""
    alone = np.zeros(polynomial.size, np.bool_)
    for run in range(alone.size):
        alone[run] = not (polynomial[run] or polynomial[run - 1])
    off = rate_off = 0.0
    for run in range(alone.size):
        x = steps.place[run]
        if alone[run] and min(edge[run + 2] - edge[run + 1], edge[run + 1] - edge[run]) > 1:  # one node has no steps
            r, s = steps.stiffer[run], steps.longer[run]
            off += steps.change[run, 0] * (r * _cubic(STIFFER_COMPLIANCE, x) + s * _cubic(LONGER_COMPLIANCE, x))
            rate_off += steps.change[run, 1] * (r * _cubic(STIFFER_RESISTANCE, x) + s * _cubic(LONGER_RESISTANCE, x))
        after = (run + 1) % alone.size
        if alone[run] or alone[after]:
            drop = np.sqrt(steps.change[run, 1] * steps.change[after, 1])
            rate_off -= CROSS * drop * x * steps.place[after] / (edge[run + 2] - edge[run + 1])
    return off, rate_off


@kernel
def _cubic(coefficients: Array, x: float) -> float:
    return float(coefficients[0] + x * (coefficients[1] + x * (coefficients[2] + x * coefficients[3])))
