"""Jobs solve curves that the store lacks, and append them every few seconds, so that a killed job has lost little."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from time import monotonic
from typing import Any

import numpy as np

from weier.api.progress import Progress
from weier.api.rows import curve_row, surface_row
from weier.digests import numerics
from weier.pipeline.needed_curves import SURFACE, Kind, Part
from weier.pipeline.store import Store
from weier.scene.case import Case

# Seconds of work lost if a job is killed (an append takes 0.02 s), and a number of rows that fits into memory.
APPEND_SECONDS, MAX_ROWS = 10.0, 50_000


def solve(parts: Iterable[Part], store: Store, origin: str, say: Callable[[str], None]) -> None:
    """Solve curves in this order and append them, with their origin, to the store, whose numerics are the plan's.

    ValueError is raised if the code on disk differs from the planned code or changes meanwhile, since the store files
    curves by code. An error of a curve is raised once all others are solved.
    """
    work = list(parts)
    check_code(store)
    count = sum(len(part.keys) for part in work)
    progress = Progress(count, f"{count} curve{'s' * (count > 1)}", APPEND_SECONDS, say)
    rows: dict[np.uint64, Mapping[str, Any]] = {}

    def append(kind: Kind) -> None:
        if rows:
            check_code(store)
            store.append(kind, rows, origin)
            rows.clear()

    saved, failed = monotonic(), list[Exception]()
    for part in work:
        try:
            for key, position in zip(part.keys, part.positions.tolist(), strict=True):
                try:
                    rows[key] = _row(part.kind, part.product.case(position), say)
                except Exception as error:
                    failed = failed or [error]
                progress()
                if monotonic() - saved > APPEND_SECONDS or len(rows) == MAX_ROWS:
                    append(part.kind)
                    saved = monotonic()
        finally:  # runs on Ctrl-C and on a scheduler's SIGTERM too
            append(part.kind)
    if failed:
        raise failed[0]


def check_code(store: Store) -> None:
    """Raise ValueError if the code on disk has other numerics than the store."""
    if numerics() != store.numerics:
        raise ValueError("the code of weier has changed since the plan: run snakemake again")


def _row(kind: Kind, case: Case, say: Callable[[str], None]) -> dict[str, Any]:
    """Return the row of a curve, or the row that describes a surface."""
    if kind.method == SURFACE:
        return surface_row(case.profile)
    curve = kind.curve_of(case.profile)
    if isinstance(outcome := curve.outcome(), Exception):
        say(f"{case.profile.describe()}, {kind.method}: {outcome}")
    row = curve_row(curve, outcome)
    return {name: value for name, value in row.items() if kind.contact_edges or np.ndim(value) < 2}
