"""Several measured lines under the same pressures, as tables and figures: `weier report`."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from importlib import import_module
from itertools import compress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from weier.cli import options
from weier.cli.bodies_file import STATISTIC_SUFFIX, read_bodies, table_of
from weier.data import markdown
from weier.data.ensembles import CLOSE_CUTOFFS
from weier.data.files import replacing, write_text
from weier.data.variables import LOADS, Status
from weier.scene import Figure
from weier.scene.case import Case, trace_parameters
from weier.scene.figure import BY_DEFAULT, Grouping

if TYPE_CHECKING:
    import pandas as pd

    from weier.surface.measured.trace import Trace

# Columns of ensembles in a report, and their headings.
COLUMNS = {
    "mean_pressure": "mean pressure",
    "resistance_median": "resistance, median",
    "resistance_percentile_10": "resistance, 10 %",
    "resistance_percentile_90": "resistance, 90 %",
    "resistance_numerical_error": "resistance, numerical error",
    "compliance_median": "compliance, median",
    "contact_fraction_median": "contact fraction, median",
    "contact_pressure_median": "mean pressure of the contacts, median",
}
ENSEMBLE_COLUMNS = ("resistance_percentile_10", "resistance_percentile_90")  # omitted for a single line
MAX_DIGITS, ERROR_DIGITS = 5, 2  # maximum significant digits of quantities and of errors
TABLES, PICTURES, DATA = (".csv", ".xlsx", ".tex", ".md"), (".png", ".pdf", ".svg"), ".nc"
PACKAGES = {".xlsx": "openpyxl", ".tex": "jinja2"}
WRITABLE = options.writable(*TABLES, *PICTURES, DATA)
UNIT, POINT = re.compile(r" \(.*\)$"), re.compile(r"\.(?=$|e)")


@click.command(
    params=[
        *options.TRACE_OPTIONS[1:],
        *options.BODIES_OPTIONS,
        *(one for one in options.SOLUTION_OPTIONS if one.name in ("tolerance", "workers")),
    ]
)
@click.argument("files", nargs=-1, required=True, type=options.FILE)
@click.option(
    "-o",
    "--output",
    "outputs",
    multiple=True,
    type=options.FILE,
    callback=lambda context, option, paths: [WRITABLE(context, option, path) for path in paths],
    help="Write here, by the suffix: a table as .csv, .xlsx, .tex or .md, a figure as .png, .pdf or .svg, all data "
    "as .nc; repeatable. By default, the table is printed.",
)
@click.option("--all", "everything", is_flag=True, help="Write tables of all columns and digits, one row per line.")
@options.FORCE
@options.MAX_SECONDS
def report(
    files: Sequence[Path],
    outputs: Sequence[Path],
    everything: bool,
    force: bool,
    bodies: Path | None,
    pressures: options.Pressures | None,
    tolerance: float | None,
    workers: int,
    max_seconds: float | None,
    **trace_options: Any,
) -> None:
    """Report the contact resistance of measured lines.

    FILES are traces of heights, one line of one surface each. A row of the table has the median of the resistance
    over the lines, its 10 and 90 % percentiles and its largest numerical error, in the unit of the pressures and in
    SI units. Resistances and compliances are rounded to the digits that their errors leave, at most five, contact
    fractions and the mean pressures of the contacts to five digits.

    \b
    weier report shaft*.csv --si bodies.yaml --pressures 1:100:20MPa -o report.csv -o report.png
    weier report shaft.csv --x-unit mm --height-unit um --si bodies.yaml --pressures 1,10MPa
    """  # noqa: D301 - click wants the character
    if bodies is None or pressures is None:
        raise click.UsageError("a report needs the two bodies, by --si, and the mean pressures, by --pressures")
    loads = np.unique(pressures.values)
    _check_outputs(outputs, files, force, loads.size)
    from weier.api.solve import solve_under  # xarray takes half a second, and the help needs none of it
    from weier.cli import result
    from weier.data import dataset
    from weier.data.si import with_pressures_in

    both, lines = read_bodies(bodies), _lines(files, trace_options)
    settings: dict[str, Any] = {"workers": workers, "max_seconds": max_seconds}
    settings |= {} if tolerance is None else {"tolerance": tolerance}
    solved = solve_under(lines, loads, both.loads_of(loads), **settings)
    done = (solved["status"] == Status.solved).values[:, 0]
    if not done.any():
        raise ValueError("no line could be solved, for the reasons above")
    data = with_pressures_in(both.in_si(solved), pressures.unit)
    of_all = len({line.digest for line in lines})
    lines = list(compress(lines, done))
    count = len({line.digest for line in lines})
    counted = f"{count} of {of_all}" if count < of_all else f"{count}"
    title = f"{counted} line{'s' * (of_all > 1)}: {', '.join(dict.fromkeys(line.source for line in lines))}"
    table = table_of(data) if everything else rounded(table_of(data, ensemble=True), count > 1)
    for path in outputs:
        if path.suffix == DATA:
            dataset.write(data, path, title, "solved")
        elif path.suffix in PICTURES:
            from weier.figures import draw

            grouping = Grouping(median_over=("trace",)) if count > 1 else BY_DEFAULT
            figure = Figure("resistance", grouping=grouping, interface=both)
            draw(figure, [with_pressures_in(solved, pressures.unit)], path, [path.suffix[1:]])
        else:
            _write_table(table, path, title)
    if not outputs:
        click.echo(_markdown(table, title), nl=False)
    result.check_solved(solved)


def _check_outputs(outputs: Sequence[Path], files: Sequence[Path], force: bool, loads: int) -> None:
    """Refuse outputs that exist, are inputs, or cannot be written, before anything is read."""
    inputs = {file.resolve() for file in files}
    for path in outputs:
        if path.resolve() in inputs:
            raise click.BadParameter(f"{path} is one of FILES: name another output, or fewer files")
        options.check_free(path, force)
        if path.suffix in PICTURES and loads < options.MIN_LOADS:
            raise click.BadParameter(f"a figure takes at least {options.MIN_LOADS} pressures, got {loads}")
        if path.suffix in PACKAGES:  # an extra installs it; the error names it
            import_module(PACKAGES[path.suffix])


def _lines(files: Sequence[Path], trace_options: Mapping[str, Any]) -> list[Trace]:
    """Return the lines of all files; ValueError unless they have one shortest wavelength, within 1 %."""
    parameters = []
    for file in files:
        trace = options.profile_or_trace(file, **trace_options)["trace"]
        try:
            parameters += trace_parameters(trace, Path())
        except ValueError as error:
            raise (ValueError(f"{file}: {error}") if len(files) > 1 else error) from None
    lines = [Case({"trace": one}, (), {}).profile for one in parameters]
    shortest = sorted(line.shortest for line in lines)
    if shortest[-1] > (1 + CLOSE_CUTOFFS) * shortest[0]:
        raise ValueError(
            f"lines must have one shortest wavelength, got {shortest[0]:.4g} to {shortest[-1]:.4g} m, two steps of "
            f"each file by default: give {shortest[-1]:.4g} m or more by --shortest, in m or in the unit of positions"
        )
    return lines


def rounded(ensemble: pd.DataFrame, several: bool) -> pd.DataFrame:
    """Return the columns of a report as texts, rounded to the digits that numerical errors justify."""
    import pandas as pd

    headings = {UNIT.sub("", name): name for name in ensemble}
    found = {}
    for name, meaning in COLUMNS.items():
        if name not in headings or (name in ENSEMBLE_COLUMNS and not several):
            continue
        values = ensemble[headings[name]].tolist()
        error = headings.get(f"{STATISTIC_SUFFIX.sub('', name)}_numerical_error")
        if name == LOADS:
            texts = [f"{value:.{MAX_DIGITS}g}" for value in values]
        elif error == headings[name]:
            texts = [_text(value, ERROR_DIGITS) for value in values]
        else:
            errors = [0.0] * len(values) if error is None else ensemble[error].tolist()
            texts = [_text(*pair) for pair in zip(values, map(_digits, values, errors), strict=True)]
        unit = headings[name].removeprefix(name)
        found[(meaning if several else meaning.removesuffix(", median")) + unit] = texts
    return pd.DataFrame(found)


def _digits(value: float, error: float) -> int:
    """Return the significant digits of a value down to the first digit of its error."""
    if not (value and error > 0):
        return MAX_DIGITS
    return min(max(math.floor(math.log10(abs(value))) - math.floor(math.log10(error)) + 1, 1), MAX_DIGITS)


def _text(value: float, digits: int) -> str:
    """Return a number with all its significant digits; empty if it is missing."""
    if not (value and math.isfinite(value)):
        return "0" if value == 0 else ""
    return POINT.sub("", f"{value:#.{digits}g}")


def _write_table(table: pd.DataFrame, path: Path, title: str) -> None:
    """Write a table in the format of a suffix."""
    import pandas as pd

    if path.suffix == ".xlsx":
        numbers = table.apply(pd.to_numeric, errors="coerce")
        with replacing(path) as temporary, temporary.open("wb") as file:
            numbers.where(numbers.notna(), table).to_excel(file, index=False, engine="openpyxl")
    elif path.suffix == ".csv":
        write_text(path, table.to_csv(index=False))
    elif path.suffix == ".tex":
        write_text(path, f"% {title}\n{table.to_latex(index=False, escape=True)}")
    else:
        write_text(path, _markdown(table, title))


def _markdown(table: pd.DataFrame, title: str) -> str:
    """Return a table below its title in Markdown."""
    head, *rows = ([markdown.plain(str(cell)) for cell in row] for row in (table, *table.fillna("").to_numpy()))
    return f"{markdown.plain(title)}\n\n{markdown.table(head, rows)}\n"
