"""The endless series: best estimates with ever more terms resolved, and the bounds that hold whatever follows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from weier.figures import style
from weier.pipeline import curves

CAPTION = (
    "The infinite series: estimates with more and more terms resolved lie within the bounds, which hold whatever the "
    "remaining terms are. Estimates and bounds close in as terms are resolved."
)
COMMAND = "endless"
VARIABLE = "points"

SHOWN = (1, 2, 4)  # resolved terms, beside the most there are


def draw(studies: Sequence[xr.Dataset], title: str) -> Figure:
    """Two panels a case: estimates within the best bounds, and how both close in as terms are resolved.

    Raises
    ------
    ValueError
        If fewer than two numbers of terms were resolved.

    """
    cases = [case for case in curves.cases(studies) if _estimated(case).size > 1]
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


def _estimated(case: xr.Dataset) -> np.ndarray:
    """Rows that have an estimate."""
    return np.flatnonzero(np.isfinite(case["compliance"].values).all(axis=1))


def _curves(axes: Axes, case: xr.Dataset) -> None:
    loads, h, most = case["mean_pressure"].values, case["compliance"].values, int(_estimated(case)[-1]) + 1
    low, high = (case[f"compliance_{side}"].values for side in ("lower", "upper"))
    axes.fill_between(loads, np.fmax.reduce(low), np.fmin.reduce(high), label="bounds", **style.BOUND)
    counts = [*(count for count in SHOWN if count < most), most]
    for look, count in zip(style.family(len(counts)), counts, strict=True):
        axes.plot(loads, h[count - 1], label=f"{count} resolved", **look)
    axes.set(xscale="log", xlabel=style.LABELS["mean_pressure"], ylabel=style.LABELS["compliance"])
    axes.legend(loc="upper left")


def _convergence(axes: Axes, case: xr.Dataset) -> None:
    """Half the width of the bounds, and how far the estimates are from the last, or from bounds that go further."""
    h, estimated = case["compliance"].values, _estimated(case)
    low, high = (case[f"compliance_{side}"].values for side in ("lower", "upper"))
    bounded = np.flatnonzero(np.isfinite(low).all(axis=1))
    width = (high - low)[bounded].max(axis=1) / 2
    axes.plot(bounded + 1, width, label="rigorous: half of the bounds", color=style.BLACK, marker="s")
    if bounded[-1] > estimated[-1]:
        shown, best, what = estimated, (low + high)[bounded[-1]] / 2, f"bounds by {bounded[-1] + 1}"
    else:
        shown, best, what = estimated[:-1], h[estimated[-1]], f"{estimated[-1] + 1} resolved"
    off = np.abs(h[shown] - best).max(axis=1)
    label = f"estimate: distance from {what}"
    axes.plot(shown + 1, off, label=label, color=style.GREEN, marker="o", linestyle=style.DASHES[1])
    room = min(off.min(), width.min()) / 10  # below the curves, for the legend
    axes.set(yscale="log", ylim=(room, None), xlabel="resolved terms $k$", ylabel=r"error of $h/g_0$")
    axes.legend(loc="lower left")
