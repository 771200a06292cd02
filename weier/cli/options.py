"""Common arguments and options of commands, and the parsing of their text."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import click

from weier import units
from weier.checks import checked_numbers, checked_workers
from weier.data.files import check_target
from weier.kernels.arrays import Array
from weier.methods.method import TOLERANCES
from weier.methods.registry import EXACT, METHODS, PLOTTED, WITHIN_TOLERANCE, infinite_names, names
from weier.methods.settings import described
from weier.scene.trace_keys import TRACE_KEYS, TraceKey
from weier.scene.yaml import number_or_word, parse_yaml
from weier.surface.loads import positive_loads

Command = Callable[..., Any]
Option = Callable[[Command], Command]
Pressures = tuple[Array, str]  # values in Pa, and the unit given first, or empty

LOADS = "1e-3:4:40"  # covers a single contact to full contact for usual profiles
PLOTTED_LOADS = "1e-3:4:400"  # This many loads resolve the drops of the resistance at births.


def _numbers(name: str, text: str, kind: type) -> list[Any]:
    """Parse comma-separated numbers."""
    try:
        return [kind(part) for part in text.split(",")]
    except ValueError:
        raise ValueError(f"{name} must be numbers with commas between, as in 0,2, got {text!r:.80}") from None


def parse_phases(text: str) -> float | list[float]:
    """Return phases from "1", the phase of every wave but the first, or "0,1,2", the phases of all waves."""
    phases = _numbers("phases", text, float)
    return phases if len(phases) > 1 else phases[0]


def check_free(path: Path, force: bool) -> None:
    """Refuse a file that exists unless it may be overwritten."""
    if path.exists() and not force:
        raise ValueError(f"{path} exists: name another file, or overwrite it by --force")


def check_line(loads: Array) -> None:
    """Refuse a single load, which gives no line in a figure."""
    if len({*loads}) < 2:
        raise click.BadParameter("a figure takes at least 2 loads, got 1: give a range, such as 1e-3:4:40")


def parse_pressures(text: str) -> Pressures:
    """Return positive pressures in Pa from a text such as "1,10MPa", and their unit."""
    given = units.listed("pressures", text, units.PASCAL)
    if not units.unit_in(text):
        click.echo(f"--pressures {text}: taken in Pa, since no unit is given", err=True)
    return checked_numbers("pressures", given, "be positive", lambda p: p > 0), units.unit_in(text)


def parse_settings(texts: Iterable[str]) -> dict[str, dict[str, Any]]:
    """Return settings of methods from texts such as "bem.points_per_wave=32"."""
    settings: dict[str, dict[str, Any]] = {}
    for text in texts:
        name, _, value = text.partition("=")
        method, _, setting = name.partition(".")
        if not (method and setting and value):
            raise ValueError(f'a setting must read "method.name=value", such as layer.points=48, got {text!r:.80}')
        settings.setdefault(method, {})[setting] = parse_yaml(value)
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
        if path is None:
            return None
        check_target(path)
        if suffixes and path.suffix not in suffixes:
            raise click.BadParameter(f"the name must end in one of {', '.join(suffixes)}, got {path.name}")
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
FORCE = click.option("--force", is_flag=True, help="Overwrite files that exist.")


def output(name: str, *suffixes: str, required: bool = True) -> Option:
    """Return an argument for an output file, limited to the suffixes, if any."""
    return click.argument(name, type=FILE, required=required, callback=writable(*suffixes))


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

    def format_epilog(self, context: click.Context, formatter: click.HelpFormatter) -> None:
        """Write each setting with its default and meaning."""
        with formatter.section("Settings with their defaults, for --set"):
            formatter.write_dl(described(METHODS))


def _trace_option(name: str, key: TraceKey) -> click.Option:
    """Return the option of a key of measured heights; several numbers of columns are separated by commas."""
    columns, repeatable = key.kind is int and key.several, key.several and key.kind in (str, object)

    def read(given: Any) -> Any:
        if columns:
            return _numbers(name, given, int)
        return [number_or_word(one) for one in given] if key.kind is object and key.several else given

    return click.Option(
        [f"--{name.replace('_', '-')}"],
        type=click.Choice(key.kind) if isinstance(key.kind, tuple) else KINDS[str if columns else key.kind],
        multiple=repeatable,
        callback=_read(read),
        help=f"{key.says} Repeatable." if repeatable else key.says.partition(" Several")[0],
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
