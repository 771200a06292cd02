"""Fig. 7: the effect of additional terms on the compliance, with the bounds on the infinite series."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from weier.data import curves
from weier.figures import truncation

# The datum is that of the infinite series, unlike in Fig. 3, where it is that of the m waves.
LABEL = "compliance $(h+G_m)/g_0$,\nfrom the infinite series"
# The inset is at this part of the range of loads, where the curves are steep and far from full contact.
ZOOM = 0.03, 0.05  # Half the width and height of the region shown, over the ranges of loads and values.


def draw(studies: Sequence[xr.Dataset], title: str) -> Figure:
    """Draw compliance over mean pressure for each number of terms, all counted from the infinite series.

    Notes
    -----
    (27) bounds the mean gap d, so that curves of different m are compared as G - d with the same G, the amplitude of
    all terms, not at their own full contact nor at first contact.
    """
    figure, panels = truncation.compare(studies, title, "compliance")
    for axes, cases in panels:
        axes.set_ylabel(LABEL)
        axes.set_xlim(0, curves.full_contact_load(cases))
        axes.set_ylim(bottom=0)
        axes.legend(loc="lower right")
        _draw_zoom(axes, cases)
    return figure


def _draw_zoom(axes: Axes, cases: Sequence[xr.Dataset]) -> None:
    """Draw an inset that separates the bounds from the curve, which are too close on the whole axes."""
    longest = cases[-1]
    if (h := curves.numerical(longest, "compliance")) is None:
        return
    load = 0.15 * axes.get_xlim()[1]
    value = np.interp(load, longest["mean_pressure"].values, h + truncation.datum(longest, "compliance"))
    across, up = ZOOM[0] * axes.get_xlim()[1], ZOOM[1] * np.ptp(axes.get_ylim())
    place = 0.5, 0.51, 0.42, 0.31  # left, bottom, width and height: between the curves and the legend
    inset = axes.inset_axes(place, xlim=(load - across, load + across), ylim=(value - up, value + up))
    truncation.draw_curves(inset, cases, "compliance")
    inset.set(xticks=[], yticks=[])
    axes.indicate_inset_zoom(inset, edgecolor="0.4")
