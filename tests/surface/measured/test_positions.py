"""Positions: the grid that their digits allow, rows that are left out, and the refusal of two grids."""

import numpy as np
import pytest

from weier.surface.measured.positions import on_grid

N = np.arange(2000)
HEIGHTS = N.astype(float)  # each height tells its number


def place(at):
    return f"height {at + 1}"


def rounded(step, decimals):
    return np.array([float(f"{n * step:.{decimals}f}") for n in N])


def kept(name):
    """Whether each row is left in, for some ways to leave out others."""
    random = np.random.default_rng(3)
    rows = {
        "15 adjacent": slice(700, 715),
        "2 adjacent": slice(1000, 1002),
        "15 at a quarter": slice(500, 515),
        "a tenth": random.choice(N[1:-1], 200, replace=False),
        "a hundredth": random.choice(N[1:-1], 20, replace=False),
    }[name]
    return ~np.isin(N, N[rows])


STEPS = [
    (0.005, 2),
    (5e-4, 2),
    (1e-3, 2),
    (0.0025, 2),
    (7e-4, 2),
    (1 / 3, 1),
    (1 / 6, 1),
    (1 / 6, 2),
    (0.3, 1),
    (1.0, 0),
]
GAPS = ["15 adjacent", "2 adjacent", "15 at a quarter", "a tenth", "a hundredth"]


@pytest.mark.parametrize(("step", "decimals"), STEPS)
def test_rounded_positions_give_their_step_and_no_gap_closes_up(step, decimals):
    x = rounded(step, decimals)
    full, length = on_grid(x, HEIGHTS, None, place)
    np.testing.assert_array_equal(full, HEIGHTS)
    assert length == pytest.approx(2000 * step, rel=5e-5)
    is_exact = step == round(step, decimals) > 10.0**-decimals
    for name in GAPS:
        within = kept(name)
        if is_exact:
            full, length = on_grid(x[within], HEIGHTS[within], None, place)
            np.testing.assert_array_equal(full, np.where(within, HEIGHTS, np.nan))
            assert length == pytest.approx(2000 * step, rel=5e-5)
        else:
            with pytest.raises(ValueError, match="positions must rise in equal steps, got"):
                on_grid(x[within], HEIGHTS[within], None, place)


@pytest.mark.parametrize(("step", "decimals"), [(0.005, 2), (1 / 7, 2), (0.25, 1), (2.5e-3, 3)])
def test_positions_that_are_cut_are_those_of_a_shifted_start(step, decimals):
    x = np.floor(N * step * 10**decimals + 1e-9) / 10**decimals
    full, length = on_grid(x, HEIGHTS, None, place)
    np.testing.assert_array_equal(full, HEIGHTS)
    assert length == pytest.approx(2000 * step, rel=5e-5)


@pytest.mark.parametrize("x", [rounded(0.012, 2), np.delete(N, N[5::10]).astype(float)])
def test_rounding_or_a_row_left_out_again_and_again_is_not_decided(x):
    with pytest.raises(
        ValueError, match=r"positions must rise in equal steps, .* write the positions with more digits"
    ):
        on_grid(x, np.ones(x.size), None, place)


def test_a_step_shorter_than_the_unit_must_have_few_digits():
    """Rows left out from among those of one position give a step of many digits."""
    x = np.array([float(f"{0.005 * n:.1f}") for n in range(60)])
    with pytest.raises(ValueError, match="positions must rise in equal steps"):
        on_grid(np.delete(x, [22, 23, 31]), np.ones(57), None, place)
    with pytest.raises(ValueError, match="positions must rise in equal steps"):
        on_grid(rounded(1 / 7, 0), HEIGHTS, None, place)


def test_a_step_that_few_digits_leave_open_is_refused():
    x = np.array([float(f"{0.29 * n:.1f}") for n in range(200)])
    assert on_grid(x, np.ones(200), None, place)[1] == pytest.approx(58, rel=1e-9)
    with pytest.raises(ValueError, match="positions must rise in equal steps"):
        on_grid(x[:6], np.ones(6), None, place)


@pytest.mark.parametrize(
    "x",
    [
        np.floor(6.073 * N[:20]),  # also of steps of 6
        np.floor(5.926 * N[:14]),
        np.delete(np.round(0.4 * N[:20]), [8, 9]),  # also of steps of 0.5
    ],
)
def test_positions_that_leave_a_range_of_steps_are_refused(x):
    with pytest.raises(ValueError, match="positions must rise in equal steps"):
        on_grid(x, np.ones(x.size), None, place)
    x = np.floor(6.073 * N[:200])
    assert on_grid(x, np.ones(200), None, place)[1] == pytest.approx(200 * 6.073, rel=0.0075)


def test_a_row_left_out_of_positions_with_more_digits_than_the_step_needs_is_missing():
    full, length = on_grid(np.delete(5.0 * N, 1000), np.ones(1999), None, place)
    assert (full.size, length, np.flatnonzero(np.isnan(full)).tolist()) == (2000, 10000.0, [1000])
