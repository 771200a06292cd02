"""Positions: the length of steps that are rounded, and rows that are left out."""

import numpy as np
import pytest

from weier.surface.measured.lines import length_of_steps

N = np.arange(2000)


def length(x):
    return length_of_steps(np.asarray(x, float), None)


def rounded(step, decimals, cut=False):
    scaled = N * step * 10**decimals
    return (np.floor(scaled + 1e-9) if cut else np.round(scaled)) / 10**decimals


def is_refused(x):
    try:
        return not length(x)
    except ValueError as error:
        return "positions must rise in equal steps, got" in str(error)


@pytest.mark.parametrize("cut", [False, True])
@pytest.mark.parametrize(("step", "decimals"), [(0.005, 3), (1 / 3, 1), (1 / 6, 2), (0.3, 1), (1.0, 0), (6.073, 0)])
def test_rounded_positions_give_their_length_and_no_gap_closes_up(step, decimals, cut):
    x = rounded(step, decimals, cut)
    assert length(x) == pytest.approx(2000 * step, rel=5e-5)
    random = np.random.default_rng(3)
    for gone in (slice(700, 715), 1000, 1, 1998, slice(5, None, 10), random.choice(N[1:-1], 20, replace=False)):
        assert is_refused(np.delete(x, N[gone]))


def test_a_row_left_out_never_passes_where_all_rows_pass():
    """Of few rows, whose step the rounding moves, and of any ratio of step and rounding."""
    passed = 0
    for step in np.linspace(1.01, 20, 150):
        for rows in (16, 30):
            x = np.round(step * np.arange(rows))
            if not is_refused(x):
                passed += 1
                assert length(x) == pytest.approx(rows * step, abs=1)
                assert all(is_refused(np.delete(x, at)) for at in range(1, rows - 1))
    assert passed > 150


def test_a_length_must_be_that_of_the_positions():
    x = 5.0 * np.arange(200)
    assert [length_of_steps(x, length) for length in (1000.0, 999.0)] == [1000, 999]  # the latter is rounded
    with pytest.raises(ValueError, match=r"length must be that of 200 steps .* about 1000, got 900"):
        length_of_steps(x, 900.0)


def test_positions_in_more_digits_must_be_equal_steps():
    for uneven in (0.39 * (N % 2), 0.19 * np.random.default_rng(0).uniform(-1, 1, N.size), N * N / N.size**2):
        assert is_refused(np.round(5.0 * (N + uneven), 6))
    assert not is_refused(np.float32(0.1) * N.astype(np.float32))
    assert not is_refused(np.linspace(0, 1, N.size))


def test_steps_that_rounding_hides_are_refused():
    assert not is_refused(np.round(2.7 * np.arange(200)))
    assert is_refused(np.round(2.7 * np.arange(16)))  # too few for a length within 0.75 %
    for x in (
        rounded(0.005, 2),
        rounded(0.012, 2),
        np.zeros(100),
        np.full(100, np.nan),
        N[::-1],
        np.where(N == 9, np.nan, N),
    ):
        assert is_refused(x)
