"""What users call: curves over the loads, and solutions under single loads, each from its own start."""

from __future__ import annotations

from contextlib import suppress
from itertools import chain, zip_longest
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from weier.kernels.arrays import Array, Indices
from weier.kernels.blas import one_thread
from weier.methods.error_model import COMPLIANCE_ROUNDING
from weier.methods.errors import ConvergenceError
from weier.methods.patches import error_model, many_contacts, newton
from weier.methods.patches.fields import pressures_or_gaps
from weier.methods.patches.inequalities import check_violation, gap_uncertainty
from weier.methods.patches.segments import ContactState, contacts_of, degrees, end_sums
from weier.methods.patches.start import Starts
from weier.methods.patches.surface import (
    TWIN_HEIGHT,
    CosineSeries,
    Surface,
    evaluate_at,
    nearest_crests,
)
from weier.methods.progress import count_load
from weier.methods.segment import RESISTANCE
from weier.theory.loads import checked_loads
from weier.theory.waves import Waves

TOLERANCE = 1e-10
CRACK_FACTOR = 2.0  # of what a crack adds to the resistance: its width is known from an interval of tension, roughly
MIN_LOAD = 1e-300  # in p_0*: squares of half-widths underflow below it
EPS = float(np.finfo(float).eps)


class Curve(NamedTuple):
    """Exact curves over the loads, each of shape (loads,).

    compliance : h, in g_0, from the profile whose waves all peak together
    compliance_error : a bound on its error, in g_0, by the conditions that the solution violates where it is sampled
    indentation : the same from first contact, in g_0, with full relative accuracy at light loads
    resistance : dh/dp, in g_0/p_0*
    resistance_error : an estimate of its error, in the same units
    contact_fraction : length in contact per length
    patch_count : contacts in one period; 0 in full contact
    residual : largest violation of a contact condition, evaluated without the equations solved, in g_0
    work : Newton steps
    contact_edge : left and right edge of each contact in turn, shape (loads, edges), in lambda_0; padded with NaN
    """

    compliance: Array
    compliance_error: Array
    indentation: Array
    resistance: Array
    resistance_error: Array
    contact_fraction: Array
    patch_count: Indices
    residual: Array
    work: Indices
    contact_edge: Array


class Solution(NamedTuple):
    """Contacts [centre - half_width, centre + half_width] in one period, in lambda_0, from left to right.

    mean_pressure : p, in p_0*
    centre, half_width : shape (patches,); both empty in full contact
    edge_strength : shape (patches, 2), at the left and right edges, in p_0*/lambda_0^(1/2): at the distance s
        from an edge p = A s^(1/2) within and gap = (4 pi/3) A s^(3/2) outside, with no singularity of stress
    mean_gap : d, in g_0
    surface, state : the series and the Chebyshev coefficients behind; state is None in full contact
    """

    mean_pressure: float
    centre: Array
    half_width: Array
    edge_strength: Array
    mean_gap: float
    surface: Surface
    state: ContactState | None

    @property
    def edges(self) -> Array:
        """Left and right edges, shape (patches, 2), in lambda_0; a right edge may lie beyond the period."""
        return np.stack([self.centre - self.half_width, self.centre + self.half_width], axis=1)

    def pressure(self, x: ArrayLike) -> Array:
        """Pressure p(x), in p_0*, for x in lambda_0 of any shape; 0 outside the contacts."""
        if self.state is None:
            return self.mean_pressure - _series_at(self.surface.tensions, x)
        return self._on_points(self.state, x, of_gaps=False)

    def gap(self, x: ArrayLike) -> Array:
        """Gap between the rigid plane and the surface, in g_0, for x in lambda_0 of any shape; 0 on the contacts."""
        if self.state is None:
            return np.zeros(np.shape(x))
        return self._on_points(self.state, x, of_gaps=True)

    def _on_points(self, state: ContactState, x: ArrayLike, of_gaps: bool) -> Array:
        value = pressures_or_gaps(state, self.surface.series(state.dual), np.ravel(np.asarray(x, float)), of_gaps)
        return np.maximum(value, 0.0).reshape(np.shape(x))

    def displacement(self, x: ArrayLike) -> Array:
        """Elastic displacement u(x) away from the rigid plane, in g_0, of mean 0: gap = d - z + u."""
        return self.gap(x) + _series_at(self.surface.heights, x) - self.mean_gap


def _series_at(series: CosineSeries, x: ArrayLike) -> Array:
    crest, y = nearest_crests(series, np.ravel(np.asarray(x, float)))
    return np.asarray(series.maximum + evaluate_at(series, crest, y, 0)).reshape(np.shape(x))


@one_thread
def curve(profile: Waves, mean_pressure: ArrayLike, tolerance: float = TOLERANCE) -> Curve:
    """Compliance and resistance of a truncated series by contact patches.

    Chebyshev collocation of the singular integral equation on every contact, whose edges are unknowns, or on every
    gap where that takes fewer nodes. The error falls exponentially with the nodes.

    Parameters
    ----------
    profile : Profile
        With a finite number of terms.
    mean_pressure : array_like, shape (loads,)
        Increasing, positive, in p_0*.
    tolerance : float
        Relative size of the last Newton step and of the last Chebyshev coefficients.

    Returns
    -------
    Curve
        Arrays over the loads.

    Raises
    ------
    ValueError
        If the loads are not increasing from 1e-300 or above, the tolerance is not within reach, or the waves are
        too many.
    ConvergenceError
        If a load cannot be solved, or its solution fails a check.

    """
    loads, starts = check_loads(mean_pressure), Starts(profile, tolerance)
    points, edges, none = [], [], np.empty(0)
    for load in map(float, loads):
        state, steps = solve_state(starts, load)
        points.append((*_curve_point(starts.surface, state, tolerance), steps))
        left, half_width, _ = _sorted_contacts(state, float(profile.period)) if state is not None else 3 * [none]
        edges.append(np.stack([left, left + 2 * half_width], axis=1).ravel())
        count_load()
    padded = np.array([*zip_longest(*edges, fillvalue=np.nan)]).reshape(-1, loads.size).T
    return Curve._make([*map(np.array, zip(*points, strict=True)), padded])


def _curve_point(
    surface: Surface, state: ContactState | None, tolerance: float
) -> tuple[float, float, float, float, float, float, int, float]:
    """Compliance and its error, indentation, resistance and its error, contact fraction, contacts, and residual."""
    total, series = surface.total_amplitude, surface.heights
    rounding, top = COMPLIANCE_ROUNDING * total, series.maximum
    if state is None:
        return total, rounding, top, 0.0, 0.0, 1.0, 0, 0.0
    half_width = state.extent[2]
    share = float(2 * half_width.sum() / series.period)
    base, fraction = (top, 1 - share) if state.dual else (0.0, share)
    of_h, indentation, R = state.error + rounding, base + state.approach, state.resistance
    of_R = error_model.error(tolerance, RESISTANCE) * max(R, 1.0) + _error_by_light_contacts(state, series, total)
    of_R += CRACK_FACTOR * _rise_by_cracks(state, series.period) + _drop_by_births(state, series)
    count = half_width.size
    return total - top + indentation, of_h, indentation, R, of_R, fraction, count, state.residual


def _rise_by_cracks(state: ContactState, period: float) -> float:
    """What cracks add to the resistance, in g_0/p_0*, whose edges are not solved for.

    One of half-width b adds pi^2 b^2 q^2/L. To the pressure there, a new load adds q = L f/(pi r sqrt(1-t^2)), where
    f is the contact's share in it.
    """
    if state.cracks.size == 0:
        return 0.0
    of, t, b, _ = state.cracks.T
    return float(period * np.sum((state.share[of.astype(np.int64)] * b) ** 2 / (1 - t**2)))


def _drop_by_births(state: ContactState, series: CosineSeries) -> float:
    """By how much contacts may lower the resistance, in g_0/p_0*, that may be born in narrow gaps.

    A gap g that may be off by e leaves a contact that penetrates by e - g at most. Where the plane cuts the crest at
    the half-width b, the contact sinks in by c = -2 ln(pi b/L) or more for each unit of force, less what the nearest
    other contact gives way. The plane nears the crest by t = R - u' for each unit of mean pressure, where the
    displacement u' of the crest is nowhere below -2 L ln 2. So the contact takes the force t/c of it, which lowers
    the resistance by t^2/(c L).
    """
    gaps, period = state.narrow_gaps, series.period
    if gaps.size == 0:
        return 0.0
    depth = gap_uncertainty(state.error, series) - gaps["value"]
    half_width = np.sqrt(2 * depth / np.maximum(gaps["curvature"], depth / period**2))
    compliance = -2 * np.log(np.minimum(np.pi * half_width / period, np.exp(-0.5)))
    origin, centre, r = contacts_of(state.segments.extent, state.dual, period)
    distance = np.abs(np.sin(np.pi / period * (gaps["position"][:, None] - (origin + centre))))
    relief = -2 * np.log(np.pi * r / period) + 4 * np.log(2 * distance)
    compliance += np.minimum(relief.min(axis=1), 0.0)
    closing = state.resistance + 2 * np.log(2.0) * period
    return min(float(np.sum(closing**2 / (np.maximum(compliance, 1.0) * period))), state.resistance)


def _error_by_light_contacts(state: ContactState, series: CosineSeries, total_amplitude: float) -> float:
    """How far the resistance may be off, in g_0/p_0*, by contacts so light that heights say little of them.

    The half-width a = 2 (F/kappa)^(1/2) follows from the force F and the curvature kappa. Heights that are off by e
    here and by -e elsewhere change F by 2 e/c, with c = -2 ln(pi a/L), and where they are off by e at the edges, not
    between them, kappa changes by 2 e/a^2. For each e-fold of a, the resistance falls by 2 L f^2, where f is the
    share of a new load that the contact takes. Where gaps are solved for, f is at most (R/L + 2 ln 2)/c, since a
    force lowers the surface nowhere by more than 2 ln 2 times itself. Crests other than the highest and its twins are
    known to a unit in the last place of the amplitudes, and curvatures to one in that of the waves' curvatures. The
    force follows from the pressure at the edges of the contact, as if that were Hertz's.
    """
    period, (origin, centre, r) = series.period, contacts_of(state.extent, state.dual, series.period)
    force = np.pi / np.sqrt(8) * r**1.5 * np.maximum(_edge_strengths(state).mean(axis=1), 1e-300)
    crest, _ = nearest_crests(series, origin + centre)
    lower = series.crest_offset[crest] < -TWIN_HEIGHT * total_amplitude
    of_height = state.error + EPS * total_amplitude * lower
    c = np.maximum(-2 * np.log(np.pi * r / period), 1.0)
    share = (state.resistance / period + 2 * np.log(2.0)) / c if state.dual else state.share[state.pieces[0]]
    rounding = EPS * float(np.abs(series.amplitude) @ series.wavenumber**2)
    of_width = (2 / c + 0.5) * of_height / force + rounding * r**2 / (4 * force)
    # A width that may be off by an e-fold may be none. Without the contact the resistance is higher by L f^2 c, where
    # the share f of a contact that has hardly begun is known to few digits, for which twice as much is taken.
    return float(period * np.sum(share**2 * np.where(of_width < 1, of_width, 2 * c)))


def solve_load(profile: Waves, mean_pressure: float, tolerance: float = TOLERANCE) -> Solution:
    """The contacts under one mean pressure, and with them the pressure and the gap anywhere.

    The parameters, and what is raised, are those of `curve`, with one load.
    """
    return solve_loads(profile, [mean_pressure], tolerance)[0]


@one_thread
def solve_loads(profile: Waves, mean_pressure: ArrayLike, tolerance: float = TOLERANCE) -> list[Solution]:
    """The contacts under each of several loads, with the parameters of `curve`."""
    loads, starts = check_loads(mean_pressure), Starts(profile, tolerance)
    return [make_solution(starts.surface, solve_state(starts, float(load))[0], load) for load in loads]


def solve_state(starts: Starts, load: float) -> tuple[ContactState | None, int]:
    """The state under one load, None in full contact, and the steps to it; it depends on no other load."""
    if load >= starts.surface.full_contact_load:
        return None, 0
    failure, guesses = ConvergenceError(f"nothing is known to start from under the mean pressure {load:.6g} p_0*"), []
    rest = starts.guesses(load)
    for guess in rest:
        guesses.append(guess)
        if guess.segments.centre.size >= many_contacts.MIN_CONTACTS:
            break
        with suppress(ConvergenceError):
            return newton.solve_few_contacts(starts.surface, guess, starts.tolerance)
    for guess in chain(guesses, rest):
        try:
            return _correct_contacts(starts.surface, guess, starts.tolerance)
        except ConvergenceError as error:
            failure = error
    raise failure


def _correct_contacts(surface: Surface, guess: ContactState, tolerance: float) -> tuple[ContactState, int]:
    """The state from one guess whose set of contacts may be wrong, or large, and the steps to it.

    The set is corrected tightly, whatever the tolerance, since next to its birth a contact changes dh/dp far more
    than h. A residual that is small beside the load does not tell how wide a contact is. The steps of a dense matrix
    do, which are relative to each segment, and so they end what are few.
    """
    state, steps = many_contacts.solve_many_contacts(surface, guess)
    if state.segments.centre.size < many_contacts.MIN_CONTACTS:
        # Next to a birth, few nodes do not tell whether a contact has any force, and rounding may keep both from it.
        for again in (newton.on_few_nodes(state, surface.series(state.dual)), state):
            with suppress(ConvergenceError):
                state, more = newton.solve_few_contacts(surface, again, min(tolerance, many_contacts.TOLERANCES[0]))
                return state, steps + more
    check_violation(state, surface.heights.period, tolerance)
    return state, steps


def make_solution(surface: Surface, state: ContactState | None, mean_pressure: float) -> Solution:
    """The contacts of a state, whether its segments are contacts or gaps; None stands for full contact."""
    if state is None:
        none = np.empty(0)
        return Solution(mean_pressure, none, none, np.empty((0, 2)), 0.0, surface, None)
    left, half_width, order = _sorted_contacts(state, surface.heights.period)
    mean_gap = (0.0 if state.dual else surface.heights.maximum) - state.approach
    strength = _edge_strengths(state)[order]
    return Solution(mean_pressure, left + half_width, half_width, strength, mean_gap, surface, state)


def _sorted_contacts(state: ContactState, period: float) -> tuple[Array, Array, Indices]:
    """Left edges in [0, L) and half-widths from left to right, and the order that sorted them."""
    origin, centre, half_width = contacts_of(state.extent, state.dual, period)
    left = origin + (centre - half_width)
    left -= period * np.floor(left / period)
    order = np.argsort(left)
    return left[order], half_width[order], order


def _edge_strengths(state: ContactState) -> Array:
    """Of the left and right edges of each contact, shape (contacts, 2), from U_k(1) = k + 1 and U_k(-1)."""
    first_node, scale = state.segments.first_node, np.sqrt(2 / state.segments.half_width)[:, None]
    of, before_crack = state.pieces
    strength = (scale * end_sums(first_node, state.coefficient * (degrees(first_node) + 1)))[of]
    strength[before_crack, 1] = strength[before_crack + 1, 0] = state.cracks[:, 3]
    if state.dual:  # contact j lies between gap j and the next
        strength = np.stack([-strength[:, 1], np.roll(strength[:, 0], -1)], axis=1) / (2 * np.pi)
    return strength


def check_loads(mean_pressure: ArrayLike) -> Array:
    """The loads as an array; ValueError if they do not increase from `MIN_LOAD` or above."""
    loads = checked_loads(mean_pressure)
    if loads[0] < MIN_LOAD:
        raise ValueError(f"mean_pressure must be at least {MIN_LOAD:g} p_0* for contact patches, got {loads[0]:g}")
    return loads
