"""Measured surfaces: heights at equal steps as the finite sum of waves that the numerical methods solve.

docs/measured.rst explains the processing ("The trace") and the checks ("Artefacts of measurements"). The waves are
the discrete Fourier transform of one period of N heights, a_k exp(i phi_k) = (2/N) sum_j z_j exp(-2 pi i j k/N).
Lengths are in lambda_0, the length of the trace, heights in g_0 = sqrt(sum a_k^2/2), pressures in p_0* = 2 pi M
g_0/lambda_0.
"""

from __future__ import annotations

import hashlib
import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from weier import units
from weier.checks import checked_file, checked_number, checked_word, readable, shown
from weier.kernels.arrays import Array, Indices
from weier.surface.measured import artefacts as measured
from weier.surface.measured.lines import UNITS, Line, known_unit, length_of_steps, line_of_array
from weier.surface.measured.text import Table
from weier.surface.profile import PARAMETERS
from weier.surface.waves import MAX_WAVES, Waves

MIRRORED, PERIODIC = ENDS = ("mirrored", "periodic")
ROUNDING = 1e-14  # amplitudes below this fraction of g_0 are rounding errors
# tolerance for wavelengths that are quotients of decimal numbers
DECIMAL_ROUNDING = 1 + 1e-9
SAME_LENGTH = 1e-6  # relative tolerance of two lengths that should be equal but are rounded
MAX_LENGTH = 100.0  # m; a longer trace indicates a wrong unit
USUAL_LENGTH = 1.0  # m; instruments rarely measure longer lines, which give a warning
MIN_STEP = 1e-10  # m; atoms are larger
# root mean square slopes outside this range indicate a wrong unit
MIN_SLOPE, MAX_SLOPE = 1e-7, 10.0


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Trace(Waves):
    """Measured heights along a line across the roughness of a turned, ground or drawn body.

    The mean is removed, and the tilt by least squares unless the trace is periodic. The heights are extended to a
    periodic surface, and waves shorter than `shortest` are removed; there is no other smoothing. The surface is the
    sum of the remaining waves. Traces are immutable.

    Parameters
    ----------
    heights : array_like, shape (samples,)
        Heights at equal steps, upwards out of the body. NaN, None and masked values are missing. An array may have a
        unit, as of xarray or pint, and positions at equal steps: a coordinate of xarray, or the index of pandas.
    length : float
        Length of the trace, the number of heights times the step, in m, or in `x_unit` or `unit` if given. It may be
        left out if the heights have a coordinate with a unit.
    shortest : float, optional
        Shortest wavelength, lambda_s of metrology, in the unit of `length`; by default two steps, which keeps all
        waves.
    ends : "mirrored" or "periodic"
        Extension beyond the ends: the mirror image, with twice the length as period, or the trace itself, which is
        then periodic.
    source : str
        Name of the origin of the heights, for the results.
    unit, x_unit, height_unit : str, optional
        Units of length and heights, or of one of them: "m", "cm", "mm", "um" (also with the letter mu), "nm", "pm",
        "angstrom", "inch", "mil" or "uin". A unit of heights is required.
    detrend : "mean", "tilt" or "form", optional
        Component removed by least squares: the mean, a straight line (default) or a parabola, the form of a cylinder
        measured around its axis. A periodic trace has neither tilt nor form.
    max_gap : int
        Largest number of adjacent missing heights that are interpolated linearly, while missing ends are trimmed; 0,
        the default, refuses missing heights with their number and the longest run.
    missing_value : float or list of float, optional
        Numbers for missing heights, such as -9999, in the unit of the heights.

    Attributes
    ----------
    lambda_0, g_0 : float
        Units of lengths and heights, in m: the length of the trace and the root mean square of its waves.
    samples, digest : int, str
        Number of heights, and a digest of the heights that are solved and of their processing, twelve letters.
    filled : int
        Number of missing heights that are interpolated.
    amplitude, phase : ndarray, shape (m,)
        Amplitudes, in g_0, and phases, in radians, of the waves; x = 0 is the first height.
    waves_per_period, period : list of int, int
        Wave numbers per period, ascending, and the period in lambda_0: 2 if the trace is mirrored, otherwise 1.

    Raises
    ------
    ValueError
        If the unit is unknown, or the heights are not roughness that waves can describe; the message names a remedy.

    Warns
    -----
    UserWarning
        If the remaining form is much higher than the roughness, or the trace is longer than 1 m.

    Examples
    --------
    >>> import numpy as np
    >>> import weier
    >>> x = 5e-6 * np.arange(400)
    >>> heights = 1e-6 * np.cos(2 * np.pi * x / 1e-3) + 2e-7 * np.cos(2 * np.pi * x / 8e-5 + 1)
    >>> trace = weier.Trace(heights, length=2e-3, ends="periodic", unit="m")
    >>> print(f"{trace.describe()}; g_0 = {trace.g_0:.3g} m")
    trace of 400 heights over 0.002 m, 2 waves down to 8e-05 m; g_0 = 7.21e-07 m
    """

    lambda_0: float
    g_0: float
    samples: int
    shortest: float
    ends: str
    detrend: str
    filled: int
    source: str
    digest: str
    period: int
    m: int
    hurst: float = math.nan  # of random lines
    rolloff: float = math.nan

    listed_terms = 0  # the waves follow from the file of heights

    def __init__(
        self,
        heights: ArrayLike | Line,
        length: float | None = None,
        shortest: float | None = None,
        ends: str = MIRRORED,
        source: str = "",
        *,
        unit: str | None = None,
        x_unit: str | None = None,
        height_unit: str | None = None,
        detrend: str | None = None,
        max_gap: int = 0,
        missing_value: float | Sequence[float] | None = None,
    ) -> None:
        if isinstance(heights, str | Path):
            raise ValueError(f"heights must be numbers, got {shown(heights)}: weier.Trace.read takes a file")
        if not isinstance(source, str):
            raise ValueError(f"source must be a text, got {shown(source)}")
        checked_word("ends", ends, ENDS)
        detrend = _checked_detrend(detrend, ends)
        one = heights if isinstance(heights, Line) else line_of_array(heights)
        height_factor = UNITS[known_unit("heights", {"unit": unit, "height_unit": height_unit}, one.height_unit)]
        z = measured.with_gaps(one.heights, missing_value)
        length_units = {"unit": unit, "x_unit": x_unit}
        length, given = _length(one, length, length_units), z.size
        z, filled = measured.without_gaps(z, max_gap)
        if z.size < given:
            if ends == PERIODIC:
                raise ValueError(f"heights must be a whole period, got {given - z.size} that are missing at its ends")
            length = _decimal(length * z.size / given)
        measured.check_sentinels(z)
        z = z * height_factor
        unit_of_call = known_unit("the length", length_units, required=False) or "m"
        shortest = _checked_shortest(shortest, length, z.size, unit_of_call)
        level = _checked_level(z, length / z.size, detrend, ends)
        period, waves, coefficient = _waves(level, ends, length, shortest)
        contents = repr([length, shortest, ends, detrend, filled])
        self._set(
            waves,
            coefficient,
            {
                "lambda_0": length,
                "samples": z.size,
                "shortest": shortest,
                "ends": ends,
                "detrend": detrend,
                "filled": filled,
                "source": source,
                "digest": digest_of(contents.encode() + level.tobytes()),
                "period": period,
            },
        )

    def _set(self, waves: Indices, coefficient: Any, fields: Mapping[str, Any]) -> None:
        """Set the numbers of waves per period, their complex amplitudes, in m, and the other fields.

        In place of assignments, which a frozen dataclass refuses.
        """
        g_0 = math.sqrt(float(np.vdot(coefficient, coefficient).real) / 2)
        vars(self).update(fields)
        vars(self).update(
            g_0=g_0,
            m=waves.size,
            _waves=waves.tolist(),
            _amplitude=np.abs(coefficient) / g_0,
            _phase=np.angle(coefficient),
        )

    def __eq__(self, other: object) -> bool:
        """Return whether these are the same heights, processed alike, of the same origin."""
        return isinstance(other, Trace) and self._identity == other._identity

    def __hash__(self) -> int:
        return hash(self._identity)

    @property
    def _identity(self) -> tuple[str, str]:
        return self.digest, self.source

    @classmethod
    def read(
        cls,
        path: str | Path,
        length: float | None = None,
        shortest: float | None = None,
        ends: str = MIRRORED,
        x_unit: str | None = None,
        height_unit: str | None = None,
        *,
        skip: int | None = None,
        rows: int | None = None,
        columns: int | Sequence[int] | None = None,
        decimal: str | None = None,
        **options: Any,
    ) -> Trace:
        """Return a trace from a file of text with one or two columns.

        Parameters
        ----------
        path : path
            Of text, with a table of heights in one column, or positions at equal steps and heights in two. Columns
            stand between semicolons, tabs, commas or blanks. The table is one block of lines, and the heading
            directly above it may name the units, as in `x (mm),z (um)`. The lines above and below are left out.
            Whatever else is not read as numbers is refused with its line: `pandas.read_csv` reads further dialects,
            and SurfaceTopography the formats of instruments, and `weier.Trace` takes their arrays.
        length : float, optional
            Length of the trace, if it is not in the file: in m, or in `x_unit` or `unit` where one is given.
        shortest, ends
            As of a trace; `shortest` is in the unit of `length`.
        x_unit, height_unit : str, optional
            Units of positions and heights, whatever the file says of them. `unit` is for both, and must agree with
            the file.
        skip, rows : int, optional
            The number of lines above the table, and of rows in the table.
        columns : int or (int, int), optional
            The column of the heights, from 0, or those of the positions and of the heights.
        decimal : "." or ",", optional
            The sign before decimals.
        **options
            `unit`, `detrend`, `max_gap`, `missing_value` and `source`, as of a trace.

        Returns
        -------
        Trace
            The source is the name of the file, unless another one is given.

        Raises
        ------
        FileNotFoundError
            If there is no such file.
        ValueError
            If the file is no text, something in its table is not read, or its signs have two readings: the message
            has the line, and the argument that settles it. If a unit is unknown, or the heights are no roughness.
        """
        one = Table(checked_file(path), skip, rows, columns, decimal).line()
        named = one._replace(x_unit="" if x_unit else one.x_unit, height_unit="" if height_unit else one.height_unit)
        options = {"source": readable(Path(path).name), **options, "x_unit": x_unit, "height_unit": height_unit}
        return cls(named, length, shortest, ends, **options)

    @classmethod
    def between(cls, first: Trace, second: Trace) -> Trace:
        """Return the trace of the gap between two rough bodies: the sum of their heights.

        Without friction, two rough bodies touch as a flat one does with a body that has both roughnesses.

        Parameters
        ----------
        first, second : Trace
            Heights of both bodies, each upwards out of its own body, along the same direction in the contact, of the
            same length, steps, ends, shortest wavelength and detrending.

        Returns
        -------
        Trace
            The sum of the waves, named after both; `filled` counts the filled heights of both.

        Raises
        ------
        ValueError
            If the two differ in what must be the same, or cancel.

        Notes
        -----
        This is a plane problem only if the ridges of both bodies are parallel. Ridges that cross touch at spots, as a
        sum of two profiles along different directions.

        Examples
        --------
        >>> import numpy as np
        >>> import weier
        >>> x = np.arange(200) / 200
        >>> shaft = weier.Trace(np.cos(2 * np.pi * x), 2e-3, ends="periodic", height_unit="um")
        >>> bush = weier.Trace(0.5 * np.cos(10 * np.pi * x), 2e-3, ends="periodic", height_unit="um")
        >>> gap = weier.Trace.between(shaft, bush)
        >>> gap.waves_per_period
        [1, 5]
        """
        pair = (first, second)
        if not all(isinstance(trace, Trace) for trace in pair):
            raise ValueError(f"first and second must be traces, got {shown(first)} and {shown(second)}")
        names = ("lambda_0", "samples", "ends", "detrend", "shortest")
        words = {"lambda_0": "length in m", "samples": "number of heights"}
        for name in names:
            one, other = getattr(first, name), getattr(second, name)
            if not (math.isclose(one, other, rel_tol=SAME_LENGTH) if isinstance(one, float) else one == other):
                raise ValueError(
                    f"both traces must have the same {words.get(name, name)}, got {one} and {other}: read both with "
                    "the same length, shortest, ends and detrend, or interpolate the heights of one at the steps of "
                    "the other"
                )
        waves = np.union1d(first.waves_per_period, second.waves_per_period)
        coefficient = np.zeros(waves.size, complex)
        for trace in pair:
            at = np.searchsorted(waves, trace.waves_per_period)
            coefficient[at] += trace.g_0 * trace.amplitude * np.exp(1j * trace.phase)
        rough = np.abs(coefficient) > ROUNDING * max(first.g_0, second.g_0)
        if not rough.any():
            raise ValueError("both traces must leave a gap, got heights that cancel: is one of them upside down?")
        shared = {name: getattr(first, name) for name in (*names, "period")}
        return cls.from_waves(
            waves[rough],
            coefficient[rough],
            **shared,
            filled=first.filled + second.filled,
            source=" on ".join(filter(None, (first.source, second.source))),
            digest=digest_of("".join(sorted((first.digest, second.digest))).encode()),
        )

    @classmethod
    def from_waves(cls, waves: Indices, coefficient: Any, **fields: Any) -> Trace:
        """Return the trace of waves, by their numbers in a period and complex amplitudes in m, and other fields."""
        trace = object.__new__(cls)
        trace._set(waves, coefficient, {"filled": 0, **fields})
        return trace

    @cached_property
    def total_amplitude(self) -> float:
        """The highest point above the mean plane, in g_0: compliance counts from first contact."""
        return self.crest[1]

    @property
    def parameters(self) -> dict[str, Any]:
        """Identity of this trace in a scene: its name, and the digest of its heights."""
        return {"trace": {"file": self.source, "digest": self.digest}}

    @property
    def labels(self) -> dict[str, Any]:
        """Labels of this trace by the names of coordinates; labels of a series are unknown."""
        random = {"trace_hurst": self.hurst, "trace_rolloff": self.rolloff} if math.isfinite(self.hurst) else {}
        return dict.fromkeys((*PARAMETERS, "seed"), math.nan) | {
            **random,
            "m": float(self.m),
            "phases": "null",
            "trace": self.source,
            "trace_digest": self.digest,
            "trace_ends": self.ends,
            "trace_length": self.lambda_0,
            "trace_height": self.g_0,
            "trace_shortest": self.shortest,
            "trace_detrend": self.detrend,
            "trace_filled": float(self.filled),
        }

    def describe(self) -> str:
        """Return the trace in a few words."""
        name = f"trace {self.source}" if self.source else "trace"
        finest = self.period * self.lambda_0 / self.waves_per_period[-1]
        filled = f", {self.filled} of them interpolated," if self.filled else ""
        return (
            f"{name} of {self.samples} heights{filled} over {self.lambda_0:g} m, {self.m} waves down to {finest:g} m"
        )


def digest_of(contents: bytes) -> str:
    """Return the digest that identifies a trace of these contents."""
    return hashlib.sha256(contents).hexdigest()[:12]


def _checked_detrend(detrend: str | None, ends: str) -> str:
    """Return the polynomial to be removed from the heights: for a periodic trace, only the mean."""
    if detrend is None:
        return measured.MEAN if ends == PERIODIC else measured.TILT
    checked_word("detrend", detrend, measured.DETREND)
    if ends == PERIODIC and detrend != measured.MEAN:
        raise ValueError(
            f"detrend must be {measured.MEAN} where the ends are periodic, got {detrend!r}: leave it out"
        )
    return detrend


def _length(one: Line, length: float | None, given: Mapping[str, Any]) -> float:
    """Return the length of the line, in m, from the call or the positions."""
    if length is not None:
        scale = 1.0 if units.unit_of(length) else UNITS[known_unit("the length", given, required=False) or "m"]
        number = checked_number("length", length, "be positive and finite", lambda x: 0 < x < math.inf, units.METRE)
        length = number if scale == 1 else _decimal(scale * number)
    if one.positions is not None:
        unit = UNITS[known_unit("positions", given, one.x_unit)]
        return _decimal(unit * length_of_steps(one.positions, None if length is None else length / unit))
    if length is None:
        raise ValueError("length must be given where heights have no positions: in m, or in x_unit")
    return length


def _decimal(length: float) -> float:
    """Return a length that is computed from decimal numbers without the rounding of floats, in twelve digits."""
    return float(f"{length:.12g}")


def _checked_shortest(shortest: float | None, length: float, samples: int, unit: str) -> float:
    """Return the shortest wavelength in m, from a value in the unit of length of the call or with its own unit."""
    size = UNITS[unit]
    if shortest is None:
        return _decimal(2 * length / samples)
    if units.unit_of(shortest):
        shortest = units.in_unit("shortest", shortest, units.METRE) / size
    least, most = 2 * length / samples / size, length / size
    return size * checked_number(
        "shortest",
        shortest,
        f"lie between two steps and the length of the trace, {least:g} and {most:g} {unit}",
        lambda x: least <= x * DECIMAL_ROUNDING and x <= most * DECIMAL_ROUNDING,
    )


def _checked_level(z: Array, step: float, detrend: str, ends: str) -> Array:
    """Return the detrended heights, in m; ValueError unless they are roughness."""
    level = measured.detrended(z, detrend)
    if not step * z.size <= MAX_LENGTH:
        raise ValueError(f"length must be at most {MAX_LENGTH:g} m, got {step * z.size:.4g} m: is a unit wrong?")
    if step * DECIMAL_ROUNDING < MIN_STEP:
        raise ValueError(
            f"the step between heights must be at least {MIN_STEP:g} m, since atoms are larger, got {step:.3g} m "
            f"from {z.size} heights over {step * z.size:.4g} m: correct length, unit or x_unit"
        )
    if np.ptp(level) <= ROUNDING * z.size * np.abs(z).max():
        raise ValueError(f"heights must be rough, got {z.size} without any but their {detrend}, from {z[0]:g} m")
    if ends == PERIODIC:
        measured.check_jumps(np.append(level, level[0]), step)
        measured.warn_about_period_end(level)
    else:
        measured.check_jumps(level, step)
        measured.warn_about_form(level)
    slope = float(np.sqrt(np.mean(np.diff(level) ** 2))) / step
    if not MIN_SLOPE <= slope <= MAX_SLOPE:
        limit = f"at most {MAX_SLOPE:g}" if slope > MAX_SLOPE else f"at least {MIN_SLOPE:g}"
        raise ValueError(
            f"heights must have a root mean square slope of {limit}, got {slope:.3g} with heights from "
            f"{level.min():.3g} to {level.max():.3g} m at steps of {step:.3g} m: is a unit wrong?"
        )
    if step * z.size > USUAL_LENGTH:
        warnings.warn(
            f"the trace is {step * z.size:.4g} m long, with heights from {level.min():.3g} to {level.max():.3g} m, "
            f"and instruments rarely measure more than {USUAL_LENGTH:g} m: if a unit is wrong, correct unit, x_unit "
            "or height_unit",
            stacklevel=3,
        )
    return level


def _waves(level: Array, ends: str, length: float, shortest: float) -> tuple[int, Indices, Any]:
    """Return the period in lengths of the trace, the wave numbers above rounding, and their amplitudes, in m."""
    z, period = (level, 1) if ends == PERIODIC else (np.concatenate([level, level[::-1]]), 2)
    # the phase of a wave of two samples is undetermined, so that the N/2-th wave is omitted
    most = min(math.floor(period * length / shortest * DECIMAL_ROUNDING), (z.size - 1) // 2)
    waves = np.arange(1, most + 1)
    coefficient = 2 * np.fft.rfft(z)[waves] / z.size
    size = np.abs(coefficient)
    rough = size > ROUNDING * np.linalg.norm(size) / math.sqrt(2)
    if not size.max(initial=0) > ROUNDING * np.abs(level).max():
        raise ValueError(f"heights must be rough, got none with waves of {shortest:g} m or longer")
    if (finest := int(waves[rough][-1])) > MAX_WAVES:
        raise ValueError(
            f"shortest must leave at most {MAX_WAVES} of the finest waves in a period, got {shortest:g} m, "
            f"which leaves {finest}: take a larger one, or a part of the trace"
        )
    return period, waves[rough], coefficient[rough]
