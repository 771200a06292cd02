"""The trade between speed and accuracy as a Markdown table."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

from weier.accuracy.metrics import by_load, seconds_per_load
from weier.accuracy.report import Column, number, rows_as_table, write_page
from weier.accuracy.tradeoff.fit import Constant, constants
from weier.data.markdown import plain
from weier.kernels.arrays import Array

LIGHT_LOAD, HEAVY_LOAD = 0.03, 1.0  # p_0*: below, a crest or two carry all; above, the coarsest wave is flat
NOTE = """\
Each row is one method at one setting, on all profiles that it was run on. `bem 32` has 32 points for each of the
finest waves, with the edges of contact between the nodes (`bem nodes 96`: on nodes; `1e-04`: stopped at that
residual), `layer 24` has 24 points a wave, and `patches 1e-06` has that tolerance.

Errors are distances from the exact contact: closed forms for one wave and for full contact, and otherwise contact
patches at a tolerance of 1e-12 on the same profile shifted along x. The error of the compliance h is in
g\\_0, that of the resistance R is relative to the larger of R and 1 g\\_0/p\\_0\\*. Two columns of each take the
largest error over the loads: the median over the profiles, and the worst of them. Between them stand three ranges of
load p, with the largest error of h within each range, as the median over the profiles.

Milliseconds are processor time on one core, the median of five runs. A finer grid is run on fewer profiles, so
compare rows that have equally many."""
NOTE_ON_CONSTANTS = (
    "The measured constant of an error is the largest over all profiles, settings and loads; the shipped one must "
    "not be smaller. The measured constant of a cost is a fit, and differs from computer to computer."
)


class Row(NamedTuple):
    """One variant on the profiles that it was run on: seconds a load, and errors of shape (profiles, loads)."""

    name: str
    seconds: Array
    loads: Array
    compliance: Array
    resistance: Array


def write_table(data: xr.Dataset, title: str, path: str | Path) -> None:
    """Write the trade as Markdown: a row for each variant, and the constants of error and cost models."""
    tables = rows_as_table(COLUMNS, _rows(data)), rows_as_table(CONSTANTS, constants(data))
    write_page(path, title, [tables[0], NOTE, tables[1], NOTE_ON_CONSTANTS])


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
CONSTANTS: list[Column[Constant]] = [
    Column("constant", lambda constant: plain(constant.name)),
    Column("shipped", lambda constant: number(constant.shipped, ".2g")),
    Column("measured here", lambda constant: number(constant.measured, ".2g")),
]
