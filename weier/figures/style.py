"""The common style of all figures: sizes, colours, lines, panels, and labels of axes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from weier.data.bodies import Bodies
from weier.data.variables import VARIABLES
from weier.methods import registry
from weier.methods.method import DEFAULT_STYLE, Method
from weier.scene.figure import MAX_PANELS
from weier.surface.profile import MAX_DENOMINATOR, PARAMETERS
from weier.units import PASCAL, THERMAL_RESISTANCE

if TYPE_CHECKING:  # importing matplotlib takes half a second, which the explorer does not need
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Group = TypeVar("Group")
Color = tuple[float, ...]

# Sizes in inches: a panel as wide as one column of a journal, a row of a legend, and panels by their number in a row.
WIDTH = 3.5
HEIGHT = 2.6
LEGEND_ROW = 0.17
GRID_PANELS = {1: (WIDTH, HEIGHT), 2: (2.9, 2.4), 3: (2.3, 2.0)}
MAX_GRID = 12  # More panels do not fit on a page.
LINEAR_DECADES = 2  # Over more decades, a linear axis hides the lightest loads.
LOGARITHMIC_MARGIN = 1.3  # ratio of the ends of a logarithmic axis to the extreme values

GREY = "0.35"  # Legend entries without a colour of their own are grey.

SHEET = Path(__file__).with_name("weier.mplstyle")  # The style sheet for matplotlib.style.use.

# Labels of axes, normalised and in SI units.

LABELS = {
    "x": r"$x/\lambda_0$",
    "height": r"height $z/g_0$",
    **{name: entry.axis for name, entry in VARIABLES.items() if entry.axis},
}

SI_LABELS = {
    "mean_pressure": r"mean pressure $\bar{p}$ (Pa)",
    "compliance": "compliance $h$ (m)",
    "resistance": r"resistance $\times$ nominal area ($\Omega\,$m$^2$)",
    "contact_fraction": VARIABLES["contact_fraction"].axis,
}

THERMAL = r"thermal resistance $\times$ nominal area (K$\,$m$^2$/W)"

# Okabe and Ito's colours, which colour-blind readers distinguish; dashes distinguish them in grey.
BLACK, VERMILLION, BLUE, GREEN = "#000000", "#D55E00", "#0072B2", "#009E73"
PURPLE, ORANGE = "#CC79A7", "#E69F00"
DASHES = (
    "-",
    (0, (5, 1.5)),
    (0, (6, 1.5, 1, 1.5)),
    (0, (1.2, 1.2)),
    (0, (6, 1.5, 1, 1.5, 1, 1.5)),
    (0, (9, 2)),
    (0, (3, 0.8)),
)


# style of numerical methods other than the most accurate one. `markevery` is the distance between points over the
# diagonal of the axes.
POINTS: dict[str, Any] = {"linestyle": "none", "markerfacecolor": "white", "markeredgewidth": 0.7, "markevery": 0.06}
# style of a band between bounds
BOUND_STYLE: dict[str, Any] = {"facecolor": "0.88", "edgecolor": "0.35", "linewidth": 0.7, "zorder": 1}


def labels_of(interface: Bodies | None, unit: str) -> dict[str, str]:
    """Return the labels of axes, for two bodies in SI units and for loads in this unit."""
    if interface is None:
        return LABELS
    own = {"resistance": THERMAL} if interface.resistance_unit == THERMAL_RESISTANCE else {}
    return SI_LABELS | own | {"mean_pressure": SI_LABELS["mean_pressure"].replace(PASCAL, unit)}


def line(method: str) -> dict[str, Any]:
    """Return keywords of Axes.plot for the curve of a method, or of a variant that is not listed as a method."""
    label, look = next(((own.label, own.style) for own in _listed(method)), (method, DEFAULT_STYLE))
    return {"label": label, "color": look.color, "linestyle": (0, look.dashes) if look.dashes else "-"}


def points(method: str) -> dict[str, Any]:
    """Return keywords of Axes.plot for the points of a numerical method on the line of a more accurate one."""
    return line(method) | POINTS | {"marker": registry.find_method(method).style.marker}


def sets_axes(method: str) -> bool:
    """Return whether axes follow the curves of a method: a method of the paper, or a numerical one."""
    return any(own.in_paper or own.numerical for own in _listed(method))


def _listed(method: str) -> list[Method]:
    return [own for own in registry.METHODS if own.name == method]


@cache
def family(count: int) -> list[dict[str, Any]]:
    """Return keywords of Axes.plot for a family of curves, from light to dark."""
    colors = shade(np.linspace(0, 1, count) if count > 1 else [1.0])
    dashes = [DASHES[(count - 1 - number) % len(DASHES)] for number in range(count)]  # the last, darkest is solid
    return [{"color": color, "linestyle": dash} for color, dash in zip(colors, dashes, strict=True)]


def shade(fractions: Iterable[float]) -> list[Color]:
    """Return colours from light (0) to dark (1), distinct in grey print and without yellow."""
    from matplotlib import colormaps

    return [colormaps["viridis_r"](0.2 + 0.75 * fraction) for fraction in fractions]


def column(title: str, names: Sequence[str], height: float = HEIGHT, **options: Any) -> tuple[Figure, list[Axes]]:
    """Return a single-column figure with a title and named panels below each other; heights in inches.

    It does not go through pyplot, which would keep it in memory.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDTH, height * len(names)), layout="constrained")
    axes = figure.subplots(len(names), 1, squeeze=False, **options)[:, 0].tolist()
    for number, (panel, name) in enumerate(zip(axes, names, strict=True)):
        name_panel(panel, number, len(names), name)
    set_title(figure, title)
    return figure, axes


def grid(panels: int, x: str, y: str, columns: int | None = None) -> tuple[Figure, list[Axes]]:
    """Return a figure with panels in rows and common axes. Without `columns`, a row has two or three panels."""
    from matplotlib.figure import Figure

    columns = columns or {1: 1, 2: 2, 4: 2}.get(panels, 3)
    width, height = GRID_PANELS[min(columns, 3)]
    rows = -(-panels // columns)
    figure = Figure(figsize=(width * columns, height * rows), layout="constrained")
    axes = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False).ravel().tolist()
    for number, panel in enumerate(axes):
        if number >= panels:
            panel.remove()
            continue
        panel.spines[:].set_in_layout(False)  # they do not extend a panel, but measure its ticks again
        if number + columns >= panels:  # no panel is below it
            panel.tick_params(labelbottom=True)
            panel.set_xlabel(x)
        if number % columns == 0:
            panel.set_ylabel(y)
    return figure, axes[:panels]


def limit_panels(
    title: str, groups: Sequence[Group], noun: str, most: int = MAX_PANELS
) -> tuple[str, Sequence[Group]]:
    """Return the groups that fit, and a title that counts the omitted ones; raises ValueError without groups."""
    if not groups:
        raise ValueError(f"there are no {noun} to draw in these studies")
    note = f"{most} of {len(groups)} {noun}" if len(groups) > most else ""
    return ": ".join(filter(None, [title, note])), groups[:most]


def set_load_axis(axes: Axes, low: float, high: float) -> None:
    """Set the axis of loads up to full contact: linear from 0, or logarithmic over more than `LINEAR_DECADES`."""
    if high > 10**LINEAR_DECADES * low:
        axes.set_xscale("log")
        axes.set_xlim(low, high)
    else:
        axes.set_xlim(0, high)


def set_load_scale(figure: Figure, scale: str) -> None:
    """Set the scale of the load axis of all panels; a linear one begins at 0."""
    for axes in figure.axes:
        if axes.get_label() != "<colorbar>":  # matplotlib gives this label to the axes of a colour bar.
            axes.set_xlim(left=axes.dataLim.minposx)
            axes.set_xscale(scale)
            if scale == "linear":
                axes.set_xlim(left=0)


def set_logarithmic_axes(axes: Axes, low: float, high: float, least: float, largest: float) -> None:
    """Set logarithmic axes over these loads and values; curves that fall to 0 cross the lower edge."""
    axes.set(xscale="log", yscale="log")
    if low < high:
        axes.set_xlim(low, high)
    if np.isfinite(least) and largest > 0:
        axes.set_ylim(least / LOGARITHMIC_MARGIN, largest * LOGARITHMIC_MARGIN)


def set_title(figure: Figure, title: str) -> None:
    """Write one line over the figure, unless the title is empty."""
    if title:
        figure.suptitle(title)


def name_panel(axes: Axes, number: int, panels: int, label: str) -> None:
    """Write the title of a panel, after (a), (b), ... if there are several panels."""
    axes.set_title(f"({chr(ord('a') + number)})  {label}" if panels > 1 else label)


def describe(case: Any, *names: str) -> str:
    """Return the labels of a case in the symbols of the paper: the given coordinates, or all."""
    values = {name: f"${symbol(name)}={_parameter(case, name)}$" for name in PARAMETERS}
    phase = np.asarray(case["phases"])
    phase = phase[np.isfinite(phase)]
    seed = float(case.get("seed", np.nan))
    if np.isfinite(seed):
        values["seed"] = f"seed {seed:.0f}"
    elif phase.size > 1 and phase[0] == 0 and np.ptp(phase[1:]) == 0:
        values["phases"] = rf"$\phi={phase[1]:.3g}$"
    return r",  ".join(text for name, text in values.items() if not names or name in names)


def symbol(name: str) -> str:
    """Return the symbol of a parameter in mathtext, which names Greek letters."""
    letter = VARIABLES[name].symbol
    return letter if len(letter) == 1 else f"\\{letter}"


def _parameter(case: Any, name: str) -> str:
    """Return the value of a parameter in mathtext: gamma as a ratio."""
    value = float(case[name])
    if name == "gamma":
        return str(Fraction(value).limit_denominator(MAX_DENOMINATOR))
    return f"{value:g}" if np.isfinite(value) else r"\infty"
