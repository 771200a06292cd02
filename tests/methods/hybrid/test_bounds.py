"""Bounds on the infinite series from the terms that are resolved."""

import math

import numpy as np

from weier import Profile
from weier.methods import bem, hybrid, patches
from weier.methods.hybrid.solver import MESH_FRACTION
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
