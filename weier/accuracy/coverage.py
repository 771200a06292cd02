"""Coverage of stated errors on families of hard series, against contact patches at a tight tolerance.

`python -m weier.accuracy.coverage` draws new series, prints the number of errors above the stated error and the
largest ratio for each family and method, and lists the worst.
"""

from __future__ import annotations

import secrets
from collections.abc import Callable, Iterable, Iterator
from typing import Any, NamedTuple

import click
import numpy as np

from weier import ConvergenceError
from weier.accuracy.families import FAMILIES, Draw, draws
from weier.data import markdown
from weier.kernels.arrays import Array
from weier.methods import bem, patches


class Judged(NamedTuple):
    """Errors of a method on a draw, measured and stated; each of shape (2, loads): h and R.

    error : in g_0 and g_0/p_0*; NaN where the method finds no solution
    stated : compliance_error and resistance_error
    ratio : error over stated, minus the uncertainty of the reference; NaN if that is too coarse
    """

    error: Array
    stated: Array
    ratio: Array


def by_elements(draw: Draw, loads: Array) -> Any:
    """Return boundary elements on the grid of a draw, their staircase removed."""
    return bem.curve(draw.profile, loads, **draw.settings)


def by_staircase(draw: Draw, loads: Array) -> Any:
    """Return boundary elements on the same grid with their staircase, as in Section 5.1."""
    return bem.curve(draw.profile, loads, **draw.settings, staircase="kept")


def by_patches(draw: Draw, loads: Array) -> Any:
    """Return contact patches at a tolerance of 1e-10 to 1e-2 g_0; below, the reference is not finer."""
    random = np.random.default_rng(draw.loads.view(np.uint64))  # the same for the whole draw and its single loads
    return patches.curve(draw.profile, loads, 10 ** random.uniform(-10, -2))


METHODS: dict[str, Callable[[Draw, Array], Any]] = {
    "bem": by_elements,
    "bem with staircase": by_staircase,
    "patches": by_patches,
}


def judge(draw: Draw, solve: Callable[[Draw, Array], Any]) -> Judged:
    """Compare a method with the exact curve, load by load if it refuses the curve; NaN at loads that it refuses."""
    try:
        found = _numbers(solve(draw, draw.loads))
    except ConvergenceError:
        found = np.concatenate([_solve_or_refuse(draw, load, solve) for load in draw.loads], axis=1)
    error, stated = np.abs(found[:2] - draw.exact), found[2:]
    # The reference must be ten times as accurate as the stated or the measured error.
    is_known = 10 * draw.uncertainty <= np.maximum(stated, error)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(is_known, np.maximum(error - draw.uncertainty, 0) / stated, np.nan)
    return Judged(error, stated, ratio)


def _numbers(curve: Any) -> Array:
    """Return compliance, resistance and their stated errors, shape (4, loads)."""
    return np.array([curve.compliance, curve.resistance, curve.compliance_error, curve.resistance_error])


def _solve_or_refuse(draw: Draw, load: float, solve: Callable[[Draw, Array], Any]) -> Array:
    try:
        return _numbers(solve(draw, np.array([load])))
    except ConvergenceError as error:
        click.echo(f"{draw.profile!r} at {load}, {draw.settings}: {error}", err=True)
        return np.full((4, 1), np.nan)


def judge_all(draw: Draw, names: Iterable[str] = METHODS) -> dict[str, Judged]:
    """Return the methods of these names on a draw."""
    return {name: judge(draw, METHODS[name]) for name in names}


Found = list[tuple[Draw, dict[str, Judged]]]


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


def exceeded(found: Found) -> Iterator[tuple[float, str]]:
    """Yield errors larger than stated: their ratio to the stated error, and their location."""
    for draw, by_method in found:
        D, gamma, m, phases = draw.profile.D, draw.profile.gamma, draw.profile.m, draw.profile.phase.tolist()
        for name, judged in by_method.items():
            for quantity, load in np.argwhere(judged.ratio > 1):
                error, stated, uncertainty = (
                    f"{values[quantity, load]:.2e}" for values in (judged.error, judged.stated, draw.uncertainty)
                )
                yield (
                    float(judged.ratio[quantity, load]),
                    f"{'hR'[quantity]} by {name} is off by {error}, stated {stated}, known to {uncertainty} "
                    f'({draw.family}): Profile({D}, "{gamma}", {m}, {phases}) at {draw.loads[load]}, {draw.settings}',
                )


def report(found: Found, names: list[str], worst: int) -> None:
    """Print a row per family, one for all, and the largest errors above the stated ones."""
    rows = []
    for family in (*FAMILIES, "all"):
        if of_family := [one for one in found if family in (one[0].family, "all")]:
            rows.append(row(family, of_family, names))
    click.echo(markdown.table(header(names), rows))
    for ratio, where in sorted(exceeded(found), reverse=True)[:worst]:
        click.echo(f"{ratio:.3g} times: {where}")


@click.command(context_settings={"show_default": True})
@click.option("--count", default=6000, help="Loads that are compared.")
@click.option("--seed", type=int, help="Seed of the draws; another one each time by default.")
@click.option("--families", default=",".join(FAMILIES), help="Families to draw from, with commas.")
@click.option("--methods", default=",".join(METHODS), help="Methods to compare, with commas.")
@click.option("--worst", default=20, help="Exceeded statements to print.")
def main(count: int, seed: int | None, families: str, methods: str, worst: int) -> None:
    """Compare methods with tight contact patches on families of hard series.

    A cell has the number of errors above the stated one, the number of comparisons, and the largest ratio of error to
    stated error. Ctrl-C prints the results so far.
    """
    of_families, of_methods = _names(families, FAMILIES), _names(methods, METHODS)
    seed = secrets.randbits(32) if seed is None else seed
    click.echo(f"seed {seed}", err=True)
    found: Found = []
    try:
        for draw in draws(of_families, np.random.default_rng(seed), count):
            found.append((draw, judge_all(draw, of_methods)))
    except KeyboardInterrupt:
        click.echo("interrupted", err=True)
    report(found, of_methods, worst)


def _names(text: str, known: Iterable[str]) -> list[str]:
    """Return the names in a list with commas, which must be known."""
    names = [name.strip() for name in text.split(",")]
    if unknown := set(names) - set(known):
        raise click.BadParameter(f"{', '.join(unknown)}: must be among {', '.join(known)}")
    return names


if __name__ == "__main__":
    main()
