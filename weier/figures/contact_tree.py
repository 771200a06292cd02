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
from weier.figures.values import keep_band, line
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
    rectangles = _rectangles(edges, loads, period)
    axes.add_collection(PolyCollection(rectangles, facecolors=style.BLUE, edgecolors="none", label="contact"))
    left, right, upper, _ = np.transpose(rectangles, (1, 2, 0))
    ends = np.ravel([left[0], right[0]], "F")  # alternates left and right ends
    keep_band(axes, "contact", ends, np.repeat(left[1], 2), np.repeat(upper[1], 2))
    axes.set(xlim=(0, period), yscale="log", ylim=(loads[0], loads[-1]))
    axes.set(xlabel=style.LABELS["x"], ylabel=style.LABELS["mean_pressure"])
    # The legend is above the axes, since contacts may be anywhere within them.
    axes.legend(loc="lower right", bbox_to_anchor=(1, 1), borderaxespad=0, handlelength=1)


def _rectangles(edges: Array, loads: Array, period: float) -> list[Array]:
    """Return a rectangle for each contact, up and down to the middle between neighbouring loads.

    A contact across the end of the period is drawn at both ends.
    """
    middle = np.sqrt(loads[1:] * loads[:-1])
    low, high = np.append(loads[0], middle), np.append(middle, loads[-1])
    rectangles = []
    edges, full = edges.copy(), ~np.isfinite(edges).any(axis=(1, 2))
    edges[full, 0] = 0.0, period  # full contact, which has no edges, reaches from one end of the period to the other
    for row, bottom, top in zip(edges, low, high, strict=True):
        for left, right in row[np.isfinite(row[:, 0])]:
            for shift in (0.0, -period) if right > period else (0.0,):
                start, end = left + shift, right + shift
                rectangles.append(np.array([(start, bottom), (end, bottom), (end, top), (start, top)]))
    return rectangles
