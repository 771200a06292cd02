"""Processor time to a given error of the compliance, and how errors fall with the nodes.

`python -m benchmarks to_error` writes a table and a figure. A program on a grid gets the coarsest grid whose largest
error over the loads is within the target. Contact patches have no grid: the target is their tolerance.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from time import process_time
from typing import NamedTuple

import click
import matplotlib.style
import numpy as np

from benchmarks.problem import REFERENCE_TOLERANCE, Problem, examine
from benchmarks.programs import PROGRAMS, calibrate, seconds, solve_loads
from benchmarks.report import HEIGHT, LOOKS, WORDS
from benchmarks.same_grid import PHASES, installed, parse_names
from weier import Profile
from weier.accuracy.measurement import CONTEXT
from weier.data import markdown
from weier.data.files import write_text
from weier.data.markdown import significant
from weier.figures import save, style
from weier.kernels.arrays import Array
from weier.methods import patches
from weier.methods.bem import curve as solve_curve

# the problem of `python -m benchmarks same_grid`, and the programs
PROFILE = Profile(D=1.25, gamma=5, m=3, phases=PHASES)
LOADS = np.geomspace(1e-3, 2, 40)
ELEMENTS, PATCHES, KEPT = "weier_default", "patches", "weier"
STAIRCASE = {ELEMENTS: "removed", KEPT: "kept"}
OTHERS = ("tamaas", "contact_mechanics", "slippy")
LABELS = {ELEMENTS: "weier, boundary elements", PATCHES: "weier, contact patches"}
LABELS |= {name: PROGRAMS[name].label for name in OTHERS}
TARGETS = (1e-4, 1e-5, 1e-6, 1e-8)  # g_0: the errors to be reached.
# candidate grids; the smallest sufficient one is found
SIZES = sorted([2**k for k in range(9, 19)] + [3 * 2**k for k in range(8, 17)])
ORDER = 3  # highest observed order of convergence, used to skip grids that are too coarse
RESIDUAL_FRACTION = 0.1  # allowed residual over target error
TIGHTER = 1 / 8  # solver tolerance over residual at which all programs reach about the residual
# The minimum over REPEATS runs is reported; runs are added up to MIN_SECONDS in total, and stop at
# MAX_REPEATED_SECONDS.
REPEATS, MIN_SECONDS, MAX_REPEATED_SECONDS = 3, 0.3, 3.0
# Grids expected to take more than MAX_SECONDS are skipped; processor seconds grow about as N^1.3.
MAX_SECONDS, GROWTH = 60.0, 1.3
MAX_DRAWN = {ELEMENTS: 2**15, KEPT: 2**15, "tamaas": 2**13}  # The programs in the figure, and their largest grids.
DRAWN_RESIDUALS = {ELEMENTS: 1e-11, KEPT: 1e-11, "tamaas": 1e-9}  # g_0: well below the errors in the figure.


class Reference(NamedTuple):
    """Compliance and resistance over LOADS by contact patches at a tight tolerance."""

    h: Array
    R: Array


class Attempt(NamedTuple):
    """The largest error of h on one grid, in g_0.

    `prepare` returns a function that solves for the same curve again, and returns the processor seconds that it took.
    """

    error: float
    prepare: Callable[[], Callable[[], float]]


class Reached(NamedTuple):
    """The smallest sufficient grid of a program, and its least processor seconds.

    Contact patches have 0 points. The seconds are inf for a grid that was skipped (`MAX_SECONDS`).
    """

    points: int
    seconds: float


def find_reference() -> Reference:
    """Solve by contact patches."""
    curve = patches.curve(PROFILE, LOADS, REFERENCE_TOLERANCE)
    return Reference(curve.compliance, curve.resistance)


def attempt(name: str, points: int, residual: float, reference: Reference) -> Attempt:
    """Solve for the compliance on a grid by a program, to a residual in g_0."""
    problem = Problem(PROFILE, LOADS, points, residual)
    if name in STAIRCASE:
        h = _solve_by_elements(name, problem)[0]
        return Attempt(_largest(h - reference.h), lambda: partial(seconds, PROGRAMS[name], problem, np.empty(0)))
    h = _compliance(name, problem)
    return Attempt(_largest(h - reference.h), lambda: _at_loosest_tolerances(name, problem))


def _solve_by_elements(name: str, problem: Problem) -> tuple[Array, Array]:
    """Return compliance and resistance by weier's boundary elements."""
    curve = solve_curve(
        problem.profile,
        problem.loads,
        points=problem.points,
        max_residual=problem.tolerance,
        staircase=STAIRCASE[name],
    )
    return curve.compliance, curve.resistance


def _largest(deviation: Array) -> float:
    return float(np.abs(deviation).max())


def _at_loosest_tolerances(name: str, problem: Problem) -> Callable[[], float]:
    """Return a function that times the whole curve at the calibrated tolerances."""
    return partial(seconds, PROGRAMS[name], problem, calibrate(PROGRAMS[name], problem))


def _compliance(name: str, problem: Problem) -> Array:
    """Return the compliances at a tolerance that meets the residual about."""
    solver, own = PROGRAMS[name].begin(problem), np.full(problem.loads.size, TIGHTER * problem.tolerance)
    height, eigenvalue = problem.height, PROGRAMS[name].eigenvalue(problem.points, problem.profile.period)
    steps = zip(problem.loads[::-1], solve_loads(solver, problem.loads, own), strict=True)
    h = [examine(problem, height, eigenvalue, load, step.pressure).compliance for load, step in steps]
    return np.array(h[::-1])


def find_smallest(name: str, target: float, reference: Reference, fewest: int = 0) -> Reached | None:
    """Return the smallest of SIZES >= `fewest` whose error is within the target; None if there is none."""
    sizes = [size for size in SIZES if size >= fewest]
    clock, expected = PROGRAMS[name].clock, 0.0
    while sizes and expected <= MAX_SECONDS:
        points, begin = sizes[0], clock()
        tried = attempt(name, points, RESIDUAL_FRACTION * target, reference)
        taken = clock() - begin
        click.echo(f"{target:.0e} g_0 by {name}: {points} nodes leave {tried.error:.1e}, {taken:.3g} s", err=True)
        if tried.error <= target:
            return Reached(points, least_seconds(tried.prepare()))
        enough = points * (tried.error / target) ** (1 / ORDER) if np.isfinite(tried.error) else points
        sizes = [size for size in sizes[1:] if size >= enough]
        expected = taken * (sizes[0] / points) ** GROWTH if sizes else 0.0
    return Reached(sizes[0], math.inf) if sizes else None


def least_seconds(timed: Callable[[], float]) -> float:
    """Return the least processor seconds of several runs."""
    taken: list[float] = []
    while sum(taken) < MIN_SECONDS or (len(taken) < REPEATS and sum(taken) < MAX_REPEATED_SECONDS):
        taken.append(timed())
    return min(taken)


def measure(name: str, reference: Reference) -> list[Reached | None]:
    """Return the grid and seconds for each target; grid sizes are monotone in the target."""
    if name == PATCHES:
        return [Reached(0, least_seconds(partial(_seconds_of_patches, target))) for target in TARGETS]
    reached: list[Reached | None] = []
    last: Reached | None = Reached(0, 0.0)
    for target in TARGETS:
        if last and math.isfinite(last.seconds):
            last = find_smallest(name, target, reference, last.points)
        reached.append(last)
    return reached


def _seconds_of_patches(target: float) -> float:
    begin = process_time()
    patches.curve(PROFILE, LOADS, target)
    return process_time() - begin


def table(reached: Mapping[str, Sequence[Reached | None]]) -> str:
    """Return a row for each program: seconds, nodes, and the ratio of seconds to weier's faster method."""
    head = ["program", *(f"{target:.0e} g_0" for target in TARGETS)]
    own = [[_seconds_or_inf(column) for column in reached[name]] for name in (ELEMENTS, PATCHES)]
    fastest = np.min(own, axis=0)
    rows = []
    for name, columns in reached.items():
        compared = fastest if name in OTHERS else [math.nan] * len(TARGETS)
        rows.append([LABELS[name], *(_cell(*pair) for pair in zip(columns, compared, strict=True))])
    return markdown.table(head, rows)


def _seconds_or_inf(reached: Reached | None) -> float:
    return reached.seconds if reached else math.inf


def _cell(reached: Reached | None, fastest: float) -> str:
    if reached is None:
        return "not reached"
    if math.isinf(reached.seconds):
        return f"over {MAX_SECONDS:g} s, over {significant(MAX_SECONDS / fastest, 2)} times"
    cell = f"{significant(reached.seconds, 2)} s" + (f", {reached.points} nodes" if reached.points else "")
    return cell if math.isnan(fastest) else f"{cell}, {significant(reached.seconds / fastest, 2)} times"


def describe(reached: Mapping[str, Sequence[Reached | None]]) -> str:
    """Return the table with its explanation, as Markdown."""
    return "\n".join(
        [
            "## To a given error",
            "",
            f"`python -m benchmarks to_error` gives each program the smallest grid with which its largest error of h "
            f"over the same {LOADS.size} loads is within a target. A residual of a tenth of the target is allowed. "
            "Seconds are processor time for the whole curve, the least of several runs. Factors "
            "compare with whichever of weier's two methods is faster. Contact patches have no grid; the target is "
            "their tolerance. Both methods give the resistance and bounds in this time, too.",
            "",
            table(reached),
            "",
            f'"Over {MAX_SECONDS:g} s" is a grid that was not tried, because it was expected to take so long.',
            "",
            "![Largest errors of h and R over the number of nodes](to_error.png)",
            "",
            "*Largest errors over the same loads: of h in g_0, of R relative to the larger of itself and "
            "1 g_0/p_0\\*, which the other programs do not give.*",
            "",
        ]
    )


def draw(programs: Sequence[str], reference: Reference, path: Path) -> None:
    """Draw the largest errors against the number of nodes, as PDF, SVG and PNG."""
    with matplotlib.style.context(style.SHEET, after_reset=True):
        figure, (h_axes, R_axes) = style.column("", ["", ""], HEIGHT)
        for axes, symbol in ((h_axes, "$h/g_0$"), (R_axes, "$R$")):
            axes.set(xscale="log", yscale="log", xlabel=WORDS["points"], ylabel=f"largest error of {symbol}")
            axes.set_xscale("log", base=2)
        for name in (name for name in programs if name in MAX_DRAWN):
            sizes = [size for size in SIZES if size <= MAX_DRAWN[name]]
            look = {**LOOKS[name], "label": PROGRAMS[name].label}
            errors = np.array([_errors(name, size, reference) for size in sizes])
            h_axes.plot(sizes, errors[:, 0], **look)
            if name in STAIRCASE:
                R_axes.plot(sizes, errors[:, 1], **look)
        figure.legend(*h_axes.get_legend_handles_labels(), loc="outside upper center", ncols=1, handlelength=3.2)
        save(figure, path)


def _errors(name: str, points: int, reference: Reference) -> tuple[float, float]:
    """Return the largest errors of h, in g_0, and of R relative to max(R, 1 g_0/p_0*), NaN if unknown."""
    if name not in STAIRCASE:
        return attempt(name, points, DRAWN_RESIDUALS[name], reference).error, math.nan
    h, R = _solve_by_elements(name, Problem(PROFILE, LOADS, points, DRAWN_RESIDUALS[name]))
    return _largest(h - reference.h), _largest((R - reference.R) / np.maximum(reference.R, 1))


@click.command(context_settings=CONTEXT)
@click.option("--programs", callback=parse_names, default=",".join(OTHERS), help="Programs to compare with weier.")
@click.option("--output", type=click.Path(path_type=Path), default="results/benchmark", help="Folder to write to.")
def main(programs: list[str], output: Path) -> None:
    """Measure the time to a given error of h by weier, tamaas, ContactMechanics and slippy.

    Writes to_error.md and to_error.{png,svg,pdf}.
    """
    reference = find_reference()
    attempt(ELEMENTS, SIZES[0], 1e-6, reference)  # compiles
    names = [ELEMENTS, PATCHES, *installed([name for name in programs if name in OTHERS])]
    reached = {name: measure(name, reference) for name in names}
    write_text(output / "to_error.md", describe(reached))
    draw([KEPT, *names], reference, output / "to_error.pdf")
    click.echo(table(reached))
