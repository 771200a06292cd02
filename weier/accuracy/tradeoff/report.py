"""The trade between speed and accuracy as a Markdown table."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

from weier.accuracy.metrics import MEASURED, STATED, seconds_per_load, worst_over_loads
from weier.accuracy.report import Column, number, rows_as_table, write_page
from weier.data.markdown import plain
from weier.kernels.arrays import Array
from weier.methods.method import QUANTITIES


class Row(NamedTuple):
    """The results of a variant; arrays of shape (profiles,).

    seconds : for one load
    compliance, stated_compliance, resistance, stated_resistance : the largest measured and stated errors over the
        loads; NaN where the method states none
    """

    name: str
    seconds: Array
    compliance: Array
    stated_compliance: Array
    resistance: Array
    stated_resistance: Array


def write_table(data: xr.Dataset, title: str, path: str | Path) -> None:
    """Write the tradeoff as Markdown, with a row for each variant."""
    write_page(path, "tradeoff/page.md", title=title, variants=rows_as_table(COLUMNS, _rows(data)))


def _rows(data: xr.Dataset) -> list[Row]:
    errors = [worst_over_loads(data, quantity, kind) for quantity in QUANTITIES for kind in (MEASURED, STATED)]
    columns = seconds_per_load(data), *errors
    run = np.isfinite(columns[0])
    rows = [
        Row(name, *(column[run[:, at], at] for column in columns))
        for at, name in enumerate(data["variant"].values.tolist())
    ]
    return [row for row in rows if row.seconds.size]


COLUMNS: list[Column[Row]] = [
    Column("method and setting", lambda row: plain(row.name)),
    Column("profiles", lambda row: str(row.seconds.size)),
    Column("ms a load", lambda row: number(1e3 * np.median(row.seconds), ".2g")),
    Column("error of h", lambda row: number(np.median(row.compliance))),
    Column("worst", lambda row: number(row.compliance.max())),
    Column("worst stated", lambda row: number(row.stated_compliance.max())),
    Column("error of R", lambda row: number(np.median(row.resistance))),
    Column("worst", lambda row: number(row.resistance.max())),
    Column("worst stated", lambda row: number(row.stated_resistance.max())),
]
