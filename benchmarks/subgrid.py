"""Accuracy of the corrected boundary elements on random series: the table of docs/subgrid.md.

python -m benchmarks.subgrid [series]
"""

from __future__ import annotations

import sys
from fractions import Fraction
from typing import NamedTuple

import click
import numpy as np
from numpy.typing import NDArray

from weier import ConvergenceError, Profile
from weier.methods import bem, patches

Array = NDArray[np.float64]

PER_WAVE = (16, 32, 64, 256)
LOADS = 40
MAX_WAVES = 64  # of the finest term, so that contact patches take milliseconds a load
QUANTILES = (0.5, 0.9, 1)
RATIOS = (Fraction(3, 2), Fraction(5, 2), Fraction(7, 3), Fraction(5, 3), Fraction(4, 3))


class Case(NamedTuple):
    """A series with its exact curve."""

    profile: Profile
    loads: Array
    exact: patches.Curve


def random_profile(random: np.random.Generator) -> Profile:
    """A series of at most MAX_WAVES waves."""
    while True:
        gamma = (
            Fraction(int(random.integers(2, 11))) if random.random() < 0.8 else RATIOS[random.integers(len(RATIOS))]
        )
        m = int(random.integers(1, 6))
        if gamma.numerator ** (m - 1) <= MAX_WAVES:
            break
    waves = np.array([gamma.numerator**n * gamma.denominator ** (m - 1 - n) for n in range(m)])
    phases = (
        random.uniform(0, 2 * np.pi, m),
        np.zeros(m),
        np.pi * random.integers(0, 2, m),
        -np.pi * waves / (PER_WAVE[0] * waves[-1]),  # all crests half a node off
    )[random.integers(4)]
    return Profile(random.uniform(1.02, 1.98), gamma, m, tuple(phases.tolist()))


def random_case(random: np.random.Generator) -> Case:
    """A series under loads from 1e-9 p_0* to full contact, if patches solve it."""
    while True:
        profile = random_profile(random)
        full = profile.full_contact_load
        loads = np.unique(np.exp(random.uniform(np.log(1e-9), np.log(full), LOADS)))
        try:
            return Case(profile, loads, patches.curve(profile, loads))
        except ConvergenceError as error:
            print(f"{profile.describe_with_phases()}: {error}", file=sys.stderr)


def errors(case: Case, per_wave: int) -> Array:
    """Errors of h and R, the latter relative from 1e-3 on, and both over the expected ones, shape (4, loads)."""
    points = per_wave * case.profile.waves_per_period[-1]
    found = bem.curve(case.profile, case.loads, points=points)
    h = np.abs(found.compliance - case.exact.compliance)
    R = np.abs(found.resistance - case.exact.resistance)
    scale = np.where(case.exact.resistance > 1e-3, case.exact.resistance, 1)
    # The exact curve holds ten digits.
    return np.array([h, R / scale, h / (found.compliance_error + 1e-12), R / (found.resistance_error + 1e-9)])


@click.command()
@click.argument("series", type=click.IntRange(1), default=300)
def main(series: int) -> None:
    """Print the errors of SERIES random series, by default 300, on several grids.

    Below the table stand the orders with which they fall from the coarsest grid to the finest.
    """
    random = np.random.default_rng(11)
    cases = [random_case(random) for _ in range(series)]
    print("| points a wave | h median | 90 % | largest | R median | 90 % | largest | within their errors | widths |")
    print("|---|---|---|---|---|---|---|---|---|")
    rows = []
    for per_wave in PER_WAVE:
        h, R, h_share, R_share = np.concatenate([errors(case, per_wave) for case in cases], axis=1)
        rows.append([np.quantile(values, quantile) for values in (h, R) for quantile in QUANTILES])
        cells = [f"{value:.1e}" for value in rows[-1]]
        held = f"{np.mean(h_share <= 1):.2%}, {np.mean(R_share <= 1):.2%}"
        widths = f"{1 / np.median(h_share):.0f}, {1 / np.median(R_share):.0f}"
        print("|", " | ".join([str(per_wave), *cells, held, widths]), "|")
    orders = -np.polyfit(np.log(PER_WAVE), np.log(rows), 1)[0]
    print("| order |", " | ".join(f"{order:.1f}" for order in orders), "| | |")


if __name__ == "__main__":
    main()
