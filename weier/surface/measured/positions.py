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
MAX_ERROR = 0.0075  # largest error of the length, which is half the range of steps that rounded positions allow
BY_CHANCE = 10  # A range of steps this many times narrower than a digit has a decimal number of it once in ten times.
ROUNDING = 1 + 1e-6  # tolerance for rounded decimals as floats
MIN_UNITS = 4  # units of the last digit in a step above which each increment tells the rows left out in it
# One or two gaps of a row also look like rounding of a slightly larger step. More of them rarely do by chance.
FEW_GAPS = 2


def on_grid(x: Array, heights: Array, length: float | None, place: Callable[[int], str]) -> tuple[Array, float]:
    """Return heights at equal steps, NaN in rows that are left out, and the length of the trace, which is all steps.

    Parameters
    ----------
    x, heights : array, shape (samples,)
        Rising positions, which may be rounded, and heights.
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
            f"positions must rise in equal steps, got {x[at]} at {place(at)}: say columns=(1, 0) if the "
            'positions are in the second column, decimal="," for decimal commas, skip= or rows= for a part of the '
            "file, or take the column of heights alone, as in columns=1, with the length, if no row is left out"
        )
    number, step = _grid(x)
    if number is None:
        even = x[0] + (x[-1] - x[0]) / rise.size * np.arange(x.size)
        at = int(np.abs(x - even).argmax())
        raise ValueError(
            f"positions must rise in equal steps, got {x[at]} at {place(at)}: interpolate the heights at equal "
            "steps, write the positions with more digits, or, if no row is left out, take the column of heights "
            "alone, as in columns=1, with the length"
        )
    full = np.full(int(number[-1]) + 1, np.nan)
    full[number.astype(int)] = heights
    own = step * full.size
    if length is None:
        return full, own
    if abs(length - own) > ROUNDING * max([UNEVEN * step, *(unit.max() for unit in _last_digits(x))]):
        raise ValueError(
            f"length must be that of {full.size} steps where positions go from {x[0]:g} to {x[-1]:g}, about "
            f"{own:.6g}, got {length:g}: leave out the length, or take the column of heights alone, as in columns=1"
        )
    return full, length


def _grid(x: Array) -> tuple[Array | None, float]:
    """Return the number of each position in a grid from the first one, and its step; None if there is none, or two.

    Positions that are rounded have another grid than exact ones where rows are left out.
    """
    rows = np.arange(float(x.size))
    exact, step = _exact_numbers(x)
    if exact is not None and exact[-1] - rows[-1] <= FEW_GAPS:
        return exact, step
    for unit in _last_digits(x):
        if rounded := _rounded_step(rows, x, unit):
            return (rows, rounded) if exact is None else (None, 0.0)
    if exact is not None:
        return exact, step
    usual = float(np.median(np.diff(x)))
    for unit in _last_digits(x):
        if usual >= MIN_UNITS * unit.max():
            number = np.append(0, np.cumsum(np.maximum(np.rint(np.diff(x) / usual), 1)))
            if number[-1] < MAX_HEIGHTS and (rounded := _rounded_step(number, x, unit)):
                return number, rounded
    return None, 0.0


def _exact_numbers(x: Array) -> tuple[Array | None, float]:
    """Return the numbers of positions that are multiples of a step, and the step; None if they are not."""
    step = float(np.median(np.diff(x)))
    if step <= 0:
        return None, 0.0
    step = float((x[-1] - x[0]) / np.rint((x[-1] - x[0]) / step))
    number = np.rint((x - x[0]) / step)
    off = np.abs(x - x[0] - number * step)
    if (off > UNEVEN * step).any() or (np.diff(number) <= 0).any() or number[-1] >= MAX_HEIGHTS:
        return None, 0.0
    return number, step


def _rounded_step(number: Array, x: Array, unit: Array) -> float:
    """Return the step of positions that are rounded, or cut, to units of their last digits; 0 if there is none.

    It is the decimal number with the fewest digits among the steps that give exactly these digits. A gap shifts the
    positions behind it, which no step then gives. Only a gap within less than a unit may leave a range of steps, but
    hardly one with a decimal number of fewer digits than such a range has by chance.
    """
    half = unit / 2 * ROUNDING + np.spacing(np.abs(x).max())
    low, high = (_last_step(number, x, half, start) for start in (0.0, 2 * (x[-1] - x[0]) / number[-1]))
    middle = (low + high) / 2
    if not high - low <= 2 * MAX_ERROR * middle:
        return 0.0
    rounded = ((round(middle, decimals), 10.0**-decimals) for decimals in range(2 * MOST_DIGITS))
    step, digit = next(((step, digit) for step, digit in rounded if low <= step <= high), (middle, 0.0))
    return step if step >= unit.max() or digit >= BY_CHANCE * (high - low) else 0.0


def _last_step(number: Array, x: Array, half: Array, step: float) -> float:
    """Return the first step from a start for which x lies within `half` of a straight line; NaN if there is none.

    The start needs a wider band than any such step. The least band is a convex function of the step, made of straight
    pieces, so that Newton's method ends.
    """
    direction = 0.0
    while True:
        rest = x - step * number
        above, below = int((rest - half).argmax()), int((rest + half).argmin())
        excess = (rest - half)[above] - (rest + half)[below]
        if excess <= 0:
            return step
        slope = float(number[below] - number[above])
        if slope == 0 or slope * direction < 0:
            return math.nan
        direction, before = slope, step
        step -= float(excess / slope)
        if step == before:  # The excess is a rounding error.
            return step


def _last_digits(x: Array) -> Iterator[Array]:
    """Yield the unit of the last decimal of all positions, and of the last significant digit of each."""
    size = np.abs(x)
    exponent = np.floor(np.log10(np.maximum(size, size[size > 0].min())))
    decimal_units = (np.full(x.size, 10.0**-decimals) for decimals in range(MOST_DIGITS))
    digit_units = (10.0 ** (exponent - digits) for digits in range(MOST_DIGITS))
    for units in (decimal_units, digit_units):
        yield from islice((unit for unit in units if (np.abs(x / unit - np.rint(x / unit)) < 1e-6).all()), 1)
