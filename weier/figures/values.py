"""The values of a figure as CSV: a row for each point of each line and band, with units in the headings."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from io import StringIO
from itertools import repeat
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.container import ErrorbarContainer
from matplotlib.figure import Figure

from weier.data.variables import VARIABLES
from weier.figures.style import LABELS, SI_LABELS
from weier.units import IN_SI, PASCAL

# Headings of the axes that show variables.
OF_VARIABLES = {"x": "x (lambda_0)", "height": "height (g_0)"}
OF_VARIABLES |= {name: f"{name} ({entry.unit})" for name, entry in VARIABLES.items()}
HEADINGS = {label: OF_VARIABLES[name] for name, label in LABELS.items()}
HEADINGS |= {
    label: f"{name} ({IN_SI.get(VARIABLES[name].unit, VARIABLES[name].unit)})" for name, label in SI_LABELS.items()
}
PRESSURE = SI_LABELS["mean_pressure"].removesuffix(f"({PASCAL})")
TITLES: tuple[Literal["center", "left", "right"], ...] = ("center", "left", "right")  # Where a panel has its title.
# Formulas of matplotlib in plain text, between signs of dollars that stand for themselves behind a backslash.
DOLLAR = re.compile(r"(?<!\\)\$")
BRACED, SPACE, WORD = re.compile(r"\\(?:bar|mathrm)\{([^}]*)\}"), re.compile(r"\\[,;!]"), re.compile(r"\\([A-Za-z]+)")


def as_csv(figure: Figure) -> str:
    """Return all points of a figure; a band has its ends in place of a value.

    Columns are the panel and the curve, and for each pair of axes x, y, and the ends of bands.
    """
    parts = [(_plain(_title(axes)), *curve) for axes in figure.axes for curve in _curves(axes)]
    headings = list(dict.fromkeys(["panel", "curve", *(name for *_, columns in parts for name in columns)]))
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(headings)
    for panel, curve, columns in parts:
        missing = repeat("")
        writer.writerows(
            zip(repeat(panel), repeat(curve), *(columns.get(name, missing) for name in headings[2:]), strict=False)
        )
    return text.getvalue()


def _curves(axes: Axes) -> Iterator[tuple[str, dict[str, list[float]]]]:
    """Yield the names of the lines and bands of a panel, each with its values by their headings."""
    labels = (_labelled(axes, name).get_label_text() for name in "xy")
    x, y = map(_heading, labels)
    for number, line in enumerate(axes.lines, 1):
        # no grid, no cap of a bar, and no entry of a legend
        if line.get_transform() == axes.transData and line.get_label() != "_nolegend_":
            points = np.asarray(line.get_xydata(), float)
            if points.size:
                yield _name(line, f"line {number}"), dict(zip((x, y), points.T.tolist(), strict=True))
    of_bars: dict[Any, Any] = {
        bar: one for one in axes.containers if isinstance(one, ErrorbarContainer) for bar in one.lines[2]
    }
    for number, band in enumerate(axes.collections, 1):
        if isinstance(band, PolyCollection | LineCollection):
            name = _name(of_bars.get(band, band), f"band {number}")
            for path in band.get_paths():
                ends = _ends(np.asarray(path.vertices, float))
                yield name, dict(zip((x, f"{y}, low", f"{y}, high"), ends, strict=True))


def _heading(label: str) -> str:
    """Return the heading of an axis; mean pressures have any unit."""
    if label.startswith(PRESSURE):
        return f"mean_pressure {label.removeprefix(PRESSURE)}"
    return HEADINGS.get(label, _plain(label))


def _ends(vertices: Any) -> tuple[list[float], list[float], list[float]]:
    """Return each x of a polygon, and the least and largest y there."""
    x, number = np.unique(vertices[:, 0], return_inverse=True)
    low, high = np.full(x.size, np.inf), np.full(x.size, -np.inf)
    np.minimum.at(low, number, vertices[:, 1])
    np.maximum.at(high, number, vertices[:, 1])
    return x.tolist(), low.tolist(), high.tolist()


def _name(artist: Any, otherwise: str) -> str:
    label = str(artist.get_label())
    return otherwise if label.startswith("_") else _plain(label)


def _column(axes: Axes) -> range | None:
    place = axes.get_subplotspec()
    return place.colspan if place else None


def _title(axes: Axes) -> str:
    """Return the title of a panel, or that of another panel of its column."""
    column = [one for one in axes.figure.axes if _column(one) == _column(axes)]
    titles = [str(one.get_title(loc=where)) for one in (axes, *column) for where in TITLES]
    return next(filter(None, titles), "")


def _labelled(axes: Axes, name: str) -> Any:
    """Return the axis of a panel, or the labelled one of a panel that shares it."""
    shared = axes.get_shared_x_axes() if name == "x" else axes.get_shared_y_axes()
    axis = [getattr(other, f"{name}axis") for other in (axes, *shared.get_siblings(axes))]
    return next((one for one in axis if one.get_label_text()), axis[0])


def _plain(text: str) -> str:
    """Return a text of matplotlib without its signs of formulas; what is between formulas, as names, stays."""
    parts = DOLLAR.split(text)
    parts[1::2] = [_plain_formula(part) for part in parts[1::2]]
    parts[::2] = [part.replace(r"\$", "$") for part in parts[::2]]
    return " ".join("".join(parts).split())


def _plain_formula(text: str) -> str:
    plain = WORD.sub(r"\1", SPACE.sub(" ", BRACED.sub(r"\1", text)))
    return re.sub(r"[{}]", "", plain).replace("infty", "inf")
