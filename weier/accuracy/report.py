"""Pages of Markdown from what was measured: a table is a list of columns, a heading beside what fills its cells."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
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


def write_page(path: str | Path, title: str, blocks: Iterable[str]) -> None:
    """Write a title and the blocks of text that are not empty, with an empty line between them."""
    write_text(path, "\n\n".join([f"# {title}", *filter(None, blocks)]) + "\n")
