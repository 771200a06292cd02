"""Many contacts without a dense matrix: hundreds of them, bad starts, and what is refused."""

import numpy as np
import pytest

from tests.profiles import THREE_WAVES
from weier import ConvergenceError, Profile
from weier.kernels.blas import one_thread
from weier.methods import patches
from weier.methods.patches import certificate, fields, many_contacts
from weier.methods.patches.certificate import check_violation, contact_residual
from weier.methods.patches.inequalities import NEGATIVE
from weier.methods.patches.many_contacts import solve_many_contacts
from weier.methods.patches.segments import ContactState, make_segments
from weier.methods.patches.solver import TOLERANCE
from weier.methods.patches.start import Starts, contacts_guess
from weier.methods.patches.surface import surface_of

FOUR_WAVES = Profile(1.25, 5, 4, (0.0, 1.0, 2.0, 3.0))


def solve_from_grid(profile, load):
    starts = Starts(profile, 1e-10)
    return solve_many_contacts(starts.surface, list(starts.guesses(load))[1], TOLERANCE)


def edges_of(state):
    segments = state.segments
    return segments.middle - segments.half_width, segments.middle + segments.half_width


# Gaps, and contacts, as many as boundary elements on 16 nodes a wave have; and contacts narrower than the overlap
# that gives them away, which divide some of 1000 gaps and are found at once.
MANY = [(np.arange(6.0), 12.0, 581), (np.arange(6.0), 2.0, 1165), (1.0, 10.0, 999)]


@one_thread
@pytest.mark.parametrize(("phases", "load", "count"), MANY)
def test_hundreds_of_contacts_or_gaps(phases, load, count):
    before, curve, after = (patches.curve(Profile(1.25, 5, 6, phases), load + step) for step in (-1e-4, 0.0, 1e-4))
    assert curve.patch_count == count
    assert curve.residual < 1e-10
    assert curve.work < 15
    # A central difference: its error is that of the compliance, 1e-15, over the step, and the step's square.
    assert curve.resistance == pytest.approx((after.compliance - before.compliance) / 2e-4, rel=1e-3)


def test_cuts_that_overlap_are_one():
    """The new gap in the wider interval of tension reaches beyond the narrower one, on its right."""
    one, none = np.ones(1), np.zeros(1)
    segments = make_segments(none.astype(int), none, 0.5 * one, 0.1 * one, np.array([8]))
    state = ContactState(False, 1.0, 0.0, segments, np.zeros(8))
    negative = np.zeros(2, NEGATIVE)
    negative["start"], negative["end"] = (-0.5, 0.35), (0.3, 0.36)
    widening = 0.5 * (np.sqrt(2) - 1) * 0.8
    expected = [(0.4, 0.5 + 0.1 * (-0.5 - widening)), (0.5 + 0.1 * (0.3 + widening), 0.6)]
    np.testing.assert_allclose(many_contacts._cut_segments(state, negative), expected)


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
    guess = contacts_guess(surface, load, np.stack([0.5 * (left + right), 0.5 * (right - left), force]))
    again, _ = solve_many_contacts(surface, guess, TOLERANCE)
    assert again.approach == pytest.approx(state.approach, abs=1e-12)
    np.testing.assert_allclose(np.sort(edges_of(again)[0] % 1), np.sort(edges_of(state)[0] % 1), atol=1e-9)


def test_an_edge_at_a_narrow_gap_tells_nothing_of_the_opposite_one():
    """The pressure beside the gap is nearly 0, and changed its sign in each step that made the other edge move."""
    starts = Starts(Profile(1.25, 5, 6, (0.0, 1.0, 1.0, 1.0, 1.0, 1.0)), 1e-10)
    assert solve_many_contacts(starts.surface, next(starts.guesses(0.5623413251903491)), TOLERANCE)[1] <= 10


@one_thread
@pytest.mark.parametrize("load", [0.3, 5.6])
def test_contacts_without_the_last_wave_are_a_start(load):
    """Most contacts are missing, and edges beside them do not settle before the set is corrected; then gaps (5.6)."""
    profile, fewer = Profile(1.25, 5, 5, 1.0), Profile(1.25, 5, 4, 1.0)
    surface = surface_of(profile)
    coarse = patches.solve_load(fewer, min(load, 5.0))
    force = np.full(coarse.centre.size, load / coarse.centre.size)
    guess = contacts_guess(surface, load, np.stack([coarse.centre, coarse.half_width, force]))
    state, steps = solve_many_contacts(surface, guess, TOLERANCE)
    expected = patches.solve_load(profile, load).state
    assert steps < 30
    assert state.segments.centre.size == expected.segments.centre.size > 3 * coarse.centre.size
    assert state.approach == pytest.approx(expected.approach, abs=1e-12)
    assert state.resistance == pytest.approx(expected.resistance, rel=1e-9)
    np.testing.assert_allclose(state.tangent_strength, expected.tangent_strength, rtol=1e-6)


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
    """Closed forms at some of the points are the reference."""
    state = patches.solve_load(FOUR_WAVES, 1.5).state
    assert state.segments.centre.size > fields.MIN_SUM_SEGMENTS
    monkeypatch.setattr(certificate, "residuals_by_sums", lambda state, series, crest, *others: np.zeros(crest.size))
    wrong = state._replace(approach=state.approach + 1e-7)
    assert contact_residual(wrong, surface_of(FOUR_WAVES).series(state.dual)).max() > 1e-8


@pytest.mark.slow
@pytest.mark.parametrize(
    ("profile", "load"),
    [(Profile(1.25, "5/2", 7), 0.3), (Profile(1.9969740225659736, "7/3", 5, 2.1988175416599183), 16.7166415671536)],
)
def test_a_long_period(profile, load):
    """It is 64 or 81 lambda_0, where positions are rounded to 1e-14; and no node makes up for rounding."""
    curve = patches.curve(profile, load)
    assert curve.residual < 1e-10 * max(load, 1)
    assert curve.work < 10


@pytest.mark.parametrize("apart", [False, True])
def test_a_polynomial_is_nowhere_larger_than_its_samples_allow(apart):
    random, everywhere = np.random.default_rng(0), np.cos(np.linspace(0, np.pi, 4000))
    state = patches.solve_load(THREE_WAVES, 0.5).state
    nodes, (first, _, y) = np.diff(state.segments.first_node), certificate.sample_points(state.segments, apart)
    for j, where in enumerate(np.split(y, first[1:-1])):
        at = (where - state.segments.centre[j]) / state.segments.half_width[j]
        for _ in range(100):
            coefficients = random.normal(size=nodes[j] + 3) * random.integers(0, 2, nodes[j] + 3)
            wave = np.polynomial.Chebyshev(coefficients + 1e-9)
            assert np.abs(wave(everywhere)).max() <= certificate.SAMPLED_FACTOR * np.abs(wave(at)).max()
