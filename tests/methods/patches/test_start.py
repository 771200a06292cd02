"""Where loads start from: grids, and contacts that these miss."""

import numpy as np
import pytest

from weier import Profile
from weier.methods import patches, westergaard
from weier.methods.bem.staircase import contact_runs
from weier.methods.patches import start
from weier.methods.patches.gaps import GAPS


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
