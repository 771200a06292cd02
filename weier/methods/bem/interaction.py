"""How contacts displace each other: by forces, and by where these stand beside their nodes.

What a contact carries in the continuum and not on the grid is represented by the pressure of the four nodes about its
middle that has the same force and first three moments. One product with the influence matrix of the grid then
displaces all contacts at once, images included; what the four nodes do to their own contact, on a line without
images, is taken off, since every contact knows that by itself.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Indices, Spectrum
from weier.kernels.jit import kernel
from weier.methods.bem.active_set import circulant_product
from weier.methods.bem.grid_solution import Continuum
from weier.theory.halfplane import displacement_at_distance

MAX_DENSE = 64  # contacts that act on each other by a matrix; more do so by products on the grid
MOMENTS = 4  # of a contact, from its force on, and nodes for them
HATS = 1 / 6  # second moment of the triangle of a nodal pressure, in squares of the nodes' spacing


class Interaction(NamedTuple):
    """What is needed to let contacts displace each other.

    mutual : displacement of one contact per force on another, 0 on the diagonal; empty where there are many contacts
    node : the first of the four nodes about the middle of each
    weights : of these nodes for moments about the middle, shape (contacts, nodes, moments)
    eigenvalue : of the influence matrix of the grid
    own : displacement of nodes at increasing distances from a unit force, on a line without images
    spacing : of the nodes, in lambda_0
    pressure, displacement, spectrum : of all nodes, shape (N,) and (N//2 + 1,): those of the last product
    """

    mutual: Array
    node: Indices
    weights: Array
    eigenvalue: Array
    own: Array
    spacing: float
    pressure: Array
    displacement: Array
    spectrum: Spectrum


@kernel
def make_interaction(position: Array, continuum: Continuum) -> Interaction:
    """The interaction of contacts with these middles."""
    points, contacts = continuum.grid.height.size, position.size
    spacing = continuum.period / points
    node, weights = np.empty(contacts, np.int64), np.empty((contacts, MOMENTS, MOMENTS))
    for i in range(contacts):
        before = int(np.floor(position[i] / spacing))
        node[i] = before - 1
        _weigh_nodes(position[i] / spacing - before, spacing, weights[i])
    return Interaction(
        _mutual(position, contacts if contacts <= MAX_DENSE else 0, continuum.period), node, weights,
        continuum.grid.influence, continuum.influence, spacing, np.zeros(points), np.zeros(points),
        np.zeros(points // 2 + 1, np.complex128),
    )  # fmt: skip


@kernel
def _mutual(position: Array, contacts: int, period: float) -> Array:
    """Displacements -2 ln|2 sin(pi x/L)| per force of contacts at the distances x.

    With the compliance -2 ln(pi a/L) of flat punches as its diagonal this is a matrix of energies, and positive: it
    is that of charges on circles, whose diameters are the contacts.
    """
    matrix = np.zeros((contacts, contacts))
    for i in range(contacts):
        for j in range(i):
            matrix[i, j] = matrix[j, i] = displacement_at_distance(position[i] - position[j], period)
    return matrix


@kernel
def displace(moments: Array, interaction: Interaction) -> Array:
    """Displacement of each contact and its next derivatives over their factorials, shape (contacts, MOMENTS).

    `moments` are zeroth to third ones about the middles of the contacts, of the same shape.
    """
    points, weights = interaction.pressure.size, interaction.weights
    forces, effects = np.zeros(moments.shape), np.zeros(moments.shape)
    interaction.pressure[:] = 0.0
    if not moments.any():
        interaction.displacement[:] = 0.0
        return effects
    for i in range(moments.shape[0]):
        for a in range(MOMENTS):
            for k in range(MOMENTS):
                forces[i, a] += weights[i, a, k] * moments[i, k]
            interaction.pressure[(interaction.node[i] + a) % points] += forces[i, a] / interaction.spacing
    circulant_product(interaction.eigenvalue, interaction.pressure, interaction.spectrum, interaction.displacement)
    for i in range(moments.shape[0]):
        for a in range(MOMENTS):
            displacement = interaction.displacement[(interaction.node[i] + a) % points]
            for b in range(MOMENTS):
                displacement -= interaction.own[abs(a - b)] * forces[i, b]
            for k in range(MOMENTS):
                effects[i, k] += weights[i, a, k] * displacement
    return effects


@kernel
def _weigh_nodes(beside: float, spacing: float, weights: Array) -> None:
    """Weights of four nodes in a row for moments about a point so far beside the second one, shape (nodes, moments).

    They are forces with these moments, and they interpolate values at the nodes, and their derivatives over
    factorials, by a cubic. A nodal pressure is a triangle: half of its second moment is taken off either way, so that
    contacts act on each other by a symmetric matrix.
    """
    o, spread = beside, HATS / 2
    powers = (
        (1.0, o, o * o - spread, o**3 - 3 * spread * o),
        (0.0, 1.0, 2 * o, 3 * (o * o - spread)),
        (0.0, 0.0, 1.0, 3 * o),
        (0.0, 0.0, 0.0, 1.0),
    )
    for k in range(MOMENTS):
        zeroth, first, second, third = powers[k]
        weights[0, k] = (3 * second - third - 2 * first) / 6
        weights[1, k] = (third - first) / 2 - second + zeroth
        weights[2, k] = (second - third) / 2 + first
        weights[3, k] = (third - first) / 6
        weights[:, k] /= spacing**k


@kernel
def press(force: Array, interaction: Interaction) -> Array:
    """Displacement of each contact by forces in the middle of the others."""
    n = force.size
    if interaction.mutual.shape[0] == n:
        displacement = np.zeros(n)
        for i in range(n):
            for j in range(n):
                displacement[i] += interaction.mutual[i, j] * force[j]
        return displacement
    moments = np.zeros((n, MOMENTS))
    moments[:, 0] = force
    return displace(moments, interaction)[:, 0].copy()


@kernel
def add_grid_moments(force: float, x: float, spacing: float, moments: Array) -> None:
    """Add first to third moments of a nodal force, at x from where they are taken."""
    moments[0] += force * x
    moments[1] += force * (x**2 + HATS * spacing**2)
    moments[2] += force * (x**3 + 3 * HATS * spacing**2 * x)
