"""The claims of a scene: measured, written into its dataset, and as a table to read."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from weier.data import dataset, markdown
from weier.data.check import Check
from weier.data.files import write_text
from weier.data.variables import flags
from weier.pipeline import curves
from weier.pipeline.claims import measures
from weier.pipeline.claims.measures import Measured
from weier.pipeline.claims.paper import CLAIMS
from weier.pipeline.claims.readings import MissingError
from weier.pipeline.gather import gather, keys_of
from weier.scene import Scene

__all__ = ["CLAIMS", "Measured", "evaluate", "write"]

CONTENT = "qualityInformation"  # what a claim is, in the words of ISO 19115


def write(scene: Scene, studies: Mapping[str, Path], path: str | Path, table: str | Path) -> None:
    """Evaluate the claims of a scene; write its whole dataset with them, and a Markdown table of them.

    Parameters
    ----------
    scene : Scene
        Names the claims, and the studies each looks at.
    studies : mapping of path
        The files of all studies of the scene by name.
    path, table : path
        The netCDF file and the Markdown file to write.

    Raises
    ------
    ValueError
        If the scene names a claim that is not in CLAIMS.

    """
    # Only the studies of one claim at a time: a sweep that no claim looks at is never in memory.
    found = {
        name: evaluate(name, [dataset.read(studies[study]) for study in wanted])
        for name, wanted in scene.claims.items()
    }
    files = list(studies.values())
    step = "checked against the paper" if found else "gathered"
    gather(files, keys_of(files), path, scene.title, step=step, scene=scene.text, more=_columns(found))
    write_text(table, _markdown(scene.title, found))


def evaluate(name: str, studies: Sequence[xr.Dataset]) -> Measured:
    """What a claim measures on these studies; where they lack what it is about, a text that says so.

    Raises
    ------
    ValueError
        If there is no claim of this name.

    """
    if name not in CLAIMS:
        raise ValueError(f"there is no claim {name!r}: choose from {', '.join(CLAIMS)}")
    try:
        return CLAIMS[name].measure(curves.cases(studies))
    except MissingError as error:
        return Measured(f"Not measured: {error}.")


def _columns(found: Mapping[str, Measured]) -> xr.Dataset:
    """The claims as variables over the dimension claim; nothing where there are none."""
    if not found:
        return xr.Dataset()
    claims = [CLAIMS[name] for name in found]
    columns = {
        "claim": (list(found), "claim of the paper"),
        "claim_statement": ([claim.statement for claim in claims], "what the paper says"),
        "claim_measured": ([measured.text for measured in found.values()], "what is measured here"),
        "claim_quantity": ([claim.quantity for claim in claims], "quantity measured for the claim"),
        "claim_paper_value": ([claim.paper_value for claim in claims], "value of the quantity in the paper"),
        "claim_measured_value": ([measured.value for measured in found.values()], "value of the quantity here"),
        "claim_holds": (
            np.array([Check.of(measured.holds) for measured in found.values()], "i1"),
            "whether the statement of the paper fits what is measured here",
        ),
    }
    variables = {
        name: xr.Variable("claim", values, {"long_name": long_name, "units": "1", "coverage_content_type": CONTENT})
        for name, (values, long_name) in columns.items()
    }
    variables["claim_holds"].attrs |= flags(Check)
    return xr.Dataset(variables).set_coords("claim")


def _markdown(title: str, found: Mapping[str, Measured]) -> str:
    if not found:
        return f"# {title}\n\nThis scene checks no claims.\n"
    rows = [
        [
            *map(markdown.plain, (name, CLAIMS[name].statement, measured.text)),
            Check.of(measured.holds).text,
        ]
        for name, measured in found.items()
    ]
    table = markdown.table(["claim", "the paper says", "measured here", "holds"], rows)
    return "\n".join([f"# {title}", "", table, "", measures.CRITERIA, ""])
