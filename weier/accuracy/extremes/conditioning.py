"""How well the equations of the boundary elements are conditioned, against the number of nodes."""

from __future__ import annotations

import numpy as np
import xarray as xr
from scipy.linalg import circulant

from weier.theory.halfplane import eigenvalues, influence_coefficients

NODES = np.array([3, *(2**k for k in range(2, 21))])
MOST_DENSE = 1024  # nodes of a matrix that is decomposed: seconds


def operator(points: int) -> float:
    """Condition number of the influence matrix on pressures of mean 0: its largest over its least eigenvalue."""
    sinking = eigenvalues(points)[1:]
    return float(sinking.max() / sinking.min())


def system(points: int, contact: int) -> float:
    """Condition number of the paper's dense equations, with so many neighbouring nodes in contact.

    The influence of the nodes on each other, bordered by the height of the flat and the load.
    """
    influence = circulant(influence_coefficients(points))[:contact, :contact]
    flat, load = np.ones((contact, 1)), np.full((1, contact), 1 / points)
    return float(np.linalg.cond(np.block([[influence, flat], [load, np.zeros((1, 1))]])))


def conditioning() -> xr.Dataset:
    """Condition numbers over the dimension nodes; NaN where no matrix is decomposed."""
    columns = {
        "condition_operator": ([operator(n) for n in NODES], "of the influence matrix on pressures of mean 0"),
        "condition_full": (_systems(1), "of the dense equations in full contact"),
        "condition_half": (_systems(2), "of the dense equations, half of the nodes in contact"),
    }
    about = {"units": "1", "coverage_content_type": "auxiliaryInformation"}
    data = {
        name: ("nodes", np.array(values), {"long_name": f"condition number {text}", "valid_min": 1.0} | about)
        for name, (values, text) in columns.items()
    }
    about = {"long_name": "nodes in one period", "units": "1", "coverage_content_type": "coordinate"}
    return xr.Dataset(data, {"nodes": ("nodes", NODES, about)})


def _systems(share: int) -> list[float]:
    return [system(n, -(-n // share)) if n <= MOST_DENSE else np.nan for n in NODES]
