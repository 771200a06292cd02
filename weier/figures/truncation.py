"""Series truncated after m terms, and what their tails could change: what Figs 7 and 8 share."""

from __future__ import annotations

from collections.abc import Sequence

import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from weier.figures import lines, style
from weier.kernels.arrays import Array
from weier.methods import curves
from weier.theory.profile import PARAMETERS

BESIDE_TERMS = [name for name in PARAMETERS if name != "m"]


def compare(
    studies: Sequence[xr.Dataset], title: str, quantity: str
) -> tuple[Figure, list[tuple[Axes, list[xr.Dataset]]]]:
    """The numerical curves of all m with the bounds from the longest series, one panel for each D and gamma.

    Returns
    -------
    figure : Figure
    panels : list of (Axes, cases)
        Limits, labels and the legend are left to the caller; the cases are in order of m.

    """
    solved = [case for case in curves.cases(studies) if curves.numerical_method(case)]
    title, series = style.limit_panels(title, curves.groups(solved, *BESIDE_TERMS), "series")
    figure, axes = style.column(len(series))
    ordered = [sorted(cases, key=lambda case: float(case["m"])) for cases in series]
    for number, (panel, cases) in enumerate(zip(axes, ordered, strict=True)):
        draw_curves(panel, cases, quantity)
        style.name_panel(panel, number, len(series), style.describe(cases[-1], *BESIDE_TERMS))
    axes[-1].set_xlabel(style.LABELS["mean_pressure"])
    style.set_title(figure, title)
    return figure, list(zip(axes, ordered, strict=True))


def draw_curves(axes: Axes, cases: Sequence[xr.Dataset], quantity: str) -> None:
    """The curves of one panel, in order of m, and the bounds below them."""
    _draw_bounds(axes, cases[-1], quantity)
    by_terms = curves.groups(cases, "m")
    looks = style.family(len(by_terms))
    for look, same in zip(looks, by_terms, strict=True):
        thin = {"linewidth": 0.4, "alpha": style.FAINT_ALPHA} if len(same) > 1 else {}
        for number, case in enumerate(same):
            label = style.describe(case, "m") if number == 0 else None
            drawn = lines.line(case, quantity, curves.numerical_method(case))
            if drawn is not None:
                axes.plot(drawn[0], from_one_datum(case, quantity, drawn[1]), label=label, **look | thin)
    alone = [(same[0], look["color"]) for look, same in zip(looks, by_terms, strict=True) if len(same) == 1]
    checks = [(_less_accurate(case, quantity), color) for case, color in alone]
    style.draw_sparse_points(axes, cases[0]["mean_pressure"].values, checks)


def _less_accurate(case: xr.Dataset, quantity: str) -> dict[str, Array]:
    """The curves by numerical methods beside the most accurate one, by method."""
    found = curves.less_accurate(case, quantity)
    return {method: from_one_datum(case, quantity, values) for method, values in found.items()}


def from_one_datum(case: xr.Dataset, quantity: str, values: Array) -> Array:
    """Values that are alike for all m: a compliance counts from where all waves of the infinite series peak."""
    return values + float(case["tail_amplitude"]) if quantity == "compliance" else values


def _draw_bounds(axes: Axes, longest: xr.Dataset, quantity: str) -> None:
    method = curves.numerical_method(longest)
    low, high = (curves.curve(longest, f"{quantity}_{side}", method) for side in ("lower", "upper"))
    if low is not None and high is not None:
        label = f"bounds from {style.describe(longest, 'm')}"
        axes.fill_between(longest["mean_pressure"].values, low, high, label=label, **style.BOUND)
