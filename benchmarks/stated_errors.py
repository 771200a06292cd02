"""Do methods keep what they state? On families of hard series, against contact patches at a tight tolerance.

`python -m benchmarks.stated_errors` draws fresh series, prints a row a family, and the worst errors beyond it.
With a file, exact curves are solved once.
"""

from __future__ import annotations

import secrets
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import click
import numpy as np

from benchmarks.families import FAMILIES, Draw, draws
from weier import ConvergenceError
from weier.kernels.arrays import Array
from weier.methods import bem, patches
from weier.methods.errors import OutOfReachError
from weier.methods.registry import PLANNED, find_method
from weier.methods.segment import QUANTITIES

FINER = 10  # a difference is judged where the reference is finer than what is stated, or than it, by this
MIN_RESISTANCE = 1e-3  # g_0/p_0*: errors of R are relative to it from here on
OF_QUANTITY = "error of {}: median / 90 % / largest", "judged", "exceeded", "largest ratio", "median width"
HEADER = ["family", "loads", *(column.format(symbol) for symbol in "hR" for column in OF_QUANTITY), "no patches"]
HEADER += ["refused"]
REFUSALS = ConvergenceError, OutOfReachError


class Judged(NamedTuple):
    """How far a method is off on a draw, and what it states; each of shape (2, loads): h and R.

    ratio : error over stated error, less what the reference may be off; NaN where the reference is too coarse
    scale : of errors in the table
    """

    error: Array
    stated: Array
    ratio: Array
    scale: Array
    uncertainty: Array


def by_elements(each: Draw, loads: Array) -> Any:
    """Boundary elements with the settings of a draw."""
    return bem.curve(each.profile, loads, **each.settings)


def by_patches(each: Draw, loads: Array) -> Any:
    """Contact patches at their usual tolerance."""
    return patches.curve(each.profile, loads)


def by_plan(each: Draw, loads: Array) -> Any:
    """A plan for either quantity within 1e-8 to 0.1, which the draw decides."""
    random = np.random.default_rng(each.loads.view(np.uint64))
    tolerance, quantity = 10 ** random.uniform(-8, -1), str(random.choice(QUANTITIES))
    return find_method(PLANNED).solve(each.profile, loads, tolerance, quantity)


METHODS: dict[str, Callable[[Draw, Array], Any]] = {"bem": by_elements, "patches": by_patches, PLANNED: by_plan}


def judge(each: Draw, solve: Callable[[Draw, Array], Any] = by_elements) -> Judged:
    """What a method finds, load by load where the curve is refused; NaN where the load is."""
    try:
        found = _numbers(solve(each, each.loads))
    except REFUSALS:
        found = np.concatenate([_solve_or_refuse(each, load, solve) for load in each.loads], axis=1)
    error, stated = np.abs(found[:2] - each.exact), found[2:]
    fine = FINER * each.uncertainty <= np.maximum(stated, error)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(fine, np.maximum(error - each.uncertainty, 0) / stated, np.nan)
    R = each.exact[1]
    scale = np.array([np.ones(R.size), np.where(R > MIN_RESISTANCE, R, 1)])
    return Judged(error, stated, ratio, scale, each.uncertainty)


def _numbers(found: Any) -> Array:
    """Compliance, resistance and their stated errors, shape (4, loads)."""
    return np.array([found.compliance, found.resistance, found.compliance_error, found.resistance_error])


def _solve_or_refuse(each: Draw, load: float, solve: Callable[[Draw, Array], Any]) -> Array:
    try:
        return _numbers(solve(each, np.array([load])))
    except REFUSALS as error:
        click.echo(f"{each.profile!r} at {load}, {each.settings}: {error}", err=True)
        return np.full((4, 1), np.nan)


def row(family: str, found: list[tuple[Draw, Judged]]) -> list[str]:
    """The numbers of a family, below HEADER."""
    all_of = Judged(*(np.concatenate(parts, axis=1) for parts in zip(*(judged for _, judged in found), strict=True)))
    unsolved = np.isnan(all_of.uncertainty[0])
    refused = np.isnan(all_of.stated[0])
    cells = [family, str(np.count_nonzero(~unsolved & ~refused))]
    for h_or_R in range(2):
        cells += _of_quantity(Judged(*(values[h_or_R][~unsolved & ~refused] for values in all_of)))
    return [*cells, str(np.count_nonzero(unsolved)), str(np.count_nonzero(refused & ~unsolved))]


def _of_quantity(of: Judged) -> list[str]:
    """Errors, comparisons, exceeded ones, the largest ratio of error to statement, and the median of its inverse."""
    if of.error.size == 0:
        return ["-"] * len(OF_QUANTITY)
    errors = " / ".join(f"{value:.0e}" for value in np.quantile(of.error / of.scale, (0.5, 0.9, 1)))
    judged = of.ratio[~np.isnan(of.ratio)]
    width = np.median(of.stated / np.maximum(of.error, of.uncertainty))
    counts = str(judged.size), str(np.count_nonzero(judged > 1))
    return [errors, *counts, f"{judged.max(initial=0):.2g}", f"{width:.2g}"]


def exceeded(found: list[tuple[Draw, Judged]]) -> Iterator[tuple[float, str]]:
    """Errors larger than stated: by which ratio, and where."""
    for draw, judged in found:
        D, gamma, m, phase = draw.profile.D, draw.profile.gamma, draw.profile.m, draw.profile.phase
        for at in map(tuple, np.argwhere(judged.ratio > 1)):
            error, stated, uncertainty = (
                f"{part[at]:.2e}" for part in (judged.error, judged.stated, judged.uncertainty)
            )
            yield (
                float(judged.ratio[at]),
                (
                    f"{'hR'[at[0]]} off by {error}, stated {stated}, known to {uncertainty} ({draw.family}): "
                    f'Profile({D}, "{gamma}", {m}, {phase.tolist()}) at {draw.loads[at[1]]}, {draw.settings}'
                ),
            )


def report(found: list[tuple[Draw, Judged]], worst: int) -> None:
    """Print a row a family, one of all, and the worst of what exceeds its statement."""
    click.echo("| " + " | ".join(HEADER) + " |\n" + "|---" * len(HEADER) + "|")
    for family in (*FAMILIES, "all"):
        if of_family := [each for each in found if family in (each[0].family, "all")]:
            click.echo("| " + " | ".join(row(family, of_family)) + " |")
    for ratio, where in sorted(exceeded(found), reverse=True)[:worst]:
        click.echo(f"{ratio:.3g} times: {where}")


@click.command(context_settings={"show_default": True})
@click.option("--method", type=click.Choice([*METHODS]), default="bem", help="Which is compared.")
@click.option("--count", default=6000, help="Loads that are compared.")
@click.option("--seed", type=int, help="Of the draws; another one each time unless told.")
@click.option("--families", default=",".join(FAMILIES), help="Which of them, with commas.")
@click.option(
    "--file", type=click.Path(dir_okay=False, path_type=Path), help="Where draws and exact curves are kept."
)
@click.option("--worst", default=20, help="Exceeded statements to print.")
def main(method: str, count: int, seed: int | None, families: str, file: Path | None, worst: int) -> None:
    """Compare a method with tight contact patches on families of hard series; Ctrl-C prints what there is."""
    names = [name.strip() for name in families.split(",")]
    if unknown := set(names) - set(FAMILIES):
        raise click.BadParameter(f"{', '.join(unknown)}: must be among {', '.join(FAMILIES)}")
    seed = secrets.randbits(32) if seed is None else seed
    click.echo(f"seed {seed}", err=True)
    found = []
    try:
        for each in draws(file, names, np.random.default_rng(seed), count):
            found.append((each, judge(each, METHODS[method])))
    except KeyboardInterrupt:
        click.echo("interrupted", err=True)
    report(found, worst)


if __name__ == "__main__":
    main()
