"""Interpolation of the compliance between its loads, by cubic pieces whose slopes are the resistance."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from weier.data import curves
from weier.figures import style
from weier.figures.values import line as draw_line
from weier.kernels.arrays import Array
from weier.methods.curve import COMPLIANCE, RESISTANCE

PIECES = 8  # segments between two loads that look smooth in print


def line(case: xr.Dataset, quantity: str, method: str | None) -> tuple[Array, Array] | None:
    """Return loads and values of a curve, a compliance also between its loads; None without a curve."""
    values, loads = curves.curve(case, quantity, method), case["mean_pressure"].values
    slope = curves.curve(case, RESISTANCE, method)
    if values is None or slope is None or quantity != COMPLIANCE:
        return None if values is None else (loads, values)
    return between_loads(loads, values, slope)


def between_loads(loads: Array, h: Array, slope: Array) -> tuple[Array, Array]:
    """Return loads and compliances, at the loads and, if the slope is known, between them."""
    if loads.size < 2 or not (np.isfinite(h).any() and np.isfinite(slope).any()):
        return loads, h
    fine = refined_loads(loads)
    return fine, compliance_at(fine, loads, h, slope)


def refined_loads(loads: Array) -> Array:
    """Return the loads and others between them, in equal ratios, shape (PIECES (loads - 1) + 1,)."""
    ratio = (loads[1:] / loads[:-1])[:, None] ** (np.arange(PIECES) / PIECES)
    return np.append((loads[:-1, None] * ratio).ravel(), loads[-1])


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
