"""Lines between the loads: a curve of few loads is drawn as the curve that it is, up to the load where it ends."""

import numpy as np
import pytest

from weier.figures import lines
from weier.methods import demelio, westergaard

LOADS = np.array([0.01, 0.1, 0.4, 0.8, 0.944, 1.1, 2.0])


def test_a_compliance_is_no_polygon():
    h, slope = westergaard.compliance(LOADS), westergaard.resistance(LOADS)
    fine, values = lines.compliance_line(LOADS, h, slope)
    inside = fine < LOADS[4]
    error = np.abs(values - westergaard.compliance(fine))[inside].max()
    polygon = np.abs(np.interp(fine, LOADS, h) - westergaard.compliance(fine))[inside].max()
    assert error < 0.1 * polygon
    assert values[:: lines.PIECES] == pytest.approx(h, abs=1e-15)
    assert np.all(np.diff(values) >= 0)


def test_a_resistance_falls_to_zero_at_its_true_load():
    """From 0.944 and 1.1 p_0* alone: a wave is flat from p_0* on (13)."""
    h, slope = westergaard.compliance(LOADS), westergaard.resistance(LOADS)
    assert lines.zero_load(LOADS, h, slope, 4) == pytest.approx(1, abs=1e-3)
    fine, values = lines.resistance_line(LOADS, h, slope)
    assert np.all(np.diff(fine) > 0)
    small = (values > 0) & (values < 0.03)
    assert small.sum() > 10
    assert fine[small] == pytest.approx(np.exp(-values[small]), abs=1e-3)  # where -ln p has this value
    assert set(LOADS) <= set(fine)


def test_demelio_leaves_where_its_last_wave_is_flat():
    loads = np.geomspace(0.1, 10, 25)
    h, slope = demelio.compliance(loads, 1.25, 5, 2), demelio.resistance(loads, 1.25, 5, 2)
    last = int(np.flatnonzero(slope > 0)[-1])
    assert lines.zero_load(loads, h, slope, last) == pytest.approx(5**0.25, rel=0.01)  # p_1* (16)
