"""Scale by scale to the infinite series, and how many scales are too many."""

from __future__ import annotations

import math

import numpy as np
import pytest

from weier import ConvergenceError
from weier.methods import layer
from weier.methods.layer.solver import ACCURACY, _may_be_infinite
from weier.methods.layer.tables import BOTTOM_POSITIONS
from weier.theory.series import tail_amplitude


@pytest.mark.parametrize(("D", "gamma", "m"), [(1.75, 2, 110), (1.9, 3, 140)])
def test_scales_one_by_one_reach_the_infinite_series(D, gamma, m):
    """So many terms that the tail is below the accuracy, and too few to be taken for infinite."""
    assert not _may_be_infinite(BOTTOM_POSITIONS[0], (D, gamma, m), ACCURACY)
    loads = np.array([1e-12, 1e-6, 1e-3, 0.1, 1.0, 3.6])
    tail = tail_amplitude(m, D, gamma)
    finite, infinite = (layer.compliance(loads, D, gamma, terms) for terms in (m, math.inf))
    print(f"D = {D}, gamma = {gamma}: {np.abs(finite / infinite - 1).max():.1e} apart, the tail is {tail:.1e} g_0")
    assert np.all(np.abs(infinite - finite) <= tail + ACCURACY * infinite)


def test_too_many_scales_are_refused():
    with pytest.raises(ConvergenceError, match=r"errors of the layer model add up over .* scales") as refused:
        layer.curve([0.1], 1.9999, 1.1, math.inf)
    assert refused.value.residual > ACCURACY
    with pytest.raises(ConvergenceError, match="a series of 5000 terms still differs from the infinite one"):
        layer.curve([0.1], 1.999, 2, 5000)
