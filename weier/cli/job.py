"""What a job of the pipeline says at its end: one line."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter

import click


@contextmanager
def job(*words: str) -> Iterator[None]:
    """One line for a job that is done: its rule, what for, and the seconds that it took."""
    start = perf_counter()
    yield
    click.echo(f"{' '.join(words)}: {perf_counter() - start:.1f} s", err=True)
