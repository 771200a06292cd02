"""The explorer of a scene: one HTML file with the curves of its cases and methods.

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
from weier.pipeline.gather import read_cases
from weier.pipeline.needed_curves import Curves
from weier.units import unit_of

MAX_CASES = 1000  # With errors, this many cases at 40 loads by four methods take 4 MB of the page.
EXPLORER_ID = ID("curves-explorer")
HIDING = "A click on a name in a legend hides its curve."
IN_SI = "Pressures are in {}, compliance in m and resistance in {}, for the two bodies of the scene."


def write(curves: Curves, path: Path) -> None:
    """Write the explorer of a scene atomically, in SI units if the scene has an interface."""
    scene, count = curves.scene, len(curves.scene.distinct)
    shown = np.unique(np.linspace(0, count - 1, min(count, MAX_CASES)).round().astype(int))
    write_text(path, render(read_cases(curves, shown, (*UNDRAWN, *UNGROUPED)), scene.title, count, scene.interface))


def render(data: xr.Dataset, title: str, count: int, interface: Bodies | None = None) -> str:
    """Return the explorer of a selection of `count` cases as HTML."""
    shown = data.sizes["case"]
    cases = f"This page has all {count} cases." if count > 1 else "This page has one case."
    if shown < count:
        cases = f"This page has {shown} of {count} cases, evenly spread; the figures and contact.nc have all."
    # Includes only the components in use; all of them would double the file size.
    library = Resources(mode="inline", components=["bokeh", "bokeh-widgets"]).render()
    item = json.dumps(json_item(curve_explorer(data, interface), EXPLORER_ID))
    environment = Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True, undefined=StrictUndefined)
    template = files("weier.figures.page").joinpath("page.html").read_text(encoding="utf-8")
    return environment.from_string(template).render(
        title=title,
        library=Markup(library),
        item=Markup(item.replace("</", "<\\/")),
        explorer=EXPLORER_ID,
        texts=[
            cases,
            IN_SI.format(unit_of(data["mean_pressure"]), interface.resistance_unit)
            if interface
            else provenance.NORMALISED,
            HIDING,
        ],
    )
