"""The command of a measurement, which prints a page: explanation, tables and provenance."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Callable, Sequence
from functools import wraps
from importlib import import_module
from inspect import cleandoc
from typing import Any

import click
import numpy as np

from weier.data import provenance
from weier.kernels.blas import one_thread
from weier.methods.errors import ConvergenceError

CONTEXT = {"show_default": True, "help_option_names": ["-h", "--help"], "max_content_width": 100}


def commands(package: str, names: Sequence[str], summary: str) -> click.Group:
    """Return the command line of a package, with the command `main` of each named module."""
    found = {name: import_module(f"{package}.{name}").main for name in names}
    return click.Group(f"python -m {package}", found, help=summary, context_settings=CONTEXT)


def measurement(title: str) -> Callable[[Callable[..., Sequence[str]]], click.Command]:
    """Return a decorator that turns a function into a command, which prints a page of Markdown.

    The function returns headings, paragraphs and tables of Markdown. Its docstring explains the measurement, in the
    page and in `--help`.
    """

    def command_of(measure: Callable[..., Sequence[str]]) -> click.Command:
        explanation = cleandoc(measure.__doc__ or "")

        @click.command(help=explanation, context_settings=CONTEXT)
        @click.pass_context
        @wraps(measure)
        def command(context: click.Context, /, **options: Any) -> None:
            try:
                with one_thread:
                    parts = measure(**options)
            except (ValueError, ConvergenceError, OSError) as error:  # no faults of the program
                raise click.ClickException(str(error)) from None
            words = f"{context.command_path} {shlex.join(sys.argv[2:])}".strip()
            made = f"Made by `{words}` on {provenance.run_date()}: {provenance.origin()}."
            click.echo("\n\n".join([f"# {title}", explanation, *parts, made]))

        return command

    return command_of


def number(value: float, form: str = ".0e") -> str:
    """Return a number in this format; empty for NaN."""
    return "" if np.isnan(value) else format(float(value), form)
