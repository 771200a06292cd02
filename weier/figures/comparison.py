"""Curves of many cases and methods, with the colours, panels and medians that a scene chooses.

A figure of a sweep shows the effect of its parameters. By default, each of few cases has a panel, and curves of many
cases are medians over the phases.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Hashable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from weier.data import curves
from weier.data.bodies import Bodies
from weier.figures import lines, style
from weier.figures.captions import PLURALS
from weier.figures.tables import Extent, Table, codes, extent, tables_of
from weier.kernels.arrays import Array, Indices
from weier.methods.curve import COMPLIANCE, QUANTITIES
from weier.methods.registry import names, numerical_names
from weier.scene import Grouping
from weier.scene.figure import EACH_CASE
from weier.surface.profile import PARAMETERS
from weier.units import unit_of

# styles of bands around medians, of a solid line under dashed ones of its colour, and of bands of stated errors
BAND: dict[str, Any] = {"alpha": 0.16, "linewidth": 0}
BEHIND: dict[str, Any] = {"facecolor": "0.86", "edgecolor": "0.7", "linewidth": 0.4, "zorder": 1.0}
BELOW: dict[str, Any] = {"linewidth": 2.6, "alpha": 0.5}
STATED: dict[str, Any] = {"alpha": 0.35, "linewidth": 0, "zorder": 1.8}
# A narrower band of stated errors is hidden by its line: widths over the largest compliance, and over the resistance.
VISIBLE = {"compliance": 0.01, "resistance": 0.05}
SURFACES = (*PARAMETERS, "trace")  # distinguish surfaces, besides phases
MAX_VALUES = 2**22  # Loads times curves that are reduced at once, 32 MB.


class PlottedCurve(NamedTuple):
    """The curves of one method that look alike, reduced to a line and a band.

    table, row : the first of their cases, and its row
    method : of all
    loads, values : the line
    band : the low and the high end of the band, shape (2, loads); None for a single curve
    members : number of curves
    points : whether to draw points instead of a line, next to a more accurate curve
    parameters : those of the first case by name
    differing : the parameters in which the curves differ
    """

    table: Table
    row: int
    method: str
    loads: Array
    values: Array
    band: Array | None
    members: int
    points: bool
    parameters: Mapping[str, Hashable]
    differing: Sequence[str]

    @property
    def case(self) -> xr.Dataset:
        """The first of their cases, in the units of the axes."""
        return self.table.case(self.row)


class Members(NamedTuple):
    """Curves that look alike: their method, and for each study the rows of cases and the column of the method."""

    method: str
    rows: list[tuple[Table, Indices, int]]

    @property
    def size(self) -> int:
        """The number of curves."""
        return sum(rows.size for _, rows, _ in self.rows)

    def column(self, name: str) -> Array:
        """Return the codes of a parameter, or another column of the tables, of all curves."""
        return np.concatenate([table.columns[name][rows] for table, rows, _ in self.rows])


def compare(
    studies: Sequence[xr.Dataset],
    title: str,
    quantity: str,
    grouping: Grouping,
    interface: Bodies | None = None,
    behind: Sequence[xr.Dataset] = (),
) -> tuple[Figure, Sequence[Axes], Extent]:
    """Draw a quantity with the panels, colours and medians of a grouping; in SI units with an interface.

    Parameters
    ----------
    studies : sequence of Dataset
        Of one scene, which has one list of loads.
    title, quantity : str
    grouping : Grouping
    interface : Bodies, optional
    behind : sequence of Dataset
        Studies whose most accurate curves are a grey band behind those of the same D, gamma and m.

    Returns
    -------
    figure : Figure
    panels : sequence of Axes
        They have common axes, whose limits and scales the caller sets.
    extent : Extent
        The loads and values that are drawn.

    Raises
    ------
    ValueError
        If there are no such curves, or some could not be distinguished.

    """
    tables = tables_of(studies, quantity, interface)
    cases = sum(int(table.known.any(axis=1).sum()) for table in tables)
    if not cases:
        raise ValueError(f"there are no curves of {quantity} to draw in these studies")
    grouping = grouping.of(cases)
    drawn = _curves(tables, quantity, grouping)
    facet_values = [_values(drawn, name) for name in grouping.facet]
    noun = " and ".join(grouping.facet) or "curves"
    title, shown = style.limit_panels(title, list(itertools.product(*facet_values)), noun, style.MAX_GRID)
    labels = style.labels_of(unit_of(studies[0]["mean_pressure"]))
    figure, panels = style.grid(len(shown), labels["mean_pressure"], labels[quantity], *map(len, facet_values[1:]))
    differing = {{"phases": "seed"}.get(name, name) for curve in drawn for name in curve.differing}
    names = [name for name in ("method", *SURFACES, "seed") if name not in (*grouping.facet, *differing)]
    parameter_values = {name: _values(drawn, name) for name in names}
    alike = {name: values[0] for name, values in parameter_values.items() if len(values) == 1 and values[0] != ""}
    shared = (
        "" if grouping.facet == EACH_CASE.facet else _join(_label(drawn, *parameter) for parameter in alike.items())
    )
    bands: dict[str, Patch] = {}
    ensembles = tables_of(behind, quantity, interface)
    for axes in panels:  # else each band would set the limits of all panels
        axes.set_autoscale_on(False)
    for number, (axes, value) in enumerate(zip(panels, shown, strict=True)):
        members = [curve for curve in drawn if tuple(curve.parameters[name] for name in grouping.facet) == value]
        if band := _draw_behind(axes, ensembles, members, quantity, grouping):
            bands["behind"] = band
        _draw(axes, members, drawn, grouping)
        if grouping.colour in ("", "method") and not grouping.median_over:
            bands |= {curve.method: band for curve in members if (band := _draw_errors(axes, curve, quantity))}
        own = _join(_label(drawn, *parameter) for parameter in zip(grouping.facet, value, strict=True))
        style.name_panel(axes, number, len(shown), own if len(shown) > 1 else _join([own, shared]))
    _add_legend(figure, panels, _legend(drawn, grouping) + list(bands.values()))
    for axes in panels:
        axes.autoscale()
        if interface:  # a power of ten stands beside the title
            axes.yaxis.get_offset_text().set(x=-0.02, horizontalalignment="right")
    above = list(filter(None, [title, shared if len(shown) > 1 else ""]))
    figure.set_figheight(figure.get_figheight() + 0.2 * len(above))  # inches for each line
    style.set_title(figure, "\n".join(above))
    return figure, panels, extent(tables)


def _curves(tables: Sequence[Table], quantity: str, grouping: Grouping) -> list[PlottedCurve]:
    """Return all lines, in the order in which they are drawn."""
    # The estimates, from the least accurate on, then methods that are not listed, then the numerical ones on top.
    numerical = numerical_names()
    estimates = [name for name in names() if name not in numerical]
    order = {name: rank for rank, name in enumerate([*estimates, "", *numerical])}
    ranked = sorted(
        _groups(tables, grouping), key=lambda same: (order.get(same.method, order[""]), same.column("case")[0])
    )
    return [_reduced(same, quantity, grouping) for same in ranked]


def _groups(tables: Sequence[Table], grouping: Grouping) -> list[Members]:
    """Return the curves that have the same colour, panel and method."""
    shown = [name for name in (grouping.colour, *grouping.facet) if name not in ("", "method")]
    found: dict[tuple[Any, ...], Members] = {}
    for table in tables:
        keys = [table.columns[name] for name in shown] or [np.zeros(table.size)]
        code = codes(*keys)
        for column, method in enumerate(table.methods):
            rows = np.flatnonzero(table.known[:, column])
            if not rows.size:
                continue
            rows = rows[np.argsort(code[rows], kind="stable")]
            for part in np.split(rows, np.flatnonzero(np.diff(code[rows])) + 1):
                value = [values[part[0]] for values in keys]
                found.setdefault((method, *value), Members(method, [])).rows.append((table, part, column))
    return list(found.values())


def _reduced(same: Members, quantity: str, grouping: Grouping) -> PlottedCurve:
    """Return the median or mean of curves that look alike, and their band, or the single curve."""
    table, rows, column = same.rows[0]
    row = int(rows[0])
    differing = _differing(same)
    if same.size > 1 and (hidden := grouping.hidden(differing)):
        raise ValueError(grouping.proposal(hidden))
    points = bool(table.beside[row, column]) and "method" not in grouping.facet
    parameters = table.parameters(row) | {"method": same.method}
    if same.size == 1:
        loads, values = table.line(row, same.method, points)
        return PlottedCurve(table, row, same.method, loads, values, None, 1, points, parameters, ())
    loads, reduced = _reduce(same, quantity, grouping)
    band = reduced[1:]
    return PlottedCurve(table, row, same.method, loads, reduced[0], band, same.size, points, parameters, differing)


def _reduce(same: Members, quantity: str, grouping: Grouping) -> tuple[Array, Array]:
    """Return loads, and the line and both ends of the band there, shape (3, loads)."""
    loads = same.rows[0][0].loads
    values = np.concatenate([table.values[rows, column] for table, rows, column in same.rows])
    slope = np.concatenate([table.slope[rows, column] for table, rows, column in same.rows])
    if quantity != COMPLIANCE or loads.size < 2 or not np.isfinite(slope).all():
        return loads, grouping.reduce(values)
    fine = lines.between(loads)
    pieces = np.array_split(fine, math.ceil(fine.size * same.size / MAX_VALUES))
    reduced = [grouping.reduce(lines.compliance_at(piece, loads, values, slope)) for piece in pieces]
    return fine, np.concatenate(reduced, axis=1)


def _values(drawn: Iterable[PlottedCurve], name: str) -> list[Hashable]:
    """Return the distinct values of a parameter: numbers are sorted, others in order of appearance."""
    values = list(dict.fromkeys(curve.parameters[name] for curve in drawn))
    return sorted(values) if all(isinstance(value, float) for value in values) else values  # type: ignore[type-var]  # all are floats


def _label(drawn: Sequence[PlottedCurve], name: str, value: Hashable) -> str:
    """Return a value of a parameter as a legend writes it."""
    first = next(curve for curve in drawn if curve.parameters[name] == value)
    if name == "method":
        return str(style.line(first.method)["label"])
    if name in ("case", "trace"):
        return str(first.parameters["trace"]) or style.describe(first.case)
    if name in PARAMETERS:
        return "" if first.parameters["trace"] else style.describe(first.case, name)
    if isinstance(value, float):
        return rf"$\phi={value:.3g}$" if value == first.parameters["phases"] else f"seed {value:.0f}"
    return f"{_values(drawn, name).index(value) + 1}. phases" if value else ""


def _join(labels: Iterable[str]) -> str:
    return ",  ".join(filter(None, labels))


def _by_dash(drawn: Sequence[PlottedCurve], grouping: Grouping) -> bool:
    """Return whether dashes distinguish the methods, since colours and panels do not."""
    return "method" not in (grouping.colour or "method", *grouping.facet) and len(_values(drawn, "method")) > 1


def _look(curve: PlottedCurve, drawn: Sequence[PlottedCurve], grouping: Grouping) -> dict[str, Any]:
    """Return the style of a curve: that of its method, or the colour of a parameter with dashes for methods."""
    look = style.points(curve.method) if curve.points else style.line(curve.method)
    if grouping.colour in ("", "method"):
        return look
    values = _values(drawn, grouping.colour)
    own = style.family(len(values))[values.index(curve.parameters[grouping.colour])]
    if not _by_dash(drawn, grouping):
        return look | own
    return look | {"color": own["color"]} | (BELOW if look["linestyle"] == "-" else {})


def _draw(axes: Axes, members: Sequence[PlottedCurve], drawn: Sequence[PlottedCurve], grouping: Grouping) -> None:
    """Draw the lines of a panel, each with its band."""
    for curve in members:
        look = _look(curve, drawn, grouping)
        if curve.method in numerical_names():
            look["zorder"] = 1.9  # below the estimates, which are thinner than it or have gaps
        name = _join(_label(drawn, part, curve.parameters[part]) for part in (grouping.colour, "method") if part)
        axes.plot(curve.loads, curve.values, **look | {"label": name})
        if curve.band is not None:
            label = f"{name}, {grouping.band_name}"
            axes.fill_between(curve.loads, *curve.band, color=look["color"], label=label, **BAND)


def _draw_behind(
    axes: Axes, ensembles: Sequence[Table], members: Sequence[PlottedCurve], quantity: str, grouping: Grouping
) -> Patch | None:
    """Draw the band of the most accurate curves of an ensemble behind a panel; returns its legend entry."""
    drawn = {tuple(curve.parameters[name] for name in PARAMETERS) for curve in members}
    found: dict[str, Members] = {}
    for table in ensembles:
        series = zip(*(table.study[name].values.tolist() for name in PARAMETERS), strict=True)
        here = np.array([own in drawn for own in series], bool)
        for column, method in enumerate(table.methods):
            rows = np.flatnonzero(here & table.known[:, column] & (table.best == column))
            if rows.size:
                found.setdefault(method, Members(method, [])).rows.append((table, rows, column))
    entry = None
    for same in found.values():
        loads, reduced = _reduce(same, quantity, grouping)
        label = f"{grouping.band_name} of {same.size} phases"
        axes.fill_between(loads, *reduced[1:], label=label, **BEHIND)
        entry = Patch(label=label, **BEHIND)
    return entry


def _differing(same: Members) -> list[str]:
    """Return the parameters in which some curves differ; phases where they have several waves, as many each."""
    differing = [name for name in SURFACES if np.ptp(same.column(name)) > 0]
    several = same.column("waves") != 1
    phases = same.column("phases")[several]
    by_phases = "m" not in differing and phases.size > 0 and np.ptp(phases) > 0
    return differing + ["seed" if same.column("seeded").all() else "phases"] * bool(by_phases)


def _draw_errors(axes: Axes, curve: PlottedCurve, quantity: str) -> Patch | None:
    """Draw the stated errors of a method as a band; returns its legend entry, or None if the band is invisible."""
    if quantity not in QUANTITIES:
        return None
    case = curve.case
    stated, values = (curves.curve(case, name, curve.method) for name in (f"{quantity}_error", quantity))
    if stated is None or values is None:
        return None
    width = np.where(np.isfinite(stated) & (values > 0), stated, 0.0)
    of = np.where(values > 0, values, 1.0) if quantity == "resistance" else values.max()  # by its logarithmic axis
    wide = width / of >= VISIBLE[quantity]
    if not (wide[1:] & wide[:-1]).any():
        return None
    line = style.line(curve.method)
    low = np.maximum(values - width, values * np.finfo(float).eps)  # on a logarithmic axis, too
    look = STATED | {"color": line["color"], "label": f"error stated by {line['label']}"}
    axes.fill_between(case["mean_pressure"].values, low, values + width, **look)
    return Patch(**look)


def _legend(drawn: Sequence[PlottedCurve], grouping: Grouping) -> list[Any]:
    """Return legend entries for colours, dashes and bands."""
    colour, by_dash = grouping.colour or "method", _by_dash(drawn, grouping)
    values = _values(drawn, colour)
    # A legend below the panels has room for eight values of a parameter.
    shown = [values[number] for number in np.unique(np.linspace(0, len(values) - 1, 8).round().astype(int))]
    hidden = len(values) - len(shown)
    handles: list[Any] = []
    for value in shown:
        first = next(curve for curve in drawn if curve.parameters[colour] == value)
        look = _look(first, drawn, grouping)
        own = {"color": look["color"]} if by_dash else look
        handles.append(Line2D([], [], **{**own, "label": _label(drawn, colour, value), "markevery": None}))
    if hidden:
        handles.append(Line2D([], [], linestyle="none", label=f"and {hidden} more between them"))
    if by_dash:
        looks = {curve.method: _look(curve, drawn, grouping) for curve in drawn}
        handles += [Line2D([], [], **look | {"color": style.GREY, "markevery": None}) for look in looks.values()]
    if grouping.median_over:
        over = dict.fromkeys(PLURALS.get(name) or f"${style.symbol(name)}$" for name in grouping.median_over)
        counts = sorted({curve.members for curve in drawn})
        number = " to ".join(map(str, dict.fromkeys([counts[0], counts[-1]])))
        handles += [
            Line2D([], [], color=style.GREY, label=f"line: {grouping.line_name} over {' and '.join(over)}"),
            Patch(color=style.GREY, label=f"band: {grouping.band_name} of {number}", **BAND),
        ]
    return handles


def _add_legend(figure: Figure, panels: Sequence[Axes], handles: Sequence[Any]) -> None:
    """Place the legend inside a single panel if it is short, otherwise below all panels."""
    if len(panels) == 1 and len(handles) <= 6:  # longer legends would cover the curves
        panels[0].legend(handles=handles, loc="best")
        return
    columns = 2 if len(panels) == 1 else 3
    figure.set_figheight(figure.get_figheight() + style.LEGEND_ROW * -(-len(handles) // columns))
    figure.legend(handles=handles, loc="outside lower center", ncols=columns)
