"""Heights at equal steps from heights at positions, which may be rounded or incomplete."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from weier.kernels.arrays import Array
from weier.surface.measured.artefacts import MAX_HEIGHTS

STEP_TOLERANCE = 0.01  # tolerance of equal steps in files, in steps
MAX_DECIMALS = 9  # decimals of rounded positions
MAX_ERROR = 0.0075  # largest error of the length
# A step known to a tenth of a digit is a decimal number of that few digits by chance in one of ten cases.
BY_CHANCE = 10
ROUNDING_FACTOR = 1.01  # tolerance for a fitted step and for rounded decimals as floats
REMEDIES = (
    "interpolate the heights at equal steps, write the positions with more digits, or, if no row is left out, take "
    "the column of heights alone, as in columns=1, with the length"
)


def on_grid(x: Array, heights: Array, length: float | None, place: Callable[[int], str]) -> tuple[Array, float]:
    """Return heights at equal steps, NaN for omitted rows, and the length of the trace, steps times heights.

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
    if not step:
        even = x[0] + (x[-1] - x[0]) / rise.size * np.arange(x.size)
        at = int(np.abs(x - even).argmax())
        raise ValueError(f"positions must rise in equal steps, got {x[at]} at {place(at)}: {REMEDIES}")
    full = np.full(int(number[-1]) + 1, np.nan)
    full[number.astype(int)] = heights
    own = step * full.size
    if length is not None and abs(length - own) > ROUNDING_FACTOR * max(STEP_TOLERANCE * step, unit):
        raise ValueError(
            f"length must be that of {full.size} steps where positions go from {x[0]:g} to {x[-1]:g}, about "
            f"{own:.6g}, got {length:g}: leave out the length, or take the column of heights alone, as in columns=1"
        )
    return full, own if length is None else length


def _grid(x: Array, unit: float) -> tuple[Array, float]:
    """Return the number of each position in a grid from the first one, and its step; 0 if there is none.

    Exact positions are multiples of a step. Some may be left out if the step exceeds the unit of the last decimal.
    Rounded ones stand within half a unit of a straight line with one row a step.
    """
    rows = np.arange(float(x.size))
    usual = float(np.median(np.diff(x))) or x[-1] - x[0]
    step = float((x[-1] - x[0]) / np.rint((x[-1] - x[0]) / usual))
    exact = np.rint((x - x[0]) / step)
    off = np.abs(x - x[0] - exact * step)
    is_exact = (off <= STEP_TOLERANCE * step).all() and (np.diff(exact) > 0).all() and exact[-1] < MAX_HEIGHTS
    if is_exact:
        return exact, step if exact[-1] == rows[-1] or step > ROUNDING_FACTOR * unit else 0.0
    return rows, _rounded_step(x, unit)


def _rounded_step(x: Array, unit: float) -> float:
    """Return the step of positions that are rounded, or cut, to a unit; 0 if there is none.

    The fitted step is rounded to as few decimals as the positions allow. After a gap of more than a unit no step fits
    the positions; after a smaller gap one may fit, but hardly one of few digits. The steps that fit are an interval:
    if neither step at a distance fits, all are within it. It must be at least that by which half a unit of the
    length changes the step, since a gap may narrow the interval.
    """
    rows = np.arange(x.size)
    fitted = float(np.polyfit(rows, x, 1)[0])

    def fits(step: float) -> bool:
        return bool(np.ptp(x - step * rows) <= ROUNDING_FACTOR * unit)

    for decimals in range(2 * MAX_DECIMALS):
        step = round(fitted, decimals)
        if fits(step):
            error = min(MAX_ERROR * step, 10.0**-decimals / BY_CHANCE if step < unit else np.inf)
            is_known = unit / 2 / rows[-1] <= error and not fits(step - error) and not fits(step + error)
            return step if is_known else 0.0
    return 0.0


def _last_digit(x: Array) -> float:
    """Return the unit of the last decimal of all positions; 0 if they have more than nine."""
    units = (10.0**-decimals for decimals in range(MAX_DECIMALS))
    return next((unit for unit in units if (np.abs(x / unit - np.rint(x / unit)) < 1e-6).all()), 0.0)
