"""The kernels by themselves: closed forms against quadrature, the Jacobian against differences."""

import mpmath as mp
import numpy as np
import pytest

from weier import Profile
from weier.methods.patches import chebyshev
from weier.methods.patches.collocation import assemble
from weier.methods.patches.guess import arrange
from weier.methods.patches.segments import moved
from weier.methods.patches.surface import surface_of
from weier.methods.patches.waves import excess, from_summit

COEFFICIENTS = np.array([1.0, -0.4, 0.3, 0.2])


def phi(s):
    return mp.fdot(COEFFICIENTS.tolist(), [1, 2 * s, 4 * s**2 - 1, 8 * s**3 - 4 * s])


@pytest.mark.parametrize("t", [-1.7, -1.001, -0.6, 0.0, 0.3, 1.01, 4.0])
def test_integrals_in_closed_form(t):
    cauchy, slope, potential = chebyshev.integrals(COEFFICIENTS, t)
    ends = [-1, t, 1] if abs(t) < 1 else [-1, 1]
    log = mp.quad(lambda s: mp.sqrt(1 - s * s) * phi(s) * mp.log(abs(t - s)), ends)
    assert potential == pytest.approx(float(log), rel=1e-8)
    if abs(t) < 1:  # the singular part of the density taken out: int ds/(t-s) = ln((1+t)/(1-t))
        at_t = mp.sqrt(1 - t * t) * phi(t)
        rest = mp.quad(lambda s: (mp.sqrt(1 - s * s) * phi(s) - at_t) / (t - s), ends)
        direct = rest + at_t * mp.log((1 + t) / (1 - t))
    else:
        direct = mp.quad(lambda s: mp.sqrt(1 - s * s) * phi(s) / (t - s), ends)
    assert cauchy == pytest.approx(float(direct), rel=1e-7)
    step = 1e-5
    before, after = (chebyshev.integrals(COEFFICIENTS, t + side * step)[0] for side in (-1, 1))
    assert slope == pytest.approx((after - before) / (2 * step), rel=1e-4)


def test_expansion_and_partial_integral():
    s = chebyshev.nodes(7)
    values = np.array([float(phi(x)) for x in s])
    np.testing.assert_allclose(chebyshev.coefficients(values), [*COEFFICIENTS, 0, 0, 0], atol=1e-14)
    assert chebyshev.series(COEFFICIENTS, 0.37) == pytest.approx(float(phi(0.37)))
    part = mp.quad(lambda x: mp.sqrt(1 - x * x) * phi(x), [-1, 0.37])
    assert chebyshev.partial_integral(COEFFICIENTS, 0.37) == pytest.approx(float(part))
    assert chebyshev.weights(7) @ values == pytest.approx(chebyshev.partial_integral(COEFFICIENTS, 1.0))
    logarithm = chebyshev.integrals(COEFFICIENTS, 0.0)[2]
    assert chebyshev.central_logarithm(7) @ values == pytest.approx(logarithm)


def test_heights_near_a_summit_keep_their_digits():
    profile = Profile(1.5, 5, 3, (0.0, 1.0, 2.0))
    heights = surface_of(profile).heights
    highest = int(np.argmax(heights.rise))
    curvature = -excess(heights, highest, 0.0)[2]
    for y in (1e-9, 1e-6):
        value, slope, _ = excess(heights, highest, y)
        # The cubic term, at most y k of the quadratic one.
        assert value == pytest.approx(-0.5 * curvature * y**2, rel=300 * y)
        assert slope == pytest.approx(-curvature * y, rel=300 * y)
    y = 0.173
    value, slope, second = excess(heights, highest, y)
    x = heights.place[highest] + y
    assert value + heights.top == pytest.approx(float(profile.height(x)))
    assert slope == pytest.approx(float(profile.slope(x)))
    assert second == pytest.approx(float(profile.curvature(x)))


@pytest.mark.parametrize("phases", [(0.0, 0.0, 0.0), (1e-17, 0.0, 0.0), (-1e-17, 0.0, 0.0), (0.0, 1.0, 2.0)])
def test_the_nearest_summit(phases):
    """On the periodic line, with a summit at its seam or beside it, against a look at all of them."""
    heights = surface_of(Profile(1.5, 5, 3, phases)).heights
    for x in np.concatenate([np.linspace(-1.2, 1.2, 97), [-1e-18, 1e-18, 1 - 1e-16]]):
        apart = x - heights.place - np.rint(x - heights.place)
        summit, y = from_summit(heights, x)
        assert abs(y) == np.abs(apart).min()
        assert y == apart[summit]


@pytest.mark.parametrize("dual", [False, True])
def test_jacobian_is_the_derivative(dual):
    seen = surface_of(Profile(1.4, "3/2", 3, (0.0, 1.0, 2.0)))
    waves, load = seen.of(dual), 1.3
    placed, _ = arrange(waves, np.array([0, 2]), np.array([0.02, -0.03]), np.array([0.11, 0.2]), np.array([4, 6]))
    rng = np.random.default_rng(1)
    unknowns = rng.normal(size=placed.node.size + 5)
    r = placed.half_width

    def residual(u, p=load):
        centre, half_width = placed.centre + r * u[-5:-3], r * (1 + u[-3:-1])
        there = moved(placed, centre, half_width, waves.period)
        # Rows of height and load are divided by half-widths: take that out.
        right = assemble(there, u[:-5], u[-1], waves, p, dual)[1][:, 0].copy()
        if not dual:
            right[-3:-1] *= half_width
            right[-1] *= half_width.max()
        return right

    unknowns[-5:-1] = 0
    jacobian, right = assemble(placed, unknowns[:-5], unknowns[-1], waves, load, dual)
    if not dual:
        jacobian[-3:-1] *= r[:, None]
        jacobian[-1] *= r.max()
        right[-1] *= r.max()
    step = 1e-6
    for column in range(unknowns.size):
        move = step * np.eye(unknowns.size)[column]
        slope = (residual(unknowns + move) - residual(unknowns - move)) / (2 * step)
        np.testing.assert_allclose(jacobian[:, column], slope, atol=1e-6 * (1 + np.abs(slope).max()))
    slope = (residual(unknowns, load + step) - residual(unknowns, load - step)) / (2 * step)
    np.testing.assert_allclose(right[:, 1], slope, atol=1e-6 * (1 + np.abs(slope).max()))
