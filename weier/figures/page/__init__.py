"""The page of a scene: one HTML file with an explorer of its curves, figures, claims, errors, costs and provenance.

The file is self-contained, so that it can be read without a network. The same data give the same bytes.
"""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Mapping, Sequence
from importlib.resources import files
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr
from bokeh.core.types import ID
from bokeh.embed import json_item
from bokeh.resources import Resources
from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from weier.data import dataset, provenance
from weier.data.files import write_text
from weier.data.selection import as_cases, label_text
from weier.data.variables import VARIABLES, Status
from weier.figures.captions import Caption, caption
from weier.figures.page.claims import picture
from weier.figures.page.explorer import MAX_CASES, curve_explorer
from weier.figures.page.formulae import typeset
from weier.methods import auto, bem
from weier.pipeline.claims.claim import Judgement
from weier.pipeline.claims.paper import MEANINGS, RULE
from weier.pipeline.claims.report import DETAILS, decisive_line, details, from_dataset
from weier.scene import Scene
from weier.tables import largest, significant

# Headings of the columns of errors.
ERRORS = {name: f"largest {entry.largest}" for name, entry in VARIABLES.items() if entry.largest}
PICTURES = (
    "In the pictures, a dot is a profile, and values in the grey part of the line are too close to the limit to "
    "decide."
)
IN_SI = " Figures in Pa, m and ohm m^2 are of the scene's two bodies; each trace has its own lambda_0 and g_0."
HELD_BY_CHORDS = (bem.METHOD.name, auto.METHOD.name)  # The stated error of the resistance is a bound by chords.
MIN_EXPLAINED = 0.1  # Larger stated errors, over the larger of R and 1, are explained on the page.
CHORDS = (
    "Where R comes from a grid, its stated error is a bound by chords to the other loads, since the compliance is "
    "concave and has a bound on its own error. R itself is mostly far more accurate, but has no other bound where "
    "few nodes carry a light load. The chords are least accurate there, and where the loads are far apart."
)
MAX_COLUMN = 1500  # pixels: wider figures span the page. A figure of one column has some 1050.
EXPLORER_ID = ID("curves-explorer")
# Attributes of the dataset in the section on provenance.
VERSIONS = ("product_version", "python_version", "numpy_version", "numba_version")
PROVENANCE = ("source", "git_commit", *VERSIONS, "date_created", "comment", "history", "references", "license")


class Table(NamedTuple):
    """A table; all columns but the first are aligned to the right if its kind is "numbers"."""

    header: Sequence[str]
    rows: Sequence[Sequence[object]]
    kind: str = "words"


class ShownFigure(NamedTuple):
    """A figure with its caption: the picture is embedded in the page, and spans it if it is wide."""

    anchor: str
    caption: Caption
    picture: str
    wide: bool


class Section(NamedTuple):
    """A section of the page, listed in its contents; empty parts are left out.

    anchor, heading : the name of links to it, and its title
    figures, claims : its first parts, the claims by their names
    texts, table : its further parts
    scene : the text of a scene file
    """

    anchor: str
    heading: str
    texts: Sequence[str] = ()
    figures: Sequence[ShownFigure] = ()
    claims: Mapping[str, Judgement] = {}
    table: Table | None = None
    scene: str = ""


def write(scene: Scene, contact: Path, figures: Sequence[Path], cost: xr.Dataset, path: Path, mark: str = "") -> None:
    """Write the page of a scene atomically.

    Parameters
    ----------
    scene : Scene
        The scene.
    contact : path
        The dataset of the scene.
    figures : sequence of path
        PNG files, named as the figures of the scene.
    cost : Dataset
        The seconds of each case and method.
    path : path
        The HTML file to write.
    mark : str
        What it was made of, for a comment at its end.
    """
    with dataset.reading(contact) as data:
        text = _page(scene, as_cases(data), figures, cost)
    write_text(path, f"{text}\n<!-- {mark} -->\n")


def _page(scene: Scene, data: xr.Dataset, figures: Sequence[Path], cost: xr.Dataset) -> str:
    count = data.sizes["case"]
    cases = f"the first {MAX_CASES} of {count} cases" if count > MAX_CASES else f"all {count} cases"
    # Only the components of the explorer: the others would double the size of the file.
    library = Resources(mode="inline", components=["bokeh", "bokeh-widgets"]).render()
    item = json.dumps(json_item(curve_explorer(data.isel(case=slice(MAX_CASES)).load()), EXPLORER_ID))
    environment = Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True, undefined=StrictUndefined)
    environment.filters |= {
        "formulae": typeset,
        "decisive_line": decisive_line,
        "details": details,
        "picture": picture,
    }
    return environment.from_string(_resource("page.html")).render(
        title=data.attrs.get("title", "A scene"),
        style=Markup(_resource("page.css")),
        library=Markup(library),
        item=Markup(item.replace("</", "<\\/")),
        explorer=EXPLORER_ID,
        normalised=provenance.NORMALISED + IN_SI * any(figure.interface for figure in scene.figures.values()),
        doi=provenance.DOI,
        details=DETAILS,
        sections=[
            Section("curves", f"Curves, {cases if count > 1 else 'one case'}"),
            _figures(scene, figures),
            _claims(data),
            *_traces(data),
            Section("errors", "Errors", _about_errors(data), table=_errors(data)),
            Section("cost", "Cost", table=_costs(cost)),
            _provenance(data),
        ],
    )


def _resource(name: str) -> str:
    return files("weier.figures.page").joinpath(name).read_text(encoding="utf-8")


def _figures(scene: Scene, paths: Sequence[Path]) -> Section:
    texts = [] if paths else ["This scene draws no figures."]
    return Section("figures", "Figures", texts, [_figure(path, caption(scene, path.stem)) for path in paths])


def _figure(path: Path, words: Caption) -> ShownFigure:
    png = path.read_bytes()
    width = int.from_bytes(png[16:20], "big")  # in the first part of every PNG file
    return ShownFigure(path.stem, words, f"data:image/png;base64,{b64encode(png).decode()}", width > MAX_COLUMN)


def _claims(data: xr.Dataset) -> Section:
    judged = from_dataset(data)
    texts = [RULE, PICTURES, MEANINGS] if judged else ["This scene checks no claims."]
    return Section("claims", "Claims", texts, claims=judged)


def _traces(data: xr.Dataset) -> list[Section]:
    """The section on the traces, if there are any, with the units of their curves."""
    columns = [name for name, entry in VARIABLES.items() if name in data.variables and name.startswith("trace")]
    header = [f"{VARIABLES[name].long_name}{', m' * (VARIABLES[name].unit == 'm')}" for name in columns]
    rows = zip(*([label_text(value) for value in data[name].values.tolist()] for name in columns), strict=True)
    known = [row for row in dict.fromkeys(rows) if any(row)]
    return [Section("traces", "Measured heights", table=Table(header, known))] if known else []


def _errors(data: xr.Dataset) -> Table:
    """The numbers of cases by status for each variant of a method, and the largest residuals and stated errors."""
    columns = {name: heading for name, heading in ERRORS.items() if name in data and data[name].notnull().any()}
    states = [state for state in Status if state != Status.not_requested]
    rows = []
    for row, method in enumerate(data["solution_method"].values.tolist()):
        for variant, cases in _variants(data, row, method).items():
            status = data["status"].values[cases, row]
            counts = [int((status == state).sum()) for state in states]
            rows.append([variant, *counts, *(largest(data[name].values[cases, row]) for name in columns)])
    return Table(["method", *(state.name.replace("_", " ") for state in states), *columns.values()], rows, "numbers")


def _about_errors(data: xr.Dataset) -> list[str]:
    """An explanation of the largest stated error of the resistance, if it is a large bound by chords."""
    among = [name for name in HELD_BY_CHORDS if name in data["solution_method"].values]
    if not among or "resistance_error" not in data:
        return []
    error, resistance = (data[name].sel(solution_method=among).values for name in ("resistance_error", "resistance"))
    relative = error / np.fmax(resistance, 1)
    known = np.isfinite(relative)
    if not known.any() or relative[known].max() < MIN_EXPLAINED:
        return []
    case, row, load = np.unravel_index(np.where(known, error, -1).argmax(), error.shape)
    where = f"{data['mean_pressure'].values[load]:.3g} p_0*, where R is {resistance[case, row, load]:.3g}"
    return [
        f"{CHORDS} Here {among[row]} states the largest, {error[case, row, load]:.2g} g_0/p_0*, at {where}; at half "
        f"of all loads it is at most {np.median(relative[known]):.2g} of the larger of R and 1 g_0/p_0*."
    ]


def _variants(data: xr.Dataset, row: int, method: str) -> dict[str, list[int]]:
    """The cases of a method, by its name with those of its settings that differ between cases."""
    names = [str(name) for name in data.coords if str(name).startswith(f"{method}_") and data[name].dims == ("case",)]
    settings = {name.removeprefix(f"{method}_").replace("_", " "): data[name].values.tolist() for name in names}
    found: dict[str, list[int]] = {}
    for case in np.flatnonzero(data["status"].values[:, row] != Status.not_requested).tolist():
        own = [f"{name} {text}" for name, values in settings.items() if (text := label_text(values[case]))]
        found.setdefault(", ".join([method, *own]), []).append(case)
    return found


def _costs(cost: xr.Dataset) -> Table:
    methods, seconds = cost["solution_method"].values.tolist(), cost["seconds"].values.T
    known = {method: own[np.isfinite(own)] for method, own in zip(methods, seconds, strict=True)}
    summaries = (np.median, 2), (np.max, 2), (np.sum, 3)
    rows = [
        [method, len(times), *(significant(summary(times), count) for summary, count in summaries)]
        for method, times in known.items()
        if times.size
    ]
    return Table(["method", "curves", "median, s", "longest, s", "all, s"], rows, "numbers")


def _provenance(data: xr.Dataset) -> Section:
    rows = [[name, data.attrs[name]] for name in PROVENANCE if name in data.attrs]
    table = Table(["attribute of the dataset", "value"], rows)
    return Section("provenance", "Provenance", table=table, scene=data.attrs.get("scene", ""))
