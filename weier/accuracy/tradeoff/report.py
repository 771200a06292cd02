"""The trade as a table to read."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr

from weier.accuracy.tradeoff.fit import Constant, constants
from weier.accuracy.tradeoff.numbers import seconds_per_load, worst_over_loads
from weier.data.files import write_text
from weier.data.markdown import plain, table

LIGHT, HEAVY = 0.03, 1.0  # p_0*: below, a crest or two carry all; above, the coarsest wave is flat


def write_table(data: xr.Dataset, title: str, path: str | Path) -> None:
    """Write the trade as a Markdown table: a row a contender."""
    write_text(path, _markdown(data, title))


def _markdown(data: xr.Dataset, title: str) -> str:
    head = [
        "method and setting", "profiles", "ms a load", "error of h", "worst", "p < 0.03", "0.03..1", "p > 1",
        "error of R", "worst",
    ]  # fmt: skip
    rows = table(head, (_row(data, number) for number in range(data.sizes["solution_method"])))
    laws = table(LAWS, map(_law, constants(data)))
    return "\n".join([f"# {title}", "", rows, "", NOTE, "", laws, "", LAWS_NOTE, ""])


LAWS = ["constant of weier/laws.py", "shipped", "measured here"]
LAWS_NOTE = (
    "Of an error the measured constant is the largest of all profiles, settings and loads, the shipped one must be "
    "no smaller; of seconds it is a fit, and differs from computer to computer."
)


def _law(constant: Constant) -> list[str]:
    return [plain(constant.name), f"{constant.shipped:.2g}", f"{constant.measured:.2g}"]


NOTE = (
    "Errors are against the contact patches at a tolerance of 1e-12: of the compliance h in g\\_0, of the resistance "
    "R relative to the larger of itself and 1 g\\_0/p\\_0\\*. First the largest over the loads, as the median "
    "over the profiles and for the worst of them; then the largest in three ranges of load, as the median over the "
    "profiles. `bem 96` has 96 points for each of the finest waves (`h`: without the resistance; `1e-04`: stopped "
    "at that residual); `layer 24` 24 points a wave; `patches 1e-06` that tolerance. Seconds are processor "
    "time, the least of three runs; a finer grid runs on fewer profiles, so compare rows of as many."
)


def _row(data: xr.Dataset, number: int) -> list[str]:
    run = np.isfinite(seconds_per_load(data)[:, number])
    h, R = (worst_over_loads(data, quantity)[run, number] for quantity in ("compliance", "resistance"))
    by_load = data["compliance_error"].values[run, number]
    loads = data["mean_pressure"].values
    bands = [
        np.median(by_load[:, inside].max(axis=-1))
        for inside in (loads < LIGHT, (loads >= LIGHT) & (loads <= HEAVY), loads > HEAVY)
    ]
    values = [np.median(h), h.max(), *bands, np.median(R), R.max()]
    cost = f"{1e3 * np.median(seconds_per_load(data)[run, number]):.2g}"
    return [
        plain(str(data["solution_method"].values[number])),
        str(run.sum()),
        cost,
        *("" if np.isnan(v) else f"{v:.0e}" for v in values),
    ]
