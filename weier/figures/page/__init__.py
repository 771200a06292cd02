"""The page of a scene: one HTML file with an explorer of its curves, figures, claims, errors, costs and provenance.

Everything stands in that file, so that it can be read without a network. The same data give the same bytes.
"""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Iterable, Sequence
from html import escape
from pathlib import Path

import numpy as np
import xarray as xr
from bokeh.core.types import ID
from bokeh.embed import json_item
from bokeh.resources import Resources

from weier.data import dataset
from weier.data.check import Check
from weier.data.dataset import Status
from weier.data.files import write_text
from weier.data.variables import VARIABLES
from weier.figures.captions import caption
from weier.figures.page import plans
from weier.figures.page.cells import largest, significant
from weier.figures.page.explorer import MAX_CASES, curve_explorer
from weier.pipeline.claims.paper import CRITERIA
from weier.scene import Scene

ERRORS = {name: f"largest {entry.largest}" for name, entry in VARIABLES.items() if entry.largest}
NUMBERS = "numbers"  # the class of tables whose columns are numbers
EXPLORER_ID = ID("curves")
EXPLORER = f"""<div id="{EXPLORER_ID}" role="group"
aria-label="Plots of compliance and of resistance over mean pressure, with choices of case and method"></div>
<noscript><p>These curves need JavaScript. The rest of this page does not.</p></noscript>"""
STYLE = """
body { font-family: Georgia, serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; color: #111;
line-height: 1.4; } h1, h2, h3 { font-weight: normal; line-height: 1.2; }
h2 { border-bottom: 1px solid #bbb; margin-top: 2.5rem; }
.table { overflow-x: auto; }
table { border-collapse: collapse; font-size: 0.9rem; font-variant-numeric: tabular-nums; }
td, th { padding: 0.25rem 1.2rem 0.25rem 0; text-align: left; vertical-align: top; border-bottom: 1px solid #ddd; }
th { vertical-align: bottom; } td { white-space: pre-line; } .numbers :is(td, th) + :is(td, th) { text-align: right; }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(20rem, 100%), 1fr)); gap: 2rem; }
figure { margin: 0; max-width: 30rem; } figure img { width: 100%; } figcaption { font-size: 0.9rem; }
pre { background: #f4f4f4; padding: 1rem; overflow-x: auto; font-size: 0.8rem; }
"""


def write(scene: Scene, contact: Path, figures: Sequence[Path], costs: Sequence[Path], path: Path) -> None:
    """Write the page of a scene, whole or not at all.

    Parameters
    ----------
    scene : Scene
        What the figures show.
    contact : path
        The dataset of the scene.
    figures : sequence of path
        PNG files, named as the figures of the scene.
    costs : sequence of path
        Files of seconds, one for each batch.
    path : path
        The HTML file to write.
    """
    with dataset.reading(contact) as data:
        text = _page(scene, data, figures, [_cost(path) for path in costs])
    write_text(path, text)


def _cost(path: Path) -> xr.Dataset:
    cost = dataset.read(path)
    if "seconds" not in cost:
        raise ValueError(f"{path} has no seconds: take the file of costs that `weier batch` wrote")
    return cost


def _page(scene: Scene, data: xr.Dataset, figures: Sequence[Path], costs: Sequence[xr.Dataset]) -> str:
    title = escape(data.attrs.get("title", "A scene"))
    count = data.sizes["case"]
    cases = f"the first {MAX_CASES} of {count} cases" if count > MAX_CASES else f"all {count} cases"
    sections = {
        f"Curves, {cases if count > 1 else 'one case'}": EXPLORER,
        "Figures": _figures(scene, figures),
        "Claims": _claims(data),
        "Errors": _errors(data),
        "Cost": _costs(data, costs),
        **_plans(data, costs),
        "Provenance": _provenance(data),
    }
    body = "\n".join(f"<h2>{heading}</h2>\n{content}" for heading, content in sections.items())
    # Only what the explorer needs: the other parts of the library would double the file.
    library = Resources(mode="inline", components=["bokeh", "bokeh-widgets"]).render()
    item = json.dumps(json_item(curve_explorer(data.isel(case=slice(MAX_CASES)).load()), EXPLORER_ID)).replace(
        "</", "<\\/"
    )
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">\n'
        f'<meta name="viewport" content="width=device-width, initial-scale=1"><title>{title}</title>\n'
        f'<link rel="icon" href="data:,"><style>{STYLE}</style>\n{library}</head>\n'
        f"<body><h1>{title}</h1>\n<p>{escape(dataset.NORMALISED)}</p>\n{body}\n"
        f"<script>Bokeh.embed.embed_item({item})</script>\n</body></html>\n"
    )


def _figures(scene: Scene, paths: Sequence[Path]) -> str:
    if not paths:
        return "<p>This scene draws no figures.</p>"
    return f'<div class="figures">{"".join(_figure(scene, path) for path in paths)}</div>'


def _figure(scene: Scene, path: Path) -> str:
    name, text, alternative = map(escape, caption(scene, path.stem))
    picture = f"data:image/png;base64,{b64encode(path.read_bytes()).decode()}"
    return (
        f'<figure><img alt="{alternative}" src="{picture}"><figcaption><b>{name}.</b> {text}</figcaption></figure>\n'
    )


def _table(header: Iterable[str], rows: Iterable[Iterable[object]], kind: str = "words") -> str:
    """A table; all columns but the first are set to the right if they are numbers.

    In a narrow window the table scrolls by itself.
    """
    head = "".join(f'<th scope="col">{escape(cell)}</th>' for cell in header)
    lines = ("".join(f"<td>{escape(str(cell))}</td>" for cell in row) for row in rows)
    body = "".join(f"<tr>{line}</tr>\n" for line in lines)
    return f'<div class="table"><table class="{kind}"><tr>{head}</tr>{body}</table></div>'


def _claims(data: xr.Dataset) -> str:
    if "claim" not in data.variables:
        return "<p>This scene checks no claims.</p>"
    holds = [Check(number).text for number in data["claim_holds"].values.tolist()]
    columns = [data[name].values.tolist() for name in ("claim", "claim_statement", "claim_measured")]
    table = _table(["claim", "the paper says", "measured here", "holds"], zip(*columns, holds, strict=True))
    return f"{table}\n<p>{escape(CRITERIA)}</p>"


def _errors(data: xr.Dataset) -> str:
    """How many cases each method solved or did not, and the largest residual and expected errors."""
    columns = {name: heading for name, heading in ERRORS.items() if name in data and data[name].notnull().any()}
    rows = []
    for row, method in enumerate(data["solution_method"].values.tolist()):
        status = data["status"][:, row].values
        counts = [int((status == each).sum()) for each in Status]
        rows.append([method, *counts, *(largest(data[name][:, row].values) for name in columns)])
    names = [each.name.replace("_", " ") for each in Status]
    return _table(["method", *names, *columns.values()], rows, NUMBERS)


def _costs(data: xr.Dataset, costs: Sequence[xr.Dataset]) -> str:
    seconds: dict[str, list[float]] = {method: [] for method in data["solution_method"].values.tolist()}
    for cost in costs:
        for row, method in enumerate(cost["solution_method"].values.tolist()):
            known = cost["seconds"].values[:, row]
            seconds[method].extend(known[np.isfinite(known)].tolist())
    rows = [
        [method, len(times), significant(np.median(times), 2), significant(max(times), 2), significant(sum(times), 3)]
        for method, times in seconds.items()
        if times
    ]
    return _table(["method", "curves", "median, s", "longest, s", "all, s"], rows, NUMBERS)


def _plans(data: xr.Dataset, costs: Sequence[xr.Dataset]) -> dict[str, str]:
    """The section that compares plans with what came of them, where something was planned."""
    rows = plans.rows(data, costs)
    return {"Plan and cost": f"<p>{escape(plans.NOTE)}</p>{_table(plans.HEADER, rows, NUMBERS)}"} if rows else {}


def _provenance(data: xr.Dataset) -> str:
    names = ("source", "git_commit", "date_created", "comment", "history", "references", "license")
    rows = [[name, data.attrs[name]] for name in names if name in data.attrs]
    text = f'<h3>The scene</h3><pre tabindex="0">{escape(data.attrs.get("scene", ""))}</pre>'
    return _table(["attribute of the dataset", "value"], rows) + text
