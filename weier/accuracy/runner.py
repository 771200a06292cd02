"""One variant of a method on one profile: its curve and its cost, or the message of its error."""

from __future__ import annotations

import re
import warnings
from collections.abc import Mapping
from pathlib import Path
from time import process_time
from traceback import extract_tb
from typing import Any, NamedTuple

import numpy as np

from weier.api.task import CurveTask
from weier.digests import PACKAGE
from weier.kernels.arrays import Array, Flags
from weier.methods.curve import QUANTITIES
from weier.methods.errors import ConvergenceError
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


class Problem(NamedTuple):
    """A named surface with increasing loads in p_0*, and the variants that are compared on it, by name."""

    name: str
    profile: Waves
    loads: Array
    variants: Mapping[str, Variant]


class Run(NamedTuple):
    """The results of a variant for some loads.

    values : compliance and resistance, in g_0 and g_0/p_0*, shape (2, loads), NaN at loads that are refused
    stated : errors of both stated by the method, shape (2, loads), NaN where it states none
    seconds : processor time
    others : further results of the method, by name
    message : kind and text of the first error, empty if there was none
    warned : the distinct texts of warnings
    """

    values: Array
    stated: Array
    seconds: float = np.nan
    others: Mapping[str, Any] = {}
    message: str = ""
    warned: tuple[str, ...] = ()

    @property
    def solved(self) -> Flags:
        """Whether there is a compliance and a resistance at each load."""
        return np.asarray(np.isfinite(self.values).all(axis=0))


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
    return Run(values, stated, sorted(seconds)[len(seconds) // 2], found)


def attempt(variant: Variant, profile: Waves, loads: Array, repeat: int = 1) -> Run:
    """Solve all loads as one curve and, after an error with a message of weier, each load separately.

    Raises
    ------
    RuntimeError
        If a method fails otherwise, or returns a number that is not finite.
    """
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            found = run(variant, profile, loads, repeat)
        except (ValueError, ConvergenceError) as error:
            if not is_clear(error):
                raise RuntimeError(f"{variant.name} fails without a clear message: {error}") from error
            parts = [attempt(variant, profile, load) for load in np.split(loads, loads.size) if loads.size > 1]
            parts = parts or [Run(np.full((2, 1), np.nan), np.full((2, 1), np.nan))]
            values, stated = (np.hstack([getattr(part, name) for part in parts]) for name in ("values", "stated"))
            warned = sum((part.warned for part in parts), ())
            found = Run(values, stated, message=f"{type(error).__name__}: {error}", warned=warned)
        else:
            if not found.solved.all():
                raise RuntimeError(f"{variant.name} returns numbers that are not finite")
    warned = (*(str(warning.message) for warning in caught), *found.warned)
    return found._replace(warned=tuple(dict.fromkeys(warned)))


def is_clear(error: Exception) -> bool:
    """Return whether weier raised the error on purpose, and its text has no NaN, which would not help the user."""
    last, text = extract_tb(error.__traceback__)[-1], str(error)
    deliberate = PACKAGE in Path(last.filename).parents and str(last.line).startswith("raise")
    return deliberate and bool(text) and not re.search(r"\b(nan|inf of|of inf)\b", text)
