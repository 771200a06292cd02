"""Figs 5 and 6: the estimates of contact resistance against the numerical curve."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import xarray as xr
from matplotlib.figure import Figure

from weier.figures import style
from weier.figures.comparison import compare


def draw(studies: Sequence[xr.Dataset], title: str, **options: Any) -> Figure:
    """Draw resistance over mean pressure by every method, on logarithmic axes."""
    figure, panels, extent = compare(studies, title, "resistance", **options)
    style.set_logarithmic_axes(panels[0], *extent)
    return figure
