"""Pages of Markdown from what was measured: a table is a list of columns, a heading beside what fills its cells."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Generic, NamedTuple, TypeVar

import numpy as np

from weier.data.files import write_text
from weier.data.markdown import table

Row = TypeVar("Row")


class Column(NamedTuple, Generic[Row]):
    """A heading, and the Markdown of a cell from whatever stands for a row."""

    heading: str
    cell: Callable[[Row], str]


def rows_as_table(columns: Sequence[Column[Row]], rows: Iterable[Row]) -> str:
    """A Markdown table with a line for each row."""
    return table([column.heading for column in columns], ([column.cell(row) for column in columns] for row in rows))


def number(value: float, form: str = ".0e") -> str:
    """A number in this format, or nothing for NaN."""
    return "" if np.isnan(value) else format(float(value), form)


def write_page(path: str | Path, template: str, **parts: object) -> None:
    """Write a page: a template of this folder, in which names in braces stand for parts."""
    text = files("weier.accuracy").joinpath(template).read_text(encoding="utf-8")
    write_text(path, text.format(**parts))
