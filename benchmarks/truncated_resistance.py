"""Coverage of the error that is estimated for the resistance of infinite series."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import click
import numpy as np

from weier import OutOfReachError, Profile, random_phases, solve
from weier.accuracy.measurement import measurement
from weier.data import markdown
from weier.methods import patches

TOLERANCES = (0.02, 0.05, 0.1, 0.2)
RATIOS = ("3/2", 2, "5/2", 3, 4, 5, 6)
# amplitude left out by the reference over amplitude left out by the solution
LEFT = 0.3
MAX_WAVES = 20_000  # largest number of waves in a reference
HEADER = ("tolerance", "loads", "met", "judged", "beyond", "median of error/stated", "largest")


class Judged(NamedTuple):
    """The result at a load: whether the tolerance is met, and error over stated error, NaN if unknown."""

    tolerance: float
    met: bool
    ratio: float


def judge(series: Profile, load: float, tolerance: float) -> Judged:
    """Compare the resistance of an infinite series with a truncation of more terms."""
    try:
        found = solve(series, [load], tolerance=tolerance, quantity="resistance")
    except OutOfReachError:
        return Judged(tolerance, False, np.nan)
    per_term = float(series.gamma) ** (series.D - 2)
    terms = int(found.chosen_terms) + math.ceil(math.log(LEFT) / math.log(per_term))
    longer = series.truncated(terms)
    if longer.waves_per_period[-1] > MAX_WAVES:
        return Judged(tolerance, True, np.nan)
    right = patches.curve(longer, [load]).resistance
    return Judged(tolerance, True, float((abs(right - found.resistance) / found.resistance_error).item()))


def judge_all(count: int, seed: int) -> Iterator[Judged]:
    """Judge all tolerances for random series, each under a random load."""
    random = np.random.default_rng(seed)
    for _ in range(count):
        phases, gamma = random_phases(int(random.integers(2**31))), RATIOS[random.integers(len(RATIOS))]
        series = Profile(random.uniform(1.05, 1.7), gamma, math.inf, phases)
        load = float(np.exp(random.uniform(np.log(0.01), np.log(2.0))))
        for tolerance in TOLERANCES:
            yield judge(series, load, tolerance)


@measurement("The resistance of infinite series")
@click.option("--count", default=200, help="Number of random series.")
@click.option("--seed", default=1, help="Of the series.")
def main(count: int, seed: int) -> list[str]:
    """Compare the resistance of infinite series by "auto" with longer truncations.

    D is in [1.05, 1.7], phases are random, and each series has one load in [0.01, 2] p_0*. The reference has
    further terms, such that 0.3 of the omitted amplitude remains. Series with more than 20 000 waves are not judged.
    """
    found, rows = list(judge_all(count, seed)), []
    for tolerance in TOLERANCES:
        here = [each for each in found if each.tolerance == tolerance]
        ratio = np.array([each.ratio for each in here if np.isfinite(each.ratio)])
        cells = [len(here), sum(each.met for each in here), ratio.size, int((ratio > 1).sum())]
        numbers = [np.median(ratio), ratio.max()] if ratio.size else [np.nan, np.nan]
        rows.append([f"{tolerance:g}", *map(str, cells), *(f"{number:.2f}" for number in numbers)])
    ratio = np.array([each.ratio for each in found if np.isfinite(each.ratio)])
    return [markdown.table(HEADER, rows), f"{np.mean(ratio <= 1):.1%} of {ratio.size} within the stated error."]
