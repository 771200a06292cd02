"""The rate problem, solved as far as corrected edges need it, from a start that has the right shape there.

Per mean pressure the pressure grows by q on the contact as it stands. Near an edge q is as 1/sqrt(distance), so
that q over the shape of a flat punch is smooth: it is found on a coarse grid first, and carried to the fine one.
"""

from __future__ import annotations

import numpy as np

from weier.kernels.arrays import Array, Flags
from weier.kernels.jit import kernel
from weier.methods.bem import fft
from weier.methods.bem.edges import Edges, find_edges
from weier.methods.bem.grid_solution import next_node, rate_tolerance
from weier.methods.bem.grids import Grid, Hierarchy, grid_of
from weier.methods.bem.windows import EDGE

COARSE_TOLERANCE = 1e-2  # of the rate
MIN_PER_WAVE = 40  # nodes of the coarse grid for each of the finest waves: on fewer it starts no better
MIN_STRIDE = 4  # fine nodes for a coarse one, or it costs more than it saves


@kernel
def punch_shape(edge: Edges, contact: Flags, shape: Array) -> None:
    """Pressure of flat punches on all contacts, q = N/sqrt(distances to both edges in nodes); 0 outside."""
    shape[:] = 0.0
    points = contact.size
    for run in range(1, edge.size - 1):
        start, nodes = edge[run], edge[run + 1] - edge[run]
        if contact[start]:
            node = start
            for i in range(nodes):
                shape[node] = points / np.sqrt((i + EDGE) * (nodes - 1 - i + EDGE))
                node = next_node(node, points)
    if edge.size == 2:
        shape[:] = 1.0


@kernel
def coarsen_contact(contact: Flags, coarse: Flags) -> None:
    """Contact of the coarse nodes: those that have a fine one in contact within half a coarse step."""
    coarse[:] = False
    for i in range(contact.size):
        if contact[i]:
            coarse[(2 * i * coarse.size + contact.size) // (2 * contact.size) % coarse.size] = True


@kernel
def fill_gaps(values: Array, contact: Flags) -> None:
    """Outside contact, the value of the nearest node in contact."""
    points = values.size
    nearest = np.full(points, 2 * points)  # nodes away
    for sweep in range(2):
        away = 2 * points
        last = 0.0
        for step in range(2 * points):
            node = step % points if sweep == 0 else (2 * points - 1 - step) % points
            if contact[node]:
                away, last = 0, values[node]
            elif away < nearest[node]:
                nearest[node] = away + 1
                values[node] = last
                away += 1
            else:
                away += 1


@kernel
def _conjugate_gradients(tolerance: float, edge: Edges, grid: Grid, state: fft.GridState) -> tuple[float, int]:
    """From the pressure in `state`, whose mean is made 1, until A q is flat in contact: the rate, or inf; pairs."""
    state.pressure[:] *= state.pressure.size / state.pressure.sum()
    fft.deformed_surface(np.zeros(state.pressure.size), grid, state)
    pairs, restart, energy = 1, True, 0.0
    for _ in range(fft.MAX_STEPS):
        plane = fft.mean_in_contact(state.deformed, state.contact)
        rate = -fft.dot(state.pressure, state.deformed) / state.pressure.size
        if fft.violations(plane, grid, state)[0] <= max(tolerance * rate, fft.RATE_TOLERANCE * tolerance):
            return rate, pairs
        energy = fft.conjugate_step(plane, edge, restart, energy, grid, state)
        pairs += 2
        restart = False
    return np.inf, pairs


@kernel
def solve_rate(hierarchy: Hierarchy, state: fft.GridState) -> tuple[float, float]:
    """As `fft.solve_rate`, to `rate_tolerance`; coarse pairs of FFTs count by their size.

    It starts from the contact of its own load alone, not from the rate at another load: what a rough rate leaves
    would depend on that load.
    """
    finest = hierarchy.points.size - 1
    edge = find_edges(state.contact, state.edge)
    punch_shape(edge, state.contact, state.pressure)
    pairs = _start_from_coarse_grid(hierarchy, state)
    tolerance = rate_tolerance(hierarchy.tolerance[finest])
    rate, here = _conjugate_gradients(tolerance, edge, grid_of(hierarchy, finest), state)
    return rate, pairs + here


@kernel
def _start_from_coarse_grid(hierarchy: Hierarchy, state: fft.GridState) -> float:
    """Multiply the shape of flat punches by what a coarse grid makes of it, if that pays; pairs of FFTs by size."""
    finest = hierarchy.points.size - 1
    points = hierarchy.points[finest]
    fewest = MIN_PER_WAVE * hierarchy.harmonics.waves_per_period[-1]
    level = 0
    while level < finest and hierarchy.points[level] < fewest:
        level += 1
    pairs = 0.0
    coarse_points = hierarchy.points[level]
    if MIN_STRIDE * coarse_points <= points:
        coarse = fft.make_grid_state(coarse_points)
        coarsen_contact(state.contact, coarse.contact)
        coarse_edge = find_edges(coarse.contact, coarse.edge)
        punch_shape(coarse_edge, coarse.contact, coarse.pressure)
        grid = grid_of(hierarchy, level)
        shape = coarse.pressure.copy()
        rate, here = _conjugate_gradients(COARSE_TOLERANCE, coarse_edge, grid, coarse)
        pairs += here * coarse_points / points
        if rate < np.inf:
            for i in range(coarse_points):
                if coarse.contact[i]:
                    coarse.pressure[i] /= shape[i]
            fill_gaps(coarse.pressure, coarse.contact)
            for i in range(points):
                before, rest = i * coarse_points // points, i * coarse_points % points / points
                after = (before + 1) % coarse_points
                state.pressure[i] *= (1 - rest) * coarse.pressure[before] + rest * coarse.pressure[after]
    return pairs
