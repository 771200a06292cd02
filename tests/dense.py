"""The paper's solver of the discrete problem, by the dense matrix, in the place of the fast one."""

from unittest import mock

import numpy as np
from scipy.linalg import circulant

from benchmarks.solvers.dense import solve_load
from weier.methods import bem
from weier.methods.bem import active_set
from weier.methods.bem.staircase import NodalSolution
from weier.theory.halfplane import influence_coefficients


class DenseSolver:
    """One profile on a grid: each load starts from the contact of the one before."""

    def __init__(self, profile, points, max_residual):
        self.height, self.max_residual = profile.sampled_height(points), max_residual
        self.matrix = circulant(influence_coefficients(points, profile.period))
        self.contact = np.ones(points, bool)

    def solve_discrete(self, load, with_tangent):
        """The solution under a load with its derivative."""
        solved = solve_load(self.matrix, self.height, self.contact, load, self.max_residual)
        self.contact, pressure, tangent = solved.contact, solved.pressure, solved.tangent_pressure
        gap = solved.plane - self.height + self.matrix @ pressure
        unbalanced = abs(pressure.mean() - load) * self.matrix[0, 0]
        residual = max(np.abs(gap[solved.contact]).max(), -gap.min(), unbalanced)
        fields = pressure, gap, tangent, self.matrix @ tangent, solved.contact
        return NodalSolution(solved.plane, solved.resistance, residual, float(solved.rounds), *fields)


def dense_curve(*arguments, **settings):
    """The curve of `bem.curve`, solved by inversion."""
    with mock.patch.object(active_set, "NestedSolver", DenseSolver):
        return bem.curve(*arguments, **settings)
