"""Random self-affine roughness: a periodic sum of waves whose spectrum is a power law below a roll-off."""

from __future__ import annotations

import math

import numpy as np

from weier import units
from weier.checks import checked_number
from weier.surface.measured.artefacts import MEAN
from weier.surface.measured.trace import (
    DECIMAL_ROUNDING,
    MAX_LENGTH,
    MAX_SLOPE,
    MIN_SLOPE,
    MIN_STEP,
    PERIODIC,
    Trace,
    digest_of,
)
from weier.surface.profile import random_phases
from weier.surface.waves import MAX_WAVES


def gaussian(
    hurst: float,
    length: float,
    shortest: float,
    *,
    rolloff: float | None = None,
    rms_height: float | None = None,
    rms_slope: float | None = None,
    seed: int = 0,
) -> Trace:
    """Return a random rough line of a self-affine power spectrum, as a periodic trace.

    Parameters
    ----------
    hurst : float
        Hurst exponent H in (0, 1); the fractal dimension of the line is D = 2 - H.
    length : float
        Period of the line, in m.
    shortest : float
        Shortest wavelength, in m: the cut-off.
    rolloff : float, optional
        Wavelength above which the spectrum is constant, in m; by default the length.
    rms_height, rms_slope : float
        Root mean square height, in m, or slope of the line: one of them.
    seed : int
        Seed of the phases.

    Returns
    -------
    Trace
        Solved like measured heights; its length is `lambda_0`, and its root mean square height `g_0`.

    Raises
    ------
    ValueError
        If an argument is out of its range, or if both or neither of `rms_height` and `rms_slope` are given.

    Notes
    -----
    The line is a sum of all waves k = 1, 2, ... of the period L down to the shortest,

        z(x) = sum_k a_k cos(2 pi k x/L + phi_k),    a_k^2 ~ max(k, L/rolloff)^(-1 - 2 H),

    with fixed amplitudes and independent phases, uniform in [0, 2 pi): each line has exactly the given height or
    slope and the same spectrum. Heights of many waves of similar size are Gaussian by the central limit theorem; a
    line without a roll-off is dominated by its longest waves, which are not many.

    Examples
    --------
    >>> import weier
    >>> line = weier.gaussian(0.8, 2e-3, 1e-5, rolloff=4e-4, rms_height=4e-7, seed=1)
    >>> line.describe()
    'trace H = 0.8, roll-off 0.0004 m, seed 1 of 402 heights over 0.002 m, 200 waves down to 1e-05 m'
    >>> print(f"g_0 = {line.g_0:.2g} m, slope {line.rms[1] * line.g_0 / line.lambda_0:.3f}")
    g_0 = 4e-07 m, slope 0.015
    """
    H = checked_number("hurst", hurst, "lie in (0, 1)", lambda H: 0 < H < 1)
    length = _checked_length("length", length, MIN_STEP, MAX_LENGTH)
    shortest = _checked_length("shortest", shortest, max(2 * MIN_STEP, length / MAX_WAVES), length)
    rolloff = length if rolloff is None else _checked_length("rolloff", rolloff, shortest, length)
    if (rms_height is None) == (rms_slope is None):
        raise ValueError("one of rms_height and rms_slope must be given, got both or neither")
    phases = random_phases(seed)
    k = np.arange(1, math.floor(length / shortest * DECIMAL_ROUNDING) + 1)
    amplitude = np.maximum(k, length / rolloff) ** (-0.5 - H)
    size = float(np.linalg.norm(amplitude))
    slope_of_height = 2 * np.pi / length * float(np.linalg.norm(k * amplitude)) / size
    if rms_height is None:
        slope = checked_number("rms_slope", rms_slope, "be positive and finite", lambda slope: 0 < slope < math.inf)
        height = slope / slope_of_height
    else:
        condition = "be positive and finite"
        height = checked_number("rms_height", rms_height, condition, lambda z: 0 < z < math.inf, units.METRE)
        slope = height * slope_of_height
    if not MIN_SLOPE <= slope <= MAX_SLOPE:
        raise ValueError(
            f"the root mean square slope must be from {MIN_SLOPE:g} to {MAX_SLOPE:g}, got {slope:.3g} for a height "
            f"of {height:.3g} m: is a unit wrong? Lengths and heights are in m"
        )
    coefficient = math.sqrt(2) * height / size * amplitude * np.exp(1j * phases.first(k.size))
    return Trace.from_waves(
        k,
        coefficient,
        lambda_0=length,
        samples=2 * (k.size + 1),
        shortest=shortest,
        ends=PERIODIC,
        detrend=MEAN,
        source=f"H = {H:g}, {f'roll-off {rolloff:g} m, ' if rolloff < length else ''}seed {phases.seed}",
        digest=digest_of(repr([length, shortest]).encode() + coefficient.tobytes()),
        period=1,
        hurst=H,
        rolloff=rolloff,
    )


def _checked_length(name: str, value: float, least: float, most: float) -> float:
    return checked_number(
        name,
        value,
        f"lie between {least:g} and {most:g} m",
        lambda x: least <= x * DECIMAL_ROUNDING and x <= most * DECIMAL_ROUNDING,
        units.METRE,
    )
