"""`weier.Interface`: from heights and Pa to m and ohm m^2, and back."""

import numpy as np
import pytest
import xarray as xr

import weier

STEEL = {"mu_1": 80e9, "mu_2": 80e9, "nu_1": 0.3, "nu_2": 0.3, "rho_1": 2e-7, "rho_2": 2e-7}
BODIES = weier.Interface(**STEEL)
SCALED = weier.Interface(**STEEL, lambda_0=1e-3, g_0=1e-6)
SERIES = weier.Profile(D=1.25, gamma=5, m=2, phases=1.0)
n = np.arange(200)
HEIGHTS = np.cos(2 * np.pi * n / 50) + 0.2 * np.cos(2 * np.pi * n / 9 + 1)
LINE = weier.Trace(HEIGHTS, 1.0, x_unit="mm", height_unit="um", source="line")


def test_a_measured_line_goes_from_heights_to_ohms():
    """The value was found by other means, from the heights by way of p_0*."""
    curve = BODIES.solve(LINE, [10e6, 1e6])
    assert curve.mean_pressure.values.tolist() == [10e6, 1e6]
    assert curve.resistance.values[0] == pytest.approx(1.050e-10, rel=1e-3)
    units = {name: curve[name].units for name in ("mean_pressure", "compliance", "resistance", "resistance_error")}
    assert units == {
        "mean_pressure": "Pa",
        "compliance": "m",
        "resistance": "ohm m^2",
        "resistance_error": "ohm m^2",
    }
    # In SI units by hand: h and R scale with g_0 and (rho_1 + rho_2) lambda_0/(2 pi).
    p_0 = 2 * np.pi * (80e9 / 1.4) * LINE.g_0 / LINE.lambda_0
    by_hand = weier.solve(LINE, [10e6 / p_0, 1e6 / p_0])
    assert curve.compliance.values == pytest.approx(by_hand.compliance.values * LINE.g_0, rel=1e-9)
    assert curve.resistance.values == pytest.approx(by_hand.resistance.values * 4e-7 * 1e-3 / (2 * np.pi), rel=1e-9)
    with pytest.raises(ValueError, match="data must be normalised"):
        BODIES.in_si(curve)
    with pytest.warns(UserWarning, match="is the unit right of the pressures, the moduli, or lambda_0 and g_0"):
        BODIES.solve(LINE, 1e15)


def test_pressures_come_back_as_given():
    given = [3.3, 10 / 3, 6.9]
    for unit in ("MPa", "psi", "ksi"):
        found = SCALED.solve(weier.Profile(1.5, 3, 1), xr.DataArray(given, attrs={"units": unit}), "westergaard")
        assert found.mean_pressure.values == pytest.approx(given, rel=0 if unit == "MPa" else 3e-16, abs=0)


def test_several_surfaces_are_cases_with_common_pressures(tmp_path):
    other = weier.Trace(2 * HEIGHTS[:150], 0.75, x_unit="mm", height_unit="um", source="other")
    surfaces, pressures = [LINE, SERIES, other], [1e7, 1e6, 2e7]
    found = SCALED.solve(surfaces, pressures, contact_edges=True)
    assert found.resistance.dims == ("case", "solution_method", "mean_pressure")
    assert found.mean_pressure.values.tolist() == pressures
    for row, surface in enumerate(surfaces):
        alone = SCALED.solve(surface, pressures, contact_edges=True)
        for name in ("compliance", "resistance", "contact_fraction", "compliance_error"):
            assert found[name].values[row, 0] == pytest.approx(alone[name].values, rel=1e-12), name
        edges = found.contact_edge.values[row]
        assert edges[:, : alone.sizes["edge"]] == pytest.approx(alone.contact_edge.values, rel=1e-12, nan_ok=True)
        assert np.isnan(edges[:, alone.sizes["edge"] :]).all()
    assert found.trace.values.tolist() == ["line", "", "other"]
    assert len(set(found.case.values)) == 3
    assert found.weier.table().shape[0] == 9
    found.to_netcdf(tmp_path / "si.nc")
    with xr.open_dataset(tmp_path / "si.nc") as again:
        assert again.resistance.values.tolist() == found.resistance.values.tolist()


def test_pressures_may_have_a_unit():
    found = BODIES.solve(LINE, xr.DataArray([10.0], attrs={"units": "MPa"}))
    assert (found.mean_pressure.values.tolist(), found.mean_pressure.units) == ([10.0], "MPa")
    expected = BODIES.solve(LINE, [1e7])
    assert found.resistance.values == expected.resistance.values
    again = BODIES.solve([LINE, LINE], found.mean_pressure)
    assert (again.mean_pressure.values.tolist(), again.weier.ensemble()["mean_pressure"].tolist()) == ([10.0], [10.0])


@pytest.mark.parametrize("surface", [LINE, SERIES], ids=["trace", "series"])
def test_the_pressure_of_a_curve_comes_back_within_its_error(surface):
    curve = SCALED.solve(surface, [2e7])
    for name in ("resistance", "compliance", "contact_fraction"):
        found = SCALED.find_pressure(surface, **{name: curve[name]})
        assert found.mean_pressure.units == found.mean_pressure_error.units == "Pa"
        # Conversions round both the value and the pressure.
        assert abs(found.mean_pressure.item() - 2e7) <= found.mean_pressure_error.item() + 1e-8 * 2e7, name
        assert found.mean_pressure_error.item() < 20, name
    with pytest.raises(ValueError, match=r"resistance must be in ohm m\^2, got values in m"):
        SCALED.find_pressure(surface, resistance=curve.compliance)
    with pytest.raises(ValueError, match="give one of resistance, compliance, contact_fraction, got none"):
        SCALED.find_pressure(surface)
    with pytest.raises(
        ValueError,
        match=r"resistance must lie strictly .* and 0 ohm m\^2, from full contact under .* Pa on, got -1 ohm m\^2$",
    ):
        SCALED.find_pressure(surface, resistance=-1.0)
    perfect = weier.Interface(**STEEL | {"rho_1": 0.0, "rho_2": 0.0}, lambda_0=1e-3, g_0=1e-6)
    with pytest.raises(ValueError, match="two perfect conductors"):
        perfect.find_pressure(surface, resistance=1e-10)
