"""The extremes as a Markdown table."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr

from weier.accuracy.extremes.measurement import CHECKS
from weier.accuracy.report import Column, number, rows_as_table, write_page
from weier.accuracy.runner import Outcome
from weier.data.check import Check
from weier.data.markdown import plain

MADE = (
    "Made by `snakemake --cores 2 extremes`, which writes `results/extremes/extremes.md`, the numbers beside it as "
    "netCDF, and a figure. `docs/stability.md` is a copy of that page."
)
PICTURE = "![Digits of one profile over all loads, and condition numbers](extremes.png)"
NOTE = """\
Each row is one method on one extreme, at the loads of that extreme, in p\\_0\\*. An *ulp* is one unit in the last
place of a number.

**Outcome.** Every load must end in a finite number, or in an error that says in a sentence what is wrong; a number in
parentheses refers to the sentences below. Where the curve of all loads ends in an error, each load is tried by
itself. If numpy had warned of anything, the row would say *warned*.

**Checks.** These columns describe the curve of all finite numbers. They allow for the errors that rounding,
iteration and the tolerance of the method leave.

- *Rises*: the compliance h never falls.
- *Concave*: the resistance R falls, and the slope of each chord of h lies between the resistances at its ends.
- *In bounds*: h and R lie within the bounds that the first wave, in closed form, sets to every longer series. The
  bounds are widened by the error that a method knows of its own solution.
- *As stated*: where a method states an error for each number, h and R at every load are off by no more than that.

**Accuracy.** *Digits* are the correct digits, relative to the number itself, at the worst of the loads; 16 stands for
no error. *Error of h* is the largest over the loads, in g\\_0. The last column names the reference:

- *mpmath*: the sums that define an estimate, in 50 digits.
- *finer layer*: the non-linear layer on twice the points.
- *closed forms, patches 1e-12*: the exact contact, for methods that solve the series. It is known in closed form at
  first touch and at full contact. Between them it is found by contact patches, at a tolerance of 1e-12, on the same
  profile shifted along x.

**Where few digits are right.** Some problems are ill-conditioned:

- Within a rounding error of full contact, or of p\\_n\\* by Demelio's formula, half a unit in the last place of p
  changes the resistance as much as the digits show.
- At light loads a grid has few digits of h, because its smallest contact is one node. `bem direct` is run on the
  paper's 12 points for each of the finest waves.
- Where two crests are equally high, or 1e-15 apart, the rounding of their heights decides at loads such as 1e-100
  whether one or both of them touch. R then has one value or half of it, which counts as 0.3 digits."""
COUNTED: dict[Outcome, str] = {kind: kind.name.replace("_", " ") for kind in Outcome if kind is not Outcome.not_run}
FAULTS = (Outcome.unclear_error, Outcome.not_finite)
MARKS = {Check.no: "**no**", Check.yes: "yes", Check.not_measured: ""}


def write_table(data: xr.Dataset, title: str, path: str | Path) -> None:
    """Write a row for each extreme and variant, the error messages, and the condition numbers, as Markdown."""
    runs, faults = _runs(data), failures(data)
    messages = list(dict.fromkeys(text for run in runs if (text := run["message"].item())))
    blocks = [
        MADE,
        f"{len(runs)} rows, {len(faults)} of them with a fault" + (":" if faults else "."),
        "\n".join(f"- {plain(fault)}" for fault in faults),
        PICTURE,
        rows_as_table(_columns(messages), runs),
        NOTE,
        "## Error messages",
        "\n".join(f"{position}. {plain(message)}" for position, message in enumerate(messages, 1)),
        "## Condition numbers of the boundary elements",
        rows_as_table(CONDITIONS, [data.isel(nodes=row) for row in range(data.sizes["nodes"])]),
    ]
    write_page(path, title, blocks)


def failures(data: xr.Dataset) -> list[str]:
    """The faults of each run that has any, one line a run."""
    found = ((run, _faults(run)) for run in _runs(data))
    return [
        f"{run['extreme'].item()}, {run['variant'].item()}: {', '.join(faults)}" for run, faults in found if faults
    ]


def _faults(run: xr.Dataset) -> list[str]:
    outcome = run["outcome"].values
    faults = [f"not {name}".replace("_", " ") for name in CHECKS if run[name] == Check.no and name != "one_curve"]
    faults += [COUNTED[bad] for bad in FAULTS if (outcome == bad).any()]
    if run["one_curve"] == Check.no and set(outcome) <= {Outcome.not_run, Outcome.finite}:
        faults.append("not one curve")  # though each load is solved by itself
    return faults


def _runs(data: xr.Dataset) -> list[xr.Dataset]:
    """One dataset for each variant that was run on an extreme."""
    run = (data["outcome"].values != Outcome.not_run).any(axis=-1)
    return [data.isel(case=case, variant=variant) for case, variant in np.argwhere(run)]


def _columns(messages: list[str]) -> list[Column[xr.Dataset]]:
    return [
        Column("extreme", lambda run: plain(run["extreme"].item())),
        Column("method", lambda run: plain(run["variant"].item())),
        Column("loads", _loads),
        Column("outcome", lambda run: _outcome(run, messages)),
        Column("rises", lambda run: MARKS[Check(run["monotone"].item())]),
        Column("concave", lambda run: MARKS[Check(run["concave"].item())]),
        Column("in bounds", lambda run: MARKS[Check(run["within_band"].item())]),
        Column("as stated", lambda run: MARKS[Check(run["within_stated_error"].item())]),
        Column("digits of h", lambda run: number(np.fmin.reduce(run["compliance_digits"].values), ".1f")),
        Column("of R", lambda run: number(np.fmin.reduce(run["resistance_digits"].values), ".1f")),
        Column("error of h", lambda run: number(np.fmax.reduce(run["compliance_error"].values))),
        Column("reference", lambda run: run["reference"].item()),
    ]


def _loads(run: xr.Dataset) -> str:
    loads = run["mean_pressure"].values[run["outcome"].values != Outcome.not_run]
    return f"{loads.size}: {loads[0]:.0e}..{loads[-1]:.0e}" if loads.size > 1 else f"{loads[0]:.0e}"


def _outcome(run: xr.Dataset, messages: list[str]) -> str:
    outcome, message = run["outcome"].values, run["message"].item()
    counts = {kind: int((outcome == kind).sum()) for kind in COUNTED}
    several = sum(count > 0 for count in counts.values()) > 1
    text = ", ".join(
        f"{count} {COUNTED[kind]}" if several else COUNTED[kind] for kind, count in counts.items() if count
    )
    if run["without_warning"] == Check.no:
        text += ", warned"
    if message and not (several or set(outcome) - {Outcome.not_run, Outcome.finite}):
        text += ", but one by one"
    return f"{text} ({messages.index(message) + 1})" if message else text


CONDITIONS: list[Column[xr.Dataset]] = [
    Column("nodes", lambda row: str(row["nodes"].item())),
    Column("influence matrix", lambda row: number(row["condition_operator"].item(), ".3g")),
    Column("full contact", lambda row: number(row["condition_full"].item(), ".3g")),
    Column("half", lambda row: number(row["condition_half"].item(), ".3g")),
]
