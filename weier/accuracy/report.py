"""Markdown pages of measurements: a table is a list of columns, each with a heading and a function for its cells."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from importlib.resources import files
from pathlib import Path
from typing import TypeVar

import numpy as np

from weier.data.files import write_text
from weier.data.markdown import table

Row = TypeVar("Row")


def rows_as_table(columns: Sequence[tuple[str, Callable[[Row], str]]], rows: Iterable[Row]) -> str:
    """Return a Markdown table from headings, each with a function from a row to its cell."""
    return table([heading for heading, _ in columns], ([cell(row) for _, cell in columns] for row in rows))


def number(value: float, form: str = ".0e") -> str:
    """Return a number in this format; empty for NaN."""
    return "" if np.isnan(value) else format(float(value), form)


def write_page(path: str | Path, template: str, **parts: object) -> None:
    """Write a page from a template of this folder, whose names in braces are replaced by the parts."""
    text = files("weier.accuracy").joinpath(template).read_text(encoding="utf-8")
    write_text(path, text.format(**parts))
