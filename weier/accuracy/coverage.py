"""Coverage of stated errors on families of hard series."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import click
import numpy as np

from weier.accuracy.families import FAMILIES, VARIANTS, Draw, draws
from weier.accuracy.measurement import measurement
from weier.accuracy.reference import contact_reference, deviation
from weier.accuracy.runner import attempt
from weier.data import markdown
from weier.kernels.arrays import Array


class Judged(NamedTuple):
    """Errors of a named variant on a draw, measured and stated; each of shape (2, loads): h and R.

    error : in g_0 and g_0/p_0*; NaN where the method finds no solution
    stated : compliance_error and resistance_error
    ratio : error over stated, minus the uncertainty of the reference; NaN if that is too coarse
    message : message of the first refusal
    """

    draw: Draw
    name: str
    error: Array
    stated: Array
    ratio: Array
    message: str


def judge(draw: Draw, name: str) -> Judged:
    """Compare a variant with the exact curve, load by load if it refuses the curve; NaN at loads that it refuses."""
    found = attempt(draw.variants[name], draw.profile, draw.loads)
    right = contact_reference(draw.profile, tuple(draw.loads.tolist()))
    error, stated = deviation(found.values, right.values), found.stated
    # The reference must be ten times as accurate as the stated or the measured error.
    is_known = 10 * right.uncertainty <= np.maximum(stated, error)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(is_known, np.maximum(error - right.uncertainty, 0) / stated, np.nan)
    return Judged(draw, name, error, stated, ratio, found.message)


def tables(found: Sequence[Judged]) -> Iterator[str]:
    """Yield a table with a row for each family and one for all, the worst errors, and the refusals."""
    names = list(dict.fromkeys(one.name for one in found))
    header = ["family", "loads", *(f"{symbol} by {name}" for name in names for symbol in "hR"), "no solution"]
    rows = []
    for family in [*dict.fromkeys(one.draw.family for one in found), "all"]:
        own = [one for one in found if family in (one.draw.family, "all")]
        by_name = ([one.ratio for one in own if one.name == name] for name in names)
        loads = sum(one.draw.loads.size for one in own if one.name == names[0])
        cells = [_coverage(ratio) for ratios in by_name for ratio in np.concatenate(ratios, axis=1)]
        rows.append([family, str(loads), *cells, str(sum(int(np.isnan(one.stated[0]).sum()) for one in own))])
    yield markdown.table(header, rows)
    for one in found:
        yield from exceeded(one)
        if np.isnan(one.stated[0]).any():
            yield f"{one.draw.profile!r} by {one.name}, {one.draw.variants[one.name].settings}: {one.message}"


def _coverage(ratio: Array) -> str:
    """Return how many known errors exceed the stated ones, and the largest ratio."""
    ratio = ratio[~np.isnan(ratio)]
    return f"{np.count_nonzero(ratio > 1)} of {ratio.size}, {ratio.max(initial=0):.2g}"


def exceeded(one: Judged) -> Iterator[str]:
    """Yield a line for each error larger than stated."""
    for quantity, load in np.argwhere(one.ratio > 1):
        error, stated = (f"{values[quantity, load]:.2e}" for values in (one.error, one.stated))
        yield (
            f"{'hR'[quantity]} by {one.name} is off by {error}, stated {stated} ({one.draw.family}): "
            f"{one.draw.profile!r} at {one.draw.loads[load]}, {one.draw.variants[one.name].settings}"
        )


@measurement("Coverage of stated errors")
@click.option("--count", default=6000, help="Loads that are compared.")
@click.option("--seed", default=1, help="Seed of the draws.")
@click.option(
    "--families", multiple=True, type=click.Choice(FAMILIES), default=FAMILIES, help="Families to draw from."
)
@click.option("--methods", multiple=True, type=click.Choice(VARIANTS), default=VARIANTS, help="Methods to compare.")
def main(count: int, seed: int, families: Sequence[str], methods: Sequence[str]) -> list[str]:
    """Compare stated with true errors on families of hard series.

    A cell has the number of errors above the stated one, the number of comparisons, and the largest ratio of error to
    stated error. The reference is contact patches at a tolerance of 1e-12 on the profile shifted along x. Its
    uncertainty is the distance from the reflected profile. A number is compared if the uncertainty is below a tenth
    of the stated or the measured error.
    """
    random = np.random.default_rng(seed)
    return [*tables([judge(draw, name) for draw in draws(families, random, count) for name in methods])]
