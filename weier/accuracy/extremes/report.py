"""The extremes as a table to read."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr

from weier.accuracy.extremes.examine import Outcome
from weier.accuracy.extremes.measure import VERDICTS
from weier.data.check import Verdict
from weier.data.files import write_text
from weier.data.markdown import plain, table

HEAD = [
    "extreme", "method", "loads", "outcome", "rises", "concave", "in bounds", "as expected", "digits of h", "of R",
    "error of h", "against",
]  # fmt: skip
MADE = (
    "Made by `snakemake --cores 2 extremes`, which leaves this page as `results/extremes/extremes.md`, the numbers "
    "beside it as netCDF, and a figure. `docs/stability.md` is a copy."
)
PICTURE = "![Digits of one profile over all loads, and condition numbers](extremes.png)"
NOTE = (
    "Each method on each extreme, at the loads of that extreme in p\\_0\\*. A load ends in a finite number or in "
    "an error that says in a sentence what is wrong; where the loads together, as one curve, end in an error, "
    "each is tried alone; *warned* would stand where numpy warned of anything. *Rises*, *concave* and *in bounds* "
    "judge the curve of the finite loads: compliance never falls, resistance falls and lies between the chords to "
    "either side, both lie within the bounds that the first wave in closed form sets, with the law of the mesh "
    "error for boundary elements; in all of it what rounding, iteration or an asked tolerance leaves is allowed. "
    "*As expected*: a planned curve is off by no more, in h and R at every load, than the errors it states. "
    "*Digits* are the fewest correct ones over the loads, relative to the number itself, 16 for no error; *error* "
    "is the largest of h, in g\\_0. They are counted against the sum of the recursion in 50 digits (mpmath), "
    "against a layer of twice the points, or for boundary elements and contact patches against closed forms at "
    "first touch and full contact and, between, contact patches at a tolerance of 1e-12 of the same profile begun "
    "elsewhere. Within an ulp of full contact, or of p\\_n\\* by Demelio, the resistance is as ill-conditioned as "
    "its digits show: half a unit in the last place of p changes it as much. Few digits of h at light loads are "
    "what a mesh gives, whose contact is one node at least; `bem direct` has the paper's 12 points for each of "
    "the finest waves. Of two crests of one height, or 1e-15 apart, the rounding of the heights decides at loads "
    "like 1e-100 whether one touches or both, and so whether R is one value or half of it: 0.3 digits."
)


def write_table(data: xr.Dataset, title: str, path: str | Path) -> None:
    """Write a row a method and extreme, what was said, and the condition numbers, as Markdown."""
    write_text(path, _markdown(data, title))


def failures(data: xr.Dataset) -> list[str]:
    """What is not as it should be, a line each: none where all is well."""
    found = []
    for case, method in _runs(data):
        run = data.isel(case=case, solution_method=method)
        faults = [
            f"not {name}".replace("_", " ") for name in VERDICTS if run[name] == Verdict.no and name != "together"
        ]
        outcome = run["outcome"].values
        for bad in (Outcome.unclear_error, Outcome.not_finite):
            if (outcome == bad).any():
                faults.append(bad.name.replace("_", " "))
        if run["together"] == Verdict.no and set(outcome) <= {Outcome.not_run, Outcome.finite}:
            faults.append("not as one curve")
        if faults:
            found.append(f"{run['extreme'].item()}, {run['solution_method'].item()}: {', '.join(faults)}")
    return found


def _runs(data: xr.Dataset) -> list[tuple[int, int]]:
    run = (data["outcome"].values != Outcome.not_run).any(axis=-1)
    return [(int(case), int(method)) for case, method in np.argwhere(run)]


def _markdown(data: xr.Dataset, title: str) -> str:
    runs, faults = _runs(data), failures(data)
    messages = list(dict.fromkeys(filter(None, (str(data["message"].values[run]) for run in runs))))
    summary = f"{len(runs)} rows, {len(faults)} of them with a fault" + (":" if faults else ".")
    listed = ["", *(f"- {plain(fault)}" for fault in faults)] if faults else []
    said = [f"{number}. {plain(message)}" for number, message in enumerate(messages, 1)]
    rows = table(HEAD, (_row(data, run, messages) for run in runs))
    head = [f"# {title}", "", MADE, "", summary, *listed, "", PICTURE, ""]
    tail = ["## What was said", "", *said, "", "## Condition numbers of the boundary elements", ""]
    return "\n".join([*head, rows, "", NOTE, "", *tail, _conditions(data), ""])


def _row(data: xr.Dataset, place: tuple[int, int], messages: list[str]) -> list[str]:
    case, method = place
    run = data.isel(case=case, solution_method=method)
    outcome = run["outcome"].values
    loads = data["mean_pressure"].values[outcome != Outcome.not_run]
    shape = [_verdict(run[name].item()) for name in ("monotone", "concave", "inside", "as_expected")]
    digits = [_worst(run[name].values, np.fmin, "{:.1f}") for name in ("compliance_digits", "resistance_digits")]
    return [
        plain(str(run["extreme"].item())),
        str(run["solution_method"].item()),
        f"{loads.size}: {loads[0]:.0e}..{loads[-1]:.0e}" if loads.size > 1 else f"{loads[0]:.0e}",
        _outcome(run, messages),
        *shape,
        *digits,
        _worst(run["compliance_error"].values, np.fmax, "{:.0e}"),
        str(run["compared_with"].item()),
    ]


def _outcome(run: xr.Dataset, messages: list[str]) -> str:
    outcome, message = run["outcome"].values, str(run["message"].item())
    counts = {kind: int((outcome == kind).sum()) for kind in Outcome if kind != Outcome.not_run}
    parts = [f"{count} {kind.name.replace('_', ' ')}" for kind, count in counts.items() if count]
    words = [kind.name.replace("_", " ") for kind, count in counts.items() if count]
    text = words[0] if len(words) == 1 else ", ".join(parts)
    text += ", warned" if run["silent"] == Verdict.no else ""
    if not message:
        return text
    note = f" ({messages.index(message) + 1})"
    return text + (", but one by one" if counts[Outcome.finite] == sum(counts.values()) else "") + note


def _verdict(value: int) -> str:
    return {Verdict.no: "**no**", Verdict.yes: "yes", Verdict.not_measured: ""}[Verdict(value)]


def _worst(values: np.ndarray, of: np.ufunc, form: str) -> str:
    worst = of.reduce(values)
    return "" if np.isnan(worst) else form.format(worst)


def _conditions(data: xr.Dataset) -> str:
    names = {"condition_operator": "influence matrix", "condition_full": "full contact", "condition_half": "half"}
    rows = [
        [str(nodes), *("" if np.isnan(v := data[name].values[i]) else f"{v:.3g}" for name in names)]
        for i, nodes in enumerate(data["nodes"].values)
    ]
    return table(["nodes", *names.values()], rows)
