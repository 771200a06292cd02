"""Composite modulus of two bodies, and resistance from stiffness."""

import math

import numpy as np
import pytest

from weier.theory.conduction import RANGES, composite_modulus, full_contact_pressure, specific_resistance


def test_composite_modulus_is_half_of_the_plane_strain_modulus():
    E_1, E_2 = 2 * 80e9 * 1.3, 2 * 45e9 * 1.34  # E = 2 mu (1 + nu)
    plane_strain = 1 / ((1 - 0.3**2) / E_1 + (1 - 0.34**2) / E_2)
    assert composite_modulus(mu_1=80e9, nu_1=0.3, mu_2=45e9, nu_2=0.34) == pytest.approx(plane_strain / 2, rel=1e-14)
    assert composite_modulus(E_1=E_1, nu_1=0.3, E_2=E_2, nu_2=0.34) == pytest.approx(plane_strain / 2, rel=1e-14)
    # Johnson (1985, 13.7) writes p* = pi E* g/lambda with the plane strain modulus E*.
    p_full = np.pi * plane_strain * 1e-7 / 1e-4
    assert full_contact_pressure(plane_strain / 2, 1e-4, 1e-7) == pytest.approx(p_full, rel=1e-14)


def test_resistance_is_modulus_times_resistivities_times_compliance_slope():
    slope, modulus = np.array([[0.0], [2e-15]]), np.array([1e10, 3e10])
    found = specific_resistance(slope, modulus, 1.4e-7, 1.7e-8)
    assert found == pytest.approx(np.array([[0, 0], [3.14e-12, 9.42e-12]]), rel=1e-14)
    assert specific_resistance(math.inf, 1e10, 1.4e-7, 1.7e-8) == math.inf


LIMITS = {"modulus": (0, None), "mu_1": (0, None), "nu_2": (-1, 0.5), "rho_1": (-1e-300, math.inf)}
LIMITS |= dict.fromkeys(("lambda_0", "g_0", "hardness_1", "k_1"), (0, math.inf))


@pytest.mark.parametrize("name", LIMITS)
def test_quantities_have_the_ranges_of_physics(name):
    """Rigid bodies have mu = inf, incompressible ones nu = 0.5, and superconducting ones no resistivity."""
    _, holds, _ = RANGES[name]
    low, high = LIMITS[name]
    assert not holds(low)
    assert holds(low + 1e-9)
    assert holds(0.3)
    assert holds(math.inf) == (high is None)
    assert name != "nu_2" or (holds(0.5) and not holds(0.5 + 1e-9))
    assert name != "rho_1" or holds(0.0)
