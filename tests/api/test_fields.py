"""Fields along the surface."""

import numpy as np
import pytest

import weier
from tests import westergaard as fields
from weier.methods import westergaard
from weier.methods.bem.active_set import NestedSolver
from weier.methods.bem.grids import full_contact_pressure

PROFILE = weier.Profile(1.25, 5, 2, (0.0, 1.0))


def test_patches_and_boundary_elements_show_the_same_surface():
    """To the error of 64 points a wave, 7e-4 g_0 in the mean gap, more beside the edges."""
    exact = weier.fields(PROFILE, 0.3)
    discrete = NestedSolver(PROFILE, exact.x.size, 1e-10).solve_discrete(0.3, False)
    assert discrete.gap.mean() == pytest.approx(exact.mean_gap, abs=7e-4)
    assert np.abs(discrete.gap - exact.gap.values).max() < 2e-3
    height = PROFILE.sampled_height(exact.x.size)
    assert np.abs(discrete.gap - discrete.plane + height - exact.displacement.values).max() < 2e-3


def test_full_contact_has_fields_however_heavy_the_load():
    for load in (3.0, 1e3, 1e100):
        found = weier.fields(PROFILE, load)
        assert np.all(found.gap == 0)
        height = PROFILE.sampled_height(found.x.size)
        assert found.displacement.values == pytest.approx(height, abs=1e-12)
        # 64 points on the finest wave of amplitude 1.5: its pressure is off by (pi/64)^2/3 of itself.
        on_nodes = full_contact_pressure(height, PROFILE.period)
        assert found.pressure.values - load == pytest.approx(on_nodes if load < 1e9 else 0, abs=2e-3)


def test_exact_fields_of_one_wave_are_westergaards():
    found = weier.fields(weier.Profile(1.5, 2, 1), 0.3, points=101)
    assert found.pressure.values == pytest.approx(fields.pressure(found.x.values, 0.3), abs=1e-9)
    assert found.gap.values == pytest.approx(fields.gap(found.x.values, 0.3), abs=1e-9)
    a = westergaard.contact_half_width(0.3)
    assert (found.right - found.left).values == pytest.approx([2 * a], rel=1e-9)


def test_pressure_leaves_an_edge_as_a_square_root_and_the_gap_as_its_cube():
    found = weier.fields(PROFILE, 0.3)
    s = 1e-6
    edge = weier.methods.patches.solve_load(PROFILE, 0.3)
    for x, strength, inward in ((found.left, found.left_strength, 1), (found.right, found.right_strength, -1)):
        assert edge.pressure(x.values + inward * s) == pytest.approx(strength.values * np.sqrt(s), rel=1e-3)
        assert edge.gap(x.values - inward * s) == pytest.approx(4 * np.pi / 3 * strength.values * s**1.5, rel=1e-3)


def test_densities_are_differences_of_exact_fractions_in_any_bins():
    found = weier.densities(PROFILE, 0.3, gap=[0.0, 0.5, 0.9, 5.0])
    covered = float((weier.fields(PROFILE, 0.3).right - weier.fields(PROFILE, 0.3).left).sum())
    assert found.contact_fraction == pytest.approx(covered, rel=1e-12)
    assert (found.pressure_density.values * np.diff(found.pressure)).sum() == pytest.approx(covered, rel=1e-12)
    assert (found.gap_density.values * np.diff(found.gap)).sum() == pytest.approx(1 - covered, rel=1e-12)
    assert found.gap_density.values[1] * 0.4 == pytest.approx(float(found.gap_above[1] - found.gap_above[2]))
    full = weier.densities(PROFILE, 1e100)
    assert full.pressure_above.values[0] == pytest.approx(full.contact_fraction, rel=1e-12)
    assert full.contact_fraction == 1
    assert np.isnan(full.gap_density).all()


def test_densities_in_si_units_have_the_same_integral():
    bodies = {"mu_1": 79e9, "nu_1": 0.3, "rho_1": 1e-7, "mu_2": 45e9, "nu_2": 0.3, "rho_2": 1e-8}
    found = weier.densities(PROFILE, 0.3)
    own = weier.Interface(**bodies, lambda_0=1e-3, g_0=1e-6).in_si(found)
    for name, unit in (("pressure", "Pa^-1"), ("gap", "m^-1")):
        assert own[f"{name}_density"].attrs["units"] == unit
        integral = (own[f"{name}_density"].values * np.diff(own[name])).sum()
        assert integral == pytest.approx(float(found[f"{name}_above"][0]), rel=1e-12)


@pytest.mark.parametrize("limits", [[0.1], [0.2, 0.1], [[0.0, 1.0]], 1.0])
def test_limits_of_bins_increase(limits):
    with pytest.raises(ValueError, match="gap must be two or more limits of bins, increasing, got"):
        weier.densities(PROFILE, 0.3, gap=limits)
