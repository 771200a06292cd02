"""The picture of a condition of a claim: a dot for each profile, in the colour of its result."""

from __future__ import annotations

from typing import NamedTuple

from weier.data.variables import Check
from weier.pipeline.claims.claim import Finding, written


class Picture(NamedTuple):
    """Positions as fractions of the width, and texts.

    left, right : the range that is too close to the limit to decide
    dots : the result of each profile, its position and its value
    low, high : the values at both ends
    """

    left: float
    right: float
    dots: list[tuple[str, float, str]]
    low: str
    high: str


def picture(finding: Finding) -> Picture:
    """The values of a condition on all profiles, with its limit."""
    ends = [*finding.values, finding.met, finding.missed]
    low, high = min(ends), max(ends)
    left, right, *places = ((value - low) / (high - low) for value in (finding.met, finding.missed, *finding.values))
    says, words = (Check(check).name for check in finding.checks), (written(v, finding.unit) for v in finding.values)
    dots = list(zip(says, places, words, strict=True))
    return Picture(min(left, right), max(left, right), dots, written(low, finding.unit), written(high, finding.unit))
