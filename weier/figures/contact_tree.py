"""The contacts along the surface over the load: they are born as points, grow, and merge until all are one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from weier.data import curves
from weier.figures import style
from weier.figures.values import keep, line
from weier.kernels.arrays import Array

SAMPLES = 2000  # points of the profile, finer than print resolves


def draw(studies: Sequence[xr.Dataset], title: str) -> Figure:
    """Draw the profile of the first case with contact edges, and below it its contacts over all mean pressures."""
    cases = (case for case in curves.cases(studies) if "contact_edge" in case)
    known = [case for case in cases if case["contact_edge"].notnull().any()]
    title, (case,) = style.limit_panels(title, known, "cases with contact edges", most=1)
    figure = Figure(figsize=(style.WIDTH, 1.5 * style.HEIGHT), layout="constrained")
    top, tree = figure.subplots(2, 1, sharex=True, height_ratios=(1, 4))
    profile = curves.profile(case)
    x = np.linspace(0, profile.period, SAMPLES)
    line(top, "profile", x, profile.height(x), color=style.BLACK, linewidth=0.8)
    top.set_ylabel(style.LABELS["height"])
    _draw_tree(tree, case)
    top.set_title(style.describe(case))
    style.set_title(figure, title)
    return figure


def _draw_tree(axes: Axes, case: xr.Dataset) -> None:
    period, loads = curves.profile(case).period, case["mean_pressure"].values
    edges = case["contact_edge"].values.reshape(loads.size, -1, 2)
    left, right, low, high = _rectangles(edges, loads, period)
    corners = np.transpose([(left, low), (right, low), (right, high), (left, high)], (2, 0, 1))
    axes.add_collection(PolyCollection([*corners], facecolors=style.BLUE, edgecolors="none", label="contact"))
    ends = np.ravel([left, right], "F")  # alternates left and right ends
    keep(axes, "contact", ends, {", low": np.repeat(low, 2), ", high": np.repeat(high, 2)})
    axes.set(xlim=(0, period), yscale="log", ylim=(loads[0], loads[-1]))
    axes.set(xlabel=style.LABELS["x"], ylabel=style.LABELS["mean_pressure"])
    # The legend is above the axes, since contacts may be anywhere within them.
    axes.legend(loc="lower right", bbox_to_anchor=(1, 1), borderaxespad=0, handlelength=1)


def _rectangles(edges: Array, loads: Array, period: float) -> Array:
    """Return both ends of each contact and loads below and above it, to the middle between neighbouring loads.

    A contact across the end of the period is drawn at both ends.
    """
    middle = np.sqrt(loads[1:] * loads[:-1])
    edges, full = edges.copy(), ~np.isfinite(edges).any(axis=(1, 2))
    edges[full, 0] = 0.0, period  # full contact, which has no edges, reaches from one end of the period to the other
    row, contact = np.nonzero(np.isfinite(edges[..., 0]))
    low, high = np.append(loads[0], middle)[row], np.append(middle, loads[-1])[row]
    found = np.array([*edges[row, contact].T, low, high])
    across = found[:, found[1] > period] - np.array([[period, period, 0, 0]]).T
    return np.concatenate([found, across], axis=1)
