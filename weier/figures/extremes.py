"""The extremes: digits against load by every method, and the condition of the boundary elements' equations."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from weier.figures import style
from weier.methods import registry
from weier.theory.profile import PARAMETERS

CAPTION = (
    "Correct digits of the compliance of one profile by every method, over all loads that a number can hold; and how "
    "the condition numbers of the boundary elements' equations grow with the number of nodes."
)
COMMAND = "extremes"
VARIABLE = "compliance_digits"

CONDITIONS = {
    "condition_operator": "influence matrix",
    "condition_full": "dense, full contact",
    "condition_half": "dense, half in contact",
}
POWERS = (-300, -30, -2, -1, 0, 1, 2, 30, 300)  # of ten, of the loads that the axis names
NEAR, SHARE_OF_NEAR = 2, 1.6  # powers of ten that are spread evenly, and their space in decades of larger powers
OTHER_ALGORITHM = style.PURPLE  # than the default of a method


def draw(studies: Sequence[xr.Dataset], title: str) -> Figure:
    """Correct digits of h over all loads there are, and condition numbers against the number of nodes."""
    (data,) = studies
    if not np.isfinite(data["compliance_digits"]).any():
        raise ValueError("there are no digits to draw in these data")
    case = data.isel(case=_widest(data))
    figure, (digits, conditions) = style.column(title, [style.describe(case, *PARAMETERS), "boundary elements"])
    _digits(digits, case)
    _conditions(conditions, data)
    return figure


def _widest(data: xr.Dataset) -> int:
    """The case with the most methods times decades of load at which digits are known; of several waves if it can."""
    known, decade = np.isfinite(data["compliance_digits"].values), np.log10(data["mean_pressure"].values)
    loads = known.any(axis=1)
    span = np.where(loads, decade, -np.inf).max(axis=1) - np.where(loads, decade, np.inf).min(axis=1)
    size = known.any(axis=2).sum(axis=1) * np.maximum(span, 0)
    return int(np.argmax(np.where(data["m"].values > 1, size + size.max(), size)))


def _digits(axes: Axes, case: xr.Dataset) -> None:
    for variant, row in zip(case["variant"].values.tolist(), case["compliance_digits"].values, strict=True):
        known = np.isfinite(row)
        if known.any():
            look = _look(variant, case["solution_method"].sel(variant=variant).item())
            axes.plot(np.log10(case["mean_pressure"].values[known]), row[known], **look)
    # Powers of ten are the axis: a logarithmic one overflows where it adds a margin to 1e300, and would put all that
    # happens into one place. So the powers are spread, those up to NEAR evenly, and others the less the larger.
    axes.set_xscale("symlog", linthresh=NEAR, linscale=SHARE_OF_NEAR)
    axes.set_xticks(POWERS, labels=[f"$10^{{{power}}}$" for power in POWERS], minor=False)
    axes.minorticks_off()
    axes.set(xlabel=style.LABELS["mean_pressure"], ylabel=r"correct digits of $h$")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.22), ncols=2, fontsize=7)


def _look(variant: str, name: str) -> dict[str, Any]:
    """The line of a method, with markers on the most accurate one, which elsewhere coincides with the other one."""
    look = style.line(name)
    if name == registry.numerical_names()[0]:
        look |= {"marker": "o", "markersize": 2}
    if variant != name:
        look |= {"label": f"{look['label']},{variant.removeprefix(name)}", "color": OTHER_ALGORITHM}
    return look


def _conditions(axes: Axes, data: xr.Dataset) -> None:
    colors = style.BLACK, style.BLUE, style.VERMILLION
    for (name, label), color, dashes in zip(CONDITIONS.items(), colors, style.DASHES, strict=False):
        axes.plot(data["nodes"].values, data[name].values, label=label, color=color, linestyle=dashes)
    axes.set(xscale="log", yscale="log", xlabel="nodes $N$", ylabel="condition number")
    axes.legend(loc="lower right")
