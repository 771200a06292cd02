"""What a job of the pipeline says: one line, at its end."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter

import click

from weier.kernels import jit


@contextmanager
def job(*words: str, announce_compiling: bool = False) -> Iterator[None]:
    """One line for a job that is done: its rule, what for, and the seconds that it took.

    What it compiles is not announced, unless asked for: a rule of Snakemake says so once for all jobs.
    """
    if not announce_compiling:
        jit.LISTENERS.clear()
    start = perf_counter()
    yield
    click.echo(f"{' '.join(words)}: {perf_counter() - start:.1f} s", err=True)
