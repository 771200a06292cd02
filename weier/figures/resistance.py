"""Figs 5 and 6: the estimates of contact resistance against the numerical curve."""

from __future__ import annotations

from collections.abc import Sequence

import xarray as xr
from matplotlib.figure import Figure

from weier.figures import style
from weier.figures.methods import compare


def draw(studies: Sequence[xr.Dataset], title: str) -> Figure:
    """Resistance over mean pressure by every method, on logarithmic axes: equal ratios are equal distances.

    Raises
    ------
    ValueError
        If no case of the studies has a curve.

    """
    figure, panels = compare(studies, title, "resistance")
    for axes, cases in panels:
        style.logarithmic(axes, cases, "resistance")
        axes.legend(loc="lower left")
    return figure
