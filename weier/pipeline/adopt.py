"""`weier adopt`: curves of other numerics count for the present code if it gives the same numbers for a sample."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from weier.data.files import replacing, write_text
from weier.data.provenance import origin
from weier.data.variables import VARIABLES
from weier.methods.curve import QUANTITIES
from weier.pipeline.jobs import solve
from weier.pipeline.needed_curves import SURFACE, Curves, Part
from weier.pipeline.store import ORIGIN, SUFFIX, Store

SAMPLE = 50  # curves per kind to solve again, evenly spread over the existing ones
RECORD = "adopted.json"  # holds the last comparison, next to the segments
NOT_COMPARED = ("seconds", ORIGIN)  # these differ from run to run


def adopt(scenes: Iterable[Curves], store: Store, within_errors: bool) -> Iterator[str]:
    """Compare curves of other numerics that scenes lack with new solutions, and copy those that agree.

    All bits of all quantities must agree, or with `within_errors`, compliance and resistance must agree within the
    sum of their stated errors. The new solutions stay in the store. Beside the segments of the present numerics,
    `adopted.json` has both digests and the result. Yield the result of each kind and other numerics in words.
    """
    by_kind: dict[str, list[Part]] = {}
    for part in store.lacking(part for curves in scenes for part in curves.parts_for()):
        by_kind.setdefault(part.kind.name, []).append(part)
    for name, wanted in by_kind.items():
        folders = [path for path in (store.folder / name).glob("*/") if path != store.segments(name)]
        for folder in sorted(folders, key=lambda path: path.stat().st_mtime, reverse=True):  # the newest first
            other = Store(store.folder, folder.name)
            if not (sample := _sample(store.lacking(wanted), other)):
                continue
            solve(sample, store, origin(), lambda line: None)
            identical = all(_agree(part, store, other) for part in sample)
            accepted = identical or (within_errors and all(_agree(part, store, other, True) for part in sample))
            for path in folder.glob(f"[!.]*{SUFFIX}") if accepted else ():
                with replacing(store.segments(name) / path.name) as temporary:
                    temporary.write_bytes(path.read_bytes())
            count = sum(len(part.keys) for part in sample)
            record = {"curves": other.numerics, "code": store.numerics, "compared": count, "identical": identical}
            write_text(store.segments(name) / RECORD, json.dumps(record | {"adopted": accepted}, indent=1) + "\n")
            store = Store(store.folder, store.numerics)  # a new store reads the copies
            agree = "the same bits" if identical else "within the stated errors" if accepted else "they differ"
            verdict = "adopted" if accepted else "not adopted"
            yield f"{name} of {other.numerics}: {count} curves solved again, {agree}: {verdict}"


def _sample(lacking: Iterable[Part], other: Store) -> list[Part]:
    """Return an evenly spread sample of the curves solved under the other numerics."""
    solved = [part.only(other.index(part.kind.name).find(part.keys)[0]) for part in lacking]
    step = -(-sum(len(part.keys) for part in solved) // SAMPLE)
    return [part.only(np.arange(0, len(part.keys), step)) for part in solved if len(part.keys)]


def _agree(part: Part, store: Store, other: Store, within_errors: bool = False) -> bool:
    """Return whether two stores have the same values of some curves, or h and R that agree within their errors."""

    def both(name: str) -> list[Any]:
        return [each.read(part.kind, each.rows(part.kind, part.keys), name) for each in (store, other)]

    if within_errors and part.kind.method != SURFACE:  # surfaces have no stated errors
        return _same(*both("status")) and all(_within(*both(name), *both(f"{name}_error")) for name in QUANTITIES)
    return all(_same(*both(name)) for name in VARIABLES if name not in NOT_COMPARED)


def _same(new: Any, old: Any) -> bool:
    """Return whether two arrays are identical, except for the padding with NaN at the ends of their rows."""
    if new is None or old is None or new.dtype.kind == "U":
        return np.array_equal(new, old)
    shape = np.maximum(new.shape, old.shape)
    new, old = (np.pad(one, [(0, more) for more in shape - one.shape], constant_values=np.nan) for one in (new, old))
    return np.array_equal(new, old, equal_nan=True)


def _within(new: Any, old: Any, *errors: Any) -> bool:
    """Return whether values are the same, or differ by at most the sum of their stated errors; NaN is NaN in both."""
    if _same(new, old) or any(one is None for one in (new, old, *errors)):
        return _same(new, old)
    return bool(np.isclose(new, old, rtol=0, atol=np.nan_to_num(np.sum(errors, axis=0)), equal_nan=True).all())
