"""One profile, one method, many loads: the public way in, and the table of all methods."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Iterable, Mapping
from numbers import Integral, Real
from time import perf_counter
from types import ModuleType, NoneType
from typing import Any, NamedTuple

import xarray as xr
from numpy.typing import ArrayLike

from weier.data import dataset
from weier.data.yaml import number
from weier.kernels.arrays import Array
from weier.kernels.jit import compiling_seconds
from weier.methods import archard, bem, demelio, layer, patches, westergaard
from weier.methods.planned import curve as planned
from weier.methods.planned.plan import OutOfReachError
from weier.theory.limits import MOST_POINTS, check_resolvable
from weier.theory.loads import checked_loads
from weier.theory.profile import Profile


class Kind(NamedTuple):
    """What values a setting takes, and that in words."""

    types: tuple[Any, ...]
    words: str


KINDS = {  # by the annotation of a solver's keyword
    "int": Kind((Integral,), "a whole number such as 512"),
    "int | None": Kind((Integral, NoneType), "a whole number such as 512, or null"),
    "float": Kind((Real,), "a number"),
    "bool": Kind((bool,), "true or false"),
    "str": Kind((str,), "a word"),
}


class Estimate(NamedTuple):
    """Compliance, in g_0, and resistance, in g_0/p_0*, of a closed form; each of shape (loads,)."""

    compliance: Array
    resistance: Array


class NotApplicableError(ValueError):
    """The method says nothing about this profile: one wave only, or finite series only."""


def solve(profile: Profile, mean_pressure: ArrayLike, method: str = "bem", **settings: Any) -> xr.Dataset:
    """Compliance and contact resistance of a profile pressed against a plane.

    Parameters
    ----------
    profile : Profile
        The Weierstrass series.
    mean_pressure : array_like, shape (loads,)
        Positive and increasing, in p_0*.
    method : str
        "westergaard" (m = 1), "archard", "demelio", "layer": the paper's closed forms and model;
        "bem": boundary elements; "patches": the exact contact edges; "planned": the cheapest of them for a tolerance.
    **settings
        Settings of the method, such as `points` of "bem"; attributes of the result.

    Returns
    -------
    Dataset
        Over the dimension mean_pressure: compliance, in g_0, and resistance, in g_0/p_0*; the numerical methods
        add contact_fraction, patch_count, residual and work, "patches" the indentation from first contact and the
        contact edges, "planned" the errors it expects. The attribute seconds is the time it took.

    Raises
    ------
    ValueError
        If the loads, the method or a setting is unknown or out of range; NotApplicableError where the method
        does not apply to the profile.
    ConvergenceError
        If a solver misses its tolerance.

    Examples
    --------
    >>> import weier
    >>> profile = weier.Profile(D=1.25, gamma=5, m=3, phases=(0.0, 1.0, 2.0))
    >>> curve = weier.solve(profile, [0.01, 0.1, 1.0], method="demelio")
    >>> curve.compliance.values.round(4)
    array([0.0706, 0.4208, 1.3527])

    """
    loads = checked_loads(mean_pressure)
    found, seconds = answer(profile, loads, method, settings)
    return dataset.curve(loads, found._asdict(), {"method": method, **settings, "seconds": seconds})


def answer(profile: Profile, loads: Array, method: str, settings: Mapping[str, Any]) -> tuple[Any, float]:
    """What `solve` holds, as the method's own tuple of arrays and scalars, and the seconds without compiling.

    For `loads` that are checked; raises what `solve` raises.
    """
    run = checked_method(method, settings).run
    start, compiling = perf_counter(), compiling_seconds()
    found = run(profile, loads, **settings)
    return found, perf_counter() - start - (compiling_seconds() - compiling)


class Method(NamedTuple):
    """How a method is run on (profile, loads, **settings), and whose keywords are its settings."""

    run: Callable[..., Any]
    solver: Callable[..., Any]


def _closed_form(estimator: ModuleType) -> Method:
    def run(profile: Profile, loads: Array) -> Estimate:
        series = (profile.D, float(profile.gamma), profile.m)
        return Estimate(estimator.compliance(loads, *series), estimator.resistance(loads, *series))

    return Method(run, run)


def _one_wave(profile: Profile, loads: Array) -> Estimate:
    if profile.m != 1:
        raise NotApplicableError(f'method "westergaard" is for one wave, m = 1, got m = {profile.m}')
    return Estimate(westergaard.compliance(loads), westergaard.resistance(loads))


def _layer(profile: Profile, loads: Array, **settings: Any) -> Any:
    return layer.curve(loads, profile.D, float(profile.gamma), profile.m, **settings)


def _truncated(solver: Callable[..., Any]) -> Method:
    def run(profile: Profile, loads: Array, **settings: Any) -> Any:
        if math.isinf(profile.m):
            raise NotApplicableError(
                "m = inf has no finest wave to resolve: choose a finite m, or archard, demelio, layer or planned"
            )
        check_resolvable(profile)
        return solver(profile, loads, **settings)

    return Method(run, solver)


def _planned(profile: Profile, loads: Array, **settings: Any) -> planned.Curve:
    try:
        return planned.curve(profile, loads, **settings)
    except OutOfReachError as error:
        raise NotApplicableError(str(error)) from None


METHODS = {
    "westergaard": Method(_one_wave, _one_wave),
    "archard": _closed_form(archard),
    "demelio": _closed_form(demelio),
    "layer": Method(_layer, layer.curve),
    "bem": _truncated(bem.curve),
    "patches": _truncated(patches.curve),
    "planned": Method(_planned, planned.curve),
}


def checked_method(name: str, settings: Iterable[str] = ()) -> Method:
    """The method of this name, if it takes these settings.

    Raises
    ------
    ValueError
        If there is no such method, or it has no such setting.

    """
    if name not in METHODS:
        raise ValueError(f"method must be one of {', '.join(METHODS)}, got {name!r}")
    known = _defaults(METHODS[name])
    for setting in settings:
        if setting not in known:
            choice = f"it takes {', '.join(known)}" if known else "it takes none"
            raise ValueError(f'method "{name}" has no setting {setting!r}: {choice}')
    return METHODS[name]


def checked_settings(method: str, settings: Mapping[str, Any]) -> dict[str, Any]:
    """The settings, if the method takes them: of the right kind and within range, before a solver meets them.

    Numbers may be written as text.

    Raises
    ------
    ValueError
        If the method has no such setting, or its value is of another kind or out of any range.

    """
    parameters = inspect.signature(checked_method(method, settings).solver).parameters
    return {
        name: _checked_setting(f"{name} of {method}", str(parameters[name].annotation), value)
        for name, value in settings.items()
    }


def _checked_setting(name: str, kind: str, value: Any) -> Any:
    shown = f"{value!r:.40}"
    if kind == "float" and isinstance(value, str):
        value = number(name, value)
    types, words = KINDS[kind]
    if not isinstance(value, types) or (isinstance(value, bool) and kind != "bool"):
        raise ValueError(f"{name} must be {words}, got {shown}")
    if kind == "float" and not 1e-15 <= value < 1:
        raise ValueError(f"{name} must lie in [1e-15, 1), got {shown}")
    if kind.startswith("int") and value is not None and not 1 <= value <= MOST_POINTS:
        raise ValueError(f"{name} must lie in [1, {MOST_POINTS}], got {shown}")
    return value


def all_settings(name: str, settings: Mapping[str, Any]) -> dict[str, Any]:
    """The settings of a method: those given, and the others at their defaults."""
    return _defaults(METHODS[name]) | dict(settings)


def _defaults(method: Method) -> dict[str, Any]:
    parameters = inspect.signature(method.solver).parameters.values()
    return {parameter.name: parameter.default for parameter in parameters if parameter.default is not parameter.empty}
