"""The settings of methods: keywords of their solvers, which are checked before a solution."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from typing import Any

from weier.checks import checked_count, checked_flag, checked_number, nearest, shown
from weier.methods import patches
from weier.methods.method import Method
from weier.methods.registry import METHODS, find_method
from weier.surface.waves import MAX_POINTS

TOLERANCE = "tolerance"  # has the same meaning in all methods


Check = Callable[[str, Any], Any]


def _count(name: str, value: Any) -> int:
    # the range of a method is narrower, and its own check names it
    checked_number(name, value, "be a whole number", lambda number: number == number // 1)  # which inf is not
    return checked_count(name, value, 1, MAX_POINTS)


def _fraction(name: str, value: Any) -> float:
    """Check a numerical setting that is no count: a tolerance or a fraction."""
    least, most = patches.MIN_TOLERANCE, patches.MAX_TOLERANCE
    return checked_number(name, value, f"lie in {patches.TOLERANCE_RANGE}", lambda number: least <= number < most)


def _word(name: str, value: Any) -> str:
    if not isinstance(value, str):
        raise ValueError(f"{name} must be a word, got {shown(value)}")
    return str(value)


# By the annotation of a solver's keyword; one that may be None ends in `| None`.
KINDS: dict[str, Check] = {"int": _count, "float": _fraction, "bool": checked_flag, "str": _word}
NONE = " | None"  # The end of the annotation of a setting that may be None.


def check_names(method: Method, settings: Iterable[str]) -> None:
    """Refuse settings that the method does not have, and name the method that has them."""
    known = defaults(method)
    for setting in settings:
        if setting not in known:
            choice = f"it takes {', '.join(known)}" if known else "it takes none"
            raise ValueError(f'method "{method.name}" has no setting {setting!r}: {choice}{_hint(method, setting)}')


def _hint(method: Method, setting: str) -> str:
    """Return the methods that have a setting, or a setting that is spelt alike, as the end of a message."""
    if found := methods_with(setting):
        return f"; {setting!r} is a setting of {', '.join(found)}"
    near = nearest(setting, all_names())
    if not near or near in defaults(method):
        return f": did you mean {near!r}?" if near else ""
    return f": did you mean {near!r}, of {', '.join(methods_with(near))}?"


def methods_with(setting: str) -> list[str]:
    """Return the names of the methods that have a setting of this name."""
    return [f'"{method.name}"' for method in METHODS if setting in defaults(method)]


def all_names() -> list[str]:
    """Return the names of the settings of all methods."""
    return [name for method in METHODS for name in defaults(method)]


def checked_settings(method: Method, settings: Mapping[str, Any]) -> dict[str, Any]:
    """Return the settings, if the method takes them: of the right kind and within range."""
    check_names(method, settings)
    return {name: _checked(method, name, value) for name, value in settings.items()}


def _checked(method: Method, name: str, value: Any) -> Any:
    kind = str(_keywords(method.solve)[name].annotation)
    if value is None and kind.endswith(NONE):
        return None
    return KINDS[kind.removesuffix(NONE)](f"{name} of {method.name}", value)


def with_tolerance(
    methods: Iterable[str], settings: Mapping[str, Mapping[str, Any]], tolerance: float | None
) -> dict[str, dict[str, Any]]:
    """Return settings by method, with this tolerance for methods that take one and have none of their own.

    ValueError is raised if none takes one.
    """
    given = {method: dict(own) for method, own in settings.items()}
    if tolerance is None:
        return given
    takers = [name for name in methods if TOLERANCE in defaults(find_method(name))]
    if not takers:
        raise ValueError(
            f"tolerance is a setting of {', '.join(methods_with(TOLERANCE))}, and none of these is among the methods "
            f"{', '.join(methods)}"
        )
    for name in takers:
        given[name] = {TOLERANCE: tolerance} | given.get(name, {})
    return given


def all_settings(method: Method, settings: Mapping[str, Any]) -> dict[str, Any]:
    """Return the settings that a method uses: those given, and the others at their defaults, without None."""
    given = {name: value for name, value in settings.items() if value is not None}
    used = {**defaults(method), **method.chosen(given), **given}
    return {name: value for name, value in used.items() if value is not None}


def defaults(method: Method) -> dict[str, Any]:
    """Return every setting of a method at its default."""
    return {name: keyword.default for name, keyword in _keywords(method.solve).items()}


def described(methods: Iterable[Method]) -> list[tuple[str, str]]:
    """Return every setting of some methods with its default, such as `layer.points=16`, and its meaning."""
    return [
        (f"{method.name}.{name}" + ("" if default is None else f"={default}"), method.settings.get(name, ""))
        for method in methods
        for name, default in defaults(method).items()
    ]


@cache  # called once per case
def _keywords(solve: Callable[..., Any]) -> dict[str, inspect.Parameter]:
    parameters = inspect.signature(solve).parameters.values()
    return {parameter.name: parameter for parameter in parameters if parameter.default is not parameter.empty}
