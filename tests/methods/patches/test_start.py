"""Where loads start from: grids, and contacts that these miss."""

import numpy as np
import pytest

from weier import Profile
from weier.methods import patches, westergaard
from weier.methods.bem.staircase import contact_runs
from weier.methods.patches import start
from weier.methods.patches.gaps import GAPS
from weier.methods.patches.surface import make_series


def gap_with_a_parabola(at, depth, curvature, n=16):
    """A gap of 1 but for three nodes about a parabola that is lowest beside one of them, at -depth."""
    gap, around = np.ones(n), np.round(at) + np.arange(-1, 2)
    gap[around.astype(int) % n] = 0.5 * curvature * (around - at) ** 2 - depth
    return gap


@pytest.mark.parametrize("at", [5.3, 7.8, 15.6, -0.3])
def test_a_contact_between_nodes_is_on_the_crest_of_a_parabola(at):
    spacing, depth, curvature = 0.25, 1e-3, 0.04
    gap = gap_with_a_parabola(at, depth, curvature)
    (middle,), (half_width,) = start._contacts_between_nodes(gap, np.zeros(16, bool), spacing)
    turns = (middle / spacing - at) / 16
    assert turns == pytest.approx(np.round(turns), abs=1e-12)
    reach = spacing * np.sqrt(2 * depth / curvature)
    assert half_width == pytest.approx(start.NEW_CONTACT_WIDTH * reach)


@pytest.mark.parametrize("load", [1e-12, 1e-6, 1e-3, 0.1])
def test_a_new_contact_has_half_its_final_width_within_a_factor_of_two(load):
    """Westergaard's contact (8), whose crest would stand above the plane by h, the compliance (12)."""
    half_width = np.arcsin(np.sqrt(load)) / np.pi
    overlap = np.sqrt(2 * westergaard.compliance(load)) / (2 * np.pi)  # of the parabola of curvature (2 pi)^2 g_0
    by_hertz = overlap * np.sqrt(2 / (1 - 2 * np.log(np.pi * half_width)))
    assert half_width == pytest.approx(by_hertz, rel=0.03)
    assert 0.5 < half_width / (start.NEW_CONTACT_WIDTH * overlap) < 2


def test_no_contact_is_missed_where_the_crest_is_below_the_plane_or_touches_at_a_node():
    free, contact = np.zeros(16, bool), np.zeros(16, bool)
    contact[6] = True
    assert start._contacts_between_nodes(gap_with_a_parabola(5.3, -1e-3, 0.04), free, 1.0).shape == (2, 0)
    assert start._contacts_between_nodes(gap_with_a_parabola(5.3, 1e-3, 0.04), contact, 1.0).shape == (2, 0)


@pytest.mark.parametrize("period", [1.0, 2.0, 9.0])
@pytest.mark.parametrize(
    ("edges", "merged"),
    [
        ([(0.1, 0.2), (0.15, 0.3), (0.4, 0.5)], [(0.1, 0.3), (0.4, 0.5)]),
        ([(0.4, 0.5), (0.1, 0.35), (0.15, 0.3)], [(0.1, 0.35), (0.4, 0.5)]),  # one within the other
        ([(0.9, 1.05), (0.02, 0.2), (0.4, 0.5)], [(0.4, 0.5), (0.9, 1.2)]),  # across the end of the period
        ([(0.1, 0.2), (0.3, 0.4)], [(0.1, 0.2), (0.3, 0.4)]),
    ],
)
def test_overlapping_intervals_are_merged(edges, merged, period):
    (left, right), (first, last) = (period * np.transpose(values) for values in (edges, merged))
    middle, half_width = start.merge_overlaps(np.stack([0.5 * (left + right), 0.5 * (right - left)]), period)
    np.testing.assert_allclose(middle, 0.5 * (first + last))
    np.testing.assert_allclose(half_width, 0.5 * (last - first))


@pytest.mark.parametrize(
    ("nodes", "runs"),
    [
        ([1, 1, 0, 0, 1, 0, 1], ([4, 6], [4, 8])),
        ([0, 1, 1, 0, 0, 0, 0], ([1], [2])),
        ([1, 0, 0, 0, 0, 0, 0], ([0], [0])),
        ([1, 1, 1, 1], ([], [])),
    ],
)
def test_a_contact_across_the_end_of_the_period_is_counted_on(nodes, runs):
    first, last = contact_runs(np.array(nodes, bool))
    assert (first.tolist(), last.tolist()) == runs


@pytest.mark.parametrize("period", [1.0, 2.0, 9.0])
def test_isolated_contacts_are_hertz_s(period):
    """Two crests of different heights, whose forces obey F_i [1 - 2 ln(pi a_i/L)] - 2 F_j ln|2 sin| = z_i - d."""
    series = make_series(np.array([1.0, 1e-5, 1.0]), [1, 2, 3], np.array([0.0, 1.0, np.pi]), period)
    load = 3e-6 / period
    guess = start.isolated_contacts(series, load)
    crest, a = guess.segments.crest, guess.segments.half_width
    assert crest.size == 2
    force = series.crest_curvature[crest] * a**2 / 4
    assert force.sum() == pytest.approx(load * period, rel=1e-9, abs=0)
    position = series.crest_position[crest]
    other = -2 * np.log(2 * abs(np.sin(np.pi * (position[1] - position[0]) / period)))
    sunk = force * (1 - 2 * np.log(np.pi * a / period)) + force[::-1] * other - series.crest_offset[crest]
    assert sunk[0] == pytest.approx(sunk[1], abs=start.GUESS_TOLERANCE * force.min())
    assert force.max() > 1.5 * force.min()


@pytest.mark.parametrize("period", [1.0, 2.0, 9.0])
def test_isolated_gaps_are_those_of_parabolas_of_tension(period):
    """a^2 = 4 (S - p)/kappa on each crest of the tension."""
    series = make_series(np.array([1.0, 1e-6, 0.5]), [1, 2, 3], np.array([0.0, 1.0, 0.0]), period)
    load = series.maximum - 1e-4
    guess = start.isolated_gaps(series, load)
    (half_width,), (crest,) = guess.segments.half_width, guess.segments.crest
    assert half_width == pytest.approx(2 * np.sqrt(1e-4 / series.crest_curvature[crest]), rel=1e-9, abs=0)
    assert start.isolated_gaps(series, series.maximum * 1.001) is None


def test_many_waves_start_from_a_rougher_grid_and_end_at_the_same_contacts(monkeypatch):
    profile, loads, sizes = Profile(1.25, 5, 4, (0, 1, 1, 1)), [0.3, 2.0], []
    usual, make_grid = patches.curve(profile, loads), start.Starts._make_grid
    monkeypatch.setattr(start, "MANY_WAVES", 125)
    monkeypatch.setattr(start.Starts, "_make_grid", lambda self, n: sizes.append(n) or make_grid(self, n))
    rough = patches.curve(profile, loads)
    assert sizes[0] == min(start.POINTS_PER_WAVE)
    assert np.all(rough.patch_count == usual.patch_count)
    assert np.all(abs(rough.compliance - usual.compliance) <= rough.compliance_error + usual.compliance_error)
    assert np.all(abs(rough.resistance - usual.resistance) <= rough.resistance_error + usual.resistance_error)


@pytest.mark.parametrize(
    ("profile", "load"),
    [
        (Profile(1.331776812957171, 25, 2, (1.4759218287830584, 4.610210342717793)), 2.1840867360023095),
        (Profile(1.9996563120900952, 5, 3, (1.8906146266840476, 2.3211360991711354, 2.6565707882292036)), 18.99409),
    ],
)
def test_a_loose_tolerance_solves_for_the_gaps_that_a_tight_one_solves_for(profile, load):
    """Few nodes hid that these need fewer: contacts took up to three times as long."""
    for tolerance in (1e-4, 1e-10):
        state = patches.solve_load(profile, load, tolerance).state
        assert state is not None
        assert state.kind is GAPS


def test_equations_with_a_plane_are_solved_without_pivoting():
    """A symmetric positive definite matrix, with a row and a column of ones for the plane."""
    random = np.random.default_rng(4)
    for n in (1, 2, 7, 32):
        factor = random.normal(size=(n, n))
        matrix = np.block([[factor @ factor.T + np.eye(n), np.ones((n, 1))], [np.ones((1, n)), np.zeros((1, 1))]])
        right = random.normal(size=n + 1)
        expected = np.linalg.solve(matrix, right)
        np.testing.assert_allclose(start._solve(matrix, right), expected, rtol=1e-9, atol=1e-9)
