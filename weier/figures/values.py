"""Draw lines and bands and keep their values, to write them as CSV with the labels of the axes as headings."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Dollar signs delimit mathtext unless escaped by a backslash; SIGNS converts mathtext to plain text.
DOLLAR = re.compile(r"(?<!\\)\$")
SIGNS = (
    (r"\\(?:bar|mathrm)\{([^}]*)\}", r"\1"),
    (r"\\[,;!]", " "),
    (r"\\infty", "inf"),
    (r"\\([A-Za-z]+)", r"\1"),
    (r"\^\{\*\}", "*"),
    (r"[{}]", ""),
)


def line(axes: Axes, name: str, x: Any, y: Any, **look: Any) -> None:
    """Draw a line and keep its values; `look` may override the label of the legend."""
    keep(axes, name, x, {"": y})
    axes.plot(x, y, **{"label": name} | look)


def band(axes: Axes, name: str, x: Any, low: Any, high: Any, **look: Any) -> None:
    """Draw a band, and keep its ends."""
    keep(axes, name, x, {", low": low, ", high": high})
    axes.fill_between(x, low, high, label=name, **look)


def keep(axes: Axes, name: str, x: Any, values: dict[str, Any]) -> None:
    """Keep the values of a curve, also of one that is drawn elsewhere, in a dict by suffix of their headings."""
    vars(axes.figure).setdefault("curves", []).append((axes, name, x, values))


def as_csv(figure: Figure) -> str:
    """Return all points: panel and curve, and for each pair of axes x, y, and the ends of bands."""
    import pandas as pd  # importing it takes a third of a second

    parts = []
    for axes, name, x, values in vars(figure)["curves"]:
        heading = plain(_label(axes, "y"))
        columns = {plain(_label(axes, "x")): x} | {f"{heading}{end}": own for end, own in values.items()}
        numbers = {name: np.asarray(own, float) for name, own in columns.items()}
        known = ~np.isnan(list(numbers.values())[1:]).all(axis=0)
        rows = {name: own[known] for name, own in numbers.items()}
        parts.append(pd.DataFrame({"panel": plain(_title(axes)), "curve": plain(name)} | rows))
    return pd.concat(parts).to_csv(index=False, lineterminator="\n")


def _title(axes: Axes) -> str:
    """Return the title of a panel, or of another panel in its column; the style sheet puts titles at the left."""
    columns = [(one, getattr(one.get_subplotspec(), "colspan", None)) for one in (axes, *axes.figure.axes)]
    same = [one for one, column in columns if column == columns[0][1]]
    return next(filter(None, (one.get_title(loc=place) for one in same for place in ("left", "center"))), "")


def _label(axes: Axes, name: str) -> str:
    """Return the label of an axis of a panel, or of a panel that shares it."""
    shared = axes.get_shared_x_axes() if name == "x" else axes.get_shared_y_axes()
    labels = (getattr(other, f"get_{name}label")() for other in (axes, *shared.get_siblings(axes)))
    return next(filter(None, labels), "")


def plain(text: str) -> str:
    """Convert mathtext to plain text; text outside formulas, such as names, is unchanged."""
    parts = DOLLAR.split(text)
    for pattern, sign in SIGNS:
        parts[1::2] = [re.sub(pattern, sign, part) for part in parts[1::2]]
    parts[::2] = [part.replace(r"\$", "$") for part in parts[::2]]
    return " ".join("".join(parts).split())
