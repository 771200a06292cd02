"""Segments and states: strengths at edges, contacts between thin gaps, and numbers of nodes."""

import numpy as np
import pytest

from tests.methods.patches.westergaard_states import OneWave
from weier.methods.patches.contacts import CONTACTS
from weier.methods.patches.gaps import GAPS
from weier.methods.patches.segments import (
    MAX_NODES,
    Cracks,
    coefficient_tails,
    contact_pieces,
    estimate_node_count,
    make_segments,
    more_nodes,
    segment_strengths,
)


def test_contacts_and_strengths_are_those_of_westergaard(wave, dual):
    """p = A s^(1/2), or a slope of 2 pi A s^(1/2) in the gap, which is negative at its right end."""
    state = wave.state(dual)
    (origin, centre, r), strength, tangent = contact_pieces(state, wave.period)
    assert np.mod(origin + centre - wave.crest + 0.5 * wave.period, wave.period) == pytest.approx(0.5 * wave.period)
    assert r == pytest.approx(wave.half_width)
    segments = state.segments
    assert segments.right - segments.middle == pytest.approx(segments.half_width)
    np.testing.assert_allclose(strength, wave.strength, rtol=1e-9)
    np.testing.assert_allclose(tangent, wave.tangent_strength, rtol=1e-9)
    s = 1e-8 * wave.half_width
    assert strength[0, 1] == pytest.approx(
        float(wave.pressure(np.array([wave.half_width - s]))[0]) / s**0.5, rel=1e-6
    )
    right = segment_strengths(state)[0, 1]
    assert right == pytest.approx(-wave.strength if dual else wave.strength, rel=1e-9, abs=0)


def test_thin_gaps_divide_their_contact(period, dual):
    wave, none = OneWave(period, 0.2 * period, 0.3 * period), np.zeros(2)
    t, reach, strength, tangent = np.array([[-0.5, 0.25], [1e-3, 2e-3], [3.0, 5.0], [2.0, 7.0]])
    cracks = Cracks(np.zeros(2, int), t, reach, reach * wave.half_width, strength, tangent, none, none, none)
    (origin, centre, r), at_edges, of_tangent = contact_pieces(wave.state(dual)._replace(cracks=cracks), period)
    left = np.mod(origin + centre - r - (wave.crest - wave.half_width) + 0.01 * period, period) - 0.01 * period
    expected = np.array([[-1, -0.501], [-0.499, 0.248], [0.252, 1]])
    np.testing.assert_allclose(left / wave.half_width, expected[:, 0] + 1, atol=1e-12)
    np.testing.assert_allclose(2 * r / wave.half_width, np.diff(expected, axis=1)[:, 0], rtol=1e-12)
    A = wave.strength
    np.testing.assert_allclose(at_edges, [[A, 3], [3, 5], [5, A]], rtol=1e-9)
    B = wave.tangent_strength
    np.testing.assert_allclose(of_tangent, [[B, 2], [2, 7], [7, B]], rtol=1e-9)


def test_values_at_edges_of_gaps_are_those_of_the_contacts_that_follow():
    """Gap j is on the left of contact j, and the last contact ends at the first gap."""
    values = np.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]])
    np.testing.assert_array_equal(GAPS.at_contacts(values), [[2, 3], [4, 5], [6, 1]])
    np.testing.assert_array_equal(CONTACTS.at_contacts(values), values)


@pytest.mark.parametrize("ratio", [1.01, 1.1, 2.0, 30.0])
def test_nodes_resolve_a_singularity_at_the_edge_of_the_neighbour(ratio, period):
    """(x_0 - t)^(1/2), whose coefficients decay as rho^-k, to within a factor of 30 of the tolerance, not to less."""
    r, tolerance = 0.01 * period, 1e-8
    gap = (ratio - 1) * r
    centre = np.array([0.2 * period, 0.2 * period + 2 * r + gap])
    extent = np.zeros(2), centre, np.full(2, r)
    series = OneWave(period, 0.1 * period, 0.0).series(False)
    count = int(estimate_node_count(extent, series, tolerance)[0])
    k = np.arange(4000)
    t = np.cos(np.pi * (k + 0.5) / 4000)
    value = np.sqrt(ratio - t)
    sizes = np.abs([2 / 4000 * (value * np.cos(n * np.pi * (k + 0.5) / 4000)).sum() for n in range(1, 400)])
    needed = int(np.argmax(sizes < tolerance * sizes[0])) + 1
    assert 0.5 * needed <= count <= 3 * needed + 10


def test_tails_are_the_last_of_two_coefficients_that_are_not_zero_by_themselves():
    segments = make_segments(np.zeros(2, int), np.zeros(2), np.zeros(2), np.ones(2), np.array([5, 6]))
    coefficient = np.array([2.0, 1.0, 1e-3, 0.0, 0.0, -8.0, 0.0, 1e-2, 1.0, 0.0, 0.0])
    np.testing.assert_allclose(coefficient_tails(segments, coefficient), [0.5, 0.125])


def test_more_nodes_are_more_up_to_the_limit():
    """By 1.3, rounded up to even numbers and, from 32 nodes on, to multiples of 4: few tables are needed."""
    count = np.array([4, 10, 40, MAX_NODES - 1])
    for height, expected in (
        (np.full(4, 2.0), [6, 14, 52, MAX_NODES]),
        (2.0 * (count == 10), [4, 14, 40, MAX_NODES - 1]),
    ):
        more, is_more = more_nodes(count, height, 1.0)
        np.testing.assert_array_equal(more, expected)
        assert is_more
    assert not more_nodes(count, np.ones(4), 1.0)[1]
    assert not more_nodes(np.array([MAX_NODES]), np.full(1, 2.0), 1.0)[1]
