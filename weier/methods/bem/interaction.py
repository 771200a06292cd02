"""How contacts displace each other: by forces, and by where these stand beside their nodes.

What a contact carries in the continuum and not on the grid is represented by the pressure of the three nodes about
its middle that has the same force and first two moments. One product with the influence matrix of the grid then
displaces all contacts at once, images included; what the three nodes do to their own contact, on a line without
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
HATS = 1 / 6  # second moment of the triangle of a nodal pressure, in squares of the nodes' spacing


class Interaction(NamedTuple):
    """What is needed to let contacts displace each other.

    mutual : displacement of one contact per force on another, 0 on the diagonal; empty where there are many contacts
    node, beside : the node next to the middle of each, and how far the middle is beside it, in nodes
    eigenvalue : of the influence matrix of the grid
    own : displacement of the nodes 0, 1 and 2 beside a unit force, on a line without images
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
        node[i] = int(np.round(in_nodes))
        beside[i] = in_nodes - node[i]
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
    """Displacement of each contact, its slope and half its curvature, shape (contacts, 3).

    `moments` are zeroth, first and second ones about the middles of the contacts, of the same shape.
    """
    points, spacing = interaction.pressure.size, interaction.spacing
    interaction.pressure[:] = 0.0
    for i in range(moments.shape[0]):
        before, here, after = _nodal_forces(moments[i], interaction.beside[i], spacing)
        node = interaction.node[i]
        interaction.pressure[(node - 1) % points] += before / spacing
        interaction.pressure[node % points] += here / spacing
        interaction.pressure[(node + 1) % points] += after / spacing
    circulant_product(interaction.eigenvalue, interaction.pressure, interaction.spectrum, interaction.displacement)
    effects = np.empty(moments.shape)
    own = interaction.own
    for i in range(moments.shape[0]):
        node, o = interaction.node[i], interaction.beside[i]
        before, here, after = _nodal_forces(moments[i], o, spacing)
        left = interaction.displacement[(node - 1) % points] - own[0] * before - own[1] * here - own[2] * after
        middle = interaction.displacement[node % points] - own[1] * (before + after) - own[0] * here
        right = interaction.displacement[(node + 1) % points] - own[2] * before - own[1] * here - own[0] * after
        slope, bend = (right - left) / 2, (right + left) / 2 - middle
        effects[i, 0] = middle + o * slope + (o * o - HATS) * bend
        effects[i, 1] = (slope + 2 * o * bend) / spacing
        effects[i, 2] = bend / spacing**2
    return effects


@kernel
def _nodal_forces(moment: Array, beside: float, spacing: float) -> tuple[float, float, float]:
    """Forces on three nodes with these moments about a point so far beside the middle one."""
    first = moment[1] / spacing + moment[0] * beside
    second = moment[2] / spacing**2 + 2 * beside * moment[1] / spacing + moment[0] * (beside * beside - HATS)
    return (second - first) / 2, moment[0] - second, (second + first) / 2


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
    moments = np.zeros((n, 3))
    for i in range(n):
        moments[i, 0] = force[i]
    effects = displace(moments, interaction)
    for i in range(n):
        displacement[i] = effects[i, 0]
    return displacement


@kernel
def add_grid_moments(force: float, x: float, spacing: float, moments: Array) -> None:
    """Add first and second moments of a nodal force, at x from where they are taken."""
    moments[0] += force * x
    moments[1] += force * (x**2 + HATS * spacing**2)
