"""The extremes: correct digits against load by every method."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from weier.figures import style
from weier.figures.values import line
from weier.methods import registry
from weier.surface.profile import PARAMETERS

POWERS = (-300, -30, -2, -1, 0, 1, 2, 30, 300)  # powers of ten labelled on the load axis
# The axis is linear in the power up to NEAR, with LINEAR_SCALE times the length of a later decade, then logarithmic.
NEAR, LINEAR_SCALE = 2, 1.6


def draw(studies: Sequence[xr.Dataset], title: str) -> Figure:
    """Draw correct digits of h over all loads."""
    (data,) = studies
    if not np.isfinite(data["compliance_digits"]).any():
        raise ValueError("there are no digits to draw in these data")
    case = data.isel(case=_widest(data))
    figure, (axes,) = style.column(title, [style.describe(case, *PARAMETERS)])
    _digits(axes, case)
    return figure


def _widest(data: xr.Dataset) -> int:
    """Return the case with the most methods times decades of known digits, preferably of several waves."""
    known, decade = np.isfinite(data["compliance_digits"].values), np.log10(data["mean_pressure"].values)
    loads = known.any(axis=1)
    span = np.where(loads, decade, -np.inf).max(axis=1) - np.where(loads, decade, np.inf).min(axis=1)
    size = known.any(axis=2).sum(axis=1) * np.maximum(span, 0)
    return int(np.argmax(np.where(data["m"].values > 1, size + size.max(), size)))


def _digits(axes: Axes, case: xr.Dataset) -> None:
    for name, row in zip(case["solution_method"].values.tolist(), case["compliance_digits"].values, strict=True):
        known = np.isfinite(row)
        if known.any():
            # Markers on the most accurate method separate coinciding lines.
            marker = {"marker": "o", "markersize": 2} if name == registry.numerical_names()[0] else {}
            look = style.line(name) | marker
            line(axes, look["label"], np.log10(case["mean_pressure"].values[known]), row[known], **look)
    # The axis is the power of ten: the margin of a logarithmic axis would overflow at 1e300, and most changes would
    # be at one place. The powers up to NEAR are spaced evenly, and larger ones logarithmically.
    axes.set_xscale("symlog", linthresh=NEAR, linscale=LINEAR_SCALE)
    axes.set_xticks(POWERS, labels=[f"$10^{{{power}}}$" for power in POWERS], minor=False)
    axes.minorticks_off()
    axes.set(xlabel=style.LABELS["mean_pressure"], ylabel=r"correct digits of $h$")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.22), ncols=2, fontsize=7)
