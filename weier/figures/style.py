"""One look for all figures: sizes, colours, lines, and the words on the axes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import Any, NamedTuple, TypeVar

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from weier.methods import registry
from weier.methods.method import DEFAULT_STYLE
from weier.pipeline import curves
from weier.theory.profile import MAX_DENOMINATOR

Shown = TypeVar("Shown")
Color = tuple[float, ...]

WIDTH = 3.5  # inches: one column of a journal
HEIGHT = 2.6
PANELS = 4  # in one column; more would not fit a page
FAINT = 0.3
MARGIN = 1.3  # on a logarithmic axis

# In Python, not in a style sheet, so that a change of style is seen by what follows imports.
RC: dict[str, Any] = {
    "font.family": "STIXGeneral",
    "font.size": 9,
    "mathtext.fontset": "stix",
    "axes.labelsize": 9,
    "axes.titlesize": 8.5,
    "axes.titlelocation": "left",
    "axes.titlepad": 4,
    "axes.linewidth": 0.6,
    "figure.titlesize": 9.5,
    "figure.dpi": 300,
    "savefig.dpi": 300,
    "legend.fontsize": 8,
    "legend.frameon": False,
    "legend.handlelength": 2.6,
    "legend.labelspacing": 0.3,
    "lines.linewidth": 1.2,
    "lines.markersize": 3.2,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4,
    "svg.hashsalt": "weier",
    "pdf.fonttype": 42,
}

LABELS = {
    "x": r"$x/\lambda_0$",
    "height": r"height $z/g_0$",
    "mean_pressure": r"mean pressure $\bar{p}/p_0^{*}$",
    "compliance": r"compliance $h/g_0$",
    "resistance": r"resistance $(\mathrm{d}h/\mathrm{d}\bar{p})\;p_0^{*}/g_0$",
}

# Okabe and Ito's colours, told apart by colour-blind readers; the dashes tell them apart in grey.
BLACK, VERMILLION, BLUE, GREEN = "#000000", "#D55E00", "#0072B2", "#009E73"
PURPLE, ORANGE, SKY = "#CC79A7", "#E69F00", "#56B4E9"
DASHES = (
    "-",
    (0, (5, 1.5)),
    (0, (6, 1.5, 1, 1.5)),
    (0, (1.2, 1.2)),
    (0, (6, 1.5, 1, 1.5, 1, 1.5)),
    (0, (9, 2)),
    (0, (3, 0.8)),
)


# A second numerical method: its distance between points is a part of the diagonal of the axes.
POINTS: dict[str, Any] = {"linestyle": "none", "marker": "o", "markerfacecolor": "white"}
POINTS |= {"markeredgewidth": 0.7, "markevery": 0.06}
FEW_POINTS: dict[str, Any] = POINTS | {"markevery": 0.15, "markersize": 2.2, "markeredgewidth": 0.6}  # many curves
BOUND: dict[str, Any] = {"facecolor": "0.88", "edgecolor": "0.35", "linewidth": 0.7, "zorder": 1}


class Line(NamedTuple):
    """How a method is drawn everywhere: its name for people, colour and dashes."""

    label: str
    color: str
    linestyle: Any


def line(method: str) -> dict[str, Any]:
    """Keywords of Axes.plot for the curve of a method, or of a variant that no method is named as."""
    found = next((each for each in registry.METHODS if each.name == method), None)
    label, look = (found.label, found.style) if found else (method, DEFAULT_STYLE)
    return Line(label, look.color, (0, look.dashes) if look.dashes else "-")._asdict()


def draw_points(axes: Axes, loads: np.ndarray, rows: Iterable[tuple[np.ndarray | None, Color]]) -> None:
    """A few points of a second numerical method beside each of many curves; the legend names them once, in black."""
    found = [(values, color) for values, color in rows if values is not None]
    for values, color in found:
        axes.plot(loads, values, color=color, **FEW_POINTS)
    if found:
        axes.plot([], [], label=registry.method_named(registry.numerical_names()[1]).label, color=BLACK, **FEW_POINTS)


def family(count: int) -> list[dict[str, Any]]:
    """Keywords of Axes.plot for so many curves in order, from light to dark."""
    colors = shade(np.linspace(0, 1, count) if count > 1 else [1.0])
    dashes = [DASHES[(count - 1 - number) % len(DASHES)] for number in range(count)]  # the last, darkest is solid
    return [{"color": color, "linestyle": dash} for color, dash in zip(colors, dashes, strict=True)]


def shade(fraction: Iterable[float]) -> list[Color]:
    """Colours from light (0) to dark (1), distinct in grey print; no yellow, which white paper swallows."""
    colormap = matplotlib.colormaps["viridis_r"]
    return [colormap(0.2 + 0.75 * value) for value in fraction]


def column(panels: int, height: float = HEIGHT, **options: Any) -> tuple[Figure, list[Axes]]:
    """A figure one column wide with panels below each other, each so high in inches; without pyplot's state."""
    figure = Figure(figsize=(WIDTH, height * panels), layout="constrained")
    axes = figure.subplots(panels, 1, squeeze=False, **options)[:, 0].tolist()
    return figure, axes


def shown(title: str, groups: Sequence[Shown], what: str) -> tuple[str, Sequence[Shown]]:
    """As many of the groups as there is space for, and a title that tells if that is not all.

    Raises
    ------
    ValueError
        If there is nothing to show.

    """
    if not groups:
        raise ValueError(f"there are no {what} to draw in these studies")
    note = f"{PANELS} of {len(groups)} {what}" if len(groups) > PANELS else ""
    return ": ".join(filter(None, [title, note])), groups[:PANELS]


def logarithmic(axes: Axes, cases: Sequence[xr.Dataset], quantity: str) -> None:
    """Logarithmic axes from light loads to full contact; a curve that falls to 0 leaves through the floor."""
    low, high = curves.light_load(cases), curves.full_contact_load(cases)
    loads = cases[0]["mean_pressure"].values
    # An estimate may vanish long before the contact is full: the numerical curves set the scale.
    rows = [row for case in cases if (row := curves.numerical(case, quantity)) is not None]
    every = np.array([case[quantity].values for case in cases])
    inside = (loads >= low) & (loads <= high)
    floor, top = (
        values[..., inside][values[..., inside] > 0] for values in (np.array(rows) if rows else every, every)
    )
    axes.set(xscale="log", yscale="log")
    if low < high:
        axes.set_xlim(low, high)
    if floor.size:
        axes.set_ylim(floor.min() / MARGIN, top.max() * MARGIN)


def set_title(figure: Figure, title: str) -> None:
    """One line over the figure, or none."""
    if title:
        figure.suptitle(title)


def name_panel(axes: Axes, number: int, panels: int, label: str) -> None:
    """(a), (b), ... where there are several, and what the panel shows."""
    axes.set_title(f"({chr(ord('a') + number)})  {label}" if panels > 1 else label)


def describe(case: xr.Dataset, *names: str) -> str:
    """The coordinates of a case in the paper's symbols: all of the series, or those named."""
    values = {"D": rf"$D={float(case['D']):g}$", "gamma": rf"$\gamma={_ratio(case)}$", "m": rf"$m={_terms(case)}$"}
    phase = case["phase"].values[1:]
    phase = phase[np.isfinite(phase)]
    if phase.size and np.ptp(phase) == 0:
        values["phase"] = rf"$\phi={phase[0]:.3g}$"
    return r",  ".join(text for name, text in values.items() if not names or name in names)


def _ratio(case: xr.Dataset) -> Fraction:
    return Fraction(float(case["gamma"])).limit_denominator(MAX_DENOMINATOR)


def _terms(case: xr.Dataset) -> str:
    m = float(case["m"])
    return f"{m:g}" if np.isfinite(m) else r"\infty"
