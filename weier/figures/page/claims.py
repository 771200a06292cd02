"""What the picture of a claim's condition shows: a dot for each profile, in the colour of what it says."""

from __future__ import annotations

from typing import NamedTuple

from weier.data.variables import Check
from weier.pipeline.claims.claim import Finding, written


class Picture(NamedTuple):
    """Places as shares of the width, and words.

    left, right : the part that is too close to the limit to be called
    dots : what each profile says, its place and its value
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
