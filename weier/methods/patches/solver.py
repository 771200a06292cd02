"""Interface of contact patches: the method, curves over the loads and solutions under single loads.

docs/patches.md: "Where a load starts" for starts and attempts, "Edges" for the strengths, "The bound on the
compliance" for the stated error.
"""

from __future__ import annotations

from itertools import zip_longest
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from weier.kernels.arrays import Array, Indices
from weier.kernels.blas import one_thread
from weier.methods.curve import Curve
from weier.methods.error_model import COMPLIANCE_ROUNDING
from weier.methods.errors import MARGIN, ConvergenceError
from weier.methods.load_progress import count_load, keeping
from weier.methods.method import CURVE_SECONDS, TOLERANCES, Method, Setting, Style, applies_to_resolvable
from weier.methods.patches.certificate import stated_errors
from weier.methods.patches.contacts import CONTACTS
from weier.methods.patches.given_edges import (
    make_punches,
    moved_expansion,
    solve_forces_on_contacts,
    transfer_forces,
)
from weier.methods.patches.kind import MAX_TOLERANCE
from weier.methods.patches.pair_sums import MAX_DIRECT, potential
from weier.methods.patches.pressure_and_gap import values_at
from weier.methods.patches.segments import ContactState, contact_extent, contact_pieces, make_segments
from weier.methods.patches.stages import MAX_OVER_TARGET, MIN_TOLERANCE, TARGET, solve_in_stages
from weier.methods.patches.start import TOLERANCE, Starts
from weier.methods.patches.surface import (
    CosineSeries,
    Extent,
    Surface,
    evaluate_near,
    nearest_crests,
)
from weier.methods.patches.thin_gaps import densities_on_contacts
from weier.surface.loads import checked_loads
from weier.surface.waves import Waves

MIN_LOAD = 1e-300  # p_0*; squares of half-widths underflow under lighter loads


class Solution(NamedTuple):
    """Contacts [centre - half_width, centre + half_width] in one period, in lambda_0, from left to right.

    mean_pressure : p, in p_0*
    centre, half_width : shape (patches,); both empty in full contact
    edge_strength : shape (patches, 2), at the left and right edges, in p_0*/lambda_0^(1/2): at the distance s
        from an edge p = A s^(1/2) within and gap = (4 pi/3) A s^(3/2) outside, with no singularity of stress
    mean_gap : d, in g_0
    surface, state : the series and the Chebyshev coefficients; `state` is None in full contact
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
        """Return pressure p(x), in p_0*, for x in lambda_0 of any shape; 0 outside the contacts."""
        if self.state is None:
            return self.mean_pressure - _series_at(self.surface.tensions, x)
        return self._on_points(self.state, x, False)

    def gap(self, x: ArrayLike) -> Array:
        """Return the gap, in g_0, at x in lambda_0 of any shape; 0 on the contacts."""
        if self.state is None:
            return np.zeros(np.shape(x))
        return self._on_points(self.state, x, True)

    def _on_points(self, state: ContactState, x: ArrayLike, is_gap: bool) -> Array:
        series = state.kind.series(self.surface)
        value = values_at(state, series, *nearest_crests(series, np.ravel(np.asarray(x, float))), is_gap)
        return np.maximum(value, 0.0).reshape(np.shape(x))

    def displacement(self, x: ArrayLike) -> Array:
        """Return elastic displacement u(x) away from the rigid plane, in g_0, of mean 0: gap = d - z + u."""
        return self.gap(x) + _series_at(self.surface.heights, x) - self.mean_gap


def _series_at(series: CosineSeries, x: ArrayLike) -> Array:
    flat = np.ravel(np.asarray(x, float))
    value = evaluate_near(series.local, series.crest_position, series.period, flat)
    return np.asarray(series.maximum + value).reshape(np.shape(x))


@one_thread
def curve(profile: Waves, mean_pressure: ArrayLike, tolerance: float = TOLERANCE) -> Curve:
    """Return compliance and resistance of a truncated series by contact patches.

    Chebyshev collocation of the singular integral equation on every contact, with unknown edges, or on every gap if
    that needs fewer nodes. The error decays exponentially with the number of nodes.

    Parameters
    ----------
    profile : Profile
        With a finite number of terms.
    mean_pressure : array_like, shape (loads,)
        Increasing, positive, in p_0*.
    tolerance : float
        Accepted error of the compliance, in g_0. It is applied relative to the indentation, and limited to
        `MAX_TOLERANCE` of it, so that the compliance is usually far more accurate than required and the
        resistance is accurate at light loads.

    Returns
    -------
    Curve
        With an a-posteriori bound on the error of the compliance, from sampled violations of the contact conditions,
        and an estimate of the error of the resistance; the residual, evaluated without the equations solved; the
        Newton steps as `work`; and the indentation, accurate relative to itself at light loads.

    Raises
    ------
    ValueError
        If the loads are not increasing from `MIN_LOAD` or above, the tolerance is not in `TOLERANCES`, or the
        waves are too many.
    ConvergenceError
        If a load cannot be solved, its solution fails a check, or the bound on its error exceeds the tolerance.

    """
    loads, starts = check_loads(mean_pressure), Starts(profile, tolerance)
    points, extents = list[dict[str, Any]](), list[Extent]()
    period, again = float(profile.period), 0

    def solved() -> Curve:
        origin, centre, half_width = (
            np.array([*zip_longest(*part, fillvalue=np.nan)]).reshape(-1, len(points)).T
            for part in zip(*extents, strict=True)
        )
        edges, _, _ = _sorted_contacts(origin, centre, half_width, period)
        values: dict[str, Any] = {name: np.array([point[name] for point in points]) for name in points[0]}
        return Curve(**values, contact_edge=edges.reshape(len(points), -1), second_attempts=again)

    with keeping(lambda _: (loads[: len(points)], solved()) if points else None):
        for load in map(float, loads):
            state, steps = solve_state(starts, load)
            contacts = 3 * (np.empty(0),) if state is None else contact_extent(state, period)
            point = _curve_point(starts.surface, state, contacts[2])
            extents.append(contacts)
            points.append(point | {"work": steps})
            again += state is not None and state.attempts > 1
            count_load()
    return solved()


def _curve_point(surface: Surface, state: ContactState | None, half_width: Array) -> dict[str, Any]:
    """Return the quantities of a curve under one load, by name; the state None is full contact."""
    total, top, series = surface.total_amplitude, surface.heights.maximum, surface.heights
    full = state is None
    indentation = top if state is None else state.indentation(top)
    R_error, fraction_error = (0.0, 0.0) if state is None else stated_errors(state, series)
    return {
        "compliance": total if full else total - top + indentation,
        "resistance": 0.0 if state is None else state.resistance,
        "compliance_error": _rounding(surface) + (0.0 if state is None else state.error),
        "resistance_error": R_error,
        "indentation": indentation,
        "contact_fraction": 1.0 if full else float(2 * half_width.sum() / series.period),
        "contact_fraction_error": fraction_error,
        "elastic_energy": surface.full_contact_energy if state is None else state.kind.elastic_energy(state, surface),
        "patch_count": half_width.size,
        "residual": 0.0 if state is None else state.residual,
    }


def _rounding(surface: Surface) -> float:
    """Return the contribution of rounding to the error of the compliance, in g_0."""
    return COMPLIANCE_ROUNDING * surface.total_amplitude


def solve_load(profile: Waves, mean_pressure: float, tolerance: float = TOLERANCE) -> Solution:
    """Return the contacts under one mean pressure, which evaluate pressure and gap at any position.

    Parameters and exceptions are as for `curve`, with one load.
    """
    return solve_loads(profile, [mean_pressure], tolerance)[0]


@one_thread
def solve_loads(profile: Waves, mean_pressure: ArrayLike, tolerance: float = TOLERANCE) -> list[Solution]:
    """Return the contacts under each of several loads, with the parameters of `curve`."""
    loads, starts = check_loads(mean_pressure), Starts(profile, tolerance)
    return [make_solution(starts.surface, solve_state(starts, float(load))[0], load) for load in loads]


def solve_state(starts: Starts, load: float) -> tuple[ContactState | None, int]:
    """Return the state under one load, None in full contact, and the steps to it; it depends on no other load.

    The second attempt is tighter. If rounding limits the target of the first one, the second one is looser instead:
    its target is the first tolerance, and its bound may still meet the tolerance.
    ConvergenceError is raised if two attempts fail, or if the bound on the error exceeds the tolerance of the starts.
    """
    if load >= starts.surface.full_contact_load:
        return None, 0
    failure, best, steps = ConvergenceError(""), np.inf, 0
    first = min(max(starts.tolerance, MIN_TOLERANCE), MAX_TOLERANCE)
    second = max(first / MAX_OVER_TARGET, MIN_TOLERANCE) if first > MIN_TOLERANCE else first / TARGET
    guess = starts.guess(load)
    for relative in (first, second):
        try:
            state, more = solve_in_stages(starts.surface, guess, relative, max(first, relative))
        except ConvergenceError as error:
            failure = error
        else:
            steps += more
            if (known := state.error + _rounding(starts.surface)) <= starts.tolerance:
                return state, steps
            best = min(best, known)
        guess = guess._replace(attempts=2)
    if best < np.inf:
        cause = " because of rounding" if second > first else ""
        failure = ConvergenceError(
            f"the compliance under the mean pressure {load:.6g} p_0* is known to {best:.1e} g_0{cause}, not to the "
            f"tolerance of {starts.tolerance:g}: take {MARGIN * best:.1e} or more",
            best,
        )
    raise failure


def make_solution(surface: Surface, state: ContactState | None, mean_pressure: float) -> Solution:
    """Return the contacts of a state, from segments of either kind; None is full contact."""
    if state is None:
        none = np.empty(0)
        return Solution(mean_pressure, none, none, np.empty((0, 2)), 0.0, surface, None)
    extent, strength, _ = contact_pieces(state, surface.heights.period)
    edges, half_width, order = _sorted_contacts(*extent, surface.heights.period)
    mean_gap = state.kind.uniform(surface.heights.maximum) - state.approach
    return Solution(mean_pressure, edges[:, 0] + half_width, half_width, strength[order], mean_gap, surface, state)


def _sorted_contacts(
    origin: Array, centre: Array, half_width: Array, period: float
) -> tuple[NDArray[np.float64], Array, Indices]:
    """Return sorted edges of contacts (left ones in [0, L)), half-widths, and the order, along the last axis."""
    left = origin + (centre - half_width)
    left -= period * np.floor(left / period)
    order = left.argsort(axis=-1)
    left, half_width = (np.take_along_axis(values, order, -1) for values in (left, half_width))
    return np.stack([left, left + 2 * half_width], axis=-1), half_width, order


def check_loads(mean_pressure: ArrayLike) -> Array:
    """Return the loads as an array; ValueError if they do not increase from `MIN_LOAD` or above."""
    loads = checked_loads(mean_pressure)
    if loads[0] < MIN_LOAD:
        raise ValueError(f"mean_pressure must be at least {MIN_LOAD:g} p_0* for contact patches, got {loads[0]:g}")
    return loads


def run_kernels() -> None:
    """Run on one segment the sums over many that curves of few waves do not take."""
    first, middle, half_width, b = np.zeros(1, np.int64), np.zeros(1), np.full(1, 0.1), np.ones(8)
    segments = make_segments(first, middle, middle, half_width, np.full(1, b.size))
    punches = make_punches(segments, 1.0, CONTACTS, most=0)
    solve_forces_on_contacts(punches, b, 1.0, 0.0, 1.0)
    moved_expansion(segments.first_node, half_width, b, b, half_width, half_width)
    transfer_forces(segments, b, first, punches)
    densities_on_contacts(segments.first_node, b, first, np.zeros((1, 1)), False)
    many = np.linspace(0.0, 0.5, MAX_DIRECT + 1)
    potential(0 * many, many, many, 0 * many, many, 1.0, False)


METHOD = Method(
    name="patches",
    label="contact patches",
    summary="contact edges as unknowns, ten digits; finite m",
    solve=curve,
    returns=(
        "compliance_error",
        "resistance_error",
        "indentation",
        "contact_fraction",
        "contact_fraction_error",
        "elastic_energy",
        "patch_count",
        "residual",
        "work",
        "contact_edge",
        "second_attempts",
    ),
    settings={
        "tolerance": Setting(
            TOLERANCE,
            f"accepted error of the compliance, in g_0, in {TOLERANCES}; the stated bound is within it",
            TOLERANCES,
        ),
    },
    takes_traces=True,
    least_load=MIN_LOAD,
    applies=applies_to_resolvable,
    numerical=True,
    style=Style("#000000", (), "d"),
    run_kernels=run_kernels,
    seconds=lambda profile, loads, **settings: (
        CURVE_SECONDS + 1.5e-3 + loads.size * (3e-4 + 8e-5 * profile.waves_per_period[-1])
    ),
)
