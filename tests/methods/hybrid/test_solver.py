"""Resolved terms on the layer: the layer model where one is resolved, and closing in on it as the mesh does."""

import math
from itertools import pairwise

import numpy as np
import pytest

from weier import Profile, random_phases
from weier.methods import hybrid, layer
from weier.methods.hybrid import newton
from weier.methods.hybrid.closure import MAX_LOAD
from weier.methods.hybrid.solver import MIN_LOAD

LOADS = np.geomspace(3e-3, 3, 7)
PROFILE = Profile(1.25, 2, math.inf, random_phases(2))


def test_one_resolved_term_is_the_layer_model_and_converges_to_it():
    """The mesh's own error is of second order: four times less at each halving, and 0.9 g_0/N^2 at most."""
    exact = layer.curve(LOADS, 1.5, 5, math.inf)
    errors = []
    for points in (32, 64, 128):
        found = hybrid.curve(Profile(1.5, 5, math.inf), LOADS, 1, points)
        errors.append(np.abs(found.compliance - exact.compliance).max())
        assert np.all(found.residual <= newton.TOLERANCE)
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
    with pytest.raises(ValueError, match="terms must be fewer, got 7"):
        hybrid.curve(Profile(1.5, 5, math.inf), LOADS, 7)


@pytest.mark.parametrize("load", [1e-300, 0.9e-6, 1.1e3, 1e300])
def test_loads_that_the_equations_do_not_carry_are_refused(load):
    with pytest.raises(ValueError, match=r"must lie in \[1e-06, 1000\] p_0\*.*got .*: take another method"):
        hybrid.curve(PROFILE, [load], 1)


def test_the_heaviest_load_is_full_contact_and_the_lightest_close_to_first():
    """Within the error of the mesh, 9e-4 of a wave, twice as much where a node is all of the contact."""
    profile = Profile(1.25, 5, math.inf)
    loads = [MIN_LOAD, MAX_LOAD]
    found, exact = hybrid.curve(profile, loads, 1), layer.curve(loads, 1.25, 5, math.inf)
    assert found.compliance == pytest.approx(exact.compliance, abs=2e-3)
    assert found.compliance[1] == pytest.approx(profile.total_amplitude, abs=1e-5)
    assert np.all(found.resistance >= 0)
