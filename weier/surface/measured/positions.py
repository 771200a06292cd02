"""Heights at equal steps from heights at positions, which may be rounded or incomplete."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from itertools import islice

import numpy as np

from weier.kernels.arrays import Array
from weier.surface.measured.artefacts import MAX_HEIGHTS

UNEVEN = 0.01  # tolerance of equal steps in files, in steps
MOST_DIGITS = 9  # decimals or significant digits of rounded positions
# The step of rounded positions is the decimal number with the fewest digits within four standard errors, and these
# may not exceed this part of a step, which is then the error of the length.
STANDARD_ERRORS, MAX_ERROR = 4.0, 0.005
ROUNDING = 1 + 1e-6  # tolerance for rounded decimals as floats


def on_grid(x: Array, heights: Array, length: float | None, place: Callable[[int], str]) -> tuple[Array, float]:
    """Return heights at equal steps, NaN in rows that are left out, and the length of the trace, which is all steps.

    Parameters
    ----------
    x, heights : array, shape (samples,)
        Positions, which may be rounded, and heights.
    length : float, optional
        Must agree with the positions, within their rounding.
    place : callable
        The place of a height, by its index, for messages.

    Raises
    ------
    ValueError
        If the steps are not equal, or do not agree with the length.
    """
    rise = np.diff(x)
    if not (rise >= 0).all() or x[-1] <= x[0]:
        at = 0 if x[-1] <= x[0] else int(np.argmin(rise >= 0)) + 1
        raise ValueError(
            f"positions must rise in equal steps, got {x[at]} at {place(at)}: say columns=(0, 1) for the columns of "
            'positions and heights, decimal="," for decimal commas, skip= or rows= for a part of the file, or take '
            "the column of heights alone, with the length"
        )
    full, step = _exact_grid(x, heights) or _rounded_grid(x, heights) or (None, 0.0)
    if full is None:
        even = x[0] + (x[-1] - x[0]) / rise.size * np.arange(x.size)
        at = int(np.abs(x - even).argmax())
        raise ValueError(
            f"positions must rise in equal steps, got {x[at]} at {place(at)}: interpolate the heights at equal "
            "steps, or take the column of heights alone, as in columns=1, with the length"
        )
    own = step * full.size
    if length is None:
        return full, own
    if abs(length - own) > ROUNDING * max([UNEVEN * step, *(unit.max() for unit in _last_digits(x))]):
        raise ValueError(
            f"length must be that of {full.size} steps where positions go from {x[0]:g} to {x[-1]:g}, about "
            f"{own:.6g}, got {length:g}: leave out the length, or take the column of heights alone, as in columns=1"
        )
    return full, length


def _exact_grid(x: Array, heights: Array) -> tuple[Array, float] | None:
    """Return heights (NaN in missing rows) and step; None unless all positions are multiples of a step."""
    step = float(np.median(np.diff(x)))
    if step <= 0:
        return None
    step = float((x[-1] - x[0]) / np.rint((x[-1] - x[0]) / step))
    number = np.rint((x - x[0]) / step)
    off = np.abs(x - x[0] - number * step)
    if (off > UNEVEN * step).any() or (np.diff(number) <= 0).any() or number[-1] >= MAX_HEIGHTS:
        return None
    full = np.full(int(number[-1]) + 1, np.nan)
    full[number.astype(int)] = heights
    return full, step


def _rounded_grid(x: Array, heights: Array) -> tuple[Array, float] | None:
    """Return heights and step if the positions are equidistant up to rounding of their digits."""
    number = np.arange(x.size)
    for unit in _last_digits(x):
        # Rounding errors are uniform.
        (step, start), covariance = np.polyfit(number, x, 1, w=math.sqrt(12) / unit, cov="unscaled")
        error = STANDARD_ERRORS * math.sqrt(covariance[0, 0])
        if (np.abs(x - start - step * number) > unit * ROUNDING).any() or error > MAX_ERROR * step:
            continue
        shortest = (round(float(step), decimals) for decimals in range(2 * MOST_DIGITS))
        return heights, next((decimal for decimal in shortest if abs(decimal - step) <= error), float(step))
    return None


def _last_digits(x: Array) -> Iterator[Array]:
    """Yield the unit of the last decimal of all positions, and of the last significant digit of each."""
    size = np.abs(x)
    exponent = np.floor(np.log10(np.maximum(size, size[size > 0].min())))
    decimal_units = (np.full(x.size, 10.0**-decimals) for decimals in range(MOST_DIGITS))
    digit_units = (10.0 ** (exponent - digits) for digits in range(MOST_DIGITS))
    for units in (decimal_units, digit_units):
        yield from islice((unit for unit in units if (np.abs(x / unit - np.rint(x / unit)) < 1e-6).all()), 1)
