"""Errors of the resistance of boundary elements, from the active set and from differences of the compliance."""

from __future__ import annotations

import numpy as np

from tests.reference import REFERENCES
from weier import Profile
from weier.accuracy.measurement import measurement
from weier.accuracy.runner import Variant, run
from weier.data import markdown
from weier.kernels.arrays import Array

POINTS = {"points_per_wave": 64}
KEPT, DEFAULT = Variant("bem", {**POINTS, "staircase": "kept"}), Variant("bem", POINTS)
FACTORS = (0.01, 0.03, 0.1, 0.2)  # ln of the ratio of a load to its neighbour
LIGHTEST = 1e-3  # p_0*
HEADER = ("scheme", "median", "90 %", "largest")


def differences(profile: Profile, p: Array, factor: float) -> Array:
    """Return centred differences of the discrete compliance between p exp(-factor) and p exp(factor)."""
    low, high = (p * np.exp(sign * factor) for sign in (-1, 1))
    below, above = (run(KEPT, profile, loads).values[0] for loads in (low, high))
    return np.asarray((above - below) / (high - low))


def errors() -> dict[str, Array]:
    """Return the relative errors of R of each scheme at all reference values in partial contact."""
    found: dict[str, list[Array]] = {}
    for known in (own.above(LIGHTEST * (1 - 1e-9)) for own in REFERENCES):
        partial = known.resistance > 0
        p, right = known.mean_pressure[partial], known.resistance[partial]
        schemes = {"active set": run(KEPT, known.profile, p).values[1]}
        schemes |= {f"differences, exp({factor:g})": differences(known.profile, p, factor) for factor in FACTORS}
        schemes["active set, staircase removed (default)"] = run(DEFAULT, known.profile, p).values[1]
        for name, R in schemes.items():
            found.setdefault(name, []).append(np.abs(R / right - 1))
    return {name: np.concatenate(own) for name, own in found.items()}


@measurement("The resistance of a grid")
def main() -> list[str]:
    """Compare two ways to find the resistance on a grid with 64 points for each of the finest waves.

    Errors are relative to the reference values of partial contact from 1e-3 p_0* (`tests/data/contact.csv`).
    """
    rows = [[name, *(f"{part(own):.2%}" for part in (np.median, _high, np.max))] for name, own in errors().items()]
    return [markdown.table(HEADER, rows)]


def _high(values: Array) -> float:
    return float(np.quantile(values, 0.9))
