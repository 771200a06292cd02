"""Common arguments and options of commands, and how their texts are read."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from weier import units
from weier.checks import checked_numbers
from weier.data.files import check_target
from weier.kernels.arrays import Array
from weier.methods.method import TOLERANCES
from weier.methods.registry import EXACT, METHODS, PLOTTED, WITHIN_TOLERANCE, infinite_names, names
from weier.methods.settings import described
from weier.scene.trace_keys import TRACE_KEYS, TraceKey
from weier.scene.yaml import parse_yaml
from weier.surface.loads import positive_loads

Pressures = tuple[Array, str]  # values in Pa, and the unit given first, or empty


class Text(click.ParamType):  # type: ignore[type-arg]  # not generic in click 8.1
    """A text that a function reads; its ValueError is wrong usage."""

    name = "text"

    def __init__(self, read: Callable[[str], Any]) -> None:
        self.read = read

    def convert(self, value: str, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return what the function reads."""
        try:
            return self.read(value)
        except ValueError as error:
            self.fail(str(error), param, ctx)


class Output(click.Path):
    """A file that can be written, which is checked before anything is computed, with one of these suffixes."""

    def __init__(self, *suffixes: str) -> None:
        super().__init__(path_type=Path)
        self.suffixes = suffixes

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        """Return the path."""
        check_target(path := Path(value))
        if path.suffix not in self.suffixes:
            self.fail(f"the name must end in one of {', '.join(self.suffixes)}, got {path.name}", param, ctx)
        return path


def check_free(path: Path, force: bool) -> None:
    """Refuse a file that exists unless it may be overwritten."""
    if path.exists() and not force:
        raise ValueError(f"{path} exists: name another file, or overwrite it by --force")


def check_line(loads: Array) -> None:
    """Refuse a single load, which gives no line in a figure."""
    if len({*loads}) < 2:
        raise click.BadParameter("a figure takes at least 2 loads, got 1: give a range, such as 1e-3:4:40")


def read_loads(text: str) -> Array:
    """Return positive loads from a text such as "0.1,1" or "1e-3:4:40"."""
    return positive_loads(units.listed("loads", text, units.NORMALISED_PRESSURE)[0])


def _read_pressures(text: str) -> Pressures:
    values, unit = units.listed("pressures", text, units.PASCAL)
    if not unit:
        click.echo(f"--pressures {text}: taken in Pa, since no unit is given", err=True)
    return checked_numbers("pressures", values, "be positive", lambda p: p > 0), unit


def _parts(text: str, kind: Callable[[str], Any], what: str) -> list[Any]:
    """Return values with commas between; ValueError says what they should be."""
    try:
        return [kind(part) for part in text.split(",")]
    except ValueError:
        raise ValueError(f"expected {what} with commas between, got {text!r:.80}") from None


def _read_phases(text: str) -> float | list[float]:
    phases = _parts(text, float, "numbers")
    return phases if len(phases) > 1 else phases[0]


def _read_setting(text: str) -> tuple[str, str, Any]:
    """Return method, name and value from a text such as "bem.points_per_wave=32"."""
    name, _, value = text.partition("=")
    method, _, setting = name.partition(".")
    if not (method and setting and value):
        raise ValueError(f'a setting must read "method.name=value", such as layer.points=48, got {text!r:.80}')
    return method, setting, parse_yaml(value)


# The required options of a series, and all of its parameters.
NEEDED = {"-D": "D", "--gamma": "gamma", "-m": "m"}
SERIES = (*NEEDED.values(), "phases", "seed")
FILE, COUNT = click.Path(path_type=Path), click.IntRange(min=0)
SI = (
    "This YAML file has the values of weier.Interface, which may have units, as in E_1: 210 GPa; it may be a scene "
    "with the key interface. Traces have their own lambda_0 and g_0."
)
FORCE = click.option("--force", is_flag=True, help="Overwrite files that exist.")
SETTINGS = "\n\n".join(["Settings with their defaults, for --set:", *map(": ".join, described(METHODS))])

SERIES_OPTIONS = (
    click.Option(["-D", "D"], type=float, help="Fractal dimension, between 1 and 2."),
    click.Option(["--gamma"], help='Ratio of successive wavelengths: 5 or "5/2".'),
    click.Option(
        ["-m", "m"], type=float, help=f"Number of waves, or inf for the methods {', '.join(infinite_names())}."
    ),
    click.Option(
        ["--phases"],
        type=Text(_read_phases),
        help="Phases in radians: 1 for every wave but the first, or 0,1,2 for all m  [default: 0].",
    ),
    click.Option(["--seed"], type=COUNT, help="Seed of random phases."),
)


def _trace_option(name: str, key: TraceKey) -> click.Option:
    """Return the option of a key of measured heights; several values are separated by commas."""
    kind: Any = click.Choice(key.kind) if isinstance(key.kind, tuple) else {int: COUNT}.get(key.kind, key.kind)
    several = key.several and name != "shortest"  # several of these are cases of a scene
    if several:
        kind = Text(lambda text: _parts(text, key.kind, "whole numbers" if key.kind is int else "numbers"))
    words = f"{key.says} Several are separated by commas." if several else key.says.partition(" Several")[0]
    return click.Option([f"--{name.replace('_', '-')}"], type=kind, help=words)


TRACE_OPTIONS = tuple(_trace_option(name, key) for name, key in TRACE_KEYS.items() if name != "longest")
TOLERANCE_OPTION = click.Option(
    ["--tolerance"],
    type=click.FloatRange(TOLERANCES.least, TOLERANCES.most, max_open=TOLERANCES.half_open),
    help=f"Accepted error of the compliance, in g_0, in {TOLERANCES}, for all methods that take one, or for auto.",
)
WORKERS_OPTION = click.Option(
    ["--workers"],
    type=int,
    default=1,
    show_default=True,
    help="Number of processes for several curves; -1 for one per core.",
)
BODIES_OPTIONS = (
    click.Option(
        ["--si", "bodies"], type=FILE, help=f"Use Pa, m and ohm m^2, or K m^2/W for heat, for two bodies. {SI}"
    ),
    click.Option(
        ["--pressures"],
        type=Text(_read_pressures),
        help='With --si, instead of --loads: mean pressures in a unit, as in "1,10MPa" or "1:100:20MPa"; without a '
        "unit in Pa. Results have the unit that is given.",
    ),
)


def one_profile_options(default_loads: str) -> list[click.Parameter]:
    """Return the options of a profile, its loads and the methods."""
    return [
        *SERIES_OPTIONS,
        click.Option(
            ["--trace", "trace_file"],
            type=FILE,
            help="Instead of a series: a text file with heights in one or two columns, or an instrument file.",
        ),
        *TRACE_OPTIONS,
        click.Option(
            ["--loads"],
            type=Text(read_loads),
            help=f'Mean pressures in p_0*: "0.1,1", or first:last:count in equal ratios  [default: {default_loads}].',
        ),
        *BODIES_OPTIONS,
        click.Option(
            ["--method", "methods"],
            multiple=True,
            type=click.Choice(names()),
            help="Method of solution; repeatable. "
            f"{'. '.join(f'{method.name}: {method.summary}' for method in METHODS)}  "
            f"[default: {EXACT.name}, or {WITHIN_TOLERANCE.name} with a tolerance; for plot: {', '.join(PLOTTED)}].",
        ),
        TOLERANCE_OPTION,
        click.Option(
            ["--set", "settings"],
            multiple=True,
            metavar="METHOD.NAME=VALUE",
            type=Text(_read_setting),
            help="Setting of a method, such as bem.points_per_wave=32; repeatable.",
        ),
        WORKERS_OPTION,
    ]
