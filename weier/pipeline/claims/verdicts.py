"""The claims of a scene in its dataset and as a text, with a table of all claims and a section for each."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from weier.data import markdown
from weier.data.variables import Check, flags
from weier.pipeline.claims.claim import Finding, Judgement, written
from weier.pipeline.claims.paper import MEANINGS, RULE

if TYPE_CHECKING:
    import xarray as xr

CONTENT = "qualityInformation"  # Kind of content of claims in the terms of ISO 19115.
DETAILS = ("quantity", "profiles", "measured", "between", "limit", "results", "holds")


def to_dataset(judged: Mapping[str, Judgement]) -> xr.Dataset:
    """Return the claims as variables over the dimension claim; an empty dataset if there are none."""
    import xarray as xr

    if not judged:
        return xr.Dataset()
    columns = {
        "claim": (list(judged), "claim of the paper"),
        "claim_statement": ([one.statement for one in judged.values()], "what the paper says"),
        "claim_measured": (
            [decisive_line(one) for one in judged.values()],
            "what decides whether it holds, and its limit",
        ),
        "claim_holds": (
            np.array([one.outcome for one in judged.values()], "i1"),
            "whether it fits what is measured here",
        ),
    }
    variables = {
        name: xr.Variable("claim", values, {"long_name": long_name, "coverage_content_type": CONTENT})
        for name, (values, long_name) in columns.items()
    }
    variables["claim_holds"].attrs |= flags(Check)
    return xr.Dataset(variables).set_coords("claim")


def decisive_cells(judged: Judgement) -> tuple[str, str, str]:
    """Return the decisive number, its limit, and the results of the profiles."""
    if judged.missing:
        return f"Not measured: {judged.missing}.", "", ""
    finding = judged.decisive
    quantity = finding.condition.quantity
    text = f"{quantity[:1].upper()}{quantity[1:]}: {written(finding.value, finding.condition.unit)}"
    return text, finding.limit, finding.votes


def decisive_line(judged: Judgement) -> str:
    """Return the decisive number, its limit and the results of the profiles in one line."""
    number, limit, votes = decisive_cells(judged)
    return "; ".join(filter(None, [number, limit and f"limit: {limit}", votes]))


def details(finding: Finding) -> list[str]:
    """Return a row of DETAILS."""
    condition = finding.condition
    value, low, high = (
        written(value, condition.unit) for value in (finding.value, min(finding.values), max(finding.values))
    )
    return [
        condition.quantity,
        finding.ensemble.name,
        value,
        f"{low} and {high}" if len(finding.values) > 1 else "",
        finding.limit,
        finding.votes,
        finding.outcome.text,
    ]


def to_markdown(title: str, judged: Mapping[str, Judgement]) -> str:
    """Return a table with a line for each claim, the rule, and a section for each claim."""
    if not judged:
        return f"# {title}\n\nThis scene checks no claims.\n"
    rows = [
        [
            f"[{markdown.plain(name)}](#{name})",
            *map(markdown.plain, (judgement.statement, judgement.outcome.text, *decisive_cells(judgement))),
        ]
        for name, judgement in judged.items()
    ]
    head = ["claim", "the paper says", "holds", "what decides", "limit", "profiles"]
    parts = [
        f"# {title}",
        markdown.table(head, rows),
        "## How claims are judged",
        markdown.plain(RULE),
        markdown.plain(MEANINGS),
    ]
    for name, judgement in judged.items():
        parts += [f"## {name}", markdown.plain(judgement.statement)]
        table = [[markdown.plain(cell) for cell in details(finding)] for finding in judgement.findings]
        parts.append(markdown.table(DETAILS, table) if table else decisive_line(judgement))
    return "\n\n".join(parts) + "\n"
