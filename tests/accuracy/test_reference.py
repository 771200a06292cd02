"""The reference of a method: right by independent values, and None where nothing is known."""

import mpmath as mp
import numpy as np
import pytest

from tests.reference import REFERENCES
from weier import Profile
from weier.accuracy.cosines import shifted
from weier.accuracy.reference import contact_reference, deviation, digits, own_reference
from weier.accuracy.runner import Variant, attempt
from weier.methods import registry, westergaard

THREE = Profile(1.25, 5, 3, (0.0, 1.0, 2.0))
LOADS = np.array([0.01, 0.1])


def reference_of(name, profile, loads=LOADS):
    return own_reference(Variant(name), profile, loads, attempt(Variant(name), profile, loads))


@pytest.mark.parametrize("known", REFERENCES, ids=str)
def test_the_exact_contact_is_that_of_independent_values(known):
    """To the digits that these have: 1e-10 of the compliance and 1e-8 of the resistance."""
    found = contact_reference(known.profile, tuple(known.mean_pressure.tolist()))
    assert np.array(found.values[0], float) == pytest.approx(known.compliance, rel=1e-10, abs=1e-10)
    assert np.array(found.values[1], float) == pytest.approx(known.resistance, rel=1e-8, abs=1e-8)
    assert np.all(found.uncertainty > 0)


def test_for_one_wave_every_method_is_held_against_westergaard():
    for name in ("layer", "bem", "auto", "archard"):
        found = reference_of(name, Profile(1.5, 5, 1))
        assert np.array(found.values[0], float) == pytest.approx(westergaard.compliance(LOADS), rel=1e-15)


def test_an_estimate_is_held_against_its_own_sum_and_a_solution_against_the_contact():
    exact = np.array(contact_reference(THREE, tuple(LOADS.tolist())).values, float)
    for name in ("demelio", "layer", "bem", "patches", "auto"):
        found = np.array(reference_of(name, THREE).values, float)
        assert np.array_equal(found, exact) == (name not in ("demelio", "layer"))
        own = registry.find_method(name).solve(THREE, LOADS)
        assert found[0] == pytest.approx(
            own.compliance, abs={"layer": 1e-4, "bem": 1e-4, "auto": 1e-2}.get(name, 1e-9)
        )


def test_a_shifted_profile_has_its_phases_within_a_turn():
    """A larger phase would be doubted, as one in degrees. The height at x is that at x + 0.3, or at -x - 0.3."""
    profile = Profile(1.3, 2, 2, (6.2, 6.1))
    for reflected in (False, True):
        surface = shifted(profile, reflected)
        assert np.all((surface.phase >= 0) & (surface.phase < 2 * np.pi))
        x = np.linspace(0, 1, 7)
        assert surface.height(x) == pytest.approx(profile.height(-x - 0.3 if reflected else x + 0.3), abs=1e-14)


def test_correct_digits_run_from_none_to_all_that_a_double_has():
    values = np.array([1.0, 1.001, 2.0, np.nan, 0.0, 1e-320, 1e-3])
    right = np.array([mp.mpf(1), mp.mpf(1), mp.mpf(1), mp.mpf(1), mp.mpf(0), mp.mpf(10) ** -400, mp.mpf(0)])
    np.testing.assert_allclose(digits(values, right), [16, 3, 0, np.nan, 16, 16, 0], atol=1e-12)


def test_deviation_is_from_all_digits_of_what_is_right():
    with mp.workdps(50):
        third = np.array([mp.mpf(1) / 3] * 2)
    assert deviation(np.array([1 / 3, np.nan]), third)[0] == pytest.approx(2**-54 / 3, rel=1e-10)
    assert np.isnan(deviation(np.array([np.nan, 1.0]), np.array([mp.mpf(1), mp.nan], object))).all()
    assert deviation(np.array([1.5]), np.array([1.0])).tolist() == [0.5]
