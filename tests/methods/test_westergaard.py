"""One wave: the closed forms agree with each other, with mpmath and with what a contact must obey."""

import mpmath as mp
import numpy as np
import pytest
from scipy.integrate import quad

from tests import westergaard as fields
from weier.methods import westergaard


@pytest.mark.parametrize("xi", [1e-300, 1e-12, 1e-3, 0.5, 0.9, 1 - 1e-12])
def test_compliance_and_resistance_have_all_digits(xi):
    with mp.workdps(40):
        log = mp.log(mp.mpf(xi))
        h, R = float(xi * (1 - log)), float(-log)
    assert (westergaard.compliance(xi), westergaard.resistance(xi)) == pytest.approx((h, R), rel=1e-15, abs=0)


def test_full_contact_has_the_amplitude_and_no_resistance():
    np.testing.assert_array_equal(westergaard.compliance([1.0, 1.5, 1e300]), 1)
    np.testing.assert_array_equal(westergaard.resistance([1.0, 1.5, 1e300]), 0)
    np.testing.assert_array_equal(westergaard.contact_half_width([1.0, 1e300]), 0.5)


@pytest.mark.parametrize("xi", [1e-3, 0.3, 1.0, 1.7])
def test_energy_is_the_work_of_the_load(xi):
    """int p dh = int p R dp; beyond full contact h stays."""
    work, _ = quad(lambda p: p * float(westergaard.resistance(p)), 0, min(xi, 1.0))
    assert westergaard.elastic_energy(xi) == pytest.approx(work, rel=1e-9)


@pytest.mark.parametrize("xi", [1e-3, 0.1, 0.5, 0.999, 1.0, 1.7])
def test_pressure_carries_the_load_over_the_contact(xi):
    a = float(westergaard.contact_half_width(xi))
    load, error = quad(lambda x: float(fields.pressure(x, xi)), -a, a, epsabs=1e-13, epsrel=1e-11)
    assert load == pytest.approx(xi, abs=10 * error + 1e-12)


@pytest.mark.parametrize("xi", [1e-9, 1e-3, 0.1, 0.5, 0.999])
def test_mean_gap_is_what_compliance_leaves_of_the_amplitude(xi):
    a = float(westergaard.contact_half_width(xi))
    # With x = exp(t) the edge of the contact, however small, lies on the scale of t.
    half, error = quad(
        lambda t: float(fields.gap(np.exp(t), xi)) * np.exp(t), np.log(a), np.log(0.5), epsabs=1e-14, limit=200
    )
    assert 2 * half == pytest.approx(1 - westergaard.compliance(xi), abs=10 * error + 1e-14)
