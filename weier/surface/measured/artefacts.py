"""Checks of measured heights: missing values, jumps that are not roughness, tilt and form.

docs/measured.rst, "Artefacts of measurements", lists what is refused and what is filled. Each height is compared with
the rest of the line, by standard deviations estimated from medians and quartiles, which a few outliers do not change.
`python -m benchmarks artefacts` counts what each limit refuses wrongly or misses if it is halved or doubled.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from weier import units
from weier.checks import checked_count, checked_number, checked_numbers
from weier.kernels.arrays import Array

# Fewer heights say too little about a spectrum. The upper limit bounds time and memory.
MIN_HEIGHTS, MAX_HEIGHTS = 16, 10**6
MEAN, TILT, FORM = DETREND = ("mean", "tilt", "form")
DEGREES = {MEAN: 0, TILT: 1, FORM: 2}  # degree of the polynomial that each word removes
NORMAL_MEDIAN = 0.6745  # median magnitude of a normal distribution, in standard deviations
MISSING_TYPES = ("NoneType", "MaskedConstant", "NAType")  # of None, numpy.ma.masked and pandas.NA
# A code for missing heights recurs exactly, as the lowest or highest value, and is off the line of the other heights
# by ten standard deviations of the changes between neighbours, unlike a groove with its flanks. Or it is off by two
# and recurs most often, at least three times, among heights nine tenths of which do not recur.
SENTINEL_DEVIATIONS, OFF_LINE_DEVIATIONS = 10.0, 2.0
MIN_RECURRENCES, MIN_DISTINCT = 3, 0.9
# From one height to the next, normal roughness changes by at most five standard deviations: one
# change in 10^6 is larger. A change of six is abrupt. On the flank of a groove, an abrupt change has a neighbour of
# the same sign and of equal size within a factor of three. Any other abrupt change is a jump if it is twice as large
# as all changes that are not near one.
ABRUPT_DEVIATIONS, FLANK_RATIO, JUMP_OUTLIER = 6.0, 3.0, 2.0
# Within one to three steps, a change is also a jump if it exceeds a tenth of the range of heights, is five times as
# large as the three differences on either side and contains one that is twice as large as all differences outside
# jumps. Roughness has no such change, even for D near 2 or with flat crests.
JUMP_FRACTION, JUMP_STEPS, JUMP_RATIO, JUMP_NEIGHBOURS = 0.1, (1, 2, 3), 5.0, 3
SAME_HEIGHT = 1e-6  # Two heights are equal if they differ by less than this fraction of the range.
MANY_EQUAL = 0.01  # from this fraction of equal neighbours on, an equal pair at the ends of a period tells nothing


def with_gaps(heights: Any, missing_value: float | Sequence[float] | None = None) -> Array:
    """Return heights as an array of floats, shape (samples,), in their own unit; NaN for missing heights.

    Masked values, of NumPy or astropy, None, pandas.NA and what equals a `missing_value` are missing.
    """
    if hasattr(heights, "unmasked"):  # masked arrays of astropy are no masked arrays of NumPy
        heights = np.ma.masked_array(units.bare(heights.unmasked), heights.mask)
    values = units.bare(heights)
    if hasattr(values, "__array__"):
        with suppress(TypeError):  # a dataset of xarray is no array
            values = np.asanyarray(values)
    if np.ma.isMaskedArray(values):
        values = values.tolist()  # with None for masked values
    if isinstance(values, list | tuple) or getattr(values, "dtype", None) is np.dtype(object):
        with suppress(TypeError):  # nor are datasets in a list, which are refused below
            values = np.array([math.nan if type(z).__name__ in MISSING_TYPES else z for z in values], object)
    z = checked_numbers("heights", values, "be finite or missing", lambda z: ~np.isinf(z))
    if z.ndim != 1:
        raise ValueError(f"heights must be one list, got an array of shape {z.shape}")
    if not MIN_HEIGHTS <= z.size <= MAX_HEIGHTS:
        raise ValueError(f"heights must be {MIN_HEIGHTS} to {MAX_HEIGHTS} numbers, got {z.size}")
    for value in missing_value if isinstance(missing_value, list | tuple) else [missing_value]:
        if value is not None:
            number = checked_number("missing_value", value)
            z = np.where(np.isclose(z, number, rtol=1e-6, atol=0), math.nan, z)  # a float32 has seven digits
    return z


def without_gaps(z: Array, max_gap: int) -> tuple[Array, int]:
    """Return the heights with runs of missing ones interpolated linearly, and the number of these.

    The trace is cut off where heights at its ends are missing. A run that is longer than `max_gap` is refused, and so
    are all missing heights if that is 0.
    """
    checked_count("max_gap", max_gap, 0)
    known = np.flatnonzero(~np.isnan(z))
    if known.size == z.size:
        return z, 0
    if not known.size:
        raise ValueError(f"all {z.size} heights are missing")
    gaps = np.diff(known) - 1
    inside, longest = int(gaps.sum()), int(gaps.max(initial=0))
    if longest > max_gap or max_gap == 0:
        raise ValueError(
            f"{z.size - known.size} of {z.size} heights are missing, the first is height {np.isnan(z).argmax() + 1}, "
            f"at most {longest} adjacent between others: say max_gap={max(longest, 1)} to fill these on straight "
            "lines and cut off missing ends, or take a part of the trace"
        )
    within = np.arange(known[0], known[-1] + 1)
    if within.size < MIN_HEIGHTS:
        raise ValueError(f"heights must be {MIN_HEIGHTS} at least without missing ends, got {within.size}")
    return np.interp(within, known, z[known]), inside


def check_sentinels(z: Array) -> None:
    """Refuse a value that recurs exactly, off the line of the other heights: a code for missing heights."""
    values, first, count = np.unique(z, return_index=True, return_counts=True)
    limits = {0: SENTINEL_DEVIATIONS, values.size - 1: SENTINEL_DEVIATIONS}
    most = int(count.argmax())
    # Heights of few digits recur by chance.
    if count[most] >= MIN_RECURRENCES and values.size - 1 >= MIN_DISTINCT * (z.size - count[most]):
        limits = {most: OFF_LINE_DEVIATIONS} | limits
    for at, deviations in limits.items():
        if count[at] > 1 and values.size > 2 and _off_line(z, values[at]) > deviations:
            raise ValueError(
                f"heights must be measured, got {values[at]:.9g} at {count[at]} of {z.size} places, first at height "
                f"{first[at] + 1}, far from its neighbours: if it is a code for missing heights, say "
                f"missing_value={values[at]:.9g}"
            )


def _off_line(z: Array, value: float) -> float:
    """Return the median distance of a value from lines through its neighbours, in deviations of ordinary changes."""
    here = z == value
    known = np.flatnonzero(~here)
    off = np.abs(np.interp(np.flatnonzero(here), known, z[known]) - value)
    return float(np.median(off)) / _ordinary(np.abs(np.diff(z[known])))


def _ordinary(size: Array) -> float:
    """Return the standard deviation of changes of these sizes; at least one unit of heights with few digits.

    Most of their changes are 0 or one unit.
    """
    counted = size[size > SAME_HEIGHT * size.max(initial=0)]
    return max(float(np.median(counted)) / NORMAL_MEDIAN, float(counted.min())) if counted.size else math.inf


def check_jumps(z: Array, step: float) -> None:
    """Refuse heights with steps and spikes: waves overshoot there, and contact would begin at an artefact.

    `z` is in m, and so is the step along x.
    """
    jump = _abrupt_change(z) or _isolated_jump(z)
    if jump is None:
        return
    at, width = jump
    size = np.ptp(z[at : at + width + 1])
    # After a spike the heights return within ten steps.
    back = np.flatnonzero(np.abs(z[at + 2 : at + 11] - z[at]) < size / 2)
    kind, width = ("spike", int(back[0]) + 2) if back.size else ("step", width)
    raise ValueError(
        f"heights must not jump, got a {kind} of {size:.3g} m between heights {at + 1} and {at + width + 1}, behind "
        f"x = {at * step:.6g} m: cut the trace there, or write what is between as nan, and say max_gap={width}"
    )


def _abrupt_change(z: Array) -> tuple[int, int] | None:
    """Return start and width of the first abrupt change without an adjacent flank, however dense such changes are."""
    change = np.diff(z)
    change = change - np.median(change)
    size = np.abs(change)
    before, after = np.append(0, change[:-1]), np.append(change[1:], 0)
    same_way = np.maximum(before * np.sign(change), after * np.sign(change))
    suspect = (size > ABRUPT_DEVIATIONS * _ordinary(size)) & (same_way < size / FLANK_RATIO)
    near = np.convolve(suspect, np.ones(2 * JUMP_NEIGHBOURS - 1), "same") > 0
    abrupt = np.flatnonzero(suspect & (size > JUMP_OUTLIER * size[~near].max(initial=0)))
    return (int(abrupt[0]), 1) if abrupt.size and not near.all() else None


def _isolated_jump(z: Array) -> tuple[int, int] | None:
    """Return start and width of a jump within one to three steps that is far larger than the changes around it."""
    change, n = np.abs(np.diff(z)), JUMP_NEIGHBOURS
    largest = sliding_window_view(np.pad(change, n), n).max(axis=1)  # largest of the n changes before each height
    others, jumps = change.copy(), []
    for width in JUMP_STEPS:
        size = np.ptp(sliding_window_view(z, width + 1), axis=1)
        around = np.maximum(largest[: size.size], largest[width + n :])
        for at in np.flatnonzero((size > JUMP_FRACTION * np.ptp(z)) & (size > JUMP_RATIO * around)).tolist():
            others[at : at + width] = 0
            jumps.append((at, width))
    # The narrowest jumps come first.
    return next((jump for jump in jumps if change[jump[0] : sum(jump)].max() > JUMP_OUTLIER * others.max()), None)


def warn_about_period_end(z: Array) -> None:
    """Warn if the last height of a period is equal to the first one, and few neighbours are equal."""
    is_same = np.abs(np.diff(z, append=z[0])) <= SAME_HEIGHT * np.ptp(z)
    if is_same[-1] and is_same[:-1].mean() < MANY_EQUAL:
        warnings.warn(
            f"the first and the last of {z.size} heights of a period are equal, {z[-1]:.6g} m: if the last one "
            f"repeats the first, leave it out and take the length of {z.size - 1} steps",
            stacklevel=4,
        )


def detrended(z: Array, detrend: str) -> Array:
    """Return the heights without their mean, straight line or parabola, by least squares."""
    x = np.arange(z.size, dtype=float)
    x = (x - x.mean()) / max(np.ptp(x), 1.0)
    basis = np.linalg.qr(np.vander(x, DEGREES[detrend] + 1, increasing=True))[0]
    left = z - basis @ (basis.T @ z)
    # Twice, since the first time leaves rounding of the whole, which may be far higher than the roughness.
    return np.asarray(left - basis @ (basis.T @ left))


def warn_about_form(level: Array) -> None:
    """Warn if a tilt or parabola exceeds the roughness, so that the form would decide the contact."""
    rough = float(np.std(detrended(level, FORM)))
    form = float(np.std(level - detrended(level, FORM)))
    if form > 5.0 * rough:
        warnings.warn(
            f"the form of the trace, a parabola or tilt of {form:.3g} m root mean square, is {form / rough:.3g} "
            f'times as high as its roughness, {rough:.3g} m: say detrend="form" for the roughness alone',
            stacklevel=4,
        )
