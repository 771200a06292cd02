"""The command and the page of a measurement: explanation, tables and provenance."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Sequence
from functools import wraps
from importlib import import_module
from inspect import cleandoc
from pathlib import Path
from typing import Any

import click
import numpy as np
from click.core import ParameterSource

from weier.data import provenance
from weier.data.files import check_target, write_text
from weier.kernels.blas import one_thread
from weier.methods.errors import ConvergenceError

CONTEXT = {"show_default": True, "help_option_names": ["-h", "--help"], "max_content_width": 100}


class Measurements(click.Group):
    """The commands of the modules of a package; bad input ends in one sentence."""

    def __init__(self, package: str, names: Sequence[str], summary: str) -> None:
        """Take the package, and the names and purposes of its measurements."""
        explanation = (
            f"{summary}\n\nEach command writes a page of Markdown, by default results/NAME/NAME.md, and prints it."
        )
        commands = {name: import_module(f"{package}.{name}").main for name in names}
        super().__init__(f"python -m {package}", commands, help=explanation, context_settings=CONTEXT)

    def invoke(self, context: click.Context) -> None:
        """Run the command, and report an error that is no fault of the program."""
        try:
            super().invoke(context)
        except (ValueError, ConvergenceError, OSError) as error:
            raise click.ClickException(str(error)) from None


def measurement(title: str) -> Callable[[Callable[..., Sequence[str]]], click.Command]:
    """Return a decorator that turns a function into the command named after its module.

    The function returns headings, paragraphs and tables of Markdown. Its docstring explains the measurement, in the
    page and in `--help`.
    """

    def command_of(measure: Callable[..., Sequence[str]]) -> click.Command:
        name, explanation = measure.__module__.removeprefix("weier.").split(".")[1], cleandoc(measure.__doc__ or "")

        @click.command(name, help=explanation, context_settings=CONTEXT)
        @click.option(
            "--output",
            type=click.Path(path_type=Path),
            default=Path("results", name, f"{name}.md"),
            callback=_checked,
            help="The page.",
        )
        @click.pass_context
        @wraps(measure)
        def command(context: click.Context, /, output: Path, **options: Any) -> None:
            with one_thread:
                parts = measure(**options)
            text = "\n\n".join([f"# {title}", explanation, *parts, _made_by(context)])
            write_text(output, f"{text}\n")
            click.echo(text)

        return command

    return command_of


def _checked(context: click.Context, option: click.Parameter, path: Path) -> Path:
    """Return the path of a page after checking that it can be written."""
    check_target(path)
    return path


def _made_by(context: click.Context) -> str:
    """Return the command line with the drawn seed, the versions and the date."""
    words = [context.command_path]
    for option in context.command.params:
        name, value = str(option.name), context.params[str(option.name)]
        given = context.get_parameter_source(name) is ParameterSource.COMMANDLINE or callable(option.default)
        if name != "output" and given:
            for one in value if isinstance(value, tuple) else [value]:
                words += [option.opts[0], shlex.quote(str(one))]
    names = {"product_version": "weier", "git_commit": "commit"}
    software = (
        f"{names.get(name, name.removesuffix('_version').replace('_', '-'))} {version}"
        for name, version in provenance.versions().items()
    )
    return f"Made by `{' '.join(words)}` on {provenance.run_date()}: {', '.join(software)}."


def number(value: float, form: str = ".0e") -> str:
    """Return a number in this format; empty for NaN."""
    return "" if np.isnan(value) else format(float(value), form)
