"""Surfaces that no computer holds."""

import pytest

from weier import Profile
from weier.surface.limits import check_resolvable


def test_the_most_waves_are_taken_and_one_more_refused():
    """5^7 = 78 125 waves, 10^5, and 46^3 = 97 336, beside 47^3."""
    for gamma, m in ((5, 8), (10, 6), (46, 4)):
        check_resolvable(Profile(1.5, gamma, m))
    for gamma, m in ((47, 4), (2**0.5, 3), (1.0000001, 3)):
        with pytest.raises(ValueError, match="at most 100000 times into the period"):
            check_resolvable(Profile(1.5, gamma, m))
