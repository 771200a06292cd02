"""The explorer of a scene: one HTML file with the curves of all its cases, methods and ensembles.

The file is self-contained, so that it can be read without a network; `snakemake --report` includes it with figures
and claims. The same data give the same bytes.
"""

from __future__ import annotations

import json
from importlib.resources import files
from pathlib import Path

import xarray as xr
from bokeh.core.types import ID
from bokeh.embed import json_item
from bokeh.resources import Resources
from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from weier.data import dataset, provenance
from weier.data.bodies import Bodies
from weier.data.files import write_text
from weier.data.selection import as_cases
from weier.figures.page.explorer import MAX_CASES, curve_explorer
from weier.scene import Scene

EXPLORER_ID = ID("curves-explorer")
IN_SI = "Pressures are in Pa, compliance in m and resistance in ohm m^2, for the two bodies of the scene."
VALUES = "The values of each figure are available as comma-separated values."
MEDIANS = "The median of phases has the largest stated error of its curves."


def write(scene: Scene, contact: Path, path: Path, mark: str = "") -> None:
    """Write the explorer of a scene atomically.

    Parameters
    ----------
    scene : Scene
        The scene; with an interface, its curves are shown in SI units.
    contact : path
        The dataset of the scene.
    path : path
        The HTML file to write.
    mark : str
        Digest of its inputs, for a comment at its end.
    """
    with dataset.reading(contact) as data:
        text = _page(as_cases(data), scene.interface)
    write_text(path, f"{text}\n<!-- {mark} -->\n")


def _page(data: xr.Dataset, interface: Bodies | None) -> str:
    count = data.sizes["case"]
    cases = f"The first {MAX_CASES} of {count} cases" if count > MAX_CASES else f"All {count} cases"
    # Only the components of the explorer: the others would double the size of the file.
    library = Resources(mode="inline", components=["bokeh", "bokeh-widgets"]).render()
    shown = curve_explorer(data.isel(case=slice(MAX_CASES)).load(), interface)
    item = json.dumps(json_item(shown, EXPLORER_ID))
    environment = Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True, undefined=StrictUndefined)
    return environment.from_string(_resource("page.html")).render(
        title=data.attrs.get("title", "A scene"),
        style=Markup(_resource("page.css")),
        library=Markup(library),
        item=Markup(item.replace("</", "<\\/")),
        explorer=EXPLORER_ID,
        texts=[cases if count > 1 else "One case", IN_SI if interface else provenance.NORMALISED, MEDIANS, VALUES],
    )


def _resource(name: str) -> str:
    return files("weier.figures.page").joinpath(name).read_text(encoding="utf-8")
