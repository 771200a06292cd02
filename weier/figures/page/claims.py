"""The claims of a page: a line each, with a table of the conditions and pictures of the profiles folded below."""

from __future__ import annotations

from typing import NamedTuple

import xarray as xr
from markupsafe import Markup

from weier.data.check import Check
from weier.pipeline.claims.claim import Finding, written
from weier.pipeline.claims.report import DETAILS, decisive_line, details, from_dataset

WIDTH, HEIGHT, MARGIN = 420, 44, 12  # of a picture, in pixels


class Picture(NamedTuple):
    """A picture of the values on all profiles, with the words below it."""

    words: str
    drawing: Markup


class ShownClaim(NamedTuple):
    """A claim as the page holds it: what decides in one line, and the rows of its table."""

    name: str
    statement: str
    outcome: Check
    decisive: str
    rows: list[list[str]]
    pictures: list[Picture]
    head: tuple[str, ...] = DETAILS


def list_claims(data: xr.Dataset) -> list[ShownClaim]:
    """The claims of a dataset, in its order."""
    return [
        ShownClaim(
            name, each.statement, each.outcome, decisive_line(each), list(map(details, each.findings)),
            [_picture(finding) for finding in each.findings if len(set(finding.checks)) > 1],
        )
        for name, each in from_dataset(data).items()
    ]  # fmt: skip


def _picture(finding: Finding) -> Picture:
    """A dot for each profile, in the colour of what it says, on a line with the limit; a grey part is too close."""
    ends = [*finding.values, finding.met, finding.missed]
    low, high = min(ends), max(ends)

    def at(value: float) -> float:
        return MARGIN + (WIDTH - 2 * MARGIN) * (value - low) / (high - low)

    left, right = sorted((at(finding.met), at(finding.missed)))
    middle = HEIGHT / 3
    dots = Markup("").join(
        Markup('<circle class="{}" cx="{:.1f}" cy="{:.1f}" r="4"><title>{}</title></circle>').format(
            Check(check).name, at(value), middle, written(value, finding.unit)
        )
        for value, check in zip(finding.values, finding.checks, strict=True)
    )
    drawing = Markup(
        '<svg viewBox="0 0 {0} {1}" width="{0}" role="img" aria-label="{2}">'
        '<rect x="{3:.1f}" y="0" width="{4:.1f}" height="{5:.1f}"/><path d="M{6} {7:.1f}H{8}"/>{9}'
        '<text x="{6}" y="{1}">{10}</text><text x="{8}" y="{1}" text-anchor="end">{11}</text></svg>'
    ).format(
        WIDTH, HEIGHT, finding.votes, left, max(right - left, 1), 2 * middle, MARGIN, middle, WIDTH - MARGIN, dots,
        written(low, finding.unit), written(high, finding.unit),
    )  # fmt: skip
    return Picture(f"{finding.quantity}, {finding.ensemble}: {finding.limit}; {finding.votes}", drawing)
