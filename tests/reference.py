"""The reference values: contact solved to ten digits by another program, never by weier itself."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from weier import Profile

DATA = Path(__file__).parent / "data" / "contact.csv"


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


def _reference(rows: pd.DataFrame) -> Reference:
    D, gamma, phases = rows.iloc[0, :3]
    listed = [float(phase) for phase in phases.split()]
    return Reference(Profile(D, gamma, len(listed), listed), *(rows[name].to_numpy() for name in rows.columns[3:]))


TABLE = pd.read_csv(DATA, dtype={"gamma": str, "phases": str})
REFERENCES = [_reference(rows) for _, rows in TABLE.groupby(["D", "gamma", "phases"], sort=False)]
