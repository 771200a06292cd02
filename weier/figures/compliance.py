"""Figs 3 and 4: the estimates of compliance against the numerical curve. All curves meet at full contact."""

from __future__ import annotations

from collections.abc import Sequence

import xarray as xr
from matplotlib.figure import Figure

from weier.data.bodies import Bodies
from weier.figures import style
from weier.figures.comparison import compare
from weier.scene import BY_DEFAULT, Grouping

CAPTION = (
    "Compliance over mean pressure. {methods} All curves of one profile meet at full contact, where the compliance "
    "is the sum of the amplitudes of its waves, or the height of a trace."
)


def draw(
    studies: Sequence[xr.Dataset],
    title: str,
    grouping: Grouping = BY_DEFAULT,
    interface: Bodies | None = None,
    behind: Sequence[xr.Dataset] = (),
) -> Figure:
    """Draw compliance over mean pressure by every method, up to full contact, on an axis that shows light loads."""
    figure, panels, extent = compare(studies, title, "compliance", grouping, interface, behind)
    style.set_load_axis(panels[0], extent.first_load, extent.full_contact)
    panels[0].set_ylim(bottom=0)
    return figure
