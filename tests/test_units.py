"""Units that values carry: converted or refused wherever a number is given, never dropped."""

from functools import partial

import numpy as np
import pint
import pytest
import xarray as xr

import weier
from weier import units
from weier.theory.conduction import composite_modulus, specific_resistance
from weier.units import factor

UREG = pint.UnitRegistry()
STEEL = {"nu_1": 0.3, "nu_2": 0.3, "rho_1": 1.4e-7, "rho_2": 1.4e-7}
BODIES = weier.Interface(mu_1=80e9, mu_2=80e9, **STEEL, lambda_0=1e-3, g_0=1e-6)
PROFILE = weier.Profile(D=1.25, gamma=5, m=2, phases=1.0)


class Quantity(np.ndarray):
    """An array with a unit as astropy and unyt have it, whose values are plain numbers for NumPy."""

    value = property(lambda self: self.view(np.ndarray))


def with_unit(values, unit):
    found = np.asarray(values, float).view(Quantity)
    found.unit = unit
    return found


def of_pint(values, unit):
    return UREG.Quantity(np.asarray(values, float)[()], unit)


def of_xarray(values, unit):
    return xr.DataArray(values, attrs={"units": unit})


def of_pint_in_xarray(values, unit):
    return xr.DataArray(of_pint(np.asarray(values, float), unit))


def one_by_one(values, unit):
    return [of_pint(value, unit) for value in values]


def in_an_array_of_objects(values, unit):
    found = np.empty(len(values), object)
    found[:] = one_by_one(values, unit)
    return found


SCALARS = (of_pint, with_unit, of_xarray, of_pint_in_xarray)
ARRAYS = (*SCALARS, one_by_one, in_an_array_of_objects)


@pytest.mark.parametrize("of", SCALARS)
def test_quantities_of_bodies_are_converted(of):
    found = weier.Interface(
        E_1=of(2.08e-1, "TPa"),
        mu_2=of(80e3, "N / mm**2"),
        **STEEL | {"rho_1": of(14.0, "uohm cm"), "nu_1": of(0.3, "dimensionless")},
        lambda_0=of(1.0, "mm"),
        g_0=of(1.0, "micrometer"),
    )
    for name, value in vars(BODIES).items():
        assert value is None or getattr(found, name) == pytest.approx(value, rel=1e-14), name
    assert composite_modulus(mu_1=of(80, "GPa"), mu_2=of(80, "GPa"), nu_1=0.3, nu_2=0.3) == pytest.approx(
        BODIES.composite_modulus, rel=1e-14
    )
    assert specific_resistance(of(3.0, "nm/MPa"), of(1.0, "GPa"), 1e-7, of(10.0, "uohm cm")) == pytest.approx(
        3e-15 * 1e9 * 2e-7, rel=1e-14
    )


@pytest.mark.parametrize("of", ARRAYS)
def test_pressures_with_a_unit_are_converted(of):
    expected = BODIES.normalised_pressure([10e6, 20e6])
    assert BODIES.normalised_pressure(of([10, 20], "MPa")) == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize("of", ARRAYS)
@pytest.mark.parametrize(
    ("call", "unit"),
    [
        (partial(weier.solve, PROFILE, method="demelio"), "MPa"),
        (BODIES.normalised_pressure, "p_0*"),
        (BODIES.resistance, "ohm m^2"),
        (PROFILE.height, "mm"),
    ],
)
def test_quantities_of_another_kind_are_refused(call, unit, of):
    if unit == "p_0*" and of in (of_pint, of_pint_in_xarray, one_by_one, in_an_array_of_objects):
        return  # which pint does not make
    with pytest.raises(ValueError, match=r"must (be in|have no unit).*got values in"):
        call(of([0.1, 0.2], unit))


def test_normalised_values_are_taken_with_their_own_unit_alone():
    curve = weier.solve(PROFILE, [0.1, 0.2], "demelio")
    assert weier.solve(PROFILE, curve.mean_pressure, "demelio").compliance.equals(curve.compliance)
    assert weier.Profile(1.25, 5, 2, curve.phases).phase.tolist() == PROFILE.phase.tolist()
    assert weier.Profile(1.25, 5, 2, of_pint(180 / np.pi, "deg")).phase == pytest.approx([0, 1], rel=1e-14)
    with pytest.raises(ValueError, match=r"mean_pressure must be in p_0\*, got values in g_0: weier.Interface"):
        weier.solve(PROFILE, curve.compliance, "demelio")
    with pytest.raises(ValueError, match="D must have no unit, got values in g_0"):
        weier.Profile(curve.compliance[0], 5, 2)


@pytest.mark.parametrize(
    ("unit", "base", "value"),
    [
        ("GPa", "Pa", 1e9),
        ("N mm\u207b\u00b2", "Pa", 1e6),
        ("N\u2215mm\u00b2", "Pa", 1e6),
        ("\u33a9", "Pa", 1.0),
        ("kg m-1 s-2", "Pa", 1.0),
        ("kgf/mm^2", "Pa", 9.80665e6),
        ("\u03bc\u2126\u22c5cm", "ohm m", 1e-8),
        ("uOhm cm", "ohm m", 1e-8),
    ],
)
def test_spellings_of_units(unit, base, value):
    assert factor("value", unit, base) == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "values", "unit"),
    [
        ("1,10MPa", [1e6, 1e7], "MPa"),
        ("1:100:3", [1, 10, 100], ""),
        ("1:100:3 kPa", [1e3, 1e4, 1e5], "kPa"),
    ],
)
def test_the_unit_at_the_end_of_a_list_is_that_of_each_number(text, values, unit):
    assert units.listed("pressures", text, "Pa") == (pytest.approx(values, rel=1e-14), unit)


@pytest.mark.parametrize("text", ["1MPa,5", "1 MPa:10:4", "1,", "1:2", "1:2:3:4", "1_0,2MPa", "1 5", "0,1:1:5"])
def test_a_list_with_units_elsewhere_is_refused(text):
    """The unit of the others would be a guess, and 1e6 times off."""
    with pytest.raises(ValueError, match=r'"1,10 Pa" or "first:last:count Pa", got .*: one unit, at the end'):
        units.listed("pressures", text, "Pa")


def test_a_list_of_quantities_and_numbers_is_refused():
    bodies = BODIES
    MPa = xr.DataArray(1.0, attrs={"units": "MPa"})
    for use in (bodies.normalised_pressure, lambda values: bodies.solve(PROFILE, values, "demelio")):
        with pytest.raises(ValueError, match="pressure must all have a unit, as some are in MPa, or none"):
            use([MPa, 5])
    assert bodies.normalised_pressure([MPa, 2 * MPa]) == pytest.approx(bodies.normalised_pressure([1e6, 2e6]))
    load = xr.DataArray(0.1, attrs={"normalised_by": "p_0*"})
    assert bodies.pressure([load, 0.2]).tolist() == bodies.pressure([0.1, 0.2]).tolist()


NO_UNITS = [
    "Pa",
    "1e-8 ohm m",
    "9**9**9**9",
    "m**9**9**9",
    "",
    "a" * 38 + "!",
    "degC",
    "m\n  m\n (m",  # which the tokenizer of Python refuses by its indentation
    "not-1",
]


@pytest.mark.parametrize("unit", NO_UNITS)
def test_a_text_that_is_no_unit_of_the_quantity_is_refused(unit):
    with pytest.raises(ValueError, match=r"(?s)^rho_1 must be in ohm m, got values in .{0,90}$"):
        factor("rho_1", unit, "ohm m")


@pytest.mark.parametrize(("of", "unit"), [(of_pint, "mil"), (with_unit, "\u00b5m"), (of_xarray, "\u03bcm")])
def test_lengths_of_a_trace_are_converted_to_the_unit_of_the_call(of, unit):
    heights = np.cos(2 * np.pi * np.arange(64) / 64) + 0.1 * np.cos(2 * np.pi * np.arange(64) / 8)
    expected = weier.Trace(heights, 1e-3, 1e-4, x_unit="m", height_unit="um")
    found = weier.Trace(heights, of(1.0, "mm"), of(100.0, "um"), x_unit=unit, height_unit="um")
    assert found.lambda_0 == pytest.approx(expected.lambda_0, rel=1e-12)
    assert found.shortest == pytest.approx(expected.shortest, rel=1e-12)
    with pytest.raises(ValueError, match="length must be in m, got values in"):
        weier.Trace(heights, of(1.0, "Pa"), x_unit=unit, height_unit="um")
