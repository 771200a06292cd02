"""Fig. 8: what additional terms change in the contact resistance, with the bounds on the endless series."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from weier.figures import style, truncation


def draw(studies: Sequence[xr.Dataset], title: str) -> Figure:
    """Resistance over mean pressure for each number of terms, with the bounds as solid lines.

    Raises
    ------
    ValueError
        If no case of the studies has a numerical solution.

    """
    figure, panels = truncation.compare(studies, title, "resistance", _as_it_is)
    for axes, cases in panels:
        style.logarithmic(axes, cases[-1:], "resistance")
        axes.set_ylabel(style.LABELS["resistance"])
        axes.legend(loc="lower left")
    return figure


def _as_it_is(resistance: np.ndarray, total_amplitude: float) -> np.ndarray:
    return resistance
