"""How contacts displace each other: by forces, and by where these stand beside their nodes.

What a contact carries in the continuum and not on the grid is represented by the pressure of the four nodes about its
middle that has the same force and first three moments. One product with the influence matrix of the grid then
displaces all contacts at once, images included; what the four nodes do to their own contact, on a line without
images, is taken off, since every contact knows that by itself.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from weier.kernels.arrays import Array, Indices
from weier.kernels.jit import kernel
from weier.kernels.transform import Spectrum
from weier.methods.bem.fft import circulant_product
from weier.methods.bem.grid_solution import Continuum

MAX_DENSE = 64  # contacts that act on each other by a matrix; more do so by products on the grid
MOMENTS = 4  # of a contact, from its force on, and nodes for them
HATS = 1 / 6  # second moment of the triangle of a nodal pressure, in squares of the nodes' spacing


class Interaction(NamedTuple):
    """What is needed to let contacts displace each other.

    mutual : displacement of one contact per force on another, 0 on the diagonal; empty where there are many contacts
    node, beside : the first of the nodes about the middle of each, and how far the middle is beside the second one,
        in nodes
    eigenvalue : of the influence matrix of the grid
    own : displacement of nodes at increasing distances from a unit force, on a line without images
    spacing : of the nodes, in lambda_0
    pressure, displacement, spectrum : of all nodes, shape (N,) and (N//2 + 1,): those of the last product
    """

    mutual: Array
    node: Indices
    beside: Array
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
    node, beside = np.empty(contacts, np.int64), np.empty(contacts)
    for i in range(contacts):
        in_nodes = position[i] * points / continuum.period
        before = int(np.floor(in_nodes))
        node[i], beside[i] = before - 1, in_nodes - before
    return Interaction(
        _mutual(position, contacts if contacts <= MAX_DENSE else 0, continuum.period), node, beside,
        continuum.grid.influence, continuum.influence, continuum.period / points, np.zeros(points), np.zeros(points),
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
            apart = np.sin(np.pi / period * (position[i] - position[j]))
            matrix[i, j] = matrix[j, i] = -2 * np.log(abs(2 * apart))
    return matrix


@kernel
def displace(moments: Array, interaction: Interaction) -> Array:
    """Displacement of each contact and its next derivatives over their factorials, shape (contacts, MOMENTS).

    `moments` are zeroth to third ones about the middles of the contacts, of the same shape.
    """
    points, spacing, own = interaction.pressure.size, interaction.spacing, interaction.own
    forces, effects = np.zeros(moments.shape), np.zeros(moments.shape)
    interaction.pressure[:] = 0.0
    for i in range(moments.shape[0]):
        weights = _weights_of_nodes(interaction.beside[i], spacing, HATS)
        for a in range(MOMENTS):
            for k in range(MOMENTS):
                forces[i, a] += weights[a, k] * moments[i, k]
            interaction.pressure[(interaction.node[i] + a) % points] += forces[i, a] / spacing
    circulant_product(interaction.eigenvalue, interaction.pressure, interaction.spectrum, interaction.displacement)
    for i in range(moments.shape[0]):
        weights = _weights_of_nodes(interaction.beside[i], spacing, 0.0)
        for a in range(MOMENTS):
            displacement = interaction.displacement[(interaction.node[i] + a) % points]
            for b in range(MOMENTS):
                displacement -= own[abs(a - b)] * forces[i, b]
            for k in range(MOMENTS):
                effects[i, k] += weights[a, k] * displacement
    return effects


@kernel
def _weights_of_nodes(beside: float, spacing: float, spread: float) -> Array:
    """Weights of four nodes in a row for moments about a point so far beside the second one, shape (nodes, moments).

    They are forces with these moments, where that on each node is spread by a second moment of its own, in squares of
    the spacing. Without it they interpolate values at the nodes, and their derivatives over factorials, by a cubic.
    """
    weights, o = np.empty((MOMENTS, MOMENTS)), beside
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
    return weights


@kernel
def press(force: Array, interaction: Interaction) -> Array:
    """Displacement of each contact by forces in the middle of the others."""
    n = force.size
    displacement = np.zeros(n)
    if interaction.mutual.shape[0] == n:
        for i in range(n):
            for j in range(n):
                displacement[i] += interaction.mutual[i, j] * force[j]
        return displacement
    moments = np.zeros((n, MOMENTS))
    for i in range(n):
        moments[i, 0] = force[i]
    effects = displace(moments, interaction)
    for i in range(n):
        displacement[i] = effects[i, 0]
    return displacement


@kernel
def add_grid_moments(force: float, x: float, spacing: float, moments: Array) -> None:
    """Add first to third moments of a nodal force, at x from where they are taken."""
    moments[0] += force * x
    moments[1] += force * (x**2 + HATS * spacing**2)
    moments[2] += force * (x**3 + 3 * HATS * spacing**2 * x)
