"""The extremes as a page of Markdown."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence

import numpy as np
import xarray as xr

from weier.accuracy.extremes.measurement import CHECKS, measure
from weier.accuracy.page import Page, measurement, number
from weier.accuracy.runner import Outcome
from weier.data.markdown import plain, table
from weier.data.variables import Check
from weier.methods.curve import QUANTITIES

# The outcomes in words.
COUNTED: dict[Outcome, str] = {kind: kind.name.replace("_", " ") for kind in Outcome if kind is not Outcome.not_run}

DIGITS_TEXT = """\
Correct digits of h at the worst load of each extreme. *All refused*: an error is raised at all loads; *some refused*:
at some of them; *finite*: numbers without a reference; empty: the method does not apply or would take minutes."""
DEFINITIONS = """\
A row is one method at the loads of one extreme, in p_0*. An *ulp* is one unit in the last place of a number. Every
load must give a finite number or an error message of one sentence. The curve of finite numbers must pass the checks
below, within rounding, iteration error and the tolerance of the method. Any failure is a fault, and so is a warning
of numpy.

- The compliance h never falls.
- The resistance R falls, and the slope of each chord of h lies between the resistances at its ends.
- h and R lie within the bounds that the first wave, in closed form, sets on every longer series, widened by the
  stated error of the method.
- Errors of h and R do not exceed the stated ones.

*Digits* are correct digits relative to the number itself; 16 means no error. An estimate is compared with its
defining sums in 50 digits, the non-linear layer with itself on twice the points. Methods that solve the series are
compared with the exact contact: in closed form at first contact and full contact, otherwise by contact patches at a
tolerance of 1e-12 on the same profile shifted along x. Some problems are ill-conditioned:

- Within a rounding error of full contact, or of p_n* in Demelio's formula, half an ulp of p changes the resistance as
  much as the digits show.
- At light loads a grid has few digits of h, because its smallest contact is one node.
- If two crests are equally high, or 1e-15 apart, rounding of their heights decides at loads such as 1e-100 whether
  one or both touch. R then has one value or half of it, which counts as 0.3 digits."""
HEADER = ("method", "extremes", "numbers", "errors in words", "least digits of h", "of R", "largest error of h")


def parts(data: xr.Dataset) -> Iterator[str]:
    """Yield the faults, the largest errors by method and by extreme, and an error message of each kind."""
    runs, faults = _runs(data), failures(data)
    runs_of_method: dict[str, list[xr.Dataset]] = {}
    for run in runs:
        runs_of_method.setdefault(run["variant"].item(), []).append(run)
    messages = dict.fromkeys(text for run in runs if (text := run["message"].item()))
    one_of_each = {re.split(r"\d", message)[0]: message for message in reversed(messages)}
    found = f"and these have a fault:\n\n{_list(faults)}" if faults else "none of them with a fault."
    yield f"{len(runs)} rows, {found}"
    yield "![Digits of one profile over all loads](extremes.png)"
    yield "## By method\n\nThe errors of h are in g_0."
    yield table(HEADER, map(_summary, runs_of_method.values()))
    yield f"## Digits of the compliance\n\n{DIGITS_TEXT}"
    yield _matrix(runs, list(runs_of_method))
    yield "## Error messages\n\nOne of each kind:"
    yield _list(reversed(one_of_each.values()))
    yield f"## Definitions\n\n{DEFINITIONS}"


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
    # No method should have these outcomes.
    faults += [COUNTED[bad] for bad in (Outcome.unclear_error, Outcome.not_finite) if (outcome == bad).any()]
    if run["one_curve"] == Check.no and set(outcome) <= {Outcome.not_run, Outcome.finite}:
        faults.append("not one curve")  # but each load alone is solved
    return faults


def _runs(data: xr.Dataset) -> list[xr.Dataset]:
    """Return one dataset for each variant that was run on an extreme."""
    run = (data["outcome"].values != Outcome.not_run).any(axis=-1)
    return [data.isel(case=case, variant=variant) for case, variant in np.argwhere(run)]


@measurement("Stability at the extremes")
def main() -> Page:
    """Examine all methods at the limits of floats.

    Each method is run at ill-conditioned loads of series at the limits of their parameters. Every load must give a
    number or a clear error, and the numbers must be a curve of compliance, within the errors that the method states.
    `snakemake --cores 2 extremes` draws the figure, too, and `docs/stability.md` is a copy of this page.
    """
    data = measure()
    return Page([*parts(data)], data)
