"""Heights at equal steps from heights at positions, which may be rounded or incomplete."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from weier.kernels.arrays import Array
from weier.surface.measured.artefacts import MAX_HEIGHTS

UNEVEN = 0.01  # tolerance of equal steps in files, in steps
MOST_DECIMALS = 9  # of rounded positions
MAX_ERROR = 0.0075  # largest error of the length, which is half the range of steps that rounded positions allow
BY_CHANCE = 10  # A range of steps this many times narrower than a digit has a decimal number of it once in ten times.
SLACK = 1 + 1e-6  # tolerance for rounded decimals as floats
# One or two gaps of a row also look like rounding of a slightly larger step. More of them rarely do by chance.
FEW_GAPS = 2
WAYS_OUT = (
    "interpolate the heights at equal steps, write the positions with more digits, or, if no row is left out, take "
    "the column of heights alone, as in columns=1, with the length"
)


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
    unit = _last_digit(x)
    number, step = _grid(x, unit)
    if number is None:
        even = x[0] + (x[-1] - x[0]) / rise.size * np.arange(x.size)
        at = int(np.abs(x - even).argmax())
        raise ValueError(f"positions must rise in equal steps, got {x[at]} at {place(at)}: {WAYS_OUT}")
    full = np.full(int(number[-1]) + 1, np.nan)
    full[number.astype(int)] = heights
    own = step * full.size
    if length is not None and abs(length - own) > SLACK * max(UNEVEN * step, unit):
        raise ValueError(
            f"length must be that of {full.size} steps where positions go from {x[0]:g} to {x[-1]:g}, about "
            f"{own:.6g}, got {length:g}: leave out the length, or take the column of heights alone, as in columns=1"
        )
    return full, own if length is None else length


def _grid(x: Array, unit: float) -> tuple[Array | None, float]:
    """Return the number of each position in a grid from the first one, and its step; None if there is none, or two.

    Exact positions are multiples of a step, of which some may be left out. Rounded ones stand within half a unit of
    a straight line with one row a step.
    """
    rows = np.arange(float(x.size))
    usual = float(np.median(np.diff(x))) or x[-1] - x[0]
    step = float((x[-1] - x[0]) / np.rint((x[-1] - x[0]) / usual))
    exact = np.rint((x - x[0]) / step)
    off = np.abs(x - x[0] - exact * step)
    is_exact = (off <= UNEVEN * step).all() and (np.diff(exact) > 0).all() and exact[-1] < MAX_HEIGHTS
    if is_exact and exact[-1] - rows[-1] <= FEW_GAPS:
        return exact, step
    rounded = _rounded_step(x, unit)
    if rounded and is_exact:
        return None, 0.0
    return (rows, rounded) if rounded else (exact, step) if is_exact else (None, 0.0)


def _rounded_step(x: Array, unit: float) -> float:
    """Return the step of positions that are rounded, or cut, to a unit; 0 if there is none.

    It is the decimal number with the fewest digits among the steps that give exactly these digits. A gap shifts the
    positions behind it, which no step then gives. Only a gap within less than a unit may leave a range of steps, but
    hardly one with a decimal number of fewer digits than such a range has by chance.
    """
    half = unit / 2 * SLACK + np.spacing(np.abs(x).max())
    low, high = (sign * _least_step(sign * x, half) for sign in (1, -1))
    middle = (low + high) / 2
    if not high - low <= 2 * MAX_ERROR * middle:
        return 0.0
    rounded = ((round(middle, decimals), 10.0**-decimals) for decimals in range(2 * MOST_DECIMALS))
    step, digit = next(((step, digit) for step, digit in rounded if low <= step <= high), (middle, 0.0))
    return step if step >= unit or digit >= BY_CHANCE * (high - low) else 0.0


def _least_step(x: Array, half: float) -> float:
    """Return the least slope of a straight line within `half` of equidistant values; NaN if there is none.

    Each pair of values bounds the slope. The pair that stands farthest apart about a slope that is too small gives
    the next one.
    """
    rows, x = np.arange(x.size), x - x[0]
    before, step = -math.inf, float(x[-1] - 2 * half) / rows[-1]
    while step > before:
        off = x - step * rows
        above, below = int(off.argmax()), int(off.argmin())
        if off[above] - off[below] <= 2 * half:
            return step
        if above < below:
            return math.nan
        before, step = step, float(x[above] - x[below] - 2 * half) / (above - below)
    return before


def _last_digit(x: Array) -> float:
    """Return the unit of the last decimal of all positions; 0 if they have more than nine."""
    units = (10.0**-decimals for decimals in range(MOST_DECIMALS))
    return next((unit for unit in units if (np.abs(x / unit - np.rint(x / unit)) < 1e-6).all()), 0.0)
