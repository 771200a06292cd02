"""The number of nodes of a first guess is judged by the coefficients of solutions."""

import numpy as np
import pytest

from benchmarks import node_counts
from weier import Profile
from weier.methods.patches.solver import solve_state
from weier.methods.patches.start import Starts


@pytest.mark.parametrize("load", [0.01, 0.9])  # contacts and gaps
def test_one_wave_needs_the_coefficients_of_its_closed_form(load):
    """p = 2 p_0* cos(pi x) (sin^2(pi a) - sin^2(pi x))^(1/2): the edges of its neighbour set rho."""
    starts = Starts(Profile(1.5, 2, 1), node_counts.TOLERANCE)
    state, _ = solve_state(starts, load * starts.profile.full_contact_load)
    ((one, radians, inverse),) = node_counts.terms(starts, state)
    r = state.segments.half_width[0]
    assert (one, radians) == (1, pytest.approx(2 * np.pi * r))
    assert np.cosh(1 / inverse) == pytest.approx((1 - r) / r)
    (few,), (many,) = node_counts.needed(state, 4), node_counts.needed(state, 8)
    assert 1 <= few < many <= state.coefficient.size - 2  # the last two are 0
    assert many - few == pytest.approx(4 * np.log(10) * inverse, abs=4)  # even degrees only, and a power of k
