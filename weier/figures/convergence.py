"""The infinite series: best estimates and bounds for increasing numbers of resolved terms."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from weier.accuracy.metrics import by_resolved_terms
from weier.data import curves
from weier.figures import lines, style
from weier.figures.values import band, line
from weier.surface.profile import PARAMETERS

HEIGHT = 2.1  # height of a panel (inches)
# The bounds for these numbers of resolved terms are drawn, from light to dark, and those for the largest number.
BANDS = (1, 2, 4)


def draw(studies: Sequence[xr.Dataset], title: str) -> Figure:
    """Draw the best estimate within bounds, a panel per case, and the convergence of all cases in one more."""
    found = [case for case in curves.cases(studies) if _rows_of_estimates(case).size > 1]
    title, cases = style.limit_panels(title, found, "cases with several estimates")
    names = [*(style.describe(case, *PARAMETERS) for case in cases), "largest over the loads"]
    figure, axes = style.column(title, names, HEIGHT)
    figure.set_figheight(figure.get_figheight() + style.LEGEND_ROW * len(cases))
    colors = style.BLACK, style.VERMILLION, style.BLUE, style.GREEN
    for panel, case, color in zip(axes, cases, colors, strict=False):
        _draw_bounds(panel, case)
        _draw_convergence(axes[-1], case, color)
    axes[-1].xaxis.set_major_locator(MaxNLocator(integer=True))
    axes[-1].set(yscale="log", xlabel="resolved terms $k$", ylabel=r"error of $h/g_0$")
    figure.legend(*axes[-1].get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return figure


def _rows_of_estimates(case: xr.Dataset) -> np.ndarray:
    """Return rows that have an estimate."""
    return np.flatnonzero(np.isfinite(case["compliance"].values).all(axis=1))


def _draw_bounds(axes: Axes, case: xr.Dataset) -> None:
    """Draw the best estimate as a line within the bounds, narrow bands over wide ones."""
    loads, h, terms = (case[name].values for name in ("mean_pressure", "compliance", "resolved_terms"))
    low, high = (case[f"compliance_{side}"].values for side in ("lower", "upper"))
    last = _rows_of_estimates(case)[-1]
    fine, best = lines.compliance_line(loads, h[last], case["resistance"].values[last])
    rows = [*(row for row in _rows_of_estimates(case)[:-1] if terms[row] in BANDS), last]
    for row, grey in zip(rows, np.linspace(0.92, 0.45, len(rows)), strict=True):
        lower, upper = (best + np.interp(fine, loads, side[row] - h[last]) for side in (low, high))
        upper = np.minimum(upper, float(case["total_amplitude"]))  # The compliance at full contact is an upper bound.
        look: dict[str, Any] = {"facecolor": str(grey), "edgecolor": "0.35", "linewidth": 0.3}
        band(axes, f"bounds, $k={terms[row]}$", fine, lower, upper, **look)
    line(axes, f"estimate, $k={terms[last]}$", fine, best, color=style.BLACK, linewidth=1)
    axes.set(xscale="log", xlabel=style.LABELS["mean_pressure"], ylabel=style.LABELS["compliance"])
    axes.set_xlim(loads[0], loads[-1])
    axes.legend(loc="lower right", fontsize=7)


def _draw_convergence(axes: Axes, case: xr.Dataset, color: str) -> None:
    """Draw the half-width of the bounds, and the distance of estimates from the last one."""
    name, terms = style.describe(case, "gamma"), case["resolved_terms"].values
    width, error = by_resolved_terms(case)
    bounded, compared = np.isfinite(width), np.isfinite(error)
    line(axes, f"{name}: half-width of bounds", terms[bounded], width[bounded], color=color, marker="s")
    look: dict[str, Any] = {"color": color, "marker": "o", "markerfacecolor": "white", "linestyle": style.DASHES[1]}
    line(axes, f"{name}: error of estimate", terms[compared], error[compared], **look)
