"""The sums in 50 digits, that others are held against, held against what can be written down."""

import mpmath as mp
import pytest

from weier.accuracy import multiprecision as exact

TERMS = 200  # of a sum that falls by half a term: below the last digit


def assert_same(found, *wanted):
    for value, known in zip(found, wanted, strict=True):
        assert abs(value - known) <= mp.mpf(10) ** -45 * abs(known)


@pytest.mark.parametrize("p", [1e-300, 1e-3, 0.25, 1.0])
@pytest.mark.parametrize("m", [1, 5, mp.inf])
def test_archard_is_a_sum_of_powers_where_one_load_maps_to_itself(p, m):
    """D = 3/2, gamma = 4: zeta_n = p^(2^-n), g_n = 2^-n."""
    with mp.workdps(60):
        p, halves = mp.mpf(p), [mp.mpf(2) ** -n for n in range(min(m, TERMS))]
        h = mp.fsum(r * p**r * (1 - r * mp.log(p)) for r in halves)
        R = mp.fsum(-(r**3) * p ** (r - 1) * mp.log(p) for r in halves)
        assert_same(exact.archard(p, 1.5, 4, m), h, R)


def test_archard_of_two_waves():
    """The second wave under a first that is in partial contact."""
    with mp.workdps(60):
        D, gamma, g = mp.mpf(1.25), mp.mpf(5), mp.mpf(5) ** mp.mpf(-0.75)
        p, down = mp.mpf(0.125), gamma ** (1 - D)
        zeta = 2 * down * mp.sqrt(p)
        h = p * (1 - mp.log(p)) + g * zeta * (1 - mp.log(zeta))
        assert_same(exact.archard(p, D, gamma, 2), h, -mp.log(p) - g * mp.log(zeta) * down / mp.sqrt(p))


@pytest.mark.parametrize("p", [1e-300, 1e-3, 0.9, 1.0, 2.0, 30.0])
def test_demelio_is_a_sum_of_single_waves(p):
    """D = 3/2, gamma = 4: p_n* = 2^n, g_n = 2^-n; the infinite sum is that of so many waves that no digit changes."""
    for m in (1, 5, mp.inf):
        with mp.workdps(60):
            waves = [exact.westergaard(p / mp.mpf(2) ** n) for n in range(min(m, TERMS))]
            h = mp.fsum(mp.mpf(2) ** -n * pair[0] for n, pair in enumerate(waves))
            R = mp.fsum(mp.mpf(4) ** -n * pair[1] for n, pair in enumerate(waves))
            assert_same(exact.demelio(p, 1.5, 4, m), h, R)


def test_one_wave_is_flat_at_p_star_and_a_logarithm_steep_below():
    assert_same(exact.westergaard(1.0), 1, 0)
    assert_same(exact.westergaard(2.0), 1, 0)
    with mp.workdps(60):
        assert_same(exact.westergaard(mp.exp(-1)), 2 * mp.exp(-1), 1)
