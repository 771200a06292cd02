"""The Jacobian against differences of the residual, and both against their products without a matrix."""

import numpy as np
import pytest

from weier import Profile
from weier.methods.patches.collocation import assemble
from weier.methods.patches.defect_correction import change_of, products, residuals
from weier.methods.patches.initial_guess import Intervals, sort_segments
from weier.methods.patches.segments import move_segments
from weier.methods.patches.surface import surface_of


@pytest.mark.parametrize("dual", [False, True])
def test_jacobian_is_the_derivative(dual):
    series, load = surface_of(Profile(1.4, "3/2", 3, (0.0, 1.0, 2.0))).series(dual), 1.3
    crest, centre, half_width = np.array([0, 2]), np.array([0.02, -0.03]), np.array([0.11, 0.2])
    segments, _ = sort_segments(series, Intervals(crest, centre, half_width), node_count=np.array([4, 6]))
    rng = np.random.default_rng(1)
    unknowns = rng.normal(size=segments.node.size + 5)
    r = segments.half_width

    def residual(u, p=load):
        centre, half_width = segments.centre + r * u[-5:-3], r * (1 + u[-3:-1])
        moved = move_segments(segments, centre, half_width, series.period)
        # The equations of height and of load are divided by half-widths: undo that.
        right_side = assemble(moved, u[:-5], u[-1], series, p, dual)[1][:, 0].copy()
        if not dual:
            right_side[-3:-1] *= half_width
            right_side[-1] *= half_width.max()
        return right_side

    unknowns[-5:-1] = 0
    jacobian, right_side = assemble(segments, unknowns[:-5], unknowns[-1], series, load, dual)
    if not dual:
        jacobian[-3:-1] *= r[:, None]
        jacobian[-1] *= r.max()
        right_side[-1] *= r.max()
    step = 1e-6
    for column in range(unknowns.size):
        change = step * np.eye(unknowns.size)[column]
        slope = (residual(unknowns + change) - residual(unknowns - change)) / (2 * step)
        np.testing.assert_allclose(jacobian[:, column], slope, atol=1e-6 * (1 + np.abs(slope).max()))
    slope = (residual(unknowns, load + step) - residual(unknowns, load - step)) / (2 * step)
    np.testing.assert_allclose(right_side[:, 1], slope, atol=1e-6 * (1 + np.abs(slope).max()))


@pytest.mark.parametrize("dual", [False, True])
def test_products_without_a_matrix(dual):
    series, load = surface_of(Profile(1.4, 5, 3, (0.0, 1.0, 2.0))).series(dual), 0.7
    rng = np.random.default_rng(2)
    crest, half_width = np.array([0, 2, 5]), np.array([0.01, 0.02, 1e-7])
    segments, _ = sort_segments(series, Intervals(crest, np.zeros(3), half_width), node_count=np.array([5, 8, 4]))
    phi = rng.normal(size=segments.node.size)
    jacobian, right_side = assemble(segments, phi, 0.3, series, load, dual)
    direction = rng.normal(size=jacobian.shape[0])
    row = residuals(segments, phi, 0.3, series, load, dual)
    np.testing.assert_allclose(row, right_side[:, 0], rtol=1e-11, atol=1e-13 * np.abs(row).max())
    row, expected = products(segments, phi, series, dual, change_of(direction, 3)), jacobian @ direction
    np.testing.assert_allclose(row, expected, rtol=1e-10, atol=1e-13 * np.abs(expected).max())
