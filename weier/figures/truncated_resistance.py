"""Fig. 8: the effect of additional terms on the contact resistance, with the bounds on the infinite series."""

from __future__ import annotations

from collections.abc import Sequence

import xarray as xr
from matplotlib.figure import Figure

from weier.figures import style, truncation

CAPTION = (
    "The effect of additional terms on the contact resistance. The band contains the infinite series for all phases "
    "of its further terms."
)


def draw(studies: Sequence[xr.Dataset], title: str) -> Figure:
    """Resistance over mean pressure for each number of terms, with the bounds as a band."""
    figure, panels = truncation.compare(studies, title, "resistance")
    for axes, cases in panels:
        style.set_logarithmic_axes(axes, cases[-1:], "resistance")
        axes.legend(loc="lower left")
    return figure
