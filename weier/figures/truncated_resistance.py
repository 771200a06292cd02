"""Fig. 8: the effect of additional terms on the contact resistance, with the bounds on the infinite series."""

from __future__ import annotations

from collections.abc import Sequence

import xarray as xr
from matplotlib.figure import Figure

from weier.data import curves
from weier.figures import style, truncation
from weier.figures.tables import extent, values_of


def draw(studies: Sequence[xr.Dataset], title: str) -> Figure:
    """Draw resistance over mean pressure for each number of terms, with the bounds as a band."""
    figure, panels = truncation.compare(studies, title, "resistance")
    for axes, cases in panels:
        drawn = curves.as_study(cases[-1]).sel(solution_method=[curves.numerical_method(cases[-1])])
        style.set_logarithmic_axes(axes, *extent(values_of([drawn], "resistance")))
        axes.legend(loc="lower left")
    return figure
