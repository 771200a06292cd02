"""Boundary elements are within their error model, and not by far; plans take their points from it."""

import numpy as np
import pytest

from tests.profiles import THREE_WAVES, half_a_node_off
from weier import Profile, plan, random_phases, solve
from weier.methods import bem, patches

LOADS = np.geomspace(1e-3, 10, 12)


@pytest.mark.parametrize(("D", "gamma", "m"), [(1.25, 5, 2), (1.6, "3/2", 4), (1.9, 3, 3)])
def test_a_crest_between_two_nodes_is_within_the_error_of_the_grid(D, gamma, m):
    """The worst that a grid can miss: the plan does not know the phases when it takes its points."""
    loads, series = np.geomspace(1e-9, 1, 10), Profile(D, gamma, m)
    points = bem.error_model.fewest_points(series, 1e-3, "compliance")
    profile = half_a_node_off(series, points)
    (part, *_) = plan(profile, loads, 1e-3).segments
    assert (part.method, part.settings["points"]) == ("bem", points)
    curve = solve(profile, loads, "planned")
    off = np.abs(curve.compliance - patches.curve(profile, loads).compliance)
    assert off[0] > 0.99 * bem.error_model.compliance_error(profile, points)
    assert np.all(off <= curve.compliance_error)
    assert np.all(off <= 1e-3)


@pytest.mark.parametrize("D", [1.15, 1.6])
@pytest.mark.parametrize("per_wave", [12, 40, 128])
def test_boundary_elements_follow_their_error_model_and_not_by_far(D, per_wave):
    profile = Profile(D, 2, 4, random_phases(3))
    exact = patches.curve(profile, LOADS)
    points = per_wave * profile.waves_per_period[-1]
    error = np.abs(bem.curve(profile, LOADS, points=points, edges="nodes").compliance - exact.compliance).max()
    expected = bem.error_model.compliance_error(profile, points)
    assert expected / 10 < error <= expected


@pytest.mark.parametrize("error", [0.3, 1e-2, 1e-4])
@pytest.mark.parametrize("quantity", ["compliance", "resistance"])
def test_points_are_the_fewest_that_do(quantity, error):
    def error_model(profile, points):
        heavy = np.array([10.0])
        by_resistance = bem.error_model.resistance_error(profile, points, heavy).item()
        return bem.error_model.compliance_error(profile, points) if quantity == "compliance" else by_resistance

    points = bem.error_model.fewest_points(THREE_WAVES, error, quantity)
    waves = THREE_WAVES.waves_per_period[-1]
    assert error_model(THREE_WAVES, points) <= error * (1 + 1e-12)
    # Rounded up to what halves: by 1 in 8 at most, and 1 in 4 of the points is half of the error.
    assert points == 12 * waves or error_model(THREE_WAVES, int(points * 0.75)) > error


@pytest.mark.parametrize("points", [75, 300, 1200, 4800])
def test_a_grid_that_does_not_tell_the_resistance_says_so(points):
    """From a single node in contact to the loads that the error model holds for."""
    profile = half_a_node_off(THREE_WAVES, points)
    light = bem.error_model.light_load(profile, points)
    loads = light * np.geomspace(1e-9, 100, 23)
    grid, exact = bem.curve(profile, loads, points=points, edges="nodes"), patches.curve(profile, loads)
    off = np.abs(grid.resistance - exact.resistance)
    relative = bem.error_model.resistance_error(profile, points, loads)
    assert np.array_equal(np.isinf(relative), loads < light)
    seen = loads >= light
    assert np.all((off <= relative * np.maximum(exact.resistance, 1))[seen])
    expected = bem.error_model.light_resistance_error(profile, points, loads, grid.resistance)[~seen]
    assert np.all(off[~seen] <= expected)
    assert np.all(expected <= 8 * off[~seen].max())
