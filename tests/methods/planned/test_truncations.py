"""Terms that a tolerance does not need, and what leaving them out adds to the errors."""

import math
from functools import cache

import numpy as np
import pytest

import weier
from tests.profiles import THREE_WAVES
from weier import Profile, plan
from weier.methods import bem, patches
from weier.methods.errors import NotApplicableError
from weier.methods.planned import solver as planned
from weier.methods.planned import truncations
from weier.theory.bounds import compliance_bounds, resistance_bounds

LOADS = np.geomspace(1e-3, 10, 12)


def test_terms_that_a_tolerance_does_not_need_are_left_out_within_the_bounds():
    (part, estimate, flat) = plan(THREE_WAVES, LOADS, 0.1).parts
    assert (part.terms, estimate.method) == (2, "demelio")
    assert part.truncation == pytest.approx(THREE_WAVES.amplitude[2])
    kept = patches.curve(THREE_WAVES.truncated(2), LOADS).compliance
    low, high = compliance_bounds(kept + THREE_WAVES.amplitude_beyond(2), part.truncation[0])
    exact = patches.curve(THREE_WAVES, LOADS).compliance
    assert np.all((low <= exact) & (exact <= high))
    # Once two terms are flat, the third one follows from half of its height, without a grid.
    assert (flat.method, flat.terms) == ("full contact", 2)
    assert flat.truncation == pytest.approx(THREE_WAVES.amplitude[2] / 2)
    curve = planned.run(THREE_WAVES, (part, estimate, flat))
    assert np.all(np.abs(curve.compliance - exact) <= curve.compliance_error)
    assert np.all(curve.compliance_error <= 0.1)


MANY_TERMS = {3: 9, 5: 6}  # by gamma: more than any plan takes
AROUND = np.array([0.9, 0.98, 1, 1.02, 1.1])


@cache
def compliance_of_many_terms(D, gamma):
    """Around each of the loads below, and within which error."""
    profile = Profile(D, gamma, MANY_TERMS[gamma], math.pi)
    points, around = 16 * profile.waves_per_period[-1], np.sort(np.outer([0.3, 1.0, 2.0], AROUND).ravel())
    h = bem.curve(profile, around, points=points, with_resistance=False, staircase="kept").compliance
    return around, h, bem.error_model.compliance_error(profile, points)


@pytest.mark.parametrize("loads", [[1.0], [0.3, 1.0, 2.0]])
@pytest.mark.parametrize("m", [12, math.inf])
@pytest.mark.parametrize(("D", "gamma", "tolerance"), [(1.02, 5, 0.3), (1.1, 3, 0.25), (1.2, 5, 0.5)])
def test_the_resistance_of_a_long_series_is_within_its_tolerance_whatever_the_loads(D, gamma, tolerance, m, loads):
    """Against more terms than the plan took: the true resistance lies within what chords of theirs allow."""
    profile = Profile(D, gamma, m, math.pi)
    curve = weier.solve(profile, loads, "planned", tolerance=tolerance, quantity="resistance")
    error = curve.resistance_error.values
    assert np.all(error <= tolerance * np.maximum(curve.resistance.values, 1) * (1 + 1e-9))
    most = MANY_TERMS[gamma]
    assert curve.planned_terms.values.max() < most
    around, h, uncertainty = compliance_of_many_terms(D, gamma)
    low, high = resistance_bounds(around, h, profile.amplitude_beyond(most) + uncertainty)
    here = np.searchsorted(around, loads)
    assert np.all(curve.resistance.values - error <= high[here])
    assert np.all(curve.resistance.values + error >= low[here])


def test_what_misses_its_tolerance_is_solved_by_more_terms_or_refused(monkeypatch):
    """Foreseen chords may turn out narrower than those found, here a tenth as wide."""
    expected = truncations.expected_chords

    def too_narrow(*given):
        width, other_loads = expected(*given)
        return width / 10, other_loads

    profile, loads = Profile(1.1, 3, math.inf, math.pi), [0.3, 2.0]
    terms = weier.solve(profile, loads, "planned", tolerance=0.3, quantity="resistance").planned_terms.values
    monkeypatch.setattr(truncations, "expected_chords", too_narrow)
    assert plan(profile, loads, 0.3, "resistance").parts[0].terms < terms[0]
    again = weier.solve(profile, loads, "planned", tolerance=0.3, quantity="resistance")
    assert np.all(again.resistance_error <= 0.3 * np.maximum(again.resistance, 1))
    monkeypatch.setattr(truncations, "MAX_POINTS", 10_000)
    with pytest.raises(NotApplicableError, match=r"was expected to do, and left an error of .* at 0\.3 p_0\*"):
        weier.solve(Profile(1.3, 5, math.inf), [0.3], "planned", tolerance=0.1, quantity="resistance")


def test_an_infinite_series_resolves_what_its_tail_demands():
    part = plan(Profile(1.25, 5, math.inf), LOADS, 1e-2).parts[0]
    assert part.method == "bem"
    assert part.truncation == pytest.approx(Profile(1.25, 5, int(part.terms)).tail_amplitude)
    assert Profile(1.25, 5, int(part.terms) - 1).tail_amplitude > 1e-2
