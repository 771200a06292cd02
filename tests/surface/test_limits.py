"""Surfaces and grids that no computer holds, and the ratio that is offered in the place of an irrational one."""

import math

import pytest

from weier import Profile
from weier.surface.limits import check_points, check_resolvable


def test_the_most_waves_and_nodes_are_taken_and_one_more_refused():
    """5^7 = 78 125 waves, 10^5, and 46^3 = 97 336, beside 47^3."""
    for gamma, m in ((5, 8), (10, 6), (46, 4)):
        check_resolvable(Profile(1.5, gamma, m))
    with pytest.raises(ValueError, match="at most 100000 times into the period"):
        check_resolvable(Profile(1.5, 47, 4))
    check_points(10**7)
    with pytest.raises(ValueError, match="points must be at most 10000000, got 10000001"):
        check_points(10**7 + 1)


@pytest.mark.parametrize("gamma", [math.sqrt(5), "1.4142135", math.pi])
def test_a_ratio_without_a_period_that_a_computer_holds_is_offered_one_that_has(gamma):
    """Only methods that resolve every wave need one."""
    with pytest.raises(ValueError, match="take gamma") as refusal:
        check_resolvable(Profile(1.5, gamma, 3))
    offered = Profile(1.5, str(refusal.value).split('"')[1], 3)
    check_resolvable(offered)
    assert float(offered.gamma) == pytest.approx(float(Profile(1.5, gamma, 3).gamma), rel=1e-2)


def test_the_ratio_that_is_offered_may_have_the_most_waves():
    """10^5, of 10/3 with six terms."""
    with pytest.raises(ValueError, match='take gamma = "10/3"'):
        check_resolvable(Profile(1.5, 3.3331, 6))


def test_no_ratio_is_offered_where_none_will_do():
    for gamma, m in ((1.0000001, 3), (math.pi, 12), (1e6, 3)):
        with pytest.raises(ValueError, match="exceeds: take fewer terms"):
            check_resolvable(Profile(1.5, gamma, m))
