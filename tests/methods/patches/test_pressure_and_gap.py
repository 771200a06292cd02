"""Pressure and gap at any points, far from segments and near them."""

import numpy as np
import pytest
from scipy.integrate import quad

from tests.methods.patches.westergaard_states import KINDS
from tests.profiles import THREE_WAVES
from weier import Profile
from weier.accuracy.cosines import Cosines
from weier.methods import patches
from weier.methods.patches import pressure_and_gap
from weier.methods.patches.kind import FIELD_ROUNDING
from weier.methods.patches.segments import ContactState, make_segments
from weier.methods.patches.surface import evaluate_series, from_crests, make_series, nearest_crests


def states_of_two_segments(period, dual):
    """Two segments with densities of their own, the second wider than half a period."""
    counts, half_width = np.array([6, 9]), np.array([0.05, 0.3]) * period
    crest, origin, centre = from_crests(SERIES[period], np.array([0.1, 0.6]) * period)
    coefficient = np.random.default_rng(int(period)).normal(size=15) + 0.5
    if dual:
        coefficient[[0, 6]] = 0.0  # the gaps close
    segments = make_segments(crest, origin, centre, half_width, counts)
    return ContactState(KINDS[dual], 0.7, 0.3, segments, coefficient)


SERIES = {period: make_series(np.array([1.0, 0.2]), [1, 3], np.array([0.3, 1.0]), period) for period in (1.0, 9.0)}


def density(state, j, x):
    """rho of segment j at positions x within it."""
    first, segments = state.segments.first_node, state.segments
    t = (x - segments.middle[j]) / segments.half_width[j]
    angle = np.arccos(np.clip(t, -1, 1))
    return sum(a * np.sin((k + 1) * angle) for k, a in enumerate(state.coefficient[first[j] : first[j + 1]]))


def integrate(state, period, x, kernel):
    """The integral of rho(s) kernel(x - s) over both segments, by adaptive quadrature, with the principal value."""
    total = 0.0
    for j in range(2):
        c, r = state.segments.middle[j], state.segments.half_width[j]
        at = x - period * np.rint((x - c) / period)
        if kernel == "cot":

            def times_distance(s, j=j, at=at):
                u = np.pi * (at - s) / period
                return density(state, j, s) * (-period / np.pi if abs(u) < 1e-9 else (s - at) / np.tan(u))

            if abs(at - c) < r:
                total += quad(times_distance, c - r, c + r, weight="cauchy", wvar=at, limit=400)[0]
            else:
                total += quad(lambda s, f=times_distance, at=at: f(s) / (s - at), c - r, c + r, limit=400)[0]
        else:
            inside = [at] if abs(at - c) < r else None
            total += quad(
                lambda s, j=j, at=at: density(state, j, s) * np.log(abs(2 * np.sin(np.pi * (at - s) / period))),
                c - r,
                c + r,
                points=inside,
                limit=400,
            )[0]
    return total


def test_residuals_are_gaps_and_pressures_of_the_definition(period, dual):
    """d - z - 2 int p ln|2 sin| ds or, dual, p_full + int w' cot ds/(2 pi L).

    On both segments, beside them, at their images and far away.
    """
    state, series = states_of_two_segments(period, dual), SERIES[period]
    x = period * np.array([0.02, 0.08, 0.1, 0.149, 0.1501, 0.2, 0.29, 0.5, 0.88, 0.901, 0.97, 1.045, -0.35, 2.61])
    height = 1.0 * np.cos(2 * np.pi * x / period + 0.3) + 0.2 * np.cos(6 * np.pi * x / period + 1.0)
    if dual:
        along = np.array([integrate(state, period, at, "cot") for at in x])
        expected = 0.7 - height + along / (2 * np.pi * period)
    else:
        along = np.array([integrate(state, period, at, "ln") for at in x])
        expected = -0.3 + series.maximum - height - 2 * along
    found = pressure_and_gap.complementary_residuals(state, series, *nearest_crests(series, x))
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-6 * period)


def test_one_wave_has_the_gap_and_the_pressure_of_westergaard(wave, dual):
    """From 1e-6 of a width beside an edge on."""
    state, series = wave.state(dual), wave.series(dual)
    a, half = wave.half_width, 0.5 * wave.period
    inside = a * np.array([-1 + 1e-6, -0.7, 0.0, 0.4, 1 - 1e-6])
    outside = half + (half - a) * np.array([-1 + 1e-6, -0.9, -0.3, 0.0, 0.6, 1 - 1e-6])
    x = wave.crest + np.concatenate([inside, outside])
    pressure = np.concatenate([wave.pressure(inside), np.zeros(6)])
    gap = np.concatenate([np.zeros(5), wave.gap(outside)])
    of_pressure = pressure_and_gap.values_at(state, series, *nearest_crests(series, x), False)
    np.testing.assert_allclose(of_pressure, pressure, rtol=0, atol=1e-10 / min(a, half - a))
    found = pressure_and_gap.values_at(state, series, *nearest_crests(series, x), True)
    np.testing.assert_allclose(found, gap, rtol=0, atol=1e-11 * wave.period)


@pytest.mark.parametrize("load", [1e-20, 1e-32])
def test_gap_beside_a_tiny_contact_has_all_digits(load):
    """Hertz's gap, kappa a^2/2 (t (t^2-1)^(1/2) - ln(t + (t^2-1)^(1/2))), near and far from the contact's nodes."""
    solution = patches.solve_load(Profile(1.25, 2, 2, (1.0, 2.0)), load)
    state, series = solution.state, solution.surface.heights
    segments, crest = state.segments, state.segments.crest[0]
    assert segments.centre.size == 1
    assert abs(series.crest_position[crest]) > 0.01  # at x = 0 no digit can be lost
    curvature = -evaluate_series(series.local, crest, 0.0)[2]
    for t in pressure_and_gap.far_field_from(state.coefficient.size) * np.array([0.5, 0.95, 1.05, 2.0, 5.0]):
        root = np.sqrt(t * t - 1)
        expected = 0.5 * curvature * segments.half_width[0] ** 2 * (t * root - np.log(t + root))
        y = segments.centre[0] + segments.half_width[0] * t
        gap = pressure_and_gap.complementary_residuals(state, series, np.array([crest]), np.array([y]))
        assert gap == pytest.approx(expected, rel=1e-9, abs=0)


@pytest.mark.parametrize("part", [0.1, 0.9])
def test_many_waves_have_the_fields_of_one(part):
    """By sums over trees, far from the segments and as near as 1e-9 of their width to an edge."""
    fields = []
    for waves in (1, 99):
        surface = Cosines(np.ones(1), [waves])
        solution = patches.solve_load(surface, part * surface.full_contact_load)
        assert solution.centre.size == waves
        a = solution.half_width[0] * waves
        apart = np.concatenate([a * (1 + 2 * np.array([0.0, 1e-9, 1e-3, 0.1])), np.linspace(0, 0.5, 30)])
        x = (np.arange(waves)[:, None] + np.concatenate([-apart, apart])) / waves
        fields.append((solution.pressure(x) / waves, solution.gap(x)))
    (pressure, gap), (pressures, gaps) = fields
    np.testing.assert_allclose(gaps, np.tile(gap, (99, 1)), rtol=0, atol=1e-12)
    at_edges = 3e-6 * pressure.max()  # the root of a rounded position
    np.testing.assert_allclose(pressures, np.tile(pressure, (99, 1)), rtol=0, atol=at_edges)
    inside = pressure > 0.1 * pressure.max()
    assert np.abs(pressures - pressure)[:, inside[0]].max() <= 1e-11 * pressure.max()


@pytest.mark.parametrize(
    "profile", [THREE_WAVES, Profile(1.17, 4, 3, (0.5, 2.0, 4.0)), Profile(1.38, 2, 4, (1.0, 3.0, 5.0, 0.2))]
)
@pytest.mark.parametrize("part", [0.01, 0.3, 0.8])
def test_fields_of_a_shifted_profile_differ_by_rounding(profile, part):
    """Gaps, and pressures away from the edges, at which a position that is rounded moves them by more."""
    shift, x = 0.3718, np.random.default_rng(1).random(300)
    phases = profile.phase + 2 * np.pi * shift * np.array(profile.waves_per_period)
    moved = Profile(profile.D, profile.gamma, profile.m, tuple(phases.tolist()))
    load = part * profile.full_contact_load
    here, there = (patches.solve_load(one, load, 1e-12) for one in (profile, moved))
    assert np.abs(there.gap(x) - here.gap(x + shift)).max() <= FIELD_ROUNDING * profile.total_amplitude
    pressure, other = here.pressure(x + shift), there.pressure(x)
    inside = pressure > 0.5 * pressure.max()
    assert inside.any()
    assert np.abs(pressure - other)[inside].max() <= FIELD_ROUNDING * pressure.max()
