"""The reference of a method: right by independent values, and None where nothing is known."""

import math

import numpy as np
import pytest

from tests.reference import REFERENCES
from weier import Profile
from weier.accuracy import reference as module
from weier.accuracy.cosines import shifted
from weier.accuracy.reference import contact_reference, find_reference, is_in_reach
from weier.accuracy.runner import Outcome, attempt
from weier.accuracy.variants import Variant
from weier.methods import registry, westergaard

THREE = Profile(1.25, 5, 3, (0.0, 1.0, 2.0))
LOADS = np.array([0.01, 0.1])


def reference_of(name, profile, loads=LOADS):
    return find_reference(
        registry.find_method(name), profile, loads, attempt(Variant(name, name, {}), profile, loads)
    )


@pytest.mark.parametrize("known", REFERENCES, ids=str)
def test_the_exact_contact_is_that_of_independent_values(known):
    """To the digits that these have: 1e-10 of the compliance and 1e-8 of the resistance."""
    found = contact_reference(known.profile, tuple(known.mean_pressure.tolist()))
    assert np.array(found.compliance, float) == pytest.approx(known.compliance, rel=1e-10, abs=1e-10)
    assert np.array(found.resistance, float) == pytest.approx(known.resistance, rel=1e-8, abs=1e-8)


def test_first_touch_meets_what_the_patches_of_the_shifted_profile_give():
    """Below 1e-20 p_0* a closed form is the reference, above it the patches."""
    below, above = (contact_reference(THREE, (p,)) for p in (0.9e-20, 1.1e-20))
    # R falls by ln(1.1/0.9) between the two loads.
    assert float(below.resistance[0] - above.resistance[0]) == pytest.approx(math.log(1.1 / 0.9), rel=1e-8)
    assert float(below.compliance[0]) == pytest.approx(float(above.compliance[0]), rel=1e-12)


def test_full_contact_is_that_of_the_patches():
    """At the load where the closed form takes over, the patches have the same compliance and hardly a resistance."""
    load = THREE.full_contact_load
    assert load < THREE.full_contact_pressure.sum()
    closed = contact_reference(THREE, (load * 1.0001,))
    below = contact_reference(THREE, (load * 0.9999,))
    assert closed.resistance == (0,)
    assert float(below.compliance[0]) == pytest.approx(float(closed.compliance[0]), rel=1e-6)
    assert 0 < below.resistance[0] < 1e-3


def test_for_one_wave_every_method_is_held_against_westergaard():
    one = Profile(1.5, 5, 1)
    for name in ("layer", "bem", "auto", "archard"):
        found = reference_of(name, one)
        assert found.source == "mpmath"
        assert np.array(found.compliance, float) == pytest.approx(westergaard.compliance(LOADS), rel=1e-15)


def test_an_estimate_is_held_against_its_own_sum_and_a_solution_against_the_contact():
    assert reference_of("demelio", THREE).source == "mpmath"
    assert reference_of("layer", THREE).source == "finer layer"
    for name in ("bem", "patches", "auto"):
        assert reference_of(name, THREE).source == "closed forms, patches 1e-12"


def test_nothing_is_known_of_what_takes_too_long(monkeypatch):
    monkeypatch.setattr(module, "MAX_REFERENCE_SECONDS", 0.1)
    infinite = Profile(1.5, 5, math.inf)
    for name, profile in (("layer", Profile(1.5, 5, 11)), ("bem", Profile(1.5, 1000, 2))):
        found = reference_of(name, profile)
        assert found.source == ""
        assert np.isnan(np.array(found.compliance, float)).all()
    assert reference_of("layer", infinite).source == "finer layer"
    assert reference_of("demelio", infinite).source == "mpmath"
    assert not is_in_reach(infinite, LOADS)
    assert not is_in_reach(Profile(1.5, 10, 5), LOADS)  # 10 000 waves
    assert not is_in_reach(Profile(1.5, 10, 9), LOADS)  # more than a computer holds
    assert is_in_reach(THREE, LOADS)


def test_where_nothing_was_made_nothing_is_looked_up():
    """Of two loads the first was refused."""
    profile, loads = Profile(1.5, 5, 1), np.array([1e-300, 0.1])
    made = attempt(Variant("bem", "bem", {}), profile, loads)
    made.outcome[0] = Outcome.clear_error
    found = find_reference(registry.find_method("bem"), profile, loads, made)
    assert np.isnan(np.array(found.compliance, float)).tolist() == [True, False]


def test_a_shifted_profile_has_its_phases_within_a_turn():
    """A larger phase would be doubted, as one in degrees. The height at x is that at x + 0.3, or at -x - 0.3."""
    profile = Profile(1.3, 2, 2, (6.2, 6.1))
    for reflected in (False, True):
        surface = shifted(profile, reflected)
        assert np.all((surface.phase >= 0) & (surface.phase < 2 * np.pi))
        x = np.linspace(0, 1, 7)
        assert surface.height(x) == pytest.approx(profile.height(-x - 0.3 if reflected else x + 0.3), abs=1e-14)
