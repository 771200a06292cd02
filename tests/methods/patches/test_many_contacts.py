"""Many contacts without a dense matrix: against the reference values, the dense matrix and bad starts."""

from types import SimpleNamespace

import numpy as np
import pytest

from tests.profiles import THREE_WAVES
from tests.reference import REFERENCES
from weier import ConvergenceError, Profile
from weier.kernels.blas import one_thread
from weier.methods import bem, patches
from weier.methods.patches import fields, inequalities, many_contacts
from weier.methods.patches.given_edges import make_punches
from weier.methods.patches.inequalities import (
    SAMPLED_FACTOR,
    NegativeIntervals,
    _sample_points,
    check_violation,
    contact_residual,
)
from weier.methods.patches.many_contacts import solve_many_contacts
from weier.methods.patches.start import Starts, contacts_guess
from weier.methods.patches.surface import surface_of

FOUR_WAVES = Profile(1.25, 5, 4, (0.0, 1.0, 2.0, 3.0))


def solve_from_grid(profile, load):
    surface = surface_of(profile)
    guess = list(Starts(profile, surface, 1e-10).guesses(load))[-1]
    return solve_many_contacts(surface, guess, load, 1e-10)


def edges_of(state):
    segments = state.segments
    centre = segments.origin + segments.centre
    return centre - segments.half_width, centre + segments.half_width


@one_thread
@pytest.mark.parametrize("reference", REFERENCES, ids=str)
def test_reference_values(reference):
    surface = surface_of(reference.profile)
    for row in np.flatnonzero(reference.patches > 2):
        state, steps = solve_from_grid(reference.profile, reference.mean_pressure[row])
        bare = surface.heights.maximum if not state.dual else 0.0
        compliance = reference.profile.total_amplitude - bare + state.approach
        assert compliance == pytest.approx(reference.compliance[row], abs=1e-10)  # the digits of the reference values
        assert state.sensitivity[-1] == pytest.approx(reference.resistance[row], rel=1e-9)
        assert state.segments.centre.size == reference.patches[row]
        width = 2 * state.segments.half_width.sum() / surface.heights.period
        fraction = 1 - width if state.dual else width
        assert fraction == pytest.approx(reference.contact_fraction[row], abs=2e-10)
        assert state.residual < 1e-11
        assert steps < 10


@one_thread
def test_many_gaps_near_full_contact():
    profile = Profile(1.25, 5, 6, np.arange(6.0))
    curve = patches.curve(profile, [12.0])
    assert curve.patch_count[0] == 581  # as boundary elements on 16 nodes a wave have it
    assert curve.residual[0] < 1e-11
    beside = patches.curve(profile, [12.0 - 1e-4, 12.0 + 1e-4]).compliance
    # A central difference: its error is that of the compliance, 1e-15, over the step, and the step's square.
    assert curve.resistance[0] == pytest.approx((beside[1] - beside[0]) / 2e-4, rel=1e-4)


@one_thread
def test_both_solvers_agree(monkeypatch):
    loads = np.append([0.3, 2.0, 4.0], np.array([0.6, 0.9, 0.99]) * FOUR_WAVES.full_contact_load)
    fast = patches.curve(FOUR_WAVES, loads)
    assert np.any(fast.patch_count > many_contacts.MIN_CONTACTS)
    monkeypatch.setattr(many_contacts, "MIN_CONTACTS", np.inf)
    dense = patches.curve(FOUR_WAVES, loads)
    monkeypatch.setattr(many_contacts, "MIN_CONTACTS", 2)
    all_fast = patches.curve(FOUR_WAVES, loads)
    for curve in (fast, all_fast):
        np.testing.assert_allclose(curve.compliance, dense.compliance, rtol=0, atol=1e-12)
        np.testing.assert_allclose(curve.resistance, dense.resistance, rtol=1e-8)  # what its own refinement moves
        np.testing.assert_allclose(curve.contact_edge, dense.contact_edge, atol=1e-9)
        np.testing.assert_array_equal(curve.patch_count, dense.patch_count)


def test_cuts_that_overlap_are_one():
    """The new gap in the wider interval of tension reaches beyond the narrower one, on its right."""
    punches = make_punches(np.array([0.5]), np.array([0.1]), np.array([8]), 1.0)
    step = SimpleNamespace(punches=punches)
    negative = NegativeIntervals(np.array([0, 0]), np.array([-0.5, 0.35]), np.array([0.3, 0.36]), None, None)
    widening = 0.5 * (np.sqrt(2) - 1) * 0.8
    expected = [(0.4, 0.5 + 0.1 * (-0.5 - widening)), (0.5 + 0.1 * (0.3 + widening), 0.6)]
    np.testing.assert_allclose(many_contacts._cut_segments(step, negative), expected)


@one_thread
def test_small_contacts_that_divide_a_gap_are_found_at_once():
    """Of 1000 gaps some are divided by contacts narrower than the overlap that gives them away."""
    curve = patches.curve(Profile(1.25, 5, 6, 1.0), 10.0)
    assert curve.patch_count == 999
    assert curve.work < 15


@one_thread
def test_more_contacts_than_a_dense_matrix_holds():
    profile = Profile(1.25, 5, 6, np.arange(6.0))
    curve = patches.curve(profile, [2.0])
    assert curve.patch_count[0] == 1165  # the same from the edges of boundary elements, and from any start below
    assert curve.residual[0] < 1e-11
    finer = patches.curve(profile, [2.0], tolerance=1e-12)
    assert finer.compliance[0] == pytest.approx(curve.compliance[0], abs=1e-12)
    elements = bem.curve(profile, [2.0], points=16 * 5**5, tolerance=1e-8, resistance=False)
    # 3.3 g_0/(points a wave)^2 for each of the waves in turn; the finest has the amplitude 2e-3.
    assert curve.compliance[0] == pytest.approx(elements.compliance[0], abs=1e-4)


@one_thread
@pytest.mark.parametrize("fault", ["missing", "spurious", "merged", "cut", "shifted"])
def test_bad_starts_lead_to_the_same_contacts(fault):
    surface, load = surface_of(THREE_WAVES), 0.5
    state, _ = solve_from_grid(THREE_WAVES, load)
    left, right = edges_of(state)
    if fault == "missing":
        left, right = left[::2], right[::2]
    elif fault == "spurious":
        middle = 0.5 * (right[:-1] + left[1:])
        left, right = np.append(left, middle - 1e-3), np.append(right, middle + 1e-3)
    elif fault == "merged":
        left, right = np.delete(left, [1, 2]), np.delete(right, [0, 1])
    elif fault == "cut":
        middle, width = 0.5 * (left + right), right - left
        left, right = np.append(left, middle + 0.05 * width), np.append(middle - 0.05 * width, right)
    else:
        gap = np.append(left[1:], left[0] + 1) - right
        left, right = left + 0.3 * gap, right + 0.3 * gap
    force = np.full(left.size, load / left.size)
    guess = contacts_guess(surface, 0.5 * (left + right), 0.5 * (right - left), force, 1e-10)
    again, _ = solve_many_contacts(surface, guess, load, 1e-10)
    assert again.approach == pytest.approx(state.approach, abs=1e-12)
    np.testing.assert_allclose(np.sort(edges_of(again)[0] % 1), np.sort(edges_of(state)[0] % 1), atol=1e-9)


@one_thread
@pytest.mark.parametrize("load", [0.3, 5.6])
def test_contacts_without_the_last_wave_are_a_start(load):
    """Most contacts are missing, and edges beside them do not settle before the set is corrected; then gaps (5.6)."""
    profile, fewer = Profile(1.25, 5, 5, 1.0), Profile(1.25, 5, 4, 1.0)
    surface = surface_of(profile)
    coarse = patches.solve_load(fewer, min(load, 5.0))
    force = np.full(coarse.centre.size, load / coarse.centre.size)
    guess = contacts_guess(surface, coarse.centre, coarse.half_width, force, 1e-10)
    state, steps = solve_many_contacts(surface, guess, load, 1e-10)
    expected = patches.solve_load(profile, load).state
    assert steps < 30
    assert state.segments.centre.size == expected.segments.centre.size > 3 * coarse.centre.size
    assert state.approach == pytest.approx(expected.approach, abs=1e-12)
    assert state.sensitivity[-1] == pytest.approx(expected.sensitivity[-1], rel=1e-9)


def test_contacts_that_do_not_sink_in_or_carry_another_load_are_refused():
    state = patches.solve_load(THREE_WAVES, 0.5).state
    check_violation(state, 1.0, 1e-10)
    for wrong in (
        state._replace(approach=-1.0),
        state._replace(load=0.5 * (1 + 1e-7)),
        state._replace(residual=1e-7),
    ):
        with pytest.raises(ConvergenceError, match="violate their conditions"):
            check_violation(wrong, 1.0, 1e-10)


@one_thread
def test_fast_sums_that_are_off_are_noticed(monkeypatch):
    """Closed forms at some of the points tell."""
    state = patches.solve_load(FOUR_WAVES, 1.5).state
    assert state.segments.centre.size > fields.MIN_SUM_SEGMENTS
    monkeypatch.setattr(inequalities, "residuals_by_sums", lambda state, series, crest, *others: np.zeros(crest.size))
    wrong = state._replace(approach=state.approach + 1e-7)
    assert contact_residual(wrong, surface_of(FOUR_WAVES).series(state.dual)).max() > 1e-8


@one_thread
@pytest.mark.parametrize(
    ("profile", "load"),
    [(Profile(1.25, 5, 4, 1.0), 3.25094), (Profile(1.25, 5, 4, 1.0), 1.5), (Profile(1.95, "7/2", 4, np.pi), 35.5)],
)
def test_fast_sums_tell_the_residual_beside_nodes(profile, load):
    """Some segments are far narrower than they are away from the crest from which positions are counted."""
    state = patches.solve_load(profile, load).state
    series, segments = surface_of(profile).series(state.dual), state.segments
    assert segments.centre.size > fields.MIN_SUM_SEGMENTS
    first, crest, y = _sample_points(segments, True)
    count = np.diff(np.append(first, y.size))
    middle, centre = np.repeat(segments.origin + segments.centre, count), np.repeat(segments.centre, count)
    fast = fields.residuals_by_sums(state, series, crest, y, middle, y - centre)
    height = 2 * np.repeat(segments.half_width, count) if state.dual else 1.0
    # Rounding of 1/sin^2 at a quarter of the distance of two nodes, some hundred times that of the rest.
    np.testing.assert_allclose(height * (fast - fields.residuals_one_by_one(state, series, crest, y)), 0, atol=1e-12)


@pytest.mark.parametrize("above", [1e-9, 1e-10])
def test_a_contact_that_was_just_born_among_many_is_found_at_any_tolerance(above):
    profile = Profile(1.25, 5, 4, 1.0)
    events = patches.events(profile, 1.5, 1.6)
    born = int(np.argmax(events.birth))
    load, count = events.mean_pressure[born] * (1 + above), events.patch_count[born]
    exact, *others = (patches.curve(profile, load, tolerance) for tolerance in (1e-12, 1e-10, 1e-8, 1e-6))
    assert exact.patch_count == count > many_contacts.MIN_CONTACTS
    for found in others:
        assert found.patch_count == count
        assert found.resistance == pytest.approx(exact.resistance, rel=1e-9)


@one_thread
def test_events_are_the_same_without_the_matrix(monkeypatch):
    low, high = 0.25, 0.6
    dense = patches.events(THREE_WAVES, low, high)
    assert dense.mean_pressure.size > 2
    assert set(dense.birth) == {False, True}
    monkeypatch.setattr(many_contacts, "MIN_CONTACTS", 1)
    fast = patches.events(THREE_WAVES, low, high)
    np.testing.assert_allclose(fast.mean_pressure, dense.mean_pressure, rtol=1e-9)  # a residual of 1e-12 g_0
    np.testing.assert_array_equal(fast.birth, dense.birth)
    np.testing.assert_allclose(fast.x, dense.x, atol=1e-6)  # the square root of that of the load, at a minimum


@one_thread
def test_pressure_and_gap_among_a_thousand_contacts():
    profile = Profile(1.25, 5, 6, np.arange(6.0))
    solution = patches.solve_load(profile, 2.0)
    assert solution.centre.size > 1000
    x = np.random.default_rng(0).uniform(0, 1, 300)
    pressure, gap = solution.pressure(x), solution.gap(x)
    # Contact is where the edges say, and there is no overlap or tension.
    inside = np.any(np.abs((x[:, None] - solution.centre + 0.5) % 1 - 0.5) < solution.half_width, axis=1)
    np.testing.assert_array_equal(pressure > 0, inside)
    np.testing.assert_array_equal(gap > 0, ~inside)
    widest = int(np.argmax(solution.half_width))
    near = 1e-4 * solution.half_width[widest]
    edge = solution.centre[widest] + solution.half_width[widest]
    # The law of the edge, with one in 1e-4 of the half-width to the next term.
    assert solution.pressure(edge - near) == pytest.approx(solution.edge_strength[widest, 1] * near**0.5, rel=1e-2)


@one_thread
@pytest.mark.parametrize(
    ("profile", "load"),
    [
        # A period of 81 or 64 lambda_0, where positions are rounded to 1e-14: heights at them once were noise.
        (Profile(1.8410904, "4/3", 5, (1.64271594, 0.4850585, 5.94681989, 3.85656693, 0.01652951)), 0.12429421),
        pytest.param(Profile(1.25, "5/2", 7, 0.0), 0.3, marks=pytest.mark.slow),
    ],
)
def test_long_periods(profile, load):
    curve = patches.curve(profile, load)
    assert curve.patch_count[0] > many_contacts.MIN_CONTACTS
    assert curve.residual[0] < 1e-10
    assert curve.work[0] < 10


def test_wide_contacts_with_many_nodes_pass_their_check():
    """Gaps near the load that flattens nearly all waves: a residual at far denser points would be rounding alone."""
    profile = Profile(1.0000000029334561, 5, 5, (-0.00011336687525986246, 0.0, -6.8e-10, 0.00017572009909963402, 0.0))
    curve = patches.curve(profile, 1.436227280176725)
    assert curve.residual[0] < 1e-10
    assert curve.compliance_error[0] < 1e-6


@pytest.mark.parametrize("apart", [False, True])
def test_a_polynomial_is_nowhere_larger_than_its_samples_allow(apart):
    random, everywhere = np.random.default_rng(0), np.cos(np.linspace(0, np.pi, 4000))
    state = patches.solve_load(THREE_WAVES, 0.5).state
    nodes, (first, _, y) = np.diff(state.segments.first_node), _sample_points(state.segments, apart)
    for j, where in enumerate(np.split(y, first[1:])):
        at = (where - state.segments.centre[j]) / state.segments.half_width[j]
        for _ in range(100):
            wave = np.polynomial.Chebyshev(
                random.normal(size=nodes[j] + 3) * random.integers(0, 2, nodes[j] + 3) + 1e-9
            )
            assert np.abs(wave(everywhere)).max() <= SAMPLED_FACTOR * np.abs(wave(at)).max()
