"""Common arguments and options of commands, and the parsing of their text."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, NamedTuple

import click

from weier import units
from weier.checks import checked_numbers, checked_workers
from weier.data.files import check_target
from weier.kernels.arrays import Array
from weier.methods.method import TOLERANCES
from weier.methods.registry import EXACT, METHODS, PLOTTED, WITHIN_TOLERANCE, infinite_names, names
from weier.methods.settings import defaults, described
from weier.scene.trace_keys import TRACE_KEYS, TraceKey
from weier.scene.yaml import number_or_word, parse_yaml
from weier.surface.loads import positive_loads

Command = Callable[..., Any]
Option = Callable[[Command], Command]

LOADS = "1e-3:4:40"  # From a single contact to full contact of usual profiles.
PLOTTED_LOADS = "1e-3:4:400"  # This many loads resolve the drops of the resistance at births.
MIN_LOADS = 2  # A line needs two points.
STDOUT = "-"  # A path of "-" stands for standard output, as in other programs.


def parse_phases(text: str) -> float | list[float]:
    """Return phases from "1", the phase of every wave but the first, or "0,1,2", the phases of all waves."""
    try:
        phases = [float(part) for part in text.split(",")]
    except ValueError:
        raise ValueError(f'phases must read "1" or "0,1,2", got {text!r:.80}') from None
    return phases if len(phases) > 1 else phases[0]


def check_free(path: Path, force: bool) -> None:
    """Refuse a file that exists unless it may be overwritten."""
    if path.exists() and not force:
        raise ValueError(f"{path} exists: name another file, or overwrite it by --force")


class Pressures(NamedTuple):
    """Mean pressures in Pa, and the first unit in which they were given; empty if there was none."""

    values: Array
    unit: str


def parse_pressures(text: str) -> Pressures:
    """Return positive pressures from a text such as "1,10MPa"."""
    given = listed_in_si("pressures", text, units.PASCAL)
    return Pressures(checked_numbers("pressures", given, "be positive", lambda p: p > 0), units.unit_in(text))


def listed_in_si(name: str, text: str, unit: str) -> list[float]:
    """Return numbers in an SI unit from the text of an option; report the assumed unit if the text has none."""
    values = units.listed(name, text, unit)
    if not units.unit_in(text):
        click.echo(f"--{name} {text}: taken in {unit}, since no unit is given", err=True)
    return values


def parse_settings(texts: Iterable[str]) -> dict[str, dict[str, Any]]:
    """Return settings of methods from texts such as "bem.points_per_wave=32"."""
    settings: dict[str, dict[str, Any]] = {}
    for text in texts:
        name, _, value = text.partition("=")
        method, _, setting = name.partition(".")
        if not (method and setting and value):
            raise ValueError(f'a setting must read "method.name=value", such as layer.points=48, got {text!r:.80}')
        try:
            settings.setdefault(method, {})[setting] = parse_yaml(value)
        except ValueError:
            raise ValueError(f"the value of a setting must be a number or a word, got {value!r:.80}") from None
    return settings


def _read(read: Callable[[Any], Any]) -> Callable[[click.Context, click.Parameter, Any], Any]:
    """Return a callback that parses the text of an option; a ValueError becomes an error of usage."""

    def callback(context: click.Context, option: click.Parameter, text: Any) -> Any:
        try:
            return None if text is None else read(text)
        except ValueError as error:
            raise click.BadParameter(str(error)) from None

    return callback


def writable(*suffixes: str) -> Callable[[click.Context, click.Parameter, Path | None], Path | None]:
    """Return a callback that checks, before anything is computed, that a file can be written."""

    def callback(context: click.Context, option: click.Parameter, path: Path | None) -> Path | None:
        if path is None or str(path) == STDOUT:
            return path
        check_target(path)
        if suffixes and path.suffix not in suffixes:
            known = ", ".join(filter(None, suffixes))
            raise click.BadParameter(f"the name must end in one of {known}, got {path.name}")
        if suffixes and not path.parent.exists():  # Unlike the pipeline, commands create no folders.
            raise click.BadParameter(f"there is no folder {path.parent}: make it first, or name another one")
        return path

    return callback


# The required options of a series, and all of its parameters.
NEEDED = {"-D": "D", "--gamma": "gamma", "-m": "m"}
SERIES = (*NEEDED.values(), "phases", "seed")
FILE = click.Path(path_type=Path)
SI = (
    "This YAML file has the values of weier.Interface, which may have units, as in E_1: 210 GPa; it may be a scene "
    "with the key interface. Traces have their own lambda_0 and g_0."
)
MAX_SECONDS = click.option("--max-seconds", type=click.FloatRange(0, min_open=True), help="Time limit, in seconds.")
FORCE = click.option("--force", is_flag=True, help="Overwrite files that exist.")
INTO = click.option(
    "-o",
    "--output",
    type=FILE,
    callback=writable(".nc", ".json", ".csv"),
    help="Write here: netCDF as .nc, or .json or .csv.",
)


def output(name: str, *suffixes: str, default: str | None = None, required: bool = True) -> Option:
    """Return an argument for an output file, with one of these suffixes if any are given."""
    return click.argument(
        name, type=FILE, default=default, required=required and default is None, callback=writable(*suffixes)
    )


SERIES_OPTIONS = (
    click.Option(["-D", "D"], type=float, help="Fractal dimension, between 1 and 2."),
    click.Option(["--gamma"], help='Ratio of successive wavelengths: 5 or "5/2".'),
    click.Option(
        ["-m", "m"], type=float, help=f"Number of waves, or inf for the methods {', '.join(infinite_names())}."
    ),
    click.Option(
        ["--phases"],
        callback=_read(parse_phases),
        help="Phases in radians: 1 for every wave but the first, or 0,1,2 for all m  [default: 0].",
    ),
    click.Option(["--seed"], type=int, help="Seed of random phases."),
)


SETTINGS = [f"{method.name}.{setting}=" for method in METHODS for setting in defaults(method)]
SOLUTION_OPTIONS = (
    click.Option(
        ["--method", "methods"],
        multiple=True,
        type=click.Choice(names()),
        help="Method of solution; repeatable. "
        f"{'. '.join(f'{method.name}: {method.summary}' for method in METHODS)}  "
        f"[default: {EXACT.name}, or {WITHIN_TOLERANCE.name} with a tolerance; for plot: {', '.join(PLOTTED)}].",
    ),
    click.Option(
        ["--tolerance"],
        type=float,
        help=f"Accepted error of the compliance, in g_0, in {TOLERANCES}, for all methods that take one, or for "
        "auto.",
    ),
    click.Option(
        ["--set", "settings"],
        multiple=True,
        metavar="METHOD.NAME=VALUE",
        shell_complete=lambda context, option, text: [name for name in SETTINGS if name.startswith(text)],
        callback=_read(parse_settings),
        help="Setting of a method, such as bem.points_per_wave=32; repeatable.",
    ),
    click.Option(
        ["--workers"],
        type=int,
        default=1,
        show_default=True,
        callback=_read(checked_workers),
        help="Number of processes for the curves of several methods; -1 for one per core.",
    ),
)


class SolvingCommand(click.Command):
    """A command with settings of methods, which its help lists below the options."""

    def parse_args(self, context: click.Context, args: list[str]) -> list[str]:
        """Refuse an option that is given twice; click would silently use the last value."""
        _, _, given = self.make_parser(context).parse_args(list(args))
        for option, count in Counter(given).items():
            if count > 1 and isinstance(option, click.Option) and not (option.multiple or option.is_flag):
                raise click.UsageError(
                    f"{option.opts[0]} must be given once, got {count} of it: a list of weier.solve, or a scene, "
                    "takes several surfaces"
                )
        return super().parse_args(context, args)

    def format_epilog(self, context: click.Context, formatter: click.HelpFormatter) -> None:
        """Write each setting with its default and meaning."""
        with formatter.section("Settings with their defaults, for --set"):
            formatter.write_dl(described(METHODS))


def _trace_option(name: str, key: TraceKey) -> click.Option:
    """Return the option of a key of measured heights; several numbers are separated by commas."""
    numbers = key.several and key.kind in (int, float)

    def read(text: Any) -> Any:
        if not numbers:
            return [number_or_word(one) for one in text] if key.kind is object and key.several else text
        try:
            return [key.kind(one) for one in text.split(",")]
        except ValueError:
            raise ValueError(f"{name} must be numbers, as in 0,2, got {text!r:.80}") from None

    return click.Option(
        [f"--{name.replace('_', '-')}"],
        type=click.Choice(key.kind) if isinstance(key.kind, tuple) else str if numbers else KINDS[key.kind],
        multiple=key.several and not numbers,
        callback=_read(read),
        help=f"{key.says} Repeatable." if key.several and not numbers else key.says,
    )


KINDS = {int: int, float: float, str: str, object: str}
TRACE_OPTIONS = (
    click.Option(
        ["--trace", "trace_file"],
        type=FILE,
        help="Instead of a series: a text file with heights in one or two columns, or an instrument file.",
    ),
    *(_trace_option(name, key) for name, key in TRACE_KEYS.items() if name != "longest"),
)


BODIES_OPTIONS = (
    click.Option(
        ["--si", "bodies"], type=FILE, help=f"Use Pa, m and ohm m^2, or K m^2/W for heat, for two bodies. {SI}"
    ),
    click.Option(
        ["--pressures"],
        callback=_read(parse_pressures),
        help='With --si, instead of --loads: mean pressures in a unit, as in "1,10MPa", "900kPa,2MPa" or '
        '"1:100:20MPa"; without a unit in Pa. Results have the unit that is given.',
    ),
)


def one_profile_options(default_loads: str) -> list[click.Parameter]:
    """Return the options of a profile, its loads and the methods."""
    loads = click.Option(
        ["--loads"],
        default=default_loads,
        show_default=True,
        callback=_read(lambda text: positive_loads(units.listed("loads", text, units.NORMALISED_PRESSURE))),
        help='Mean pressures in p_0*: "0.1,1", or first:last:count in equal ratios.',
    )
    return [*SERIES_OPTIONS, *TRACE_OPTIONS, loads, *BODIES_OPTIONS, *SOLUTION_OPTIONS]


def profile_or_trace(trace_file: Path | None, **options: Any) -> dict[str, Any]:
    """Return the parameters of a profile or a trace, as in a scene, from the options of a command."""
    given = {name: value for name, value in options.items() if value not in (None, (), [])}
    series = {name: given.pop(name) for name in SERIES if name in given}
    if trace_file is not None:
        if "across" in given and "line" not in given:
            raise click.UsageError("--across names the axis of a line: give its number by --line")
        if series:
            raise click.UsageError(f"a trace has no {', '.join(series)}: take --trace or a series")
        return {"trace": {"file": str(trace_file), **given}}
    if given:
        raise click.UsageError(f"--{next(iter(given)).replace('_', '-')} is of a trace: name its file by --trace")
    if missing := [option for option, name in NEEDED.items() if name not in series]:
        raise click.UsageError(f"a profile takes -D, --gamma and -m, or --trace; missing: {', '.join(missing)}")
    if {"phases", "seed"} <= series.keys():
        raise click.UsageError("a profile takes --phases or --seed, got both")
    return series | {"m": int(series["m"]) if series["m"].is_integer() else series["m"]}
