"""Appendix B derived again: the tangents, the cubic, the stiffness of the smooth punch."""

import mpmath as mp
import numpy as np
import pytest

from weier.theory.self_similar_punch import stiffness_bounds, tangent_roots

ROUGHNESS = np.concatenate(
    [[0.0, 1e-300, 1e-16, 1e-9], np.linspace(0.01, 0.99, 25), 1 - np.geomspace(1e-3, 1e-16, 9)]
)


def roots_of_the_cubic(epsilon):
    """x_1, x_2 of (B.8), in 400 digits: epsilon = 1e-300 parts them by 1e-150."""
    with mp.workdps(400):
        ratio = mp.sqrt((1 - mp.mpf(epsilon)) / (1 + mp.mpf(epsilon)))
        first, second = mp.mpf("0.55"), 2 / ratio
        for _ in range(1500):  # Newton from outside both roots: each step stays outside
            first -= cubic(first, ratio) / (6 * ratio * first**2 - 6 * first)
            second -= cubic(second, ratio) / (6 * ratio * second**2 - 6 * second)
            if max(abs(cubic(x, ratio)) for x in (first, second)) < mp.mpf(10) ** -390:
                break
        return first, second


def cubic(x, ratio):
    return 2 * ratio * x**3 - 3 * x**2 + 1


@pytest.mark.parametrize("epsilon", ROUGHNESS[1:])
def test_roots_solve_the_cubic(epsilon):
    for computed, exact in zip(tangent_roots(epsilon), roots_of_the_cubic(epsilon), strict=True):
        assert float(abs(mp.mpf(float(computed)) / exact - 1)) < 1e-15


def test_no_steeper_or_flatter_line_is_allowed():
    # By brute force: from every point between F_1 and F_2 at force F = 1, the lines below F_1.
    epsilon, zeta = 0.3, np.geomspace(1e-4, 1e3, 200_001)
    C_1, C_2 = (8 / 3 / np.sqrt(1 + sign * epsilon) for sign in (-1, 1))  # (B.3), (B.4) for M = R = 1
    smooth = 1.5 * (8 / 3) ** (2 / 3)
    lower, upper = np.inf, 0.0
    for start in np.linspace(C_1 ** (-2 / 3), C_2 ** (-2 / 3), 11):
        chord = (C_1 * zeta**1.5 - 1) / (zeta - start)
        steepest = np.min(chord[zeta > start * (1 + 1e-9)])
        flattest = np.max(chord[zeta < start * (1 - 1e-9)])
        upper, lower = max(upper, steepest / smooth), min(lower, flattest / smooth)
    # The chord is stationary at the tangent point: the grid's 8e-5 enters squared.
    assert stiffness_bounds(epsilon) == pytest.approx((lower, upper), rel=1e-7)


def test_bounds_contain_the_smooth_punch_and_widen_with_roughness():
    lower, upper = stiffness_bounds(ROUGHNESS)
    assert (lower[0], upper[0]) == pytest.approx((1, 1), abs=1e-15)
    assert np.all((lower[2:] < 1) & (upper[2:] > 1))
    assert np.all((np.diff(lower) <= 0) & (np.diff(upper) >= 0))


def test_bounds_of_the_roughest_punch_are_the_limits_of_the_cubic():
    # x_2 -> 3/(2 lambda) as (B.8) loses its constant, x_1 -> 1/sqrt(3) as it loses its cubic term.
    lower, upper = stiffness_bounds(1 - 1e-16)
    assert lower == pytest.approx(2 / 3 * 2 ** (1 / 6 - 1 / 2), rel=1e-7)
    assert upper * np.sqrt(2.0**-53) == pytest.approx(np.sqrt(3) * 2 ** (1 / 6), rel=1e-7)


@pytest.mark.parametrize("epsilon", [-0.1, 1.0, np.nan, [0.5, 2.0]])
@pytest.mark.parametrize("function", [tangent_roots, stiffness_bounds])
def test_roughness_outside_its_range_is_refused(function, epsilon):
    with pytest.raises(ValueError, match=r"epsilon must lie in \[0, 1\)"):
        function(epsilon)
