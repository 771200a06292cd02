"""The stages of a load: hundreds of contacts, bad starts, and states that are refused."""

import numpy as np
import pytest

from tests.hard_series import hard_series
from tests.methods.patches.westergaard_states import KINDS
from tests.profiles import THREE_WAVES
from weier import ConvergenceError, Profile
from weier.kernels.blas import one_thread
from weier.methods import patches
from weier.methods.patches import pair_sums, stages
from weier.methods.patches.certificate import check_violation, contact_residual
from weier.methods.patches.contacts import CONTACTS
from weier.methods.patches.edge_iteration import ContactProblem, carried_along, make_guess, take_step
from weier.methods.patches.gaps import GAPS
from weier.methods.patches.given_edges import solve_tangent
from weier.methods.patches.inequalities import NEGATIVE, minima_between
from weier.methods.patches.pressure_and_gap import complementary_residuals
from weier.methods.patches.segments import ContactState, make_segments, segment_strengths
from weier.methods.patches.solver import solve_state
from weier.methods.patches.stages import follow_contacts, solve_in_stages
from weier.methods.patches.start import TOLERANCE, Starts, _make_guess, contacts_guess
from weier.methods.patches.surface import nearest_crests, surface_of

FOUR_WAVES = Profile(1.25, 5, 4, (0.0, 1.0, 2.0, 3.0))


def test_fast_sums_that_are_off_are_noticed(monkeypatch):
    """Direct sums at some of the points are the reference."""
    state = patches.solve_load(FOUR_WAVES, 1.8).state
    series = state.kind.series(surface_of(FOUR_WAVES))
    assert state.segments.node_count.sum() > pair_sums.MAX_DIRECT
    fine = contact_residual(state, series)[0].max()
    real, hidden = pair_sums._potential, 1e-7 / state.kind.factor(series.period)
    wrong = state._replace(approach=state.approach + 1e-7)
    monkeypatch.setattr(pair_sums, "_potential", lambda *arguments: real(*arguments) + hidden)
    assert contact_residual(wrong, series)[0].max() == pytest.approx(1e-7, rel=1e-3)
    assert fine < 1e-10


def solve_from_grid(profile, load):
    starts = Starts(profile, 1e-10)
    return solve_in_stages(starts.surface, starts.guess(load), TOLERANCE)


def edges_of(state):
    segments = state.segments
    return segments.middle - segments.half_width, segments.middle + segments.half_width


# As many as boundary elements on 16 nodes a wave have, and one more: contacts narrower than the overlap that gives
# them away divide some of the gaps, and are found at once.
@one_thread
@pytest.mark.parametrize(("phases", "load", "count"), [(np.arange(5.0), 2.0, 310), (1.0, 4.0, 346)])
def test_hundreds_of_contacts_or_gaps(phases, load, count):
    curve = patches.curve(Profile(1.25, 5, 5, phases), load + np.array([-1e-4, 0.0, 1e-4]))
    assert curve.patch_count[1] == count
    assert curve.residual.max() < 1e-10
    assert curve.work.max() < 15
    # A central difference: its error is that of the compliance, 1e-15, over the step, and the step's square.
    before, _, after = curve.compliance
    assert curve.resistance[1] == pytest.approx((after - before) / 2e-4, rel=1e-3)


def test_cuts_that_overlap_are_one():
    """The new gap in the wider interval of tension reaches beyond the narrower one, on its right."""
    one, none = np.ones(1), np.zeros(1)
    segments = make_segments(none.astype(int), none, 0.5 * one, 0.1 * one, np.array([8]))
    state = ContactState(CONTACTS, 1.0, 0.0, segments, np.zeros(8))
    negative = np.zeros(2, NEGATIVE)
    negative["start"], negative["end"] = (-0.5, 0.35), (0.3, 0.36)
    widening = 0.5 * (np.sqrt(2) - 1) * 0.8
    expected = [(0.4, 0.5 + 0.1 * (-0.5 - widening)), (0.5 + 0.1 * (0.3 + widening), 0.6)]
    np.testing.assert_allclose(stages._cut_segments(state, negative), expected)


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
    guess = contacts_guess(surface, load, np.stack([0.5 * (left + right), 0.5 * (right - left)]))
    again, _ = solve_in_stages(surface, guess, TOLERANCE)
    assert again.approach == pytest.approx(state.approach, abs=1e-12)
    np.testing.assert_allclose(np.sort(edges_of(again)[0] % 1), np.sort(edges_of(state)[0] % 1), atol=1e-9)


@one_thread
@pytest.mark.parametrize("load", [0.3, 5.6])
def test_contacts_without_the_last_wave_are_a_start(load):
    """Two of three contacts are missing, or gaps (5.6): corrections find all of them, one set after another."""
    profile, fewer = Profile(1.25, 5, 5, 1.0), Profile(1.25, 5, 4, 1.0)
    surface = surface_of(profile)
    coarse = patches.solve_load(fewer, min(load, 5.0))
    guess = contacts_guess(surface, load, np.stack([coarse.centre, coarse.half_width]))
    state, steps = solve_in_stages(surface, guess, TOLERANCE)
    expected = patches.solve_load(profile, load).state
    assert state.corrections == 2
    assert steps <= 31
    assert state.segments.centre.size == expected.segments.centre.size > 3 * coarse.centre.size
    assert state.approach == pytest.approx(expected.approach, abs=1e-12)
    assert state.resistance == pytest.approx(expected.resistance, rel=1e-9)
    np.testing.assert_allclose(state.tangent_strength, expected.tangent_strength, rtol=1e-6)


def test_contacts_that_do_not_sink_in_or_carry_another_load_are_refused():
    state = patches.solve_load(THREE_WAVES, 0.5).state
    check_violation(state, state.residual, state.kind.imbalance(state, 1.0)[0], 1.0, 1e-10)
    for wrong in (
        state._replace(approach=-1.0),
        state._replace(load=0.5 * (1 + 1e-7)),
        state._replace(residual=1e-7),
    ):
        with pytest.raises(ConvergenceError, match="violate their conditions"):
            check_violation(wrong, wrong.residual, wrong.kind.imbalance(wrong, 1.0)[0], 1.0, 1e-10)


@pytest.mark.parametrize("below", [0.0, 1e-13, 1e-12, 1e-11])
def test_a_gap_of_rounding_size_is_closed(below):
    """A merger of 2 contacts: the last gap between them is 4e-8 wide, and its tension 1e-12 of the load."""
    profile, merger = Profile(1.5, 3, 3, (0.0, 1.0, 2.0)), 4.355780741819659
    around = patches.curve(profile, [merger * (1 - 1e-8), merger * (1 - below), merger * (1 + 1e-8)])
    assert around.patch_count[[0, 2]].tolist() == [2, 1]
    assert around.residual.max() < 1e-10
    assert around.compliance[0] < around.compliance[1] < around.compliance[2]
    assert around.resistance[0] > around.resistance[1] > around.resistance[2]
    assert around.resistance[1] == pytest.approx(around.resistance[0], rel=1e-6)


@pytest.mark.parametrize("above", [1e-4, 1e-8, 1e-9, 1e-10])
@pytest.mark.parametrize("tolerance", [1e-12, 1e-10])
def test_a_contact_born_in_a_gap_changes_the_problem_that_is_solved(above, tolerance):
    """Three gaps start; the overlap in one of them, at most 2e-9 of its height, divides it; then contacts are solved.

    The new contact is so narrow that gaps beside it would take hundreds of nodes, whose rounding exceeds 1e-10.
    """
    profile = Profile(1.6118185037681407, 2, 3, (0.5959314512210883, 3.5894714149203306, 0.5937880239670698))
    load = 1.3837307176116824 * (1 + above)
    starts = Starts(profile, tolerance)
    assert starts.guess(load).kind is GAPS
    state, steps = solve_state(starts, load)
    assert state.kind is CONTACTS
    assert (state.segments.centre.size, state.corrections) == (4, 1)
    assert 3 < state.steps == steps < 10
    assert state.error < 1e-12


@pytest.mark.second_attempt
def test_a_gap_that_opens_by_less_than_the_residual_is_not_added():
    """Fast sums leave 2e-11 g_0, which hides an opening of 4e-13: such a gap came and vanished in turn."""
    profile = Profile(1.7986052809696087, "6/5", 3, (3.325507403983423, 3.1541776454366532, 2.812665935113782))
    loose, tight = (patches.curve(profile, [0.9744016943467795], tolerance) for tolerance in (1e-4, 1e-12))
    assert loose.work[0] < 10
    assert abs(loose.compliance - tight.compliance) <= loose.compliance_error < 1e-8
    assert abs(loose.resistance - tight.resistance) <= loose.resistance_error


@hard_series("limited_by_rounding")
def test_rounding_beside_events_ends_the_iteration(profile, loads):
    tight, usual = patches.curve(profile, loads, 1e-12), patches.curve(profile, loads)
    assert tight.work[0] < 20
    error = tight.compliance_error + usual.compliance_error
    assert tight.compliance[0] == pytest.approx(usual.compliance[0], abs=float(error[0]), rel=0)


def test_the_resistance_beside_a_merger():
    """The value is that of Newton's method on density and edges together, in a dense matrix of all."""
    phases = 4.574169531099157, 4.748128995525145, 0.2278665173120248
    profile, load = Profile(1.0693689688036165, 8, 3, phases), 0.2503344663826191
    curve = patches.curve(profile, load)  # for which the gap may count as a crack
    assert abs(curve.resistance - 1.71034873840) < curve.resistance_error < 1e-7


@pytest.mark.parametrize(
    ("profile", "load"), [(THREE_WAVES, 0.4), (THREE_WAVES, 2.0), (Profile(1.25, 5, 4, 1.0), 0.6)]
)
def test_the_resistance_falls_as_edges_move_out(profile, load):
    """By 2 pi^2 B^2/L for each unit of length, where an edge moves at the speed 2 B/A: few contacts, gaps, many."""
    before, here, after = patches.solve_loads(profile, load * (1 + np.array([-1e-4, 0, 1e-4])))
    expected = (after.state.resistance - before.state.resistance) / (after.mean_pressure - before.mean_pressure)
    B, strength = here.state.tangent_strength, np.abs(segment_strengths(here.state))
    assert -4 * np.pi**2 / profile.period * np.sum(B**3 / strength) == pytest.approx(expected, rel=1e-5)
    speed = (after.edges - before.edges) / (after.mean_pressure - before.mean_pressure) * [-1, 1]
    np.testing.assert_allclose(np.sort(speed.ravel()), np.sort((2 * B / strength).ravel()), rtol=1e-4)


@pytest.mark.parametrize("above", [1e-2, 1e-4, 1e-6])
def test_a_shallow_missing_contact_is_seen(above):
    """Contacts from below a birth, pressed beyond it: the overlap is 1e-6 to 1e-2 of what it soon would be."""
    events = patches.events(THREE_WAVES, 0.3, 1.0)
    born = events.mean_pressure[events.birth][0]
    surface, before = surface_of(THREE_WAVES), patches.solve_load(THREE_WAVES, born * (1 - 1e-7)).state
    assert before.kind is CONTACTS
    series, limit = surface.heights, 1e-10 * before.approach
    assert np.all(minima_between(before, series, limit, 0.0)["value"] >= -limit)
    beyond = follow_contacts(surface, before, born * (1 + above))
    x = np.linspace(-1, 1, 2001) * 10 * above**0.5 / THREE_WAVES.waves_per_period[-1]
    x = events.x[events.birth][0] + x[np.abs(x) < 0.2 / THREE_WAVES.waves_per_period[-1]]
    lowest = complementary_residuals(beyond, series, *nearest_crests(series, x)).min()
    assert lowest < -limit
    assert 1 <= minima_between(beyond, series, limit, 0.0)["value"].min() / lowest < 1.2


@one_thread
def test_edges_that_moved_after_the_last_solution_change_the_resistance(wave, dual):
    """By the energy released, to the square of the move: against -L ln(xi) of Westergaard's wave."""
    exact, problem = wave.state(dual).segments, ContactProblem(wave.series(dual), wave.load, KINDS[dual])
    scale = min(wave.half_width, 0.5 * wave.period - wave.half_width)
    wider = exact._replace(half_width=exact.half_width + 1e-4 * scale)
    step = take_step(problem, make_guess(problem, wider, TOLERANCE), 1e-15)
    tangent = solve_tangent(step.punches, step.forces, 1e-10)
    wrong, right = (stages._resistance(step, end, tangent)[0] for end in (step, carried_along(step, 0.0)))
    assert abs(wrong - wave.resistance) > 1e-5 * scale
    assert abs(right - wave.resistance) < 2e-3 * abs(wrong - wave.resistance)


@pytest.mark.parametrize(
    ("kind", "part", "name"),
    [(CONTACTS, 0.02, "new_outside"), (CONTACTS, 0.02, "new_within"), (GAPS, 0.8, "new_within")],
)
def test_the_width_of_new_segments_changes_no_result(kind, part, name, monkeypatch):
    """From a guess without the second segment, or with the first two as one, which are added or cut."""
    profile = Profile(1.6, 2, 7, tuple(np.random.default_rng(3).uniform(0, 2 * np.pi, 7)))
    starts, load = Starts(profile, TOLERANCE), part * profile.full_contact_load
    exact, _ = solve_state(starts, load)
    assert exact.kind is kind
    assert exact.cracks.contact.size == 0
    left, right = exact.segments.middle - exact.segments.half_width, exact.segments.right
    left, right = np.delete(left, 1), np.delete(right, 1 if name == "new_outside" else 0)
    intervals, value = np.stack([0.5 * (left + right), 0.5 * (right - left)]), getattr(kind, name)
    for factor in (0.5, 1.0, 2.0):
        monkeypatch.setattr(type(kind), name, factor * value)
        guess = _make_guess(kind.series(starts.surface), load, kind, intervals)
        state, _ = solve_in_stages(starts.surface, guess, TOLERANCE)
        assert state.corrections > 0
        assert state.approach == pytest.approx(exact.approach, abs=TOLERANCE)
        assert state.resistance == pytest.approx(exact.resistance, rel=1e-9)
