"""What violates the inequalities is found: where it is, how deep, and how wide a new segment becomes."""

from types import SimpleNamespace

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from tests.methods.patches.westergaard_states import KINDS, OneWave
from weier import Profile
from weier.kernels.blas import one_thread
from weier.methods.chebyshev import gauss_rule
from weier.methods.errors import ConvergenceError
from weier.methods.patches import inequalities
from weier.methods.patches.edge_iteration import ContactProblem, make_guess, take_step
from weier.methods.patches.given_edges import force_field
from weier.methods.patches.inequalities import find_missing, find_negative_intervals, gap_minima, minima_between
from weier.methods.patches.pressure_and_gap import complementary_residuals
from weier.methods.patches.segments import MINIMUM, ContactState, make_segments
from weier.methods.patches.solver import solve_state
from weier.methods.patches.stages import contact_state, follow_contacts
from weier.methods.patches.start import Starts
from weier.methods.patches.surface import distances_between, evaluate_at, make_series, nearest_crests


def state_of(phi, period, r, dual=False, nodes=12):
    """One segment in the middle of the period with the density sqrt(1-t^2) phi(t)."""
    rule, none = gauss_rule(nodes, True), np.zeros(1)
    segments = make_segments(none.astype(int), none, np.array([0.5 * period]), np.array([r]), np.array([nodes]))
    return ContactState(KINDS[dual], 1.0, 0.1, segments, rule.expansion @ phi(rule.node))


@pytest.mark.parametrize("part", [0.02, 0.4])
def test_intervals_of_tension(period, part):
    """A parabola of phi, an interval that reaches the right end, and two parabolas."""
    r = part * period
    well = find_negative_intervals(state_of(lambda t: (t - 0.3) ** 2 - 0.01, period, r))
    assert well["segment"].tolist() == [0]
    assert [well["start"][0], well["end"][0]] == pytest.approx([0.2, 0.4], abs=1e-11)
    # Samples are 1/24 pi apart in the angle, so that the lowest is less deep than the minimum by a twentieth at most.
    assert well["value"][0] == pytest.approx(-0.01 * np.sqrt(1 - 0.09), rel=0.05)
    assert well["relative"][0] == pytest.approx(well["value"][0] / (1.3**2 - 0.01), rel=1e-9, abs=0)
    # A crack of half-width b under the tension sigma opens by 2 pi b sigma.
    assert well["height"][0] == pytest.approx(2 * np.pi * 0.1 * r * 0.01 * np.sqrt(1 - 0.09), rel=1e-9, abs=0)
    at_end = find_negative_intervals(state_of(lambda t: 0.8 - t, period, r))
    assert [at_end["start"][0], at_end["end"][0]] == pytest.approx([0.8, 1.0], abs=1e-11)
    both = find_negative_intervals(state_of(lambda t: ((t + 0.5) ** 2 - 0.01) * ((t - 0.5) ** 2 - 0.01), period, r))
    np.testing.assert_allclose(both["start"], [-0.6, 0.4], atol=1e-11)
    np.testing.assert_allclose(both["end"], [-0.4, 0.6], atol=1e-11)
    for middle in np.linspace(-0.7, 0.7, 57):  # wells that are narrower than the distance of samples, 25 on 12 nodes
        found = find_negative_intervals(state_of(lambda t, c=middle: (t - c) ** 2 - 1e-6, period, r))
        assert [found["start"][0], found["end"][0]] == pytest.approx([middle - 1e-3, middle + 1e-3], abs=1e-9)


@pytest.mark.parametrize("part", [0.02, 0.4])
def test_overlaps_in_gaps(period, part):
    """w = r (1-t^2)^(3/2) v(t), whose slope is sqrt(1-t^2) phi with phi = (1-t^2) v' - 3 t v."""
    r, depth = part * period, 0.01

    def slope(t):
        v = (t - 0.3) ** 2 - depth
        return (1 - t * t) * 2 * (t - 0.3) - 3 * t * v

    state = state_of(slope, period, r, True)
    found = find_negative_intervals(state)
    assert [found["start"][0], found["end"][0]] == pytest.approx([0.2, 0.4], abs=1e-11)
    overlap = r * (1 - 0.09) ** 1.5 * depth
    assert found["height"][0] == pytest.approx(overlap, rel=1e-9, abs=0)
    assert found["value"][0] == pytest.approx(-overlap, rel=0.05)


@pytest.mark.parametrize("place", [0.25, -0.25])
def test_each_gap_has_minima_of_its_own_and_none_at_its_ends(place):
    """Three gaps with one minimum each, at a quarter of the half-width to within a twentieth of it."""
    one = state_of(lambda t: (1 - t * t) * 2 * (t - place) - 3 * t * ((t - place) ** 2 + 1e-4), 1.0, 0.1, True)
    middle, r, none = np.array([0.2, 0.5, 0.8]), np.array([0.1, 0.05, 0.02]), np.zeros(3)
    segments = make_segments(none.astype(int), none, middle, r, np.full(3, 12))
    minima = gap_minima(one._replace(segments=segments, coefficient=np.tile(one.coefficient, 3)))
    assert minima["interval"].tolist() == [0, 1, 2]
    assert (minima["position"] - middle) / r == pytest.approx(place, abs=0.05)
    assert minima["value"] == pytest.approx(1e-4 * 0.9375**1.5 * r, rel=0.1)
    assert minima["curvature"] * r == pytest.approx(2 * 0.9375**1.5, rel=0.2)


def test_minima_of_the_gap_and_of_the_pressure(period, dual):
    """The crests of a series stand for those of the surface or of the tension, beside hardly any density."""
    series = make_series(np.array([1.0, 0.3]), [1, 3], np.array([0.0, np.pi]), period)
    narrow, crest = OneWave(period, 0.05 * period, 0.0).state(False), series.crest_position
    state = narrow._replace(
        kind=KINDS[dual],
        load=series.maximum + 0.02,
        approach=-0.02,
        segments=narrow.segments._replace(origin=crest[:1], centre=-crest[:1]),
        coefficient=1e-9 * narrow.coefficient,
    )
    below = minima_between(state, series, 0.0, 0.05)
    crest = crest[(crest > 0.05 * period) & (crest < 0.95 * period)]
    wave, third = np.cos(2 * np.pi * crest / period), np.cos(6 * np.pi * crest / period)
    value = 0.02 + series.maximum - wave + 0.3 * third
    expected = value < 0.05
    assert 0 < np.count_nonzero(expected) < 3
    np.testing.assert_allclose(np.sort(below["position"]), np.sort(crest[expected]), atol=1e-3 * period)
    assert np.all((below["value"] <= value[expected]) & (below["value"] > 0.9 * value[expected]))
    curvature = (2 * np.pi / period) ** 2 * (wave - 2.7 * third)
    np.testing.assert_allclose(below["curvature"], curvature[expected], rtol=0.1)


def samples_between(state, series):
    """The lowest residual in each interval between segments, of 100 samples per finest wave."""
    length = distances_between(*state.segments.extent, series.period)
    count = 60 + (length * series.wavenumber[-1] * 100 / (2 * np.pi)).astype(int)
    interval = np.repeat(np.arange(length.size), count)
    part = np.concatenate([(np.arange(n) + 0.5) / n for n in count])
    x = state.segments.right[interval] + part * length[interval]
    residual = complementary_residuals(state, series, *nearest_crests(series, x))
    return np.minimum.reduceat(residual, np.append(0, count.cumsum()[:-1]))


@one_thread
@pytest.mark.parametrize("seed", range(4))
def test_nothing_is_lower_than_the_bounds_and_these_are_nearly_attained(seed):
    """On solutions, and on those of the equations without one of the contacts or gaps, where others tell."""
    random, violated = np.random.default_rng(seed), 0
    for _ in range(12):
        terms, gamma = int(random.integers(1, 4)), [1.5, 2, 3, 5, "5/2"][random.integers(5)]
        starts = Starts(
            Profile(random.uniform(1.02, 1.95), gamma, terms, tuple(random.uniform(0, 6.28, terms))), 1e-10
        )
        exact, _ = solve_state(starts, starts.surface.full_contact_load * 10 ** random.uniform(-5, -0.01))
        series, tolerance = exact.kind.series(starts.surface), 1e-9 * min(exact.load, 1.0)
        states = [exact]
        for kept in 1 - np.eye(exact.segments.centre.size)[:3] if exact.segments.centre.size > 1 else []:
            crest, *extent, count = (part[kept > 0] for part in (*exact.segments[:4], exact.segments.node_count))
            a = exact.coefficient[np.repeat(kept > 0, exact.segments.node_count)]
            fewer = exact._replace(segments=make_segments(crest, *extent, count), coefficient=a)
            try:
                states.append(follow_contacts(starts.surface, fewer, exact.load))
            except ConvergenceError:
                continue
        for state in states:
            lowest, minima = samples_between(state, series), minima_between(state, series, tolerance, 0.0)
            at = complementary_residuals(state, series, *nearest_crests(series, minima["position"]))
            np.minimum.at(lowest, minima["interval"], at)
            bound = np.zeros(lowest.size)
            np.minimum.at(bound, minima["interval"], minima["value"])
            if np.all(find_negative_intervals(state)["relative"] > -1e-9):
                assert np.all(lowest >= bound - tolerance)
                clear = lowest < -20 * tolerance
                np.testing.assert_allclose(bound[clear], lowest[clear], rtol=0.12)
                violated += np.count_nonzero(clear)
    assert violated > 0


def test_the_gap_next_to_an_edge_is_certainly_positive(wave, dual):
    """Also where the surface is convex at the edge: no cell is left."""
    assert minima_between(wave.state(dual), wave.series(dual), 0.0, 0.0).size == 0


def points_of(x, u, S):
    """Points of one interval with the residual u - S, of polynomials."""
    points = np.zeros(x.size, inequalities.POINT)
    points["x"], points["residual"], points["series"] = x, u(x) - S(x), S(x)
    points["slope"], points["curvature"] = S.deriv()(x), S.deriv(2)(x)
    return points


@pytest.mark.parametrize("is_slope", [False, True])
@pytest.mark.parametrize("node", [0, 1])
def test_the_fourth_derivative_bounds_a_cell_without_curvature_at_its_ends(is_slope, node):
    """A beam under its weight M sags by 5/384 M w^4 between its ends; the largest moment everywhere has M w^4/64."""
    w, M, series = 0.25, 64 / 0.25**4, make_series(np.ones(1), [1], np.zeros(1), 1.0)
    S = Polynomial([0, w**3, 0, -2 * w, 1]) * (M / 24)
    points, fourth = points_of(np.array([0.0, w]), Polynomial([0.5]), S), np.eye(4)[node] * M
    bound = inequalities._lower_bound(points, 0, M, is_slope)
    assert bound == pytest.approx(-0.5)
    assert bound <= 0.5 - S(0.5 * w)
    line = series.period, series.crest_position, series.local
    assert series.step == w  # the cell from node 0 to node 1
    assert inequalities._divide(points, *line, fourth, is_slope, 0.0, 0.0)[2]["value"] == pytest.approx([-0.5])


def test_tangents_of_the_field_bound_it():
    """u'' is linear, its tangents are known by narrow cells, and S is its chord."""
    x, u = np.array([-0.01, 0.0, 1.0, 1.01]), Polynomial([0.1, 1.0]) ** 3 / 6
    S = Polynomial([u(0.0), u(1.0) - u(0.0)])
    lowest = np.min((u - S)(np.linspace(0, 1, 1001)))
    assert 2 * lowest < inequalities._lower_bound(points_of(x, u, S), 1, 0.0, False) <= lowest


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_convex_gap_is_lowest_at_an_end_if_it_does_not_fall_there(mirrored):
    """u = (3/2 - x)^4, whose second derivative decreases, or its image; S has one curvature, or a bump of it."""
    x, u = np.linspace(0, 1, 11), Polynomial([1.5, -1.0]) ** 4

    def bound_and_lowest(cell, fall, curvature, fourth=0.0):
        start, bump = x[cell], fourth / 24 * Polynomial([0, 0, 0, 0.2, -1])
        S = Polynomial([u(start) - 1, u.deriv()(start) + fall, curvature / 2]) + bump
        field, S = (
            u(Polynomial([1, -1])) if mirrored else u,
            S(Polynomial([1 - start, -1] if mirrored else [-start, 1])),
        )
        points, cell = points_of(x, field, S), 9 - cell if mirrored else cell
        lowest = np.min((field - S)(np.linspace(x[cell], x[cell + 1], 1001)))
        return inequalities._lower_bound(points, cell, fourth, False), lowest

    bound, lowest = bound_and_lowest(4, -0.4, 9.5)
    assert bound == pytest.approx(lowest) == pytest.approx(1)
    for case in (
        (4, 0.1, 9.5),
        (0, 0.0, 20.0, 12e3),
    ):  # the gap falls at the end; its curvature is known at both ends
        bound, lowest = bound_and_lowest(*case)
        assert bound <= lowest < 1
    field = u(Polynomial([1, -1])) if mirrored else u
    points, curvature, side = points_of(x, field, Polynomial([0.0])), field.deriv(2)(x), -1 if mirrored else 1
    assert inequalities._least_curvature(points, 5, -side) == 0
    assert curvature[5 + 2 * side] < inequalities._least_curvature(points, 5, side) < curvature[5]


@one_thread
def test_a_missing_segment_gets_the_width_of_its_parabola(period, dual):
    """A lower crest beside one contact, or a lower crest of the tension beside one gap, that was left out."""
    series = make_series(np.array([0.2, 1.0]), [1, 3], np.array([0.5, 0.0]), period)
    load = 0.6 * series.maximum if dual else 0.1 / period
    half_width = np.array([0.05 * period])
    segments = make_segments(
        np.array([np.argmax(series.crest_offset)]),
        series.crest_position[series.crest_offset == 0],
        np.zeros(1),
        half_width,
        np.array([20]),
    )
    problem = ContactProblem(series, load, KINDS[dual])
    step = take_step(problem, make_guess(problem, segments, 1e-10), 1e-14)

    def residual(x):
        total = force_field(step.punches, step.forces.force, x)
        return (
            (0.0 if dual else step.forces.plane)
            + total
            - problem.highest
            - evaluate_at(series.local, *nearest_crests(series, x), 0)
        )

    state = contact_state(problem, step)
    edges, minima = find_missing(problem, step, state, 0.0, 0.0, 0.0)
    assert len(edges) == np.count_nonzero(minima["value"] < 0) > 0
    deepest = minima["value"].min()
    below_margin = find_missing(problem, step, state, 0.0, -0.1 * deepest, 0.0)[1]
    assert below_margin["value"].min() == pytest.approx(deepest, rel=1e-6)
    room = inequalities._room(step, minima)
    for (left, right), minimum, most in zip(edges, minima, room, strict=True):
        x = minimum["position"] + 1e-3 * period * np.arange(-1, 2)
        below, here, above = residual(x)
        curvature = (below + above - 2 * here) / (1e-3 * period) ** 2
        assert here < min(below, above)
        reach = np.sqrt(-2 * here / curvature) * (np.sqrt(2) if dual else 0.5)
        assert 0.5 * (right - left) == pytest.approx(min(reach, 0.5 * most), rel=0.1, abs=0)
    if dual:  # A crack of half-width b in the tension q_0 opens by 2 pi b q_0.
        opening = 2 * np.pi * np.sqrt(-4 * minima["value"] / minima["curvature"]) * -minima["value"]
        for factor, expected in ((1.01, 0), (0.99, 1)):
            assert len(find_missing(problem, step, state, 0.0, 0.0, factor * opening.max())[0]) == expected


def test_two_new_segments_share_the_room_between_them():
    """Contacts on [0, 1] and from 5 on, and new ones at 2, 2.6 and, behind the second contact, 7."""
    segments = SimpleNamespace(right=np.array([1.0, 6.0]))
    step = SimpleNamespace(punches=SimpleNamespace(segments=segments, gap=np.array([4.0, 4.0])))
    minima = np.zeros(3, MINIMUM)
    minima["position"], minima["interval"] = [2.0, 2.6, 7.0], [0, 0, 1]
    np.testing.assert_allclose(inequalities._room(step, minima), [0.3, 0.3, 1.0])
