"""The staircase of boundary elements: its constants, what is left of it, and where edges are in their steps."""

from functools import cache

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import zeta

from tests.reference import REFERENCES
from weier import Profile
from weier.accuracy.cosines import Cosines
from weier.methods import patches, westergaard
from weier.methods.bem import curve, staircase
from weier.methods.bem.active_set import NestedSolver
from weier.theory.halfplane import eigenvalues, influence_coefficients


def relative(found, resistance):
    """Errors of a resistance, relative from 1e-3 on, absolute below."""
    return np.abs(found - resistance) / np.where(resistance > 1e-3, resistance, 1)


@cache
def errors_of_references(per_wave, **settings):
    """Errors of h and R where a grid can see the contact, which a lighter load has on a single node."""
    h, R = [], []
    for reference in REFERENCES:
        seen = reference.above(1e-3)
        found = curve(
            seen.profile, seen.mean_pressure, points=per_wave * seen.profile.waves_per_period[-1], **settings
        )
        assert np.all(np.abs(found.compliance - seen.compliance) <= found.compliance_error)
        assert np.all(np.abs(found.resistance - seen.resistance) <= found.resistance_error)
        h += list(np.abs(found.compliance - seen.compliance))
        R += list(relative(found.resistance, seen.resistance))
    return np.array(h), np.array(R)


@pytest.mark.parametrize(
    ("per_wave", "h", "R"), [(16, 5e-4, 2e-2), (32, 8e-5, 5e-3), (64, 1.2e-5, 1.2e-3), (128, 2e-6, 3e-4)]
)
def test_the_accuracy_is_what_was_measured(per_wave, h, R):
    """Medians, of which the limits are about twice, for other machines."""
    compliance, resistance = errors_of_references(per_wave)
    print(f"{per_wave}: h {np.median(compliance):.1e}, R {np.median(resistance):.1e}")
    assert np.median(compliance) < h
    assert np.median(resistance) < R


def test_with_its_staircase_the_compliance_converges_almost_as_the_square_of_the_grid():
    """The largest error and its fifteenth, as docs/numerics.md states them."""
    coarse, fine = (errors_of_references(per_wave, staircase="kept")[0].max() for per_wave in (64, 256))
    assert f"{coarse:.1e}" == "6.2e-04"
    assert coarse / fine == pytest.approx(15, rel=0.1)


def test_without_its_staircase_a_grid_is_ten_times_as_accurate():
    removed, kept = (errors_of_references(64, staircase=setting) for setting in ("removed", "kept"))
    assert np.median(removed[0]) < np.median(kept[0]) / 10
    assert np.median(removed[1]) < np.median(kept[1]) / 5
    assert removed[0].max() < kept[0].max()


def test_the_edge_of_a_punch_is_that_of_wiener_and_hopf():
    """The factor of 2 sin(theta/2) times the symbol: 1/4 - 1/2 of an integral."""

    def symbol(kappa):
        return np.sin(np.pi * kappa) ** 2 / np.pi**2 * (zeta(3, kappa) + zeta(3, 1 - kappa))

    def integrand(kappa):
        return np.log(symbol(kappa) * np.sin(np.pi * kappa) / np.pi) / np.sin(np.pi * kappa) ** 2

    assert pytest.approx(0.25 - quad(integrand, 1e-6, 0.5)[0] / 2, abs=1e-6) == staircase.EDGE_OFFSET


def test_constants_of_single_nodes_are_those_of_the_influence_matrix():
    points = 2**14
    stiffness = np.fft.irfft(np.concatenate([[0], 1 / eigenvalues(points, points)[1:]]), points)
    assert -stiffness[1] / stiffness[0] == pytest.approx(staircase.TRANSFERRED_FRACTION, abs=1e-7)
    influence = influence_coefficients(points) * points  # of a unit force on the nodes of a period
    assert 2 / (influence[0] - influence[1]) == pytest.approx(staircase.SINGLE_NODE_SQUARE, abs=1e-6)


def test_one_wave_has_no_staircase_left():
    """The compliance is off by O(N^-3), and the resistance by O(N^-2) at least, where the contact has many nodes."""
    loads = np.linspace(0.2, 0.8, 61)
    errors = []
    for points in (64, 128):
        found = curve(Profile(1.25, 5, 1, (0.3,)), loads, points=points, max_residual=1e-13)
        of_h = np.abs(found.compliance - westergaard.compliance(loads)).max()
        of_R = np.abs(found.resistance - westergaard.resistance(loads)).max()
        errors.append((of_h, of_R))
    (h, R), (finer_h, finer_R) = errors
    print(f"h {h:.1e}, {finer_h:.1e}; R {R:.1e}, {finer_R:.1e}")
    assert finer_h < h / 6
    assert finer_R < R / 3
    assert finer_h < 2e-6


def edge_deviation(profile, found, exact):
    """Largest distance between edges of the same load, in the finest waves."""
    period = float(profile.period)
    apart = (found[~np.isnan(found)] - exact[~np.isnan(exact)] + period / 2) % period - period / 2
    return np.abs(apart).max(initial=0.0) * profile.waves_per_period[-1] / period


@pytest.mark.parametrize(("per_wave", "deviation"), [(32, 1e-2), (128, 1.5e-3)])
def test_edges_of_contact_are_a_fraction_of_a_node_from_those_of_the_continuum(per_wave, deviation):
    """At four of five loads: beside births and mergers they move as a root."""
    profile, loads = Profile(1.25, 5, 3, (0.0, 1.0, 2.0)), np.geomspace(1e-3, 1.5, 20)
    exact, found = patches.curve(profile, loads), curve(profile, loads, points=per_wave * 25)
    assert found.patch_count.tolist() == exact.patch_count.tolist()
    pairs = zip(found.contact_edge, exact.contact_edge, strict=True)
    assert np.quantile([edge_deviation(profile, *pair) for pair in pairs], 0.8) < deviation
    assert np.abs(found.contact_fraction - exact.contact_fraction).max() < deviation


def test_a_gap_of_a_node_that_the_continuum_has_not_is_closed():
    """Where two contacts merge, the grid keeps the last node apart for too long."""
    profile, load = Profile(1.23663, "3/2", 2, (np.pi, np.pi)), np.array([0.82839])
    exact, found = patches.curve(profile, load), curve(profile, load, points=96)
    assert curve(profile, load, points=96, staircase="kept").patch_count.tolist() == [3]
    assert found.patch_count.tolist() == exact.patch_count.tolist() == [1]
    assert edge_deviation(profile, found.contact_edge[0], exact.contact_edge[0]) < 1e-2


def test_contacts_merge_across_the_end_of_the_period():
    """The gap at node 0 of 10 closes."""
    nodes, edge = (np.array([1, 8]), np.array([6, 9])), np.array([0.5, 6.5, 7.5, 9.5])
    first, last, merged = staircase._merge(*nodes, 10, edge, np.array([False, True]))
    assert (first.tolist(), last.tolist(), merged.tolist()) == ([8], [16], [7.5, 16.5])


def test_edges_that_stay_on_nodes_are_half_a_node_beyond_the_last():
    """Also of a contact that begins at node 0, whose left edge lies in the period."""
    middle = round(512 * float(westergaard.contact_half_width(0.3)))
    for node in (0, middle):
        profile = Profile(1.25, 5, 1, (-2 * np.pi * node / 512,))
        left, right = curve(profile, [0.3], points=512, staircase="kept").contact_edge[0] * 512
        assert (left - node + 512.0, right - node) == pytest.approx(
            (1024 - middle - 0.5, 512 + middle + 0.5), abs=1e-9
        )


THREE_TO_A_PERIOD = 130 / 3  # nodes of each of three equal waves, which lie 0, 1/3 and -1/3 of a node off the grid


@pytest.mark.parametrize("fraction", [0.1, 0.4, 0.7])
@pytest.mark.parametrize("shift", [0.0, 0.25])
def test_a_contact_of_one_node_is_hertzs(fraction, shift):
    """Width and middle, from a load that is this fraction of the load at which the next node touches."""
    points = 64
    profile = Profile(1.25, 5, 1, (-2 * np.pi * shift / points,))
    grid = NestedSolver(profile, points, 1e-12)
    load = fraction * np.pi**2 / (2 * np.log(2) * points**2) / 2
    _, _, first, last, (left, right) = staircase.in_continuum(grid.solve_discrete(load, True))
    assert first.tolist() == last.tolist() == [0]
    half_width = np.arcsin(np.sqrt(load)) / np.pi * points
    assert 0.5 * (right - left) == pytest.approx(half_width, rel=0.02 + shift**2)
    assert 0.5 * (right + left) == pytest.approx(shift, abs=0.01)


def test_each_contact_of_one_node_is_beside_it_as_its_crest_is():
    """The higher a node, the more of the load its contact takes."""
    load = 0.4 * np.pi**2 / (2 * np.log(2) * THREE_TO_A_PERIOD**2) / 2
    grid = NestedSolver(Cosines(np.ones(1), [3]), 130, 1e-12)
    _, _, first, last, edge = staircase.in_continuum(grid.solve_discrete(3 * load, True))
    assert first.tolist() == last.tolist() == [0, 43, 87]
    left, right = edge.reshape(-1, 2).T
    half_width = np.arcsin(np.sqrt(load)) / np.pi * THREE_TO_A_PERIOD
    assert 0.5 * (right - left) == pytest.approx(half_width, rel=0.1)
    assert 0.5 * (right + left) == pytest.approx(np.arange(3) * THREE_TO_A_PERIOD, abs=0.02)


@pytest.mark.parametrize("width", [0.3, 0.4, 0.5])
def test_gaps_of_one_node_are_cracks(width):
    """Half-widths and middles, in nodes, of the last gaps, whose troughs are beside nodes."""
    load = np.cos(np.pi * width / THREE_TO_A_PERIOD) ** 2
    grid = NestedSolver(Cosines(np.ones(1), [3], np.pi), 130, 1e-12)
    _, _, first, _, edge = staircase.in_continuum(grid.solve_discrete(3 * load, True))
    assert sorted(first % 130) == [1, 44, 88]
    start, end = edge.reshape(-1, 2).T
    gap = np.append(start[1:], start[0] + 130) - end
    middle = (np.append(start[1:], start[0] + 130) + end) / 2
    assert 0.5 * gap == pytest.approx(width, abs=0.01)
    nearest = np.rint(middle / THREE_TO_A_PERIOD) * THREE_TO_A_PERIOD
    assert middle == pytest.approx(nearest, abs=2e-3)


@pytest.mark.parametrize("width", [0.5, 0.9])
def test_a_gap_of_one_node_may_be_nearly_two_nodes_wide(width):
    """Its half-width, from a trough on the node, also where less than half of the step has passed."""
    load = np.cos(np.pi * width / 64) ** 2
    solution = NestedSolver(Profile(1.25, 5, 1), 64, 1e-12).solve_discrete(load, True)
    _, _, first, last, edge = staircase.in_continuum(solution)
    assert (first.tolist(), last.tolist()) == ([33], [95])
    assert 0.5 * (edge[0] + 64 - edge[1]) == pytest.approx(width, abs=5e-3)


def test_in_full_contact_all_is_known():
    found = curve(Profile(1.25, 5, 2, 1.0), [0.01, 0.3, 10.0])
    assert np.all(found.compliance_error[:2] > 1e-6)
    assert np.all(found.resistance_error[:2] > 1e-3)
    assert found.compliance_error[2] < 1e-13
    assert found.resistance_error[2] == found.resistance[2] == found.patch_count[2] == 0
    assert found.contact_fraction[2] == 1


def test_a_mirrored_profile_has_mirrored_edges_and_the_same_numbers():
    """Contacts and gaps of one node among them: from the right as from the left."""
    phases = 0.4, 2.1, 5.0
    one, other = Profile(1.6, 3, 3, phases), Profile(1.6, 3, 3, [-phi for phi in phases])
    loads = np.linspace(0.05, 0.95, 40) * one.full_contact_load
    found, mirrored = (curve(profile, loads, points=12 * 9, max_residual=1e-12) for profile in (one, other))
    np.testing.assert_allclose(found.compliance, mirrored.compliance, atol=1e-10)
    np.testing.assert_allclose(found.resistance, mirrored.resistance, atol=1e-7)
    np.testing.assert_array_equal(found.patch_count, mirrored.patch_count)
    np.testing.assert_allclose(found.contact_fraction, mirrored.contact_fraction, atol=1e-6)


def test_contact_is_full_or_has_a_resistance():
    """Where the last gap is a node that has closed, nothing is left of mean gap and resistance."""
    profile = Profile(1.69, 2, 2, (0.0, 0.7))
    loads = np.linspace(0.97, 1.0, 40) * profile.full_contact_load
    found = curve(profile, loads, points=16 * 2)
    full = found.patch_count == 0
    assert np.all((found.resistance == 0) == full)
    assert np.all(found.compliance[full] == pytest.approx(profile.total_amplitude, rel=1e-14))
    assert full[:-1].any()
