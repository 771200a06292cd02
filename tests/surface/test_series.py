"""Amplitudes, pressures and their sums against mpmath."""

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from weier.surface.series import (
    amplitude,
    checked_dimension,
    checked_terms,
    full_contact_pressure,
    leading_amplitude,
    tail_amplitude,
)

EPS = np.finfo(float).eps


@settings(max_examples=200, deadline=None, derandomize=True)
@given(st.floats(1e-9, 1 - 1e-9), st.floats(-6, 6), st.integers(0, 1000))
def test_powers_keep_their_last_digits(a, size, n):
    D, gamma = 1 + a, 1 + 10.0**size
    with mp.workdps(40):
        g, pressure = (mp.mpf(gamma) ** ((mp.mpf(D) - e) * n) for e in (2, 1))
    if g > 1e-300:
        assert amplitude(n, D, gamma) == pytest.approx(float(g), rel=4 * EPS)
    if pressure < 1e300:
        assert full_contact_pressure(n, D, gamma) == pytest.approx(float(pressure), rel=4 * EPS)


@pytest.mark.parametrize(("D", "gamma"), [(1.25, 5), (1 + 1e-9, 1e6), (2 - 1e-9, 1 + 1e-6), (1.5, 2)])
@pytest.mark.parametrize("m", [0, 1, 4, 1000, np.inf])
def test_sums_of_amplitudes_against_mpmath(D, gamma, m):
    with mp.workdps(60):
        ratio = mp.mpf(gamma) ** (mp.mpf(D) - 2)
        first = mp.fsum(ratio**n for n in range(m)) if m < np.inf else 1 / (1 - ratio)
        rest = ratio**m / (1 - ratio) if m < np.inf else mp.mpf(0)
    # ratio^m magnifies the rounding of its exponent m (2 - D) ln gamma
    rounding = (4 + abs(float(mp.log(ratio)) * min(m, 1000))) * EPS
    assert leading_amplitude(m, D, gamma) == pytest.approx(float(first), rel=4 * EPS)
    assert tail_amplitude(m, D, gamma) == pytest.approx(float(rest), rel=rounding, abs=1e-300)


def test_dimensions_lie_between_those_of_a_line_and_a_plane():
    assert checked_dimension(1.0001) == 1.0001
    for D in (1.0, 2.0, 0.5, 2.5, np.nan):
        with pytest.raises(ValueError, match=r"D must lie in \(1, 2\), got"):
            checked_dimension(D)


def test_terms_are_whole_numbers_up_to_a_million_or_inf():
    assert [checked_terms(m) for m in (1, 3.0, 10**6, np.inf, " Inf")] == [1, 3, 10**6, np.inf, np.inf]
    for m in (0, 2.5, 10**6 + 1, -np.inf, np.nan):
        with pytest.raises(ValueError, match="m must be a whole number of terms, from 1 to 1000000, or inf"):
            checked_terms(m)
