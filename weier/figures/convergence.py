"""The infinite series: best estimates with ever more terms resolved, and the bounds that hold whatever follows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from weier.figures import style
from weier.pipeline import curves

CAPTION = (
    "The infinite series: estimates with more and more terms resolved lie within the bounds, which hold whatever the "
    "remaining terms are. Estimates and bounds converge as terms are resolved."
)
COMMAND = "convergence"
VARIABLE = "resolved_terms"

COUNTS = (1, 2, 4)  # of resolved terms, beside the largest


def draw(studies: Sequence[xr.Dataset], title: str) -> Figure:
    """Two panels a case: estimates within the best bounds, and how both converge as terms are resolved."""
    cases = [case for case in curves.cases(studies) if _rows_of_estimates(case).size > 1]
    if not cases:
        raise ValueError("there are no estimates to compare in these data: resolve more terms")
    figure, axes = style.column(2 * len(cases))
    for number, case in enumerate(cases):
        _curves(axes[2 * number], case)
        _convergence(axes[2 * number + 1], case)
        style.name_panel(axes[2 * number], 2 * number, len(axes), style.describe(case, "D", "gamma", "m"))
        style.name_panel(axes[2 * number + 1], 2 * number + 1, len(axes), "largest over the loads")
    style.set_title(figure, title)
    return figure


def _rows_of_estimates(case: xr.Dataset) -> np.ndarray:
    """Rows that have an estimate."""
    return np.flatnonzero(np.isfinite(case["compliance"].values).all(axis=1))


def _curves(axes: Axes, case: xr.Dataset) -> None:
    loads, h, terms = (case[name].values for name in ("mean_pressure", "compliance", "resolved_terms"))
    low, high = (case[f"compliance_{side}"].values for side in ("lower", "upper"))
    axes.fill_between(loads, np.fmax.reduce(low), np.fmin.reduce(high), label="bounds", **style.BOUND)
    last = _rows_of_estimates(case)[-1]
    rows = [*(row for row in range(last) if terms[row] in COUNTS), last]
    for look, row in zip(style.family(len(rows)), rows, strict=True):
        axes.plot(loads, h[row], label=f"{terms[row]} resolved", **look)
    axes.set(xscale="log", xlabel=style.LABELS["mean_pressure"], ylabel=style.LABELS["compliance"])
    axes.legend(loc="upper left")


def _convergence(axes: Axes, case: xr.Dataset) -> None:
    """Half the width of the bounds, and how far the estimates are from the last, or from bounds that go further."""
    h, terms, estimated = case["compliance"].values, case["resolved_terms"].values, _rows_of_estimates(case)
    low, high = (case[f"compliance_{side}"].values for side in ("lower", "upper"))
    bounded = np.flatnonzero(np.isfinite(low).all(axis=1))
    width = (high - low)[bounded].max(axis=1) / 2
    axes.plot(terms[bounded], width, label="rigorous: half-width of the bounds", color=style.BLACK, marker="s")
    if bounded[-1] > estimated[-1]:
        compared, best, name = estimated, (low + high)[bounded[-1]] / 2, f"bounds by {terms[bounded[-1]]}"
    else:
        compared, best, name = estimated[:-1], h[estimated[-1]], f"{terms[estimated[-1]]} resolved"
    deviation = np.abs(h[compared] - best).max(axis=1)
    label = f"estimate: distance from {name}"
    axes.plot(terms[compared], deviation, label=label, color=style.GREEN, marker="o", linestyle=style.DASHES[1])
    floor = min(deviation.min(), width.min()) / 10  # leaves space for the legend
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set(yscale="log", ylim=(floor, None), xlabel="resolved terms $k$", ylabel=r"error of $h/g_0$")
    axes.legend(loc="lower left")
