"""Coverage of stated errors on families of hard series."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import click
import numpy as np

from weier.accuracy.comparison import Compared, by_problem, compare
from weier.accuracy.families import FAMILIES, VARIANTS, draws
from weier.accuracy.measurement import measurement


def parts(found: Sequence[Compared]) -> Iterator[str]:
    """Yield a table with a row for each family and one for all, the errors beyond the stated ones, and refusals."""
    whole = [one._replace(problem=one.problem._replace(name="all")) for one in found]
    yield by_problem([*found, *whole], "family", _coverage)
    for one in found:
        yield from one.exceeded()
        if one.result.message:
            settings = one.problem.variants[one.name].settings
            yield f"{one.problem.profile!r} by {one.name}, {settings}: {one.result.message}"


def _coverage(found: Sequence[Compared]) -> str:
    """Return how many known errors of h and R exceed the stated ones, the largest ratio, and the refused loads."""
    texts = []
    for symbol, ratio in zip("hR", np.concatenate([one.ratio for one in found], axis=1), strict=True):
        known = ratio[~np.isnan(ratio)]
        texts.append(f"{symbol}: {np.count_nonzero(known > 1)} of {known.size}, {known.max(initial=0):.2g}")
    refused = sum(np.count_nonzero(~one.result.solved) for one in found)
    return "; ".join([*texts, *[f"{refused} refused"] * bool(refused)])


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
    stated error, for h and for R. The reference is contact patches at a tolerance of 1e-12 on the profile shifted
    along x. Its uncertainty is the distance from the reflected profile. A number is compared if the uncertainty is
    below a tenth of the stated or the measured error.
    """
    drawn = draws(families, methods, np.random.default_rng(seed), count)
    return [*parts([*compare(drawn)])]
