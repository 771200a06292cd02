"""The explorer of a scene: one HTML file with the curves of its cases, methods and ensembles.

The file is self-contained, so that it can be read without a network; `snakemake --report` includes it with figures
and claims. The same data give the same bytes. Of a scene of more than MAX_CASES cases it shows a selection.
"""

from __future__ import annotations

import json
from importlib.resources import files
from pathlib import Path

import numpy as np
import xarray as xr
from bokeh.core.types import ID
from bokeh.embed import json_item
from bokeh.resources import Resources
from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from weier.data import provenance
from weier.data.bodies import Bodies
from weier.data.files import write_text
from weier.figures import UNDRAWN, UNGROUPED
from weier.figures.page.explorer import curve_explorer
from weier.kernels.arrays import Flags, Indices
from weier.pipeline.curves import Curves
from weier.pipeline.gather import read_cases
from weier.scene import Scene
from weier.scene.study import SEEDS, CaseProduct
from weier.units import unit_of

MAX_CASES = 1000  # As many cases of 40 loads by four methods take 4 MB of the page, with their errors.
EXPLORER_ID = ID("curves-explorer")
IN_SI = "Pressures are in {}, compliance in m and resistance in ohm m^2, for the two bodies of the scene."
MEDIANS = "The median of phases has the largest stated error of its curves."
SELECTED = (
    "{} of {} cases: of each series as many phases, evenly spread over the scene. Medians are over the cases of this "
    "page; the figures and contact.nc have all."
)


def write(curves: Curves, path: Path) -> None:
    """Write the explorer of a scene atomically.

    Parameters
    ----------
    curves : Curves
        The curves of the scene; with an interface, they are shown in SI units.
    path : path
        The HTML file to write.
    """
    scene = curves.scene
    data = read_cases(curves, shown_cases(scene), (*UNDRAWN, *UNGROUPED))
    write_text(path, render(data, scene.title, len(scene.distinct), scene.interface))


def shown_cases(scene: Scene, most: int = MAX_CASES) -> Indices:
    """Return the numbers of at most this many cases: evenly spread series, and of each one evenly spread phases."""
    parts = [np.empty(0, int)]
    for number, product in enumerate(scene.products):
        positions = scene.position_in_product[scene.product_of_cases == number]
        parts.append(max(parts[-1], default=-1) + 1 + _series(product, positions))
    series = np.unique(np.concatenate(parts), return_inverse=True)[1]
    size = np.bincount(series)
    order = np.argsort(series, kind="stable")
    place = np.empty_like(order)  # of each case in its series
    place[order] = np.arange(order.size) - (np.cumsum(size) - size)[series[order]]
    chosen = _evenly(np.arange(size.size), size.size, most)
    of_each = next(each for each in range(most, 0, -1) if np.minimum(size[chosen], each).sum() <= most)
    return np.flatnonzero(chosen[series] & _evenly(place, size[series], of_each))


def _series(product: CaseProduct, positions: Indices) -> Indices:
    """Return a number for each case of a product, the same for those that differ in their phases alone."""
    axes = {name: len(values) for name, values in product.axes.items()}
    places = zip(axes.items(), np.unravel_index(positions, list(axes.values())), strict=True)
    series = np.zeros(len(positions), int)
    for (name, length), place in places:
        series = series if name in SEEDS else series * length + place
    return series


def _evenly(number: Indices, count: Indices | int, few: int) -> Flags:
    """Return whether each of these numbers below `count` is one of a few that are evenly spread, 0 among them."""
    chosen: Flags = number * few // count > (number - 1) * few // count
    return chosen


def render(data: xr.Dataset, title: str, count: int, interface: Bodies | None = None) -> str:
    """Return the explorer of some of this number of cases as HTML."""
    shown = data.sizes["case"]
    cases = SELECTED.format(shown, count) if shown < count else f"All {count} cases" if count > 1 else "One case"
    # Only the components of the explorer: the others would double the size of the file.
    library = Resources(mode="inline", components=["bokeh", "bokeh-widgets"]).render()
    item = json.dumps(json_item(curve_explorer(data, interface), EXPLORER_ID))
    environment = Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True, undefined=StrictUndefined)
    return environment.from_string(_resource("page.html")).render(
        title=title,
        style=Markup(_resource("page.css")),
        library=Markup(library),
        item=Markup(item.replace("</", "<\\/")),
        explorer=EXPLORER_ID,
        texts=[cases, IN_SI.format(unit_of(data["mean_pressure"])) if interface else provenance.NORMALISED, MEDIANS],
    )


def _resource(name: str) -> str:
    return files("weier.figures.page").joinpath(name).read_text(encoding="utf-8")
