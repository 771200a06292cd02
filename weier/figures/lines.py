"""Interpolation of curves between their loads, from compliance and resistance together.

The resistance is the slope of the compliance, so that a compliance is drawn as cubic pieces with the right slopes,
not as a polygon. Where a resistance falls to 0 between two loads, the rise of the compliance gives the load.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from weier.data import curves
from weier.figures import style
from weier.figures.values import line as draw_line
from weier.kernels.arrays import Array, Flags
from weier.methods.curve import QUANTITIES

PIECES = 8  # segments between two loads that look smooth in print
DECADES = 4  # decades drawn of a resistance that falls to 0, more than an axis shows


def line(case: xr.Dataset, quantity: str, method: str | None) -> tuple[Array, Array] | None:
    """Return loads and values of a curve, at the loads of the case and between them; None without a curve."""
    if curves.curve(case, quantity, method) is None:
        return None
    column = case["solution_method"].values.tolist().index(method)
    return between_loads(quantity, case["mean_pressure"].values, *(case[name].values[column] for name in QUANTITIES))


def between_loads(quantity: str, loads: Array, h: Array, slope: Array) -> tuple[Array, Array]:
    """Return loads and values of a curve, at its loads and, if both quantities are known, between them."""
    if loads.size < 2 or not (np.isfinite(h).any() and np.isfinite(slope).any()):
        return loads, h if quantity == "compliance" else slope
    return compliance_line(loads, h, slope) if quantity == "compliance" else resistance_line(loads, h, slope)


def between(loads: Array) -> Array:
    """Return the loads and others between them, in equal ratios, shape (PIECES (loads - 1) + 1,)."""
    ratio = (loads[1:] / loads[:-1])[:, None] ** (np.arange(PIECES) / PIECES)
    return np.append((loads[:-1, None] * ratio).ravel(), loads[-1])


def compliance_line(loads: Array, h: Array, slope: Array) -> tuple[Array, Array]:
    """Interpolate the compliance by cubic Hermite polynomials, shape (PIECES (loads - 1) + 1,)."""
    fine = between(loads)
    return fine, compliance_at(fine, loads, h, slope)


def compliance_at(fine: Array, loads: Array, h: Array, slope: Array) -> Array:
    """Interpolate the compliances of one or several curves, shape (..., loads)."""
    piece = np.minimum(np.searchsorted(loads, fine, side="right") - 1, loads.size - 2)
    width = (loads[1:] - loads[:-1])[piece]
    t = (fine - loads[piece]) / width
    left, right = h[..., piece], h[..., piece + 1]
    values: Array = left * ((1 + 2 * t) * (1 - t) ** 2) + right * (t**2 * (3 - 2 * t))
    values += slope[..., piece] * (width * t * (1 - t) ** 2)
    values -= slope[..., piece + 1] * (width * t**2 * (1 - t))
    return np.clip(values, left, right, out=values)


def resistance_line(loads: Array, h: Array, slope: Array) -> tuple[Array, Array]:
    """Return the resistance at the loads and, where it falls to 0, between the last two of them.

    Notes
    -----
    Before the last gap closes at the load p_c, the resistance is proportional to p_c - p, as -ln p is at p = 1 for
    one wave (13). The compliance still rises by R (p_c - p)/2 there, from which p_c follows.
    """
    ends = np.flatnonzero((slope[:-1] > 0) & (slope[1:] == 0))
    if not ends.size:
        return loads, slope
    last = int(ends[-1])
    zero = zero_load(loads, h, slope, last)
    remaining = np.append(np.geomspace(1, 10.0**-DECADES, PIECES * DECADES)[1:], 0.0)
    more = zero - (zero - loads[last]) * remaining
    full_contact: Flags = loads > zero
    return (
        np.concatenate([loads[: last + 1], more, loads[full_contact]]),
        np.concatenate([slope[: last + 1], slope[last] * remaining, slope[full_contact]]),
    )


def zero_load(loads: Array, h: Array, slope: Array, last: int) -> float:
    """Return the load at which the resistance vanishes, between a load and the next one."""
    return float(min(loads[last] + 2 * (h[last + 1] - h[last]) / slope[last], loads[last + 1]))


def draw_sparse_points(axes: Axes, quantity: str, rows: Iterable[tuple[xr.Dataset, float, style.Color]]) -> None:
    """Draw a few points of other numerical methods on each of many curves, given as (case, datum, colour).

    The datum is added to the values. The legend has each method once, in black.
    """
    drawn: dict[str, dict[str, Any]] = {}
    for case, datum, color in rows:
        for method in list(curves.numerical_methods(case))[1:]:
            if (values := curves.curve(case, quantity, method)) is not None:
                drawn[method] = look = style.points(method) | style.SPARSE_POINTS
                own = look | {"color": color, "label": None}
                draw_line(axes, look["label"], case["mean_pressure"].values, values + datum, **own)
    for look in drawn.values():
        axes.plot([], [], **look | {"color": style.BLACK})
