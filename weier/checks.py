"""Checks of arguments: numbers, arrays of numbers, words and flags.

Each returns the value in a Python or NumPy type, or raises an error of one sentence with the argument's name, the
allowed values and the given value. Texts, booleans, bytes, complex numbers and masked values are refused as numbers,
although NumPy converts some of them.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Collection, Iterable
from decimal import Decimal
from numbers import Real
from os import PathLike
from pathlib import Path
from reprlib import Repr
from typing import Any

import numpy as np

from weier import units
from weier.kernels.arrays import Array, Flags

MAX_SHOWN = 60  # maximum characters of a value in a message
MAX_LISTED = 300  # maximum characters of a list of choices in a message
SHORT = Repr()  # writes only the first elements: a YAML text may hold 9^9
SHORT.maxlevel, SHORT.maxother, SHORT.maxstring, SHORT.maxlong = 2, 2 * MAX_SHOWN, 2 * MAX_SHOWN, MAX_SHOWN
ALL_CORES = -1  # value of `workers` for all cores, as in SciPy

Condition = Callable[[Any], Any]


def checked_number(
    name: str, value: Any, condition: str = "be a number", holds: Condition = np.isreal, unit: str = units.NONE
) -> float:
    """Return a number as a float; a quantity with a unit of its own is converted to `unit`.

    The words of the condition follow "must", as in "be positive"; `holds` tells whether a float meets it.
    """
    number = None if isinstance(value, list | tuple) else _number(units.in_unit(name, value, unit))
    if number is None or not holds(number):
        raise ValueError(f"{name} must {condition}, got {shown(value)}")
    return number


def checked_numbers(
    name: str, values: Any, condition: str = "be numbers", holds: Condition = np.isreal, unit: str = units.NONE
) -> Array:
    """Return numbers, an array or a nested list, as an array of floats of the same shape.

    NaN counts as a number unless `holds`, which takes the whole array, refuses it.
    """
    numbers = _numbers(name, values, unit)
    failing: Flags = ~np.asarray(holds(numbers), bool)
    if failing.any():
        where = f" at position {int(failing.ravel().argmax())}" if numbers.ndim else ""
        raise ValueError(f"{name} must {condition}, got {shown(numbers[failing][0])}{where}")
    return numbers


def checked_count(name: str, value: Any, least: int, most: float = math.inf) -> int:
    """Return a whole number from `least` to `most`."""
    within = f"at least {least}" if math.isinf(most) else f"from {least} to {most:.10g}"
    condition = f"be a whole number, {within}"
    return int(checked_number(name, value, condition, lambda number: least <= number <= most and number.is_integer()))


def checked_workers(workers: Any) -> int:
    """Return the number of processes; `ALL_CORES` means one per available core."""
    number = checked_number(
        "workers",
        workers,
        f"be a whole number, at least 1, or {ALL_CORES} for all cores",
        lambda number: number == ALL_CORES or (number >= 1 and number.is_integer()),
    )
    if number != ALL_CORES:
        return int(number)
    # a cluster or `taskset` may have limited the cores
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def checked_word(name: str, value: Any, choices: Collection[str]) -> str:
    """Return the value if it is one of the allowed words."""
    if not isinstance(value, str) or value not in choices:
        raise ValueError(unknown(name, value, choices))
    return str(value)


def unknown(name: str, value: Any, choices: Iterable[str]) -> str:
    """Return the message for a word that is not one of the choices."""
    listed = ", ".join(choices) or "none"
    return f"{name} must be one of {listed:.{MAX_LISTED}}, got {shown(value)}"


def checked_flag(name: str, value: Any) -> bool:
    """Return a flag as a bool; words, numbers and None are refused, although Python converts them."""
    if not isinstance(value, bool | np.bool_):
        raise ValueError(f"{name} must be true or false, got {shown(value)}")
    return bool(value)


def shown(value: Any) -> str:
    """Return a value in one short line."""
    if isinstance(value, np.generic):
        value = value.item()
    if hasattr(value, "__array__") and hasattr(value, "shape"):  # an xarray.Dataset has only the first
        return f"an array of shape {tuple(value.shape)}"
    try:
        text = " ".join(SHORT.repr(value).split())
    except ValueError:  # it contains an integer too long to print
        text = f"<{type(value).__name__}>"
    return text if len(text) <= MAX_SHOWN else f"{text[:MAX_SHOWN]}..."


def checked_file(path: Any) -> Path:
    """Return the path of an existing file; raise FileNotFoundError otherwise."""
    if not isinstance(path, str | PathLike):
        raise ValueError(f"path must be the name of a file, got {shown(path)}")
    file = Path(path)
    if not file.is_file():
        raise FileNotFoundError(f"there is no file {readable(str(file))}{': that is a folder' * file.is_dir()}")
    return file


def readable(name: str) -> str:
    """Return the name of a file as text, without bytes that are not UTF-8 or that the locale cannot write."""
    return os.fsencode(name).decode("utf-8", "replace")


def _number(value: Any) -> float | None:
    """Return a number as a float; None for other types, and for an integer or fraction too large for a float."""
    if hasattr(value, "__array__") and getattr(value, "shape", None) == ():
        value = np.asanyarray(value)
        value = None if np.ma.is_masked(value) or value.dtype.kind not in "iufO" else value.item()
    if isinstance(value, bool) or not isinstance(value, Real | Decimal):
        return None
    try:
        return float(value)
    except (OverflowError, ValueError):  # Decimal has a signalling NaN
        return None


def _numbers(name: str, values: Any, unit: str) -> Array:
    """Return the values as an array of floats of the same shape, in the unit."""
    array = _array(units.in_unit(name, values, unit))
    if array is None or array.dtype.kind not in "iufO":
        raise ValueError(f"{name} must be a number or an array of numbers, got {shown(values)}")
    if np.ma.is_masked(array):
        at = int(np.ma.getmaskarray(array).ravel().argmax())
        raise ValueError(f"{name} must have all its values, got a masked one at position {at}: leave it out")
    if array.dtype.kind != "O":
        with np.errstate(over="ignore"):  # a long double beyond the floats is inf
            return np.asarray(array, float)
    numbers = [_number(units.in_unit(name, value, unit)) for value in array.ravel().tolist()]
    if None in numbers:
        at = numbers.index(None)
        what = f"got {shown(array.ravel()[at])}" + (f" at position {at}" if array.ndim else "")
        raise ValueError(f"{name} must be a number or an array of numbers, {what}")
    return np.array(numbers, float).reshape(array.shape)


def _array(values: Any) -> np.ndarray[Any, Any] | None:
    """Return the values as an array that keeps the types of its elements; None if they form none, or hold bytes."""
    try:
        if hasattr(values, "__array__"):
            return np.asanyarray(values)
        return None if _holds_bytes(values) else np.array(values, object)
    except (TypeError, ValueError):  # an xarray.Dataset, or incompatible shapes
        return None


def _holds_bytes(values: Any) -> bool:
    """Return whether the value is bytes or a nested list with bytes, which NumPy would read as integers."""
    if isinstance(values, list | tuple):
        return any(map(_holds_bytes, values))
    return isinstance(values, bytearray | memoryview)
