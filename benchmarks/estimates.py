"""Errors of the estimates on ensembles, and the exponent of the stiffness."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import click
import numpy as np

from weier.accuracy.measurement import measurement
from weier.accuracy.runner import Variant, run
from weier.data import markdown
from weier.kernels.arrays import Array
from weier.surface.profile import Profile

ESTIMATES = ("archard", "demelio", "layer", "persson", "cascade")
# D, gamma and m, with 25 to 64 of the finest waves per period
SERIES = tuple((D, gamma, m) for D in (1.25, 1.5, 1.75) for gamma, m in ((2, 7), (5, 3)))
LOADS = np.geomspace(0.01, 4, 14)
RANGES = ((0.002, 0.01), (0.01, 0.05), (0.05, 0.3))  # p_0*, of the exponents of the stiffness
MIN_RESISTANCE = 1e-3  # g_0/p_0*: below it contact is nearly full


class Errors(NamedTuple):
    """Median and 90th percentile of |error| over profiles and loads, of h, R and area; NaN without an area."""

    series: tuple[float, int, int]
    method: str
    median: Array
    high: Array


def measure(seeds: int, series: Sequence[tuple[float, int, int]] = SERIES, loads: Array = LOADS) -> Iterator[Errors]:
    """Yield the errors of each estimate on each series."""
    for own in series:
        exact = [_solved("patches", Profile(*own, seed=seed), loads) for seed in range(seeds)]
        for method in ESTIMATES:
            guess = _solved(method, Profile(*own), loads)
            yield _errors(own, method, guess, np.stack(exact))


def exponents(seeds: int, series: tuple[float, int, int] = (1.25, 5, 3)) -> dict[tuple[float, float], float]:
    """Return the mean slope of ln(1/R) over ln(p) between the ends of each range, over profiles of random phases."""
    found = {}
    for ends in RANGES:
        R = np.array([_solved("patches", Profile(*series, seed=seed), np.array(ends))[1] for seed in range(seeds)])
        found[ends] = float(np.mean(np.log(R[:, 0] / R[:, 1])) / np.log(ends[1] / ends[0]))
    return found


def _solved(method: str, profile: Profile, loads: Array) -> Array:
    """Return compliance, resistance and contact fraction, or NaN for it, shape (3, loads)."""
    solved = run(Variant(method), profile, loads)
    area = solved.others.get("contact_fraction", np.full(loads.size, np.nan))
    return np.vstack([solved.values, area])


def _errors(series: tuple[float, int, int], method: str, guess: Array, exact: Array) -> Errors:
    """Reduce the errors of one estimate; the exact values have the shape (profiles, 3, loads)."""
    scale = exact.copy()
    scale[:, 0] = 1.0
    partial = exact[:, 1] > MIN_RESISTANCE
    error = np.abs(guess - exact) / np.where(partial[:, None], scale, 1.0)
    columns = [error[:, row][partial] for row in range(3)]
    median, high = (np.array([np.percentile(column, part) for column in columns]) for part in (50, 90))
    return Errors(series, method, median, high)


@measurement("Errors of the estimates")
@click.option("--seeds", default=12, help="Profiles of each series.")
@click.option("--lightest", default=float(LOADS[0]), help="The lightest load, in p_0*.")
def main(seeds: int, lightest: float) -> list[str]:
    """Compare the estimates with contact patches on ensembles of random phases.

    The first table has the median and the 90th percentile of |error| over profiles and loads: of h in g_0, of R and
    of the contact area relative to themselves. Nearly full contact is left out, where ratios are meaningless. The
    second table has the mean exponent a of the stiffness between the ends of ranges of loads.
    """
    rows = [
        [*(f"{value:g}" for value in found.series), found.method, *map(_cell, found.median, found.high, range(3))]
        for found in measure(seeds, loads=LOADS[lightest <= LOADS])
    ]
    header = ["D", "gamma", "m", "estimate", "error of h", "of R, %", "of the area, %"]
    ranges = [(f"{low:g} to {high:g}", f"{exponent:.2f}") for (low, high), exponent in exponents(seeds).items()]
    range_header = ["p in p_0*, D = 1.25, gamma = 5, m = 3", "a of 1/R ~ p^a"]
    return [markdown.table(header, rows), markdown.table(range_header, ranges)]


def _cell(median: float, high: float, row: int) -> str:
    if np.isnan(median):
        return ""
    return f"{median:.3f}, {high:.3f}" if row == 0 else f"{100 * median:.0f}, {100 * high:.0f}"
