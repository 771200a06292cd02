"""The extremes as a page of Markdown."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from weier.accuracy.extremes.measurement import CHECKS
from weier.accuracy.report import Column, number, rows_as_table, write_page
from weier.accuracy.runner import Outcome
from weier.data.check import Check
from weier.data.markdown import plain, table

MADE = (
    "Made by `snakemake --cores 2 extremes`, with a figure, and all numbers as netCDF. `docs/stability.md` is a copy "
    "of this page."
)
PICTURE = "![Digits of one profile over all loads, and condition numbers](extremes.png)"
NOTE = """\
A row is one method on one extreme, at the loads of that extreme, in p\\_0\\*. An *ulp* is one unit in the last
place of a number. Every load must end in a finite number, or in an error that says in a sentence what is wrong.
The curve of all finite numbers must pass the checks below, which allow for the errors that rounding, iteration
and the tolerance of the method leave. Whatever fails is a fault, and so is a warning of numpy.

- The compliance h never falls.
- The resistance R falls, and the slope of each chord of h lies between the resistances at its ends.
- h and R lie within the bounds that the first wave, in closed form, sets to every longer series. The bounds are
  widened by the error that a method knows of its own solution.
- Where a method states an error for each number, h and R at every load are off by no more than that.

*Digits* are the correct digits, relative to the number itself; 16 stands for no error. An estimate is held
against the sums that define it, in 50 digits, and the non-linear layer against itself on twice the points.
Methods that solve the series are held against the exact contact. It is known in closed form at first touch and at
full contact. Between them it is found by contact patches, at a tolerance of 1e-12, on the same profile shifted
along x. Some problems are ill-conditioned:

- Within a rounding error of full contact, or of p\\_n\\* by Demelio's formula, half a unit in the last place of p
  changes the resistance as much as the digits show.
- At light loads a grid has few digits of h, because its smallest contact is one node. `bem direct` is run on the
  paper's 12 points for each of the finest waves.
- Where two crests are equally high, or 1e-15 apart, the rounding of their heights decides at loads such as 1e-100
  whether one or both of them touch. R then has one value or half of it, which counts as 0.3 digits."""
BY_METHOD = "## By method\n\nThe errors of h are in g\\_0."
BY_EXTREME = """\
## Digits of the compliance

Correct digits of h at the worst of the loads of each extreme. *All refused* stands for errors at all loads, *some
refused* for errors at some of them, and *finite* for numbers without a reference. Nothing stands where a method
does not apply or would take minutes."""
MESSAGES = "## What errors say\n\nOne of each kind:"
COUNTED: dict[Outcome, str] = {kind: kind.name.replace("_", " ") for kind in Outcome if kind is not Outcome.not_run}
FAULTS = (Outcome.unclear_error, Outcome.not_finite)


def write_summary(data: xr.Dataset, title: str, path: str | Path) -> None:
    """Write the faults, the worst of each method and of each method on each extreme, and errors of each kind."""
    runs, faults = _runs(data), failures(data)
    of_method: dict[str, list[xr.Dataset]] = {}
    for run in runs:
        of_method.setdefault(run["variant"].item(), []).append(run)
    first = {re.split(r"\d", message)[0]: message for message in reversed(_messages(runs))}
    blocks = [
        MADE,
        f"{len(runs)} rows, " + ("and these have a fault:" if faults else "none of them with a fault."),
        "\n".join(f"- {plain(fault)}" for fault in faults),
        PICTURE,
        BY_METHOD,
        rows_as_table(SUMMARY, of_method.values()),
        BY_EXTREME,
        _matrix(runs, list(of_method)),
        MESSAGES,
        "\n".join(f"- {plain(message)}" for message in reversed(first.values())),
        "## What is counted",
        NOTE,
    ]
    write_page(path, title, blocks)


def _messages(runs: Sequence[xr.Dataset]) -> list[str]:
    return list(dict.fromkeys(text for run in runs if (text := run["message"].item())))


def _matrix(runs: Sequence[xr.Dataset], variants: Sequence[str]) -> str:
    """A row for each extreme, with what is left of h by each variant."""
    by_name = {(run["extreme"].item(), run["variant"].item()): run for run in runs}
    extremes = dict.fromkeys(extreme for extreme, _ in by_name)
    rows = (
        [plain(extreme), *(_digits_left(by_name.get((extreme, name))) for name in variants)] for extreme in extremes
    )
    return table(["extreme", *variants], rows)


def _digits_left(run: xr.Dataset | None) -> str:
    if run is None:
        return ""
    outcome = run["outcome"].values
    refused = outcome[outcome != Outcome.not_run] != Outcome.finite
    if refused.all():
        return "all refused"
    digits = number(_worst([run], "compliance_digits"), ".1f") or "finite"
    return f"{digits}, some refused" if refused.any() else digits


def _worst(runs: Sequence[xr.Dataset], name: str, of: np.ufunc = np.fmin) -> float:
    return float(of.reduce([of.reduce(run[name].values) for run in runs]))


def _count(runs: Sequence[xr.Dataset], refused: bool) -> str:
    outcomes = np.concatenate([run["outcome"].values for run in runs])
    return str(np.count_nonzero((outcomes != Outcome.not_run) & ((outcomes != Outcome.finite) == refused)))


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


SUMMARY: list[Column[list[xr.Dataset]]] = [
    Column("method", lambda runs: plain(runs[0]["variant"].item())),
    Column("extremes", lambda runs: str(len(runs))),
    Column("numbers", lambda runs: _count(runs, refused=False)),
    Column("errors in words", lambda runs: _count(runs, refused=True)),
    Column("least digits of h", lambda runs: number(_worst(runs, "compliance_digits"), ".1f")),
    Column("of R", lambda runs: number(_worst(runs, "resistance_digits"), ".1f")),
    Column("largest error of h", lambda runs: number(_worst(runs, "compliance_error", np.fmax))),
]
