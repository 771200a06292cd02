"""The trade between speed and accuracy as a Markdown table."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

from weier.accuracy.metrics import by_load, seconds_per_load
from weier.accuracy.report import Column, number, rows_as_table, write_page
from weier.data.markdown import plain
from weier.kernels.arrays import Array

LIGHT_LOAD, HEAVY_LOAD = 0.03, 1.0  # p_0*: below, a crest or two carry all; above, the coarsest wave is flat


class Row(NamedTuple):
    """One variant on the profiles that it was run on: seconds a load, and errors of shape (profiles, loads)."""

    name: str
    seconds: Array
    loads: Array
    compliance: Array
    resistance: Array


def write_table(data: xr.Dataset, title: str, path: str | Path) -> None:
    """Write the trade as Markdown: a row for each variant."""
    write_page(path, "tradeoff/page.md", title=title, variants=rows_as_table(COLUMNS, _rows(data)))


def _rows(data: xr.Dataset) -> list[Row]:
    seconds, loads = seconds_per_load(data), data["mean_pressure"].values
    errors = [by_load(data, quantity) for quantity in ("compliance", "resistance")]
    rows = []
    for at, name in enumerate(data["variant"].values.tolist()):
        run = np.isfinite(seconds[:, at])
        rows.append(Row(name, seconds[run, at], loads, *(error[run, at] for error in errors)))
    return [row for row in rows if row.seconds.size]


def _worst(error: Array) -> Array:
    """The largest error of each profile over these loads, NaN where there is none."""
    return np.asarray(np.fmax.reduce(error, axis=-1, initial=np.nan))


def _typical_between(row: Row, low: float, high: float) -> str:
    inside = (row.loads >= low) & (row.loads <= high)
    return number(np.median(_worst(row.compliance[:, inside])))


COLUMNS: list[Column[Row]] = [
    Column("method and setting", lambda row: plain(row.name)),
    Column("profiles", lambda row: str(row.seconds.size)),
    Column("ms a load", lambda row: number(1e3 * np.median(row.seconds), ".2g")),
    Column("error of h", lambda row: number(np.median(_worst(row.compliance)))),
    Column("worst", lambda row: number(_worst(row.compliance).max())),
    Column("p < 0.03", lambda row: _typical_between(row, 0, np.nextafter(LIGHT_LOAD, 0))),
    Column("0.03..1", lambda row: _typical_between(row, LIGHT_LOAD, HEAVY_LOAD)),
    Column("p > 1", lambda row: _typical_between(row, np.nextafter(HEAVY_LOAD, np.inf), np.inf)),
    Column("error of R", lambda row: number(np.median(_worst(row.resistance)))),
    Column("worst", lambda row: number(_worst(row.resistance).max())),
]
