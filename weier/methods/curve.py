"""The common result type of all methods."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from weier.kernels.arrays import Array, Indices

QUANTITIES = COMPLIANCE, RESISTANCE = "compliance", "resistance"


@dataclass(frozen=True, eq=False)
class Curve:
    """Quantities over the loads, by the names of `weier.data.variables`, which has their meanings and units.

    Every method returns compliance and resistance, NaN if it has none. Other quantities are None unless the method
    returns them. Arrays have the shape (loads,), but for `contact_edge`, of shape (loads, edges) and padded with NaN;
    left edges are in the period. The last four are scalars.
    """

    compliance: Array
    resistance: Array
    compliance_error: Array | None = None
    resistance_error: Array | None = None
    indentation: Array | None = None
    contact_fraction: Array | None = None
    contact_fraction_error: Array | None = None
    elastic_energy: Array | None = None
    patch_count: Array | Indices | None = None
    residual: Array | None = None
    work: Array | Indices | None = None
    contact_edge: Array | None = None
    points: int | None = None
    second_attempts: int | None = None
    chosen_method: str | None = None
    chosen_terms: float | None = None

    def values(self) -> dict[str, Any]:
        """Return the quantities that the method has, by name."""
        return {name: value for name, value in vars(self).items() if value is not None}


def joined(parts: Sequence[tuple[Array, Curve]]) -> tuple[Array, Curve]:
    """Return the increasing loads of curves by one method under different loads, and their curve, without edges."""
    loads = np.concatenate([own for own, _ in parts])
    order, known = loads.argsort(), [curve.values() for _, curve in parts]
    found: dict[str, Any] = {}
    for name in dict.fromkeys(name for values in known for name in values):
        given = [values.get(name, np.nan) for values in known]
        if max(map(np.ndim, given)) == 1:
            each = [np.broadcast_to(value, own.shape) for value, (own, _) in zip(given, parts, strict=True)]
            found[name] = np.concatenate(each)[order]
        elif name == "second_attempts":
            found[name] = sum(given)
        elif max(map(np.ndim, given)) == 0:
            found[name] = given[-1]
    return loads[order], Curve(**found)
