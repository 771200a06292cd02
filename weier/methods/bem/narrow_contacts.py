"""One contact, or one gap, in the continuum: where it ends under heights, or pressures, that are a polynomial.

Kernels of docs/subgrid.md. Positions s are in half widths of the window of nodes on which the polynomial was fitted.
"""

from __future__ import annotations

import numpy as np

from weier.kernels.arrays import Array
from weier.kernels.jit import kernel
from weier.methods.bem.local_fit import MEANS, derivative, expansion, shift, slopes
from weier.methods.chebyshev import second_kind
from weier.theory.halfplane import displacement_of_punch

MAX_STEPS = 40  # of Newton's; 4 to 6 are usual
CLOSE = 1e-13  # relative size of the last of them
HERTZ = 1e-6  # half width of a contact below which a parabola is exact, and Newton's last step too long
MAX_STRIDE = 0.5  # of the half width that one step may take


@kernel
def contact_edges(height: Array, force: float, centre: float, half_width: float) -> tuple[float, float, bool]:
    """Centre and half width of the contact that carries a force, and whether they were found.

    The pressure is bounded at both ends where the mean of z' over the Chebyshev nodes t is 0, and the force is
    -(half width/2) times the mean of t z'. The two arguments are where the search begins.
    """
    centre, half_width, found = _balance(derivative(height), force, centre, half_width)
    if found and half_width < HERTZ:
        curvature = -slopes(height, centre)[1]
        half_width = 2 * np.sqrt(force / curvature) if force > 0 and curvature > 0 else 0.0
    return centre, half_width, found and half_width > 0


@kernel
def gap_edges(pressure: Array, centre: float, half_width: float) -> tuple[float, float, bool]:
    """Centre and half width of a gap, and whether they were found.

    The pressure that would close the gap, times 1 and t, has no mean over the Chebyshev nodes t; nor would z'
    under a contact without force.
    """
    centre, half_width, found = _balance(pressure, 0.0, centre, half_width)
    return centre, half_width, found and half_width > 0


@kernel
def _balance(polynomial: Array, force: float, centre: float, half_width: float) -> tuple[float, float, bool]:
    """Where a polynomial has no mean, and t times it one of -2 force/half width, by Newton's method; if it ended."""
    here = polynomial.copy()
    shift(here, centre)
    for _ in range(MAX_STEPS):
        mean, mean_t, bend, bend_t, bend_tt = means(here, half_width)
        excess = -half_width / 2 * mean_t - force
        down = -half_width / 2 * bend_t
        across = -half_width / 2 * bend_tt - (mean_t / 2 if force > 0 else 0.0)  # the factor matters beside a force
        along, wider = _step(mean, excess, bend, bend_t, down, across, half_width)
        centre, half_width = centre + along, half_width + wider
        shift(here, along)
        if abs(along) + abs(wider) <= CLOSE * (1 + half_width):
            return centre, half_width, True
    return centre, half_width, False


@kernel
def means(polynomial: Array, half_width: float) -> tuple[float, float, float, float, float]:
    """Means over the Chebyshev nodes t of a polynomial and t times it, and of its slope, t times and t^2 times it.

    The polynomial is one of the distance from the middle of the interval.
    """
    mean = mean_t = bend = bend_t = bend_tt = 0.0
    before, power = 0.0, 1.0  # of the half width
    for k in range(polynomial.size):
        here, slope = polynomial[k] * power, k * polynomial[k] * before
        mean += here * MEANS[k]
        mean_t += here * MEANS[k + 1]
        if k > 0:
            bend += slope * MEANS[k - 1]
            bend_t += slope * MEANS[k]
            bend_tt += slope * MEANS[k + 1]
        before, power = power, power * half_width
    return mean, mean_t, bend, bend_t, bend_tt


@kernel
def _step(
    first: float, second: float, a: float, b: float, c: float, d: float, half_width: float
) -> tuple[float, float]:
    """Newton's step of centre and half width for two equations with the matrix a b, c d; NaN where it is singular."""
    determinant = a * d - b * c
    if determinant == 0:
        return np.nan, np.nan
    along = -(first * d - second * b) / determinant
    wider = -(a * second - c * first) / determinant
    along = min(max(along, -1.0), 1.0)
    wider = min(max(wider, -MAX_STRIDE * half_width), max(MAX_STRIDE * half_width, MAX_STRIDE))
    return along, wider


@kernel
def contact_energies(height: Array, rate: Array, force: float, share: float) -> tuple[float, float]:
    """Energies of a contact, with this force and share, in the rates of others: of its pressure and of its rate.

    Both polynomials come as coefficients of T_k. The rate of the pressure follows the rates of others.
    """
    mixed, cross = force * rate[0], share * rate[0]
    for k in range(1, rate.size):
        mixed += k * height[k] * rate[k] / 4
        cross -= k * rate[k] * rate[k] / 4
    return mixed, cross


@kernel
def move_edges(height: Array, tilt: float, tilt_t: float, centre: float, half_width: float) -> tuple[float, float]:
    """How centre and half width follow a slope with the means `tilt`, and `tilt_t` of t times it, under one force."""
    slope = derivative(height)
    shift(slope, centre)
    _, mean_t, bend, bend_t, bend_tt = means(slope, half_width)
    down, across = -half_width / 2 * bend_t, -(half_width * bend_tt + mean_t) / 2
    return _step(tilt, -half_width / 2 * tilt_t, bend, bend_t, down, across, half_width)


@kernel
def gap_energy(pressure: Array, rate: Array, half_width: float) -> tuple[float, float]:
    """Energies of a gap: the integrals of it, and of its rate, times the rate of the pressure that closes it.

    Pressure and rate are coefficients of T_k; `half_width` is a length.
    """
    closing, rates = second_kind(pressure), second_kind(rate)
    mixed = alone = 0.0
    for k in range(closing.size):
        mixed -= (np.pi * half_width) ** 2 * closing[k] * rates[k] / (k + 1)
        alone -= (np.pi * half_width) ** 2 * rates[k] * rates[k] / (k + 1)
    return mixed, alone


@kernel
def highest(height: Array, reach: float) -> float:
    """Where the polynomial is highest near the middle, not farther than `reach`."""
    s = 0.0
    for _ in range(MAX_STEPS):
        first, second, _ = slopes(height, s)
        if second >= 0:
            break
        further = min(max(s - first / second, -reach), reach)
        if abs(further - s) <= CLOSE:
            break
        s = further
    return s


@kernel
def plane_height(
    height: Array, force: float, centre: float, half_width: float, scale: float, period: float
) -> tuple[float, float, float, float]:
    """Height of the plane that presses this force on the contact, its compliance, its edges; NaN if not found.

    `centre` and `half_width` are where the search begins, `scale` is the length of one s.
    """
    centre, half_width, found = contact_edges(height, force, centre, half_width)
    if not found:
        return np.nan, np.nan, centre, half_width
    compliance = displacement_of_punch(half_width * scale, period)
    return expansion(height, centre, half_width)[0] - force * compliance, compliance, centre, half_width
