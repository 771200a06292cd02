"""One load on the grid, solved: what the continuum is told of it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.bem.edges import Flags

Array = NDArray[np.float64]


class Solution(NamedTuple):
    """A converged solution on N nodes, and its rate per mean pressure; arrays of shape (N,).

    flat : height H of the flat above the mean plane, in g_0
    rate : by which it sinks on the contact as it stands, in g_0/p_0*
    pressure, deformed : p, in p_0*, and z - A p, in g_0
    per_load, displacement : q, of mean 1, and A q, in g_0/p_0*
    contact : whether a node is in contact
    """

    flat: float
    rate: float
    pressure: Array
    deformed: Array
    per_load: Array
    displacement: Array
    contact: Flags
