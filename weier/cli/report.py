"""`weier report`: tables and figures of several measured lines under common pressures."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from importlib import import_module
from itertools import compress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from weier.cli import options
from weier.data import markdown
from weier.data.ensembles import CLOSE_CUTOFFS
from weier.data.files import replacing, write_text
from weier.scene import Grouping

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
MAX_DIGITS = 5
TABLES, PICTURES, DATA = (".csv", ".xlsx", ".tex", ".md"), (".png", ".pdf", ".svg"), ".nc"
PACKAGES = {".xlsx": "openpyxl", ".tex": "jinja2"}
WRITABLE = options.writable(*TABLES, *PICTURES, DATA)
UNIT, STATISTIC = re.compile(r" \(.*\)$"), re.compile(r"_(median|percentile_\d+|numerical_error)$")


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
    help="Write here, by the suffix: a table as .csv, .xlsx, .tex or .md, a figure as .png, .pdf or .svg, all "
    "curves as .nc; repeatable. By default, the table is printed.",
)
@click.option("--all", "everything", is_flag=True, help="Write tables of all columns and digits, one row per line.")
@options.FORCE
def report(
    files: Sequence[Path],
    outputs: Sequence[Path],
    everything: bool,
    force: bool,
    bodies: Path | None,
    pressures: options.Pressures | None,
    tolerance: float | None,
    workers: int,
    **trace_options: Any,
) -> None:
    """Report the contact resistance of measured lines.

    FILES are traces of heights, one line of one surface each. A row of the table has the median of the resistance
    over the lines, its 10 and 90 % percentiles and its largest numerical error, in the unit of the pressures and in
    SI units, rounded to the first digit of the numerical error. After Ctrl-C, it covers the lines solved so far.

    \b
    weier report shaft*.csv --si bodies.yaml --pressures 1:100:20MPa -o report.csv -o report.png
    weier report shaft.csv --x-unit mm --height-unit um --si bodies.yaml --pressures 1,10MPa
    """  # noqa: D301 - click wants the character
    if bodies is None or pressures is None:
        raise click.UsageError("a report needs the two bodies, by --si, and the mean pressures, by --pressures")
    for path in outputs:  # is checked before any file is read
        if path.resolve() in {file.resolve() for file in files}:
            raise click.BadParameter(f"{path} is one of FILES: name another output")
        options.check_free(path, force)
        if path.suffix in PICTURES:
            options.check_line(pressures[0])
        if path.suffix in PACKAGES:
            import_module(PACKAGES[path.suffix])  # an extra installs it; the error names it
    from weier.cli.call import Call  # xarray takes half a second, and the help needs none of it
    from weier.cli.result import check_solved, table_of
    from weier.data import dataset

    lines = _lines(files, trace_options)
    call = Call.from_options(lines, pressures[0], bodies, pressures, tolerance=tolerance)
    curves, stop = call.solve(workers)
    done = curves["compliance"].notnull().all(("solution_method", "mean_pressure")).values
    all_count, lines = len({line.digest for line in lines}), list(compress(lines, done))
    if not lines:
        raise stop or ValueError("no line could be solved at all loads, for the reasons above")
    solved = curves.isel(case=done)
    data, count = call.in_units(solved), len({line.digest for line in lines})
    counted = f"{count} of {all_count}" if count < all_count else f"{count}"
    title = f"{counted} line{'s' * (all_count > 1)}: {', '.join(dict.fromkeys(line.source for line in lines))}"
    table = table_of(data) if everything else _columns(table_of(data, ensemble=True), count > 1)
    for path in outputs:
        if path.suffix == DATA:
            dataset.write(data, path, title, "solved")
        elif path.suffix in PICTURES:
            call.draw(solved, path, "resistance", Grouping(median_over=("trace",) * (count > 1)))
        else:
            _write_table(table, path)
    click.echo(title, err=bool(outputs))
    if not outputs:
        click.echo(_markdown(table), nl=False)
    if stop is not None:
        raise stop
    check_solved(curves)


def _lines(files: Sequence[Path], trace_options: dict[str, Any]) -> list[Trace]:
    """Return the lines of all files; ValueError unless they have one shortest wavelength, within 1 %."""
    from weier.cli.call import lines_of

    given = {name: value for name, value in trace_options.items() if value not in (None, (), [])}
    lines = [line for file in files for line in lines_of(file, **given)]
    shortest = sorted(line.shortest for line in lines)
    if shortest[-1] > (1 + CLOSE_CUTOFFS) * shortest[0]:
        raise ValueError(
            f"lines must have one shortest wavelength, got {shortest[0]:.4g} to {shortest[-1]:.4g} m, two steps of "
            f"each file by default: give {shortest[-1]:.4g} m or more by --shortest, in m or in the unit of positions"
        )
    return lines


def _columns(ensemble: pd.DataFrame, several: bool) -> pd.DataFrame:
    """Return the columns of a report with headings and units, rounded by their numerical errors.

    A single line has no percentiles, and its headings name the quantity alone.
    """
    names = {UNIT.sub("", name): name for name in ensemble}
    found = {}
    for name, meaning in COLUMNS.items():
        if name in names and (several or "percentile" not in name):
            values = ensemble[names[name]]
            errors = ensemble.get(names.get(f"{STATISTIC.sub('', name)}_numerical_error"), 0 * values)
            heading = meaning if several else meaning.removesuffix(", median")
            found[heading + names[name].removeprefix(name)] = list(map(_rounded, values, errors))
    return type(ensemble)(found)


def _rounded(value: float, error: float) -> float:
    """Return a value rounded to the first digit of its error, and an error to its second; at most five digits."""
    if not (value and math.isfinite(value)):
        return value
    below = math.floor(math.log10(abs(value))) - math.floor(math.log10(error)) if error > 0 else MAX_DIGITS
    return float(f"{value:.{min(max(below + 1 + (value == error), 1), MAX_DIGITS)}g}")


def _write_table(table: pd.DataFrame, path: Path) -> None:
    """Write a table in the format of a suffix."""
    if path.suffix == ".csv":
        write_text(path, table.to_csv(index=False))
    elif path.suffix == ".tex":
        write_text(path, table.to_latex(index=False, escape=True, float_format=str))
    elif path.suffix == ".md":
        write_text(path, _markdown(table))
    else:
        with replacing(path) as temporary, temporary.open("wb") as file:
            table.to_excel(file, index=False, engine="openpyxl")


def _markdown(table: pd.DataFrame) -> str:
    head, *rows = ([markdown.plain(str(cell)) for cell in row] for row in (table, *table.to_numpy().tolist()))
    return f"{markdown.table(head, rows)}\n"
