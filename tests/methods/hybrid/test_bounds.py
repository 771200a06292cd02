"""Bounds on the infinite series from the terms that are resolved."""

import math

import numpy as np
import pytest

from weier import ConvergenceError, Profile
from weier.methods import bem, hybrid, patches
from weier.methods.bem.active_set import NestedSolver
from weier.methods.errors import OutOfReachError
from weier.methods.hybrid.solver import MESH_FRACTION, HybridCurve
from weier.surface.profile import RandomPhases


class OnePlace(RandomPhases):
    """Crests of all waves at one place: `seed` nodes in a period, half of a node from the first."""

    def first(self, m):
        """Phases of m waves."""
        return -math.pi / self.seed * 5.0 ** np.arange(m)


def test_bounds_hold_for_crests_between_two_nodes():
    """The infinite series with all its crests at that place touches at h = 0, and no bound lies below."""
    kept = Profile(1.25, 5, 2)
    points = bem.points_of(kept, tolerance=MESH_FRACTION * kept.tail_amplitude)
    lower, upper = hybrid.bounds(Profile(1.25, 5, math.inf, OnePlace(points)), [1e-9, 1.0], 2)
    exact = patches.curve(Profile(1.25, 5, 4, OnePlace(points)), np.array([1e-9, 1.0])).compliance
    assert np.all(lower <= exact)
    assert lower[0] == 0
    assert np.all(upper > exact)


def test_bounds_that_take_too_many_points_are_refused_by_the_number_of_terms():
    with pytest.raises(OutOfReachError, match="terms must be fewer, got 9"):
        hybrid.bounds(Profile(1.25, 5, math.inf), [0.1], 9)


def test_a_load_that_does_not_converge_is_refused_in_terms_of_the_hybrid(monkeypatch):
    """Boundary elements propose another grid, which is not a setting here."""
    stopped = NestedSolver.solve_each

    def stop(*arguments):
        return (solution._replace(residual=1e-3) for solution in stopped(*arguments))

    monkeypatch.setattr(NestedSolver, "solve_each", stop)
    with pytest.raises(ConvergenceError, match=r"2 resolved terms stopped at .* resolve fewer terms") as refused:
        hybrid.bounds(Profile(1.25, 5, math.inf), [0.1], 2)
    assert refused.value.residual == 1e-3
    assert "points" not in str(refused.value)


def test_the_distance_to_the_bounds_is_that_to_the_farther_one():
    """No series between the bounds is farther from the estimate."""
    none = np.zeros(3)
    curve = HybridCurve(np.array([0.1, 0.5, 0.2]), none, np.array([0.0, 0.1, 0.2]), np.array([0.4, 0.6, 0.2]), none)
    np.testing.assert_allclose(curve.distance_to_bounds, [0.3, 0.4, 0.0], rtol=1e-12)
