"""The endless series: best estimates with ever more terms resolved, and the bounds that hold whatever follows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from weier.figures import style

SHOWN = (1, 2, 4)  # resolved terms, beside the most there are


def draw(studies: Sequence[xr.Dataset], title: str) -> Figure:
    """Estimates within the bounds of the last, and how both close in as terms are resolved.

    Raises
    ------
    ValueError
        If fewer than two numbers of terms were resolved.

    """
    (case,) = (study.isel(case=0) for study in studies)
    if case.sizes["method"] < 2:
        raise ValueError(f"there are no estimates to compare, only {case.sizes['method']}: resolve more terms")
    figure, axes = style.column(2)
    _curves(axes[0], case)
    _convergence(axes[1], case)
    style.name_panel(axes[0], 0, 2, style.describe(case, "D", "gamma", "m"))
    style.name_panel(axes[1], 1, 2, "largest over the loads")
    style.set_title(figure, title)
    return figure


def _curves(axes: Axes, case: xr.Dataset) -> None:
    loads, h, most = case["mean_pressure"].values, case["compliance"].values, case.sizes["method"]
    low, high = (case[f"compliance_{side}"].values for side in ("lower", "upper"))
    axes.fill_between(loads, low.max(axis=0), high.min(axis=0), label="bounds", **style.BOUND)
    counts = [*(count for count in SHOWN if count < most), most]
    for look, count in zip(style.family(len(counts)), counts, strict=True):
        axes.plot(loads, h[count - 1], label=f"{count} resolved", **look)
    axes.set(xscale="log", xlabel=style.LABELS["mean_pressure"], ylabel=style.LABELS["compliance"])
    axes.legend(loc="upper left")


def _convergence(axes: Axes, case: xr.Dataset) -> None:
    h, counts = case["compliance"].values, np.arange(1, case.sizes["method"] + 1)
    width = (case["compliance_upper"].values - case["compliance_lower"].values).max(axis=1) / 2
    off = np.abs(h[:-1] - h[-1]).max(axis=1)
    axes.plot(counts, width, label=r"rigorous: half of the bounds, $G_k$", color=style.BLACK, marker="s")
    label = f"estimate: distance from {counts[-1]} resolved"
    axes.plot(counts[:-1], off, label=label, color=style.GREEN, marker="o", linestyle=style.DASHES[1])
    room = off.min() / 10  # below the curves, for the legend
    axes.set(yscale="log", ylim=(room, None), xlabel="resolved terms $k$", ylabel=r"error of $h/g_0$")
    axes.legend(loc="lower left")
