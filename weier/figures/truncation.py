"""Series truncated after m terms, and what their tails could change: what Figs 7 and 8 share."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from weier.figures import lines, style
from weier.pipeline import curves

# From the values of a series, its total amplitude and that of the infinite series to values of one datum for all.
Datum = Callable[[np.ndarray, float, float], np.ndarray]


def compare(
    studies: Sequence[xr.Dataset], title: str, quantity: str, datum: Datum
) -> tuple[Figure, list[tuple[Axes, list[xr.Dataset]]]]:
    """The numerical curves of all m with the bounds from the longest series, one panel for each D and gamma.

    Returns
    -------
    figure : Figure
    panels : list of (Axes, cases)
        Limits, labels and the legend are left to the caller; the cases are in order of m.

    """
    solved = [case for case in curves.cases(studies) if curves.numerical_method(case)]
    title, series = style.limit_panels(title, curves.groups(solved, "D", "gamma"), "series")
    figure, axes = style.column(len(series))
    ordered = [sorted(cases, key=lambda case: float(case["m"])) for cases in series]
    for number, (panel, cases) in enumerate(zip(axes, ordered, strict=True)):
        draw_curves(panel, cases, quantity, datum)
        style.name_panel(panel, number, len(series), style.describe(cases[-1], "D", "gamma"))
    axes[-1].set_xlabel(style.LABELS["mean_pressure"])
    style.set_title(figure, title)
    return figure, list(zip(axes, ordered, strict=True))


def draw_curves(axes: Axes, cases: Sequence[xr.Dataset], quantity: str, datum: Datum) -> None:
    """The curves of one panel, in order of m, and the bounds below them."""
    _draw_bounds(axes, cases[-1], quantity, datum)
    by_terms = curves.groups(cases, "m")
    looks = style.family(len(by_terms))
    for look, same in zip(looks, by_terms, strict=True):
        thin = {"linewidth": 0.4, "alpha": style.FAINT_ALPHA} if len(same) > 1 else {}
        for number, case in enumerate(same):
            label = style.describe(case, "m") if number == 0 else None
            drawn = lines.line(case, quantity, curves.numerical_method(case))
            if drawn is not None:
                loads, values = drawn
                axes.plot(
                    loads,
                    datum(values, float(case["total_amplitude"]), infinite_amplitude(case)),
                    label=label,
                    **look | thin,
                )
    alone = [(same[0], look["color"]) for look, same in zip(looks, by_terms, strict=True) if len(same) == 1]
    checks = [(_less_accurate(case, quantity, datum), color) for case, color in alone]
    style.draw_sparse_points(axes, cases[0]["mean_pressure"].values, checks)


def _less_accurate(case: xr.Dataset, quantity: str, datum: Datum) -> dict[str, np.ndarray]:
    """The curves by numerical methods beside the most accurate one, by method."""
    total, infinite = float(case["total_amplitude"]), infinite_amplitude(case)
    return {method: datum(values, total, infinite) for method, values in curves.less_accurate(case, quantity).items()}


def numerical_or_nan(case: xr.Dataset, quantity: str) -> np.ndarray:
    """The numerical curve of a case, or NaN, which draws nothing, if it has none."""
    values = curves.numerical(case, quantity)
    return np.full(case.sizes["mean_pressure"], np.nan) if values is None else values


def infinite_amplitude(case: xr.Dataset) -> float:
    """The amplitude G of all terms of the infinite series, in g_0."""
    return float(case["total_amplitude"] + case["tail_amplitude"])


def _draw_bounds(axes: Axes, longest: xr.Dataset, quantity: str, datum: Datum) -> None:
    method = curves.numerical_method(longest)
    low, high = (curves.curve(longest, f"{quantity}_{side}", method) for side in ("lower", "upper"))
    if low is not None and high is not None:
        label = f"bounds from {style.describe(longest, 'm')}"
        loads = longest["mean_pressure"].values
        infinite = infinite_amplitude(longest)
        lower, upper = (datum(side, infinite, infinite) for side in (low, high))
        axes.fill_between(loads, lower, upper, label=label, **style.BOUND)
