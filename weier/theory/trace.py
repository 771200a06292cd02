"""A measured surface: heights at equal steps, as the finite sum of waves that the numerical methods take.

Lengths along x are in lambda_0, the length of the trace, heights in g_0, the root mean square height of its waves,
and pressures in p_0* = 2 pi M g_0/lambda_0.
"""

from __future__ import annotations

import hashlib
import math
import re
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import ArrayLike

from weier.kernels.arrays import Array
from weier.theory.arguments import checked_file, checked_number, checked_numbers, checked_word, shown
from weier.theory.limits import MAX_WAVES
from weier.theory.profile import PARAMETERS
from weier.theory.waves import Waves

MIN_HEIGHTS, MAX_HEIGHTS = 16, 10**6
MIRRORED, PERIODIC, TAPERED = ENDS = ("mirrored", "periodic", "tapered")
TAPER = 0.1  # of the length at each end, over which a tapered trace falls to its mean
ROUNDING = 1e-14  # of g_0: lower waves are what rounding leaves of a smooth surface
# A jump within one to three steps is more than a tenth of all heights, five times as large as the three differences
# on either side, and has one that is twice as large as all outside jumps: roughness has none, with D near 2 and with
# flat tops, either.
JUMP_STEPS, JUMP_SHARE, JUMP_RATIO, JUMP_NEIGHBOURS, JUMP_OUTLIER = (1, 2, 3), 0.1, 5.0, 3, 2.0
NEAR = 1 + 1e-9  # what quotients of decimal numbers are off
UNEVEN = 0.01  # of a step: the digits that files give of positions
UNITS = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "\u00b5m": 1e-6, "\u03bcm": 1e-6, "nm": 1e-9}  # micro sign and Greek mu


class Trace(Waves):
    """A surface given by its heights: one line across the roughness of a turned, ground or drawn body.

    The mean is removed, and the tilt by least squares unless the trace is periodic. It is continued as a periodic
    surface, and waves shorter than `shortest` are cut off; nothing else is smoothed. Between the samples the surface
    is the sum of the waves that are left.

    Parameters
    ----------
    heights : array_like, shape (samples,)
        At equal steps, upwards out of the body, in m.
    length : float
        Of the trace, as many steps as there are heights, in m.
    shortest : float, optional
        The shortest wavelength that is kept, in m; by default two steps, so that all are.
    ends : "mirrored", "periodic" or "tapered"
        How the surface goes on behind the ends: as a mirror image, so that the period is twice the length; from the
        start, as it is periodic already; or from the start, once the heights have fallen smoothly to their mean over
        the last tenth of the length at either end.
    source : str
        Where the heights come from: a name for the results.

    Attributes
    ----------
    lambda_0, g_0 : float
        The units of lengths and heights, in m: the length of the trace, and the root mean square of its waves.
    samples, digest : int, str
        The number of heights, and twelve letters that differ where heights or waves do.
    amplitude, phase : ndarray, shape (m,)
        Of the waves, in g_0 and in radians; x = 0 is the first height.
    waves_per_period, period : list of int, int
        Waves of each kind in one period, ascending, and its length in lambda_0: 2 if the trace is mirrored, else 1.

    Raises
    ------
    ValueError
        If the heights are no roughness that waves can describe; the message says what would do.

    Examples
    --------
    >>> import numpy as np
    >>> import weier
    >>> x = 5e-6 * np.arange(400)
    >>> heights = 1e-6 * np.cos(2 * np.pi * x / 1e-3) + 2e-7 * np.cos(2 * np.pi * x / 8e-5 + 1)
    >>> trace = weier.Trace(heights, length=2e-3, ends="periodic")
    >>> print(f"{trace.describe()}; g_0 = {trace.g_0:.3g} m")
    trace of 400 heights over 0.002 m, 2 waves down to 8e-05 m; g_0 = 7.21e-07 m
    """

    listed_terms = 0  # the file of heights tells the waves

    def __init__(
        self, heights: ArrayLike, length: float, shortest: float | None = None, ends: str = MIRRORED, source: str = ""
    ) -> None:
        if isinstance(heights, str | Path):
            raise ValueError(f"heights must be numbers, got {shown(heights)}: weier.Trace.read takes a file")
        if not isinstance(source, str):
            raise ValueError(f"source must be a text, got {shown(source)}")
        z = _checked_heights(heights)
        self.lambda_0 = checked_number("length", length, "be positive and finite, in m", lambda x: 0 < x < math.inf)
        self.ends, self.source, self.samples = checked_word("ends", ends, ENDS), source, z.size
        step = self.lambda_0 / z.size
        condition = f"lie between two steps and the length of the trace, {2 * step:g} and {self.lambda_0:g} m"
        self.shortest = checked_number(
            "shortest", 2 * step if shortest is None else shortest, condition,
            lambda x: 2 * step <= x * NEAR and x <= self.lambda_0,
        )  # fmt: skip
        level = _levelled(z, self.ends)
        _check_jumps(level if self.ends != PERIODIC else np.append(level, level[0]), step)
        z_of_period = _continued(level, self.ends)
        self.period = z_of_period.size // z.size  # 2 if it is mirrored
        # The phase of two samples a wave is unknown: only shorter numbers of waves are told apart.
        most = min(math.floor(self.period * self.lambda_0 / self.shortest * NEAR), (z_of_period.size - 1) // 2)
        waves = np.arange(1, most + 1)
        coefficient = 2 * np.fft.rfft(z_of_period)[waves] / z_of_period.size
        self.g_0 = math.sqrt(float(np.vdot(coefficient, coefficient).real) / 2)
        if not self.g_0 > ROUNDING * np.abs(z).max():
            raise ValueError(f"heights must be rough, got none with waves of {self.shortest:g} m or longer")
        rough = np.abs(coefficient) > ROUNDING * self.g_0
        self.waves_per_period, self.m = waves[rough].tolist(), int(rough.sum())
        self.amplitude, self.phase = np.abs(coefficient[rough]) / self.g_0, np.angle(coefficient[rough])
        told = [self.lambda_0, self.shortest, self.ends]
        self.digest = hashlib.sha256(repr(told).encode() + z.tobytes()).hexdigest()[:12]
        if (finest := self.waves_per_period[-1]) > MAX_WAVES:
            raise ValueError(
                f"shortest must leave at most {MAX_WAVES} of the finest waves in a period, got {self.shortest:g} m, "
                f"which leaves {finest}: take a larger one, or a part of the trace"
            )

    @classmethod
    def read(
        cls,
        path: str | Path,
        length: float | None = None,
        shortest: float | None = None,
        ends: str = MIRRORED,
        x_unit: str = "m",
        height_unit: str = "m",
    ) -> Trace:
        """A trace from a file of text with one or two columns, between commas, semicolons or blanks.

        Parameters
        ----------
        path : path
            Two columns are positions at equal steps and heights, one column is the heights. A first line that is no
            numbers is a heading; empty lines and those that begin with # say nothing.
        length : float, optional
            Of the trace, in m, if there is one column.
        shortest, ends
            As of a trace.
        x_unit, height_unit : "m", "mm", "um" (also with the letter mu) or "nm"
            What the file has positions and heights in.

        Raises
        ------
        FileNotFoundError
            If there is no such file.
        ValueError
            If it is no such table, or its heights are no roughness.

        """
        table = _table(checked_file(path))
        heights = table[:, -1] * UNITS[checked_word("height_unit", height_unit, UNITS)]
        if (length is None) == (table.shape[1] == 1):
            two = "two columns, with positions: length must be left out, and decimals must have points"
            raise ValueError(f"{path} has {'one column: its length must be given' if length is None else two}")
        if length is None:
            length = _length(table[:, 0]) * UNITS[checked_word("x_unit", x_unit, UNITS)]
        return cls(heights, length, shortest, ends, Path(path).name)

    @cached_property
    def total_amplitude(self) -> float:
        """The highest point above the mean plane, in g_0: compliance counts from first contact."""
        return self.crest[1]

    @property
    def parameters(self) -> dict[str, Any]:
        """What a scene knows this trace by: its name, and the digest of its heights."""
        return {"trace": {"file": self.source, "digest": self.digest}}

    @property
    def labels(self) -> dict[str, Any]:
        """What tells this trace from others, by the names of coordinates; those of a series are unknown."""
        return dict.fromkeys((*PARAMETERS, "seed"), math.nan) | {
            "m": float(self.m), "phases": "null",
            "trace": self.source, "trace_digest": self.digest, "trace_ends": self.ends,
            "trace_length": self.lambda_0, "trace_height": self.g_0, "trace_shortest": self.shortest,
        }  # fmt: skip

    def describe(self) -> str:
        """The trace in a few words."""
        name = f"trace {self.source}" if self.source else "trace"
        finest = self.period * self.lambda_0 / self.waves_per_period[-1]
        return f"{name} of {self.samples} heights over {self.lambda_0:g} m, {self.m} waves down to {finest:g} m"


def _checked_heights(heights: ArrayLike) -> Array:
    """The heights as an array of one dimension."""
    z = checked_numbers("heights", heights, "be finite, in m", np.isfinite)
    if z.ndim != 1:
        raise ValueError(f"heights must be one list, in m, got an array of shape {z.shape}")
    if not MIN_HEIGHTS <= z.size <= MAX_HEIGHTS:
        raise ValueError(f"heights must be {MIN_HEIGHTS} to {MAX_HEIGHTS} numbers, got {z.size}")
    if np.ptp(z) == 0:
        raise ValueError(f"heights must be rough, got {z.size} times {z[0]:g} m")
    return z


def _check_jumps(z: Array, step: float) -> None:
    """Refuse heights with steps and spikes, where waves overshoot and contact would begin at what is no roughness."""
    change, n = np.abs(np.diff(z)), JUMP_NEIGHBOURS
    largest = sliding_window_view(np.pad(change, n), n).max(axis=1)  # of the n changes before each height
    others, jumps = change.copy(), []
    for width in JUMP_STEPS:
        size = np.ptp(sliding_window_view(z, width + 1), axis=1)
        around = np.maximum(largest[: size.size], largest[width + n :])
        for at in np.flatnonzero((size > JUMP_SHARE * np.ptp(z)) & (size > JUMP_RATIO * around)).tolist():
            others[at : at + width] = 0
            jumps.append((at, width, size[at]))
    for at, width, size in jumps:  # the narrowest first
        if change[at : at + width].max() > JUMP_OUTLIER * others.max():
            kind = "step" if abs(z[at + width] - z[at]) > size / 2 else "spike"
            where = f"between heights {at + 1} and {at + width + 1}, behind x = {at * step:.6g} m"
            mended = "cut the trace there, or interpolate the heights between"
            raise ValueError(f"heights must not jump, got a {kind} of {size:.3g} m {where}: {mended}")


def _levelled(z: Array, ends: str) -> Array:
    """The heights without their mean, and without tilt unless they are periodic."""
    z = z - z.mean()
    if ends == PERIODIC:
        return z
    x = np.arange(z.size) - (z.size - 1) / 2
    return z - x * (x @ z) / (x @ x)


def _continued(z: Array, ends: str) -> Array:
    """The heights of one period."""
    if ends == PERIODIC:
        return z
    if ends == MIRRORED:
        return np.concatenate([z, z[::-1]])
    fall = np.arange(z.size) / (TAPER * z.size)
    share = np.clip(np.minimum(fall, fall[::-1]), 0, 1)
    return z * np.sin(np.pi / 2 * share) ** 2


def _table(path: Path) -> Array:
    """The numbers of a file, shape (rows, 1) or (rows, 2); one of far too many is not read to its end."""
    rows: list[list[float]] = []
    with path.open(encoding="utf-8-sig", errors="replace") as lines:
        for number, line in enumerate(map(str.strip, lines), 1):
            found = _numbers(line)
            if not line or line.startswith("#") or (number == 1 and not found):
                continue
            if len(found) not in ((len(rows[0]),) if rows else (1, 2)) or not all(map(math.isfinite, found)):
                raise ValueError(
                    f"{path}, line {number}, must have one or two finite numbers, with decimal points and as many as "
                    f"the lines before, or begin with #, got {shown(line)}"
                )
            rows.append(found)
            if len(rows) > MAX_HEIGHTS:
                break  # no trace has so many
    if not rows:
        raise ValueError(f"{path} must have one or two columns of numbers, got none")
    return np.array(rows)


def _numbers(line: str) -> list[float]:
    """The numbers of a line, NaN where one is missing; none of a line that has anything else."""
    try:
        return [float(field or "nan") for field in re.split(r"\s*[,;\s]\s*", line)]
    except ValueError:
        return []


def _length(x: Array) -> float:
    """The length of the trace: the positions times their step, if this is even."""
    step = (x[-1] - x[0]) / max(x.size - 1, 1)
    even = x[0] + step * np.arange(x.size)
    rule = "rise in equal steps (else interpolate the heights first, and write decimals with points)"
    checked_numbers("positions", x, rule, lambda x: (step > 0) & (np.abs(x - even) <= UNEVEN * step))
    return float(step * x.size)
