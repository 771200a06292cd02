"""Speed against accuracy: what each method and setting costs, how far it is off, and which are worth it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from weier.accuracy.metrics import pareto, seconds_per_load, typical, worst_over_loads
from weier.figures import style
from weier.methods import registry

CAPTION = (
    "Seconds for one load against the largest error over the loads. A dot is one profile, a marker the median of a "
    "method at one setting, and the band joins those that no other beats in both."
)
COMMAND = "tradeoff"
VARIABLE = "reference_resistance"

FLOOR = 1e-15  # an error of 0 is drawn here
LABELS = {
    "compliance": r"largest error of $h/g_0$",
    "resistance": r"largest error of $R$, in max$(R,\,g_0/p_0^{*})$",
}
PROFILES: dict[str, Any] = {"marker": ".", "markersize": 1.5, "linestyle": "none", "alpha": 0.6}
FRONT: dict[str, Any] = {"color": "0.8", "linewidth": 5, "solid_capstyle": "round", "zorder": 1}


def draw(studies: Sequence[xr.Dataset], title: str) -> Figure:
    """Seconds a load against the largest error over the loads: a dot a profile, a marker their median."""
    (data,) = studies
    cost = seconds_per_load(data)
    if not np.isfinite(cost).any():
        raise ValueError("there are no times to draw in these data")
    figure, axes = style.column(title, list(LABELS), sharex=True)
    for panel, quantity in zip(axes, LABELS, strict=True):
        error = np.maximum(worst_over_loads(data, quantity), FLOOR)
        _panel(panel, data["solution_method"].values, 1e3 * cost, error)
        panel.set(xscale="log", yscale="log", ylabel=LABELS[quantity])
    axes[0].plot([], [], **PROFILES, color=style.GREY, label="one profile")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=2)
    axes[-1].set_xlabel("milliseconds a load, one core")
    return figure


def _panel(axes: Axes, methods: np.ndarray, cost: np.ndarray, error: np.ndarray) -> None:
    middle_cost, middle_error = typical(cost), typical(error)
    front = pareto(middle_cost, middle_error)
    axes.plot(middle_cost[front], middle_error[front], label="Pareto front", **FRONT)
    for method in registry.METHODS:
        members = np.flatnonzero(methods == method.name)
        if not members.size:
            continue
        look = style.line(method.name) | {"marker": method.style.marker, "linestyle": "none"}
        if method.name == registry.numerical_names()[0]:
            look["markerfacecolor"] = "white"
        axes.plot(cost[:, members], error[:, members], color=look["color"], **PROFILES)
        axes.plot(middle_cost[members], middle_error[members], **look)
