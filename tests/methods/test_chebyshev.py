"""Closed forms against quadrature in higher precision."""

import mpmath as mp
import numpy as np
import pytest
from scipy.special import eval_chebyt, eval_chebyu, roots_chebyt, roots_chebyu

from weier.methods import chebyshev

COEFFICIENTS = np.array([1.0, -0.4, 0.3, 0.2])


def density(s):
    return mp.fdot(COEFFICIENTS.tolist(), [1, 2 * s, 4 * s**2 - 1, 8 * s**3 - 4 * s])


@pytest.mark.parametrize("t", [-1.7, -1.001, -0.6, 0.0, 0.3, 1.01, 4.0])
def test_closed_forms_of_integrals_agree_with_quadrature(t):
    cauchy, potential = chebyshev.cauchy_integral(COEFFICIENTS, t), chebyshev.log_integral(COEFFICIENTS, t)
    ends = [-1, t, 1] if abs(t) < 1 else [-1, 1]
    log = mp.quad(lambda s: mp.sqrt(1 - s * s) * density(s) * mp.log(abs(t - s)), ends)
    assert potential == pytest.approx(float(log), rel=1e-8)
    if abs(t) < 1:  # the singular part of the density taken out: int ds/(t-s) = ln((1+t)/(1-t))
        at_t = mp.sqrt(1 - t * t) * density(t)
        rest = mp.quad(lambda s: (mp.sqrt(1 - s * s) * density(s) - at_t) / (t - s), ends)
        direct = rest + at_t * mp.log((1 + t) / (1 - t))
        gap = mp.quad(lambda s: mp.sqrt(1 - s * s) * (density(s) - COEFFICIENTS[0]), [-1, t])
        value = chebyshev.evaluate_expansion(chebyshev.gap_expansion(COEFFICIENTS), t)
        assert value * (1 - t * t) ** 1.5 == pytest.approx(float(gap), rel=1e-8)
    else:
        direct = mp.quad(lambda s: mp.sqrt(1 - s * s) * density(s) / (t - s), ends)
    assert cauchy == pytest.approx(float(direct), rel=1e-7)


@pytest.mark.parametrize("count", [1, 8, 33])
@pytest.mark.parametrize(
    ("second_kind", "roots", "polynomial"), [(False, roots_chebyt, eval_chebyt), (True, roots_chebyu, eval_chebyu)]
)
def test_rules_are_those_of_scipy_and_their_expansions_invert_the_polynomials(count, second_kind, roots, polynomial):
    rule, (node, weight) = chebyshev.gauss_rule(count, second_kind), roots(count)
    assert rule.node == pytest.approx(node, abs=1e-14)
    assert rule.weight == pytest.approx(weight, rel=1e-12)
    np.testing.assert_allclose(rule.polynomial, polynomial(np.arange(count)[:, None], node), atol=1e-11)
    np.testing.assert_allclose(rule.expansion @ rule.polynomial.T, np.eye(count), atol=1e-12)
