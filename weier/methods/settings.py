"""The settings of a method: keywords of its solver, checked before a solver meets them."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping
from numbers import Integral, Real
from types import NoneType
from typing import Any, NamedTuple

from weier.data.yaml import number
from weier.methods.method import Method
from weier.theory.limits import MAX_POINTS

MIN_FRACTION = 1e-15  # of a tolerance: less is below rounding


class SettingKind(NamedTuple):
    """What values a setting takes, and that in words."""

    types: tuple[Any, ...]
    words: str


KINDS = {  # by the annotation of a solver's keyword
    "int": SettingKind((Integral,), "a whole number such as 512"),
    "int | None": SettingKind((Integral, NoneType), "a whole number such as 512, or null"),
    "float": SettingKind((Real,), "a number"),
    "bool": SettingKind((bool,), "true or false"),
    "str": SettingKind((str,), "a word"),
}


def check_names(method: Method, settings: Iterable[str]) -> None:
    """Refuse settings that the method does not have."""
    known = defaults(method)
    for setting in settings:
        if setting not in known:
            choice = f"it takes {', '.join(known)}" if known else "it takes none"
            raise ValueError(f'method "{method.name}" has no setting {setting!r}: {choice}')


def checked_settings(method: Method, settings: Mapping[str, Any]) -> dict[str, Any]:
    """The settings, if the method takes them: of the right kind and within range. Numbers may be written as text."""
    check_names(method, settings)
    keywords = _keywords(method.solve)
    return {
        name: _checked_setting(f"{name} of {method.name}", str(keywords[name].annotation), value)
        for name, value in settings.items()
    }


def all_settings(method: Method, settings: Mapping[str, Any]) -> dict[str, Any]:
    """The settings of a method: those given, and the others at their defaults."""
    return defaults(method) | dict(settings)


def defaults(method: Method) -> dict[str, Any]:
    """Every setting of a method at its default."""
    return {name: keyword.default for name, keyword in _keywords(method.solve).items()}


def _keywords(solve: Callable[..., Any]) -> dict[str, inspect.Parameter]:
    parameters = inspect.signature(solve).parameters.values()
    return {parameter.name: parameter for parameter in parameters if parameter.default is not parameter.empty}


def _checked_setting(name: str, kind: str, value: Any) -> Any:
    shown = f"{value!r:.40}"
    if kind == "float" and isinstance(value, str):
        value = number(name, value)
    types, words = KINDS[kind]
    if not isinstance(value, types) or (isinstance(value, bool) and kind != "bool"):
        raise ValueError(f"{name} must be {words}, got {shown}")
    if kind == "float" and not MIN_FRACTION <= value < 1:
        raise ValueError(f"{name} must lie in [{MIN_FRACTION:g}, 1), got {shown}")
    if kind.startswith("int") and value is not None and not 1 <= value <= MAX_POINTS:
        raise ValueError(f"{name} must lie in [1, {MAX_POINTS}], got {shown}")
    return value
