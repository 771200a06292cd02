"""One load solved on the grid, and what its correction knows of grid and profile besides."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Flags, Indices
from weier.kernels.jit import kernel
from weier.methods.bem.grids import Grid
from weier.methods.bem.local_fit import MAX_MARGIN, Windows, make_windows
from weier.theory.halfplane import eigenvalues
from weier.theory.waves import Waves

MAX_NARROW = 256  # nodes of a contact or gap with a polynomial; the next edge is then too far to matter


@kernel
def next_node(node: int, points: int) -> int:
    """The node after this one of so many; a remainder takes as long as ten additions."""
    return node + 1 if node + 1 < points else 0


class GridSolution(NamedTuple):
    """A converged solution on N nodes, and its rate per mean pressure; arrays of shape (N,).

    plane : height H of the plane above the mean plane, in g_0
    rate : by which it sinks on the contact as it stands, in g_0/p_0*
    pressure, deformed : p, in p_0*, and z - A p, in g_0
    per_load, displacement : q, of mean 1, and A q, in g_0/p_0*
    contact : whether a node is in contact
    edge : where contact begins or ends, as `find_edges` has it
    """

    plane: float
    rate: float
    pressure: Array
    deformed: Array
    per_load: Array
    displacement: Array
    contact: Flags
    edge: Indices


class Continuum(NamedTuple):
    """What the correction knows of grid and profile.

    grid : on which the solution was found
    influence : displacement at j nodes from a unit force, of a line without images, shape (nodes,)
    stiffness : pressure at j nodes from a unit displacement of one node, the same, shape (nodes,)
    windows : fits on the nodes about contacts and gaps
    narrow : nodes of the largest contact, or gap, that is given a polynomial: half a finest wave
    angle : 2 pi over the points for each of the finest waves
    period : in lambda_0
    """

    grid: Grid
    influence: Array
    stiffness: Array
    windows: Windows
    narrow: int
    angle: float
    period: float


def make_continuum(profile: Waves, grid: Grid) -> Continuum:
    """Tables for a profile on a grid."""
    points = grid.height.size
    narrow = min(points // (2 * profile.waves_per_period[-1]) + 1, MAX_NARROW)
    period, nodes = float(profile.period), narrow + 2 * MAX_MARGIN
    influence = _line_influence(nodes) - 2 * np.log(2 * np.pi / points)
    stiffness = _line_stiffness(nodes) * points / period
    angle = 2 * np.pi * profile.waves_per_period[-1] / points
    return Continuum(grid, influence, stiffness, make_windows(nodes), narrow, angle, period)


def _line_influence(nodes: int) -> Array:
    """Displacement by a triangle of pressure of unit force, at whole distances j, but for a constant."""
    j = np.abs(np.arange(-1, nodes + 1.0))
    twice = j * j / 2 * np.log(np.where(j > 0, j, 1))  # integrates ln twice, but for -3/4 j^2
    return np.asarray(3 - 2 * np.diff(twice, 2))


@lru_cache(maxsize=4)
def _line_stiffness(nodes: int, points: int = 2**14) -> Array:
    """Pressure by a unit displacement of one node on a line of unit steps, at whole distances."""
    ring = np.fft.irfft(np.concatenate([[0], 1 / eigenvalues(points, points)[1:]]), points)[:nodes]
    # Far away it is -1/(2 pi^2 j^2), and on the ring the sum of that over all turns; take the others off.
    j = np.arange(1, nodes)
    turns = 1 / (2 * points**2 * np.sin(np.pi * j / points) ** 2) - 1 / (2 * np.pi**2 * j**2)
    return np.asarray(ring + np.concatenate([[1 / (6 * points**2)], turns]))
