"""Two bodies, and normalised results in SI units."""

import math
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from weier.api.fields import events, fields
from weier.api.interface import Interface
from weier.api.solve import solve
from weier.data.bodies import Bodies
from weier.data.markdown import significant
from weier.methods import westergaard
from weier.surface.measured.trace import Trace
from weier.surface.profile import Profile
from weier.theory.conduction import composite_modulus

STEEL = {"mu_1": 80e9, "nu_1": 0.3, "rho_1": 1.4e-7}
COPPER = {"mu_2": 45e9, "nu_2": 0.34, "rho_2": 1.7e-8}
ROUGH = {"lambda_0": 1e-4, "g_0": 1e-7}


def interface(**changed):
    return Bodies(**{**STEEL, **COPPER, **ROUGH, **changed})


def test_bodies_are_given_by_either_modulus():
    of_young = {"E_1": 2 * 80e9 * 1.3, "nu_1": 0.3, "rho_1": 1.4e-7} | COPPER | ROUGH
    bodies = Bodies(**of_young)
    assert bodies.composite_modulus == pytest.approx(interface().composite_modulus, rel=1e-15)
    assert replace(bodies, g_0=1e-6).mu_1 == bodies.mu_1
    assert bodies.normalised_pressure(bodies.pressure([0.1, 2.0])) == pytest.approx([0.1, 2.0], rel=1e-15)
    with pytest.raises(ValueError, match="give one of mu_1, the shear modulus, and E_1, Young's modulus, got both"):
        Bodies(**of_young, mu_1=80e9)
    with pytest.raises(ValueError, match="got neither"):
        Bodies(nu_1=0.3, rho_1=1.4e-7, **COPPER, **ROUGH)


def test_results_in_si_units_follow_westergaard_in_si_units():
    # Johnson (1985, 13.7) writes p* = pi E* g/lambda with E* = 2 M.
    bodies = interface()
    assert bodies.composite_modulus == composite_modulus(mu_1=80e9, nu_1=0.3, mu_2=45e9, nu_2=0.34)
    M, g, wavelength = bodies.composite_modulus, 1e-7, 1e-4
    p_full = np.pi * (2 * M) * g / wavelength
    assert bodies.full_contact_pressure == pytest.approx(p_full, rel=1e-14)

    p, step = 0.3 * p_full, 1e-5 * p_full
    h = [g * q / p_full * (1 - np.log(q / p_full)) for q in (p - step, p, p + step)]
    assert bodies.pressure(0.3) == pytest.approx(p, rel=1e-14)
    assert bodies.compliance(westergaard.compliance(0.3)) == pytest.approx(h[1], rel=1e-14)
    slope = (h[2] - h[0]) / (2 * step)
    # The chord of h = xi (1 - ln xi) is off by step^2/(6 xi^2) ~ 2e-10, its rounding by 1e-16/step ~ 1e-11.
    assert bodies.resistance(westergaard.resistance(0.3)) == pytest.approx(M * 1.57e-7 * slope, rel=1e-9)


def test_heat_is_conducted_as_current_with_conductivities():
    """Of strips that touch on a share e of a width, 1/h_c = (1/k_1 + 1/k_2) lambda/pi ln(1/sin(pi e/2)) (Mikic)."""
    heat = {"k_1": 16.0, "k_2": 390.0}
    bodies = Interface(mu_1=80e9, nu_1=0.3, mu_2=45e9, nu_2=0.34, **heat, **ROUGH)
    curve = bodies.in_si(solve(Profile(1.5, 3, 1), [0.01, 0.5], "westergaard"))
    share = curve.contact_fraction.values
    expected = (1 / 16 + 1 / 390) * 1e-4 / np.pi * np.log(1 / np.sin(np.pi * share / 2))
    assert curve.resistance.values == pytest.approx(expected, rel=1e-12)
    assert curve.resistance.units == "K m^2/W"
    assert {name: curve.attrs[name] for name in heat} == heat
    assert "rho_1" not in curve.attrs
    found = bodies.find_pressure(Profile(1.5, 3, 1), resistance=curve.resistance[1])
    assert found.mean_pressure.item() == pytest.approx(bodies.pressure(0.5), rel=1e-9)


def test_contacts_that_yield_are_named_once_with_their_mean_pressure():
    """Of one wave, A = 2/pi asin(sqrt(p/p*)) (Johnson 1985, 13.7): p/A grows from 0 to p*."""
    loads = np.array([0.01, 0.1, 0.5, 1.0, 2.0])
    expected = interface().full_contact_pressure * loads / np.r_[2 / np.pi * np.arcsin(np.sqrt(loads[:3])), 1, 1]
    bodies = interface(hardness_1=9e9, hardness_2=expected[2] / 0.47 * (1 - 1e-6))
    curve = solve(Profile(1.5, 3, 1), loads, "westergaard")
    said = (
        f"from a mean pressure of {significant(bodies.pressure(0.5) / 1e6, 3)} MPa on, at 3 of 5 loads: .* reaches "
    )
    with pytest.warns(UserWarning, match=f"{said}{significant(expected[4] / 1e6, 3)} MPa") as warned:
        table = bodies.in_si(curve).weier.table()
    assert len(warned) == 1
    assert table["contact_pressure"].to_numpy() == pytest.approx(expected, rel=1e-12)
    interface(hardness_2=expected[4] / 0.47 * (1 + 1e-6)).in_si(curve)  # without a warning
    cases = solve([Profile(1.5, 3, 1), Profile(1.2, 3, 1)], loads, ["westergaard"])
    with pytest.warns(UserWarning, match="1 of 1 loads: .* reaches"):
        bodies.in_si(cases.transpose("mean_pressure", ...).isel(mean_pressure=4))
    ensemble = solve([Profile(1.5, 3, 1)], loads, ["westergaard", "demelio"]).weier.ensemble()
    expected /= interface().full_contact_pressure
    assert ensemble["contact_pressure_median"].to_numpy()[:5] == pytest.approx(expected, rel=1e-12)
    assert ensemble["contact_pressure_median"][5:].isna().all()


@pytest.mark.parametrize("method", ["demelio", ["demelio", "westergaard"]])
def test_yield_that_cannot_be_judged_is_named(method):
    with pytest.warns(UserWarning, match="whether contacts yield cannot be judged at 2 of 2 loads") as warned:
        interface(hardness_1=1e11).in_si(solve(Profile(1.5, 3, 1), [0.1, 0.2], method))
    assert len(warned) == 1


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"nu_1": 0.7}, r"nu_1 must lie in \(-1, 0.5\], got 0.7"),
        ({"k_1": 1.0}, "give rho_1 and rho_2, .*, or k_1 and k_2, .*, got k_1, rho_1, rho_2"),
        ({"mu_1": np.inf, "mu_2": np.inf, "lambda_0": None, "g_0": None}, "two rigid bodies"),
    ],
)
def test_interface_refuses_what_cannot_be(changed, message):
    with pytest.raises(ValueError, match=message):
        interface(**changed)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"mu_1": None, "E_1": 210}, r"^mu_1 = 80.7692 Pa is not from 1e\+06 to 1e\+13 Pa: is the unit right\?"),
        ({"lambda_0": 0.8, "g_0": 0.4}, "g_0/lambda_0 = 0.5 m/m is not from 1e-08 to 0.2 m/m"),
        ({"lambda_0": 4.0, "g_0": 1e-3}, "lambda_0 = 4 m is not from 2e-10 to 1 m"),
    ],
)
def test_unusual_materials_are_doubted(changed, message):
    with pytest.warns(UserWarning, match=message) as warned:
        interface(**changed)
    assert len(warned) == 1
    assert warned[0].filename == __file__
    interface(mu_1=np.inf, rho_1=0.0)  # a rigid body, a perfect conductor
    interface(rho_1=1e-8, rho_2=1e-3, lambda_0=1.0, g_0=0.05)


@pytest.fixture(scope="module")
def curve():
    return solve(Profile(1.25, 5, 2, 1.0), [0.1, 0.5, 3.0], "bem")


def test_a_curve_in_si_units_keeps_its_coordinates(curve):
    bodies = interface()
    found = bodies.in_si(curve)
    assert curve.resistance.symbol == found.resistance.symbol == "R"
    assert found.compliance.symbol == curve.compliance.symbol
    assert set(found.variables) == set(curve.variables)
    assert found.mean_pressure.values == pytest.approx(bodies.pressure([0.1, 0.5, 3.0]), rel=1e-15)
    assert found.indexes["mean_pressure"].tolist() == found.mean_pressure.values.tolist()
    assert found.resistance.values == pytest.approx(bodies.resistance(curve.resistance.values), rel=1e-15)
    assert (found.D, found.m, found.solution_method) == (1.25, 2, "bem")
    units = [found[name].attrs.get("units") for name in ("mean_pressure", "compliance", "resistance", "patch_count")]
    assert units == ["Pa", "m", "ohm m^2", "1"]
    assert found.compliance.long_name == "compliance"
    assert not any("normalised_by" in values.attrs for values in found.variables.values())
    assert (found.attrs["lambda_0"], found.attrs["g_0"]) == (1e-4, 1e-7)
    assert found.contact_fraction.equals(curve.contact_fraction.assign_coords(found.contact_fraction.coords))
    assert curve.compliance.attrs["normalised_by"] == "g_0"  # what is given stays as it was


def test_each_of_several_traces_and_series_has_its_own_scale():
    """Their common loads in p_0* are different ones in Pa."""
    z = 1e-6 * np.cos(2 * np.pi * np.arange(32) / 32)
    surfaces = [Trace(z, 1e-3, ends="periodic", unit="m"), Profile(1.25, 5, 2, 1.0), Trace(2 * z, 3e-3, unit="m")]
    curves = solve(surfaces, [0.1, 1.0], ["bem"], bem={"staircase": "kept"})
    with pytest.raises(ValueError, match=r"common pressures in Pa, got traces .* convert each case alone"):
        interface().in_si(curves)
    pressures = Interface(**STEEL, **COPPER, **ROUGH).solve(surfaces, [1e8, 1e9], ["bem"], bem={"staircase": "kept"})
    for row, surface in enumerate(surfaces):
        own, found = interface().at(surface), interface().in_si(curves.isel(case=[row]))
        assert found.mean_pressure.values == pytest.approx(own.pressure([0.1, 1.0]), rel=1e-15)
        common = solve(surface, own.normalised_pressure([1e8, 1e9]), "bem", staircase="kept")
        for name in ("compliance", "resistance"):
            expected = getattr(own, name)(curves[name][row].values)
            assert found[name][0].values == pytest.approx(expected, rel=1e-15, nan_ok=True), name
            expected = getattr(own, name)(common[name].values)
            assert pressures[name][row, 0].values == pytest.approx(expected, rel=1e-14), name
    with pytest.raises(ValueError, match="surface must be a weier"):
        interface().at(curves)
    with pytest.raises(ValueError, match="lambda_0 and g_0 must be given for a series"):
        interface(lambda_0=None, g_0=None).in_si(curves)


ARITHMETIC = {
    "assigned": lambda data: data.assign(resistance=1 / data.resistance),
    "of one unit": lambda data: data.assign(made=data.resistance / data.resistance.shift(mean_pressure=1)),
    "without attributes": lambda data: data.assign(made=(1 / data.resistance).drop_attrs()),
    "of both": lambda data: data.assign(made=data.resistance / data.compliance),
    "loads": lambda data: data.assign_coords(mean_pressure=2 * data.mean_pressure),
}
SELECTION = {
    "one variable": lambda data: data.resistance.to_dataset(),
    "joined": lambda data: xr.concat(
        [data.isel(mean_pressure=[0]), data.isel(mean_pressure=[1, 2])], "mean_pressure"
    ),
    "without phases": lambda data: data.drop_vars(["phases", "seed", "term"]),
}


@pytest.mark.parametrize("change", ARITHMETIC.values(), ids=ARITHMETIC)
def test_arithmetic_that_keeps_attributes_is_refused(change, curve):
    with xr.set_options(keep_attrs=True), pytest.raises(ValueError, match=r"must be as weier returned it|has lost"):
        interface().in_si(change(curve[["compliance", "resistance"]]))


@pytest.mark.parametrize("change", SELECTION.values(), ids=SELECTION)
def test_selections_and_copies_are_converted(change, curve):
    own = curve.drop_vars("contact_edge", errors="ignore")
    found, expected = interface().in_si(change(own)), change(interface().in_si(own))
    for name, values in expected.variables.items():
        if values.dtype.kind == "f":
            np.testing.assert_allclose(found.variables[name].values, values.values, rtol=1e-15)


def test_a_file_that_xarray_wrote_is_converted(tmp_path, curve):
    curve.to_netcdf(tmp_path / "curve.nc")
    with xr.open_dataset(tmp_path / "curve.nc") as again:
        np.testing.assert_array_equal(interface().in_si(again).resistance, interface().in_si(curve).resistance)
        with pytest.raises(ValueError, match="resistance must be as weier returned it"):
            interface().in_si(again.assign(resistance=again.resistance**2))


def test_the_units_of_a_trace_are_never_those_of_a_series():
    """Its length and height are coordinates, in which a conversion must not be in doubt."""
    trace = Trace(1e-6 * np.cos(2 * np.pi * np.arange(32) / 32), 1e-3, ends="periodic", unit="m")
    curve = solve(trace, [0.1, 1.0], "bem", staircase="kept")
    both = solve([trace, Profile(1.25, 5, 2)], [0.1, 1.0], ["bem"])
    expected = interface().in_si(curve)
    assert interface().in_si(curve.reset_coords()).resistance.equals(expected.resistance.reset_coords(drop=True))
    for lost in (
        curve.reset_coords(drop=True),
        curve.drop_vars("trace_length"),
        curve.drop_vars("trace_height"),
        curve[["resistance"]].drop_vars(["D", "trace_length", "trace_height"]),
        both.drop_vars("trace_length"),
    ):
        with pytest.raises(ValueError, match="data must have the coordinate D of a series, or trace_length"):
            interface().in_si(lost)


def test_fields_and_events_are_in_units_of_their_trace():
    x = 2 * np.pi * np.arange(64) / 64
    trace = Trace(1e-6 * np.cos(x) + 2e-7 * np.cos(5 * x + 1), 1e-3, ends="periodic", unit="m")
    for found in (fields(trace, 0.1), events(trace, 0.01, 0.5)):
        own, expected = interface().in_si(found), interface(lambda_0=trace.lambda_0, g_0=trace.g_0).in_si(found)
        assert own.equals(expected)
        assert own.attrs["g_0"] == trace.g_0
    assert own.mean_pressure.values[0] == pytest.approx(
        found.mean_pressure.values[0] * 2 * np.pi * interface().composite_modulus * trace.g_0 / trace.lambda_0
    )


def test_no_contact_has_no_conductance_whatever_the_bodies_are():
    perfect = interface(rho_1=0.0, rho_2=0.0)
    assert perfect.resistance([0.0, 1.0, math.inf]).tolist() == [0.0, 0.0, math.inf]
    assert math.isnan(perfect.resistance(math.nan))


NORMALISED_TWICE = [
    lambda bodies, curve: bodies.in_si(bodies.in_si(curve).drop_attrs(deep=False)),
    lambda bodies, curve: bodies.pressure(bodies.in_si(curve).mean_pressure.variable),
    lambda bodies, curve: solve(Profile(1.25, 5, 2), bodies.in_si(curve).mean_pressure, "demelio"),
]


@pytest.mark.parametrize("convert", NORMALISED_TWICE)
def test_a_conversion_happens_once(convert, curve):
    with pytest.raises(ValueError, match=r"(must be (normalised|in)|must have no unit)"):
        convert(interface(), curve)


def test_other_variables_are_converted_by_their_own_unit(curve):
    found = interface().in_si(
        curve.assign(again=curve.resistance, T=("mean_pressure", [1.0, 2.0, 3.0], {"units": "K"}))
    )
    assert found.again.units == "ohm m^2"
    assert found["T"].values.tolist() == [1.0, 2.0, 3.0]
