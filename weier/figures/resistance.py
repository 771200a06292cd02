"""Figs 5 and 6: the estimates of contact resistance against the numerical curve."""

from __future__ import annotations

from collections.abc import Sequence

import xarray as xr
from matplotlib.figure import Figure

from weier.data.bodies import Bodies
from weier.figures import style
from weier.figures.comparison import compare
from weier.scene import BY_DEFAULT, Grouping

CAPTION = (
    "Contact resistance over mean pressure. {methods} The exact curve drops steeply at the birth of a contact and "
    "has a kink where two merge."
)


def draw(
    studies: Sequence[xr.Dataset],
    title: str,
    grouping: Grouping = BY_DEFAULT,
    interface: Bodies | None = None,
    behind: Sequence[xr.Dataset] = (),
) -> Figure:
    """Draw resistance over mean pressure by every method, on logarithmic axes."""
    figure, panels, extent = compare(studies, title, "resistance", grouping, interface, behind)
    style.set_logarithmic_axes(panels[0], *extent)
    return figure
