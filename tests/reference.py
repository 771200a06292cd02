"""The reference values: contact solved to ten digits by another program, never by weier itself."""

from __future__ import annotations

import json
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier import Profile

DATA = Path(__file__).parent / "data" / "contact.json"


class Reference(NamedTuple):
    """One profile with its curves, each of shape (loads,): compliance and contact fraction hold ten digits."""

    profile: Profile
    mean_pressure: NDArray[np.float64]
    compliance: NDArray[np.float64]
    resistance: NDArray[np.float64]
    contact_fraction: NDArray[np.float64]
    patches: NDArray[np.int64]

    def above(self, load: float) -> Reference:
        """The rows with at least this load."""
        rows = self.mean_pressure >= load
        return Reference(self.profile, *(column[rows] for column in self[1:]))

    def __str__(self) -> str:
        phases = ",".join(f"{phase:.3g}" for phase in self.profile.phase)
        return f"D{self.profile.D}-gamma{self.profile.gamma}-phases{phases}"


def _reference(entry: dict) -> Reference:
    profile = Profile(entry["D"], entry["gamma"], entry["m"], entry["phases"])
    names = ("mean_pressure", "compliance", "resistance", "contact_fraction", "patches")
    return Reference(profile, *(np.array([row[name] for row in entry["rows"]]) for name in names))


REFERENCES = [_reference(entry) for entry in json.loads(DATA.read_text())]
