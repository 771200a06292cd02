"""The claims of a scene in its dataset and as a text, with a table of all claims and a section for each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from weier.data.markdown import plain, significant, table
from weier.data.variables import Check, flags
from weier.pipeline.claims.claim import Finding, Judgement
from weier.pipeline.claims.paper import MEANINGS, RULE

if TYPE_CHECKING:
    import xarray as xr

CONTENT = "qualityInformation"  # Kind of content of claims in the terms of ISO 19115.
DETAILS = ("quantity", "profiles", "measured", "between", "limit", "results", "holds")
VOTES = {Check.yes: "say yes", Check.no: "say no", Check.not_decided: "too close to call"}  # checks of members


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


def decisive_line(judged: Judgement) -> str:
    """Return the decisive number, its limit and the results of the profiles in one line."""
    if judged.missing:
        return f"Not measured: {judged.missing}."
    quantity, _, value, _, limit, votes, _ = details(judged.decisive)
    return "; ".join(filter(None, [f"{quantity[:1].upper()}{quantity[1:]}: {value}", f"limit: {limit}", votes]))


def details(finding: Finding) -> list[str]:
    """Return a row of DETAILS."""
    number, values = finding.number, finding.values
    value, limit, low, high = (
        _written(value, number.unit) for value in (number.value, number.limit, min(values), max(values))
    )
    return [
        number.quantity,
        finding.ensemble.name,
        value,
        f"{low} and {high}" if len(values) > 1 else "",
        f"{number.word} {limit}",
        _votes(finding.checks),
        finding.outcome.text,
    ]


def _written(value: float, unit: str) -> str:
    """Return a value in its unit, with two digits."""
    if value == 0:
        return "0"
    return f"{significant(100 * value, 2)} %" if unit == "%" else f"{significant(value, 2)} {unit}".rstrip()


def _votes(checks: Sequence[Check]) -> str:
    """Return the numbers of members by their results, in words."""
    if len(checks) == 1:
        return VOTES[Check.not_decided] * (Check.not_decided in checks)
    counts = [(checks.count(check), words) for check, words in VOTES.items() if check in checks]
    (first, words), *others = counts
    return ", ".join([f"{first} of {len(checks)} {words}", *(f"{count} {words}" for count, words in others)])


def to_markdown(title: str, judged: Mapping[str, Judgement]) -> str:
    """Return a table with a line for each claim, the rule, and a section for each claim."""
    if not judged:
        return f"# {title}\n\nThis scene checks no claims.\n"
    rows = [
        [f"[{plain(name)}](#{name})", plain(one.statement), one.outcome.text, plain(decisive_line(one))]
        for name, one in judged.items()
    ]
    head = ["claim", "the paper says", "holds", "what decides"]
    parts = [f"# {title}", table(head, rows), "## How claims are judged", plain(RULE), plain(MEANINGS)]
    for name, one in judged.items():
        rows = [list(map(plain, details(finding))) for finding in one.findings]
        parts += [f"## {name}", plain(one.statement), table(DETAILS, rows) if rows else decisive_line(one)]
    return "\n\n".join(parts) + "\n"
