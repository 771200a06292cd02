"""Compliance between the loads."""

import numpy as np
import pytest

from weier.figures import interpolation
from weier.methods import westergaard

LOADS = np.array([0.01, 0.1, 0.4, 0.8, 0.944, 1.1, 2.0])


def test_a_compliance_is_no_polygon():
    h, slope = westergaard.compliance(LOADS), westergaard.resistance(LOADS)
    fine, values = interpolation.between_loads(LOADS, h, slope)
    inside = fine < LOADS[4]
    error = np.abs(values - westergaard.compliance(fine))[inside].max()
    polygon = np.abs(np.interp(fine, LOADS, h) - westergaard.compliance(fine))[inside].max()
    assert error < 0.1 * polygon
    assert values[:: interpolation.PIECES] == pytest.approx(h, abs=1e-15)
    assert np.all(np.diff(values) >= 0)
