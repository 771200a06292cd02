"""Jobs solve curves that the store lacks, and append them every few seconds, so that a killed job has lost little."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from contextlib import closing
from time import monotonic
from typing import Any

import numpy as np

from weier.api.progress import Progress
from weier.api.rows import curve_row, surface_row
from weier.api.task import CurveTask
from weier.digests import numerics
from weier.methods.errors import ConvergenceError, NotApplicableError
from weier.pipeline.curves import SURFACE, Kind, Lacking
from weier.pipeline.store import Store
from weier.scene.case import Case
from weier.surface.spectrum import columns_of_fits
from weier.surface.waves import Waves

# Seconds of work that are lost with a job that is killed (an append takes 0.02); rows that fit into memory.
APPEND_SECONDS, MAX_ROWS = 10.0, 50_000
CHANGED = "the code of weier has changed since {}: run snakemake again, which plans with the new code"


def solve(lacking: Iterable[Lacking], store: Store, origin: str, say: Callable[[str], None]) -> None:
    """Solve curves and append them to the store.

    Parameters
    ----------
    lacking : iterable of Lacking
        What to solve, in this order.
    store : Store
        Where to append it; its numerics are those of the plan.
    origin : str
        The program and the processor, which are stored with the curves.
    say : callable
        Called with lines of progress and with the reason why a method has no curve.

    Raises
    ------
    ValueError
        If the code on disk is not that of the plan, or changes meanwhile: curves must not be filed under other code.
    """
    work = list(lacking)
    check_code(store.numerics, "the plan")
    progress = Progress(sum(len(each.numbers) for each in work), APPEND_SECONDS, say, "curves")
    for each in work:
        kind, segment = each.part.kind, Segment(each.part.kind, store, origin)
        with closing(segment):  # also of Ctrl-C, and of SIGTERM from a scheduler
            for key, number in zip(each.keys, each.numbers.tolist(), strict=True):
                segment.add(key, _row(kind, each.part.case(number), say))
                progress.add(1)


class Segment:
    """Curves that are solved and not yet in the store."""

    def __init__(self, kind: Kind, store: Store, origin: str) -> None:
        self._kind, self._store, self._origin = kind, store, origin
        self._keys, self._rows = list[np.uint64](), list[Mapping[str, Any]]()
        self._saved = monotonic()

    def add(self, key: np.uint64, row: Mapping[str, Any]) -> None:
        """Add a curve, and append all to the store after some seconds."""
        self._keys.append(key)
        self._rows.append(row)
        if monotonic() - self._saved > APPEND_SECONDS or len(self._rows) == MAX_ROWS:
            self.close()

    def close(self) -> None:
        """Append what there is to the store, unless the code on disk is another one by now."""
        if self._rows:
            check_code(self._store.numerics, "this job began")
            self._store.append(self._kind, self._keys, self._rows, self._origin)
        self._keys, self._rows, self._saved = [], [], monotonic()


def check_code(expected: str, since: str) -> None:
    """Refuse code on disk that has other numerics than expected."""
    if numerics().name != expected:
        raise ValueError(CHANGED.format(since))


def solve_curve(surface: Waves, kind: Kind) -> tuple[CurveTask, Any]:
    """Return the curve of a surface, and its solution with the seconds it took, or the error."""
    curve = CurveTask(surface, kind.method, kind.settings, kind.loads_for(surface))
    try:
        return curve, curve.solve()
    except (NotApplicableError, ConvergenceError) as error:
        return curve, error.with_traceback(None)  # the traceback would keep the arrays of the solver


def described(case: Case) -> dict[str, Any]:
    """Return what describes the surface of a case, and the fit of a series to a trace."""
    row = surface_row(case.profile)
    if "trace" in case.parameters:
        fits = columns_of_fits([(case.profile, case.parameters["trace"].get("longest"))])
        row |= {name: column[0] for name, column in fits.items()}
    return row


def _row(kind: Kind, case: Case, say: Callable[[str], None]) -> dict[str, Any]:
    """Return the row of one curve of a kind, or of a surface."""
    if kind.method == SURFACE:
        return described(case)
    curve, outcome = solve_curve(case.profile, kind)
    if isinstance(outcome, Exception):
        say(f"{case.profile.describe()}, {kind.method}: {outcome}")
    row = curve_row(curve, outcome)
    return {name: value for name, value in row.items() if kind.contact_edges or np.ndim(value) < 2}
