"""The contact fraction by every method that has one: numerical methods, and the theories of 2000 and of Persson."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import xarray as xr
from matplotlib.figure import Figure

from weier.figures import style
from weier.figures.comparison import compare


def draw(studies: Sequence[xr.Dataset], title: str, **options: Any) -> Figure:
    """Draw contact fraction over mean pressure, on logarithmic axes."""
    figure, panels, extent = compare(studies, title, "contact_fraction", **options)
    style.set_logarithmic_axes(panels[0], *extent)
    return figure
