"""One wave on a layer: a stiff one leaves Westergaard, one far too thin is refused."""

from __future__ import annotations

import numpy as np
import pytest

from weier import ConvergenceError, Profile
from weier.methods import layer, westergaard
from weier.methods.layer.nonlinear_layer import ACCURACY, POINTS
from weier.methods.layer.scaling_tables import closure_from_table
from weier.methods.layer.wave import midpoints, solve_waves


@pytest.mark.parametrize("xi", [1e-12, 1e-3, 0.3, 0.99])
def test_a_stiff_layer_leaves_westergaard(xi):
    # w = 1e-11 sqrt(xi) p. Westergaard's q is a constant and a cosine, which the nodes have exactly; that p vanishes
    # at the edge they learn from w alone, so that the square root of 1e-11 is seen.
    position = np.linspace(-4, 1, 200)  # the cubics between so many rows are the power law to 1e-8
    log_p = np.sinh(position)
    log_w, slope = log_p + np.log(1e-11 * np.sqrt(xi)), np.cosh(position)
    found = solve_waves(np.log([xi]), closure_from_table(position, log_w, slope), midpoints(POINTS), 1e-12)
    np.testing.assert_allclose(found.compliance, westergaard.compliance(xi), rtol=1e-6)
    np.testing.assert_allclose(found.rate / xi, westergaard.resistance(xi), rtol=1e-4, atol=2e-5)


def test_a_wave_that_misses_the_tolerance_is_refused():
    # Waves 1e300 times as fine: their layer is far too thin for numbers.
    with pytest.raises(ConvergenceError, match="stopped at a relative residual") as refused:
        layer.curve(Profile(1.5, 1e300, 3), [1e-4, 0.2, 3.0])
    assert refused.value.residual > 1e-5 * ACCURACY
