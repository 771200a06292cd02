"""The extremes: digits against load by every method, and the condition of the boundary elements' equations."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from weier.figures import style

CONDITIONS = {
    "condition_operator": "influence matrix",
    "condition_full": "dense, full contact",
    "condition_half": "dense, half in contact",
}


def draw(studies: Sequence[xr.Dataset], title: str) -> Figure:
    """Correct digits of h over all loads there are, and condition numbers against the number of nodes.

    Raises
    ------
    ValueError
        If there are no digits to draw.

    """
    (data,) = studies
    if not np.isfinite(data["compliance_digits"]).any():
        raise ValueError("there are no digits to draw in these data")
    case = data.isel(case=_widest(data))
    figure, axes = style.column(2)
    _digits(axes[0], case)
    _conditions(axes[1], data)
    style.name_panel(axes[0], 0, 2, style.describe(case, "D", "gamma", "m"))
    style.name_panel(axes[1], 1, 2, "boundary elements")
    style.set_title(figure, title)
    return figure


def _widest(data: xr.Dataset) -> int:
    """The case whose digits are known by the most methods at the most loads, of several waves."""
    known = np.isfinite(data["compliance_digits"].values)
    counted = known.any(axis=2).sum(axis=1) * known.any(axis=1).sum(axis=1) * np.where(data["m"].values > 1, 2, 1)
    return int(np.argmax(counted))


def _digits(axes: Axes, case: xr.Dataset) -> None:
    for method, row in zip(case["method"].values.tolist(), case["compliance_digits"].values, strict=True):
        known = np.isfinite(row)
        if known.any():
            axes.plot(case["mean_pressure"].values[known], row[known], **style.line(method))
    axes.set(xscale="log", xlabel=style.LABELS["mean_pressure"], ylabel=r"correct digits of $h$")
    axes.legend(loc="center left", fontsize=7)


def _conditions(axes: Axes, data: xr.Dataset) -> None:
    for number, (name, label) in enumerate(CONDITIONS.items()):
        look: dict[str, Any] = {
            "linestyle": style.DASHES[number],
            "color": (style.BLACK, style.BLUE, style.VERMILLION)[number],
        }
        axes.plot(data["nodes"].values, data[name].values, label=label, **look)
    axes.set(xscale="log", yscale="log", xlabel="nodes $N$", ylabel="condition number")
    axes.legend(loc="upper left")
