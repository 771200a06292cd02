"""Stated errors hold on loads that once exceeded them, or lie where one of their terms is most of them."""

import itertools

import numpy as np
import pytest

import weier
from tests.hard_series import hard_series
from weier import Profile
from weier.methods import patches
from weier.methods.bem import curve


def solve_within_errors(profile, loads, rounding=(1e-13, 1e-11), **settings):
    """Exact curve and that of boundary elements, which must lie within what it states and rounding of h and R."""
    exact, found = patches.curve(profile, loads, 1e-12), curve(profile, loads, **settings)
    of_h, of_R = found.compliance - exact.compliance, found.resistance - exact.resistance
    assert np.all(np.abs(of_h) <= found.compliance_error + rounding[0])
    assert np.all(np.abs(of_R) <= found.resistance_error + rounding[1] * exact.resistance)
    return exact, found


@hard_series("beyond_stated_errors")
def test_errors_hold(profile, loads, points_per_wave, tolerance, contacts, largest):
    for count, residual in itertools.product(points_per_wave, tolerance or [1e-10]):
        exact, found = solve_within_errors(profile, loads, points_per_wave=count, tolerance=residual)
        if largest:
            assert np.abs(found.compliance - exact.compliance).max() < largest[0]
            assert np.abs(found.resistance - exact.resistance).max() < largest[1]
        if contacts == "same":
            assert np.array_equal(found.patch_count, exact.patch_count)


@pytest.mark.parametrize(
    ("D", "gamma", "m", "phases", "load"),
    [(1.508811728881581, 7, 4, 0, 0.0107663), (1.19419083047206, 7, 3, np.pi, 4.4445)],
)
def test_a_residual_is_as_loose_as_errors_hold_and_no_looser(D, gamma, m, phases, load):
    """With 1e-2, R at the first load is off by more than stated; with 1e-3, all nodes touch at the second."""
    profile = Profile(D, gamma, m, phases)
    assert solve_within_errors(profile, [load], tolerance=1e-5)[1].contact_fraction[0] > 0
    with pytest.raises(ValueError, match='at most 1e-05 with edges="subgrid"'):
        weier.solve(profile, [load], "bem", residual_tolerance=1e-4)


@pytest.mark.parametrize("points", [16, 22, 33, 64])
@pytest.mark.parametrize("phase", [0.0, -np.pi / 16, 2.0])
def test_errors_hold_where_the_last_gap_has_few_nodes(points, phase):
    """As the gap of one wave closes, until the grid has no node in it."""
    solve_within_errors(Profile(1.5, 3, 1, (phase,)), np.sort(1 - np.geomspace(0.5, 1e-4, 150)), points=points)


@pytest.mark.parametrize("seed", range(4))
def test_the_verge_of_full_contact_is_within_the_errors(seed):
    """A last gap of one node or none, anywhere between two nodes."""
    random = np.random.default_rng(seed)
    phases = tuple(random.uniform(0, 2 * np.pi, 2))
    profile = Profile(random.uniform(1.05, 1.9), int(random.integers(2, 6)), 2, phases)
    loads = profile.full_contact_load * np.sort(1 - np.geomspace(1e-4, 3e-2, 40))
    assert np.all(solve_within_errors(profile, loads, points_per_wave=32)[1].resistance > 0)


@pytest.mark.parametrize("points_per_wave", [16, 24, 32, 64, 128])
@pytest.mark.parametrize(
    ("D", "birth"), [(1.852, 0.10220486331021063), (1.758, 0.1045682219323272), (1.44, 0.11308763726439561)]
)
def test_a_birth_beside_a_single_contact_is_within_the_errors(D, birth, points_per_wave):
    """Its own errors are a millionth of what its pressure on the grid displaces other crests by."""
    loads = birth * (1 + np.array([-1e-3, -1e-5, 1e-5, 1e-4, 1e-3]))
    exact, found = solve_within_errors(Profile(D, 5, 2), loads, points_per_wave=points_per_wave)
    assert found.resistance_error[0] < 1e-4 * exact.resistance[0]  # away from it they are not wide


def test_errors_hold_where_a_gap_closes_within_a_narrow_contact():
    """On 16 nodes a wave the gap is still open where it has closed, from its merger to 1.003 of that load."""
    profile = Profile(1.376849862291913, "3/2", 3, (-0.08726646259971647, -0.1308996938995747, -0.19634954084936207))
    loads = 0.04017864 * np.array([0.995, 0.998, 1, 1.001, 1.005])
    exact, found = solve_within_errors(profile, loads, points=16 * 9)
    assert (found.patch_count != exact.patch_count).any()


@pytest.mark.parametrize("tolerance", [1e-8, 1e-10])
@pytest.mark.parametrize("points_per_wave", [256, 655])
def test_errors_hold_on_fine_grids_where_residuals_are_much_of_them(points_per_wave, tolerance):
    settings = {"points_per_wave": points_per_wave, "tolerance": tolerance}
    _, found = solve_within_errors(Profile(1.25, 5, 3, (0.0, 1.0, 2.0)), [0.1148, 0.1306, 0.2077], **settings)
    assert found.compliance_error.max() < 2 * tolerance + 5e-7 * (64 / points_per_wave) ** 2


@pytest.mark.parametrize(("D", "gamma"), [(1 + 1e-9, 1000), (1.02, 100)])
@pytest.mark.parametrize("points_per_wave", [32, 64, 128])
def test_errors_hold_where_rounding_of_heights_is_much_of_a_low_wave(D, gamma, points_per_wave):
    profile = Profile(D, gamma, 2, (0.0, 1.0))
    _, found = solve_within_errors(profile, [1e-9, 1e-6, 1e-4], points_per_wave=points_per_wave)
    assert found.resistance_error[0] < 1e-6


PHASES = (-5.6085094352652565, -5.2711714993080925, -1.6235719417825516, -2.4353579126738274)


@pytest.mark.parametrize("points_per_wave", [16, 19, 32, 128])
def test_a_crest_that_the_corrected_plane_reaches_is_a_contact(points_per_wave):
    """Nearly half of one more load goes to it, though on the grid it stands far below the plane."""
    profile = Profile(1.39114069774982, "3/2", 4, PHASES)
    exact, found = solve_within_errors(profile, [0.01043], points_per_wave=points_per_wave)
    assert exact.resistance[0] == pytest.approx(38.32891910641977, rel=1e-9)
    assert found.patch_count[0] == 2
    assert found.resistance[0] == pytest.approx(38.32891910641977, rel=1e-4)


@hard_series("sharing_one_plane")
def test_many_contacts_share_one_plane(profile, loads, points_per_wave, h, R):
    found = curve(profile, loads, points_per_wave=points_per_wave)
    assert abs(found.compliance[0] - h) <= found.compliance_error[0] + 1e-12
    assert abs(found.resistance[0] - R) <= found.resistance_error[0] + 1e-9
    assert found.compliance_error[0] < 2e-5
