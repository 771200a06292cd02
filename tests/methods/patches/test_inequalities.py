"""What violates the inequalities is found: where it is, how deep, and how wide a new segment becomes."""

from types import SimpleNamespace

import numpy as np
import pytest

from tests.methods.patches.westergaard_states import KINDS, OneWave
from weier.kernels.blas import one_thread
from weier.methods.chebyshev import gauss_rule
from weier.methods.patches import inequalities
from weier.methods.patches.contacts import CONTACTS
from weier.methods.patches.edge_iteration import ContactProblem, make_guess, take_step
from weier.methods.patches.gaps import GAPS
from weier.methods.patches.given_edges import force_field
from weier.methods.patches.inequalities import find_missing, find_negative_intervals, gap_minima, minima_outside
from weier.methods.patches.pressure_and_gap import complementary_residuals
from weier.methods.patches.segments import MINIMUM, ContactState, edge_strengths, make_segments
from weier.methods.patches.surface import evaluate_at, make_series, nearest_crests


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
    below = minima_outside(state, series, 0.05)
    crest = crest[(crest > 0.05 * period) & (crest < 0.95 * period)]
    wave, third = np.cos(2 * np.pi * crest / period), np.cos(6 * np.pi * crest / period)
    value = 0.02 + series.maximum - wave + 0.3 * third
    expected = value < 0.05
    assert 0 < np.count_nonzero(expected) < 3
    np.testing.assert_allclose(np.sort(below["position"]), np.sort(crest[expected]), atol=1e-6 * period)
    np.testing.assert_allclose(below["value"], value[expected], atol=1e-7)
    curvature = (2 * np.pi / period) ** 2 * (wave - 2.7 * third)
    np.testing.assert_allclose(below["curvature"], curvature[expected], rtol=1e-3)


def test_the_residual_beside_an_edge_has_the_strength_of_the_density(wave, dual):
    """At 1e-4 of the narrower width from the edge, up to terms of this order."""
    state, series = wave.state(dual), wave.series(dual)
    kind, segments = state.kind, state.segments
    s = 1e-4 * min(wave.half_width, 0.5 * wave.period - wave.half_width)
    value = complementary_residuals(state, series, *nearest_crests(series, segments.right + s))
    k_1 = abs(edge_strengths(segments.first_node, segments.half_width, state.coefficient, 1.0)[0, 1])
    expected = kind.residual_strength * k_1 * s**kind.residual_power
    assert value[0] == pytest.approx(expected, rel=1e-3, abs=0)


def test_gaps_are_probed_at_crests_midway_between_them_and_closely_at_their_ends():
    """Two contacts on [0.1, 0.3] and [0.4, 0.8] of a period with crests at 0.2, 0.5 and 0.95 beside others."""
    crest = np.array([0.02, 0.2, 0.35, 0.5, 0.95])
    one = np.zeros(2), np.array([0.2, 0.6]), np.array([0.1, 0.2])
    x, interval = inequalities._probe_points(*one, crest, 1.0, 2 * np.pi * 8)
    assert np.all(np.diff(x) > 0)
    assert np.all(np.where(interval == 0, (x > 0.3) & (x < 0.4), (x > 0.8) & (x < 1.1)))
    for expected in (0.35, 0.875 - 0.15, 0.95, 1.02, 0.985):
        inside = 0.3 < expected < 0.4 or 0.8 < expected < 1.1
        assert np.any(np.abs(x - expected) < 1e-12) == inside
    assert np.diff(x[interval == 1]).max() < 1 / 40  # five probes to the finest of eight waves, at least
    for end, (first, last) in enumerate(((0.3, 0.4), (0.8, 1.1))):
        own = x[interval == end]
        assert max(own[0] - first, last - own[-1]) < 0.3 * np.diff(own).max()


@pytest.mark.parametrize("probe", np.linspace(-2.3, 2.3, 12))
def test_a_minimum_is_found_from_probes_beyond_an_inflection(probe):
    """The lowest of three probes of a cosine may lie where it is concave."""
    bracket = np.array([-2.8]), np.array([probe]), np.array([3.2]), np.zeros(1, np.int64)
    found = inequalities._negative_minima(bracket, lambda x: 0.5 - np.cos(x), lambda x, interval: np.ones(x.size))
    assert found["position"].tolist() == pytest.approx([0.0], abs=1e-4)
    assert found["value"][0] == pytest.approx(-0.5, abs=1e-8)
    assert found["curvature"][0] == pytest.approx(1.0, rel=1e-3)


@pytest.mark.parametrize("distance", [0.003, 0.006, 0.012, 0.03, 0.1])
@pytest.mark.parametrize("at_right", [False, True])
@pytest.mark.parametrize("is_gap", [False, True])
def test_a_narrow_minimum_next_to_an_edge_is_found(is_gap, at_right, distance, period):
    """Next to an edge it may be much narrower than the distance of probes: w = s^power [(s/e - 1)^2 - 0.01]."""
    series = make_series(np.array([1.0]), [1], np.zeros(1), period)
    crest, half_width = series.crest_position, 0.2 * period
    segments = make_segments(np.zeros(1, np.int64), crest, np.zeros(1), np.array([half_width]), np.array([12]))
    place = distance * period

    def residual(x):
        s = (crest[0] + period - half_width) - x if at_right else x - (crest[0] + half_width)
        return np.abs(s) ** (1.5 if is_gap else 0.5) * ((s / place - 1) ** 2 - 0.01)

    # Its edges have the strength of 0.99 s^power, the quotient there.
    kind, coefficient = CONTACTS if is_gap else GAPS, np.zeros(12)
    at_edge = 0.99 * (3 / (4 * np.pi) if is_gap else 1) / (kind.strength_factor * np.sqrt(2 / half_width))
    coefficient[:2] = np.array([0.5, -0.25 if at_right else 0.25]) * at_edge
    found = inequalities._minima_between(kind, segments, coefficient, True, series, residual, 0.0, 0.0)
    assert found.size == 1
    s = found["position"][0] - (crest[0] + half_width)
    s = 0.6 * period - s if at_right else s
    assert s == pytest.approx(place, rel=0.02)
    assert found["value"][0] == pytest.approx(-0.01 * place ** (1.5 if is_gap else 0.5), rel=0.05)


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

    edges, minima = find_missing(problem, step, 0.0, 0.0, 0.0)
    assert len(edges) == np.count_nonzero(minima["value"] < 0) > 0
    deepest = minima["value"].min()
    below_margin = find_missing(problem, step, 0.0, -0.1 * deepest, 0.0)[1]
    assert below_margin["value"].min() == pytest.approx(deepest, rel=1e-6)
    room = inequalities._room(step, minima)
    for (left, right), minimum, most in zip(edges, minima, room, strict=True):
        x = minimum["position"] + 1e-3 * period * np.arange(-1, 2)
        below, here, above = residual(x)
        curvature = (below + above - 2 * here) / (1e-3 * period) ** 2
        assert here < min(below, above)
        reach = np.sqrt(-2 * here / curvature) * (np.sqrt(2) if dual else 0.5)
        assert 0.5 * (right - left) == pytest.approx(min(reach, 0.5 * most), rel=1e-3, abs=0)
    if dual:  # A crack of half-width b in the tension q_0 opens by 2 pi b q_0.
        opening = 2 * np.pi * np.sqrt(-4 * minima["value"] / minima["curvature"]) * -minima["value"]
        for factor, expected in ((1.01, 0), (0.99, 1)):
            assert len(find_missing(problem, step, 0.0, 0.0, factor * opening.max())[0]) == expected


def test_two_new_segments_share_the_room_between_them():
    """Contacts on [0, 1] and from 5 on, and new ones at 2, 2.6 and, behind the second contact, 7."""
    segments = SimpleNamespace(right=np.array([1.0, 6.0]))
    step = SimpleNamespace(punches=SimpleNamespace(segments=segments, gap=np.array([4.0, 4.0])))
    minima = np.zeros(3, MINIMUM)
    minima["position"], minima["interval"] = [2.0, 2.6, 7.0], [0, 0, 1]
    np.testing.assert_allclose(inequalities._room(step, minima), [0.3, 0.3, 1.0])
