"""Resolved terms on the layer: the limit of one resolved term is the layer model, and the mesh converges."""

import math
from itertools import pairwise

import numpy as np
import pytest

from weier import Profile, random_phases
from weier.methods import hybrid, layer
from weier.methods.hybrid import newton
from weier.methods.hybrid.closure import MAX_LOAD
from weier.methods.hybrid.method import METHOD
from weier.methods.hybrid.solver import MAX_POINTS, MESH_FRACTION, MIN_LOAD
from weier.methods.layer.solver import ACCURACY

LOADS = np.geomspace(3e-3, 3, 7)
PROFILE = Profile(1.25, 2, math.inf, random_phases(2))


def test_one_resolved_term_is_the_layer_model_and_converges_to_it():
    """The mesh's own error is of second order: four times less at each halving, and 0.9 g_0/N^2 at most."""
    exact = layer.curve(Profile(1.5, 5, math.inf), LOADS)
    errors = []
    for points in (32, 64, 128):
        found = hybrid.curve(Profile(1.5, 5, math.inf), LOADS, 1, points)
        errors.append(np.abs(found.compliance - exact.compliance).max())
        assert np.all(found.residual <= newton.TOLERANCE)
    assert errors[0] < 0.9 / 32**2
    orders = [math.log2(coarse / fine) for coarse, fine in pairwise(errors)]
    assert min(orders) > 1.7, errors
    assert errors[-1] < 1.5 / 128**2 + 1e-5  # the layer's own tables
    # The slope of both curves, where neither is close to 0.
    assert found.resistance[:-1] == pytest.approx(exact.resistance[:-1], rel=0.05)


def test_resistance_is_the_slope_of_the_estimate():
    """To the step, since nodes come into contact on the way."""
    step = 1e-4
    loads = np.array([0.1 * (1 - step), 0.1, 0.1 * (1 + step)])
    found = hybrid.curve(PROFILE, loads, 2)
    slope = (found.compliance[2] - found.compliance[0]) / (loads[2] - loads[0])
    assert found.resistance[1] == pytest.approx(slope, rel=step)
    assert np.all(np.diff(found.resistance) < 0)


def test_what_is_not_infinite_or_too_long_is_refused():
    with pytest.raises(ValueError, match="m = inf, got m = 3"):
        hybrid.curve(Profile(1.5, 5, 3), LOADS, 1)
    with pytest.raises(ValueError, match="m = inf, got m = 3"):
        hybrid.bounds(Profile(1.5, 5, 3), LOADS, 1)
    for terms, says in ((7, "terms must be fewer, got 7"), (900, "m = 900 exceeds: take fewer terms")):
        with pytest.raises(ValueError, match=says):
            hybrid.curve(Profile(1.5, 5, math.inf), LOADS, terms)


@pytest.mark.parametrize("load", [1e-300, 0.9e-6, 1.1e3, 1e300])
def test_loads_that_the_equations_do_not_carry_are_refused(load):
    with pytest.raises(ValueError, match=r"must lie in \[1e-06, 1000\] p_0\*.*got .*: take another method"):
        hybrid.curve(PROFILE, [load], 1)


def test_the_heaviest_load_is_full_contact_and_the_lightest_close_to_first():
    """Within the error of the mesh, 9e-4 of a wave, twice as much where a node is all of the contact."""
    profile = Profile(1.25, 5, math.inf)
    loads = [MIN_LOAD, MAX_LOAD]
    found, exact = hybrid.curve(profile, loads, 1), layer.curve(Profile(1.25, 5, math.inf), loads)
    assert found.compliance == pytest.approx(exact.compliance, abs=2e-3)
    assert found.compliance[1] == pytest.approx(profile.total_amplitude, abs=1e-5)
    assert np.all(found.resistance >= 0)


# Of random series: on a mesh of 32 points a wave their estimates lie outside the bounds.
LARGE_RATIOS = [(1.1214, 1000, 255, 0.016583), (1.0831, 5505, 1, 3e-5), (1.21, 8077, 2, 1e-3)]


@pytest.mark.parametrize(("D", "gamma", "seed", "load"), LARGE_RATIOS)
def test_the_mesh_resolves_what_the_layer_adds_where_the_ratio_is_large(D, gamma, seed, load):
    """The layer has a thousandth of the height of the first wave, and a mesh of 32 points as large an error."""
    profile = Profile(D, gamma, math.inf, random_phases(seed))
    kept, loads = profile.truncated(1), load * np.array([0.5, 1.0, 2.0])
    found, exact = hybrid.curve(profile, loads, 1), layer.curve(Profile(D, gamma, math.inf), loads)
    error = np.abs(found.compliance - exact.compliance)
    assert np.all(error < MESH_FRACTION * kept.tail_amplitude + ACCURACY * exact.compliance)
    assert np.all(found.compliance > found.compliance_lower)  # inside, not cut off at the bounds
    assert np.all(found.compliance < found.compliance_upper)
    assert found.resistance == pytest.approx(exact.resistance, rel=0.15)  # one to ten nodes touch


def test_an_estimate_is_within_its_bounds_on_any_mesh():
    """One that misses first contact by ten times what the layer adds: the nearest bound is the better estimate."""
    profile = Profile(1.05, 1e4, math.inf, random_phases(1))
    loads = np.geomspace(1e-5, 1, 20)
    coarse, fine = hybrid.curve(profile, loads, 1, 16), hybrid.curve(profile, loads, 1)
    assert np.any(coarse.compliance == coarse.compliance_lower)
    assert np.all(coarse.compliance >= coarse.compliance_lower)
    assert np.all(coarse.compliance <= coarse.compliance_upper)
    assert np.all(np.abs(coarse.compliance - fine.compliance) <= coarse.compliance_upper - coarse.compliance_lower)


# Of random series: Newton's method diverges if it starts from full contact on the half-plane without the layer.
SMALL_RATIOS = [(1.7747, 1.01), (1.37, 1.0106), (1.98, 1.27), (1.04, 1.03)]


@pytest.mark.parametrize("loads", [np.geomspace(1e-3, 500, 20), [0.1], np.geomspace(1e-6, 1e3, 7)])
@pytest.mark.parametrize(("D", "gamma"), SMALL_RATIOS)
def test_ratios_close_to_1_put_hundreds_of_waves_into_the_layer(D, gamma, loads):
    """The layer is far softer than the first wave, which is pressed flat on it at once."""
    found, exact = (
        hybrid.curve(Profile(D, gamma, math.inf), loads, 1),
        layer.curve(Profile(D, gamma, math.inf), loads),
    )
    assert found.compliance == pytest.approx(exact.compliance, rel=1e-5, abs=2e-3)
    assert np.all(found.residual <= newton.TOLERANCE)


def test_expected_seconds_follow_the_nodes_of_the_terms():
    """Newton's method takes them for each node and load, up to the most nodes that are solved."""
    profile = Profile(1.25, 5, math.inf)

    def seconds(terms, count):
        return METHOD.seconds(profile, np.ones(count), terms=terms)

    of_load = [seconds(terms, 40) - seconds(terms, 20) for terms in (1, 2, 3, 4, 9, 900)]
    nodes = [32, 160, 800, 4000, MAX_POINTS, MAX_POINTS]
    np.testing.assert_allclose(np.diff(of_load), 20 * hybrid.SECONDS[2] * np.diff(nodes), rtol=1e-9, atol=1e-12)
    assert METHOD.seconds(profile, np.ones(20)) == seconds(3, 20)
