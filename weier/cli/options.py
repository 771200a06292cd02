"""Common options of commands. `weier.cli.call` reads their texts, and the library checks their values."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import click

from weier.data.files import check_target
from weier.methods.method import TOLERANCES
from weier.methods.registry import EXACT, METHODS, PLOTTED, WITHIN_TOLERANCE, infinite_names, names
from weier.methods.settings import described
from weier.scene.trace_keys import TRACE_KEYS, TraceKey
from weier.scene.yaml import read_yaml


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


def numbers(text: str) -> list[float]:
    """Return numbers with commas between; click reports a ValueError as a wrong value of its option."""
    return [float(part) for part in text.split(",")]


def indices(text: str) -> list[int]:
    """Return whole numbers with commas between."""
    return [int(part) for part in text.split(",")]


def setting(text: str) -> tuple[str, str, Any]:
    """Return method, name and value of a setting, as in "bem.points_per_wave=32"."""
    if not (found := re.fullmatch(r"(\w+)\.(\w+)=(.+)", text)):
        raise click.BadParameter(f'it must read "method.name=value", such as layer.points=48, got {text!r:.80}')
    return found[1], found[2], read_yaml(found[3]).values


FILE = click.Path(path_type=Path)
# Options of traces that take several numbers on the command line; several `shortest` are cases of a scene.
LISTS = {"columns": indices, "missing_value": numbers}
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
        type=numbers,
        help="Phases in radians: 1 for every wave but the first, or 0,1,2 for all m  [default: 0].",
    ),
    click.Option(["--seed"], type=int, help="Seed of random phases."),
)


def _trace_option(name: str, key: TraceKey) -> click.Option:
    """Return the option of a key of measured heights."""
    kind = click.Choice(key.kind) if isinstance(key.kind, tuple) else LISTS.get(name, key.kind)
    says = key.says.partition(" Several")[0] + " Several are separated by commas." * (name in LISTS)
    return click.Option([f"--{name.replace('_', '-')}"], type=kind, help=says)


TRACE_OPTIONS = tuple(_trace_option(name, key) for name, key in TRACE_KEYS.items())
TOLERANCE_OPTION = click.Option(
    ["--tolerance"],
    type=float,
    help=f"Accepted error of the compliance, in g_0, in {TOLERANCES}, for all methods that take one, or for auto.",
)
WORKERS_OPTION = click.Option(
    ["--workers"],
    type=int,
    default=1,
    show_default=True,
    help="Number of processes for several curves; -1 for one per core.",
)


def bodies_options(required: bool) -> list[click.Option]:
    """Return the options of two bodies and of pressures in Pa."""
    about = f"Use Pa, m and ohm m^2, or K m^2/W for heat, for two bodies. {SI}"
    pressures = (
        'With --si, instead of --loads: mean pressures in a unit, as in "1,10MPa" or "1:100:20MPa"; without a unit '
        "in Pa. Results have the unit that is given."
    )
    return [
        click.Option(["--si", "bodies"], type=FILE, required=required, help=about),
        click.Option(["--pressures"], required=required, help=pressures),
    ]


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
            help=f'Mean pressures in p_0*: "0.1,1", or first:last:count in equal ratios  [default: {default_loads}].',
        ),
        *bodies_options(False),
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
            type=setting,
            metavar="METHOD.NAME=VALUE",
            help="Setting of a method, such as bem.points_per_wave=32; repeatable.",
        ),
        WORKERS_OPTION,
    ]
