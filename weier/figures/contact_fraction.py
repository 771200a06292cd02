"""The contact fraction by every method that has one: numerical methods, and the theories of 2000 and of Persson."""

from __future__ import annotations

from collections.abc import Sequence

import xarray as xr
from matplotlib.figure import Figure

from weier.data.bodies import Bodies
from weier.figures import style
from weier.figures.comparison import compare
from weier.scene import BY_DEFAULT, Grouping

CAPTION = "Contact fraction, the contact area over the nominal area, over mean pressure. {methods}"


def draw(
    studies: Sequence[xr.Dataset],
    title: str,
    grouping: Grouping = BY_DEFAULT,
    interface: Bodies | None = None,
    behind: Sequence[xr.Dataset] = (),
) -> Figure:
    """Draw contact fraction over mean pressure, on logarithmic axes."""
    figure, panels, extent = compare(studies, title, "contact_fraction", grouping, interface, behind)
    style.set_logarithmic_axes(panels[0], *extent)
    return figure
