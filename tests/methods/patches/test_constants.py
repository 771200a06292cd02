"""Constants that decide how a solution is found, not which: a factor of two either way changes no result."""

import numpy as np
import pytest

from weier import Profile
from weier.methods.patches import given_edges, stages, start
from weier.methods.patches.contacts import CONTACTS
from weier.methods.patches.gaps import GAPS
from weier.methods.patches.solver import curve, solve_state
from weier.methods.patches.start import TOLERANCE, Starts, _make_guess
from weier.methods.patches.surface import surface_of

SEVEN_WAVES = Profile(1.6, 2, 7, tuple(np.random.default_rng(3).uniform(0, 2 * np.pi, 7)))
FULL = surface_of(SEVEN_WAVES).full_contact_load
LOADS = FULL * np.append(np.geomspace(1e-5, 0.96, 40), 1 - np.geomspace(0.03, 1e-6, 4))
CONSTANTS = [
    ("MAX_OVER_TARGET", stages),
    ("TARGET", stages),
    ("MAX_DIRECT", given_edges, stages),
    ("GUESS_TOLERANCE", start),
    ("GRID_TOLERANCE", start),
]


@pytest.fixture(scope="module")
def reference():
    return curve(SEVEN_WAVES, LOADS)


@pytest.mark.parametrize("constant", CONSTANTS, ids=lambda constant: constant[0])
def test_a_factor_of_two_changes_no_result(constant, reference, monkeypatch):
    name, *owners = constant
    value, changes = getattr(owners[0], name), 0
    for factor in (0.5, 2.0):
        for owner in owners:
            monkeypatch.setattr(owner, name, type(value)(factor * value))
        found = curve(SEVEN_WAVES, LOADS)
        np.testing.assert_array_equal(found.patch_count, reference.patch_count)
        np.testing.assert_allclose(found.compliance, reference.compliance, rtol=0, atol=TOLERANCE)
        difference = np.abs(found.resistance - reference.resistance)
        assert np.all(difference <= 0.01 * (found.resistance_error + reference.resistance_error))
        changes += np.count_nonzero(difference)
    assert changes > 0  # in the last digits: the constant is used under these loads


@pytest.mark.parametrize(
    ("kind", "load", "name"),
    [(CONTACTS, 0.02 * FULL, "new_outside"), (CONTACTS, 0.02 * FULL, "new_within"), (GAPS, 0.8 * FULL, "new_within")],
)
def test_the_width_of_new_segments_changes_no_result(kind, load, name, monkeypatch):
    """From a guess without the second segment, or with the first two as one, which are added or cut."""
    starts = Starts(SEVEN_WAVES, TOLERANCE)
    exact, _ = solve_state(starts, load)
    assert exact.kind is kind
    assert exact.cracks.contact.size == 0
    left, right = exact.segments.middle - exact.segments.half_width, exact.segments.right
    left, right = np.delete(left, 1), np.delete(right, 1 if name == "new_outside" else 0)
    intervals, value = np.stack([0.5 * (left + right), 0.5 * (right - left)]), getattr(kind, name)
    for factor in (0.5, 1.0, 2.0):
        monkeypatch.setattr(type(kind), name, factor * value)
        guess = _make_guess(kind.series(starts.surface), load, kind, intervals)
        state, _ = stages.solve_in_stages(starts.surface, guess, TOLERANCE)
        assert state.corrections > 0
        assert state.approach == pytest.approx(exact.approach, abs=TOLERANCE)
        assert state.resistance == pytest.approx(exact.resistance, rel=1e-9)
