"""The claims of a scene: measured, written into its dataset, and as a table to read."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from weier.data import markdown
from weier.data.check import Check
from weier.data.files import write_text
from weier.data.variables import flags
from weier.pipeline import curves
from weier.pipeline.batches import Solutions
from weier.pipeline.claims.claim import CLAIMS, Claim, Measured
from weier.pipeline.claims.paper import CRITERIA
from weier.pipeline.claims.readings import MissingError
from weier.scene import Mistake, Scene
from weier.theory.arguments import suggestion

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["CLAIMS", "Claim", "Measured", "check_names", "evaluate", "write"]

CONTENT = "qualityInformation"  # what a claim is, in the words of ISO 19115


def check_names(scene: Scene) -> Iterator[Mistake]:
    """The claims of a scene that are not in CLAIMS."""
    return (Mistake(("claims", name), _unknown(name)) for name in scene.claims if name not in CLAIMS)


def _unknown(name: str) -> str:
    return f"there is no claim {name!r}, only {', '.join(CLAIMS)}{suggestion(name, CLAIMS)}"


def write(solutions: Solutions, path: str | Path, table: str | Path) -> None:
    """Evaluate the claims of a scene; write its whole dataset with them, and a Markdown table of them.

    Parameters
    ----------
    solutions : Solutions
        Of the scene, which names the claims and the studies each looks at.
    path, table : path
        The netCDF file and the Markdown file to write.

    Raises
    ------
    ValueError
        If the scene names a claim that is not in CLAIMS.

    """
    from weier.pipeline.gather import gather, read_study  # xarray, which the names of claims do without

    # Only the studies that claims look at are ever in memory, each read once.
    study = cache(partial(read_study, solutions))
    measured = {
        name: evaluate(name, [study(each) for each in names]) for name, names in solutions.scene.claims.items()
    }
    gather(solutions, path, "checked against the paper" if measured else "gathered", _columns(measured))
    write_text(table, _markdown(solutions.scene.title, measured))


def evaluate(name: str, studies: Sequence[xr.Dataset]) -> Measured:
    """What a claim measures on these studies, or a text that says what they lack for it."""
    if name not in CLAIMS:
        raise ValueError(_unknown(name))
    try:
        return CLAIMS[name].measure(_distinct(curves.cases(studies)))
    except MissingError as error:
        return Measured(f"Not measured: {error}.")


def _distinct(cases: Sequence[xr.Dataset]) -> list[xr.Dataset]:
    """Each case once: it may stand in several studies, and would count twice."""
    return list({str(case["key"].values): case for case in cases}.values())


def _columns(measured: Mapping[str, Measured]) -> xr.Dataset:
    """The claims as variables over the dimension claim; an empty dataset if there are none."""
    import xarray as xr

    if not measured:
        return xr.Dataset()
    claims = [CLAIMS[name] for name in measured]
    columns = {
        "claim": (list(measured), "claim of the paper"),
        "claim_statement": ([claim.statement for claim in claims], "what the paper says"),
        "claim_measured": ([each.text for each in measured.values()], "what is measured here"),
        "claim_reason": (
            [each.reason for each in measured.values()], "why the statement does not hold or is not decided"
        ),
        "claim_quantity": ([claim.quantity for claim in claims], "quantity measured for the claim"),
        "claim_paper_value": ([claim.paper_value for claim in claims], "value of the quantity in the paper"),
        "claim_measured_value": (
            [each.value for each in measured.values()], "value of the quantity here, as the mean over all phases"
        ),
        "claim_spread": (
            [each.spread for each in measured.values()], "standard deviation of the quantity over all phases"
        ),
        "claim_members": (
            np.array([each.members for each in measured.values()], "i4"), "profiles of different phases measured"
        ),
        "claim_holds": (
            np.array([each.outcome for each in measured.values()], "i1"),
            "whether the statement of the paper fits what is measured here",
        ),
    }  # fmt: skip
    variables = {
        name: xr.Variable("claim", values, {"long_name": long_name, "units": "1", "coverage_content_type": CONTENT})
        for name, (values, long_name) in columns.items()
    }
    variables["claim_holds"].attrs |= flags(Check)
    return xr.Dataset(variables).set_coords("claim")


def _words(measured: Measured) -> str:
    """The numbers and the reasons, each line one of the cell of a table."""
    return "<br>".join(map(markdown.plain, [*measured.text.splitlines(), *measured.reason.splitlines()]))


def _markdown(title: str, measured: Mapping[str, Measured]) -> str:
    if not measured:
        return f"# {title}\n\nThis scene checks no claims.\n"
    rows = [
        [*map(markdown.plain, (name, CLAIMS[name].statement)), _words(each), each.outcome.text]
        for name, each in measured.items()
    ]
    table = markdown.table(["claim", "the paper says", "measured here", "holds"], rows)
    return "\n".join([f"# {title}", "", table, "", CRITERIA, ""])
