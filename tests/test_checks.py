"""Every public function, given values of every type: a sound result, or one sentence that names the argument.

Texts, booleans, bytes, complex numbers and the like are never taken for numbers.
"""

import inspect
import warnings
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

import weier
from tests.marks import examples, few
from tests.scenes import blank
from weier.methods.errors import ConvergenceError
from weier.methods.registry import find_method, names
from weier.methods.settings import defaults
from weier.theory import conduction

MAX_MESSAGE = 400

PROFILE = weier.Profile(1.25, 5, 2, 1.0)
INTERFACE = weier.Interface(
    mu_1=45e9, mu_2=45e9, nu_1=0.34, nu_2=0.34, rho_1=1.7e-8, rho_2=1.7e-8, lambda_0=1e-3, g_0=1e-6
)
HEIGHTS = 1e-3 * np.fft.irfft(np.r_[0, np.exp(1j * np.arange(1, 26) ** 2) / np.arange(1, 26)], 64)
TRACE = weier.Trace(HEIGHTS, 1e-3, unit="m")


def contact():
    """Curves of a file: one case, two methods."""
    data = blank(1, ["demelio", "bem"], np.array([0.1, 1.0]), 2)
    for name, value in (("D", 1.25), ("gamma", 5), ("m", 2), ("phases", [0, 1.0])):
        data[name].values[0] = value
    return data


# Sound values of the arguments, by their names; a function may have others.
SOUND = {
    "profile": PROFILE,
    "surface": PROFILE,
    "mean_pressure": [0.1, 1.0],
    "D": 1.25,
    "gamma": 5,
    "m": 2,
    "phases": 0.5,
    "seed": 7,
    "low": 0.05,
    "high": 0.3,
    "tolerance": 1e-3,
    "quantity": "compliance",
    "points": 64,
    "path": "there/is/none.nc",
    "x": [0.1, 0.2],
    "terms": 1,
    "normalised": [0.1, 0.2],
    "pressure": 1e6,
    "modulus": 1e9,
    "compliance_slope": 1e-9,
    "heights": HEIGHTS,
    "length": 1e-3,
    "shortest": 1e-4,
    "ends": "mirrored",
    "source": "",
    "trace": TRACE,
    "unit": "m",
    "x_unit": "m",
    "height_unit": "m",
    "detrend": "tilt",
    "max_gap": 5,
    "missing_value": -9999.0,
    "longest": 9e-4,
    "hurst": 0.8,
    "rolloff": 5e-4,
    "rms_height": 1e-6,
    "workers": 1,
    "contact_edges": True,
    "data": contact(),
    **vars(INTERFACE),
}
OWN = {
    "gaussian": {"hurst": 0.8, "length": 1e-3, "shortest": 1e-5, "rms_height": 1e-7},
    "Profile": {"phases": 0.0},
    "solve": {"method": "demelio"},
    "load_scene": {"path": "config/scenes/minimal.yaml"},
    "fields": {"mean_pressure": 0.1},
    "densities": {"mean_pressure": 0.1, "pressure": [0, 1], "gap": [0, 1]},
    "Profile.sampled_height": {"terms": 2},
    "cases": {"phases": 1.0, "seed": None, "study": None},
    "Interface": {"E_1": None, "E_2": None},
    "composite_modulus": {"E_1": None, "E_2": None},
    "Interface.solve": {"method": "demelio", "pressure": [1e6, 1e7]},
    "Interface.in_si": {"data": weier.solve(PROFILE, [0.1], "demelio")},
}
# Of functions that take one of several keywords.
WANTED = {"find_load": {"resistance": 1.0}, "Interface.find_pressure": {"resistance": 1e-10}}


INNER = ("loads_of", "warn_of_yield", "scales")  # which get loads and data that others have checked


def functions():
    """Every public function and method: those of `weier.__all__`, and what the theory of conduction has beside."""
    found = {name: getattr(weier, name) for name in weier.__all__ if callable(getattr(weier, name))}
    classes = {name: value for name, value in found.items() if inspect.isclass(value)}
    for name, value in classes.items():
        if issubclass(value, Exception):
            del found[name]  # raised, not called
            continue
        instance = {"Profile": PROFILE, "Interface": INTERFACE, "Trace": TRACE}[name]
        for method, function in inspect.getmembers(value, inspect.isfunction):
            if (
                not method.startswith("_")
                and method not in INNER
                and set(inspect.signature(function).parameters) - {"self"}
            ):
                found[f"{name}.{method}"] = getattr(instance, method)
    extra = (conduction.composite_modulus, conduction.specific_resistance)
    return found | {function.__name__: function for function in (*extra, contact().weier.cases)}


FUNCTIONS = functions()


def arguments(name):
    """The sound arguments of a function."""
    parameters = inspect.signature(FUNCTIONS[name]).parameters.values()
    known = SOUND | OWN.get(name, {})
    named = [parameter for parameter in parameters if parameter.kind is not parameter.VAR_KEYWORD]
    return {
        parameter.name: known[parameter.name]
        for parameter in named
        if parameter.name in known or parameter.default is parameter.empty
    } | WANTED.get(name, {})


ARGUMENTS = [(name, argument) for name in FUNCTIONS for argument in arguments(name)]
SETTINGS = [(method, setting) for method in names() for setting in defaults(find_method(method))]

NO_NUMBERS = [
    {},
    object(),
    np.bool_(True),
    np.complex128(1),
    np.array("5"),
    np.timedelta64(5, "s"),
    np.ma.masked,
    10**400,
    Fraction(10**400, 3),
    xr.Dataset(),
]
NO_ARRAYS_OF_NUMBERS = [
    np.array([True, False]),
    np.array(["0.1", "0.2"]),
    np.array([0.1, 1j]),
    np.ma.array([0.1, 0.2], mask=[0, 1]),
    np.array([0.1, None], object),
    [[0.1], [0.2, 0.3]],
    "0.1,0.2",
    xr.DataArray([True]),
]
NUMBERS_OF_NUMPY = [of(2) for of in (np.uint8, np.int8, np.int64, np.float16, np.float32, np.longdouble)]
ARRAYS_OF_NUMBERS = [
    np.array(1.5),
    xr.DataArray(1.5),
    xr.DataArray([0.1, 0.2]),
    np.ones((2, 2)),
    range(1, 3),
    [],
    (0.2, 0.1),
]

never = (
    st.text(max_size=5)
    | st.sampled_from(["0.5", "nan", "1e-3", "5"])
    | st.booleans()
    | st.binary(max_size=4)
    | st.complex_numbers()
    | st.sampled_from(NO_NUMBERS)
)
arrays_of_none = (
    never.map(lambda value: [value]) | never.map(lambda value: [0.1, value]) | st.sampled_from(NO_ARRAYS_OF_NUMBERS)
)
numbers = (
    st.floats()
    | st.integers()
    | st.decimals()
    | st.fractions()
    | st.sampled_from([*NUMBERS_OF_NUMPY, Decimal("NaN"), Decimal("sNaN")])
    | st.sampled_from(ARRAYS_OF_NUMBERS)
    | st.lists(st.floats(), max_size=3)
)
anything = st.none() | never | arrays_of_none | numbers | st.just(PROFILE) | st.just([PROFILE])

NAMES = {"method", "quantity", "study", "path", "source", "ends", "detrend"}
UNITS = {"unit", "x_unit", "height_unit"}
NOT_NUMBERS = {"profile", "surface", "trace", "data", "contact_edges", *NAMES, *UNITS}
TEXT_TOO = {"gamma"}
TEXTS = {"compliance", "resistance"}  # that settings with a text as their default take
NONE_TOO = {
    "Profile": {"seed"},
    "fields": {"points"},
    "densities": {"pressure", "gap"},
    "Profile.sampled_height": {"terms"},
    "Trace": {"shortest", "missing_value"},
    "Trace.sampled_height": {"terms"},
    "fit": {"longest", "shortest"},
    "Interface": {"E_1", "E_2", "k_1", "k_2", "hardness_1", "hardness_2"},
    "gaussian": {"rolloff"},
    "composite_modulus": {"E_1", "E_2"},
    "cases": {"D", "gamma", "m", "phases", "seed", "study"},
}


def clear(message, argument):
    """One sentence that names the argument, or the rule that its value breaks."""
    assert "\n" not in message, message
    assert len(message) < MAX_MESSAGE, message
    named = {
        "path": "there is no file",
        "gamma": "the spectrum must fall",
        "length": "shortest",
        "rms_height": "the root mean square slope",
        "surface": "data must have",
    } | dict.fromkeys(("mu_2", "nu_1", "nu_2", "lambda_0", "g_0"), "mu_1")
    assert argument in message or named.get(argument, argument) in message, (argument, message)


def attempt(call, argument):
    """What a call gives, or None where it refuses in a clear sentence."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", UserWarning)  # a doubt about a unit is as clear an answer as a refusal
        try:
            return (call(),)
        except (ValueError, ConvergenceError, FileNotFoundError) as refusal:
            clear(str(refusal), argument)
    return None


def holds_a_number(value):
    """Whether the value may be taken for a number or an array of numbers."""
    if isinstance(value, bool | np.bool_) or np.ma.is_masked(value):
        return False
    if isinstance(value, list | tuple | range):
        return all(holds_a_number(element) for element in value)
    if isinstance(value, np.ndarray | xr.DataArray):
        return value.dtype.kind in "iuf"
    return isinstance(value, int | float | Fraction | Decimal | np.integer | np.floating)


def check(name, argument, value):
    result = attempt(lambda: FUNCTIONS[name](**arguments(name) | {argument: value}), argument)
    if result is None or argument in NOT_NUMBERS or (value is None and argument in NONE_TOO.get(name, ())):
        return
    texts = argument in TEXT_TOO and all(
        isinstance(element, str) or holds_a_number(element) for element in np.atleast_1d(value).tolist()
    )
    assert texts or holds_a_number(value), (name, argument, value, result)


@examples(25, 500)
@pytest.mark.parametrize(("name", "argument"), ARGUMENTS, ids=lambda name: name)
def test_every_argument_of_every_public_function(name, argument, how_many):
    how_many(given(anything)(lambda value: check(name, argument, value)))()


@pytest.mark.parametrize(("method", "setting"), SETTINGS, ids=lambda name: name)
def test_every_setting_of_every_method(method, setting):
    profile = PROFILE
    default = defaults(find_method(method))[setting]

    @few(25)
    @given(never | arrays_of_none)
    def run(value):
        taken = attempt(lambda: weier.solve(profile, [0.1], method, **{setting: value}), setting)
        of_truth = isinstance(default, bool) and type(value) in (bool, np.bool_)
        of_text = isinstance(default, str) and isinstance(value, str) and value in TEXTS
        assert taken is None or of_truth or of_text, (value, taken)

    run()


def test_the_arguments_are_sound():
    """Else nothing but refusals would be tested."""
    for name in FUNCTIONS:
        if name != "open_dataset":
            FUNCTIONS[name](**arguments(name))


@pytest.mark.parametrize("loads", [bytearray(b"12"), memoryview(b"12"), [bytearray(b"1")], [1, (memoryview(b"2"),)]])
def test_bytes_are_no_loads(loads):
    """NumPy reads those of a bytearray as integers."""
    with pytest.raises(ValueError, match="mean_pressure must be a number or an array of numbers"):
        weier.solve(PROFILE, loads, "demelio")
