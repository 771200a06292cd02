"""Random phases: the same for the same seed, and more of them for a longer series."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from weier import Profile, random_phases


@given(st.integers(0, 2**63), st.integers(1, 50), st.integers(1, 50))
@settings(deadline=None, derandomize=True)
def test_random_phases_of_a_longer_series_extend_the_shorter(seed, m, more):
    shorter, longer = (Profile(1.5, 5, terms, random_phases(seed)).phase for terms in (m, m + more))
    np.testing.assert_array_equal(longer[:m], shorter)
    assert np.all((longer >= 0) & (longer < 2 * np.pi))


def test_random_phases_differ_between_seeds():
    assert np.all(random_phases(1).first(5) != random_phases(2).first(5))


@pytest.mark.parametrize("seed", [-1, 1.5, True, "1", None])
def test_random_phases_refuse_what_is_no_seed(seed):
    with pytest.raises(ValueError, match="seed must be a non-negative integer, got"):
        random_phases(seed)
