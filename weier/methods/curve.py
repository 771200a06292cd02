"""The common result type of all methods."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

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
