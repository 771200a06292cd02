"""Coverage of stated errors on families of hard series."""

from __future__ import annotations

import secrets
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

import click
import numpy as np

from weier.accuracy.families import FAMILIES, VARIANTS, Draw, draws
from weier.accuracy.page import Page, measurement
from weier.accuracy.reference import contact_reference, deviation
from weier.accuracy.runner import Variant, attempt
from weier.data import markdown
from weier.kernels.arrays import Array


class Judged(NamedTuple):
    """Errors of a variant on a draw, measured and stated; each of shape (2, loads): h and R.

    error : in g_0 and g_0/p_0*; NaN where the method finds no solution
    stated : compliance_error and resistance_error
    ratio : error over stated, minus the uncertainty of the reference; NaN if that is too coarse
    message : message of the first refusal
    """

    error: Array
    stated: Array
    ratio: Array
    message: str


Found = list[tuple[Draw, Mapping[str, Judged]]]


def judge(draw: Draw, variant: Variant) -> Judged:
    """Compare a variant with the exact curve, load by load if it refuses the curve; NaN at loads that it refuses."""
    found = attempt(variant, draw.profile, draw.loads)
    right = contact_reference(draw.profile, tuple(draw.loads.tolist()))
    error, stated = deviation(found.values, right.values), found.stated
    # The reference must be ten times as accurate as the stated or the measured error.
    is_known = 10 * right.uncertainty <= np.maximum(stated, error)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(is_known, np.maximum(error - right.uncertainty, 0) / stated, np.nan)
    return Judged(error, stated, ratio, found.message)


def judge_all(draw: Draw, names: Iterable[str] = VARIANTS) -> dict[str, Judged]:
    """Return the judged variants of these names on a draw."""
    return {variant.name: judge(draw, variant) for variant in draw.variants if variant.name in names}


def header(names: Iterable[str]) -> list[str]:
    """Return the headings of `row`."""
    return ["family", "loads", *(f"{symbol} by {name}" for name in names for symbol in "hR"), "no solution"]


def row(family: str, found: Found, names: Iterable[str]) -> list[str]:
    """Return the numbers of a family, below `header`."""
    cells, refused = [family, str(sum(draw.loads.size for draw, _ in found))], 0
    for name in names:
        for quantity in range(2):
            ratio = np.concatenate([judged[name].ratio[quantity] for _, judged in found])
            ratio = ratio[~np.isnan(ratio)]
            cells.append(f"{np.count_nonzero(ratio > 1)} of {ratio.size}, {ratio.max(initial=0):.2g}")
        refused += sum(int(np.isnan(judged[name].stated[0]).sum()) for _, judged in found)
    return [*cells, str(refused)]


def tables(found: Found, names: Iterable[str], worst: int) -> Iterator[str]:
    """Yield a table with a row for each family and one for all, the worst errors, and the refusals."""
    rows = []
    for family in (*FAMILIES, "all"):
        if of_family := [one for one in found if family in (one[0].family, "all")]:
            rows.append(row(family, of_family, names))
    yield markdown.table(header(names), rows)
    largest = sorted(exceeded(found), reverse=True)[:worst]
    yield from (f"{ratio:.3g} times: {where}" for ratio, where in largest)
    for draw, by_name in found:
        for variant in draw.variants:
            if variant.name in by_name and np.isnan(by_name[variant.name].stated[0]).any():
                yield f"{draw.profile!r} by {variant.name}, {variant.settings}: {by_name[variant.name].message}"


def exceeded(found: Found) -> Iterator[tuple[float, str]]:
    """Yield errors larger than stated: their ratio to the stated error, and their location."""
    for draw, by_name in found:
        for variant in (each for each in draw.variants if each.name in by_name):
            judged = by_name[variant.name]
            for quantity, load in np.argwhere(judged.ratio > 1):
                error, stated = (f"{values[quantity, load]:.2e}" for values in (judged.error, judged.stated))
                yield (
                    float(judged.ratio[quantity, load]),
                    f"{'hR'[quantity]} by {variant.name} is off by {error}, stated {stated} ({draw.family}): "
                    f"{draw.profile!r} at {draw.loads[load]}, {variant.settings}",
                )


@measurement("Coverage of stated errors")
@click.option("--count", default=6000, help="Loads that are compared.")
@click.option(
    "--seed", type=int, default=lambda: secrets.randbits(32), show_default="a new one", help="Seed of the draws."
)
@click.option(
    "--families", multiple=True, type=click.Choice([*FAMILIES]), default=[*FAMILIES], help="Families to draw from."
)
@click.option("--methods", multiple=True, type=click.Choice(VARIANTS), default=VARIANTS, help="Methods to compare.")
@click.option("--worst", default=20, help="Errors above the stated ones that are listed.")
def main(count: int, seed: int, families: Sequence[str], methods: Sequence[str], worst: int) -> Page:
    """Compare stated errors with errors against the exact contact, on families of hard series.

    A cell has the number of errors above the stated one, the number of comparisons, and the largest ratio of error to
    stated error. The reference is contact patches at a tolerance of 1e-12 on the profile shifted along x. A number is
    compared if the uncertainty of the reference, its distance from that of the reflected profile, is below a tenth of
    the stated or of the measured error. Ctrl-C ends the draws and keeps the results so far.
    """
    found: Found = []
    try:
        for draw in draws(families, np.random.default_rng(seed), count):
            found.append((draw, judge_all(draw, methods)))
    except KeyboardInterrupt:
        click.echo("interrupted", err=True)
    return Page([*tables(found, methods, worst)])
