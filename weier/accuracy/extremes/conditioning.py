"""Condition numbers of the equations of boundary elements against the number of nodes."""

from __future__ import annotations

import numpy as np
import xarray as xr
from scipy.linalg import circulant

from weier.data import variables
from weier.data.variables import AUXILIARY, LABEL, Variable
from weier.theory.halfplane import eigenvalues, influence_coefficients

NODES = np.array([3, *(2**k for k in range(2, 21))])  # From the coarsest grid to 2^20 nodes, in powers of two.
MAX_DENSE = 1024  # The singular values of a matrix of more nodes take more than seconds.
OWN = {
    "nodes": Variable(("nodes",), "nodes in one period", content=LABEL),
    **{
        f"condition_{name}": Variable(("nodes",), f"condition number of the {text}", least=1.0, content=AUXILIARY)
        for name, text in (
            ("operator", "influence matrix on pressures of mean 0"),
            ("full", "dense equations in full contact"),
            ("half", "dense equations, half of the nodes in contact"),
        )
    },
}


def operator(points: int) -> float:
    """Return the condition number of the influence matrix on pressures of mean 0."""
    values = eigenvalues(points)[1:]
    return float(values.max() / values.min())


def system(points: int, contact: int) -> float:
    """Return the condition number of the paper's dense equations for a number of neighbouring nodes in contact.

    The influence of the nodes on each other, bordered by the height of the rigid plane and the load.
    """
    influence = circulant(influence_coefficients(points))[:contact, :contact]
    plane, load = np.ones((contact, 1)), np.full((1, contact), 1 / points)
    return float(np.linalg.cond(np.block([[influence, plane], [load, np.zeros((1, 1))]])))


def conditioning() -> xr.Dataset:
    """Return condition numbers over the dimension nodes; NaN where no matrix is decomposed."""
    values = {"nodes": NODES, "condition_operator": np.array([operator(n) for n in NODES])}
    for name, divisor in (("full", 1), ("half", 2)):
        system_conditions = [system(n, -(-n // divisor)) if n <= MAX_DENSE else np.nan for n in NODES]
        values[f"condition_{name}"] = np.array(system_conditions)
    columns = {name: ("nodes", column, variables.attributes(name, OWN)) for name, column in values.items()}
    return xr.Dataset(columns).set_coords("nodes")
