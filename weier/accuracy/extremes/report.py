"""The extremes as a page of Markdown."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from weier.accuracy.extremes.measurement import CHECKS
from weier.accuracy.report import number, write_page
from weier.accuracy.runner import Outcome
from weier.data.markdown import plain, table
from weier.data.variables import Check
from weier.methods.method import QUANTITIES

# The outcomes in words.
COUNTED: dict[Outcome, str] = {kind: kind.name.replace("_", " ") for kind in Outcome if kind is not Outcome.not_run}

HEADER = ("method", "extremes", "numbers", "errors in words", "least digits of h", "of R", "largest error of h")


def write_summary(data: xr.Dataset, title: str, path: str | Path) -> None:
    """Write the faults, the largest errors by method and by extreme, and an error message of each kind."""
    runs, faults = _runs(data), failures(data)
    runs_of_method: dict[str, list[xr.Dataset]] = {}
    for run in runs:
        runs_of_method.setdefault(run["variant"].item(), []).append(run)
    messages = dict.fromkeys(text for run in runs if (text := run["message"].item()))
    one_of_each = {re.split(r"\d", message)[0]: message for message in reversed(messages)}
    write_page(
        path,
        "extremes.md",
        title=title,
        rows=len(runs),
        faults=f"and these have a fault:\n\n{_list(faults)}" if faults else "none of them with a fault.",
        by_method=table(HEADER, map(_summary, runs_of_method.values())),
        by_extreme=_matrix(runs, list(runs_of_method)),
        messages=_list(reversed(one_of_each.values())),
    )


def _list(texts: Iterable[str]) -> str:
    return "\n".join(f"- {plain(text)}" for text in texts)


def _matrix(runs: Sequence[xr.Dataset], variants: Sequence[str]) -> str:
    """Return a row for each extreme, with the least correct digits of h by each variant."""
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


def _summary(runs: Sequence[xr.Dataset]) -> list[str]:
    """Return the cells of the runs of a variant, below `HEADER`."""
    return [
        plain(runs[0]["variant"].item()),
        str(len(runs)),
        _count(runs, refused=False),
        _count(runs, refused=True),
        *(number(_worst(runs, f"{quantity}_digits"), ".1f") for quantity in QUANTITIES),
        number(_worst(runs, "compliance_deviation", np.fmax)),
    ]


def _worst(runs: Sequence[xr.Dataset], name: str, of: np.ufunc = np.fmin) -> float:
    return float(of.reduce([of.reduce(run[name].values) for run in runs]))


def _count(runs: Sequence[xr.Dataset], refused: bool) -> str:
    outcomes = np.concatenate([run["outcome"].values for run in runs])
    return str(np.count_nonzero((outcomes != Outcome.not_run) & ((outcomes != Outcome.finite) == refused)))


def failures(data: xr.Dataset) -> list[str]:
    """Return the faults, one line for each run that has any."""
    found = ((run, _faults(run)) for run in _runs(data))
    return [
        f"{run['extreme'].item()}, {run['variant'].item()}: {', '.join(faults)}" for run, faults in found if faults
    ]


def _faults(run: xr.Dataset) -> list[str]:
    outcome = run["outcome"].values
    faults = [f"not {name}".replace("_", " ") for name in CHECKS if run[name] == Check.no and name != "one_curve"]
    # Outcomes that no method should have.
    faults += [COUNTED[bad] for bad in (Outcome.unclear_error, Outcome.not_finite) if (outcome == bad).any()]
    if run["one_curve"] == Check.no and set(outcome) <= {Outcome.not_run, Outcome.finite}:
        faults.append("not one curve")  # though each load is solved by itself
    return faults


def _runs(data: xr.Dataset) -> list[xr.Dataset]:
    """Return one dataset for each variant that was run on an extreme."""
    run = (data["outcome"].values != Outcome.not_run).any(axis=-1)
    return [data.isel(case=case, variant=variant) for case, variant in np.argwhere(run)]
