"""`weier adopt`: curves of other numerics count for the present code if it gives the same numbers for a sample."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from weier.api.rows import curve_row
from weier.data.files import write_text
from weier.pipeline.curves import SURFACE, Curves, Lacking
from weier.pipeline.jobs import described, solve_curve
from weier.pipeline.store import ADOPTED, SUFFIX, Store

SAMPLE = 50  # curves of each kind that are solved again, evenly spread over those that there are
NOT_COMPARED = ("seconds",)  # which differ from run to run


class Verdict(NamedTuple):
    """The comparison of the curves of one kind under other numerics with those of the present code.

    name, curves : of the kind, and of the other numerics
    compared : number of curves that were solved again
    identical : whether all were the same to the last bit
    within : whether compliance and resistance differ by at most the sum of their stated errors
    largest : largest difference of compliance over the sum of the stated errors; NaN where none is stated
    """

    name: str
    curves: str
    compared: int
    identical: bool
    within: bool
    largest: float


def adopt(scenes: Iterable[Curves], store: Store, within_errors: bool, say: Callable[[str], None]) -> list[Verdict]:
    """Compare solved curves of other numerics that scenes lack with new solutions, and adopt those that agree.

    Parameters
    ----------
    scenes : iterable of Curves
        What is wanted.
    store : Store
        The solved curves, under the present numerics.
    within_errors : bool
        Whether differences within the stated errors are accepted, too; by default, all bits must agree.
    say : callable
        Called with a line for each comparison.

    Returns
    -------
    list of Verdict
        Those of all kinds that were compared. Adopted ones are written to `adopted.json` in the folder of the present
        numerics.
    """
    wanted: dict[str, list[Lacking]] = {}
    for each in store.lacking(part for curves in scenes for part in curves.of_studies(None)):
        wanted.setdefault(each.part.kind.name, []).append(each)
    verdicts = []
    for name, lacking in wanted.items():
        for folder in others(store, name):
            known = Store(store.folder, folder.name)
            if (sample := _sample(lacking, known)) and not (folder.parent / store.numerics / ADOPTED).exists():
                verdict = _compared(sample, known)
                accepted = verdict.identical or (within_errors and verdict.within)
                say(_line(verdict, accepted))
                verdicts.append(verdict)
                if accepted:
                    own = verdict._asdict() | {"code": store.numerics, "date": datetime.now(UTC).isoformat()}
                    write_text(folder.parent / store.numerics / ADOPTED, json.dumps(own, indent=1) + "\n")
    return verdicts


def others(store: Store, kind: str) -> list[Path]:
    """Return the folders of other numerics with segments of a kind, the newest first."""
    folders = [path for path in (store.folder / kind).glob("*/") if path.name != store.numerics]
    return sorted(filter(_newest, folders), key=_newest, reverse=True)


def _newest(folder: Path) -> float:
    return max((path.stat().st_mtime for path in folder.glob(f"[!.]*{SUFFIX}")), default=0.0)


def _sample(lacking: Sequence[Lacking], known: Store) -> list[tuple[Lacking, int]]:
    """Return curves that are solved under the other numerics, evenly spread: parts with their numbers."""
    index = known.index(lacking[0].part.kind.name)
    solved = [(each, int(number)) for each in lacking for number in each.numbers[index.find(each.keys)[0]]]
    return [solved[place] for place in np.unique(np.linspace(0, len(solved) - 1, SAMPLE).astype(int)) if solved]


def _compared(sample: Sequence[tuple[Lacking, int]], known: Store) -> Verdict:
    """Solve a sample again, and compare it with the store."""
    kind = sample[0][0].part.kind
    identical, within, largest = True, True, np.nan
    for lacking, number in sample:
        case = lacking.part.case(number)
        new = described(case) if kind.method == SURFACE else curve_row(*solve_curve(case.profile, kind))
        key = lacking.part.keys[number : number + 1]
        old = {name: found[0] for name in new if (found := known.read(kind, key, name)) is not None}
        names = [name for name in new if name not in NOT_COMPARED and (kind.contact_edges or np.ndim(new[name]) < 2)]
        exact = names if kind.method == SURFACE else ["status"]  # nothing else of a surface has a stated error
        identical &= all(name in old and _same(new[name], old[name]) for name in names)
        within &= all(name in old and _same(new[name], old[name]) for name in exact)
        for quantity in ("compliance", "resistance"):
            if f"{quantity}_error" in old and f"{quantity}_error" in new:
                difference = np.abs(new[quantity] - old[quantity])
                stated = new[f"{quantity}_error"] + old[f"{quantity}_error"]
                within &= bool((difference <= stated).all())
                if quantity == "compliance":
                    ratio = difference[stated > 0] / stated[stated > 0]
                    largest = float(np.fmax(largest, np.max(ratio, initial=0.0)))
            elif quantity in new:
                within &= quantity in old and _same(new[quantity], old[quantity])
    return Verdict(kind.name, known.numerics, len(sample), identical, within, largest)


def _same(new: Any, old: Any) -> bool:
    """Return whether two values are the same to the last bit; the stored one may end in NaN."""
    new, old = np.asarray(new), np.asarray(old)
    if new.dtype.kind in "UO":
        return str(new) == str(old)
    own = tuple(map(slice, new.shape))
    if old[own].shape != new.shape:
        return False
    padded = np.full(old.shape, np.nan)
    padded[own] = new
    return np.array_equal(padded, old, equal_nan=True)


def _line(verdict: Verdict, accepted: bool) -> str:
    """Return a comparison in one line."""
    agree = "the same bits" if verdict.identical else "within the stated errors" if verdict.within else "they differ"
    what = f"{verdict.name} of {verdict.curves}: {verdict.compared} curves solved again, {agree}"
    return f"{what}: {'adopted' if accepted else 'not adopted'}"
