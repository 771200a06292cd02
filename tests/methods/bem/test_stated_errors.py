"""Boundary elements are within their error models, and not by far."""

from itertools import product

import numpy as np
import pytest

from tests.hard_series import hard_series
from tests.profiles import THREE_WAVES
from weier import Profile, random_phases
from weier.methods import bem, patches, westergaard
from weier.methods.errors import OutOfReachError

LOADS = np.geomspace(1e-3, 10, 12)


@pytest.mark.parametrize("error", [0.3, 1e-2, 1e-4])
def test_points_are_the_fewest_that_do(error):
    points = bem.stated_errors.fewest_points(THREE_WAVES, error)
    waves = THREE_WAVES.waves_per_period[-1]
    assert bem.stated_errors.compliance_error(THREE_WAVES, points) <= error * (1 + 1e-12)
    # Rounded up to what halves: by 1 in 8 at most, and 3 in 4 of the points leave a larger error.
    assert points == 12 * waves or bem.stated_errors.compliance_error(THREE_WAVES, int(points * 0.75)) > error


def test_a_tolerance_is_met_on_fine_grids_as_far_as_rounding_allows():
    """On 70 000 nodes for a wave, whose rounding is above a thousandth of a tolerance of 2e-10."""
    loads, one_wave = np.array([0.1, 0.6]), Profile(1.25, 5, 1)
    found = bem.METHOD.solve(one_wave, loads, tolerance=1e-9)
    assert found.points > 60_000
    assert np.all(found.compliance_error <= 1e-9)
    assert np.all(np.abs(found.compliance - westergaard.compliance(loads)) <= found.compliance_error)
    with pytest.raises(OutOfReachError, match="inf points for a tolerance of 2e-10 g_0"):
        bem.METHOD.solve(one_wave, loads, tolerance=2e-10)


@pytest.mark.parametrize("profile", [Profile(1.4, "5/2", 4, random_phases(3)), Profile(1.1, 2, 5, 0.0)])
def test_the_largest_curvature_is_bounded_by_samples(profile):
    """In radians of the finest wave, by samples that are far denser."""
    waves = profile.waves_per_period[-1]
    x = np.linspace(0, float(profile.period), 2000 * waves + 1)
    largest = np.abs(profile.curvature(x)).max() * (float(profile.period) / (2 * np.pi * waves)) ** 2
    assert largest <= bem.stated_errors.curvature(profile) * (1 + 1e-12) <= 1.021 * largest


@hard_series("beyond_stated_errors")
def test_errors_are_within_those_stated(profile, loads, points_per_wave, tolerance):
    loads = np.unique(loads)
    exact = patches.curve(profile, loads)
    for per_wave, residual in product(points_per_wave, tolerance or [1e-10]):
        found = bem.curve(profile, loads, per_wave * profile.waves_per_period[-1], residual)
        for quantity in ("compliance", "resistance"):
            (value, error), (right, off) = (
                (getattr(c, quantity), getattr(c, f"{quantity}_error")) for c in (found, exact)
            )
            assert np.all(np.abs(value - right) <= error + off)


@hard_series("sharing_one_plane")
def test_errors_of_hundreds_of_contacts_are_within_those_stated(profile, loads, points_per_wave, h, R):
    found = bem.curve(profile, loads, points_per_wave * profile.waves_per_period[-1])
    assert abs(found.compliance[0] - h) <= found.compliance_error[0]
    assert abs(found.resistance[0] - R) <= found.resistance_error[0]
