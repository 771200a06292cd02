"""One method on one extreme: it answers in numbers or in a clear sentence, and nothing is warned of."""

from __future__ import annotations

import re
import warnings
from enum import IntEnum
from pathlib import Path
from traceback import extract_tb
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from weier.kernels.arrays import Array
from weier.kernels.sources import PACKAGE
from weier.methods.errors import ConvergenceError, NotApplicableError
from weier.methods.method import Variant
from weier.methods.solve import solve
from weier.theory.profile import Profile

OBSCURE = re.compile(r"\b(nan|inf of|of inf)\b")  # a sentence about numbers that are none helps nobody


class Outcome(IntEnum):
    """What a method made of a load."""

    not_run = 0
    finite = 1
    clear_error = 2
    unclear_error = 3
    not_finite = 4


class Examined(NamedTuple):
    """A method on an extreme.

    compliance, resistance : shape (loads,), NaN where there is none
    compliance_error, resistance_error : what the method itself expects, NaN where it does not say
    outcome : what became of each load, shape (loads,)
    message : of the first error, and its kind; empty if there was none
    warned : what was warned of, each once
    """

    compliance: Array
    resistance: Array
    compliance_error: Array
    resistance_error: Array
    outcome: NDArray[np.int8]
    message: str
    warned: tuple[str, ...]


def examine(contender: Variant, profile: Profile, loads: Array) -> Examined:
    """Solve all loads at once and, if that ends in an error, each by itself."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        together = _answer(contender, profile, loads)
        parts = [together]
        if together.message and loads.size > 1:
            parts = [_answer(contender, profile, loads[i : i + 1]) for i in range(loads.size)]
    h, R, miss, rough, outcome = (np.concatenate(columns) for columns in list(zip(*parts, strict=True))[:5])
    warned = tuple(dict.fromkeys(str(w.message) for w in caught))
    return Examined(h, R, miss, rough, outcome, together.message, warned)


def _answer(contender: Variant, profile: Profile, loads: Array) -> Examined:
    try:
        return _numbers(solve(profile, loads, contender.method, **contender.settings))
    except Exception as error:  # whatever it is belongs into the report
        none = np.full(loads.size, np.nan)
        outcome = Outcome.clear_error if clear(error) else Outcome.unclear_error
        return Examined(none, none, none, none, np.full(loads.size, outcome, np.int8), described(error), ())


def _numbers(curve: xr.Dataset) -> Examined:
    h, R = curve["compliance"].values, curve["resistance"].values
    none = np.full(h.size, np.nan)
    miss, rough = (curve.get(name, none) for name in ("compliance_error", "resistance_error"))
    outcome = np.where(np.isfinite(h) & np.isfinite(R), Outcome.finite, Outcome.not_finite).astype(np.int8)
    return Examined(h, R, np.asarray(miss), np.asarray(rough), outcome, "", ())


def clear(error: Exception) -> bool:
    """Whether weier itself says what is wrong: raised by a line of its own, and not about a number that is none."""
    last, text = extract_tb(error.__traceback__)[-1], str(error)
    own = PACKAGE in Path(last.filename).parents and str(last.line).startswith("raise")
    return own and isinstance(error, ValueError | ConvergenceError) and bool(text) and not OBSCURE.search(text)


def described(error: Exception) -> str:
    """The kind of the error and its sentence."""
    kind = "ValueError" if isinstance(error, NotApplicableError) else type(error).__name__
    return f"{kind}: {error}"
