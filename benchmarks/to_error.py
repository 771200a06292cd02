"""Time to a given error of compliance and resistance, and how errors fall with the nodes.

`python -m benchmarks.to_error` writes a table and a figure. Each program is run on the smallest grid with which its
largest error over the loads is within the target. The others know no resistance: they get the best that differences
of their compliances give.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from time import process_time
from typing import Any, NamedTuple

import click
import matplotlib.style
import numpy as np

from benchmarks.command import PHASES, installed, parse_names
from benchmarks.problem import Problem, examine
from benchmarks.programs import PROGRAMS, calibrate, seconds, solve_loads
from benchmarks.report import HEIGHT, LOOKS, WORDS
from benchmarks.solvers import slippy
from benchmarks.threads import use_one_thread
from weier import Profile, solve
from weier.data import markdown
from weier.data.files import write_text
from weier.figures import save, style
from weier.kernels.arrays import Array
from weier.methods.bem import curve as solve_curve
from weier.theory.tables import significant

PROFILE = Profile(D=1.25, gamma=5, m=3, phases=PHASES)
LOADS = np.geomspace(1e-3, 2, 40)
EDGES = {"weier_between": "subgrid", "weier": "nodes"}  # of weier's own, which give h and R in one call
LABELS = {"weier_between": "weier, edges between nodes", "weier": "weier, edges on nodes"}
LABELS |= {name: PROGRAMS[name].label for name in ("tamaas", "contact_mechanics", "slippy")}
OURS, *OTHERS = LABELS
TARGETS = {"h": (1e-4, 1e-5, 1e-6, 1e-7), "R": (3e-2, 1e-2, 1e-3)}
SIZES = [400, *sorted([2**k for k in range(9, 17)] + [3 * 2**k for k in range(8, 16)])]  # 400: 16 for a finest wave
MAX_SIZES = {"h": 2**16, "R": 2**13}  # of R, for those that need differences: each takes six curves
ORDER = 3  # no error falls faster: sizes that are too small by this are not tried
# Residual allowed, in the error wanted, of all programs alike. At light loads a difference divides by little. With a
# residual 100 times smaller, the largest error of h by weier changes by less than 1 %, and its largest estimate by
# less than a tenth.
SHARES = {"h": 0.1, "R": 1e-4}
TIGHTER = 1 / 8  # a tolerance of their own, in the residual wanted, where no time is taken
STEPS = (0.01, 0.03, 0.09)  # of ln p on either side of a load
REPEATS, SHORT, LONG = 3, 0.3, 1.0  # runs to time, more if they take less together, and seconds of one timed once
# No program is asked for a grid on which an attempt is expected to take longer than MAX_SECONDS. With tamaas at
# 1e-7 g_0, they take 2.3, 6.3, 17, 24 and 47 processor seconds on 6144, 12288, 24576, 32768 and 49152 nodes; the last
# gets there. From grid to grid they grow by powers from 1.2 to 1.7 of the nodes. By 1.3, the seconds expected
# of the next grid are between 16 % too few and 3 % too many.
MAX_SECONDS = 60.0
GROWTH = 1.3
DRAWN = {"weier_between": 2**14, "weier": 2**15, "tamaas": 2**13}  # the programs of the figure, up to so many nodes
DRAWN_RESIDUALS = (1e-12, 1e-9)  # of weier, whose errors become small, and of the others


class Exact(NamedTuple):
    """Compliance and resistance over LOADS by contact patches, which hold ten digits, and the seconds they took."""

    h: Array
    R: Array
    seconds: float

    def error(self, quantity: str, values: Array) -> float:
        """The largest: of h in g_0, of R relative to the larger of itself and 1 g_0/p_0*."""
        right = self.h if quantity == "h" else self.R
        return float((np.abs(values - right) / (1 if quantity == "h" else np.maximum(right, 1))).max())


class Attempt(NamedTuple):
    """How far off a quantity is on one grid; `prepare` returns a call that does the same again, for its time."""

    error: float
    prepare: Callable[[], Callable[[], Any]]
    how: str = ""


class Reached(NamedTuple):
    """The smallest grid with which a program gets to an error, and the least processor seconds of its runs.

    The seconds are infinite for a grid that was not tried, since it would take more than MAX_SECONDS.
    """

    points: int
    seconds: float
    how: str


def exact() -> Exact:
    """The reference."""
    curve = solve(PROFILE, LOADS, "patches")
    return Exact(curve.compliance.values, curve.resistance.values, curve.attrs["seconds"])


def attempt(name: str, quantity: str, points: int, residual: float, reference: Exact) -> Attempt:
    """A quantity by a program, to a residual in g_0: R of the others by the best of the differences."""
    if name in EDGES:
        return _own(name, quantity, points, residual, reference)
    if quantity == "h":
        problem = Problem(PROFILE, LOADS, points, residual)
        return Attempt(reference.error("h", _compliance(name, problem)), partial(_timed, name, problem))
    tried = (_differences(name, points, residual, step, reference) for step in STEPS)
    return min(tried, key=lambda each: np.nan_to_num(each.error, nan=np.inf))


def _own(name: str, quantity: str, points: int, residual: float, reference: Exact) -> Attempt:
    def again() -> Any:
        rate = quantity == "R" or EDGES[name] == "subgrid"
        return solve_curve(PROFILE, LOADS, points=points, tolerance=residual, edges=EDGES[name], resistance=rate)

    found = again()
    error = reference.error(quantity, found.compliance if quantity == "h" else found.resistance)
    return Attempt(error, lambda: again)


def _differences(name: str, points: int, residual: float, step: float, reference: Exact) -> Attempt:
    """R from centred differences of h along ln p."""
    loads = np.ravel(LOADS[:, None] * np.exp([-step, step]))  # increasing, as the steps are less than half of theirs
    problem = Problem(PROFILE, loads, points, residual)
    h = _compliance(name, problem)
    R = np.diff(h.reshape(-1, 2))[:, 0] / np.diff(loads.reshape(-1, 2))[:, 0]
    return Attempt(reference.error("R", R), partial(_timed, name, problem), f"differences by {step:g}")


def _timed(name: str, problem: Problem) -> Callable[[], Any]:
    """A call that solves for the whole curve, at the loosest tolerances that leave the residual."""
    return partial(seconds, PROGRAMS[name], problem, calibrate(PROGRAMS[name], problem))


def _compliance(name: str, problem: Problem) -> Array:
    """The compliances, at a tolerance with which every program leaves the residual or little more."""
    program, own = PROGRAMS[name], np.full(problem.loads.size, TIGHTER * problem.tolerance)
    height, eigenvalue = problem.height, program.eigenvalue(problem.points, problem.profile.period)
    steps = zip(problem.loads[::-1], solve_loads(program.begin(problem), problem.loads, own), strict=True)
    h = [examine(problem, height, eigenvalue, load, step.pressure).compliance for load, step in steps]
    return np.array(h[::-1])


def smallest(name: str, quantity: str, target: float, reference: Exact, fewest: int = 0) -> Reached | None:
    """The smallest of SIZES, from `fewest` on, with which a program keeps within an error, and its time there.

    None if there is none.
    """
    most = SIZES[-1] if quantity == "R" and name in EDGES else MAX_SIZES[quantity]
    sizes = [size for size in SIZES if fewest <= size <= most]
    clock, expected = _clock(name), 0.0
    while sizes and expected <= MAX_SECONDS:
        points, begin = sizes[0], clock()
        tried = attempt(name, quantity, points, SHARES[quantity] * target, reference)
        taken = clock() - begin
        said = f"{quantity} within {target:.0e} by {name}: {points} nodes leave {tried.error:.1e} {tried.how}"
        click.echo(said, err=True)
        if tried.error <= target:
            return Reached(points, _least_seconds(name, tried.prepare()), tried.how)
        enough = points * (tried.error / target) ** (1 / ORDER) if np.isfinite(tried.error) else points
        sizes = [size for size in sizes[1:] if size >= enough]
        expected = taken * (sizes[0] / points) ** GROWTH if sizes else 0.0
    return Reached(sizes[0], math.inf, "") if sizes else None


def _clock(name: str) -> Callable[[], float]:
    """Processor seconds that a program has taken; slippy's are those of its process."""
    return slippy.processor_seconds if name == "slippy" else process_time


def _least_seconds(name: str, again: Callable[[], Any]) -> float:
    """Processor seconds, which other programs on the machine do not lengthen."""
    clock = _clock(name)
    taken: list[float] = []
    while sum(taken) < SHORT or (len(taken) < REPEATS and sum(taken) < LONG):
        begin = clock()
        again()
        taken.append(clock() - begin)
    return min(taken)


def measure(name: str, reference: Exact) -> dict[str, list[Reached | None]]:
    """What a program takes for each target of each quantity; no smaller error is reached with fewer nodes."""
    found: dict[str, list[Reached | None]] = {}
    for quantity, targets in TARGETS.items():
        reached: Reached | None = Reached(0, 0.0, "")
        found[quantity] = []
        for target in targets:
            if reached and math.isfinite(reached.seconds):
                reached = smallest(name, quantity, target, reference, reached.points)
            found[quantity].append(reached)
    return found


def table(found: dict[tuple[str, str, float], Reached | None], programs: Sequence[str]) -> str:
    """A row for each program: seconds, nodes, and how many times those of weier with edges between the nodes."""
    columns = [(quantity, target) for quantity, targets in TARGETS.items() for target in targets]
    head = ["program", *(f"{quantity} within {target:.0e}" for quantity, target in columns)]
    rows = [[LABELS[name], *(_cell(found, name, *column) for column in columns)] for name in programs]
    return markdown.table(head, rows)


def _cell(found: dict[tuple[str, str, float], Reached | None], name: str, quantity: str, target: float) -> str:
    reached, ours = found[name, quantity, target], found.get((OURS, quantity, target))
    if reached is None:
        return "not reached"
    if math.isinf(reached.seconds):
        return f"over {MAX_SECONDS:g} s"
    times = f"{significant(reached.seconds / ours.seconds, 2)} times, " if ours and name != OURS else ""
    return f"{times}{significant(reached.seconds, 2)} s, {reached.points} nodes"


def _words(reference: Exact) -> str:
    return (
        f"Contact patches take {reference.seconds:.3g} s for ten digits of both. Not reached: on the finest grid, of "
        f"{MAX_SIZES['h']} nodes for h and of {MAX_SIZES['R']} for differences. Over {MAX_SECONDS:g} s: the next "
        "grid was not tried. A try takes longer than a time here: by tighter tolerances, or six curves."
    )


def draw(programs: Sequence[str], reference: Exact, path: Path) -> None:
    """How the largest errors fall with the nodes, as PDF, SVG and PNG beside each other."""
    with matplotlib.style.context(style.SHEET, after_reset=True):
        figure, panels = style.column("", ["", ""], HEIGHT)
        for axes, quantity in zip(panels, TARGETS, strict=True):
            axes.set(xscale="log", yscale="log", xlabel=WORDS["points"], ylabel=f"largest error of ${quantity}$")
            axes.set_xscale("log", base=2)
            for name in programs:
                sizes = [size for size in SIZES if size <= DRAWN.get(name, 0)][:: 2 if name == "tamaas" else 1]
                residual = DRAWN_RESIDUALS[name not in EDGES]
                errors = [attempt(name, quantity, size, residual, reference).error for size in sizes]
                if sizes:
                    axes.plot(sizes, errors, **LOOKS[name], label=LABELS[name])
        figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=1, handlelength=3.2)
        save(figure, path)


@click.command(context_settings={"help_option_names": ["-h", "--help"], "show_default": True})
@click.option(
    "--programs", callback=parse_names, default=",".join(OTHERS[1:]), help="Programs to compare with weier."
)
@click.option("--output", type=click.Path(path_type=Path), default="results/benchmark", help="Folder to write to.")
@click.option("--figure/--no-figure", default=True, help="Whether to draw how errors fall with the nodes.")
def main(programs: list[str], output: Path, figure: bool) -> None:
    """Measure the time to a given error of h and R by weier, tamaas, ContactMechanics and slippy.

    Writes to_error.md and to_error.{png,svg,pdf}, and what each program took as to_error_NAME.json: a program that
    has this file is not run again.
    """
    use_one_thread()
    reference, compared = exact(), [*EDGES, *installed([name for name in programs if name not in EDGES])]
    attempt(OURS, "R", SIZES[0], 1e-6, reference)  # compiles
    found = {}
    for name in compared:
        path = output / f"to_error_{name}.json"
        if not path.exists():
            write_text(path, json.dumps(measure(name, reference), indent=1))
        for quantity, rows in json.loads(path.read_text()).items():
            for target, row in zip(TARGETS[quantity], rows, strict=True):
                found[name, quantity, target] = row and Reached(*row)
    write_text(
        output / "to_error.md", f"# Time to a given error\n\n{table(found, compared)}\n\n{_words(reference)}\n"
    )
    if figure:
        draw(compared, reference, output / "to_error.pdf")
    click.echo(table(found, compared))


if __name__ == "__main__":
    main()
