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

OVERWRITE = "overwrite"  # key of the context: whether files may be replaced


class Output(click.Path):
    """A file that can be written, with one of these suffixes; `FORCE` lets it replace another.

    It is checked before anything is computed.
    """

    def __init__(self, *suffixes: str) -> None:
        super().__init__(path_type=Path)
        self.suffixes = suffixes

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        """Return the path."""
        check_target(path := Path(value))
        if path.suffix not in self.suffixes:
            self.fail(f"the name must end in one of {', '.join(self.suffixes)}, got {path.name}", param, ctx)
        if path.exists() and ctx and not ctx.meta[OVERWRITE]:
            raise ValueError(f"{path} exists: name another file, or overwrite it by --force")
        return path


def numbers(text: str) -> list[float]:
    """Return numbers with commas between."""
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise click.BadParameter(f"it must be numbers with commas between, such as 0,2, got {text!r:.80}") from None


def setting(text: str) -> tuple[str, str, Any]:
    """Return method, name and value of a setting, as in "bem.points_per_wave=32"."""
    if not (found := re.fullmatch(r"(\w+)\.(\w+)=(.+)", text)):
        raise click.BadParameter(f'it must read "method.name=value", such as layer.points=48, got {text!r:.80}')
    return found[1], found[2], read_yaml(found[3]).values


FILE = click.Path(path_type=Path)
FORCE = click.option(
    "--force",
    is_flag=True,
    is_eager=True,  # known before the names of outputs are checked
    expose_value=False,
    callback=lambda ctx, param, force: ctx.meta.update({OVERWRITE: force}),
    help="Overwrite files that exist.",
)
SETTINGS = "\n\n".join(["Settings with their defaults, for --set:", *map(": ".join, described(METHODS))])


def _trace_option(name: str, key: TraceKey) -> click.Option:
    """Return the option of a key of measured heights."""
    kind = click.Choice(key.kind) if isinstance(key.kind, tuple) else key.kind
    if key.several and name != "shortest":  # of which a scene makes a case each
        kind = numbers
    return click.Option([f"--{name.replace('_', '-')}"], type=kind, help=key.says.partition(" Several")[0])


def si_option(required: bool = False) -> click.Option:
    """Return the option of two bodies."""
    return click.Option(
        ["--si", "bodies"],
        type=FILE,
        required=required,
        help="Use Pa, m and ohm m^2, or K m^2/W for heat, for two bodies. This YAML file has the values of "
        "weier.Interface, which may have units, as in E_1: 210 GPa; it may be a scene with the key interface. Traces "
        "have their own lambda_0 and g_0.",
    )


def solution_options(required: bool = False) -> list[click.Parameter]:
    """Return the options of measured heights, two bodies, pressures, which may be required, and the solution."""
    return [
        *[_trace_option(name, key) for name, key in TRACE_KEYS.items()],
        si_option(required),
        click.Option(
            ["--pressures"],
            required=required,
            help='With --si, instead of --loads: mean pressures in a unit, as in "1,10MPa" or "1:100:20MPa"; without '
            "a unit in Pa. Results have the unit that is given.",
        ),
        click.Option(
            ["--tolerance"],
            type=float,
            help=f"Accepted error of the compliance, in g_0, in {TOLERANCES}, for all methods that take one, or for "
            "auto.",
        ),
        click.Option(
            ["--workers"],
            type=int,
            default=1,
            show_default=True,
            help="Number of processes for several curves; -1 for one per core.",
        ),
    ]


def one_profile_options(default_loads: str) -> list[click.Parameter]:
    """Return the options of a profile, its loads and the methods."""
    return [
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
        click.Option(
            ["--trace", "trace_file"],
            type=FILE,
            help="Instead of a series: a text file with heights in one or two columns.",
        ),
        click.Option(
            ["--loads"],
            help=f'Mean pressures in p_0*: "0.1,1", or first:last:count in equal ratios  [default: {default_loads}].',
        ),
        click.Option(
            ["--method", "methods"],
            multiple=True,
            type=click.Choice(names()),
            help="Method of solution; repeatable. "
            f"{'. '.join(f'{method.name}: {method.summary}' for method in METHODS)}  "
            f"[default: {EXACT.name}, or {WITHIN_TOLERANCE.name} with a tolerance; for plot: {', '.join(PLOTTED)}].",
        ),
        click.Option(
            ["--set", "settings"],
            multiple=True,
            type=setting,
            metavar="METHOD.NAME=VALUE",
            help="Setting of a method, such as bem.points_per_wave=32; repeatable.",
        ),
        *solution_options(),
    ]
