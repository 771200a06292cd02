"""Figs 5 and 6: the estimates of contact resistance against the numerical curve."""

from __future__ import annotations

from collections.abc import Sequence

import xarray as xr
from matplotlib.figure import Figure

from weier.figures import style
from weier.figures.comparison import compare
from weier.scene import BY_DEFAULT, Grouping

CAPTION = (
    "Contact resistance over mean pressure. {methods} The exact curve has a kink at each load at which contacts are "
    "born or merge."
)


def draw(studies: Sequence[xr.Dataset], title: str, grouping: Grouping = BY_DEFAULT) -> Figure:
    """Resistance over mean pressure by every method, on logarithmic axes, where equal ratios are equal distances."""
    figure, panels = compare(studies, title, "resistance", grouping)
    for axes, cases in panels:
        style.set_logarithmic_axes(axes, cases, "resistance")
        if grouping == BY_DEFAULT:
            axes.legend(loc="lower left")
    return figure
