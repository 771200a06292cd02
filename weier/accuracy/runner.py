"""One variant of a method on one profile: its curve and its cost, or the message of its error."""

from __future__ import annotations

import re
import warnings
from collections.abc import Mapping
from enum import IntEnum
from pathlib import Path
from time import process_time
from traceback import extract_tb
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from weier.api.task import CurveTask
from weier.digests import PACKAGE
from weier.kernels.arrays import Array
from weier.methods.curve import QUANTITIES
from weier.methods.errors import ConvergenceError
from weier.methods.method import Method
from weier.methods.registry import find_method
from weier.surface.waves import Waves

MAX_POINTS = 100_000  # Points per period of boundary elements; a load then takes tens of milliseconds.
MAX_REPEATED = 0.5  # seconds; longer runs average over disturbances and are not repeated


class Variant(NamedTuple):
    """One competitor in a comparison: a method and its settings."""

    method: str
    settings: Mapping[str, Any] = {}

    @property
    def name(self) -> str:
        """The method and the values of its settings."""
        return " ".join(map(str, (self.method, *self.settings.values())))


class Outcome(IntEnum):
    """The outcome of the solution at a load."""

    finite = 1
    clear_error = 2
    unclear_error = 3
    not_finite = 4


class Run(NamedTuple):
    """The results of a variant for some loads.

    values : compliance and resistance, in g_0 and g_0/p_0*, shape (2, loads), NaN where there is none
    stated : errors of both stated by the method, shape (2, loads), NaN where it states none
    outcome : outcome at each load, shape (loads,)
    seconds : processor time
    others : further results of the method, by name
    message : kind and text of the first error, empty if there was none
    warned : the distinct texts of warnings
    """

    values: Array
    stated: Array
    outcome: NDArray[np.int8]
    seconds: float = np.nan
    others: Mapping[str, Any] = {}
    message: str = ""
    warned: tuple[str, ...] = ()


def run(variant: Variant, profile: Waves, loads: Array, repeat: int = 1) -> Run:
    """Return the curve of a variant and the median seconds of several runs; raises the errors of `weier.solve`."""
    task, seconds = CurveTask(profile, variant.method, variant.settings, loads), list[float]()
    if repeat > 1:
        task._replace(loads=loads[:1]).solve()  # loads compiled code
    while not seconds or (len(seconds) < repeat and seconds[-1] <= MAX_REPEATED):
        start = process_time()
        solved, _ = task.solve()
        seconds.append(process_time() - start)
    found = solved.values()
    values = np.stack([found[name] for name in QUANTITIES])
    stated = np.stack([found.get(f"{name}_error", np.full(loads.size, np.nan)) for name in QUANTITIES])
    outcome = np.where(np.isfinite(values).all(axis=0), Outcome.finite, Outcome.not_finite).astype(np.int8)
    return Run(values, stated, outcome, sorted(seconds)[len(seconds) // 2], found)


def attempt(variant: Variant, profile: Waves, loads: Array) -> Run:
    """Solve all loads as one curve and, after an error, each load separately. Errors are results, and not raised."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            found = run(variant, profile, loads)
        except TimeoutError:  # raised by the caller's handler of signals, such as a time limit: no result of a method
            raise
        except Exception as error:  # a fault of a method is a result, too
            message, none = f"{type(error).__name__}: {error}", np.full((2, loads.size), np.nan)
            outcome = Outcome.clear_error if is_clear(error, find_method(variant.method)) else Outcome.unclear_error
            found = Run(none, none, np.full(loads.size, outcome, np.int8), message=message)
            if loads.size > 1:
                parts = [attempt(variant, profile, loads[i : i + 1]) for i in range(loads.size)]
                values, stated, outcomes = (
                    np.concatenate([getattr(part, name) for part in parts], axis=-1)
                    for name in ("values", "stated", "outcome")
                )
                warned = sum((part.warned for part in parts), ())
                found = Run(values, stated, outcomes, message=message, warned=warned)
    warned = (*(str(warning.message) for warning in caught), *found.warned)
    return found._replace(warned=tuple(dict.fromkeys(warned)))


def is_clear(error: Exception, method: Method) -> bool:
    """Return whether weier, or the file of the method, raised the error on purpose, and its text has no NaN."""
    last, text = extract_tb(error.__traceback__)[-1], str(error)
    source_file = getattr(getattr(method.solve, "__code__", None), "co_filename", None)
    own = PACKAGE in Path(last.filename).parents or last.filename == source_file
    deliberate = own and str(last.line).startswith("raise") and isinstance(error, ValueError | ConvergenceError)
    # A message that contains them does not help the user.
    return deliberate and bool(text) and not re.search(r"\b(nan|inf of|of inf)\b", text)
